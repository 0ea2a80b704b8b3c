"""Limit cycles of the program at given amplitudes, one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hunting import LureSystem, limit_cycles


@dataclass(frozen=True)
class Cycle:
    """A limit cycle: peak |y| [m], speed [m/s], frequency [rad/s], stability, a state on it."""

    amplitude: float
    speed: float
    frequency: float
    stable: bool
    multipliers: NDArray[np.complex128]
    start: NDArray[np.float64]

    @property
    def hertz(self) -> float:
        """Frequency [Hz]."""
        return self.frequency / (2 * np.pi)

    @property
    def multiplier(self) -> float:
        """Largest modulus of its nontrivial multipliers."""
        return dominant(self.multipliers)


def cycles_at(
    system: LureSystem, amplitudes: Sequence[float], harmonics: int, hopf: int | None = None
) -> list[Cycle]:
    """Return the program's limit cycles of the given amplitudes [m].

    Raises
    ------
    RuntimeError
        If the program did not find all of them.
    """
    branch = limit_cycles(system, amplitudes, harmonics=harmonics, hopf=hopf)
    at = [np.flatnonzero(branch.amplitude == amplitude) for amplitude in amplitudes]
    if branch.multipliers is None or not all(len(places) for places in at):
        raise RuntimeError(f"cycles are missing from the branch: {branch.message}")
    return [
        Cycle(
            amplitude=float(branch.amplitude[i]),
            speed=float(branch.speed[i]),
            frequency=float(branch.frequency[i]),
            stable=bool(branch.stable[i]),
            multipliers=branch.multipliers[i],
            start=branch.motion(int(i)).state[0],
        )
        for (i, *_) in at
    ]


def dominant(multipliers: NDArray[np.complex128]) -> float:
    """Return the largest modulus of Floquet multipliers but the trivial one, nearest 1."""
    rest = np.delete(multipliers, np.argmin(np.abs(multipliers - 1)))
    return float(np.abs(rest).max())
