"""The address bar: what differs from the preset, as a query string, and back."""

from __future__ import annotations

from typing import Any
from urllib.parse import parse_qsl, urlencode

from hunting_app.numerals import compact
from hunting_app.state import (
    CHOICES,
    FIELDS,
    SPEED,
    State,
    with_choice,
    with_disturbance,
    with_preset,
    with_value,
)


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
    return f"?{urlencode(items)}" if items else ""


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

    if "preset" in asked:  # first: the other values are changes of it
        attempt("preset", asked.pop("preset"))
    for name, text in asked.items():
        attempt(name, text)
    names = ("preset", "parameters", "speed", "disturbance", *CHOICES)
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
    raise ValueError(f"‘{name[:40]}’ in the link is no parameter and no setting")
