"""Where a branch turns: its folds, from cycles on both sides of them.

Speed over amplitude is smooth below the clearance. Above it, it is smooth in the root of the
excess, w = sqrt(Y/delta - 1): the dead band adds a term in w^3. So V is interpolated in Y or in w,
between cycles whose slopes are known, and never fitted across the clearance.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hunting.elements import Array
from hunting.harmonic_balance import Balance, Solution, at_amplitude, polished, solve
from hunting.ports import orders_up_to

FREE = 1 - 1e-4  # of the clearance: what does not touch yet, whatever the rounding
CRUDE_FOLD = 3e-6  # relative change of its speed by higher harmonics that asks for more of them
_ROUGH = 1e-4  # relative Newton step, squared by the next one, that intermediate cycles end with
_CLOSE = 1e-7  # relative change of the fold's speed still possible in the bracket
_ROUNDS = 20


def closed_in(balance: Balance, low: Solution, high: Solution, delta: Array) -> Solution:
    """Return the cycles at the folds between pairs of cycles whose slopes differ in sign.

    Parameters
    ----------
    balance : Balance
        The equations of one system, or of each of M systems.
    low, high : Solution
        M cycles each, found at given amplitudes, the first ones smaller.
    delta : ndarray, shape (M,)
        The clearance.

    Returns
    -------
    Solution
        Not converged where the search failed.
    """
    low, high, best = low.copy(), high.copy(), low.copy()
    rises = low.V_slope > 0
    going = np.arange(len(delta))
    for round_ in range(_ROUNDS):
        if len(going) == 0:
            break
        a, b = low[going], high[going]
        Y = _turning(a, b, delta[going])
        if round_ % 3 == 2:  # a bend that the cubic keeps missing
            Y = 0.5 * (a.cycles.Y + b.cycles.Y)
        share = (Y - a.cycles.Y) / (b.cycles.Y - a.cycles.Y)
        guess = replace(a.cycles.towards(b.cycles, share), Y=Y)
        tried = solve(balance.take(going), guess, at_amplitude(Y), tolerance=_ROUGH)
        best.put(going, tried)
        before = (tried.V_slope > 0) == rises[going]
        low.put(going[before], tried[before])
        high.put(going[~before], tried[~before])
        still = np.abs(tried.V_slope * (_turning(low[going], high[going], delta[going]) - Y))
        going = going[tried.converged & (still > _CLOSE * tried.cycles.V)]
    best.converged[going] = False
    return best


def found_between(
    balance: Balance, low: Solution, high: Solution, delta: Array
) -> tuple[Solution, Array]:
    """Return the folds between pairs of cycles, and whether their harmonics do.

    Parameters
    ----------
    balance, low, high, delta
        As for `closed_in`.

    Returns
    -------
    Solution
        The cycles at the folds, corrected by higher harmonics; not converged where that failed.
    sure : ndarray of bool, shape (M,)
        Whether the fold was found and the correction is negligible.
    """
    folds = closed_in(balance, low, high, delta)
    final = polished(balance, folds)
    change = np.abs(final.cycles.V / folds.cycles.V - 1)
    sure = low.converged & high.converged & final.converged & (change <= CRUDE_FOLD)
    return final, sure


def refined(balance: Balance, low: Solution, high: Solution) -> tuple[Balance, Solution, Solution]:
    """Return the equations with twice the harmonics, and how they solve these cycles.

    Parameters
    ----------
    balance : Balance
        The equations of one system, or of each of M systems.
    low, high : Solution
        M cycles each; those of no amplitude are Hopf points and stay what they are.
    """
    finer = replace(balance, orders=orders_up_to(4 * len(balance.orders) - 1))

    def solved(found: Solution) -> Solution:
        found = replace(found, cycles=found.cycles.resized(len(finer.orders)))
        moving = np.flatnonzero(found.cycles.Y > 0)
        guess, Y = found.cycles[moving], found.cycles.Y[moving]
        found.put(moving, solve(finer.take(moving), guess, at_amplitude(Y), tolerance=_ROUGH))
        return found

    return finer, solved(low), solved(high)


def _turning(low: Solution, high: Solution, delta: Array) -> Array:
    return turning_amplitude(
        np.array([low.cycles.Y, high.cycles.Y]),
        np.array([low.cycles.V, high.cycles.V]),
        np.array([low.V_slope, high.V_slope]),
        delta,
    )


def turning_amplitude(Y: Array, V: Array, slope: Array, delta: Array) -> Array:
    """Return the amplitude between two cycles at which the speed is stationary.

    Parameters
    ----------
    Y, V, slope : ndarray, shape (2, M)
        Amplitude, speed and dV/dY of the two cycles, the slopes of opposite sign. Where the
        clearance lies between them, the first has `FREE` amplitude or more: it all but touches.
    delta : float or ndarray, shape (M,)
        The clearance.

    Returns
    -------
    ndarray, shape (M,)
    """
    w = np.sqrt(np.maximum(Y / delta - 1, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        free = _stationary_point(Y, V, slope)
        pressed = _stationary_point(w, V, 2 * delta * w * slope)
        touch = np.array([V[0] + slope[0] * (delta - Y[0]), V[1]])
        touching = _first_touch(w[1], touch, slope, delta)
    beyond = delta * (1 + np.where(w[0] > 0, pressed, touching) ** 2)
    return np.where(Y[1] <= delta, free, beyond)


def _first_touch(w: Array, V: Array, slope: Array, delta: Array) -> Array:
    """Return w where V = V0 + A w^2 + B w^3 + C w^4 is stationary; the slope at w = 0 gives A."""
    A = delta * slope[0]
    rise, steep = V[1] - V[0] - A * w**2, 2 * w * (delta * slope[1] - A)
    B = (4 * rise - steep * w) / w**3
    C = (steep * w - 3 * rise) / w**4
    return _root_between(4 * C, 3 * B, 2 * A, w)


def _stationary_point(x: Array, V: Array, slope: Array) -> Array:
    """Return where the cubic through two points and their slopes is stationary."""
    h, rise = x[1] - x[0], V[1] - V[0]
    b = (3 * rise / h - 2 * slope[0] - slope[1]) / h
    a = (slope[0] + slope[1] - 2 * rise / h) / h**2
    return x[0] + _root_between(3 * a, 2 * b, slope[0], h)


def _root_between(a: Array, b: Array, c: Array, high: Array) -> Array:
    """Return the root of a x^2 + b x + c in 0..high, or the middle if there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        half = -0.5 * (b + np.copysign(np.sqrt(b * b - 4 * a * c), b))
        roots = np.array([half / a, c / half])
        inside = (roots >= 0) & (roots <= high)
    return np.where(inside[0], roots[0], np.where(inside[1], roots[1], 0.5 * high))
