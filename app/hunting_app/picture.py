"""From the person's choices to what is drawn: every number here comes from the model."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hunting import Parameters, bogie, wheelset
from hunting.bogoliubov import averaged_branch
from hunting.branch import Branch, LimitCycle
from hunting.critical_speeds import CriticalSpeeds, critical_speeds
from hunting.elements import Array, Phasor
from hunting.stability import HopfPoints, eigenvalues, hopf_points
from hunting_app.state import VEHICLES

if TYPE_CHECKING:
    from collections.abc import Iterable

KMH = 3.6  # km/h in a m/s
MM = 1e3  # mm in a m; mrad in a rad
_SYSTEMS = {"bogie": bogie, "wheelset": wheelset}
_SWEEP = 160  # speeds of the damping curves
_CYCLE = 97  # instants of a limit cycle: a closed curve without visible corners


@dataclass(frozen=True)
class Answers:
    """What the model says of one vehicle, at every speed."""

    vehicle: str
    critical: CriticalSpeeds
    hopf: HopfPoints
    branch: Branch

    @property
    def unstable_everywhere(self) -> bool:
        """No Hopf point, as the centred motion is never stable."""
        return not self.hopf.speed.size and self.hopf.unstable_below.item() > 0

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
    speeds : ndarray
        Speeds of the sweeps [km/h], to the end of the speed axis.
    """

    clearance: float
    speed: float
    answers: dict[str, Answers]
    moments: dict[str, Moment]
    sweeps: dict[str, Phasor]
    speeds: Array


def picture(parameters: Parameters, vehicle: str, speed: float) -> Picture:
    """Return what a choice of parameters, vehicle and speed [km/h] looks like.

    Raises
    ------
    ValueError
        If the equations cannot be solved with these values.
    """
    try:
        return _picture(tuple(parameters.to_dict().values()), vehicle, speed)
    except (np.linalg.LinAlgError, FloatingPointError, OverflowError) as error:
        raise ValueError(
            "the equations cannot be solved in double precision with this value"
        ) from error


@lru_cache(maxsize=8)
def _picture(values: tuple[float, ...], vehicle: str, speed: float) -> Picture:
    vehicles = VEHICLES[vehicle]
    answers = {name: _answers(values, name) for name in vehicles}
    end = _axis_end(answers.values(), speed)
    return Picture(
        clearance=MM * float(Parameters(*values).delta),
        speed=speed,
        answers=answers,
        moments={name: _moment(answers[name], speed) for name in vehicles},
        sweeps={name: _sweep(values, name, end) for name in vehicles},
        speeds=_speeds(end),
    )


@lru_cache(maxsize=64)
def _answers(values: tuple[float, ...], vehicle: str) -> Answers:
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        system = _SYSTEMS[vehicle](Parameters(*values))
        hopf = hopf_points(system)
        return Answers(
            vehicle,
            critical_speeds(system, method="averaging", points=hopf),
            hopf,
            averaged_branch(system, points=hopf),
        )


@lru_cache(maxsize=64)
def _sweep(values: tuple[float, ...], vehicle: str, end: float) -> Phasor:
    return eigenvalues(_answers(values, vehicle).branch.system, _speeds(end) / KMH)


def _moment(answers: Answers, speed: float) -> Moment:
    branch = answers.branch
    return Moment(
        cycles=branch.at_speed(speed / KMH, samples=_CYCLE) if branch.speed.size else [],
        eigenvalues=eigenvalues(branch.system, [speed / KMH])[0],
    )


def _speeds(end: float) -> Array:
    return np.linspace(end / _SWEEP, end, _SWEEP)


def _axis_end(answers: Iterable[Answers], speed: float) -> float:
    """Return an end of the speed axis [km/h] that does not jump with every move."""
    linear = [KMH * float(one.critical.linear) for one in answers]
    reach = [1.25 * V for V in linear if math.isfinite(V)] or [240.0]
    return 50.0 * math.ceil(max(*reach, 1.05 * speed) / 50.0)
