"""Following a branch where its amplitude turns back, one cycle at a time.

A branch that joins two Hopf points of a low-speed window has a largest amplitude; no cycle answers
to a larger one. It is followed along secants of the (V, Y) plane instead.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hunting.bogoliubov import Averaging
from hunting.elements import Array
from hunting.harmonic_balance import Balance, Line, Solution, solve

STUCK = "the branch could not be followed further"
_MOST = 150  # cycles
_SHRINK, _GROW, _SMALLEST = 0.4, 1.4, 1e-3


def continued(
    balance: Balance, found: Solution, averaged: Averaging, largest: float
) -> tuple[Solution, str]:
    """Return the branch completed beyond the last cycle found, and how it ends, in words.

    The cycles are returned without higher harmonics.

    Parameters
    ----------
    balance : Balance
        The equations.
    found : Solution
        Cycles in order of the branch, two at least.
    averaged : Averaging
        Averaging at the Hopf point the branch starts at.
    largest : float
        The amplitude at which the branch counts as ended [m].
    """
    without_tail = replace(found.cycles, tail=found.cycles.tail[:, :0])
    found = solve(balance, without_tail, found.line)
    found, V_c = found[found.converged], float(averaged.speed[0])
    if len(found) < 2:
        return found, STUCK
    scale = np.array([V_c, float(found.cycles.Y.max())])
    longest = _distance(found, scale).max(initial=0.05)
    reach = _distance(found[len(found) - 2 :], scale)[0]
    for _ in range(_MOST):
        step = _next(balance, found, scale, reach)
        if step is None:
            reach *= _SHRINK
            if reach < _SMALLEST * longest:
                return found, STUCK
            continue
        found, reach = found.joined(step), min(_GROW * reach, longest)
        Y, V = found.cycles.Y[-1], found.cycles.V[-1]
        if 0.03 * scale[1] > Y:
            return found, "the branch ends at another Hopf point"
        if largest < Y:
            return found, ""
        if not 0.05 * V_c < V < 5 * V_c:
            return found, "the branch leaves the speeds the model is made for"
    return found, "the branch could not be followed to its end"


def _distance(found: Solution, scale: Array) -> Array:
    at = np.array([found.cycles.V, found.cycles.Y]).T / scale
    return np.linalg.norm(np.diff(at, axis=0), axis=-1)


def _next(balance: Balance, found: Solution, scale: Array, reach: float) -> Solution | None:
    """Return the cycle `reach` further along the secant of the last two, None if there is none."""
    before, last = found.cycles[-2:-1], found.cycles[-1:]
    secant = np.array([last.V - before.V, last.Y - before.Y])[:, 0] / scale
    length = np.linalg.norm(secant)
    guess = before.towards(last, np.array([1 + reach / length]))
    v, a = secant / length / scale
    line: Line = (np.array([v]), np.array([a]), v * guess.V + a * guess.Y)
    step = solve(balance, guess, line)
    if not step.converged[0]:
        return None
    moved = np.array([step.cycles.V - last.V, step.cycles.Y - last.Y])[:, 0] / scale
    turned = moved @ secant / (length * np.linalg.norm(moved))
    return step if turned > 0.7 and np.linalg.norm(moved) < 2 * reach else None
