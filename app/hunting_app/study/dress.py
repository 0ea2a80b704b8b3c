"""How HoloViews' figures look here: fonts, colours of the light or dark set, sizes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import holoviews as hv
import numpy as np
import panel as pn
from bokeh.models import ColorBar, CustomJSTickFormatter, FixedTicker, LogAxis

from hunting.parameters import Field
from hunting_app.notebook import kernel, load
from hunting_app.palette import DARK, Palette
from hunting_app.plots.base import FONT

if kernel():
    load()
else:
    hv.extension("bokeh")

_WRITTEN = """
  return Math.abs(tick) >= 1e5
    ? tick.toExponential().replace("e+", "e").replace("-", "−")
    : tick.toLocaleString("en-US", { maximumSignificantDigits: 4 }).replace("-", "−")
"""
Hook = Callable[[Any, Any], None]

_RAMPS = {  # soft to stiff, dark to light against the paper: told apart without colour vision, too
    False: ("#0d0887", "#7e03a8", "#cc4778", "#e8762b", "#d9a400"),
    True: ("#9d8bff", "#d36be0", "#f5759a", "#fca25f", "#fbe069"),
}


def ramp(colours: Palette) -> tuple[str, ...]:
    """Return five colours from the lowest to the highest value of a family."""
    return _RAMPS[colours is DARK]


def named(field: Field) -> str:
    """Return an axis label: name, symbol and unit."""
    return f"{field.label} {field.symbol} [{field.unit}]"


def dressed(colours: Palette, name: str, described: str) -> Hook:
    """Return a hook that gives a finished Bokeh figure fonts, colours and a description."""

    def dress(plot: Any, _element: Any) -> None:
        figure = plot.state
        figure.name = name
        figure.html_attributes = {"role": "img", "aria-label": described}
        figure.update(
            background_fill_color=colours.paper,
            border_fill_color=colours.paper,
            outline_line_color=colours.grid,
            min_border_right=14,
        )
        figure.toolbar.update(logo=None, autohide=True)
        for axis in figure.axis:
            axis.update(
                axis_label_text_font=FONT,
                axis_label_text_font_style="normal",
                axis_label_text_font_size="12px",
                axis_label_text_color=colours.ink,
                major_label_text_font=FONT,
                major_label_text_font_size="11px",
                major_label_text_color=colours.faint,
                axis_line_color=colours.faint,
                major_tick_line_color=colours.faint,
                minor_tick_line_color=None,
            )
            axis.formatter = CustomJSTickFormatter(code=_WRITTEN)
            if isinstance(axis, LogAxis):
                ends = figure.x_range if axis in figure.xaxis else figure.y_range
                axis.ticker = FixedTicker(ticks=_steps(ends.start, ends.end))
        for grid in figure.grid:
            grid.grid_line_color = colours.grid
        for legend in figure.legend:
            legend.update(
                label_text_font=FONT,
                label_text_font_size="11px",
                label_text_color=colours.ink,
                background_fill_alpha=0,
                border_line_color=None,
                margin=0,
                label_standoff=4,
                glyph_width=18,
                padding=2,
                spacing=4,
            )
        for bar in figure.select({"type": ColorBar}):
            bar.update(
                background_fill_color=colours.paper,
                major_label_text_color=colours.faint,
                major_label_text_font=FONT,
                title_text_color=colours.ink,
                title_text_font=FONT,
                title_text_font_style="normal",
                title_text_font_size="12px",
                bar_line_color=colours.grid,
            )

    return dress


def _steps(low: float, high: float) -> list[float]:
    """Return round numbers for a logarithmic axis."""
    decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    ticks = np.outer(10.0**decades, [1.0, 2.0, 5.0]).ravel()
    return ticks[(0.999 * low <= ticks) & (ticks <= 1.001 * high)].tolist()


def shown(element: Any, height: int) -> pn.pane.HoloViews:
    """Return a pane as wide as its card."""
    return pn.pane.HoloViews(
        element,
        height=height,
        min_height=height,
        sizing_mode="stretch_width",
        linked_axes=False,  # each figure has its own
        backend="bokeh",
        margin=0,
    )
