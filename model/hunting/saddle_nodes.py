"""The slowest limit cycle of each of many systems: the exact nonlinear critical speed.

Averaging says where to look. The cycle that just touches the rail then tells the two kinds of fold
apart: if speed still falls there, the dead band makes the branch graze and turn just beyond the
clearance; if it rises, the fold is a smooth one below. Either is closed in on between a falling
and a rising cycle, for all systems at once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hunting.bogoliubov import REACH, Averaging
from hunting.elements import Array
from hunting.folds import FREE, found_between, refined
from hunting.harmonic_balance import Balance, Cycles, Solution, at_amplitude, solve
from hunting.lure import LureSystem
from hunting.ports import Ports, orders_up_to

_ROUGH = 1e-4  # relative Newton step, squared by the next one, that intermediate cycles end with
_NEAR, _CAREFUL = 1e-3, 1.6  # relative excess, and the factor it grows by, on second thoughts
_SHORTEST = 3e-3  # stride in amplitude, over the amplitude wanted
_STRIDE_CHANGE = 0.3  # largest relative change of speed that still is the same branch


@dataclass(frozen=True)
class Slowest:
    """The slowest cycle of M systems.

    Attributes
    ----------
    V, Y : ndarray, shape (M,)
        Its speed [m/s] and amplitude [m]; those of the Hopf point, if no cycle is slower. NaN if
        the branch is still falling at 1.2 delta, or the cycle was not found.
    missed : ndarray of bool, shape (M,)
        Whether it was not found, or not with so few harmonics.
    """

    V: Array
    Y: Array
    missed: Array


def slowest_cycles(
    system: LureSystem, averaged: Averaging, a_fold: Array, harmonics: int
) -> Slowest:
    """Return the slowest cycle of each system of a stack of one axis.

    Parameters
    ----------
    system : LureSystem
        M systems.
    averaged : Averaging
        Averaging at a Hopf point of each.
    a_fold : ndarray, shape (M,)
        Amplitude of the fold of the averaged branch [m], NaN if it has none.
    harmonics : int
        The highest harmonic solved for.

    Returns
    -------
    Slowest
    """
    if len(a_fold) == 0:
        return Slowest(a_fold, a_fold, a_fold.astype(bool))
    delta = np.asarray(system.clearance)
    right, left = averaged.right[:, 0], averaged.left[:, 0]
    balance = Balance(Ports.of(system), right, left, orders_up_to(harmonics))
    rest = _at_rest(balance, averaged)
    V_touch = averaged.branch_speed(delta[:, None])[:, 0]
    touch = touching_cycles(balance, rest, V_touch, FREE * delta)
    falls, found = touch.V_slope < 0, touch.converged
    subcritical = rest.V_slope < 0

    # A branch that turns more than once, or where averaging says otherwise, is none of ours.
    missed = ~found | (falls & (a_fold < 0.99 * delta))
    missed |= ~subcritical & (falls | np.isfinite(a_fold))
    V, Y = rest.cycles.V.copy(), np.zeros(len(delta))
    grazing = np.flatnonzero(~missed & falls)
    smooth = np.flatnonzero(~missed & ~falls & subcritical)
    low, high = _around_contact(
        balance.take(grazing), touch[grazing], a_fold[grazing] / delta[grazing]
    )
    # Strides of a factor 9 in excess may step over a fold and the one above it.
    again = np.flatnonzero(high.converged & ~(high.V_slope > 0))
    which = grazing[again]
    nearer = np.full(len(again), 1 + _NEAR)
    again_low, again_high = _around_contact(balance.take(which), touch[which], nearer, _CAREFUL)
    low.put(again, again_low)
    high.put(again, again_high)
    sides = (rest[smooth].joined(low), touch[smooth].joined(high))
    which = np.concatenate([smooth, grazing])
    rising = sides[1].V_slope > 0
    V[which[~rising]] = Y[which[~rising]] = np.nan
    missed[which[~sides[1].converged]] = True

    which, low, high = which[rising], sides[0][rising], sides[1][rising]
    folds, sure = found_between(balance.take(which), low, high, delta[which])
    V_fold, Y_fold = folds.cycles.V, folds.cycles.Y
    crude = np.flatnonzero(~sure)
    if len(crude):  # once more with twice the harmonics
        folds, sure[crude] = found_between(
            *refined(balance.take(which[crude]), low[crude], high[crude]), delta[which[crude]]
        )
        V_fold[crude], Y_fold[crude] = folds.cycles.V, folds.cycles.Y
    missed[which[~sure]] = True
    slower = V[which] > V_fold
    V[which[slower]], Y[which[slower]] = V_fold[slower], Y_fold[slower]
    return Slowest(V, Y, missed)


def _at_rest(balance: Balance, averaged: Averaging) -> Solution:
    """Return the Hopf points as cycles of no amplitude, their branches' slope included."""
    M, none = len(averaged.speed), np.zeros(len(averaged.speed))
    U = np.zeros((M, len(balance.orders), balance.ports.B.shape[-1]), dtype=complex)
    U[:, 0] = balance.seen(averaged.right)[:, 0]
    cycles = Cycles(
        U,
        np.ones(M, dtype=complex),
        averaged.speed[:, 0],
        averaged.frequency[:, 0],
        none,
        np.zeros((M, 0, averaged.right.shape[-1]), dtype=complex),
    )
    slope = averaged.branch_slope(none[:, None])[:, 0]
    return Solution(cycles, at_amplitude(none), none == 0, slope, none + 1)


