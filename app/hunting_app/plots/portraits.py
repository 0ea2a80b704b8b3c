"""Phase portraits of y, psi and z: the limit cycles at the chosen speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hunting_app.numerals import rounded_up
from hunting_app.picture import MM
from hunting_app.plots.base import Plot, joined

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bokeh.models import ColumnDataSource

    from hunting_app.picture import Picture
    from hunting_app.plots.feed import Columns, Feed


class Coordinate(NamedTuple):
    """A displacement or an angle and its rate, by the symbols of `LureSystem.states`."""

    symbol: str
    label: str
    unit: str
    rate: str


COORDINATES = (
    Coordinate("y", "lateral displacement y", "mm", "y′ [mm/s]"),
    Coordinate("ψ", "yaw angle ψ", "mrad", "ψ′ [mrad/s]"),
    Coordinate("z", "frame displacement z", "mm", "z′ [mm/s]"),
)
_COLUMNS = tuple(name for c in COORDINATES for name in (c.symbol, f"{c.symbol}'"))


class Portraits:
    """One plot for each coordinate; they share the sources."""

    def __init__(self, feed: Feed) -> None:
        self.feed = feed
        names = ("bogie", "wheelset")
        self.stable = {v: feed.source(*_COLUMNS) for v in names}
        self.unstable = {v: feed.source(*_COLUMNS) for v in names}
        self.centre = {v: feed.source("x", "stable", "unstable") for v in names}
        self.clearance = feed.source("x")
        self.plots = {c.symbol: self._plot(c) for c in COORDINATES}
        self._cycles = dict.fromkeys(_COLUMNS, 0.0)
        self._motions: dict[str, float] = {}

    def _plot(self, c: Coordinate) -> Plot:
        plot = Plot(
            f"{c.label} [{c.unit}]", c.rate, f"portrait-{c.symbol}", f"Phase portrait, {c.label}"
        )
        plot.figure.min_height = 105  # of which a third are labels
        if c.symbol == "y":
            plot.add(
                "vspan", self.clearance, {"line_color": "clearance"}, x="x", line_dash="dotted",
                line_width=1.5,
            )  # fmt: skip
        at = {"x": c.symbol, "y": f"{c.symbol}'"}
        for v in self.stable:
            line = {"line_color": v}
            plot.add("line", self.stable[v], line, **at, line_width=2.5)
            plot.add("line", self.unstable[v], line, **at, line_width=2, line_dash=[6, 4])
            filled, hollow = line | {"fill_color": v}, line | {"fill_color": "paper"}
            plot.add("scatter", self.centre[v], filled, x="x", y="stable", size=7)
            plot.add("scatter", self.centre[v], hollow, x="x", y="unstable", size=7)
        return plot

    def follow(self, motions: dict[str, ColumnDataSource]) -> None:
        """Draw simulated motions on top."""
        for c in COORDINATES:
            for role, source in reversed(motions.items()):
                self.plots[c.symbol].add(
                    "line", source, {"line_color": role}, x=c.symbol, y=f"{c.symbol}'",
                    line_width=1, line_alpha=0.75,
                )  # fmt: skip

    def draw_moment(self, shown: Picture) -> None:
        """Draw the cycles at the chosen speed; without any, the axes follow the clearance."""
        for vehicle in self.stable:
            moment = shown.moments.get(vehicle)
            for sources, kind in ((self.stable, True), (self.unstable, False)):
                self.feed.put(sources[vehicle], _cycles(shown, vehicle, kind))
            at_rest = [0.0] if moment else []
            is_stable = moment is not None and moment.centre_is_stable
            nowhere = [np.nan] * len(at_rest)
            marks = (at_rest, nowhere) if is_stable else (nowhere, at_rest)
            self.feed.put(
                self.centre[vehicle], {"x": at_rest, "stable": marks[0], "unstable": marks[1]}
            )
        delta = shown.clearance
        self.feed.put(self.clearance, {"x": [-delta, delta]})
        reach = dict.fromkeys(_COLUMNS, 0.0)
        reach["y"] = delta
        for _, _, values in _all_columns(shown):
            for symbol, column in values.items():
                reach[symbol] = max(reach[symbol], MM * float(np.abs(column).max()))
        self._cycles = reach
        self._frame()

    def include(self, reach: dict[str, float]) -> None:
        """Make room for motions that reach so far [mm, mrad or per second], by symbol."""
        self._motions = reach
        self._frame()

    def _frame(self) -> None:
        reach = {s: max(size, self._motions.get(s, 0.0)) for s, size in self._cycles.items()}
        for symbol, plot in self.plots.items():
            x, y = (rounded_up(1.1 * reach[s]) if reach[s] else 1.0 for s in (symbol, f"{symbol}'"))
            plot.frame((-x, x), (-y, y))


def _all_columns(shown: Picture) -> Iterator[tuple[str, bool, dict]]:
    """Yield vehicle, stability and states by symbol of every cycle at the chosen speed."""
    for vehicle, moment in shown.moments.items():
        symbols = [state.symbol for state in shown.answers[vehicle].branch.system.states]
        for cycle in moment.cycles:
            yield vehicle, cycle.stable, dict(zip(symbols, cycle.motion.state.T, strict=True))


def _cycles(shown: Picture, vehicle: str, stable: bool) -> Columns:
    """Return the sources' columns; a state that the vehicle does not have rests."""
    found = [x for name, kind, x in _all_columns(shown) if (name, kind) == (vehicle, stable)]
    return {
        symbol: joined([MM * x.get(symbol, np.zeros_like(x["y"])) for x in found])
        for symbol in _COLUMNS
    }
