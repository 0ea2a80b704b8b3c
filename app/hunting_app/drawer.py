"""The drawer with the designs that were kept: a table to compare, switch and export them."""

from __future__ import annotations

import math
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import panel as pn
import param

from hunting.tables import rows
from hunting_app import files
from hunting_app.component import Component
from hunting_app.designs import MOST, differences
from hunting_app.pace import after
from hunting_app.picture import KMH, critical
from hunting_app.scripts import script
from hunting_app.state import FIELDS, VEHICLES

if TYPE_CHECKING:
    from collections.abc import Callable

    from hunting.parameters import Parameters
    from hunting_app.state import Design, State

_HERE = Path(__file__).parent
_GAP = 20  # ms between two designs that are computed, in which others are served


class Drawer(Component):
    """A button and, over the lower plots, the table; the designs live in the browser's memory.

    Critical speeds are computed only while the drawer is open, one design at a time.
    """

    served = param.Boolean(doc="Whether the page is all ours, and with it the browser's memory.")
    count = param.Integer(doc="How many designs are kept.")
    rows = param.List(doc="Each design: name, what it changes, critical speeds, whether shown.")
    columns = param.List(doc="Of each column of critical speeds, subscript and vehicle.")
    stored = param.String(doc="All designs as JSON, for the browser to remember.")
    answered = param.Integer(doc="Number of the last message that was dealt with.")

    _esm: ClassVar = script("dom", "drawer")
    _stylesheets: ClassVar = [(_HERE / "drawer.css").read_text(encoding="utf-8")]

    def __init__(self, state: State, act: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(margin=0, styles={"flex": "none", "align-self": "center"}, **params)
        self._state, self._act = state, act
        self._open = False
        self._written: tuple[Design, ...] = ()
        self._known: dict[tuple[Any, ...], list[str]] = {}
        self._late: Any = None

    def _handle_msg(self, data: Any) -> None:
        match data["act"]:
            case {"open": bool(is_open)}:
                self._open = is_open
                with pn.io.hold():
                    self.present()
            case {"export": "csv"}:
                self._send_msg({"name": "designs.csv", "text": self.csv(), "type": "text/csv"})
            case {"export": "json"}:
                text, kind = files.designs_json(self._state.designs), "application/json"
                self._send_msg({"name": "designs.json", "text": text, "type": kind})
            case act:
                self._act(act)
        self.answered = data["number"]

    def present(self) -> None:
        """Show the designs; the table follows as far as it is seen."""
        designs = self._state.designs
        if self._written is not designs:
            self._written = designs
            self.param.update(stored=files.designs_json(designs), count=len(designs))
        if self._open:
            self._fill()

    def _fill(self) -> None:
        state, speeds = self._state, self._speeds()
        self.param.update(
            rows=[
                {
                    "name": design.name,
                    "changed": differences(design),
                    "speeds": ["…"] * 2 * len(self._vehicles) if known is None else known,
                    "shown": design.same(state.design()),
                    "pinned": state.baseline is not None and design.same(state.baseline),
                }
                for design, known in zip(state.designs, speeds, strict=True)
            ],
            columns=[
                [symbol, vehicle if len(self._vehicles) > 1 else ""]
                for vehicle in self._vehicles
                for symbol in ("nl", "lin")
            ],
        )
        if None in speeds and self._late is None:
            self._late = after(_GAP, self._compute_one)

    @property
    def _vehicles(self) -> tuple[str, ...]:
        return VEHICLES[self._state.vehicle]

    def _key(self, design: Design) -> tuple[Any, ...]:
        state = self._state
        return (*design.parameters.to_dict().values(), state.vehicle, state.exact)

    def _speeds(self) -> list[list[str] | None]:
        """V_nl and V_lin [km/h] of each vehicle for each design; None where not known yet."""
        return [self._known.get(self._key(design)) for design in self._state.designs]

    def _compute_one(self) -> None:
        """Compute the first design that is not known yet."""
        self._late = None
        wanted = (d for d in self._state.designs if self._key(d) not in self._known)
        if (design := next(wanted, None)) is None:
            return
        if len(self._known) > 4 * MOST:
            self._known.clear()
        self._known[self._key(design)] = _written(
            design.parameters, self._vehicles, exact=self._state.exact == "shown"
        )
        with pn.io.hold():
            self._fill()

    def csv(self) -> str:
        """Return the table as CSV: names, critical speeds and all parameters."""
        designs, speeds = self._state.designs, self._speeds()
        method = "exact" if self._state.exact == "shown" else "averaging"
        table: dict[str, Any] = {"design": [d.name for d in designs]}
        table["preset"] = [d.preset for d in designs]
        for k, vehicle in enumerate(self._vehicles):
            for i, symbol in enumerate(("V_nl", "V_lin")):
                texts = [known[2 * k + i] if known else "" for known in speeds]
                table[f"{symbol} of the {vehicle} [km/h]"] = texts
        for name, field in FIELDS.items():
            table[f"{name} [{field.unit}]"] = [getattr(d.parameters, name) for d in designs]
        made_by = f"# bogie-hunting {version('bogie-hunting')}\n# critical speeds: {method}\n"
        return f"# designs\n{made_by}{rows(table)}"


def _written(parameters: Parameters, vehicles: tuple[str, ...], exact: bool) -> list[str]:
    """Return V_nl and V_lin [km/h] of each vehicle as they are shown."""
    try:
        found = [critical(parameters, vehicle, exact) for vehicle in vehicles]
    except ValueError:
        return ["none"] * 2 * len(vehicles)
    speeds = [KMH * float(V) for one in found for V in (one.nonlinear, one.linear)]
    return [f"{V:.1f}" if math.isfinite(V) else "none" for V in speeds]
