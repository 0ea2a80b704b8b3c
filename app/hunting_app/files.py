"""Parameters and designs as JSON: written to files and to the browser's memory, and read back."""

from __future__ import annotations

import json
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from hunting_app.designs import MOST, Designs, joined, named
from hunting_app.state import FIELDS, PRESETS, Design

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hunting_app.state import State

LARGEST = 100_000  # characters; fifty designs have half as many


def parameters_json(state: State) -> str:
    """Return the present parameters [SI], their units and the preset, as JSON."""
    return _dumped(_plain(state.design()))


def designs_json(designs: Designs) -> str:
    """Return all designs [SI] as JSON."""
    return _dumped({"designs": [{"name": one.name, **_plain(one)} for one in designs]})


def _plain(design: Design) -> dict[str, Any]:
    return {"preset": design.preset, "parameters": design.parameters.to_dict()}


def _dumped(content: dict[str, Any]) -> str:
    units = {name: field.unit for name, field in FIELDS.items()}
    made_by = {"program": f"bogie-hunting {version('bogie-hunting')}"}
    return json.dumps(made_by | content | {"units": units}, indent=1, ensure_ascii=False)


def with_file(state: State, name: str, text: Any, size: float) -> tuple[dict[str, Any], str]:
    """Return the change of `state` that a file asks for, and what was done, in words.

    A parameter that the file does not name keeps its present value, or gets that of the preset
    if the file names one. Designs are added to those that are kept.

    Parameters
    ----------
    state : State
        What is changed.
    name : str
        The file's name.
    text : str or None
        What is in it; None if the browser found it too large.
    size : float
        Its size [bytes].

    Raises
    ------
    ValueError, TypeError
        If anything in it is wrong: the file and the field are named.
    """
    name = f"‘{str(name)[:60]}’"
    if not isinstance(text, str) or len(text) > LARGEST:
        most = f"{LARGEST / 1000:.0f} kB"
        raise ValueError(f"{name} is refused: {size / 1000:.0f} kB is too large, at most {most}")
    try:
        content = _object(text)
        if "designs" in content:
            found = _designs(content)
            more = tuple(design for design in found if design not in state.designs)
            had = len(found) - len(more)
            already = f", {had} of them kept already" if had else ""
            said = f"{len(found)} design{'s' * (len(found) != 1)} from {name}{already}."
            return {"designs": joined(state.designs, more)}, said
        change, count = _parameters(content, state)
    except (ValueError, TypeError, OverflowError) as refusal:
        raise ValueError(f"{name} is refused, nothing was changed: {refusal}") from refusal
    others = f" The other {len(FIELDS) - count} are as they were."
    partly = "" if count == len(FIELDS) or "preset" in content else others
    return change, f"{count} parameter{'s' * (count != 1)} from {name}.{partly}"


def stored(text: Any) -> Designs:
    """Return the designs that a browser remembers.

    Raises
    ------
    ValueError, TypeError
        If anything is wrong with them.
    """
    if not isinstance(text, str) or len(text) > LARGEST:
        raise ValueError("the designs that this browser remembers are too large to be read")
    try:
        return _designs(_object(text))
    except (ValueError, TypeError, OverflowError) as refusal:
        raise ValueError(f"what this browser remembers of designs is refused: {refusal}") from None


def _object(text: str) -> dict[str, Any]:
    try:
        content = json.loads(text, parse_int=float, object_pairs_hook=_unique)
    except json.JSONDecodeError as error:
        raise ValueError(f"it is not JSON (line {error.lineno}: {error.msg})") from None
    except RecursionError:
        raise ValueError("it is not JSON of ours: too deeply nested") from None
    if not isinstance(content, dict):
        raise TypeError('it must hold a JSON object, such as {"Ky": 86700}')
    return content


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"{next(n for n in names if names.count(n) > 1)[:40]} stands there twice")
    return content


def _parameters(content: dict[str, Any], state: State) -> tuple[dict[str, Any], int]:
    """Return the change that a file of parameters asks for, and how many it names."""
    values = content.get("parameters", content)
    if not isinstance(values, dict):
        raise TypeError("parameters must be an object of names and values")
    _check_units(content.get("units", {}))
    if values is content:
        values = {n: v for n, v in content.items() if n not in {"preset", "units", "program"}}
    preset = _preset(content["preset"]) if "preset" in content else state.preset
    base = PRESETS[preset].parameters if "preset" in content else state.parameters
    if not values and "preset" not in content:
        raise ValueError("there is no parameter in it")
    change = {"preset": preset, "parameters": base.replace(**_checked(values))}
    return change, len(values)


def _designs(content: dict[str, Any]) -> Designs:
    found = content.get("designs")
    if not isinstance(found, list) or len(found) > MOST:
        raise ValueError(f"designs must be a list of at most {MOST}")
    _check_units(content.get("units", {}))
    return joined((), tuple(_design(one) for one in found))


def _design(one: Any) -> Design:
    if not isinstance(one, dict) or not isinstance(one.get("parameters"), dict):
        raise TypeError("each design must be an object with name, preset and parameters")
    preset = _preset(one.get("preset", "reconstructed"))
    values = _checked(one["parameters"])
    return Design(named(one.get("name", "")), preset, PRESETS[preset].parameters.replace(**values))


def _preset(name: Any) -> str:
    if not isinstance(name, str) or name not in PRESETS:
        raise ValueError(f"preset must be one of {', '.join(PRESETS)}, got ‘{str(name)[:40]}’")
    return name


def _checked(values: Mapping[str, Any]) -> dict[str, float]:
    """Return the values as numbers; the model itself takes lists of them, a slider does not."""
    for name, value in values.items():
        if name not in FIELDS:
            raise ValueError(f"‘{name[:40]}’ is no parameter")
        if isinstance(value, bool) or not isinstance(value, float):
            raise TypeError(f"{name} must be a number, got {json.dumps(value)[:40]}")
    return {name: float(value) for name, value in values.items()}


def _check_units(units: Any) -> None:
    if not isinstance(units, dict):
        raise TypeError("units must be an object of names and units")
    for name, unit in units.items():
        if name in FIELDS and unit != FIELDS[name].unit:
            raise ValueError(f"{name} must be in {FIELDS[name].unit}, not in ‘{str(unit)[:20]}’")
