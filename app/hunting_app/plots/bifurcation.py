"""Bifurcation diagram: amplitude of the limit cycles over forward speed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from hunting_app.numerals import rounded_up
from hunting_app.picture import KMH, MM
from hunting_app.plots.base import AVERAGED, BASELINE, EXACT, Plot

if TYPE_CHECKING:
    from bokeh.models import ColumnDataSource, GlyphRenderer

    from hunting.branch import Branch
    from hunting_app.picture import Answers, Picture
    from hunting_app.plots.feed import Columns, Feed

_ZONES = ("safe", "conditional", "hunting")
_UNDER_THE_POINTER = "<b>$name</b><br>$snap_y{0.00} mm at $snap_x{0.0} km/h"


class Bifurcation(Plot):
    """Stable branches solid, unstable ones dashed, over the zones of the first vehicle."""

    def __init__(self, feed: Feed) -> None:
        super().__init__(
            feed,
            "forward speed V [km/h]",
            "amplitude, peak |y| [mm]",
            "bifurcation",
            "Bifurcation diagram: amplitude of the limit cycles over forward speed",
        )
        self.zones = {zone: feed.source("left", "right") for zone in _ZONES}
        self.clearance = feed.source("y")
        self.cursor = feed.source("x")
        self.branches: dict[str, ColumnDataSource] = {}
        self.averaged: dict[str, ColumnDataSource] = {}
        self.averaged_folds: dict[str, ColumnDataSource] = {}
        self.hopf: dict[str, ColumnDataSource] = {}
        self.folds: dict[str, ColumnDataSource] = {}
        self.cycles: dict[str, ColumnDataSource] = {}
        self.baseline: dict[str, ColumnDataSource] = {}
        self._draw_background()

    def _draw_background(self) -> None:
        for zone, source in self.zones.items():
            self.add(
                "vstrip", source, {"fill_color": zone}, x0="left", x1="right",
                fill_alpha=0.16, line_color=None,
            )  # fmt: skip
        self.add(
            "hspan", self.clearance, {"line_color": "clearance"}, y="y", line_dash="dotted",
            line_width=1.5,
        )  # fmt: skip
        self.add("vspan", self.cursor, {"line_color": "cursor"}, x="x", line_width=1.5)

    def add_baseline(self, vehicle: str) -> list[GlyphRenderer]:
        """Add the branch of a baseline."""
        source = self.baseline[vehicle] = self.feed.source("V", "stable", "unstable")
        look = {"line_width": 3, "layer": BASELINE}
        return self._add_branch(source, "baseline", f"baseline, {vehicle}, {{}} cycle", look)

    def add_vehicle(self, vehicle: str) -> list[GlyphRenderer]:
        """Add a vehicle's branches and their points."""
        return self._add_averaged(vehicle) + self._add_exact(vehicle)

    def _add_averaged(self, v: str) -> list[GlyphRenderer]:
        self.averaged[v] = self.feed.source("V", "stable", "unstable")
        self.averaged_folds[v] = self.feed.source("V", "a")
        look = {"line_width": 1.5, "layer": AVERAGED}
        return [
            *self._add_branch(self.averaged[v], "averaged", f"{v}, {{}}, averaged", look),
            self.add(
                "scatter", self.averaged_folds[v],
                {"line_color": "averaged", "fill_color": "averaged"}, AVERAGED,
                x="V", y="a", size=9, marker="diamond",
            ),
        ]  # fmt: skip

    def _add_exact(self, v: str) -> list[GlyphRenderer]:
        filled, hollow = ({"line_color": v, "fill_color": fill} for fill in (v, "paper"))
        branch = self.branches[v] = self.feed.source("V", "stable", "unstable")
        cycles = self.cycles[v] = self.feed.source("V", "stable", "unstable")
        self.hopf[v], self.folds[v] = self.feed.source("V", "a"), self.feed.source("V", "a")
        square = {"x": "V", "size": 8, "marker": "square"}
        look = {"line_width": 3, "layer": EXACT}
        return [
            *self._add_branch(branch, v, f"{v}, {{}} cycle, exact", look),
            self.add("scatter", self.hopf[v], filled, EXACT, x="V", y="a", size=10),
            self.add(
                "scatter", self.folds[v], filled, EXACT, x="V", y="a", size=13, marker="diamond"
            ),
            self.add("scatter", cycles, filled, EXACT, y="stable", **square),
            self.add("scatter", cycles, hollow, EXACT, y="unstable", **square),
        ]

    def _add_branch(
        self, source: ColumnDataSource, ink: str, name: str, look: dict[str, Any]
    ) -> list[GlyphRenderer]:
        """Add its stable part, solid, and its unstable one, dashed."""
        made = []
        for column, dash in (("stable", []), ("unstable", [7, 5])):
            line = self.add(
                "line", source, {"line_color": ink}, x="V", y=column, line_dash=dash, **look
            )
            self.hover(line, name.format(column), _UNDER_THE_POINTER)
            made.append(line)
        return made

    def draw(self, shown: Picture, averaging: bool = True) -> None:
        """Draw branches, points and zones; the averaged branch only if it is wanted."""
        for vehicle in self.branches:
            answers = shown.answers.get(vehicle)
            exact = answers.exact if answers else None
            averaged = answers.averaged if answers and averaging else None
            self.feed.put(self.branches[vehicle], branch_columns(exact))
            self.feed.put(self.folds[vehicle], _fold(exact))
            self.feed.put(self.averaged[vehicle], branch_columns(averaged))
            self.feed.put(self.averaged_folds[vehicle], _fold(averaged))
            self.feed.put(self.hopf[vehicle], _hopf(answers))
        end = float(shown.speeds[-1])
        zones = _zones(next(iter(shown.answers.values())), end)
        for zone, source in self.zones.items():
            here = [(low, high) for name, low, high in zones if name == zone]
            self.feed.put(
                source, {"left": [low for low, _ in here], "right": [high for _, high in here]}
            )
        delta = shown.clearance
        self.feed.put(self.clearance, {"y": [delta]})
        self.frame((0, end), (0, rounded_up(1.2 * max(delta, shown.baseline_clearance))))

    def draw_baseline(self, shown: Picture) -> None:
        """Draw the baseline's branches: the exact one, or the averaged one if that is hidden."""
        super().draw_baseline(shown)
        for vehicle, source in self.baseline.items():
            answers = shown.baseline.get(vehicle)
            self.feed.put(source, branch_columns(answers.branch if answers else None))

    def draw_moment(self, shown: Picture) -> None:
        """Draw the cursor and the cycles it meets."""
        self.feed.put(self.cursor, {"x": [shown.speed]})
        for vehicle, source in self.cycles.items():
            moment = shown.moments.get(vehicle)
            cycles = moment.cycles if moment else []
            marks = {
                "V": [shown.speed] * len(cycles),
                "stable": [MM * c.amplitude if c.stable else math.nan for c in cycles],
                "unstable": [math.nan if c.stable else MM * c.amplitude for c in cycles],
            }
            self.feed.put(source, marks)


