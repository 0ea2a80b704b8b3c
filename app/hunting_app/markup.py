"""Pieces of HTML that the server rewrites."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import param
from bokeh.models import Pane
from bokeh.models.dom import HTML

from hunting_app import formula
from hunting_app.component import Component

if TYPE_CHECKING:
    from collections.abc import Callable

_HERE = Path(__file__).parent


STYLE = (_HERE / "markup.css").read_text(encoding="utf-8") + formula.STYLE


def text(*classes: str) -> tuple[HTML, Pane]:
    """Return a text that changes with every move, and what shows it.

    Bare Bokeh elements: Panel's cost a millisecond each move, and Bokeh's own Div lays out the
    whole page again, plots and all, when its text changes.
    """
    content = HTML(html="")
    return content, Pane(elements=[content], css_classes=list(classes), stylesheets=[STYLE])


class Html(Component):
    """Markup with buttons; what one stands for is its ``data-act``, as JSON."""

    html = param.String(doc="What is shown.")
    scrolls = param.Boolean(default=False, doc="Whether the keyboard must reach it to scroll it.")

    _esm: ClassVar = _HERE / "markup.js"
    _stylesheets: ClassVar = [STYLE]

    def __init__(self, act: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(**({"sizing_mode": "stretch_width", "margin": 0} | params))
        self._act = act

    def _handle_msg(self, data: Any) -> None:
        if self._act is not None:
            self._act(data)
