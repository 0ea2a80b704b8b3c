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
from hunting.continuation import continued
from hunting.elements import Array
from hunting.floquet import half_multipliers
from hunting.folds import FREE, turning_amplitude
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
from hunting.stability import HopfPoints

HARMONICS = 15
_POINTS = 62  # of the default branch, folds not counted
_FREE = np.array([0.25, 0.5, 0.75, 0.9, FREE])  # amplitudes found first, over the clearance
_TOUCHING = 8  # and as many beyond it
_CRUDE = 0.03  # relative Newton step that the first cycles may end with
_ROUGH = 1e-3  # relative Newton step, squared by the next one, that guesses and turns may end with


def limit_cycles(
    system: LureSystem,
    amplitudes: ArrayLike | None = None,
    harmonics: int = HARMONICS,
    hopf: int | None = None,
    points: HopfPoints | None = None,
) -> Branch:
    """Return the exact limit cycles that grow out of a Hopf point.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    amplitudes : array_like, shape (m,), optional
        Peak lateral displacements of the wheelset [m], rising. By default the whole branch: from
        the Hopf point to its end - a second fold at strong contact, another Hopf point, or 1.2
        delta - denser around contact.
    harmonics : int, default 15
        The highest harmonic solved for. As many again follow from the forces.
    hopf : int, optional
        Index of the Hopf point the branch starts at; by default the hunting one, where the fastest
        unstable range begins.
    points : HopfPoints, optional
        The system's Hopf points, if they are known already.

    Returns
    -------
    Branch
        With Floquet multipliers. Cycles that were not found are left out, and `Branch.message`
        says so.

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
    if harmonics < 1 or harmonics % 2 != 1:
        raise ValueError(f"harmonics must be an odd number >= 1, got {harmonics!r}")
    Y = None if amplitudes is None else checked_amplitudes(amplitudes)
    averaged = averaging(system, points, hopf)
    if np.isnan(averaged.speed[0]):
        return _none(system)
    return _branch(system, averaged, Y, int(harmonics))


def _branch(system: LureSystem, averaged: Averaging, Y: Array | None, harmonics: int) -> Branch:
    delta = float(system.clearance)
    balance = Balance(
        Ports.of(system), averaged.right[0], averaged.left[0], orders_up_to(harmonics)
    )
    wanted = _default_amplitudes() * delta if Y is None else Y[Y > 0]
    first = _first_cycles(balance, averaged, delta, wanted.max(initial=0.0))
    guess = _between(balance, averaged, first, delta, wanted)
    tried = solve(balance, guess, at_amplitude(wanted), tolerance=_ROUGH)
    found, note = tried[tried.converged], ""
    if Y is None:
        found = _in_order(found.joined(_turns(balance, found, delta)))
        found, note = _to_its_end(balance, found, averaged, delta)
    elif not tried.converged.all():
        note = f"{(~tried.converged).sum()} of {len(tried)} cycles were not found"
    if not first.converged.all() or len(first) < len(_FREE) + _TOUCHING or len(found) > len(tried):
        found = polished(balance, found)
        if not found.converged.all():
            note = f"{(~found.converged).sum()} cycles need more than {harmonics} harmonics"
            found = found[found.converged]
    return _as_branch(balance, averaged, found, note)


def _turns(balance: Balance, found: Solution, delta: float) -> Solution:
    """Return the cycles at the folds between those found."""
    cycles = found.cycles
    slope = found.V_slope
    left = np.flatnonzero(np.signbit(slope[:-1]) != np.signbit(slope[1:]))
    ends = np.array([left, left + 1])
    Y = turning_amplitude(cycles.Y[ends], cycles.V[ends], slope[ends], np.asarray(delta))
    share = (Y - cycles.Y[left]) / (cycles.Y[left + 1] - cycles.Y[left])
    guess = cycles[left].towards(cycles[left + 1], share)
    turns = solve(balance, replace(guess, Y=Y), at_amplitude(Y), tolerance=_ROUGH)
    return turns[turns.converged]


def _in_order(found: Solution) -> Solution:
    return found[np.argsort(found.cycles.Y, kind="stable")]


def _to_its_end(
    balance: Balance, found: Solution, averaged: Averaging, delta: float
) -> tuple[Solution, str]:
    """Return the branch cut at its second fold, or completed where its amplitude turns back."""
    Y, V = found.cycles.Y, found.cycles.V
    peak = (Y[1:-1] > delta) & (V[1:-1] > V[:-2]) & (V[1:-1] > V[2:])
    if peak.any():
        last = int(np.argmax(peak)) + 1
        return found[: last + 1], "the branch ends at a second fold, beyond which motions run away"
    if len(found) < 2 or Y[-1] > 0.999 * REACH * delta:
        return found, "" if len(found) > 1 else "no limit cycle was found"
    return continued(balance, found, averaged, REACH * delta)


def _as_branch(balance: Balance, averaged: Averaging, found: Solution, note: str) -> Branch:
    """Return the branch of the cycles found, the Hopf point in front."""
    answer, states = completed(balance, found)
    system, cycles = balance.ports.system, found.cycles
    half = half_multipliers(balance.ports, cycles.V, cycles.omega, answer)
    V_c, omega_c = averaged.speed, averaged.frequency
    at_hopf = np.exp(2 * np.pi / omega_c * np.linalg.eigvals(system.matrix(V_c)[0]))
    stable: Array = np.all(np.abs(half[:, 1:]) < 1, axis=-1)
    lowest = int(np.argmin(cycles.V)) if len(found) else 0
    fold = None
    if 0 < lowest < len(found) - 1 and cycles.V[lowest] < V_c[0]:
        fold = (float(cycles.V[lowest]), float(cycles.Y[lowest]))
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
    guess = solve(one, guess, at_amplitude(Y), tolerance=0.5).cycles
    first = solve(balance, guess, at_amplitude(Y), tolerance=_CRUDE)
    return polished(balance, first[first.converged], trust=_CRUDE)


def _between(
    balance: Balance, averaged: Averaging, first: Solution, delta: float, Y: Array
) -> Cycles:
    """Return guesses at the amplitudes Y by splines, one on each side of the clearance."""
    h, (n, q) = len(balance.orders), balance.ports.B.shape[-2:]
    cycles = first.cycles[first.converged]
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
    return _spline_weights(x.tobytes(), np.minimum(at, x[-1]).tobytes()) @ rows


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
