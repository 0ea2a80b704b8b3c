"""What all figures share: how they are made and dressed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from bokeh.models import GlyphRenderer, HoverTool, HSpan, Line, Range1d, Scatter, VSpan, VStrip
from bokeh.plotting import figure

from hunting_app.state import VEHICLES

if TYPE_CHECKING:
    from bokeh.model import Model
    from bokeh.models import ColumnDataSource

    from hunting.elements import Array
    from hunting_app.palette import Palette
    from hunting_app.picture import Picture

FONT = "system-ui, sans-serif"
_GLYPHS = {"line": Line, "scatter": Scatter, "hspan": HSpan, "vspan": VSpan, "vstrip": VStrip}


class Plot:
    """A Bokeh figure whose colours follow the palette and whose data is patched, never rebuilt."""

    def __init__(self, x_label: str, y_label: str, name: str, described: str) -> None:
        self.figure = figure(
            name=name,
            html_attributes={"role": "img", "aria-label": described},
            x_range=Range1d(0, 1),
            y_range=Range1d(0, 1),
            title=None,
            x_axis_label=x_label,
            y_axis_label=y_label,
            tools="pan,box_zoom,wheel_zoom,reset,save",
            active_scroll=None,
            sizing_mode="stretch_both",
            min_height=170,
            min_border_right=12,
        )
        self.figure.toolbar.autohide = True
        self.figure.toolbar.logo = None
        self._inks: list[tuple[Model, str, str]] = []
        self._of_vehicle: list[tuple[GlyphRenderer, str]] = []
        for axis in self.figure.axis:
            axis.axis_label_text_font = axis.major_label_text_font = FONT
            axis.axis_label_text_font_style = "normal"
            axis.axis_label_text_font_size = "12px"
            axis.major_label_text_font_size = "11px"
            axis.minor_tick_line_color = None
            self.ink(
                axis,
                axis_label_text_color="ink",
                major_label_text_color="faint",
                axis_line_color="faint",
                major_tick_line_color="faint",
            )
        self.ink(self.figure, background_fill_color="paper", border_fill_color="paper")
        self.ink(self.figure, outline_line_color="grid")
        for grid in self.figure.grid:
            self.ink(grid, grid_line_color="grid")

    def ink(self, model: Model, **roles: str) -> None:
        """Let colours of a model follow the palette: ``ink(line, line_color="bogie")``."""
        self._inks += [(model, attribute, role) for attribute, role in roles.items()]

    def add(self, glyph: str, source: ColumnDataSource, inks: dict[str, str], **look: Any) -> Any:
        """Add a glyph, such as ``"line"``, whose colours follow the palette."""
        drawn = _GLYPHS[glyph](**look)
        renderer = GlyphRenderer(  # figure.line and the like would prepare four more looks of it
            data_source=source,
            glyph=drawn,
            selection_glyph=None,
            nonselection_glyph=None,
            muted_glyph=None,
        )
        self.figure.renderers.append(renderer)
        self.ink(drawn, **inks)
        self._of_vehicle += [(renderer, role) for role in set(inks.values()) & set(VEHICLES)]
        return renderer

    def behind(self, source: ColumnDataSource, **look: Any) -> Any:
        """Add a grey line of the baseline, hidden until there is one."""
        line = self.add("line", source, {"line_color": "baseline"}, **look)
        line.visible = False
        return line

    def show_vehicles(self, vehicles: set[str]) -> None:
        """Draw only these: what is hidden costs no time."""
        for renderer, vehicle in self._of_vehicle:
            renderer.visible = vehicle in vehicles

    def hover(self, renderers: list[GlyphRenderer], tooltips: list[tuple[str, str]]) -> None:
        """Show values under the pointer."""
        tool = HoverTool(renderers=renderers, tooltips=tooltips, visible=False)
        self.figure.add_tools(tool)

    def dress(self, palette: Palette) -> None:
        """Apply a palette."""
        for model, attribute, role in self._inks:
            setattr(model, attribute, getattr(palette, role))

    def draw(self, shown: Picture) -> None:
        """Draw what holds at every speed."""

    def draw_moment(self, shown: Picture) -> None:
        """Draw what holds at the chosen speed."""

    def draw_baseline(self, shown: Picture) -> None:
        """Draw what is compared with, in grey."""

    def frame(self, x: tuple[float, float], y: tuple[float, float]) -> None:
        """Set the axes; what has not changed is left alone, and with it the person's zoom."""
        for bounds, (start, end) in ((self.figure.x_range, x), (self.figure.y_range, y)):
            if (bounds.reset_start, bounds.reset_end) != (start, end):
                bounds.update(start=start, end=end, reset_start=start, reset_end=end)


def joined(parts: list[Array]) -> Array:
    """Return curves as one column, with a gap between each two."""
    gap = np.full(1, np.nan)
    return np.concatenate([piece for part in parts for piece in (part, gap)][:-1] or [gap[:0]])
