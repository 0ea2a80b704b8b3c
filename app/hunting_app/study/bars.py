"""What ten percent more of each parameter does to the critical speeds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from typing import Any

import holoviews as hv
import numpy as np

from hunting.cases import Progress
from hunting.elements import Array
from hunting.sensitivity import Sensitivity, sensitivity
from hunting.tables import header, rows
from hunting_app.palette import Palette
from hunting_app.picture import KMH
from hunting_app.state import FIELDS
from hunting_app.study.dress import dressed, shown
from hunting_app.study.section import Section, part, warning

MORE = 10.0  # percent


class Sensitivities(Section):
    """Bars, the longest on top."""

    key = "sensitivity"
    label = "Sensitivity"
    call = "Compute the sensitivities"
    things = "steps"
    explained = (
        "Each bar is the change of a critical speed, in percent, for 10 % more of one parameter: "
        "to the right the speed rises, to the left it falls. The parameter with the longest bar is "
        "on top. (To first order: ten times the slope d ln V / d ln p at the present design. The "
        "advice on the Explore page takes the whole step, so its numbers differ a little.)"
    )

    def opened(self) -> None:
        """Compute at once: it takes a moment."""
        if (self.result is None and self.job is None) or self.outdated():
            self.start()

    def work(self, executor: Executor, _progress: Progress) -> Any:
        """Ask the model."""
        return executor.submit(sensitivity, self.model, self.parameters).result()

    def draw(self) -> None:
        """Draw two bars for each parameter."""
        found = self.result
        if not np.isfinite(found.linear).any():
            self.said.html, self.body[:] = warning(f"No critical speed: {found.message}."), []
            return
        chart = sensitivity_bars(found, self.colours)
        self.body[:] = [part("plot", shown(chart, height_of(chart)))]
        self.said.html = (
            f"<p>At the present design V<sub>lin</sub> = {KMH * found.V_linear:.1f} km/h and "
            f"V<sub>nl</sub> = {KMH * found.V_nonlinear:.1f} km/h.</p>"
            + (warning(found.message) if found.message else "")
        )

    def csv(self) -> str:
        """Return slopes and changes."""
        found = self.result
        fields = [FIELDS[name] for name in found.names]
        title = "sensitivity of the critical speeds"
        return (
            header(title, self.vehicle, "harmonic_balance", self.parameters, set())
            + f"# reason for a gap: {found.message or 'none'}\n"
            + rows(
                {
                    "parameter": list(found.names),
                    "value": [getattr(self.parameters, name) for name in found.names],
                    "unit": [field.unit for field in fields],
                    "d ln V_lin/d ln p [1]": found.linear,
                    "d ln V_nl/d ln p [1]": found.nonlinear,
                    "change of V_lin for +10 % [%]": MORE * found.linear,
                    "change of V_nl for +10 % [%]": MORE * found.nonlinear,
                }
            )
        )


def sensitivity_bars(found: Sensitivity, colours: Palette) -> hv.Overlay:
    """Return two bars for each parameter, the longest on top."""
    order = np.argsort(-np.abs(np.nan_to_num(np.stack([found.nonlinear, found.linear]))).max(0))
    labels = [f"{FIELDS[found.names[k]].label}  {FIELDS[found.names[k]].symbol}" for k in order]
    values = {
        "V_nl, nonlinear": (MORE * found.nonlinear[order], colours.conditional),
        "V_lin, linear": (MORE * found.linear[order], colours.hunting),
    }
    axis = "change of the critical speed [%] for 10 % more of the parameter"
    return bars(labels, values, axis, colours, "sensitivity")


def height_of(chart: hv.Overlay) -> int:
    """Return the height that a chart asks for [px]."""
    return int(chart.opts.get("plot").kwargs["height"])


def bars(
    labels: Sequence[str],
    values: Mapping[str, tuple[Array, str]],
    axis: str,
    colours: Palette,
    name: str,
) -> hv.Overlay:
    """Return horizontal bars, a group for each label, the first on top.

    Parameters
    ----------
    labels : sequence of str
        Names of the groups.
    values : dict of str to (ndarray, colour)
        For each entry of the legend the length of its bar in every group.
    axis : str
        What the lengths mean.
    colours, name
        The palette and the figure's name.
    """
    count, wide = len(labels), 0.8 / len(values)
    places = -np.arange(count, dtype=float)
    parts = [hv.VLine(0).opts(color=colours.faint, line_width=1)]
    for k, (label, (lengths, colour)) in enumerate(values.items()):
        top = places + 0.4 - k * wide
        boxes = [
            (min(v, 0.0), t - 0.9 * wide, max(v, 0.0), t, label, v)
            for v, t in zip(np.nan_to_num(lengths), top, strict=True)
        ]
        vdims = ["speed", hv.Dimension("change", label=axis)]
        box = hv.Rectangles(boxes, ["x0", "y0", "x1", "y1"], vdims, label=label)
        parts.append(box.opts(color=colour, line_width=0, tools=["hover"], hover_tooltips=_TIPS))
    height = 70 + (26 if len(values) > 1 else 20) * count
    return hv.Overlay(parts).opts(
        responsive=True,
        height=height,
        xlabel=axis,
        ylabel="",
        title="",
        yticks=list(zip(places, labels, strict=True)),
        ylim=(-count + 0.4, 0.6),
        legend_position="top",
        show_legend=len(values) > 1,
        gridstyle={"ygrid_line_alpha": 0},
        show_grid=True,
        hooks=[dressed(colours, name, axis)],
    )


_TIPS = [("", "@speed"), ("change", "@change{0.00}")]
