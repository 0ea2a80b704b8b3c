"""The toolbar: undo and redo, the baseline, files, the link; and what there is to say of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import param

from hunting_app import files
from hunting_app.component import Component
from hunting_app.scripts import script
from hunting_app.state import FIELDS

if TYPE_CHECKING:
    from collections.abc import Callable

    from hunting_app.history import History, Step
    from hunting_app.state import State

_HERE = Path(__file__).parent
_CALLED = {
    "speed": "speed V",
    "pair": "motions beside the unstable cycle",
    "curve": "stability plot",
    "exact": "exact branch",
    "averaged": "averaged branch",
}


class Toolbar(Component):
    """Buttons beside the title, on every page; also Ctrl+Z, and files that are dropped."""

    served = param.Boolean(doc="Whether page and address bar are all ours.")
    undo = param.String(doc="What would be taken back; empty if nothing.")
    redo = param.String(doc="What would be done again; empty if nothing.")
    pinned = param.Boolean(doc="Whether there is a baseline.")
    baseline = param.String(doc="The baseline's name.")
    pinnable = param.Boolean(default=True, doc="Whether the baseline is another design.")
    largest = param.Integer(default=files.LARGEST, doc="The largest file [bytes] that is sent.")
    notices = param.List(doc="What was refused.")
    said = param.List(default=["", 0], doc="What was done, and how many things were before it.")
    answered = param.Integer(doc="Number of the last message that was dealt with.")

    _esm: ClassVar = script("dom", "toolbar")
    _stylesheets: ClassVar = [(_HERE / "toolbar.css").read_text(encoding="utf-8")]

    def __init__(self, state: State, act: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(margin=0, styles={"flex": "0 1 auto", "align-self": "center"}, **params)
        self._state, self._act = state, act

    def _handle_msg(self, data: Any) -> None:
        if data["act"] == {"save": True}:
            text, kind = files.parameters_json(self._state), "application/json"
            self._send_msg({"name": "bogie-parameters.json", "text": text, "type": kind})
        else:
            self._act(data["act"])
        self.answered = data["number"]

    def present(self, history: History, notices: list[str], said: str) -> None:
        """Show what can be done, what was refused and, if anything is said, what was done."""
        now = self._state.design()
        pinned = self._state.baseline
        self.param.update(
            undo=_described(history.past),
            redo=_described(history.future),
            pinned=pinned is not None,
            baseline=pinned.name if pinned else "",
            pinnable=pinned is None or not pinned.same(now),
            notices=notices,
        )
        if said:
            self.said = [said, self.said[1] + 1]


def _described(steps: list[Step]) -> str:
    """Return what the last step changed, in a few words."""
    if not steps:
        return ""
    before, after = steps[-1]
    if "preset" in before or "parameters" not in before:
        return ", ".join(_CALLED.get(name, name) for name in before if name != "parameters")
    old, new = before["parameters"], after["parameters"]
    changed = [f.symbol for n, f in FIELDS.items() if getattr(old, n) != getattr(new, n)]
    return ", ".join(changed) if len(changed) <= 3 else f"{len(changed)} parameters"
