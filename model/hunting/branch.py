"""A branch of limit cycles over speed, whichever method found it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hunting.elements import Array, Phasor
from hunting.lure import LureSystem


@dataclass(frozen=True)
class Motion:
    """A motion over time.

    Attributes
    ----------
    time : ndarray, shape (n_times,)
        Time [s].
    state : ndarray, shape (n_times, n)
        States in the order of `LureSystem.states`.
    forces : dict of str to ndarray, shape (n_times,)
        Whole force of each element [N].
    """

    time: Array
    state: Array
    forces: dict[str, Array]


@dataclass(frozen=True)
class LimitCycle:
    """One limit cycle of a branch at a chosen speed.

    Attributes
    ----------
    amplitude : float
        Peak lateral displacement [m].
    frequency : float
        Angular frequency [rad/s].
    stable : bool
        Whether neighbouring motions approach it.
    motion : Motion
        One period.
    """

    amplitude: float
    frequency: float
    stable: bool
    motion: Motion


@dataclass(frozen=True)
class Branch:
    """Limit cycles that grow out of a Hopf point, in order of the branch.

    For a stack of systems every array has the stack's axes first; entries that do not exist are
    NaN. A system without a Hopf point has an empty branch.

    Attributes
    ----------
    amplitude : ndarray, shape (..., m)
        Peak lateral displacement of the wheelset [m]; the first point is the Hopf point, 0.
    speed : ndarray, shape (..., m)
        Forward speed [m/s].
    frequency : ndarray, shape (..., m)
        Angular frequency [rad/s].
    stable : ndarray of bool, shape (..., m)
        Whether neighbouring motions approach the cycle.
    harmonics : ndarray, complex, shape (..., m, h, n)
        x(t) = sum_j Re(harmonics[j] exp(i orders[j] omega t)).
    orders : tuple of int
        The h harmonics kept.
    fold : tuple of (float or ndarray), or None
        Speed [m/s] and amplitude [m] of the lowest saddle-node of limit cycles below the Hopf
        speed. None where there is none; in a stack NaN.
    system : LureSystem
        The system the branch belongs to.
    multipliers : ndarray, complex, shape (..., m, n), or None
        Floquet multipliers; None for averaging, which has none.
    message : str, or ndarray of str, shape (...)
        What a reader of the branch must know, in words; empty if nothing.
    """

    amplitude: Array
    speed: Array
    frequency: Array
    stable: Array
    harmonics: Phasor
    orders: tuple[int, ...]
    fold: tuple[float, float] | tuple[Array, Array] | None
    system: LureSystem
    multipliers: Phasor | None = None
    message: str | Array = ""

    def motion(self, index: int, samples: int = 257) -> Motion:
        """Return one period of point `index`.

        Parameters
        ----------
        index : int
            Point of the branch of a single system.
        samples : int, default 257
            Number of instants; the last one closes the period.

        Returns
        -------
        Motion
        """
        return self._motion(self.harmonics[index], self.frequency[index], samples)

    def at_speed(self, speed: float, samples: int = 257) -> list[LimitCycle]:
        """Return the limit cycles at `speed`, smallest first.

        They are interpolated between the two points of the branch around each crossing.

        Parameters
        ----------
        speed : float
            Forward speed [m/s].
        samples : int, default 257
            Number of instants in each period.

        Returns
        -------
        list of LimitCycle
            Empty if the branch has none there.
        """
        V = self.speed
        with np.errstate(invalid="ignore"):
            crossing = np.flatnonzero((V[:-1] - speed) * (V[1:] - speed) < 0)
        cycles = []
        for i in crossing:
            share = (speed - V[i]) / (V[i + 1] - V[i])

            def between(values: Array, i: int = int(i), share: float = share) -> Array:
                return values[i] + share * (values[i + 1] - values[i])

            omega = float(between(self.frequency))
            cycles.append(
                LimitCycle(
                    amplitude=float(between(self.amplitude)),
                    frequency=omega,
                    stable=bool(self.stable[i + 1] if share > 0.5 else self.stable[i]),
                    motion=self._motion(between(self.harmonics), omega, samples),
                )
            )
        return sorted(cycles, key=lambda cycle: cycle.amplitude)

    def _motion(self, harmonics: Phasor, omega: float, samples: int) -> Motion:
        phase = np.linspace(0, 2 * np.pi, samples)
        state = (np.exp(1j * np.outer(phase, self.orders)) @ harmonics).real
        return Motion(phase / omega, state, self.system.forces(state))