def branch_columns(branch: Branch | None) -> Columns:
    """Return a branch [km/h, mm] as two curves that meet: the stable part and the unstable."""
    if branch is None or not branch.speed.size:
        return {"V": [], "stable": [], "unstable": []}
    amplitude, stable = MM * branch.amplitude, branch.stable
    touches_unstable = ~stable
    touches_unstable[1:] |= ~stable[:-1]  # so that the two curves meet
    return {
        "V": KMH * branch.speed,
        "stable": np.where(stable, amplitude, np.nan),
        "unstable": np.where(touches_unstable, amplitude, np.nan),
    }


def _hopf(answers: Answers | None) -> Columns:
    speeds = (KMH * answers.hopf.speed).tolist() if answers else []
    return {"V": speeds, "a": [0.0] * len(speeds)}


def _fold(branch: Branch | None) -> Columns:
    if branch is None or branch.fold is None:
        return {"V": [], "a": []}
    speed, amplitude = branch.fold
    return {"V": [KMH * float(speed)], "a": [MM * float(amplitude)]}


def _zones(answers: Answers, end: float) -> list[tuple[str, float, float]]:
    """Return (zone, from, to) [km/h]; nothing where the model has no answer."""
    if answers.unstable_everywhere:
        return [("hunting", 0.0, end)]
    linear = KMH * float(answers.critical.linear)
    if not math.isfinite(linear):
        return []
    zones = [("conditional", answers.lowest, linear), ("hunting", linear, end)]
    zones += [("hunting", KMH * low, KMH * high) for low, high in answers.critical.windows]
    start = 0.0
    for low, high in [*answers.critical.windows, (answers.lowest / KMH, 0.0)]:
        zones.append(("safe", start, KMH * low))
        start = KMH * high
    return [(zone, low, high) for zone, low, high in zones if high > low]
