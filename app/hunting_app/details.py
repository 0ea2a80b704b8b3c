"""Phase portraits, simulated motions and stability plot: what explains the diagram."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hunting_app import words
from hunting_app.blocks import block, button, column, said
from hunting_app.glossary import term
from hunting_app.markup import Html, text
from hunting_app.motions import Motions
from hunting_app.plots.portraits import Portraits
from hunting_app.plots.stability import Damping, Locus
from hunting_app.state import CURVES

if TYPE_CHECKING:
    from collections.abc import Callable

    from bokeh.models import ColumnDataSource

    from hunting_app.exports.files import Files
    from hunting_app.picture import Picture
    from hunting_app.plots.base import Plot
    from hunting_app.plots.feed import Feed
    from hunting_app.state import State


class Details:
    """The cards beside and below the diagram."""

    def __init__(
        self,
        state: State,
        feed: Feed,
        cursor: ColumnDataSource,
        act: Callable[[dict[str, Any]], None],
        files: Files,
    ) -> None:
        self.state, self.files = state, files
        self.portraits = Portraits(feed)
        self.stability = {"damping": Damping(feed, cursor), "locus": Locus(feed)}
        self.motions = Motions(state, feed, act, files.menu("motion"))
        self.motions.on_reach = self.portraits.include
        self.portraits.follow(self.motions.curves.sources)
        self.plots: list[Plot] = [
            *self.portraits.plots.values(),
            *self.stability.values(),
            *self.motions.plots.values(),
        ]
        self.texts, self.panes = {}, {}
        for name in ("portraits", "stability"):
            self.texts[name], self.panes[name] = text(name)
        self.choice = Html(act)

    def draw(self, shown: Picture) -> None:
        """Draw what holds at every speed."""
        for name, plot in self.stability.items():
            plot.figure.visible = name == self.state.curve
        self.stability[self.state.curve].draw(shown)
        self.choice.html = "".join(
            button({"curve": name}, label, pressed=name == self.state.curve)
            for name, label in CURVES.items()
        ) + term(CURVES[self.state.curve], "?", classes="what")

    def draw_moment(self, shown: Picture, settled: bool) -> None:
        """Draw and say what holds at the chosen speed; what the branch decides, if `settled`."""
        self.stability[self.state.curve].draw_moment(shown)
        self.motions.draw_moment(shown, settled)
        self.texts["stability"].html = said(words.stability(shown))
        if settled:
            self.portraits.draw_moment(shown)
            heading = f"<h2>{term('Phase portraits')}</h2>"
            self.texts["portraits"].html = heading + said(words.portraits(shown))

    def cards(self) -> list[Any]:
        """The cards, for the grid of the page."""
        portraits = [plot.figure for plot in self.portraits.plots.values()]
        curves = [plot.figure for plot in self.stability.values()]
        said_of_curves = self.panes["stability"]
        return [
            block(
                "card portraits",
                self.files.menu("portraits"),
                column("curves abreast", self.panes["portraits"], *portraits),
            ),
            self.motions,
            block(
                "card stability",
                self.files.menu("stability"),
                self.choice,
                column("curves", said_of_curves, *curves),
            ),
        ]
