"""Plan view of the wheelset between the rails, animated in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param

from hunting_app.component import Component

_HERE = Path(__file__).parent


class Plan(Component):
    """Plays the motions that the page holds already; asks the server for nothing."""

    clearance = param.Number(default=9.0, doc="Flange clearance [mm].")
    frame = param.Boolean(default=True, doc="Whether the vehicle has a frame that moves.")
    present = param.Boolean(default=False, doc="Whether there is a motion to play.")

    _esm: ClassVar = _HERE / "plan.js"
    _stylesheets: ClassVar = [(_HERE / "plan.css").read_text(encoding="utf-8")]

    def __init__(self, **params: Any) -> None:
        super().__init__(css_classes=["plan"], sizing_mode="stretch_both", margin=0, **params)
