"""The Study page: what every parameter does, alone, in pairs, all at once, and within limits."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import panel as pn

from hunting_app.numerals import written
from hunting_app.state import FIELDS, PRESETS, VEHICLES, State
from hunting_app.study.bars import Sensitivities
from hunting_app.study.figures import Figures
from hunting_app.study.limits import Limits
from hunting_app.study.map import Map
from hunting_app.study.section import Section, markup, part, warning
from hunting_app.study.target import Target

if TYPE_CHECKING:
    from collections.abc import Callable

SECTIONS: tuple[type[Section], ...] = (Figures, Map, Sensitivities, Limits, Target)


class StudyPage:
    """Sections, one of them shown at a time; each is made when first turned to."""

    def __init__(self, state: State, act: Callable[[dict[str, Any]], None]) -> None:
        self.state, self.act = state, act
        self.kinds = {kind.key: kind for kind in SECTIONS}
        self.sections: dict[str, Section] = {}
        self.chosen = SECTIONS[0].key
        self.navigation = markup(self._clicked)
        self.design = markup()
        self.places = {key: part("place") for key in self.kinds}
        self.show()
        state.param.watch(lambda *_: self.show(), ["parameters", "vehicle", "page"])
        state.param.watch(lambda *_: self._redraw(), ["dark"])
        pn.state.on_session_destroyed(lambda _context: self.close())

    def show(self) -> None:
        """Show the chosen section; nothing is done while another page is shown."""
        if self.state.page != "study":
            return
        section = self._section(self.chosen)
        self.navigation.html = "".join(
            f'<button data-act=\'{{"section": "{key}"}}\' '
            f'aria-pressed="{str(key == self.chosen).lower()}">{kind.label}</button> '
            for key, kind in self.kinds.items()
        )
        section.opened()
        note = "What is shown below was computed for other parameters; compute it again."
        self.design.html = _design(self.state) + (warning(note) if section.outdated() else "")
        for key, place in self.places.items():
            place.visible = key == self.chosen

    def close(self) -> None:
        """Stop all work, as nobody is there to see it."""
        for section in self.sections.values():
            if section.job is not None:
                section.job.cancel()

    def _section(self, key: str) -> Section:
        if key not in self.sections:
            self.sections[key] = self.kinds[key](self.state, self.act)
            self.places[key].append(self.sections[key])
        return self.sections[key]

    def _clicked(self, act: dict[str, Any]) -> None:
        if act.get("section") in self.kinds:
            with pn.io.hold():
                self.chosen = act["section"]
                self.show()

    def _redraw(self) -> None:
        for section in self.sections.values():
            section.redraw()

    def __panel__(self) -> pn.viewable.Viewable:
        """Design and sections on top."""
        return part("study", self.design, self.navigation, *self.places.values())


def _design(state: State) -> str:
    """Return in words what is studied."""
    vehicle = VEHICLES[state.vehicle][0]
    changed = ", ".join(
        f"{FIELDS[n].symbol} = {written(getattr(state.parameters, n))} {FIELDS[n].unit}"
        for n in state.changed()
    )
    start = PRESETS[state.preset].label
    return (
        f"<p>Studied here: the <b>{vehicle}</b> with the parameters now on the sliders of Explore: "
        f"preset “{escape(start)}”, {'with ' + escape(changed) if changed else 'nothing changed'}."
        "</p>"
    )
