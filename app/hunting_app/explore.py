"""The Explore page: answers and plots. It only draws; the numbers come in a picture."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import panel as pn
from bokeh.models import Column

from hunting_app import words
from hunting_app.html import Html, text
from hunting_app.palette import palette
from hunting_app.picture import picture
from hunting_app.plots.bifurcation import Bifurcation
from hunting_app.plots.feed import Feed
from hunting_app.plots.portraits import Portraits
from hunting_app.plots.stability import Damping, Locus
from hunting_app.state import State

if TYPE_CHECKING:
    from collections.abc import Callable

    from bokeh.models import UIElement

    from hunting_app.picture import Picture
    from hunting_app.plots.base import Plot

LAYOUT = (Path(__file__).parent / "layout.css").read_text(encoding="utf-8")


class Explore:
    """Answers, bifurcation diagram, phase portraits and stability plot of one session."""

    def __init__(self, state: State, act: Callable[[dict[str, Any]], None]) -> None:
        self.state = state
        self.feed = feed = Feed()
        self.bifurcation = Bifurcation(feed)
        self.portraits = Portraits(feed)
        self.stability = {"damping": Damping(feed, self.bifurcation.cursor), "locus": Locus(feed)}
        feed.connect(self.bifurcation.figure)
        self.plots: list[Plot] = [
            self.bifurcation,
            *self.portraits.plots.values(),
            *self.stability.values(),
        ]
        self.texts, self.panes = {}, {}
        for name in ("answers", "bifurcation", "portraits", "stability"):
            self.texts[name], self.panes[name] = text(name)
        self.choice = Html(act)
        self._drawn: tuple[Any, ...] = ()
        self._dressed: bool | None = None
        self._vehicles: set[str] = set()
        self.draw()
        state.param.watch(
            lambda *_: self.draw(), ["parameters", "vehicle", "speed", "curve", "dark"]
        )

    def draw(self) -> None:
        """Bring everything up to date; what has not changed is left alone."""
        state = self.state
        shown = picture(state.parameters, state.vehicle, state.speed)
        colours = palette(state.dark)
        if self._dressed != state.dark:
            for plot in self.plots:
                plot.dress(colours)
            self._dressed = state.dark
        wanted = (state.parameters, state.vehicle, state.curve, float(shown.speeds[-1]))
        if self._drawn != wanted:
            self._draw_curves(shown)
            self._drawn = wanted
        self.bifurcation.draw_moment(shown)
        self.portraits.draw_moment(shown)
        self.stability[state.curve].draw_moment(shown)
        self.feed.send()
        self._write(shown)

    def _draw_curves(self, shown: Picture) -> None:
        if set(shown.answers) != self._vehicles:
            self._vehicles = set(shown.answers)
            for plot in self.plots:
                plot.show_vehicles(self._vehicles)
        self.bifurcation.draw(shown)
        for name, plot in self.stability.items():
            plot.figure.visible = name == self.state.curve
        self.stability[self.state.curve].draw(shown)
        self.texts["answers"].html = words.answers(shown)
        self.choice.html = _CURVE_CHOICE[self.state.curve]

    def _write(self, shown: Picture) -> None:
        warned = "".join(f'<p class="warning">{escape(w)}</p>' for w in words.warnings(shown))
        said = {
            "bifurcation": "<h2>Bifurcation diagram</h2>"
            + _said(words.diagram(shown))
            + warned
            + words.legend(shown),
            "portraits": "<h2>Phase portraits</h2>" + _said(words.portraits(shown)),
            "stability": _said(words.stability(shown)),
        }
        for name, html in said.items():
            self.texts[name].html = html

    def __panel__(self) -> pn.viewable.Viewable:
        """Answers on top, the diagram left, portraits right, stability below."""
        panes = self.panes
        portraits = [plot.figure for plot in self.portraits.plots.values()]
        curves = [plot.figure for plot in self.stability.values()]
        return block(
            "explore",
            _column("strip", panes["answers"]),
            _column("card diagram", panes["bifurcation"], self.bifurcation.figure),
            _column("card portraits", panes["portraits"], *portraits),
            block("card stability", self.choice, _column("curves", panes["stability"], *curves)),
        )


def _column(classes: str, *children: UIElement) -> Column:
    """A part of the page made of bare Bokeh models."""
    return Column(
        *children,
        css_classes=classes.split(),
        stylesheets=[LAYOUT],
        sizing_mode="stretch_both",
    )


def _said(sentence: str) -> str:
    return f"<p>{escape(sentence)}</p>"


def _button(curve: str, label: str, chosen: str) -> str:
    act = escape(f'{{"curve": "{curve}"}}')
    return (
        f'<button data-act="{act}" aria-pressed="{str(curve == chosen).lower()}">{label}</button>'
    )


_CURVE_CHOICE = {
    chosen: _button("damping", "Damping ratio", chosen) + _button("locus", "Root locus", chosen)
    for chosen in ("damping", "locus")
}


def block(classes: str, *objects: Any) -> pn.Column:
    """A part of the page, laid out by layout.css."""
    return pn.Column(
        *objects,
        css_classes=classes.split(),
        stylesheets=[LAYOUT],
        sizing_mode="stretch_both",
        margin=0,
    )
