"""Critical speeds of a design known only within limits: distribution, probability, Sobol' indices.

Parameters are drawn as points of a scrambled Sobol' sequence, which fill the limits more evenly
than random ones. Two independent halves A and B of it serve for the distribution; the indices need
A with single columns taken from B as well (A. Saltelli et al., Computer Physics Communications 181
(2010) 259-270).
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import binomtest, qmc, sobol_indices, uniform

from hunting.cases import QUANTITIES, Answers, Cases, Progress, Vehicle, name_of, solve_cases
from hunting.critical_speeds import Method
from hunting.elements import Array
from hunting.parameters import Field, Parameters, check_one_design
from hunting.tables import speeds_table

_SPEEDS = ("linear", "nonlinear")
_FEWEST = 64  # sets from which indices are still computed
_BASE = 512  # sets of A from which they are computed, if there are so many, or more


class Distribution(Protocol):
    """A frozen distribution of `scipy.stats`."""

    def ppf(self, q: Array) -> Array:
        """Return the value below which the share q of all values lies."""


Spread = float | tuple[float, float] | Distribution


@dataclass(frozen=True)
class Indices:
    """Sobol' indices: the share of a speed's variance that each parameter explains.

    Attributes
    ----------
    names : tuple of str
        The d parameters.
    first_order, total : ndarray, shape (d,)
        Share of a parameter by itself, and with all its interactions. NaN if too many sets lack
        the speed.
    base : int
        How many sets of A they were computed from: those without a gap, rounded down to a power
        of two.
    """

    names: tuple[str, ...]
    first_order: Array
    total: Array
    base: int


@dataclass(frozen=True)
class Uncertainty:
    """Critical speeds of designs drawn within limits.

    Attributes
    ----------
    vehicle, method : str
        How they were computed.
    parameters : Parameters
        The design in the middle.
    columns : dict of str to ndarray, shape (n,)
        The values drawn [SI].
    linear, nonlinear : ndarray, shape (n,)
        V_lin and V_nl [m/s], NaN where there is none.
    amplitude, frequency : ndarray, shape (n,)
        As in `CriticalSpeeds` [m, rad/s].
    criticality, message : ndarray of str, shape (n,)
        As in `CriticalSpeeds`.
    indices : dict of str to Indices
        Of "linear" and "nonlinear".
    """

    vehicle: str
    method: Method
    parameters: Parameters
    columns: Mapping[str, Array]
    linear: Array
    nonlinear: Array
    amplitude: Array
    frequency: Array
    criticality: Array
    message: Array
    indices: Mapping[str, Indices]

    def gaps(self) -> dict[str, int]:
        """Return how many sets lack a critical speed, by the reason."""
        reasons, counts = np.unique(self.message[self.message != ""], return_counts=True)
        return dict(zip(reasons.tolist(), counts.tolist(), strict=True))

    def quantiles(self, shares: ArrayLike, speed: str = "nonlinear") -> Array:
        """Return the speeds [m/s] below which the given shares of all sets that have one lie.

        Parameters
        ----------
        shares : array_like
            Between 0 and 1.
        speed : {"nonlinear", "linear"}
            Which one.
        """
        values = getattr(self, speed)
        finite = values[np.isfinite(values)]
        if len(finite) == 0:
            return np.full(np.shape(shares), np.nan)
        return np.quantile(finite, np.asarray(shares, dtype=float))

    def probability_below(
        self, operating_speed: float, speed: str = "nonlinear", confidence: float = 0.95
    ) -> tuple[float, float, float]:
        """Return the probability that a critical speed lies below the operating speed.

        Parameters
        ----------
        operating_speed : float
            [m/s].
        speed : {"nonlinear", "linear"}
            Which one.
        confidence : float, default 0.95
            That of the interval.

        Returns
        -------
        probability, low, high : float
            The share of all sets that have the speed, and its confidence interval (Wilson's, as
            for independent random sets: on the safe side, for Sobol' points are more even). Sets
            without the speed are left out; `gaps` counts them. NaN if no set has one.
        """
        values = getattr(self, speed)
        finite = values[np.isfinite(values)]
        if len(finite) == 0:
            return np.nan, np.nan, np.nan
        test = binomtest(int((finite < operating_speed).sum()), len(finite))
        interval = test.proportion_ci(confidence, method="wilson")
        return float(test.statistic), float(interval.low), float(interval.high)

    def csv(self) -> str:
        """Return the sets and their speeds as CSV, what they share in the header."""
        return speeds_table(
            "critical speeds of parameters drawn within limits",
            self.vehicle,
            self.method,
            self.parameters,
            self.columns,
            {name: getattr(self, name) for name in QUANTITIES},
        )


def uncertainty(
    vehicle: Vehicle,
    parameters: Parameters,
    spreads: Mapping[str, Spread],
    samples: int = 10_000,
    seed: int = 0,
    method: Method = "averaging",
    executor: Executor | None = None,
    progress: Progress | None = None,
    store: str | os.PathLike[str] | None = None,
) -> Uncertainty:
    """Return the critical speeds of designs known only within limits.

    Parameters
    ----------
    vehicle : callable
        `wheelset` or `bogie`.
    parameters : Parameters
        The design in the middle, as numbers.
    spreads : dict of str to float, pair or distribution
        How far a parameter is known. A number s: anything from (1 - s) p to (1 + s) p. A pair:
        anything from low to high [SI]. Or a frozen distribution of `scipy.stats`. Parameters are
        independent of each other.
    samples : int, default 10000
        Parameter sets in the distribution, rounded up to an even number. The indices take half as
        many again, or 512 for each spread.
    seed : int, default 0
        Of the scrambling; the same seed gives the same numbers.
    method : {"averaging", "harmonic_balance"}
        How limit cycles are found.
    executor, progress, store : optional
        As for `sweep`.

    Returns
    -------
    Uncertainty

    Raises
    ------
    TypeError
        If a spread names no field of the parameters.
    ValueError
        If a spread reaches values out of a parameter's bounds, or there are too few samples.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie, uncertainty
    >>> known = uncertainty(bogie, RECONSTRUCTED, {"lam": 0.1, "Ky": 0.1, "Kr": 0.5}, samples=1000)
    >>> probability, low, high = known.probability_below(140 / 3.6)
    >>> low < probability < high
    True
    >>> most = np.argmax(known.indices["nonlinear"].total)
    >>> known.indices["nonlinear"].names[most]
    'lam'
    """
    check_one_design(parameters)
    if samples < 2:
        raise ValueError(f"samples must be 2 or more, got {samples!r}")
    distributions = _distributions(parameters, spreads)
    d, n = len(distributions), -(-samples // 2)
    base = _power_of_two(min(n, max(_BASE, samples // (2 * d))))
    unit = qmc.Sobol(2 * d, rng=seed).random_base2(int(np.ceil(np.log2(n))))[:n]
    halves = np.moveaxis(unit.reshape(n, 2, d), 0, -1)  # half, parameter, set
    mixed = np.repeat(halves[:1, :, :base], d, axis=0)  # A, with parameter i as in B
    mixed[np.arange(d), np.arange(d)] = halves[1, :, :base]
    drawn = np.concatenate([np.concatenate(halves, axis=-1), *mixed], axis=-1)
    columns = _values(distributions, drawn)
    cases = Cases(vehicle, parameters, columns, method)
    answers = solve_cases(cases, executor, progress, store)
    names = tuple(distributions)
    return Uncertainty(
        name_of(vehicle),
        method,
        parameters,
        {name: values[: 2 * n] for name, values in columns.items()},
        **{name: answers[name][: 2 * n] for name in QUANTITIES},
        indices={speed: _indices(answers, speed, names, n, base) for speed in _SPEEDS},
    )


def _distributions(
    parameters: Parameters, spreads: Mapping[str, Spread]
) -> dict[str, tuple[Field, Distribution]]:
    fields = {f.name: f for f in Parameters.fields()}
    unknown = [name for name in spreads if name not in fields]
    if unknown or not spreads:
        raise TypeError(f"spreads must be of one or more of {', '.join(fields)}, got {spreads!r}")
    return {
        name: (fields[name], _distribution(fields[name], getattr(parameters, name), spread))
        for name, spread in spreads.items()
    }


def _distribution(field: Field, value: float, spread: Any) -> Distribution:
    if hasattr(spread, "ppf"):
        return spread
    if np.ndim(spread) == 0:
        low, high = sorted(value * (1 + np.array([-1, 1]) * abs(spread)))
    else:
        low, high = spread
    if not low <= high:
        raise ValueError(f"spread of {field.name} must be low, high, got {spread!r}")
    field.checked([low, high])
    return uniform(low, high - low)


def _values(
    distributions: Mapping[str, tuple[Field, Distribution]], drawn: Array
) -> dict[str, Array]:
    """Return values of each parameter from points of the unit cube, shape (d, m)."""
    return {
        name: np.asarray(field.checked(np.asarray(law.ppf(points))))
        for (name, (field, law)), points in zip(distributions.items(), drawn, strict=True)
    }


def _power_of_two(most: int) -> int:
    return 0 if most < 1 else 1 << (most.bit_length() - 1)


def _indices(answers: Answers, speed: str, names: tuple[str, ...], n: int, base: int) -> Indices:
    d = len(names)
    V = answers[speed]
    f = np.concatenate(
        [V[None, :base], V[None, n : n + base], V[2 * n :].reshape(d, base)]
    )  # A, B, A with one parameter of B
    whole = f[:, np.isfinite(f).all(axis=0)]
    kept = _power_of_two(whole.shape[1])
    if kept < _FEWEST:
        return Indices(names, np.full(d, np.nan), np.full(d, np.nan), kept)
    if d == 1:  # it explains everything; sobol_indices is not made for one
        return Indices(names, np.ones(1), np.ones(1), kept)
    f = whole[:, :kept]
    found = sobol_indices(func={"f_A": f[None, 0], "f_B": f[None, 1], "f_AB": f[2:, None]}, n=kept)
    first, total = np.reshape(found.first_order, d), np.reshape(found.total_order, d)
    return Indices(names, first, total, kept)
