"""The address bar: what differs from the preset, as a query string, and back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any
from urllib.parse import parse_qsl, urlencode

from hunting_app.designs import named
from hunting_app.numerals import compact
from hunting_app.state import (
    CHOICES,
    FIELDS,
    SPEED,
    Design,
    State,
    with_choice,
    with_disturbance,
    with_preset,
    with_value,
)

_PINNED = "baseline."  # before what the baseline changes of its preset


def query(state: State) -> str:
    """Return ``?Ky=100000&vehicle=both``: only what differs from the defaults and the preset.

    Examples
    --------
    >>> query(State(vehicle="both"))
    '?vehicle=both'
    """
    items: dict[str, str] = {}
    if state.preset != State.param.preset.default:
        items["preset"] = state.preset
    items |= {name: compact(getattr(state.parameters, name)) for name in state.changed()}
    if state.speed != State.param.speed.default:
        items[SPEED.name] = compact(state.speed)
    if state.disturbance:
        items["disturbance"] = compact(round(state.disturbance, 3))
    for name in CHOICES:
        if getattr(state, name) != State.param[name].default:
            items[name] = getattr(state, name)
    if state.baseline is not None:
        items |= _of_baseline(state.baseline)
    return f"?{urlencode(items)}" if items else ""


def _of_baseline(baseline: Design) -> dict[str, str]:
    values = {n: compact(getattr(baseline.parameters, n)) for n in baseline.changed()}
    if baseline.name:
        values["name"] = baseline.name
    return {"baseline": baseline.preset} | {f"{_PINNED}{n}": text for n, text in values.items()}


def changes(search: str) -> tuple[dict[str, Any], list[str]]:
    """Return what a query string makes of a fresh state, and its refusals in words.

    Whatever in it makes no sense is refused and leaves its default; the rest counts.

    Examples
    --------
    >>> changes("?vehicle=tram")[1]
    ['vehicle must be one of bogie, wheelset, both, got ‘tram’']
    """
    asked = dict(parse_qsl(search.removeprefix("?"), keep_blank_values=True))
    fresh = State()
    refused: list[str] = []

    def attempt(name: str, text: str) -> None:
        try:
            fresh.param.update(**_change(fresh, name, text))
        except (ValueError, TypeError) as refusal:
            refused.append(str(refusal) if name in str(refusal) else f"{name}: {refusal}")

    first = ("preset", "baseline")  # the other values are changes of them
    for name in (*(n for n in first if n in asked), *(n for n in asked if n not in first)):
        attempt(name, asked[name])
    names = ("preset", "parameters", "speed", "disturbance", "baseline", *CHOICES)
    return {name: getattr(fresh, name) for name in names}, refused


def _change(state: State, name: str, text: str) -> dict[str, Any]:
    if name == "preset":
        return with_preset(text)
    if name == "disturbance":
        return with_disturbance(text)
    if name in CHOICES:
        return with_choice(name, text)
    if name in FIELDS or name == SPEED.name:
        return with_value(state, name, text)
    if name == "baseline":
        return {"baseline": Design("", **with_preset(text))}
    if name.startswith(_PINNED):
        return {"baseline": _pinned(state.baseline, name.removeprefix(_PINNED), text)}
    raise ValueError(f"‘{name[:40]}’ in the link is no parameter and no setting")


def _pinned(baseline: Design | None, name: str, text: str) -> Design:
    if baseline is None:
        raise ValueError(f"‘{_PINNED}{name[:40]}’ in the link is of no baseline")
    if name == "name":
        return replace(baseline, name=named(text))
    changed = with_value(State(parameters=baseline.parameters), name, text)
    if "parameters" not in changed:
        raise ValueError(f"‘{_PINNED}{name[:40]}’ in the link is no parameter")
    return replace(baseline, parameters=changed["parameters"])
