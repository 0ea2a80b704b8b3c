"""Disturbances: the state a click stands for, the motion from it, and how it ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hunting.simulation import Decay, Trajectory, decays, simulate
from hunting_app.picture import KMH, MM

if TYPE_CHECKING:
    from hunting.branch import LimitCycle
    from hunting.elements import Array
    from hunting_app.picture import Answers, Moment

BESIDE = (0.9, 1.1)  # what the two disturbances are of the unstable cycle
_SHOWN = {False: 15.0, True: 60.0}  # s of one motion, of two beside the unstable cycle
HORIZON = 300.0  # s over which the end of a motion is looked for
_SAMPLES = 80.0  # 1/s: some 35 in a hunting period
_MOST_STEPS = 10_000  # 4 s of work, for what takes a tenth of a second in any real vehicle
_SWINGS = 1e-3  # share of a swinging mode's eigenvalue that is imaginary


@dataclass(frozen=True)
class Disturbed:
    """Motions of one vehicle at one speed, from one disturbance or from two.

    Attributes
    ----------
    vehicle : str
        ``"bogie"`` or ``"wheelset"``.
    speed : float
        Forward speed [km/h].
    sizes : ndarray, shape (k,)
        Peak lateral displacements that the motions begin with [m].
    initial : ndarray, shape (k, n)
        Their first states.
    from_cycle : bool
        Whether these have the shape of a limit cycle, not of the least damped mode.
    trajectory : Trajectory
        The motions; its first axis is that of the disturbances.
    """

    vehicle: str
    speed: float
    sizes: Array
    initial: Array
    from_cycle: bool
    trajectory: Trajectory

    def decay(self) -> Decay:
        """Return whether they die out, and how long it takes. Takes about a second."""
        return decays(
            self.trajectory.system,
            self.speed / KMH,
            self.initial,
            horizon=HORIZON,
            most_steps=2 * _MOST_STEPS,
        )

    def column(self, symbol: str, index: int) -> Array:
        """Return a state [mm, mrad or per second] over time; zeros if the vehicle has none."""
        symbols = self.trajectory.system.symbols
        if symbol not in symbols:
            return np.zeros_like(self.trajectory.time)
        return MM * self.trajectory.state[index, :, symbols.index(symbol)]

    def touching(self) -> Array:
        """Return the largest flange force of the motions over time [N]."""
        return np.nanmax(np.abs(np.nan_to_num(self.trajectory.forces["flange force"])), axis=0)


def threshold(moment: Moment) -> LimitCycle | None:
    """Return the unstable cycle that small disturbances have to exceed, if there is one."""
    return next((cycle for cycle in moment.cycles if not cycle.stable), None)


def disturbed(
    answers: Answers, moment: Moment, speed: float, size: float | None
) -> Disturbed | None:
    """Return the motions from a disturbance, or from both sides of the unstable cycle.

    The first state has the shape of the limit cycle of nearest amplitude at that speed, at its
    peak and scaled; where there is none, that of the least damped mode.

    Parameters
    ----------
    answers, moment
        What the model says of the vehicle, and at this speed.
    speed : float
        Forward speed [km/h].
    size : float or None
        Peak lateral displacement [mm]; None for two motions beside the unstable cycle.

    Returns
    -------
    Disturbed or None
        None where there is no unstable cycle to be beside of.
    """
    unstable = threshold(moment)
    system = answers.branch.system
    if size is not None:
        sizes = np.array([size / MM])
    elif unstable is not None:
        sizes = np.array(BESIDE) * unstable.amplitude
    else:
        return None
    near = min(moment.cycles, key=lambda c: abs(c.amplitude - sizes.mean()), default=None)
    shape = (
        _least_damped(system.matrix(speed / KMH)) if near is None else _peak(near, system.output)
    )
    initial = sizes[:, None] * shape / (shape @ system.output)
    motion = simulate(
        system,
        speed / KMH,
        initial,
        _SHOWN[size is None],
        samples=_SAMPLES,
        most_steps=_MOST_STEPS,
    )
    return Disturbed(answers.vehicle, speed, sizes, initial, near is not None, motion)


def _peak(cycle: LimitCycle, output: Array) -> Array:
    state = cycle.motion.state
    return state[np.abs(state @ output).argmax()]


def _least_damped(A: Array) -> Array:
    """Return the mode that swings longest, or else decays most slowly, as it passes its peak."""
    values, vectors = np.linalg.eig(A)
    swings = np.abs(values.imag) > _SWINGS * np.abs(values)
    mode = vectors[:, np.where(swings | ~swings.any(), values.real, -np.inf).argmax()]
    return (mode / mode[0]).real


def contacts(time: Array, force: Array) -> tuple[Array, Array]:
    """Return when contact begins and ends [s]; a contact cut off by the end is kept."""
    touches = np.concatenate([[False], np.nan_to_num(force) != 0, [False]])
    change = np.flatnonzero(touches[1:] != touches[:-1])
    return time[change[::2]], time[np.minimum(change[1::2], len(time) - 1)]
