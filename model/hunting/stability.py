"""Stability of the centred motion: eigenvalues over speed and every Hopf point, without a grid.

A(V) = A0 + A1/V + A2 V has two eigenvalues of opposite sign, among them every pair +-i omega,
exactly where its bialternate sum 2 A(V) (.) I - the map X -> A X + X A^T on antisymmetric X - is
singular. V times that map is quadratic in V, so one small eigenvalue problem gives every crossing
(W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, ch. 5).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from hunting.elements import Array, Phasor
from hunting.lure import LureSystem

SPEED_RANGE = (1.0, 400.0)
_SHIFT = -50.0  # m/s; the pencil is expanded about a speed that no crossing can have
_REAL = 1e-6  # relative imaginary part up to which an eigenvalue of the pencil counts as real
_SETTLED = 1e-9  # relative Newton step after which the error is beyond double precision


def eigenvalues(system: LureSystem, speeds: ArrayLike) -> Phasor:
    """Return the eigenvalues of A(V) at each speed.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    speeds : array_like, shape (n_speeds,)
        Forward speeds [m/s], > 0.

    Returns
    -------
    ndarray, complex, shape (..., n_speeds, n)
        In no particular order [1/s].

    Raises
    ------
    ValueError
        If a speed is not finite and positive.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie, eigenvalues
    >>> growth = eigenvalues(bogie(RECONSTRUCTED), [30.0, 45.0]).real.max(axis=-1)
    >>> growth > 0
    array([False,  True])
    """
    speeds = np.asarray(speeds, dtype=float)
    if not (np.isfinite(speeds).all() and (speeds > 0).all()):
        bad = speeds[~(np.isfinite(speeds) & (speeds > 0))].flat[0]
        raise ValueError(f"speeds must be > 0 m/s, got {float(bad)!r}")
    return np.linalg.eigvals(system.with_axes().matrix(speeds)).astype(complex, copy=False)


def damping_ratios(eigenvalues: Phasor) -> Array:
    """Return -Re(s)/|s| of each eigenvalue s: negative is unstable, 1 does not oscillate.

    Examples
    --------
    >>> damping_ratios(np.array([-0.3 + 0.4j, -2.0 + 0j]))
    array([0.6, 1. ])
    """
    return -eigenvalues.real / np.abs(eigenvalues)


@dataclass(frozen=True)
class HopfPoints:
    """Speeds at which a complex pair crosses the imaginary axis, in rising order.

    For a stack of systems every array has the stack's axes first and is padded with NaN (and
    direction 0) to the largest number of points.

    Attributes
    ----------
    speed : ndarray, shape (..., k)
        Forward speed [m/s].
    frequency : ndarray, shape (..., k)
        Angular frequency omega [rad/s].
    direction : ndarray of int, shape (..., k)
        +1 where the centred motion loses the stability of this pair with rising speed, -1 where
        it regains it.
    growth : ndarray, complex, shape (..., k)
        d(eigenvalue)/dV = l A'(V) r [1/m].
    right, left : ndarray, complex, shape (..., k, n)
        Eigenvectors r and l of the pair, l r = 1, the lateral displacement of r being 1.
    unstable_below : ndarray of int, shape (...)
        How many pairs are unstable at the lower end of the range.
    lowest : ndarray, shape (...)
        The lower end of the range [m/s].
    """

    speed: Array
    frequency: Array
    direction: Array
    growth: Phasor
    right: Phasor
    left: Phasor
    unstable_below: Array
    lowest: Array

    def take(self, index: ArrayLike) -> HopfPoints:
        """Return the points of the systems at `index` of the flattened stack.

        Parameters
        ----------
        index : int or array_like of int
            Places in the stack in C order.
        """
        axes = self.unstable_below.ndim
        return HopfPoints(
            *(part.reshape(-1, *part.shape[axes:])[index] for part in vars(self).values())
        )

    def unstable_pairs(self) -> Array:
        """Return the number of unstable pairs below each point and above the last one.

        Returns
        -------
        ndarray of int, shape (..., k + 1)
        """
        steps = np.concatenate([self.unstable_below[..., None], self.direction], axis=-1)
        return np.cumsum(steps, axis=-1)

    def hunting_index(self) -> Array:
        """Return the index of the Hopf point at which the fastest unstable range begins.

        Returns
        -------
        ndarray of int, shape (...)
            -1 where no such point exists.
        """
        stable_below = self.unstable_pairs()[..., :-1] == 0
        begins = (self.direction > 0) & stable_below
        k = begins.shape[-1]
        if k == 0:
            return np.full(begins.shape[:-1], -1)
        last = k - 1 - np.argmax(begins[..., ::-1], axis=-1)
        return np.where(begins.any(axis=-1), last, -1)


def hopf_points(system: LureSystem, speed_range: tuple[float, float] = SPEED_RANGE) -> HopfPoints:
    """Return every speed at which a complex pair crosses the imaginary axis.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    speed_range : tuple of float, default (1, 400)
        Lowest and highest speed looked at [m/s].

    Returns
    -------
    HopfPoints
        Empty arrays if there is no such point in the range.

    Raises
    ------
    ValueError
        If the range is not 0 < low < high.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, hopf_points, wheelset
    >>> points = hopf_points(wheelset(RECONSTRUCTED))
    >>> points.speed, points.frequency, points.direction
    (array([43.4614...]), array([14.4172...]), array([1]))
    """
    low, high = speed_range
    if not 0 < low < high < np.inf:
        raise ValueError(f"speed_range must be 0 < low < high m/s, got {speed_range!r}")
    stack = system.shape
    n = system.A0.shape[-1]
    A = (system.A0.reshape(-1, n, n), system.A1.reshape(-1, n, n), system.A2.reshape(-1, n, n))
    which, V = _candidates(A, low, high)
    V, omega, growth, right, left, which = _refined(A, which, V, system.output)
    inside = (low <= V) & (high >= V)
    V, omega, growth, right, left, which = (
        part[inside] for part in (V, omega, growth, right, left, which)
    )
    order = np.lexsort((V, which))
    slot, depth = _slots(which[order], len(A[0]))

    def padded(values: Array, empty: float) -> Array:
        shape = (len(A[0]), depth, *values.shape[1:])
        out = np.full(shape, empty, dtype=values.dtype)
        out[which[order], slot] = values[order]
        return out.reshape(*stack, depth, *values.shape[1:])

    at_low = np.linalg.eigvals(system.matrix(low))
    return HopfPoints(
        speed=padded(V, np.nan),
        frequency=padded(omega, np.nan),
        direction=padded(np.sign(growth.real).astype(np.int64), 0),
        growth=padded(growth, np.nan),
        right=padded(right, np.nan),
        left=padded(left, np.nan),
        unstable_below=((at_low.real > 0) & (at_low.imag > 0)).sum(axis=-1),
        lowest=np.full(stack, float(low)),
    )


def _slots(which: Array, count: int) -> tuple[Array, int]:
    """Return each entry's place among those of its system, and the largest number of places."""
    found = np.bincount(which, minlength=count)
    first = np.cumsum(found) - found
    return np.arange(len(which)) - first[which], int(found.max(initial=0))


