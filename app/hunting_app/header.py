"""The header: pages, light or dark, and the address bar."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import param

from hunting_app.component import Component
from hunting_app.state import PAGES

if TYPE_CHECKING:
    from collections.abc import Callable

_HERE = Path(__file__).parent


class Header(Component):
    """Title, navigation, theme; keeps the address bar and the Back button in step."""

    pages = param.List(doc="Key and label of each page.")
    page = param.String()
    dark = param.Boolean()
    address = param.String(
        allow_None=True, doc="The query string; None where no address bar is ours."
    )

    visited = param.Integer(doc="Number of the last step through the browser's history.")

    _esm: ClassVar = _HERE / "header.js"
    _stylesheets: ClassVar = [(_HERE / "header.css").read_text(encoding="utf-8")]

    def __init__(self, act: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(
            pages=[list(item) for item in PAGES.items()],
            styles={"flex": "1 1 auto"},
            margin=0,
            **params,
        )
        self._act = act

    def _handle_msg(self, data: Any) -> None:
        self._act(data["act"])
        self.visited = data.get("visited", self.visited)
