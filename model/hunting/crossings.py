"""Where a quantity known with its rate at a few instants crosses zero or turns.

Between two instants it is the cubic Hermite polynomial through values y0, y1 and slopes d0, d1 (per
unit of the interval).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hunting.elements import Array

Value = Any  # number or array
_PARTS = np.linspace(0, 1, 33)


def cubic(y0: Value, y1: Value, d0: Value, d1: Value, s: Value) -> Value:
    """Return the Hermite polynomial at s in [0, 1].

    Examples
    --------
    >>> cubic(0.0, 1.0, 0.0, 3.0, 0.5)  # s^3
    0.125
    """
    rise = y1 - y0
    return y0 + s * (d0 + s * (3 * rise - 2 * d0 - d1 + s * (d0 + d1 - 2 * rise)))


def turning_point(y0: Value, y1: Value, d0: Value, d1: Value) -> Array:
    """Return s in (0, 1) at which the slope is zero, where d0 and d1 differ in sign.

    Examples
    --------
    >>> float(turning_point(0.0, 0.0, 1.0, -1.0))
    0.5
    """
    rise = y1 - y0
    a, b = 3 * (d0 + d1 - 2 * rise), 2 * (3 * rise - 2 * d0 - d1)
    root = np.sqrt(np.maximum(b * b - 4 * a * d0, 0))
    return np.clip(2 * d0 / (np.where(np.asarray(d0) > 0, root, -root) - b), 0, 1)


def first_crossing(grid: Array, y: Array, slope: Array) -> Array:
    """Return the instant at which each quantity first rises through zero.

    Parameters
    ----------
    grid : ndarray, shape (G,)
        Instants, rising.
    y, slope : ndarray, shape (s, G)
        Values and slopes there. A quantity that starts at zero and falls has not crossed; one
        that starts at or above zero and rises crosses at once.

    Returns
    -------
    ndarray, shape (s,)
        Infinity where there is no crossing.

    Examples
    --------
    >>> t = np.linspace(0, 3, 4)
    >>> first_crossing(t, np.sin(t - 0.5)[None], np.cos(t - 0.5)[None])
    array([0.5])
    """
    width = np.diff(grid)
    data = (y[:, :-1], y[:, 1:], slope[:, :-1] * width, slope[:, 1:] * width)
    crosses = data[1] > 0
    i, j = np.nonzero(~crosses & (data[2] > 0) & (data[3] < 0))
    y0, y1, d0, d1 = (part[i, j] for part in data)
    crosses[i, j] = cubic(y0, y1, d0, d1, turning_point(y0, y1, d0, d1)) > 0

    instant = np.full(len(y), np.inf)
    i = np.flatnonzero(crosses.any(axis=1))
    if len(i):
        j = crosses[i].argmax(axis=1)
        instant[i] = grid[j] + width[j] * _rise_through_zero(*(part[i, j] for part in data))
    return instant


def _rise_through_zero(y0: Array, y1: Array, d0: Array, d1: Array) -> Array:
    """Return s at which the polynomial rises through zero, to about 1e-4."""
    low, high = np.zeros(len(y0)), np.ones(len(y0))
    for bound, turns in ((high, y1 <= 0), (low, (y0 >= 0) & (d0 < 0))):
        if turns.any():
            bound[turns] = turning_point(y0[turns], y1[turns], d0[turns], d1[turns])
    s = low[:, None] + (high - low)[:, None] * _PARTS
    y = cubic(y0[:, None], y1[:, None], d0[:, None], d1[:, None], s)
    after = np.maximum((y > 0).argmax(axis=1), 1)[:, None]
    s0, s1 = (np.take_along_axis(s, k, axis=1)[:, 0] for k in (after - 1, after))
    ya, yb = (np.take_along_axis(y, k, axis=1)[:, 0] for k in (after - 1, after))
    share = np.zeros(len(y0))
    np.divide(-ya, yb - ya, out=share, where=(ya < 0) & (yb > 0))
    return np.where((y0 >= 0) & (d0 >= 0), 0.0, s0 + share * (s1 - s0))
