"""All curves of the page travel as one array.

Bokeh sends each column of each source as two frames of its own, some seventy of them for one move
of a slider, and the frames cost more than what is in them. One array of all columns, taken apart
in the browser, costs two.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from bokeh.models import AllIndices, CDSView, ColumnDataSource, CustomJS, Selection, UnionRenderers
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bokeh.model import Model

Columns = Mapping[str, Sequence[float] | NDArray[np.float64]]

_HERE = Path(__file__).parent
_TAKE_APART = (_HERE / "feed.js").read_text(encoding="utf-8")
_KEEP_STYLES = (_HERE / "styles.js").read_text(encoding="utf-8")
_UNCHANGED = np.full(1, -1.0)


class Feed:
    """Sources of numbers, filled together; what has not changed is not sent again.

    `send` fills sources that the browser does not know yet, so that glyphs are made with their
    data; of the others only the twins in the browser: here they keep what they began with.

    Attributes
    ----------
    sources : list of ColumnDataSource
        In the order in which they travel.
    views : dict
        By the id of a source: all of it, for every glyph that draws it. Bokeh goes through all
        models of a page at every update; what sources and glyphs can share, they share.
    """

    def __init__(self) -> None:
        self.sources: list[ColumnDataSource] = []
        self.views: dict[str, CDSView] = {}
        self._whole = AllIndices()
        self._alike = {"selected": Selection(), "selection_policy": UnionRenderers()}
        self._staged: dict[str, tuple[Columns, NDArray[np.float64]]] = {}
        self._shown: dict[str, bytes] = {}
        self._waits = False
        self._known = 0  # sources that the array is for
        self._channel = ColumnDataSource({"packed": np.zeros(0)})
        self._take_apart = CustomJS(code=_TAKE_APART)
        self._keep_styles = CustomJS(code=_KEEP_STYLES)
        self._channel.js_on_change("data", self._take_apart)
        self._take_apart.js_on_change("args", self._keep_styles)

    def source(self, *columns: str) -> ColumnDataSource:
        """Return a new empty source with these columns."""
        source = ColumnDataSource({name: [] for name in columns}, **self._alike)
        self.sources.append(source)
        self.views[source.id] = CDSView(filter=self._whole)
        return source

    def connect(self, figure: Model) -> None:
        """Let the array travel with a figure of the page, for all sources that there are by now."""
        if self._channel not in figure.tags:
            figure.tags = [*figure.tags, self._channel]
            self._keep_styles.args = {"figure": figure}
        self._extend()

    def _extend(self) -> None:
        columns = [source.column_names for source in self.sources]
        self._take_apart.args = {"sources": list(self.sources), "columns": columns}
        self._known = len(self.sources)

    def put(self, source: ColumnDataSource, columns: Columns) -> None:
        """Give a source new columns of one length, with the next `send`."""
        values = [columns[name] for name in source.column_names]
        packed = np.concatenate([[len(values[0])], *values], dtype=float)
        if self._shown.get(source.id) != (new := packed.tobytes()):
            self._shown[source.id] = new
            self._staged[source.id] = columns, packed

    @contextmanager
    def one_update(self) -> Iterator[None]:
        """Send all at the end: of two arrays in one update the browser gets but the last."""
        self._waits = True
        try:
            yield
        finally:
            self._waits = False
            self.send()

    def send(self) -> None:
        """Show what was put since the last time."""
        if self._waits:
            return
        parts, changed = [], False
        for number, source in enumerate(self.sources):
            columns, packed = self._staged.get(source.id, (None, _UNCHANGED))
            if columns is not None and (source.document is None or number >= self._known):
                source.data = dict(columns)
                packed = _UNCHANGED
            changed |= packed is not _UNCHANGED
            parts.append(packed)
        if self._known < len(self.sources) and self.sources[-1].document is not None:
            self._extend()
        if changed:
            self._channel.data = {"packed": np.concatenate(parts)}
        self._staged.clear()
