"""From the person's choices to what is drawn: every number here comes from the model."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hunting import Parameters, bogie, wheelset
from hunting.bogoliubov import averaged_branch
from hunting.branch import Branch, LimitCycle
from hunting.critical_speeds import CriticalSpeeds, critical_speeds
from hunting.elements import Array, Phasor, PolynomialDamper
from hunting.limit_cycles import limit_cycles
from hunting.stability import HopfPoints, damping_ratios, eigenvalues, hopf_points
from hunting_app.state import VEHICLES

if TYPE_CHECKING:
    from collections.abc import Iterable

KMH = 3.6  # km/h in a m/s
MM = 1e3  # mm in a m; mrad in a rad
_SYSTEMS = {"bogie": bogie, "wheelset": wheelset}
_SWEEP = 160  # speeds of the damping curves
Values = tuple[float, ...]  # of all parameters; hashable, unlike them
_CYCLE = 97  # instants of a limit cycle: a closed curve without visible corners


@dataclass(frozen=True)
class Answers:
    """What the model says of one vehicle, at every speed.

    Attributes
    ----------
    vehicle : str
        ``"bogie"`` or ``"wheelset"``.
    hopf : HopfPoints
        All its Hopf points.
    averaging : CriticalSpeeds
        Critical speeds by averaging.
    averaged : Branch
        The branch of limit cycles by averaging.
    exact : Branch or None
        The exact one; None where it is hidden.
    """

    vehicle: str
    hopf: HopfPoints
    averaging: CriticalSpeeds
    averaged: Branch
    exact: Branch | None

    @property
    def branch(self) -> Branch:
        """The branch that all answers come from: the exact one unless it is hidden."""
        return self.averaged if self.exact is None else self.exact

    @cached_property
    def critical(self) -> CriticalSpeeds:
        """The critical speeds, V_nl from `branch`."""
        return self.averaging if self.exact is None else _by(self.exact, self.averaging)

    @property
    def error_of_averaging(self) -> float:
        """How far averaging is off at the fold [km/h]; NaN where either has none."""
        if self.exact is None or self.exact.fold is None or self.averaged.fold is None:
            return math.nan
        return KMH * float(self.averaging.nonlinear - self.exact.fold[0])

    @property
    def unstable_everywhere(self) -> bool:
        """No Hopf point, as the centred motion is never stable."""
        return not self.hopf.speed.size and self.hopf.unstable_below.item() > 0

    @cached_property
    def damper_pushes(self) -> tuple[float, float] | None:
        """The speeds of the yaw damper [m/s] at which its force is negative, from where to where.

        None if no limit cycle of the branch is that fast.
        """
        branch = self.branch
        for at in branch.system.elements:
            if isinstance(at.element, PolynomialDamper) and branch.speed.size:
                pushes = at.element.pushes()
                largest = branch.motion(int(np.argmax(branch.amplitude)), _CYCLE).state
                if pushes is not None and np.abs(largest @ at.C.T).max() > pushes[0]:
                    return pushes
        return None

    @property
    def lowest(self) -> float:
        """The lowest speed [km/h] from which a limit cycle is known: V_nl, or the branch's end."""
        if math.isfinite(self.critical.nonlinear):
            return KMH * float(self.critical.nonlinear)
        speeds = self.branch.speed
        return KMH * float(max(np.min(speeds), 0.0)) if speeds.size else math.nan


@dataclass(frozen=True)
class Moment:
    """What the model says of one vehicle at the chosen speed."""

    cycles: list[LimitCycle]
    eigenvalues: Phasor
    damping: Array

    @property
    def centre_is_stable(self) -> bool:
        """Whether a small disturbance dies out."""
        return bool(self.eigenvalues.real.max() < 0)


@dataclass(frozen=True)
class Picture:
    """Everything the Explore page shows.

    Attributes
    ----------
    clearance : float
        The flange clearance [mm].
    speed : float
        The chosen speed [km/h].
    answers, moments, sweeps : dict
        By vehicle: at every speed; at the chosen one; eigenvalues at `speeds`.
    damping : dict
        By vehicle: damping ratios at `speeds`, the least first.
    speeds : ndarray
        Speeds of the sweeps [km/h], to the end of the speed axis.
    baseline : dict
        By vehicle: what the model says of the baseline; empty where none is pinned.
    baseline_damping : dict
        By vehicle: its least damping ratio at `speeds`.
    baseline_clearance : float
        Its flange clearance [mm]; 0 where none is pinned.
    """

    clearance: float
    speed: float
    answers: dict[str, Answers]
    moments: dict[str, Moment]
    sweeps: dict[str, Phasor]
    damping: dict[str, Array]
    speeds: Array
    baseline: dict[str, Answers]
    baseline_damping: dict[str, Array]
    baseline_clearance: float


