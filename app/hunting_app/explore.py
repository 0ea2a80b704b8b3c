"""The Explore page: answers and plots. It only draws; the numbers come in a picture."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import panel as pn
from bokeh.events import Tap

from hunting_app import words
from hunting_app.blocks import block, button, column, said
from hunting_app.markup import Html, text
from hunting_app.motions import Motions
from hunting_app.pace import send_at_once
from hunting_app.palette import palette
from hunting_app.picture import picture
from hunting_app.plots.bifurcation import Bifurcation
from hunting_app.plots.feed import Feed
from hunting_app.plots.portraits import Portraits
from hunting_app.plots.stability import Damping, Locus
from hunting_app.state import CURVES, State

if TYPE_CHECKING:
    from collections.abc import Callable

    from hunting_app.picture import Picture
    from hunting_app.plots.base import Plot

PAUSE = 60  # ms after which the exact branch follows a move; until then only what is cheap


class Explore:
    """Answers, bifurcation diagram, phase portraits and stability plot of one session."""

    def __init__(self, state: State, act: Callable[[dict[str, Any]], None]) -> None:
        self.state = state
        self.act = act
        self.feed = feed = Feed()
        self.bifurcation = Bifurcation(feed)
        self.portraits = Portraits(feed)
        self.stability = {"damping": Damping(feed, self.bifurcation.cursor), "locus": Locus(feed)}
        self.motions = Motions(state, feed, act)
        self.portraits.follow(self.motions.sources)
        feed.connect(self.bifurcation.figure)
        self.bifurcation.figure.on_event(Tap, self._disturb)
        self.plots: list[Plot] = [
            self.bifurcation,
            *self.portraits.plots.values(),
            *self.stability.values(),
            *self.motions.plots.values(),
        ]
        self.texts, self.panes = {}, {}
        for name in ("answers", "bifurcation", "portraits", "stability"):
            self.texts[name], self.panes[name] = text(name)
        self.choice = Html(act)
        self.branches = Html(act)
        self._drawn: tuple[Any, ...] = ()
        self._exact: tuple[Any, ...] = ()
        self._late: Any = None
        self._dressed: bool | None = None
        self._vehicles: set[str] = set()
        self.draw()
        self.motions.run()
        state.param.watch(
            lambda *_: self.draw(),
            ["parameters", "vehicle", "speed", "curve", "exact", "averaged", "dark"],
        )

    def draw(self) -> None:
        """Bring everything up to date; what takes too long for a moving hand comes after it."""
        state = self.state
        wanted = state.exact == "shown"
        waits = wanted and self._served() and self._exact != (state.parameters, state.vehicle)
        doc = pn.state.curdoc
        if waits and doc and self._late is None:
            self._late = doc.add_timeout_callback(self._draw_exact, PAUSE)
        self._draw(wanted and not waits)

    def _served(self) -> bool:
        """Whether a person sees this already: then the cheap answer goes out at once."""
        return bool(self._drawn and pn.state.curdoc and pn.state.curdoc.session_context)

    def _draw_exact(self) -> None:
        self._late = None
        send_at_once()
        with pn.io.hold():
            self._draw(self.state.exact == "shown")

    def _draw(self, exact: bool) -> None:
        """Draw the exact branch too, or leave all that follows from it as it is."""
        state = self.state
        shown = picture(state.parameters, state.vehicle, state.speed, exact)
        settled = exact or state.exact == "hidden"
        if exact:
            self._exact = (state.parameters, state.vehicle)
        colours = palette(state.dark)
        if self._dressed != state.dark:
            for plot in self.plots:
                plot.dress(colours)
            self._dressed = state.dark
        choices = (state.vehicle, state.curve, state.exact, state.averaged)
        wanted = (state.parameters, *choices, float(shown.speeds[-1]), settled)
        if self._drawn != wanted:
            self._draw_curves(shown, settled)
            self._drawn = wanted
        self.bifurcation.draw_moment(shown)
        self.portraits.draw_moment(shown)
        self.stability[state.curve].draw_moment(shown)
        self.motions.draw_moment(shown, settled)
        self.feed.send()
        self._write(shown, settled)

    def _draw_curves(self, shown: Picture, settled: bool) -> None:
        if set(shown.answers) != self._vehicles:
            self._vehicles = set(shown.answers)
            for plot in self.plots:
                plot.show_vehicles(self._vehicles)
        self.bifurcation.draw(shown, averaging=self.state.averaged == "shown", settled=settled)
        for name, plot in self.stability.items():
            plot.figure.visible = name == self.state.curve
        self.stability[self.state.curve].draw(shown)
        if settled:
            self.texts["answers"].html = words.answers(shown)
        self.choice.html = _choice("curve", CURVES, self.state.curve)
        self.branches.html = _toggles(exact=self.state.exact, averaged=self.state.averaged)

    def _write(self, shown: Picture, settled: bool) -> None:
        warned = "".join(f'<p class="warning">{escape(w)}</p>' for w in words.warnings(shown))
        html = {
            "bifurcation": "<h2>Bifurcation diagram</h2>"
            + said(words.diagram(shown))
            + warned
            + words.legend(shown),
            "portraits": "<h2>Phase portraits</h2>" + said(words.portraits(shown)),
            "stability": said(words.stability(shown)),
        }
        for name, markup in html.items():
            if settled or name == "stability":
                self.texts[name].html = markup

    def _disturb(self, event: Tap) -> None:
        """Simulate what was clicked on."""
        if event.x is not None and event.x > 0 and event.y > 0:
            self.act({"disturbance": round(event.y, 2), "speed": max(round(event.x, 1), 1.0)})

    def __panel__(self) -> pn.viewable.Viewable:
        """Answers on top, the diagram left, portraits right, stability below."""
        panes = self.panes
        portraits = [plot.figure for plot in self.portraits.plots.values()]
        curves = [plot.figure for plot in self.stability.values()]
        return block(
            "explore",
            column("strip", panes["answers"]),
            block(
                "card diagram",
                self.branches,
                column("curves", panes["bifurcation"], self.bifurcation.figure),
            ),
            column("card portraits", panes["portraits"], *portraits),
            self.motions,
            block("card stability", self.choice, column("curves", panes["stability"], *curves)),
        )


def _choice(name: str, labels: dict[str, str], chosen: str) -> str:
    """One button for each of several choices."""
    return "".join(button({name: k}, label, pressed=k == chosen) for k, label in labels.items())


def _toggles(**shown: str) -> str:
    """One button for each thing that can be hidden."""
    other = {"shown": "hidden", "hidden": "shown"}
    return "".join(
        button({name: other[now]}, name.capitalize(), pressed=now == "shown")
        for name, now in shown.items()
    )
