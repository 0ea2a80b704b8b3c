"""Linear and nonlinear critical speeds: the one-line answer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from hunting.bogoliubov import (
    NO_HOPF_POINT,
    REACH,
    averaged_fold,
    averaging,
    default_amplitudes,
)
from hunting.elements import Array
from hunting.lure import LureSystem
from hunting.stability import HopfPoints, hopf_points

Method = Literal["averaging"]
_BRACKET = 64  # amplitudes that bracket a fold


@dataclass(frozen=True)
class CriticalSpeeds:
    """Critical speeds of one system, or of a stack of them.

    Below `nonlinear` every motion dies out; between `nonlinear` and `linear` it depends on the
    disturbance; above `linear` the bogie hunts by itself.

    Attributes
    ----------
    linear : float or ndarray, shape (...)
        V_lin [m/s]: the speed at which the fastest unstable range of the centred motion begins.
        NaN if there is none.
    nonlinear : float or ndarray, shape (...)
        V_nl [m/s]: the lowest speed on the branch of limit cycles that starts at V_lin, which is
        a fold if the Hopf point is subcritical and V_lin itself if it is supercritical. NaN if
        there is no V_lin, or no fold within the model's range.
    amplitude : float or ndarray, shape (...)
        Peak lateral displacement of the limit cycle at V_nl [m].
    frequency : float or ndarray, shape (...)
        Angular frequency at V_lin [rad/s].
    criticality : str or ndarray of str, shape (...)
        "subcritical", "supercritical", or "none" without V_lin.
    windows : list of (float, float), or ndarray, shape (..., k, 2)
        Lower unstable ranges that open and close again below V_lin [m/s]; in a stack padded with
        NaN.
    message : str or ndarray of str, shape (...)
        Why a value is missing, in words; empty if none is.
    """

    linear: float | Array
    nonlinear: float | Array
    amplitude: float | Array
    frequency: float | Array
    criticality: str | Array
    windows: list[tuple[float, float]] | Array
    message: str | Array

    def __str__(self) -> str:
        if np.ndim(self.linear):
            return f"critical speeds of {np.size(self.linear)} systems"
        if not np.isfinite(self.linear):
            return str(self.message)
        return (
            f"{self.criticality}: V_nl = {3.6 * self.nonlinear:.2f} km/h, "
            f"V_lin = {3.6 * self.linear:.2f} km/h, {self.frequency / (2 * np.pi):.2f} Hz"
        )


def critical_speeds(
    system: LureSystem,
    method: Method = "averaging",
    points: HopfPoints | None = None,
) -> CriticalSpeeds:
    """Return the linear and the nonlinear critical speed.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    method : {"averaging"}
        How limit cycles are found: Bogoliubov's first order.
    points : HopfPoints, optional
        The system's Hopf points, if they are known already.

    Returns
    -------
    CriticalSpeeds
        Floats for a single system, arrays for a stack.

    Raises
    ------
    ValueError
        If the method is unknown.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie, critical_speeds
    >>> print(critical_speeds(bogie(RECONSTRUCTED), method="averaging"))
    subcritical: V_nl = 140.03 km/h, V_lin = 149.42 km/h, 2.20 Hz
    """
    if method != "averaging":
        raise ValueError(f"method must be 'averaging', got {method!r}")
    points = hopf_points(system) if points is None else points
    averaged = averaging(system, points)
    amplitudes = default_amplitudes(system.clearance, _BRACKET)
    V_fold, a_fold = averaged_fold(averaged, amplitudes)

    linear = averaged.speed[..., 0]
    exists = np.isfinite(linear)
    falls = _falls_to_the_end(averaged.branch_speed(amplitudes))
    subcritical = np.isfinite(V_fold) | falls
    nonlinear = np.where(np.isfinite(V_fold), V_fold, np.where(falls, np.nan, linear))
    nonlinear = np.where(nonlinear > 0, nonlinear, np.nan)
    return _answer(
        linear=linear,
        nonlinear=nonlinear,
        amplitude=np.where(subcritical, a_fold, np.where(exists, 0.0, np.nan)),
        frequency=averaged.frequency[..., 0],
        criticality=np.where(exists, np.where(subcritical, "subcritical", "supercritical"), "none"),
        windows=_windows(points),
        message=_messages(points, nonlinear),
    )


def _falls_to_the_end(V: Array) -> Array:
    """Whether the branch is slowest at its end: no fold within the amplitudes looked at."""
    return np.argmin(np.where(np.isnan(V), np.inf, V), axis=-1) == V.shape[-1] - 1


def _messages(points: HopfPoints, nonlinear: Array) -> Array:
    no_point = points.hunting_index() < 0
    always = no_point & (points.unstable_pairs()[..., -1] > 0)
    return np.select(
        [always, no_point, np.isnan(nonlinear)],
        [
            "unstable at every speed in range",
            NO_HOPF_POINT,
            f"no fold of the branch up to {REACH} times the clearance",
        ],
        default="",
    )


def _windows(points: HopfPoints) -> Array:
    """Return the unstable ranges below the hunting point, as pairs of speeds padded with NaN."""
    below = points.unstable_pairs()
    opens = (points.direction > 0) & (below[..., :-1] == 0)
    closes = (points.direction < 0) & (below[..., 1:] == 0)
    position = np.arange(points.speed.shape[-1])
    in_window = position < points.hunting_index()[..., None]
    count = int((closes & in_window).sum(axis=-1).max(initial=0))
    windows = np.full((*points.speed.shape[:-1], count, 2), np.nan)
    for side, marks in enumerate((opens, closes)):
        rank = np.cumsum(marks, axis=-1) - 1
        for k in range(count):
            here = marks & in_window & (rank == k)
            speed = np.where(here, points.speed, -np.inf).max(axis=-1, initial=-np.inf)
            windows[..., k, side] = np.where(here.any(axis=-1), speed, np.nan)
    return windows


def _answer(**values: Any) -> CriticalSpeeds:
    if values["linear"].ndim:
        return CriticalSpeeds(**values)
    windows = [(float(low), float(high)) for low, high in values.pop("windows")]
    return CriticalSpeeds(**{name: value.item() for name, value in values.items()}, windows=windows)