@cache
def _bialternate_map(n: int) -> Array:
    """Return the linear map from the n^2 entries of A to the entries of its bialternate sum."""
    p, q = np.tril_indices(n, -1)
    N = len(p)
    place = np.zeros((n, n), dtype=int)
    sign = np.zeros((n, n))
    place[p, q], sign[p, q] = np.arange(N), 1.0
    place[q, p], sign[q, p] = np.arange(N), -1.0
    T = np.zeros((N, N, n, n))
    row = np.arange(N)
    for r in range(n):  # (A X)_pq = sum_r A_pr X_rq and (X A^T)_pq = sum_r X_pr A_qr
        T[row, place[r, q], p, r] += sign[r, q]
        T[row, place[p, r], q, r] += sign[p, r]
    return T.reshape(N * N, n * n)


def _bialternate(A: Array) -> Array:
    T = _bialternate_map(A.shape[-1])
    N = round(len(T) ** 0.5)
    return (A.reshape(len(A), -1) @ T.T).reshape(-1, N, N)


def _candidates(A: tuple[Array, Array, Array], low: float, high: float) -> tuple[Array, Array]:
    """Return (system, V) of every real root of det(V^2 K2 + V K0 + K1) in the range.

    Rows of the bialternate sum that do not depend on V are constraints: X is sought in their null
    space. What is left is linearised with as many extra unknowns as K2 has rows: 7 in all for the
    wheelset and 13 for the bogie, in place of 12 and 30.
    """
    K0, K1, K2 = map(_bialternate, A)
    moving = np.any(K1 != 0, axis=(0, 2)) | np.any(K2 != 0, axis=(0, 2))
    constraints = np.swapaxes(K0[:, ~moving], -1, -2)
    null_space = np.linalg.qr(constraints, mode="complete").Q[..., constraints.shape[-1] :]
    K0, K1, K2 = (K[:, moving] @ null_space for K in (K0, K1, K2))
    turning = np.flatnonzero(np.any(K2 != 0, axis=(0, 2)))
    m, e = K0.shape[-1], len(turning)

    # With V = V0 + 1/mu: (mu^2 P(V0) + mu P'(V0) + K2) xi = 0 and eta = K2 xi / mu.
    V0 = _SHIFT
    right_sides = np.zeros((len(K0), m, m + e))
    right_sides[..., :m] = K0 + 2 * V0 * K2
    right_sides[:, turning, m + np.arange(e)] = 1.0
    M = np.zeros((len(K0), m + e, m + e))
    M[:, :m] = -np.linalg.solve(V0**2 * K2 + V0 * K0 + K1, right_sides)
    M[:, m:, :m] = K2[:, turning]
    mu = np.linalg.eigvals(M).astype(complex, copy=False)

    ahead = mu.real > 0.5 / (high - V0)
    V = np.zeros(mu.shape)
    np.divide(1.0, mu.real, out=V, where=ahead)
    V += V0
    real = np.abs(mu.imag) <= _REAL * np.abs(mu)
    margin = 1e-3
    found = ahead & real & (low * (1 - margin) < V) & (high * (1 + margin) > V)
    which, column = np.nonzero(found)
    return which, V[which, column]


