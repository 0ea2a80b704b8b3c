"""Stability of the centred motion over speed: damping ratios, and the root locus."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from bokeh.models import Span

from hunting_app.numerals import rounded_up
from hunting_app.picture import KMH
from hunting_app.plots.base import Plot

if TYPE_CHECKING:
    from bokeh.models import ColumnDataSource

    from hunting.elements import Phasor
    from hunting_app.picture import Picture
    from hunting_app.plots.feed import Feed

_MODES = ("least", "second", "third")
_CREEP = -60.0  # 1/s; modes that decay faster are creep, far to the left of the locus


class Damping(Plot):
    """Damping ratios over speed, sorted: the least damped mode decides."""

    def __init__(self, feed: Feed, cursor: ColumnDataSource) -> None:
        self.feed = feed
        super().__init__(
            "forward speed V [km/h]",
            "damping ratio ζ [%]",
            "damping",
            "Damping ratio of each mode over forward speed",
        )
        zero = Span(location=0, dimension="width", line_width=1.5)
        self.figure.add_layout(zero)
        self.ink(zero, line_color="hunting")
        self.add("vspan", cursor, {"line_color": "cursor"}, x="x", line_width=1.5)
        self.modes = {v: feed.source("V", *_MODES) for v in ("bogie", "wheelset")}
        self.baseline = {v: feed.source("V", "least") for v in self.modes}
        self._greys = {
            v: self.behind(source, x="V", y="least", line_width=2.5)
            for v, source in self.baseline.items()
        }
        for v, line in self._greys.items():
            self.hover([line], [(f"baseline, {v}, ζ", "@least{0.00} %"), ("at", "@V{0.0} km/h")])
        self.hopf = {v: feed.source("V", "zero") for v in self.modes}
        for v, source in self.modes.items():
            for mode, width in zip(_MODES, (3, 1.5, 1.5), strict=True):
                line = self.add("line", source, {"line_color": v}, x="V", y=mode, line_width=width)
                self.hover([line], [("ζ", f"@{mode}{{0.00}} %"), ("at", "@V{0.0} km/h")])
            dot = {"line_color": v, "fill_color": v}
            self.add("scatter", self.hopf[v], dot, x="V", y="zero", size=10)

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
        for v, source in self.baseline.items():
            there = v in shown.baseline_damping
            self._greys[v].visible = there
            if there:
                least = 100 * shown.baseline_damping[v]
                self.feed.put(source, {"V": shown.speeds, "least": least})
            else:
                self.feed.put(source, {"V": [], "least": []})


class Locus(Plot):
    """Eigenvalues in the upper half plane as the speed rises."""

    def __init__(self, feed: Feed) -> None:
        self.feed = feed
        super().__init__(
            "growth rate Re s [1/s]",
            "Im s / 2π [Hz]",
            "locus",
            "Root locus: eigenvalues of the centred motion as the speed rises",
        )
        axis = Span(location=0, dimension="height", line_width=1.5)
        self.figure.add_layout(axis)
        self.ink(axis, line_color="hunting")
        self.roots = {v: feed.source("re", "im", "V") for v in ("bogie", "wheelset")}
        self.now = {v: feed.source("re", "im") for v in self.roots}
        for v, source in self.roots.items():
            dot = {"line_color": v, "fill_color": v}
            trail = self.add("scatter", source, dot, x="re", y="im", size=2.5)
            self.add(
                "scatter", self.now[v], dot | {"line_color": "cursor"}, x="re", y="im", size=10
            )
            self.hover([trail], [("V", "@V{0.0} km/h"), ("s", "@re{0.00} 1/s, @im{0.00} Hz")])

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
