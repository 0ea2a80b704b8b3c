"""A map of the critical speeds over two parameters."""

from __future__ import annotations

from concurrent.futures import Executor
from html import escape
from typing import Any

import holoviews as hv
import numpy as np
from bokeh.models import GlyphRenderer, Quad
from holoviews.operation import contours

from hunting import Sweep, sweep
from hunting.cases import Progress
from hunting.elements import Array
from hunting.parameters import Field
from hunting.study import span_of
from hunting_app.picture import KMH
from hunting_app.state import FIELDS
from hunting_app.study.choices import METHODS, PARAMETERS, select
from hunting_app.study.dress import dressed, named, shown
from hunting_app.study.section import Section, part

QUANTITIES = {"V_nl, nonlinear": "nonlinear", "V_lin, linear": "linear", "band between": "band"}
_TITLES = {
    "nonlinear": "nonlinear critical speed V_nl [km/h]",
    "linear": "linear critical speed V_lin [km/h]",
    "band": "conditional band V_lin − V_nl [km/h]",
}
_POINTS = {f"{n} × {n} points": n for n in (25, 50, 100, 200)}
_GAPS = ("#8a8f98", "#b9bec6", "#6b5b73", "#5d6b62")  # a grey for each reason
_HEIGHT = 520


class Map(Section):
    """Critical speeds over any two parameters."""

    key = "map"
    label = "Map"
    call = "Compute the map"
    explained = (
        "Choose two parameters: the colour shows the critical speed for every pair of their "
        "values, the lines join equal speeds. The cross is the present design. <b>Click anywhere "
        "in the map to take that design to Explore.</b>"
    )

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.x = select("across", PARAMETERS, "Ky", 230)
        self.y = select("upwards", PARAMETERS, "lam", 230)
        self.quantity = select("colour", QUANTITIES, "nonlinear")
        self.method = select("method", METHODS, "averaging")
        self.points = select("resolution", _POINTS, 50)
        self.controls[:] = [self.x, self.y, self.quantity, self.method, self.points]
        self.quantity.param.watch(lambda _event: self.redraw(), "value")

    def ask(self) -> None:
        """Take the axes from the lists."""
        if self.x.value == self.y.value:
            raise ValueError("Choose two different parameters for the map.")
        self.axes = {name: self._values(FIELDS[name]) for name in (self.x.value, self.y.value)}
        self.asked = self.method.value

    def _values(self, field: Field) -> Array:
        """Return the field's span, made wider if the present design lies outside."""
        values, present = span_of(field, self.points.value), getattr(self.parameters, field.name)
        low, high = min(values[0], present), max(values[-1], present)
        spaced = np.geomspace if field.log and low > 0 else np.linspace
        return values if values[0] == low and values[-1] == high else spaced(low, high, len(values))

    def work(self, executor: Executor, progress: Progress) -> Sweep:
        """Sweep the grid."""
        return sweep(self.model, self.parameters, self.axes, self.asked, executor, progress)

    def draw(self) -> None:
        """Draw colours, lines, gaps and the present design."""
        found: Sweep = self.result
        values = speeds(found, self.quantity.value)
        picture, mesh = speed_map(found, self.quantity.value, self.colours)
        self.tap = hv.streams.Tap(source=mesh, x=None, y=None)
        self.tap.add_subscriber(self._take)
        self.body[:] = [part("plot", shown(picture, _HEIGHT))]
        low, high = (f(values) if np.isfinite(values).any() else np.nan for f in _ENDS)
        self.said.html = (
            f"<p>From {low:.1f} to {high:.1f} km/h, by {_METHOD_WORDS[found.method]}.</p>"
            + gap_legend(values, found.message)
        )

    def _take(self, x: float | None = None, y: float | None = None) -> None:
        if x is None or y is None:
            return
        for name, value in zip(self.result.axes, (x, y), strict=True):
            self.act({"set": name, "to": float(f"{value:.4g}")})
        self.act({"page": "explore"})

    def csv(self) -> str:
        """Return the grid."""
        return self.result.csv()


_ENDS = (np.nanmin, np.nanmax)
_METHOD_WORDS = {"averaging": "averaging", "harmonic_balance": "exact limit cycles"}


def speeds(found: Sweep, quantity: str) -> Array:
    """Return what the map shows [km/h], a row for each value upwards."""
    V = found.linear - found.nonlinear if quantity == "band" else getattr(found, quantity)
    return KMH * V.T


