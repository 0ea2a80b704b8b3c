"""The designs that were kept: changes of their list, and what is compared with a baseline."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from hunting_app.numerals import written
from hunting_app.state import FIELDS, PRESETS, Design

if TYPE_CHECKING:
    from hunting_app.state import State

MOST = 50  # designs; a browser has to keep them
LONGEST = 40  # characters of a name

Designs = tuple[Design, ...]


def named(text: object) -> str:
    """Return a name without needless space.

    Raises
    ------
    ValueError
        If nothing is left of it, or too much.
    """
    name = " ".join(str(text).split())
    if not name:
        raise ValueError("a name is missing")
    if len(name) > LONGEST:
        raise ValueError(f"a name may have {LONGEST} characters, ‘{name[:LONGEST]}…’ has more")
    return name


def with_kept(state: State) -> dict[str, Any]:
    """Return the change of `state` that keeps the present parameters under a new name.

    Raises
    ------
    ValueError
        If there are too many already.
    """
    return {"designs": joined(state.designs, (state.design("Design 1"),))}


def joined(designs: Designs, more: Designs) -> Designs:
    """Return both, those that came later renamed where a name was taken.

    Raises
    ------
    ValueError
        If they are too many.
    """
    if len(designs) + len(more) > MOST:
        raise ValueError(f"at most {MOST} designs are kept; delete some first")
    for design in more:
        taken = {kept.name for kept in designs}
        designs = (*designs, replace(design, name=_free(design.name, taken)))
    return designs


def _free(name: str, taken: set[str]) -> str:
    if name not in taken:
        return name
    stem, _, end = name.rpartition(" ")
    stem = (stem if stem and end.isdecimal() else name)[: LONGEST - 4]
    return next(f"{stem} {k}" for k in range(2, MOST + 3) if f"{stem} {k}" not in taken)


def with_change(state: State, act: dict[str, Any]) -> dict[str, Any]:
    """Return the change of `state` that an act on the design ``act["design"]`` asks for.

    Raises
    ------
    ValueError
        If there is no such design, or its new name is none or taken.
    """
    names = [design.name for design in state.designs]
    if act["design"] not in names:
        raise ValueError(f"there is no design ‘{str(act['design'])[:LONGEST]}’ any more")
    at = names.index(act["design"])
    design, designs = state.designs[at], list(state.designs)
    match act:
        case {"show": True}:
            return {"preset": design.preset, "parameters": design.parameters}
        case {"pin": True}:
            return {"baseline": design}
        case {"delete": True}:
            del designs[at]
        case {"move": -1 | 1 as by}:
            designs.insert(min(max(at + by, 0), len(names) - 1), designs.pop(at))
        case {"rename": text}:
            name = named(text)
            if name in names and name != design.name:
                raise ValueError(f"there is a design ‘{name}’ already")
            designs[at] = replace(design, name=name)
    return {"designs": tuple(designs)}


def differences(design: Design) -> str:
    """Return what a design changes of its preset, in words."""
    changed = ", ".join(
        f"{FIELDS[n].symbol} = {written(getattr(design.parameters, n))} {FIELDS[n].unit}"
        for n in design.changed()
    )
    start = PRESETS[design.preset].label
    return f"{start}: {changed}" if changed else f"{start}, nothing changed"
