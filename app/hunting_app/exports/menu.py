"""The small menu at each card that offers what it shows as files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

import param

from hunting_app.component import Component

_HERE = Path(__file__).parent
KINDS = {"csv": "Curves (CSV)", "png": "Picture (PNG)", "svg": "Drawing (SVG)"}
REPORT = {"report": "Report of everything (HTML)"}


@dataclass(frozen=True)
class File:
    """What the browser needs to make a file.

    Attributes
    ----------
    name : str
        File name.
    kind : str
        ``"csv"``, ``"report"``, ``"png"`` or ``"svg"``.
    text : str
        The content; of a picture, which the browser draws itself, the words below it, a paragraph
        a line.
    title : str
        The heading of a picture.
    """

    name: str
    kind: str
    text: str
    title: str = ""


class Menu(Component):
    """Offers files; the server keeps nothing, what it makes travels in its answer."""

    subject = param.String(doc="What the files hold, in words.")
    kinds = param.List(doc="Key and label of each kind of file.")

    _esm: ClassVar = _HERE / "menu.js"
    _stylesheets: ClassVar = [(_HERE / "menu.css").read_text(encoding="utf-8")]

    def __init__(
        self, make: Callable[[str], File], subject: str, kinds: dict[str, str] = KINDS
    ) -> None:
        super().__init__(
            subject=subject,
            kinds=[list(item) for item in kinds.items()],
            css_classes=["downloads"],
            margin=0,
        )
        self._make = make

    def _handle_msg(self, data: Any) -> None:
        if data["kind"] in dict(self.kinds):
            self._send_msg(asdict(self._make(data["kind"])))