def picture(
    parameters: Parameters,
    vehicle: str,
    speed: float,
    exact: bool = True,
    baseline: Parameters | None = None,
) -> Picture:
    """Return what a choice of parameters, vehicle and speed [km/h] looks like.

    Without `exact` all answers are those of averaging, those for the baseline too.

    Raises
    ------
    ValueError
        If the equations cannot be solved with these values.
    """
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            pinned = None if baseline is None else _values(baseline)
            return _picture(_values(parameters), vehicle, speed, exact, pinned)
    except (np.linalg.LinAlgError, FloatingPointError, OverflowError) as error:
        raise ValueError(
            "the equations cannot be solved in double precision with this value"
        ) from error


def critical(parameters: Parameters, vehicle: str, exact: bool) -> CriticalSpeeds:
    """Return the critical speeds of a vehicle, V_nl of the exact branch or by averaging.

    Raises
    ------
    ValueError
        If the equations cannot be solved with these values.
    """
    return next(iter(picture(parameters, vehicle, 100.0, exact).answers.values())).critical


def _values(parameters: Parameters) -> Values:
    return tuple(parameters.to_dict().values())


@lru_cache(maxsize=8)
def _picture(
    values: Values, vehicle: str, speed: float, exact: bool, baseline: Values | None
) -> Picture:
    vehicles = VEHICLES[vehicle]
    answers = {name: _answers(values, name) for name in vehicles}
    if exact:
        answers = {name: _with_exact(values, name) for name in vehicles}
    pinned = {name: _pinned(baseline, name, exact) for name in vehicles} if baseline else {}
    end = _axis_end([*answers.values(), *pinned.values()], speed)
    return Picture(
        clearance=MM * float(Parameters(*values).delta),
        speed=speed,
        answers=answers,
        moments={name: _moment(answers[name], speed) for name in vehicles},
        sweeps={name: _sweep(values, name, end) for name in vehicles},
        damping={name: _damping(values, name, end) for name in vehicles},
        speeds=_speeds(end),
        baseline=pinned,
        baseline_damping={n: _pinned_damping(baseline, n, end) for n in pinned if baseline},
        baseline_clearance=MM * float(Parameters(*baseline).delta) if baseline else 0.0,
    )


@lru_cache(maxsize=128)  # one for each visitor; not forgotten for others' moves
def _pinned(values: Values, vehicle: str, exact: bool) -> Answers:
    return _with_exact(values, vehicle) if exact else _answers(values, vehicle)


@lru_cache(maxsize=128)
def _pinned_damping(values: Values, vehicle: str, end: float) -> Array:
    return _damping(values, vehicle, end)[:, 0]


@lru_cache(maxsize=64)
def _answers(values: Values, vehicle: str) -> Answers:
    system = _SYSTEMS[vehicle](Parameters(*values))
    hopf = hopf_points(system)
    return Answers(
        vehicle,
        hopf,
        critical_speeds(system, method="averaging", points=hopf),
        averaged_branch(system, points=hopf),
        exact=None,
    )


@lru_cache(maxsize=64)
def _with_exact(values: Values, vehicle: str) -> Answers:
    answers = _answers(values, vehicle)
    try:
        return replace(answers, exact=limit_cycles(answers.averaged.system, points=answers.hopf))
    except (np.linalg.LinAlgError, FloatingPointError, OverflowError):
        return answers  # averaging, which has an answer, is named as its source


def _by(branch: Branch, averaging: CriticalSpeeds) -> CriticalSpeeds:
    """Return the critical speeds with V_nl from the exact branch, as far as that goes."""
    V, message = branch.speed, ""
    if not V.size:
        return averaging
    if branch.fold is not None:
        speed, amplitude = map(float, branch.fold)
    elif V.argmin() == 0:
        speed, amplitude = float(V[0]), 0.0
    else:
        speed = amplitude = math.nan
        message = f"no fold on the exact branch{branch.message and ': '}{branch.message}"
    return replace(averaging, nonlinear=speed, amplitude=amplitude, message=message)


@lru_cache(maxsize=64)
def _sweep(values: Values, vehicle: str, end: float) -> Phasor:
    return eigenvalues(_answers(values, vehicle).averaged.system, _speeds(end) / KMH)


@lru_cache(maxsize=64)
def _damping(values: Values, vehicle: str, end: float) -> Array:
    return np.sort(damping_ratios(_sweep(values, vehicle, end)), axis=-1)


def _moment(answers: Answers, speed: float) -> Moment:
    branch = answers.branch
    return Moment(
        cycles=branch.at_speed(speed / KMH, samples=_CYCLE) if branch.speed.size else [],
        eigenvalues=(s := eigenvalues(branch.system, [speed / KMH])[0]),
        damping=damping_ratios(s),
    )


def _speeds(end: float) -> Array:
    return np.linspace(end / _SWEEP, end, _SWEEP)


def _axis_end(answers: Iterable[Answers], speed: float) -> float:
    """Return an end of the speed axis [km/h] that does not jump with every move."""
    linear = [KMH * float(one.critical.linear) for one in answers]
    reach = [1.25 * V for V in linear if math.isfinite(V)] or [240.0]
    return 50.0 * math.ceil(max(*reach, 1.05 * speed) / 50.0)
