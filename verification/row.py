"""One line of the table: what is compared, both answers, and how far apart they may be."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A comparison.

    Attributes
    ----------
    what : str
        What is compared, with its unit.
    ours, theirs : float
        The program's answer and the yardstick's.
    allowed : float
        Largest difference that passes.
    absolute : bool, default False
        Whether the difference is meant as it is; else it is relative to the yardstick's answer.
    """

    what: str
    ours: float
    theirs: float
    allowed: float
    absolute: bool = False

    @property
    def difference(self) -> float:
        """How far apart the answers are; NaN if one is missing."""
        apart = abs(self.ours - self.theirs)
        return apart if self.absolute else apart / abs(self.theirs)

    @property
    def passes(self) -> bool:
        """Whether the answers agree."""
        return self.difference <= self.allowed


def worst(rows: Iterable[Row]) -> Row:
    """Return the row that uses up most of what it is allowed, a missing answer first of all."""
    return max(rows, key=lambda row: (not row.passes, row.difference / row.allowed))
