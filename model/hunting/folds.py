"""Where a branch turns: its folds, from cycles on both sides of them.

Speed over amplitude is smooth below the clearance. Above it, it is smooth in the root of the
excess, w = sqrt(Y/delta - 1): the dead band adds a term in w^3. So V is interpolated in Y or in w,
between cycles whose slopes are known, and never fitted across the clearance.
"""

from __future__ import annotations

import numpy as np

from hunting.elements import Array

FREE = 1 - 1e-4  # of the clearance: what does not touch yet, whatever the rounding


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
