"""Bifurcation diagram: amplitude of the limit cycles over forward speed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from hunting_app.numerals import rounded_up
from hunting_app.picture import KMH, MM
from hunting_app.plots.base import Plot

if TYPE_CHECKING:
    from hunting.branch import Branch
    from hunting_app.picture import Answers, Picture
    from hunting_app.plots.feed import Columns, Feed

_ZONES = ("safe", "conditional", "hunting")


class Bifurcation(Plot):
    """Stable branches solid, unstable ones dashed, over the zones of the first vehicle."""

    def __init__(self, feed: Feed) -> None:
        self.feed = feed
        super().__init__(
            "forward speed V [km/h]",
            "amplitude, peak |y| [mm]",
            "bifurcation",
            "Bifurcation diagram: amplitude of the limit cycles over forward speed",
        )
        self.zones = {zone: feed.source("left", "right") for zone in _ZONES}
        self.clearance = feed.source("y")
        self.cursor = feed.source("x")
        self.branches = {v: feed.source("V", "stable", "unstable") for v in ("bogie", "wheelset")}
        self.averaged = {v: feed.source("V", "stable", "unstable") for v in self.branches}
        self.averaged_folds = {v: feed.source("V", "a") for v in self.branches}
        self.hopf = {v: feed.source("V", "a") for v in self.branches}
        self.folds = {v: feed.source("V", "a") for v in self.branches}
        self.cycles = {v: feed.source("V", "stable", "unstable") for v in self.branches}
        self.baseline = {v: feed.source("V", "stable", "unstable") for v in self.branches}
        self._draw_background()
        self._greys = {v: self._add_baseline(v) for v in self.branches}
        for vehicle in self.branches:
            self._draw_averaged(vehicle)
        for vehicle in self.branches:
            self._draw_vehicle(vehicle)

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

    def _add_baseline(self, v: str) -> list[Any]:
        stable, unstable = (
            self.behind(self.baseline[v], x="V", y=column, line_width=3, line_dash=dash)
            for column, dash in (("stable", []), ("unstable", [7, 5]))
        )
        for line, column in ((stable, "stable"), (unstable, "unstable")):
            label = f"baseline, {v}, {column} cycle"
            self.hover([line], [(label, f"@{column}{{0.00}} mm"), ("at", "@V{0.0} km/h")])
        return [stable, unstable]

    def _draw_averaged(self, v: str) -> None:
        source, colour = self.averaged[v], {"line_color": "averaged"}
        diamond = colour | {"fill_color": "averaged"}
        made = [
            self.add("line", source, colour, x="V", y="stable", line_width=1.5),
            self.add("line", source, colour, x="V", y="unstable", line_width=1.5, line_dash=[6, 4]),
            self.add(
                "scatter", self.averaged_folds[v], diamond, x="V", y="a", size=9, marker="diamond"
            ),
        ]
        self._of_vehicle += [(renderer, v) for renderer in made]
        for line, column in zip(made[:2], ("stable", "unstable"), strict=True):
            label = f"{v}, {column}, averaged"
            self.hover([line], [(label, f"@{column}{{0.00}} mm"), ("at", "@V{0.0} km/h")])

    def _draw_vehicle(self, v: str) -> None:
        colour, filled = {"line_color": v}, {"line_color": v, "fill_color": v}
        hollow = {"line_color": v, "fill_color": "paper"}
        branch, cycles = self.branches[v], self.cycles[v]
        stable = self.add("line", branch, colour, x="V", y="stable", line_width=3)
        unstable = self.add(
            "line", branch, colour, x="V", y="unstable", line_width=2.5, line_dash=[7, 5]
        )
        self.add("scatter", self.hopf[v], filled, x="V", y="a", size=10)
        self.add("scatter", self.folds[v], filled, x="V", y="a", size=13, marker="diamond")
        self.add("scatter", cycles, filled, x="V", y="stable", size=8, marker="square")
        self.add("scatter", cycles, hollow, x="V", y="unstable", size=8, marker="square")
        for line, column in ((stable, "stable"), (unstable, "unstable")):
            label = f"{v}, {column} cycle, exact"
            self.hover([line], [(label, f"@{column}{{0.00}} mm"), ("at", "@V{0.0} km/h")])

    def draw(self, shown: Picture, averaging: bool = True, settled: bool = True) -> None:
        """Draw branches, points and zones.

        The averaged branch only if it is wanted; what follows from the exact one only if that is
        `settled`, else it stays as it is.
        """
        for vehicle in self.branches:
            answers = shown.answers.get(vehicle)
            exact = answers.exact if answers else None
            averaged = answers.averaged if answers and averaging else None
            if settled:
                self.feed.put(self.branches[vehicle], branch_columns(exact))
                self.feed.put(self.folds[vehicle], _fold(exact))
            self.feed.put(self.averaged[vehicle], branch_columns(averaged))
            self.feed.put(self.averaged_folds[vehicle], _fold(averaged))
            self.feed.put(self.hopf[vehicle], _hopf(answers))
        end = float(shown.speeds[-1])
        zones = _zones(next(iter(shown.answers.values())), end)
        for zone, source in self.zones.items() if settled else ():
            here = [(low, high) for name, low, high in zones if name == zone]
            self.feed.put(
                source, {"left": [low for low, _ in here], "right": [high for _, high in here]}
            )
        delta = shown.clearance
        self.feed.put(self.clearance, {"y": [delta]})
        self.frame((0, end), (0, rounded_up(1.2 * max(delta, shown.baseline_clearance))))

    def draw_baseline(self, shown: Picture) -> None:
        """Draw the baseline's branches: the exact one, or the averaged one if that is hidden."""
        for vehicle, source in self.baseline.items():
            answers = shown.baseline.get(vehicle)
            self.feed.put(source, branch_columns(answers.branch if answers else None))
            for line in self._greys[vehicle]:
                line.visible = answers is not None

    def draw_moment(self, shown: Picture, settled: bool = True) -> None:
        """Draw the cursor, and the cycles it meets if what decides on them is `settled`."""
        self.feed.put(self.cursor, {"x": [shown.speed]})
        for vehicle, source in self.cycles.items() if settled else ():
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