def reasons(values: Array, message: Array) -> dict[str, Array]:
    """Return where the map has gaps, by the reason."""
    missing = ~np.isfinite(values)
    return {
        str(reason) or "no such speed": missing & np.equal(message.T, reason)
        for reason in np.unique(message.T[missing])
    }


def gap_legend(values: Array, message: Array) -> str:
    """Return what the greys mean."""
    items = "".join(
        f'<li><i style="background:{colour}"></i> {where.sum():,} of {values.size:,} points: '
        f"{escape(reason)}</li>"
        for colour, (reason, where) in zip(
            np.resize(_GAPS, 9), reasons(values, message).items(), strict=False
        )
    )
    return f'<ul class="legend" aria-label="gaps">{items}</ul>' if items else ""


def speed_map(found: Sweep, quantity: str, colours: Any) -> tuple[hv.Overlay, hv.QuadMesh]:
    """Return the map and the mesh that takes clicks."""
    (x_name, x), (y_name, y) = found.axes.items()
    fields = FIELDS[x_name], FIELDS[y_name]
    values = speeds(found, quantity)
    kdims = [hv.Dimension(n, label=f"{FIELDS[n].symbol} [{FIELDS[n].unit}]") for n in found.axes]
    mesh = hv.QuadMesh((x, y, values), kdims, hv.Dimension("V", label=_TITLES[quantity]))
    mesh = mesh.opts(
        cmap="viridis",
        colorbar=True,
        tools=["hover"],
        clabel=_TITLES[quantity],
    )
    parts: list[Any] = [mesh]
    for k, where in enumerate(reasons(values, found.message).values()):
        cells = hv.QuadMesh((x, y, np.where(where, 1.0, np.nan)), kdims, f"gap {k}")
        parts.append(cells.opts(cmap=[_GAPS[k % len(_GAPS)]] * 2, colorbar=False))
    if np.isfinite(values).any() and np.nanmax(values) - np.nanmin(values) > 1e-3:
        parts += _lines(mesh, values)
    here = [[float(getattr(found.parameters, name)) for name in found.axes]]
    cross = {"marker": "cross", "size": 18, "line_width": 4}
    parts.append(hv.Points(here, kdims).opts(color="black", **cross))
    parts.append(hv.Points(here, kdims).opts(color="white", **cross | {"line_width": 2}))
    overlay = hv.Overlay(parts).opts(
        responsive=True,
        height=_HEIGHT,
        xlabel=named(fields[0]),
        ylabel=named(fields[1]),
        logx=bool(fields[0].log and x[0] > 0),
        logy=bool(fields[1].log and y[0] > 0),
        xlim=(float(x[0]), float(x[-1])),
        ylim=(float(y[0]), float(y[-1])),
        show_legend=False,
        hooks=[dressed(colours, "map", f"Map of the {_TITLES[quantity]}"), _close_seams],
    )
    return overlay, mesh


def _close_seams(plot: Any, _element: Any) -> None:
    """Let no paper shine through between the cells."""
    for renderer in plot.state.select({"type": GlyphRenderer}):
        if isinstance(renderer.glyph, Quad):
            renderer.glyph.update(line_color=renderer.glyph.fill_color, line_width=1, line_alpha=1)


def _lines(mesh: hv.QuadMesh, values: Array) -> list[Any]:
    """Return contour lines, each labelled with its speed."""
    levels = _levels(float(np.nanmin(values)), float(np.nanmax(values)))
    lines = contours(mesh, levels=levels)
    lines = lines.opts(color="white", cmap=["white", "white"], line_width=1, alpha=0.8)
    lines = lines.opts(colorbar=False, tools=[])
    marks = []
    for path in lines.split(datatype="dictionary"):
        x, y = (np.atleast_1d(path[d.name]) for d in mesh.kdims)
        if len(x) > 5:
            middle = len(x) // 2
            marks.append((x[middle], y[middle], f"{np.ravel(path['V'])[0]:.0f}"))
    labels = hv.Labels(marks, mesh.kdims, "speed")
    return [lines, labels.opts(text_color="white", text_font_size="10px")] if marks else [lines]


def _levels(low: float, high: float) -> list[float]:
    """Return some eight round speeds between two."""
    size = (high - low) / 8
    power = 10.0 ** np.floor(np.log10(size))
    step = next(s * power for s in (1, 2, 5, 10) if s * power >= size)
    return (step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)).tolist()
