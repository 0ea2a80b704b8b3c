"""The smallest change of a design that brings its nonlinear critical speed to a target."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import Bounds, differential_evolution, minimize

from hunting.cases import Vehicle
from hunting.critical_speeds import critical_speeds
from hunting.elements import Array
from hunting.parameters import Field, Parameters
from hunting.sensitivity import sensitivity

_MET = 1e-4  # relative distance from the target that counts as met
_TRIALS = 40  # designs looked at by one search
_POPULATION, _GENERATIONS = 6, 30  # designs for each free parameter; of designs
_NONE = 10.0  # what a design without a critical speed counts for, beyond all logarithms of others


@dataclass(frozen=True)
class Design:
    """A changed design.

    Attributes
    ----------
    parameters : Parameters
        The changed design; the best there is, if the target is out of reach.
    changes : dict of str to float
        Relative change p/p0 - 1 of each free parameter.
    V_nonlinear : float
        Its nonlinear critical speed [m/s].
    target : float
        The one asked for [m/s].
    reached : bool
        Whether the two agree to 1e-4.
    smallest : bool
        Whether the change is known to be the smallest, at least among its neighbours.
    message : str
        The result in words.
    """

    parameters: Parameters
    changes: Mapping[str, float]
    V_nonlinear: float
    target: float
    reached: bool
    smallest: bool
    message: str

    def __str__(self) -> str:
        return self.message


def design(
    vehicle: Vehicle,
    parameters: Parameters,
    free: Sequence[str] | Mapping[str, tuple[float, float] | None],
    target: float,
) -> Design:
    """Return the smallest change that brings the nonlinear critical speed to the target.

    Parameters
    ----------
    vehicle : callable
        `wheelset` or `bogie`.
    parameters : Parameters
        The present design, as numbers.
    free : list of str, or dict of str to pair
        The parameters that may change, and the lowest and highest value [SI] of each; by default
        the field's span.
    target : float
        Nonlinear critical speed wanted [m/s].

    Returns
    -------
    Design
        The one whose relative changes p/p0 - 1 have the least sum of squares; or, if no design
        within the bounds has the target speed, the one found that comes nearest.

    Raises
    ------
    TypeError
        If a name is no field of the parameters.
    ValueError
        If a free parameter is zero, so that it has no relative change, or outside its bounds; if
        the target is not positive; if the present design has no nonlinear critical speed.

    Notes
    -----
    Sequential quadratic programming (SLSQP) with the derivatives of `sensitivity` from the present
    design. If that fails, differential evolution looks within the bounds for a design beyond the
    target, and a second search starts where the line from there to the present design meets it.
    "Out of reach" means that neither found one.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie, design
    >>> print(design(bogie, RECONSTRUCTED, ["Ky", "Kpsi"], target=150 / 3.6))
    V_nl = 150.0 km/h with Ky +10.6 %, Kpsi +20.1 %
    """
    search = _Search(vehicle, parameters, _limits(parameters, free), target)
    answer = search.nearest_with_target(np.zeros(len(search.names)))
    smallest = search.is_met(answer)
    if not smallest:
        answer = search.furthest()
        if search.is_beyond(answer):
            answer = search.between(answer)
            nearer = search.nearest_with_target(answer)
            smallest = search.is_met(nearer) and bool(nearer @ nearer <= answer @ answer)
            answer = nearer if smallest else answer
    return search.result(answer, smallest)


def _limits(
    parameters: Parameters, free: Sequence[str] | Mapping[str, tuple[float, float] | None]
) -> dict[str, tuple[float, float]]:
    """Return the lowest and highest relative change of each free parameter."""
    fields = {f.name: f for f in Parameters.fields()}
    unknown = [name for name in free if name not in fields]
    if unknown or not free:
        raise TypeError(f"free must be one or more of {', '.join(fields)}, got {free!r}")
    given = free if isinstance(free, Mapping) else dict.fromkeys(free)
    return {name: _limit(fields[name], parameters, bounds) for name, bounds in given.items()}


def _limit(
    field: Field, parameters: Parameters, bounds: tuple[float, float] | None
) -> tuple[float, float]:
    value = float(getattr(parameters, field.name))
    low, high = np.asarray(field.checked(field.span if bounds is None else bounds)).tolist()
    if value == 0:
        raise ValueError(f"{field.name} is 0 {field.unit}, it has no relative change")
    if not low <= value <= high:
        raise ValueError(
            f"{field.name} must be between its bounds {low:g} and {high:g} {field.unit}, "
            f"got {value!r}"
        )
    first, last = sorted((low / value - 1, high / value - 1))
    return first, last


class _GivenUp(Exception):
    """A search has looked at more designs than one that gets there does."""


class _Search:
    """Speeds over relative changes x of the free parameters, and the searches among them."""

    def __init__(
        self,
        vehicle: Vehicle,
        parameters: Parameters,
        limits: Mapping[str, tuple[float, float]],
        target: float,
    ) -> None:
        if not (np.isfinite(target) and target > 0):
            raise ValueError(f"target must be > 0 m/s, got {target!r}")
        self.vehicle, self.parameters, self.target = vehicle, parameters, target
        self.names, self.bounds = tuple(limits), Bounds(*np.transpose(list(limits.values())))
        self.start = np.array([getattr(parameters, name) for name in self.names])
        self.known: dict[bytes, tuple[float, Array]] = {}
        self.last, self.most = np.zeros(len(self.names)), 0
        V, _ = self.speed(self.last)
        if not np.isfinite(V):
            raise ValueError(f"the present design has no nonlinear critical speed: {self.why}")
        self.sign = 1.0 if target > V else -1.0

    def changed(self, x: Array) -> Parameters:
        values = (self.start * (1 + x.T)).T
        return self.parameters.replace(**dict(zip(self.names, values, strict=True)))

    def speed(self, x: ArrayLike) -> tuple[float, Array]:
        """Return ln(V_nl/target) and its derivative with x."""
        x = np.clip(x, self.bounds.lb, self.bounds.ub)
        key = x.tobytes()
        if key not in self.known:
            found = sensitivity(self.vehicle, self.changed(x))
            self.why = found.message
            slopes = np.array([found.of(name)[1] for name in self.names])
            # d ln V/dx is d ln V/d ln p over 1 + x; a parameter that has become zero gets none.
            slopes = np.divide(slopes, 1 + x, out=np.zeros(len(x)), where=x != -1)
            self.known[key] = (np.log(found.V_nonlinear / self.target), slopes)
        return self.known[key]

    def value(self, x: Array) -> float:
        """Return ln(V_nl/target); where there is no such speed, as from the last one found."""
        if len(self.known) > self.most:
            raise _GivenUp
        V, slope = self.speed(x)
        if np.isfinite(V) and np.isfinite(slope).all():
            self.last = np.array(x)
            return V
        V, slope = self.speed(self.last)
        return float(V + slope @ (x - self.last))

    def slope(self, x: Array) -> Array:
        V, slope = self.speed(x)
        whole = np.isfinite(V) and np.isfinite(slope).all()
        return slope if whole else self.speed(self.last)[1]

    def is_met(self, x: Array) -> bool:
        return abs(self.speed(x)[0]) <= _MET

    def is_beyond(self, x: Array) -> bool:
        return self.sign * self.speed(x)[0] > 0

    def nearest_with_target(self, x: Array) -> Array:
        """Return the smallest change with the target speed, sought from x."""
        self.last, self.most = x, len(self.known) + _TRIALS
        try:
            found = minimize(  # type: ignore[call-overload]
                lambda x: x @ x,
                x,
                jac=lambda x: 2 * x,
                bounds=self.bounds,
                constraints={"type": "eq", "fun": self.value, "jac": self.slope},
                method="SLSQP",
                options={"ftol": 1e-10},
            )
        except _GivenUp:
            return self.last
        return np.clip(found.x, self.bounds.lb, self.bounds.ub)

    def furthest(self) -> Array:
        """Return a change beyond the target, or the one whose speed comes nearest to it."""

        def shortfalls(x: Array) -> Array:
            stack = self.vehicle(self.changed(x.reshape(len(self.names), -1)))
            ahead = self.sign * np.log(critical_speeds(stack).nonlinear / self.target)
            return np.where(np.isfinite(ahead), -ahead, _NONE).reshape(x.shape[1:])

        def is_enough(intermediate_result: Any) -> bool:
            return bool(intermediate_result.fun < -_MET)

        found = differential_evolution(
            shortfalls,  # type: ignore[arg-type]
            self.bounds,
            x0=np.zeros(len(self.names)),
            popsize=_POPULATION,
            maxiter=_GENERATIONS,
            tol=1e-3,
            rng=0,
            callback=is_enough,  # type: ignore[arg-type]
            polish=False,
            updating="deferred",
            vectorized=True,
        )
        return found.x

    def between(self, x: Array) -> Array:
        """Return the change between none and x that has the target speed, by halving."""
        low, high = 0.0, 1.0
        for _ in range(40):
            middle = 0.5 * (low + high)
            if self.is_met(middle * x):
                return middle * x
            low, high = (low, middle) if self.is_beyond(middle * x) else (middle, high)
        return high * x

    def result(self, x: Array, smallest: bool) -> Design:
        V = float(self.target * np.exp(self.speed(x)[0]))
        changes = dict(zip(self.names, x.tolist(), strict=True))
        reached = self.is_met(x)
        words = ", ".join(f"{name} {100 * change:+.1f} %" for name, change in changes.items())
        message = f"V_nl = {3.6 * V:.1f} km/h with {words}"
        if not reached:
            wanted = f"{3.6 * self.target:.1f} km/h"
            message = f"{wanted} is out of reach within the bounds; the nearest is {message}"
        elif not smallest:
            message += "; there may be a smaller change"
        return Design(self.changed(x), changes, V, self.target, reached, smallest, message)
