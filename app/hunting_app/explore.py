"""The Explore page: answers and plots. It only draws; the numbers come in a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import panel as pn
from bokeh.events import Tap

from hunting_app import words
from hunting_app.blocks import LAYOUT, block, button, column
from hunting_app.details import Details
from hunting_app.exports.files import Files
from hunting_app.glossary import explained, term
from hunting_app.markup import Html, text
from hunting_app.pace import open_page
from hunting_app.palette import palette
from hunting_app.picture import picture
from hunting_app.plots.bifurcation import Bifurcation
from hunting_app.plots.feed import Feed

if TYPE_CHECKING:
    from collections.abc import Callable

    from hunting_app.advice import Advice
    from hunting_app.picture import Picture
    from hunting_app.plots.base import Plot
    from hunting_app.state import State


class Explore:
    """Answers and bifurcation diagram first; the details once the page shows those."""

    def __init__(self, state: State, act: Callable[[dict[str, Any]], None], advice: Advice) -> None:
        self.state, self.act, self.advice = state, act, advice
        self.feed = Feed()
        self.bifurcation = Bifurcation(self.feed)
        self.bifurcation.figure.on_event(Tap, self._disturb)
        self.plots: list[Plot] = [self.bifurcation]
        self.texts, self.panes = {}, {}
        for name in ("answers", "bifurcation"):
            self.texts[name], self.panes[name] = text(name)
        self.branches = Html(act, css_classes=["toggles"], stylesheets=[LAYOUT])
        self.details: Details | None = None
        self.files = Files(state, lambda: self.details.motions if self.details else None)
        self._drawn: tuple[Any, ...] = ()
        self._exact: tuple[Any, ...] = ()
        self._pinned: tuple[Any, ...] = ()
        self._waits = False  # the exact branch, for the cheap answers to leave
        self._dressed: bool | None = None
        self._vehicles: set[str] = set()
        self.view = block(
            "explore",
            column("strip", self.panes["answers"], advice.pane),
            block(
                "card diagram",
                self.files.menu("bifurcation"),
                self.branches,
                column("curves tall", self.panes["bifurcation"], self.bifurcation.figure),
            ),
        )
        self.draw()
        self.feed.connect(self.bifurcation.figure)
        state.param.watch(
            lambda *_: self.draw(),
            ["parameters", "vehicle", "speed", "curve", "exact", "averaged", "baseline", "dark"],
        )
        pn.state.onload(self.complete)

    def complete(self) -> None:
        """Add the details once they are seen: Bokeh stumbles over plots made out of sight."""
        if self.details or self.state.page != "explore":
            return
        with pn.io.hold():
            self.details = Details(
                self.state, self.feed, self.bifurcation.cursor, self.act, self.files
            )
            self.plots += self.details.plots
            self.texts |= self.details.texts
            self._drawn, self._pinned, self._dressed, self._vehicles = (), (), None, set()
            self._draw(self.state.exact == "shown")
            self.details.motions.run()
            self.view.extend(self.details.cards())
            self.feed.connect(self.bifurcation.figure)
            self.advice.run()

    def draw(self) -> None:
        """Bring everything up to date; what takes too long for a moving hand waits for `settle`."""
        state = self.state
        wanted, seen = state.exact == "shown", bool(self._drawn and open_page())
        self._waits = wanted and seen and self._exact != (state.parameters, state.vehicle)
        self._draw(wanted and not self._waits)

    def settle(self) -> None:
        """Draw the exact branch, in an update of its own."""
        if self._waits:
            self._waits = False
            with pn.io.hold():
                self._draw(self.state.exact == "shown")

    def _draw(self, exact: bool) -> None:
        """Draw the exact branch too, or leave all that follows from it as it is."""
        state = self.state
        shown = picture(state.parameters, state.vehicle, state.speed, exact, state.pinned())
        settled = exact or state.exact == "hidden"
        if exact:
            self._exact = (state.parameters, state.vehicle)
        colours = palette(state.dark)
        if self._dressed != state.dark:
            for plot in self.plots:
                plot.dress(colours)
            self._dressed = state.dark
        choices = (state.vehicle, state.curve, state.exact, state.averaged, state.baseline)
        wanted = (state.parameters, *choices, float(shown.speeds[-1]), settled)
        if self._drawn != wanted:
            self._draw_curves(shown, settled)
            self._drawn = wanted
        if settled:
            self.bifurcation.draw_moment(shown)
        if self.details:
            self.details.draw_moment(shown, settled)
        self.feed.send()
        if settled:
            self._write(shown)

    def _draw_curves(self, shown: Picture, settled: bool) -> None:
        if set(shown.answers) != self._vehicles:
            self._vehicles = set(shown.answers)
            for plot in self.plots:
                plot.show_vehicles(self._vehicles)
        if settled:  # both branches move together
            self.bifurcation.draw(shown, averaging=self.state.averaged == "shown")
            self._draw_baseline(shown)
        if self.details:
            self.details.draw(shown)
        self.branches.html = _toggles(exact=self.state.exact, averaged=self.state.averaged)

    def _draw_baseline(self, shown: Picture) -> None:
        """Draw it only when it is another one: moves of the sliders leave it alone."""
        state = self.state
        pinned = (state.baseline, state.vehicle, state.exact, float(shown.speeds[-1]))
        if self._pinned != pinned:
            self._pinned = pinned
            for plot in self.plots:
                plot.draw_baseline(shown)

    def _write(self, shown: Picture) -> None:
        self.texts["answers"].html = words.answers(shown)
        self.texts["bifurcation"].html = (
            f"<h2>{term('Bifurcation diagram')}</h2>"
            + explained(words.diagram(shown))
            + words.warning_signs(shown)
            + words.legend(shown)
        )

    def _disturb(self, event: Tap) -> None:
        """Simulate what was clicked on."""
        if event.x is not None and event.x > 0 and event.y > 0:
            self.act({"disturbance": round(event.y, 2), "speed": max(round(event.x, 1), 1.0)})

    def run(self) -> None:
        """Work out what waits until the hand rests: motions and advice."""
        if self.details:
            self.details.motions.run()
            self.advice.run()

    def __panel__(self) -> pn.viewable.Viewable:
        """Answers on top, the diagram left, what explains it right and below."""
        return self.view


def _toggles(**shown: str) -> str:
    """One button for each thing that can be hidden."""
    other = {"shown": "hidden", "hidden": "shown"}
    return "".join(
        button({name: other[now]}, name.capitalize(), pressed=now == "shown")
        for name, now in shown.items()
    )
