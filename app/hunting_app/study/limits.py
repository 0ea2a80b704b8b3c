"""How likely a vehicle hunts whose parameters are known only within limits."""

from __future__ import annotations

from concurrent.futures import Executor
from html import escape
from typing import Any

import holoviews as hv
import numpy as np

from hunting.cases import Progress
from hunting.uncertainty import Indices, uncertainty
from hunting_app.palette import Palette
from hunting_app.picture import KMH
from hunting_app.state import FIELDS
from hunting_app.study.bars import bars, height_of
from hunting_app.study.choices import METHODS, number, select, ticks
from hunting_app.study.dress import dressed, shown
from hunting_app.study.section import Section, part

_SAMPLES = {f"{n:,}": n for n in (1_000, 10_000, 100_000)}
_KNOWN_BADLY = ["lam", "Ky", "Cy", "Kpsi", "f11", "f33", "C1", "C2", "delta"]
_HEIGHT = 380


class Limits(Section):
    """Distribution of the critical speeds."""

    key = "uncertainty"
    label = "Uncertainty"
    call = "Draw the samples"
    things = "samples"
    explained = (
        "No parameter is known exactly: conicity wears, rubber ages. Tick those that are "
        "uncertain and say by how much. Many designs are drawn, every value between these limits "
        "as likely as any other; the histogram shows how often each critical speed comes out. "
        "Where part of it lies left of the operating speed, such a vehicle can be made to hunt in "
        "service."
    )

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.spread = number("limits, ± [%]", 10.0, 0.1, 95.0)
        self.operating = number("operating speed [km/h]", 130.0, 1.0, 1440.0, 5.0)
        self.samples = select("samples", _SAMPLES, 10_000)
        self.method = select("method", METHODS, "averaging")
        self.names = ticks("uncertain parameters", _KNOWN_BADLY)
        self.controls[:] = [self.spread, self.operating, self.samples, self.method, self.names]
        self.operating.param.watch(lambda _event: self.redraw(), "value")

    def ask(self) -> None:
        """Take the limits from the boxes."""
        if not self.names.value or not self.spread.value:
            raise ValueError("Tick at least one parameter and give limits above 0 %.")
        self.spreads = dict.fromkeys(self.names.value, self.spread.value / 100)
        self.asked = {"samples": self.samples.value, "method": self.method.value}

    def work(self, executor: Executor, progress: Progress) -> Any:
        """Draw the designs."""
        return uncertainty(
            self.model,
            self.parameters,
            self.spreads,
            executor=executor,
            progress=progress,
            **self.asked,
        )

    def draw(self) -> None:
        """Draw histogram and Sobol' indices, say the probability."""
        found, speed = self.result, self.operating.value or 0.0
        self.said.html = _words(found, speed)
        indices = found.indices["nonlinear"]
        plots = [part("plot", shown(histogram(found, speed, self.colours), _HEIGHT))]
        if np.isfinite(indices.total).any():
            chart = index_bars(indices, self.colours)
            plots.append(part("plot", shown(chart, height_of(chart))))
        self.body[:] = [part("two", *plots)]

    def csv(self) -> str:
        """Return all samples."""
        limits = ", ".join(f"{name} ±{100 * s:g} %" for name, s in self.spreads.items())
        return f"# limits: {limits}\n{self.result.csv()}"


def index_bars(indices: Indices, colours: Palette) -> hv.Overlay:
    """Return what each uncertain parameter explains of the scatter, the most on top."""
    order = np.argsort(-indices.total)
    labels = [FIELDS[indices.names[k]].symbol for k in order]
    values = {
        "alone": (indices.first_order[order], colours.bogie),
        "with all interactions": (indices.total[order], colours.wheelset),
    }
    axis = "share of the scatter of V_nl it explains (Sobol’ index)"
    return bars(labels, values, axis, colours, "indices")


def histogram(found: Any, speed: float, colours: Any) -> hv.Overlay:
    """Return how often each critical speed comes out."""
    both = KMH * np.concatenate([found.linear, found.nonlinear])
    finite = both[np.isfinite(both)]
    edges = np.histogram_bin_edges(finite if finite.size else [0.0, 1.0], 60)
    parts: list[Any] = []
    kinds = {
        "V_nl, nonlinear": (found.nonlinear, colours.conditional),
        "V_lin, linear": (found.linear, colours.hunting),
    }
    for label, (V, colour) in kinds.items():
        counts, _ = np.histogram(KMH * V[np.isfinite(V)], edges)
        bars_ = hv.Histogram((edges, 100 * counts / len(V)), kdims="V", vdims="share", label=label)
        parts.append(bars_.opts(fill_color=colour, fill_alpha=0.55, line_width=0, tools=["hover"]))
    line = hv.Curve([(speed, 0), (speed, 1e3)], "V", "share", label="operating speed")
    parts.append(line.opts(color=colours.ink, line_width=2.5))
    most = max(float(np.nanmax(one.dimension_values(1))) for one in parts[:-1])
    low, high = np.fmin(edges[0], speed), np.fmax(edges[-1], speed)
    margin = 0.03 * (high - low)
    return hv.Overlay(parts).opts(
        responsive=True,
        height=_HEIGHT,
        xlabel="critical speed V [km/h]",
        ylabel="share of the samples [%]",
        xlim=(low - margin, high + margin),
        ylim=(0, 1.1 * most or 1.0),
        legend_position="top",
        legend_cols=3,
        show_grid=True,
        hooks=[dressed(colours, "histogram", "Histogram of the critical speeds")],
    )


def _words(found: Any, speed: float) -> str:
    probability, low, high = found.probability_below(speed / KMH)
    if not np.isfinite(probability):
        said = "<p>None of the designs drawn has a nonlinear critical speed.</p>"
    else:
        five, half, most = KMH * found.quantiles([0.05, 0.5, 0.95])
        said = (
            f"<p><b>With a probability of {100 * probability:.2f} % the nonlinear critical speed "
            f"lies below {speed:g} km/h</b> (95 % confidence: {100 * low:.2f} to {100 * high:.2f} "
            "%): then a large enough disturbance makes the vehicle hunt at that speed. Half of all "
            f"designs have V<sub>nl</sub> below {half:.1f} km/h, nine of ten between {five:.1f} "
            f"and {most:.1f} km/h.</p>"
        )
    gaps = "".join(
        f'<p class="warning">{count:,} of {len(found.linear):,} samples are left out: '
        f"{escape(reason)}.</p>"
        for reason, count in found.gaps().items()
    )
    return said + gaps
