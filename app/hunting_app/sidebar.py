"""The sidebar: presets, vehicle, speed and a row for every parameter."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import param

from hunting_app.component import Component
from hunting_app.scripts import script
from hunting_app.state import FIELDS, PRESETS, SPEED, VEHICLES, State
from hunting_app.units import UNITS, scale

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from hunting.parameters import Field

_HERE = Path(__file__).parent


class Sidebar(Component):
    """Native sliders, boxes and buttons, drawn in the browser.

    The browser sends lists of acts and keeps at most one such message in flight: what happens
    meanwhile is merged, so that only the newest value of a slider is ever computed.
    """

    rows = param.List(doc="Symbol, unit, range and meaning of each row.")
    presets = param.List(doc="Key, label and note of each preset.")
    vehicles = param.List(doc="The vehicles to choose from.")
    unit_systems = param.List(doc="Key and label of the units to choose from.")
    units = param.String(doc="Those in which values are shown.")
    values = param.Dict(default={}, doc="The value of each row.")
    base = param.Dict(default={}, doc="The preset's value of each row.")
    preset = param.String()
    vehicle = param.String()
    provenance = param.String(doc="Whose numbers these are.")
    refused = param.Dict(default={}, doc="By row: why what was typed is not allowed.")
    idle = param.Dict(default={}, doc="By row: that it moves no answer, in words.")
    answered = param.Integer(doc="Number of the last message that was dealt with.")

    _esm: ClassVar = script("dom", "sidebar")
    _stylesheets: ClassVar = [(_HERE / "sidebar.css").read_text(encoding="utf-8")]

    def __init__(
        self,
        act: Callable[[list[dict[str, Any]]], None],
        names: Iterable[str] = FIELDS,
        **params: Any,
    ) -> None:
        super().__init__(
            unit_systems=[list(item) for item in UNITS.items()],
            presets=[[key, preset.label, preset.note] for key, preset in PRESETS.items()],
            vehicles=list(VEHICLES),
            sizing_mode="stretch_both",
            margin=0,
            **params,
        )
        self._act = act
        self._names = (SPEED.name, *names)
        self._number = 0

    def _handle_msg(self, data: Any) -> None:
        self._number = data["number"]
        self._act(data["acts"])

    def present(self, state: State, refused: dict[str, str], words: str) -> None:
        """Show the state and what was refused, and let the browser send its next message."""
        if self.units != state.units:
            self.rows = [_row(scale(n, state.units).field) for n in self._names]
        values = state.parameters.to_dict() | {SPEED.name: state.speed}
        base = state.base().to_dict() | {SPEED.name: State.param.speed.default}
        self.param.update(
            units=state.units,
            values={n: scale(n, state.units).shown(value) for n, value in values.items()},
            base={n: scale(n, state.units).shown(value) for n, value in base.items()},
            preset=state.preset,
            vehicle=state.vehicle,
            provenance=words,
            refused=refused,
            answered=self._number,
        )


def _row(field: Field) -> dict[str, Any]:
    symbol, _, subscript = field.symbol.partition("_")
    return {
        "name": field.name,
        "symbol": symbol,
        "subscript": subscript,
        "unit": field.unit,
        "label": field.label,
        "meaning": field.description,
        "group": field.group,
        "span": list(field.span),
        "log": field.log,
    }
