"""Time history of simulated motions: y, psi and z in three lanes, flange contact shaded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hunting_app.disturbance import contacts
from hunting_app.numerals import rounded_up
from hunting_app.plots.base import Plot
from hunting_app.plots.portraits import COORDINATES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bokeh.models import ColumnDataSource

    from hunting_app.disturbance import Disturbed
    from hunting_app.plots.feed import Feed

ROLES = ("motion", "hunting")  # the palette's colours of the only or inner motion, of the outer one
_COLUMNS = ("t", *(name for c in COORDINATES for name in (c.symbol, f"{c.symbol}'")))


class Motion:
    """The sources of simulated motions, which several plots draw."""

    def __init__(self, feed: Feed) -> None:
        self.feed = feed
        self.sources = {role: feed.source(*_COLUMNS) for role in ROLES}
        for role, source in self.sources.items():
            source.name = f"motion-{role}"

    def put(self, motion: Disturbed) -> dict[str, float]:
        """Show motions; return how far they reach [mm, mrad or per second], by symbol."""
        reach = dict.fromkeys(_COLUMNS[1:], 0.0)
        for index, role in enumerate(ROLES[: len(motion.sizes)]):
            columns = {name: motion.column(name, index) for name in _COLUMNS[1:]}
            self.feed.put(self.sources[role], {"t": motion.trajectory.time, **columns})
            for symbol in reach:
                reach[symbol] = max(reach[symbol], float(np.nanmax(np.abs(columns[symbol]))))
        return reach

    def clear(self) -> None:
        """Show none."""
        for source in self.sources.values():
            self.feed.put(source, {name: [] for name in _COLUMNS})


class History:
    """One lane for each coordinate; they share the axis of time."""

    def __init__(self, feed: Feed, motions: dict[str, ColumnDataSource]) -> None:
        self.feed = feed
        self.contacts = feed.source("from", "to")
        self.lanes = {
            c.symbol: Plot(feed, "", "", f"history-{c.symbol}", c.label) for c in COORDINATES
        }
        first = self.lanes[COORDINATES[0].symbol].figure
        for c in COORDINATES:
            lane = self.lanes[c.symbol]
            figure = lane.figure
            figure.min_height = 30
            figure.min_border_top = figure.min_border_bottom = 2
            figure.x_range = first.x_range
            figure.yaxis.axis_label = f"{c.symbol} [{c.unit}]"
            figure.yaxis.ticker.desired_num_ticks = 3
            figure.yaxis.axis_label_text_font_size = "11px"
            figure.yaxis.axis_label_standoff = 2
            figure.min_border_left = 58
            figure.xaxis.axis_label = "time t [s]"
            lane.add(
                "vstrip", self.contacts, {"fill_color": "hunting", "line_color": "hunting"},
                x0="from", x1="to", fill_alpha=0.25, line_alpha=0.25,
            )  # fmt: skip
            for role, source in reversed(motions.items()):
                lane.add("line", source, {"line_color": role}, x="t", y=c.symbol, line_width=1)
        self.show([c.symbol for c in COORDINATES])

    def show(self, symbols: Sequence[str]) -> None:
        """Show the lanes of these states only; the last of them has the axis of time."""
        *_, last = (symbol for symbol in self.lanes if symbol in symbols)
        for symbol, lane in self.lanes.items():
            is_last = symbol == last
            lane.figure.visible = symbol in symbols
            lane.figure.xaxis.visible = is_last
            lane.figure.styles = {"flex": "1 1 36px" if is_last else "1 1 0"}

    def draw(self, reach: dict[str, float], motion: Disturbed) -> None:
        """Set the axes and shade the contacts; the motions are in their sources."""
        time = motion.trajectory.time
        begins, ends = contacts(time, motion.touching())
        self.feed.put(self.contacts, {"from": begins, "to": ends})
        for symbol, lane in self.lanes.items():
            end = rounded_up(1.05 * reach[symbol]) if reach[symbol] else 1.0
            lane.frame((0.0, float(time[-1])), (-end, end))

    def clear(self) -> None:
        """Shade nothing, on axes as they were before any motion."""
        nothing = np.zeros(0)
        for lane in self.lanes.values():
            lane.frame((0.0, 1.0), (0.0, 1.0))
        self.feed.put(self.contacts, {"from": nothing, "to": nothing})
