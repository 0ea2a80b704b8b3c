"""Undo and redo: what each edit changed, and the values before and after it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

Values = dict[str, Any]
Step = tuple[Values, Values]
LONGEST = 300  # steps; earlier ones are forgotten


@dataclass
class History:
    """Steps, each one edit, of named values that are replaced, never altered.

    A step knows only the names that its edit changed, so that taking it back leaves the others as
    they are.

    Examples
    --------
    >>> history = History({"speed": 145, "vehicle": "bogie"})
    >>> history.note({"speed": 160, "vehicle": "bogie"})
    >>> history.undo()
    {'speed': 145}
    >>> history.redo()
    {'speed': 160}
    """

    now: Values
    past: list[Step] = field(default_factory=list)
    future: list[Step] = field(default_factory=list)

    def note(self, now: Mapping[str, Any]) -> None:
        """End an edit: what differs from before becomes a step, and nothing is left to redo."""
        changed = [name for name in self.now if _differ(self.now[name], now[name])]
        if changed:
            self.past.append(({n: self.now[n] for n in changed}, {n: now[n] for n in changed}))
            del self.past[:-LONGEST]
            self.future.clear()
            self.now = dict(now)

    def take(self, values: Mapping[str, Any]) -> None:
        """Count these values as given: they are no step."""
        self.now |= values

    def undo(self) -> Values:
        """Return the values from before the last step; none if there is no step."""
        return self._step(self.past, self.future, 0)

    def redo(self) -> Values:
        """Return the values of the step that was taken back last; none if there is no such."""
        return self._step(self.future, self.past, 1)

    def _step(self, source: list[Step], target: list[Step], side: int) -> Values:
        if not source:
            return {}
        step = source.pop()
        target.append(step)
        self.now |= step[side]
        return dict(step[side])


def _differ(one: Any, other: Any) -> bool:
    return one is not other and one != other