def _refined(
    A: tuple[Array, Array, Array], which: Array, V: Array, output: Array
) -> tuple[Array, Array, Phasor, Phasor, Phasor, Array]:
    """Polish the candidates by Newton's method on Re(lambda) = 0; drop those that are no pair."""
    n = A[0].shape[-1]
    done: list[tuple[Array, ...]] = []
    for _ in range(8):
        if len(V) == 0:
            break
        A0, A1, A2 = (M[which] for M in A)
        speed = V[:, None, None]
        lam, r, l = _nearest_pair(A0 + A1 / speed + A2 * speed, output)
        growth = np.einsum("mi,mij,mj->m", l, A2 - A1 / speed**2, r)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -lam.real / growth.real
        good = np.abs(step) <= 0.01 * V  # False for NaN: a pair of real eigenvalues
        settled = good & (np.abs(step) <= _SETTLED * V)
        refined = V + step
        omega = (lam + growth * step).imag
        done.append(tuple(part[settled] for part in (refined, omega, growth, r, l, which)))
        going = good & ~settled
        which, V = which[going], refined[going]
    if not done:
        empty = np.zeros(0)
        vectors = np.zeros((0, n), dtype=complex)
        return empty, empty, empty.astype(complex), vectors, vectors, which
    V, omega, growth, r, l, which = (np.concatenate(parts) for parts in zip(*done, strict=True))
    keep = _distinct(which, V)
    return V[keep], omega[keep], growth[keep], r[keep], l[keep], which[keep]


def _nearest_pair(A: Array, output: Array) -> tuple[Phasor, Phasor, Phasor]:
    """Return the upper eigenvalue nearest the imaginary axis with its eigenvectors, or NaN."""
    lam, R = np.linalg.eig(A)
    distance = np.where(lam.imag > 0, np.abs(lam.real), np.inf)
    best = np.argmin(distance, axis=-1)[:, None]
    oscillates = np.isfinite(np.take_along_axis(distance, best, axis=-1)[:, 0])
    pick = np.zeros((len(A), A.shape[-1], 1))
    np.put_along_axis(pick, best[..., None], 1.0, axis=1)
    l = np.linalg.solve(np.swapaxes(R, -1, -2).astype(complex), pick)[..., 0]
    r = (R @ pick)[..., 0]
    scale = r @ output
    # Fast creep modes leave their rounding on every eigenvalue, but not on a Rayleigh quotient.
    chosen = np.einsum("mi,mij,mj->m", l, A, r) / np.einsum("mi,mi->m", l, r)
    chosen[~oscillates] = np.nan
    return chosen, r / scale[:, None], l * scale[:, None]


def _distinct(which: Array, V: Array) -> Array:
    """Return the indices of the entries that do not repeat another one of the same system."""
    order = np.lexsort((V, which))
    repeats = (np.diff(which[order]) == 0) & (np.diff(V[order]) <= 1e-9 * V[order][1:])
    return order[np.concatenate([[True], ~repeats])] if len(order) else order
