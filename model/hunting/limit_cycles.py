"""The exact branch of limit cycles: stacked harmonic balance, folds, Floquet multipliers.

The branch is parametrised by the peak lateral displacement, so that its folds are no singularities
and every cycle is a problem of its own: all of them are solved at once. A dozen cycles are found
first, from the describing-function branch; the rest start from what these interpolate to.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from hunting.bogoliubov import NO_HOPF_POINT, REACH, Averaging, averaging, checked_amplitudes
from hunting.branch import Branch
from hunting.continuation import STUCK, continued
from hunting.elements import Array
from hunting.floquet import half_multipliers
from hunting.folds import FREE, found_between, refined
from hunting.harmonic_balance import (
    Balance,
    Cycles,
    Solution,
    at_amplitude,
    completed,
    polished,
    solve,
)
from hunting.lure import LureSystem
from hunting.ports import Ports, orders_up_to
from hunting.stability import HopfPoints, hopf_points

HARMONICS = 15
MORE_HARMONICS = (HARMONICS, 2 * HARMONICS + 1)
_POINTS = 62  # of the default branch, folds not counted
_FREE = np.array([0.25, 0.5, 0.75, 0.9, FREE])  # amplitudes found first, over the clearance
_TOUCHING = 8  # and as many beyond it
_SLACK = 1e-4  # rounding and truncation of neighbours' speeds
_ATTEMPTS = 2  # to find the rest from what was found
_CRUDE = 0.03  # relative Newton step that the first cycles may end with
_ROUGH = 1e-3  # relative Newton step, squared by the next one, that guesses and turns may end with


def limit_cycles(
    system: LureSystem,
    amplitudes: ArrayLike | None = None,
    harmonics: int | None = None,
    hopf: int | None = None,
    points: HopfPoints | None = None,
) -> Branch:
    """Return the exact limit cycles that grow out of a Hopf point.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them, which are solved one by one.
    amplitudes : array_like, shape (m,) or (..., m), optional
        Peak lateral displacements of the wheelset [m], rising. By default the whole branch: from
        the Hopf point to its end - a second fold at strong contact, another Hopf point, or 1.2
        delta - denser around contact.
    harmonics : int, optional
        The highest harmonic solved for. As many again follow from the forces. By default 15, and
        31 where some cycles of the branch cannot do with less; a fold that takes even more is found
        with 63.
    hopf : int, optional
        Index of the Hopf point the branch starts at; by default the hunting one, where the fastest
        unstable range begins.
    points : HopfPoints, optional
        The system's Hopf points, if they are known already.

    Returns
    -------
    Branch
        With Floquet multipliers. Cycles that were not found are left out, and `Branch.message`
        says so. Those of a stack are padded with NaN to the longest.

    Raises
    ------
    ValueError
        If amplitudes are not positive and rising, or harmonics is not an odd number >= 1.
    IndexError
        If there is no Hopf point `hopf`.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie, limit_cycles
    >>> branch = limit_cycles(bogie(RECONSTRUCTED))
    >>> speed, amplitude = branch.fold
    >>> round(3.6 * speed, 2), round(1e3 * amplitude, 2)  # km/h, mm
    (138.87, 9.23)
    """
    if harmonics is not None and (harmonics < 1 or harmonics % 2 != 1):
        raise ValueError(f"harmonics must be an odd number >= 1, got {harmonics!r}")
    Y = None if amplitudes is None else checked_amplitudes(amplitudes)
    averaged = averaging(system, points, hopf)
    numbers = MORE_HARMONICS if harmonics is None else (int(harmonics),)
    if not system.shape:
        return _branch(system, averaged, Y, numbers)
    points = hopf_points(system) if points is None else points
    count = int(np.prod(system.shape))
    Y = None if Y is None else np.broadcast_to(Y, (*system.shape, Y.shape[-1])).reshape(count, -1)
    branches = []
    for i in range(count):
        one = system.take(i)
        averaged = averaging(one, points.take(i), hopf)
        branches.append(_branch(one, averaged, None if Y is None else Y[i], numbers))
    return _stacked(system, branches)


def _stacked(system: LureSystem, branches: list[Branch]) -> Branch:
    """Return the branches as one, padded with NaN to the longest."""
    longest = max(len(branch.speed) for branch in branches)
    orders = max((branch.orders for branch in branches), key=len)

    def padded(name: str, fill: complex) -> Array:
        rows = [getattr(branch, name) for branch in branches]
        out = np.full((len(rows), longest, *rows[0].shape[1:]), fill, dtype=rows[0].dtype)
        for k, row in enumerate(rows):
            out[k, : len(row)] = row
        return out.reshape(*system.shape, *out.shape[1:])

    def widened(branch: Branch) -> Branch:
        none = len(orders) - len(branch.orders)
        return replace(branch, harmonics=np.pad(branch.harmonics, ((0, 0), (0, none), (0, 0))))

    branches = [widened(branch) for branch in branches]
    folds = np.array([branch.fold or (np.nan, np.nan) for branch in branches])
    return Branch(
        amplitude=padded("amplitude", np.nan),
        speed=padded("speed", np.nan),
        frequency=padded("frequency", np.nan),
        stable=padded("stable", False),
        harmonics=padded("harmonics", np.nan),
        orders=orders,
        fold=(folds[:, 0].reshape(system.shape), folds[:, 1].reshape(system.shape)),
        system=system,
        multipliers=padded("multipliers", np.nan),
        message=np.array([branch.message for branch in branches]).reshape(system.shape),
    )


def _branch(
    system: LureSystem, averaged: Averaging, Y: Array | None, harmonics: tuple[int, ...]
) -> Branch:
    """Return the branch with the first of these numbers of harmonics that does for all of it."""
    if np.isnan(averaged.speed[0]):
        return _none(system)
    delta = float(system.clearance)
    wanted = _default_amplitudes() * delta if Y is None else Y[Y > 0]
    ports, right, left = Ports.of(system), averaged.right[0], averaged.left[0]
    best, known = None, None
    for highest in harmonics:
        balance = Balance(ports, right, left, orders_up_to(highest))
        cycles = _at(balance, averaged, known, delta, wanted, sure=Y is not None)
        known = cycles
        turned, crude = _with_turns(balance, cycles, delta)
        found, note = cycles, ""
        if Y is None:
            turned, note, crude_end = _to_its_end(balance, turned, averaged, delta)
            found, crude = turned, crude or crude_end
        reached = wanted if Y is not None else wanted[wanted <= found.cycles.Y.max(initial=0.0)]
        near = np.isclose(reached[:, None], found.cycles.Y, rtol=1e-9)
        lost = len(reached) - int(near.any(axis=-1).sum())
        if lost:
            note = "; ".join(filter(None, [note, f"{lost} cycles were not found"]))
        fold = _fold(turned, averaged)
        if fold and crude and len(harmonics) > 1 and highest == harmonics[-1]:
            fold = _finer_fold(balance, turned, fold, delta)
        best = (balance, averaged, found, fold, note)
        if not lost and not crude and not note.startswith(STUCK):
            break
    assert best is not None
    return _as_branch(*best)


def _fold(found: Solution, averaged: Averaging) -> tuple[float, float] | None:
    """Return speed and amplitude of the slowest turn, if it is the slowest of all."""
    turns = found.cycles[found.V_slope == 0]
    V = turns.V.min(initial=np.inf)
    slowest = (1 + _SLACK) * found.cycles.V.min(initial=np.inf)
    if not (averaged.speed[0] > V and slowest > V):
        return None
    return float(V), float(turns.Y[np.argmin(turns.V)])


def _finer_fold(
    balance: Balance, found: Solution, fold: tuple[float, float], delta: float
) -> tuple[float, float]:
    """Return the fold with twice the harmonics, if that can be found."""
    i = int(np.argmin(np.where(found.V_slope == 0, found.cycles.V, np.inf)))
    sides = found[np.array([i - 1, i + 1])]
    sides = sides[np.argsort(sides.cycles.Y)]
    finer, sure = found_between(*refined(balance, sides[:1], sides[1:]), np.array([delta]))
    return (float(finer.cycles.V[0]), float(finer.cycles.Y[0])) if sure[0] else fold


def _kept(found: Solution) -> Solution:
    return found[found.converged]


def _solved(balance: Balance, guess: Cycles, tolerance: float = _ROUGH) -> Solution:
    return _kept(solve(balance, guess, at_amplitude(guess.Y), tolerance))


def _at(
    balance: Balance,
    averaged: Averaging,
    known: Solution | None,
    delta: float,
    Y: Array,
    sure: bool,
) -> Solution:
    """Return the cycles of amplitudes Y; what is known of them with fewer harmonics, helps."""
    if known is None:
        known = _first_cycles(balance, averaged, delta, Y.max(initial=0.0))
        sure = sure or len(known) < len(_FREE) + _TOUCHING
    else:
        known = _kept(polished(balance, _solved(balance, known.cycles), trust=_CRUDE))
        sure = True
    found = _solved(balance, _between(balance, averaged, known, delta, Y))
    for _ in range(_ATTEMPTS):
        rest = Y[~np.isin(Y, found.cycles.Y)]
        if len(rest) == 0 or len(found) == 0:
            break
        more = _solved(balance, _between(balance, averaged, found, delta, rest))
        if len(more) == 0:
            break
        found = found.joined(more)
        found = found[np.argsort(found.cycles.Y, kind="stable")]
    return _kept(polished(balance, found)) if sure else found


def _with_turns(balance: Balance, found: Solution, delta: float) -> tuple[Solution, bool]:
    """Return the cycles with those at the folds between them, whose slope is zero.

    The second answer is whether higher harmonics matter at the folds.
    """
    slope, forth = found.V_slope / found.Y_slope, found.Y_slope > 0
    turns = (slope[:-1] > 0) != (slope[1:] > 0)
    left = np.flatnonzero(turns & (forth[:-1] == forth[1:]))
    below, above = left + ~forth[left], left + forth[left]
    found = replace(found, V_slope=slope, line=at_amplitude(found.cycles.Y))
    folds, sure = found_between(balance, found[below], found[above], np.full(len(left), delta))
    folds = replace(folds, V_slope=np.zeros(len(left)))
    place = np.concatenate([np.arange(len(found)), left[folds.converged] + 0.5])
    turned = found.joined(_kept(folds))[np.argsort(place)]
    return turned, not sure.all()


def _to_its_end(
    balance: Balance, found: Solution, averaged: Averaging, delta: float
) -> tuple[Solution, str, bool]:
    """Return the branch cut at its second fold, or completed where its amplitude turns back.

    The third answer is whether higher harmonics matter at folds that were added.
    """
    if len(found) < 2:
        return found, "no limit cycle was found", False
    Y, slope = found.cycles.Y, found.V_slope
    peak = (slope[1:-1] == 0) & (Y[1:-1] > delta) & (slope[:-2] > 0)
    if peak.any():
        last = int(np.argmax(peak)) + 1
        note = "the branch ends at a second fold, beyond which motions run away"
        return found[: last + 1], note, False
    if Y[-1] > 0.999 * REACH * delta:
        return found, "", False
    found, note = continued(balance, found[slope != 0], averaged, REACH * delta)
    sure = polished(balance, found)
    if not sure.converged[-1]:
        note = STUCK
    turned, crude = _with_turns(balance, _kept(sure), delta)
    return turned, note, crude


def _as_branch(
    balance: Balance,
    averaged: Averaging,
    found: Solution,
    fold: tuple[float, float] | None,
    note: str,
) -> Branch:
    """Return the branch of the cycles found, the Hopf point in front."""
    answer, states = completed(balance, found)
    system, cycles = balance.ports.system, found.cycles
    half = half_multipliers(balance.ports, cycles.V, cycles.omega, answer)
    V_c, omega_c = averaged.speed, averaged.frequency
    at_hopf = np.exp(2 * np.pi / omega_c * np.linalg.eigvals(system.matrix(V_c)[0]))
    stable: Array = np.all(np.abs(half[:, 1:]) < 1, axis=-1)
    return Branch(
        amplitude=np.append(0.0, cycles.Y),
        speed=np.append(V_c, cycles.V),
        frequency=np.append(omega_c, cycles.omega),
        stable=np.append(stable[0] if len(stable) else False, stable),
        harmonics=np.concatenate([np.zeros((1, *states.shape[1:]), dtype=complex), states]),
        orders=tuple(balance.orders_of(cycles).tolist()),
        fold=fold,
        system=system,
        multipliers=np.concatenate([at_hopf[None], half**2]),
        message=note,
    )


def _default_amplitudes() -> Array:
    """Return amplitudes over the clearance, from nearly 0 to 1.2, denser around contact."""
    free = _POINTS // 2
    below = FREE * (1 - np.linspace(1, 0, free + 1)[1:] ** 1.5)
    above = 1 + (REACH - 1) * np.linspace(0, 1, _POINTS - free + 1)[1:] ** 2
    return np.concatenate([below, above])


def _first_cycles(balance: Balance, averaged: Averaging, delta: float, largest: float) -> Solution:
    """Return cycles over the whole range, from those of averaging by way of one harmonic."""
    excess = max(REACH, largest / delta) - 1
    touching = 1 + excess * np.linspace(0, 1, _TOUCHING + 1)[1:] ** 2
    Y = delta * np.concatenate([_FREE, touching])
    U1 = balance.seen(averaged.right)
    V_c = averaged.speed[0]
    guess = Cycles(
        U=np.repeat(U1[None], len(Y), axis=0),
        kappa=np.ones(len(Y), dtype=complex),
        V=np.clip(averaged.branch_speed(Y), 0.5 * V_c, 1.2 * V_c),
        omega=np.full(len(Y), averaged.frequency[0]),
        Y=Y,
        tail=np.zeros((len(Y), 0, len(averaged.right[0])), dtype=complex),
    )
    one = Balance(balance.ports, balance.right, balance.left, orders_up_to(1))
    guess = solve(one, guess, at_amplitude(Y), tolerance=np.inf).cycles  # one step
    first = solve(balance, guess, at_amplitude(Y), tolerance=_CRUDE)
    return _kept(polished(balance, _kept(first), trust=_CRUDE))


def _between(
    balance: Balance, averaged: Averaging, first: Solution, delta: float, Y: Array
) -> Cycles:
    """Return guesses at the amplitudes Y by splines, one on each side of the clearance."""
    h, (n, q) = len(balance.orders), balance.ports.B.shape[-2:]
    cycles = first.cycles
    rows = np.column_stack(
        [
            cycles.U.reshape(len(cycles), h * q),
            cycles.tail.reshape(len(cycles), h * n),
            cycles.kappa,
            cycles.V,
            cycles.omega,
        ]
    )
    start = np.zeros((1, rows.shape[-1]), dtype=complex)
    start[0, :q] = balance.seen(averaged.right)[0]
    start[0, -3:] = 1.0, averaged.speed[0], averaged.frequency[0]
    rows = np.concatenate([start, rows])
    y, at = np.append(0.0, cycles.Y) / delta, Y / delta
    out = np.empty((len(Y), rows.shape[-1]), dtype=complex)
    free, beyond = at <= 1, at > 1
    touches = 0.9999 * FREE
    out[free] = _spline(y[y <= 1], rows[y <= 1], at[free])
    w = np.sqrt(np.maximum(y[y > touches] - 1, 0.0))
    out[beyond] = _spline(w, rows[y > touches], np.sqrt(at[beyond] - 1), otherwise=rows[-1])
    return Cycles(
        U=out[:, : h * q].reshape(len(Y), h, q),
        tail=out[:, h * q : -3].reshape(len(Y), h, n),
        kappa=out[:, -3],
        V=out[:, -2].real,
        omega=out[:, -1].real,
        Y=Y,
    )


def _spline(x: Array, rows: Array, at: Array, otherwise: Array | None = None) -> Array:
    if len(x) < 3:
        return np.repeat((rows[-1] if otherwise is None else otherwise)[None], len(at), axis=0)
    x, first = np.unique(x, return_index=True)
    return _spline_weights(x.tobytes(), np.minimum(at, x[-1]).tobytes()) @ rows[first]


@lru_cache(maxsize=32)
def _spline_weights(x: bytes, at: bytes) -> Array:
    """Return what each of the points x counts for at each of `at`: sliders ask for the same."""
    nodes = np.frombuffer(x)
    return CubicSpline(nodes, np.eye(len(nodes)))(np.frombuffer(at))


def _none(system: LureSystem) -> Branch:
    none, n = np.zeros(0), len(system.states)
    return Branch(
        amplitude=none,
        speed=none,
        frequency=none,
        stable=none.astype(bool),
        harmonics=np.zeros((0, 1, n), dtype=complex),
        orders=(1,),
        fold=None,
        system=system,
        multipliers=np.zeros((0, n), dtype=complex),
        message=NO_HOPF_POINT,
    )
