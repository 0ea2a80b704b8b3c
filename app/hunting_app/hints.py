"""Three hints for a first visit, shown once."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import param

from hunting_app.component import Component

_HERE = Path(__file__).parent
HINTS = (
    "Move any slider: the two critical speeds on top and all plots follow at once.",
    "The dashed curve is the threshold: a disturbance above it makes the bogie hunt, one below it "
    "dies out. Click beside it, or type a disturbance, to watch.",
    "Dotted words explain themselves; the line under the answers says what raises V_nl.",
)


class Hints(Component):
    """A box at the lower edge; the browser remembers that it was read."""

    hints = param.List(default=list(HINTS), doc="One after the other.")

    _esm: ClassVar = _HERE / "hints.js"
    _stylesheets: ClassVar = [(_HERE / "hints.css").read_text(encoding="utf-8")]

    def __init__(self) -> None:
        super().__init__(css_classes=["hints"], margin=0)
