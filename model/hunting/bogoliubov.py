"""Bogoliubov's first-order averaging (Eqs. 9 to 13), in closed form.

Near a Hopf point (V_c, omega) with eigenvectors r and l, l r = 1, the motion is
x = a Re(r exp(i phi)) with slowly varying amplitude and phase::

    da/dt = A1(a, V),    dphi/dt = omega + B1(a, V)                        (Eqs. 11 and 12)

The integrals of Eq. 13 over one period are describing functions N(a), so that::

    A1 = a Re[l A'(V_c) r (V - V_c) + l N(a) r]
    B1 =   Im[l A'(V_c) r (V - V_c) + l N(a) r]

and the branch of limit cycles, A1 = 0, gives the speed explicitly over the amplitude.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from hunting.branch import Branch
from hunting.elements import Array, Phasor
from hunting.lure import LureSystem
from hunting.stability import HopfPoints, hopf_points

REACH = 1.2  # branches are followed to this multiple of the clearance
NO_HOPF_POINT = "no Hopf point in range"


@dataclass(frozen=True)
class Averaging:
    """The averaged equations at one Hopf point of a system, or of each system of a stack.

    Attributes
    ----------
    system : LureSystem
        The system, its stack axes followed by one axis for amplitudes.
    speed, frequency : ndarray, shape (..., 1)
        V_c [m/s] and omega [rad/s] of the Hopf point; NaN where there is none.
    growth : ndarray, complex, shape (..., 1)
        l A'(V_c) r [1/m].
    right, left : ndarray, complex, shape (..., 1, n)
        Eigenvectors r and l.
    """

    system: LureSystem
    speed: Array
    frequency: Array
    growth: Phasor
    right: Phasor
    left: Phasor

    def A1(self, a: ArrayLike, V: ArrayLike) -> Array:
        """Return da/dt [m/s] at amplitude a [m] and speed V [m/s] (Eq. 11).

        Parameters
        ----------
        a, V : array_like
            Broadcast with the system's stack axes and one more.
        """
        a = np.asarray(a, dtype=float)
        return a * (self.growth * (V - self.speed) + self.gain(a)).real

    def B1(self, a: ArrayLike, V: ArrayLike) -> Array:
        """Return dphi/dt - omega [rad/s] at amplitude a [m] and speed V [m/s] (Eq. 12)."""
        return (self.growth * (V - self.speed) + self.gain(a)).imag

    def gain(self, a: ArrayLike) -> Phasor:
        """Return l N(a) r [1/s]: what the elements add to the eigenvalue at amplitude a [m]."""
        return self._sum("describing_function", a)

    def gain_slope(self, a: ArrayLike) -> Phasor:
        """Return d(l N(a) r)/da [1/(m s)]."""
        return self._sum("describing_slope", a)

    def branch_speed(self, a: ArrayLike) -> Array:
        """Return the speed V(a) [m/s] of the limit cycle of amplitude a [m]: A1(a, V) = 0."""
        return self.speed - self.gain(a).real / self.growth.real

    def branch_slope(self, a: ArrayLike) -> Array:
        """Return dV/da [1/s] along the branch."""
        return -self.gain_slope(a).real / self.growth.real

    def _sum(self, function: str, a: ArrayLike) -> Phasor:
        a = np.asarray(a, dtype=float)[..., None]
        total = 0.0
        for link in self.system.elements:
            seen = (link.C @ self.right[..., None])[..., 0]
            pushed = (self.left[..., None, :] @ link.B)[..., 0, :]
            size = np.abs(seen)
            value = getattr(link.element, function)(size * a)
            if function == "describing_slope":
                value = value * size
            total = total + (pushed * value * seen).sum(axis=-1)
        return np.asarray(total)


def averaging(
    system: LureSystem, hopf: HopfPoints | None = None, index: int | None = None
) -> Averaging:
    """Return the averaged equations at a Hopf point.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    hopf : HopfPoints, optional
        The system's Hopf points, if they are known already.
    index : int, optional
        Which of them; by default the hunting one, where the fastest unstable range begins.

    Returns
    -------
    Averaging

    Raises
    ------
    IndexError
        If there is no Hopf point `index`.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, wheelset
    >>> averaged = averaging(wheelset(RECONSTRUCTED))
    >>> averaged.A1(0.008, 40.0) > 0, averaged.A1(0.008, 42.0) > 0
    (array([False]), array([ True]))
    """
    hopf = hopf_points(system) if hopf is None else hopf
    pick, exists = _chosen(hopf, index)

    def at_point(values: Array) -> Array:
        if values.shape[pick.ndim] == 0:
            return np.full((*pick.shape, 1, *values.shape[pick.ndim + 1 :]), np.nan, values.dtype)
        extra = values.ndim - pick.ndim - 1
        where = pick.reshape(*pick.shape, *(1,) * (1 + extra))
        taken = np.take_along_axis(values, where, axis=pick.ndim)
        return np.where(exists.reshape(where.shape), taken, np.nan)

    return Averaging(
        system.with_axes(),
        speed=at_point(hopf.speed),
        frequency=at_point(hopf.frequency),
        growth=at_point(hopf.growth),
        right=at_point(hopf.right),
        left=at_point(hopf.left),
    )


def _chosen(hopf: HopfPoints, index: int | None) -> tuple[Array, Array]:
    if index is None:
        pick = hopf.hunting_index()
        return np.maximum(pick, 0), pick >= 0
    count = hopf.speed.shape[-1]
    if not 0 <= index < count:
        raise IndexError(f"hopf must be the index of one of {count} Hopf points, got {index}")
    return np.full(hopf.unstable_below.shape, index), np.isfinite(hopf.speed[..., index])


def default_amplitudes(clearance: ArrayLike, points: int = 240) -> Array:
    """Return amplitudes from 0 to 1.2 delta, denser where the flange begins to touch.

    Parameters
    ----------
    clearance : array_like
        Clearance delta [m].
    points : int, default 240
        How many.

    Returns
    -------
    ndarray, shape (..., points)
        The clearance itself is one of them.
    """
    free = points // 2
    below = 1 - np.linspace(1, 0, free) ** 1.5
    above = 1 + (REACH - 1) * np.linspace(0, 1, points - free + 1)[1:] ** 2
    return np.asarray(clearance, dtype=float)[..., None] * np.concatenate([below, above])


def averaged_branch(
    system: LureSystem,
    amplitudes: ArrayLike | None = None,
    hopf: int | None = None,
    points: HopfPoints | None = None,
) -> Branch:
    """Return the limit cycles of first-order averaging.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    amplitudes : array_like, shape (m,) or (..., m), optional
        Amplitudes of the wheelset's lateral displacement [m], rising from 0 or above; by default
        240 from 0 to 1.2 delta.
    hopf : int, optional
        Index of the Hopf point the branch starts at; by default the hunting one, where the
        fastest unstable range begins.
    points : HopfPoints, optional
        The system's Hopf points, if they are known already.

    Returns
    -------
    Branch
        Without Hopf point: empty for a single system, NaN in a stack.

    Raises
    ------
    ValueError
        If amplitudes are negative, not finite or not rising.
    IndexError
        If there is no Hopf point `hopf`.

    Notes
    -----
    Stable where dA1/da < 0. The branch leaves the Hopf point linearly in amplitude, as v|v| has no
    second derivative at rest.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, averaged_branch, wheelset
    >>> speed, amplitude = averaged_branch(wheelset(RECONSTRUCTED)).fold
    >>> round(3.6 * speed, 2), round(1e3 * amplitude, 2)  # km/h, mm
    (145.09, 9.23)
    """
    averaged = averaging(system, points, hopf)
    if amplitudes is None:
        a = default_amplitudes(system.clearance)
    else:
        a = checked_amplitudes(amplitudes)
    none = np.isnan(averaged.speed)
    if not system.shape and none.all():
        a = a[:0]
    a = np.broadcast_to(a, np.broadcast_shapes(a.shape, (*system.shape, 1))).copy()
    V = averaged.branch_speed(a)
    fold: tuple[Any, Any] | None = averaged_fold(averaged, a) if a.size else None
    if not system.shape and fold is not None:
        fold = (float(fold[0]), float(fold[1])) if np.isfinite(fold[0]) else None
    return Branch(
        amplitude=np.where(none, np.nan, a),
        speed=V,
        frequency=averaged.frequency + averaged.B1(a, V),
        stable=averaged.branch_slope(a) * averaged.growth.real > 0,
        harmonics=(a[..., None] * averaged.right)[..., None, :].astype(complex),
        orders=(1,),
        fold=fold,
        system=system,
        message=NO_HOPF_POINT if none.all() else "",
    )


def averaged_fold(averaged: Averaging, amplitudes: Array) -> tuple[Array, Array]:
    """Return speed and amplitude at which the averaged branch is slowest, if that is a fold.

    Parameters
    ----------
    averaged : Averaging
        The averaged equations.
    amplitudes : ndarray, shape (..., m)
        Amplitudes among which the fold is bracketed [m].

    Returns
    -------
    speed, amplitude : ndarray, shape (...)
        NaN where the branch never goes below the Hopf speed or is still falling at its end.

    Notes
    -----
    The dead band makes V(a) turn just above the clearance with unbounded curvature, so the fold is
    bracketed by the sign of dV/da and never fitted.
    """
    V = averaged.branch_speed(amplitudes)
    lowest = np.argmin(np.where(np.isnan(V), np.inf, V), axis=-1)[..., None]
    last = V.shape[-1] - 1
    a = np.broadcast_to(amplitudes, V.shape)
    low = np.take_along_axis(a, np.maximum(lowest - 1, 0), axis=-1)
    high = np.take_along_axis(a, np.minimum(lowest + 1, last), axis=-1)
    parts = np.linspace(0, 1, 17)
    for _ in range(14):  # 16^14 > 2^53
        grid = low + parts * (high - low)
        rising = averaged.branch_slope(grid[..., 1:-1]) > 0
        step = np.where(rising.any(axis=-1), np.argmax(rising, axis=-1), len(parts) - 2)[..., None]
        low = np.take_along_axis(grid, step, axis=-1)
        high = np.take_along_axis(grid, step + 1, axis=-1)
    amplitude = 0.5 * (low + high)
    speed = averaged.branch_speed(amplitude)
    is_fold = (lowest < last) & (speed < averaged.speed) & (amplitude > 0)
    return (
        np.where(is_fold, speed, np.nan)[..., 0],
        np.where(is_fold, amplitude, np.nan)[..., 0],
    )


def checked_amplitudes(amplitudes: ArrayLike) -> Array:
    """Return amplitudes as an array; ValueError unless finite, not negative and rising."""
    a = np.atleast_1d(np.asarray(amplitudes, dtype=float))
    if not (np.isfinite(a).all() and (a >= 0).all() and (np.diff(a, axis=-1) > 0).all()):
        raise ValueError(f"amplitudes must be finite, >= 0 m and rising, got {amplitudes!r}")
    return a
