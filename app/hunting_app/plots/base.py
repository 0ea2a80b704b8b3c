"""What all figures share: how they are made and dressed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from bokeh.models import GlyphRenderer, HoverTool, HSpan, Line, Range1d, Scatter, VSpan, VStrip
from bokeh.plotting import figure

if TYPE_CHECKING:
    from bokeh.model import Model
    from bokeh.models import ColumnDataSource

    from hunting.elements import Array
    from hunting_app.palette import Palette
    from hunting_app.picture import Picture
    from hunting_app.plots.feed import Feed

FONT = "system-ui, sans-serif"
BACKGROUND, BASELINE, AVERAGED, EXACT, MOTIONS = range(5)  # layers, the lowest first
_GLYPHS = {"line": Line, "scatter": Scatter, "hspan": HSpan, "vspan": VSpan, "vstrip": VStrip}


class Plot:
    """A Bokeh figure whose colours follow the palette and whose data is patched, never rebuilt.

    What shows a vehicle or its baseline is made when it is first wanted: all that is on a page
    takes its time at every update, drawn or not.
    """

    def __init__(self, feed: Feed, x_label: str, y_label: str, name: str, described: str) -> None:
        self.feed = feed
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
        self._palette: Palette | None = None
        self._inks: list[tuple[Model, str, str]] = []
        self._layers = [0] * (MOTIONS + 1)  # how many glyphs there are in each
        self._hovers: dict[str, HoverTool] = {}
        self._of_vehicle: dict[str, list[GlyphRenderer]] = {}
        self._greys: dict[str, list[GlyphRenderer]] = {}
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
        inks = [(model, attribute, role) for attribute, role in roles.items()]
        self._inks += inks
        self._colour(inks)

    def _colour(self, inks: list[tuple[Model, str, str]]) -> None:
        if self._palette is not None:
            for model, attribute, role in inks:
                setattr(model, attribute, getattr(self._palette, role))

    def add(
        self,
        glyph: str,
        source: ColumnDataSource,
        inks: dict[str, str],
        layer: int = BACKGROUND,
        **look: Any,
    ) -> GlyphRenderer:
        """Add a glyph, such as ``"line"``, on top of its layer; colours follow the palette."""
        drawn = _GLYPHS[glyph](**look)
        renderer = GlyphRenderer(  # figure.line and the like would prepare four more looks of it
            data_source=source,
            glyph=drawn,
            view=self.feed.views[source.id],
            selection_glyph=None,
            nonselection_glyph=None,
            muted_glyph=None,
        )
        self.figure.renderers.insert(sum(self._layers[: layer + 1]), renderer)
        self._layers[layer] += 1
        self.ink(drawn, **inks)
        return renderer

    def show_vehicles(self, vehicles: set[str]) -> None:
        """Draw only these: what is hidden costs no time."""
        for vehicle in sorted(vehicles - self._of_vehicle.keys()):
            self._of_vehicle[vehicle] = self.add_vehicle(vehicle)
        for vehicle, renderers in self._of_vehicle.items():
            for renderer in renderers:
                renderer.visible = vehicle in vehicles

    def add_vehicle(self, vehicle: str) -> list[GlyphRenderer]:
        """Add what shows a vehicle."""
        return []

    def draw_baseline(self, shown: Picture) -> None:
        """Draw what is compared with, in grey."""
        for vehicle in sorted(shown.baseline.keys() - self._greys.keys()):
            self._greys[vehicle] = self.add_baseline(vehicle)
        for vehicle, greys in self._greys.items():
            for grey in greys:
                grey.visible = vehicle in shown.baseline

    def add_baseline(self, vehicle: str) -> list[GlyphRenderer]:
        """Add what shows the baseline of a vehicle."""
        return []

    def hover(self, renderer: GlyphRenderer, name: str, says: str) -> None:
        """Show values under the pointer; `says` may hold Bokeh's ``$name`` and the like."""
        renderer.name = name
        if says not in self._hovers:
            self._hovers[says] = HoverTool(renderers=[], tooltips=says, visible=False)
            self.figure.add_tools(self._hovers[says])
        self._hovers[says].renderers.append(renderer)

    def dress(self, palette: Palette) -> None:
        """Apply a palette."""
        self._palette = palette
        self._colour(self._inks)

    def draw(self, shown: Picture) -> None:
        """Draw what holds at every speed."""

    def draw_moment(self, shown: Picture) -> None:
        """Draw what holds at the chosen speed."""

    def frame(self, x: tuple[float, float], y: tuple[float, float]) -> None:
        """Set the axes; what has not changed is left alone, and with it the person's zoom."""
        for bounds, (start, end) in ((self.figure.x_range, x), (self.figure.y_range, y)):
            if (bounds.reset_start, bounds.reset_end) != (start, end):
                bounds.update(start=start, end=end, reset_start=start, reset_end=end)


def joined(parts: list[Array]) -> Array:
    """Return curves as one column, with a gap between each two."""
    gap = np.full(1, np.nan)
    return np.concatenate([piece for part in parts for piece in (part, gap)][:-1] or [gap[:0]])
