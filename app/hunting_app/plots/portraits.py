"""Phase portraits of y, psi and z: the limit cycles at the chosen speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hunting_app.numerals import rounded_up
from hunting_app.picture import MM
from hunting_app.plots.base import EXACT, MOTIONS, Plot, joined

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bokeh.models import ColumnDataSource, GlyphRenderer

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


class Portrait(Plot):
    """The plot of one coordinate."""

    def __init__(self, feed: Feed, of: Coordinate, cycles: Cycles) -> None:
        super().__init__(
            feed,
            f"{of.label} [{of.unit}]",
            of.rate,
            f"portrait-{of.symbol}",
            f"Phase portrait, {of.label}",
        )
        self.figure.min_height = 105  # of which a third are labels
        self._at = {"x": of.symbol, "y": f"{of.symbol}'"}
        self._cycles = cycles

    def add_vehicle(self, vehicle: str) -> list[GlyphRenderer]:
        """Add a vehicle's limit cycles, and its centre filled or hollow."""
        stable, unstable, centre = self._cycles.of(vehicle)
        line = {"line_color": vehicle}
        filled, hollow = (line | {"fill_color": fill} for fill in (vehicle, "paper"))
        dashed = {"line_width": 2, "line_dash": [6, 4]}
        return [
            self.add("line", stable, line, EXACT, line_width=2.5, **self._at),
            self.add("line", unstable, line, EXACT, **dashed, **self._at),
            self.add("scatter", centre, filled, EXACT, x="x", y="stable", size=7),
            self.add("scatter", centre, hollow, EXACT, x="x", y="unstable", size=7),
        ]


class Cycles:
    """The sources of each vehicle's limit cycles at the chosen speed; all portraits share them."""

    def __init__(self, feed: Feed) -> None:
        self.feed = feed
        self.stable: dict[str, ColumnDataSource] = {}
        self.unstable: dict[str, ColumnDataSource] = {}
        self.centre: dict[str, ColumnDataSource] = {}

    def of(self, vehicle: str) -> tuple[ColumnDataSource, ColumnDataSource, ColumnDataSource]:
        """Return the stable cycles, the unstable ones and the centre."""
        if vehicle not in self.stable:
            self.stable[vehicle] = self.feed.source(*_COLUMNS)
            self.unstable[vehicle] = self.feed.source(*_COLUMNS)
            self.centre[vehicle] = self.feed.source("x", "stable", "unstable")
        return self.stable[vehicle], self.unstable[vehicle], self.centre[vehicle]

    def put(self, shown: Picture) -> None:
        """Show the cycles of the vehicles that are shown."""
        for vehicle, centre in self.centre.items():
            moment = shown.moments.get(vehicle)
            for sources, kind in ((self.stable, True), (self.unstable, False)):
                self.feed.put(sources[vehicle], _cycles(shown, vehicle, kind))
            at_rest = [0.0] if moment else []
            is_stable = moment is not None and moment.centre_is_stable
            nowhere = [np.nan] * len(at_rest)
            marks = (at_rest, nowhere) if is_stable else (nowhere, at_rest)
            self.feed.put(centre, {"x": at_rest, "stable": marks[0], "unstable": marks[1]})


class Portraits:
    """One plot for each coordinate."""

    def __init__(self, feed: Feed) -> None:
        self.feed = feed
        self.cycles = Cycles(feed)
        self.clearance = feed.source("x")
        self.plots: dict[str, Plot] = {
            c.symbol: Portrait(feed, c, self.cycles) for c in COORDINATES
        }
        self.plots["y"].add(
            "vspan", self.clearance, {"line_color": "clearance"}, x="x", line_dash="dotted",
            line_width=1.5,
        )  # fmt: skip
        self._reached = dict.fromkeys(_COLUMNS, 0.0)
        self._motions: dict[str, float] = {}

    def follow(self, motions: dict[str, ColumnDataSource]) -> None:
        """Draw simulated motions on top."""
        for c in COORDINATES:
            for role, source in reversed(motions.items()):
                self.plots[c.symbol].add(
                    "line", source, {"line_color": role}, MOTIONS, x=c.symbol, y=f"{c.symbol}'",
                    line_width=1, line_alpha=0.75,
                )  # fmt: skip

    def draw_moment(self, shown: Picture) -> None:
        """Draw the cycles at the chosen speed; without any, the axes follow the clearance."""
        self.cycles.put(shown)
        known = {s for one in shown.answers.values() for s in one.branch.system.symbols}
        for symbol, plot in self.plots.items():
            plot.figure.visible = symbol in known  # a wheelset has no frame
        delta = shown.clearance
        self.feed.put(self.clearance, {"x": [-delta, delta]})
        reach = dict.fromkeys(_COLUMNS, 0.0)
        reach["y"] = delta
        for _, _, values in _all_columns(shown):
            for symbol, column in values.items():
                reach[symbol] = max(reach[symbol], MM * float(np.abs(column).max()))
        self._reached = reach
        self._frame()

    def include(self, reach: dict[str, float]) -> None:
        """Make room for motions that reach so far [mm, mrad or per second], by symbol."""
        self._motions = reach
        self._frame()

    def _frame(self) -> None:
        reach = {s: max(size, self._motions.get(s, 0.0)) for s, size in self._reached.items()}
        for symbol, plot in self.plots.items():
            x, y = (rounded_up(1.1 * reach[s]) if reach[s] else 1.0 for s in (symbol, f"{symbol}'"))
            plot.frame((-x, x), (-y, y))


def _all_columns(shown: Picture) -> Iterator[tuple[str, bool, dict]]:
    """Yield vehicle, stability and states by symbol of every cycle at the chosen speed."""
    for vehicle, moment in shown.moments.items():
        symbols = shown.answers[vehicle].branch.system.symbols
        for cycle in moment.cycles:
            yield vehicle, cycle.stable, dict(zip(symbols, cycle.motion.state.T, strict=True))


def _cycles(shown: Picture, vehicle: str, stable: bool) -> Columns:
    """Return the sources' columns; a state that the vehicle does not have rests."""
    found = [x for name, kind, x in _all_columns(shown) if (name, kind) == (vehicle, stable)]
    return {
        symbol: joined([MM * x.get(symbol, np.zeros_like(x["y"])) for x in found])
        for symbol in _COLUMNS
    }
