"""Which file is made of which card."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from html import unescape
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from hunting_app import words
from hunting_app.exports.curves import csv
from hunting_app.exports.menu import KINDS, REPORT, File, Menu
from hunting_app.exports.report import report
from hunting_app.numerals import written
from hunting_app.picture import Picture, picture
from hunting_app.state import FIELDS, PRESETS

if TYPE_CHECKING:
    from hunting_app.motions import Motions
    from hunting_app.state import State

_SUBJECTS = {
    "bifurcation": "bifurcation diagram",
    "portraits": "phase portraits",
    "motion": "motion over time",
    "stability": "stability over speed",
}
_OF_A_SPEED = ("portraits", "motion")
_MARKS = {
    "bifurcation": "Solid: stable limit cycle; dashed: unstable; thin: averaged after Bogoliubov. "
    "Disc: Hopf point; diamond: fold; dotted: flange clearance.",
    "portraits": "Solid: stable limit cycle; dashed: unstable.",
    "motion": "Shaded: the flange touches the rail.",
    "stability": "",
}


_TAG = re.compile(r"(<[^>]*>\s*)+")


class Files:
    """Makes files of what the page shows at the moment it is asked.

    Parameters
    ----------
    state : State
        What is shown.
    motions : callable
        Returns the simulated motions, or None while the page has no place for them.
    """

    def __init__(self, state: State, motions: Callable[[], Motions | None]) -> None:
        self.state, self._motions = state, motions

    def menu(self, card: str) -> Menu:
        """Return the menu of a card."""
        kinds = KINDS | (REPORT if card == "bifurcation" else {})
        return Menu(partial(self.make, card), f"the {_SUBJECTS[card]}", kinds)

    def make(self, card: str, kind: str) -> File:
        """Return a file of a card, or the report of them all."""
        s = self.state
        shown = picture(s.parameters, s.vehicle, s.speed, s.exact == "shown", s.pinned())
        motions = self._motions()
        motion = motions.motion if motions else None
        said = str(motions.text.html) if motions and motion else ""
        if kind == "report":
            return File(_name("report", "html", s), kind, report(s, shown, motion, said))
        what = s.curve if card == "stability" else card
        name = _name(what, kind, s)
        if kind == "csv":
            return File(name, kind, csv(what, s.parameters, shown, motion))
        return File(name, kind, _caption(card, shown, s, said), _SUBJECTS[card].capitalize())


def _name(what: str, suffix: str, state: State) -> str:
    at = f"-at-{state.speed:g}-km-h" if what in _OF_A_SPEED else ""
    return f"{state.vehicle}-{what}{at}.{suffix}".replace("both-", "bogie-and-wheelset-")


def _caption(card: str, shown: Picture, state: State, moved: str) -> str:
    sentences: dict[str, Callable[[Any], str]] = {
        "bifurcation": words.diagram,
        "portraits": words.portraits,
        "stability": words.stability,
    }
    said = sentences[card](shown) if card in sentences else unescape(_TAG.sub(" ", moved)).strip()
    changed = ", ".join(
        f"{FIELDS[name].symbol} = {written(getattr(state.parameters, name))} {FIELDS[name].unit}"
        for name in state.changed()
    )
    design = f"Parameters: {PRESETS[state.preset].label}"
    design += f", changed: {changed}." if changed else "."
    lines = [said, _MARKS[card], f"{design} bogie-hunting {version('bogie-hunting')}."]
    return "\n".join(line for line in lines if line)
