"""Stability of the centred motion over speed: damping ratios, and the root locus."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from bokeh.models import Span

from hunting_app.numerals import rounded_up
from hunting_app.picture import KMH
from hunting_app.plots.base import BASELINE, EXACT, Plot

if TYPE_CHECKING:
    from bokeh.models import ColumnDataSource, GlyphRenderer

    from hunting.elements import Phasor
    from hunting_app.picture import Picture
    from hunting_app.plots.feed import Feed

_MODES = ("least", "second", "third")
_UNDER_THE_POINTER = "<b>$name</b><br>ζ = $snap_y{0.00} % at $snap_x{0.0} km/h"
_CREEP = -60.0  # 1/s; modes that decay faster are creep, far to the left of the locus


class Damping(Plot):
    """Damping ratios over speed, sorted: the least damped mode decides."""

    def __init__(self, feed: Feed, cursor: ColumnDataSource) -> None:
        super().__init__(
            feed,
            "forward speed V [km/h]",
            "damping ratio ζ [%]",
            "damping",
            "Damping ratio of each mode over forward speed",
        )
        zero = Span(location=0, dimension="width", line_width=1.5)
        self.figure.add_layout(zero)
        self.ink(zero, line_color="hunting")
        self.add("vspan", cursor, {"line_color": "cursor"}, x="x", line_width=1.5)
        self.modes: dict[str, ColumnDataSource] = {}
        self.baseline: dict[str, ColumnDataSource] = {}
        self.hopf: dict[str, ColumnDataSource] = {}

    def add_baseline(self, vehicle: str) -> list[GlyphRenderer]:
        """Add the least damped mode of a baseline."""
        source = self.baseline[vehicle] = self.feed.source("V", "least")
        grey = {"line_color": "baseline"}
        line = self.add("line", source, grey, BASELINE, x="V", y="least", line_width=2.5)
        self.hover(line, f"baseline, {vehicle}", _UNDER_THE_POINTER)
        return [line]

    def add_vehicle(self, vehicle: str) -> list[GlyphRenderer]:
        """Add a vehicle's modes and Hopf points."""
        source = self.modes[vehicle] = self.feed.source("V", *_MODES)
        self.hopf[vehicle] = self.feed.source("V", "zero")
        ink = {"line_color": vehicle}
        lines = [
            self.add("line", source, ink, EXACT, x="V", y=mode, line_width=width)
            for mode, width in zip(_MODES, (3, 1.5, 1.5), strict=True)
        ]
        for line, mode in zip(lines, _MODES, strict=True):
            self.hover(line, f"{vehicle}, {mode} damped mode", _UNDER_THE_POINTER)
        dot = ink | {"fill_color": vehicle}
        return [
            *lines,
            self.add("scatter", self.hopf[vehicle], dot, EXACT, x="V", y="zero", size=10),
        ]

    def draw(self, shown: Picture) -> None:
        """Draw all modes; the axis is chosen for the least damped one."""
        low, high = 0.0, 0.0
        for v, source in self.modes.items():
            if v not in shown.sweeps:
                self.feed.put(source, {name: [] for name in ("V", *_MODES)})
                self.feed.put(self.hopf[v], {"V": [], "zero": []})
                continue
            ratios = 100 * shown.damping[v]
            last = ratios.shape[-1] - 1
            modes = {mode: ratios[:, min(2 * k, last)] for k, mode in enumerate(_MODES)}
            self.feed.put(source, {"V": shown.speeds, **modes})
            speeds = (KMH * shown.answers[v].hopf.speed).tolist()
            self.feed.put(self.hopf[v], {"V": speeds, "zero": [0.0] * len(speeds)})
            low, high = min(low, ratios[:, 0].min()), max(high, ratios[:, 0].max())
        reach = max(rounded_up(1.15 * high), 1.0)
        self.frame(
            (0, float(shown.speeds[-1])), (-min(rounded_up(max(-1.1 * low, 0.3)), reach), reach)
        )

    def draw_baseline(self, shown: Picture) -> None:
        """Draw the least damped mode of the baseline."""
        super().draw_baseline(shown)
        for v, source in self.baseline.items():
            if v in shown.baseline_damping:
                least = 100 * shown.baseline_damping[v]
                self.feed.put(source, {"V": shown.speeds, "least": least})
            else:
                self.feed.put(source, {"V": [], "least": []})


class Locus(Plot):
    """Eigenvalues in the upper half plane as the speed rises."""

    def __init__(self, feed: Feed) -> None:
        super().__init__(
            feed,
            "growth rate Re s [1/s]",
            "Im s / 2π [Hz]",
            "locus",
            "Root locus: eigenvalues of the centred motion as the speed rises",
        )
        axis = Span(location=0, dimension="height", line_width=1.5)
        self.figure.add_layout(axis)
        self.ink(axis, line_color="hunting")
        self.roots: dict[str, ColumnDataSource] = {}
        self.now: dict[str, ColumnDataSource] = {}

    def add_vehicle(self, vehicle: str) -> list[GlyphRenderer]:
        """Add a vehicle's eigenvalues, and those at the chosen speed."""
        roots = self.roots[vehicle] = self.feed.source("re", "im", "V")
        now = self.now[vehicle] = self.feed.source("re", "im")
        dot = {"line_color": vehicle, "fill_color": vehicle}
        ring = dot | {"line_color": "cursor"}
        trail = self.add("scatter", roots, dot, EXACT, x="re", y="im", size=2.5)
        self.hover(trail, vehicle, "<b>$name</b><br>@re{0.00} 1/s, @im{0.00} Hz at @V{0.0} km/h")
        return [trail, self.add("scatter", now, ring, EXACT, x="re", y="im", size=10)]

    def draw(self, shown: Picture) -> None:
        """Draw the whole locus."""
        left, right, top = 0.0, 0.0, 0.0
        for v, source in self.roots.items():
            sweep = shown.sweeps.get(v)
            if sweep is None:
                self.feed.put(source, {"re": [], "im": [], "V": []})
                continue
            slow = _oscillating(sweep)
            speeds = np.broadcast_to(shown.speeds[:, None], sweep.shape)
            s = sweep[slow]
            trail = {"re": s.real, "im": s.imag / (2 * np.pi), "V": speeds[slow]}
            self.feed.put(source, trail)
            if s.size:
                left, right = min(left, s.real.min()), max(right, s.real.max())
                top = max(top, s.imag.max() / (2 * np.pi))
        reach = rounded_up(-1.05 * left)
        self.frame((-reach, max(rounded_up(1.3 * right), 0.1 * reach)), (0, rounded_up(1.1 * top)))

    def draw_moment(self, shown: Picture) -> None:
        """Mark the eigenvalues at the chosen speed."""
        for v, source in self.now.items():
            moment = shown.moments.get(v)
            s = (
                moment.eigenvalues[_oscillating(moment.eigenvalues)]
                if moment
                else np.zeros(0, complex)
            )
            self.feed.put(source, {"re": s.real, "im": s.imag / (2 * np.pi)})


def _oscillating(s: Phasor) -> Phasor:
    return (s.imag > 0) & (s.real > _CREEP)