def touching_cycles(balance: Balance, rest: Solution, V: Array, Y: Array) -> Solution:
    """Return cycles of amplitudes Y, from the Hopf points by way of a single harmonic."""
    V_c = rest.cycles.V
    guess = replace(rest.cycles, V=np.clip(V, 0.5 * V_c, 1.2 * V_c), Y=Y).resized(1)
    one = replace(balance, orders=orders_up_to(1))
    guess = solve(one, guess, at_amplitude(Y), tolerance=0.1).cycles
    touch = solve(balance, guess, at_amplitude(Y), tolerance=_ROUGH)
    missed = np.flatnonzero(~touch.converged)
    touch.put(missed, _walked(balance.take(missed), rest[missed], Y[missed]))
    return touch


def _walked(balance: Balance, rest: Solution, Y: Array) -> Solution:
    """Return cycles of amplitudes Y, led there from rest in strides as long as they succeed."""
    last, at, stride = rest.copy(), np.zeros(len(Y)), np.full(len(Y), 0.1)
    going = np.arange(len(Y))
    while len(going):
        step = np.minimum(stride[going], 1 - at[going])
        ahead = last.cycles[going]
        V = ahead.V + last.V_slope[going] * step * Y[going]
        goal = (at[going] + step) * Y[going]
        guess = replace(ahead, V=np.maximum(V, 0.5 * ahead.V), Y=goal)
        tried = solve(balance.take(going), guess, at_amplitude(goal), tolerance=_ROUGH)
        ok = tried.converged & (np.abs(tried.cycles.V / ahead.V - 1) < _STRIDE_CHANGE)
        last.put(going[ok], tried[ok])
        at[going[ok]] += step[ok]
        stride[going] = np.where(ok, 1.5 * step, 0.3 * step)
        going = going[(at[going] < 1 - 1e-12) & (stride[going] > _SHORTEST)]
    last.converged[at < 1 - 1e-12] = False
    return last


def _around_contact(
    balance: Balance, touch: Solution, expected: Array, stride: float = 9.0
) -> tuple[Solution, Solution]:
    """Return cycles on both sides of a grazing fold, given where averaging expects it.

    The excess over the clearance grows by the factor `stride` until speed rises. The second one is
    still falling where there is no fold up to 1.2 delta.
    """
    delta = touch.cycles.Y / FREE
    low, high = touch.copy(), touch.copy()
    excess = np.clip(np.nan_to_num(4 * (expected - 1), nan=np.inf), 1e-6, REACH - 1)
    reached, factor = np.zeros(len(delta)), np.full(len(delta), stride)
    going = np.arange(len(delta))
    while len(going):
        Y = delta[going] * (1 + excess[going])
        ahead = high.cycles[going]
        tried = solve(balance.take(going), replace(ahead, Y=Y), at_amplitude(Y), tolerance=_ROUGH)
        ok = tried.converged & (np.abs(tried.cycles.V / ahead.V - 1) < _STRIDE_CHANGE)
        low.put(going[ok], high[going[ok]])
        high.put(going[ok], tried[ok])
        reached[going] = np.where(ok, excess[going], reached[going])
        factor[going] = np.where(ok, factor[going], np.sqrt(factor[going]))
        further = np.where(reached > 0, factor * reached, 0.1 * excess)[going]
        last = ok & (excess[going] >= REACH - 1)
        excess[going] = np.minimum(further, REACH - 1)
        lost = (factor[going] < 1.02) | (excess[going] < 1e-8)
        high.converged[going[lost & ~ok]] = False
        going = going[~(ok & (tried.V_slope > 0)) & ~last & ~lost]
    return low, high
