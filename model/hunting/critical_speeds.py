"""Linear and nonlinear critical speeds: the one-line answer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from hunting.bogoliubov import (
    NO_HOPF_POINT,
    REACH,
    Averaging,
    averaged_fold,
    averaging,
    default_amplitudes,
)
from hunting.display import speeds_html, speeds_text
from hunting.elements import Array
from hunting.limit_cycles import MORE_HARMONICS, limit_cycles
from hunting.lure import LureSystem
from hunting.saddle_nodes import slowest_cycles
from hunting.stability import HopfPoints, hopf_points

Method = Literal["harmonic_balance", "averaging"]
_BRACKET = 64  # amplitudes that bracket a fold
_CHUNK = 1000  # systems solved for at once: bounds memory


@dataclass(frozen=True, repr=False)
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
        V_nl [m/s]: the lowest speed on the branch of limit cycles that starts at V_lin: a fold
        below V_lin, or V_lin itself if no cycle is slower. NaN if
        there is no V_lin, or no fold within the model's range.
    amplitude : float or ndarray, shape (...)
        Peak lateral displacement of the limit cycle at V_nl [m].
    frequency : float or ndarray, shape (...)
        Angular frequency at V_lin [rad/s].
    criticality : str or ndarray of str, shape (...)
        "subcritical" if the branch sets out towards lower speeds, "supercritical" if towards
        higher ones (it may still come back below V_lin later), or "none" without V_lin.
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

    def __repr__(self) -> str:
        return speeds_text(self)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        return speeds_html(self)

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
    method: Method = "harmonic_balance",
    points: HopfPoints | None = None,
) -> CriticalSpeeds:
    """Return the linear and the nonlinear critical speed.

    Parameters
    ----------
    system : LureSystem
        One system or a stack of them.
    method : {"harmonic_balance", "averaging"}
        How limit cycles are found: exactly, or by Bogoliubov's first order.
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
    >>> print(critical_speeds(bogie(RECONSTRUCTED)))
    subcritical: V_nl = 138.87 km/h, V_lin = 149.42 km/h, 2.20 Hz
    >>> print(critical_speeds(bogie(RECONSTRUCTED), method="averaging"))
    subcritical: V_nl = 140.03 km/h, V_lin = 149.42 km/h, 2.20 Hz
    """
    if method not in get_args(Method):
        raise ValueError(f"method must be one of {get_args(Method)}, got {method!r}")
    points = hopf_points(system) if points is None else points
    averaged = averaging(system, points)
    amplitudes = default_amplitudes(system.clearance, _BRACKET)
    V_fold, a_fold = averaged_fold(averaged, amplitudes)
    linear, missed = averaged.speed[..., 0], np.zeros(a_fold.shape, dtype=bool)
    if method == "averaging":
        falls = _falls_to_the_end(averaged.branch_speed(amplitudes))
        nonlinear = np.where(np.isfinite(V_fold), V_fold, np.where(falls, np.nan, linear))
        amplitude = np.where(np.isfinite(V_fold) | falls, a_fold, 0.0 * linear)
    else:
        nonlinear, amplitude, missed = _exact(system, points, averaged, a_fold)
    message = _messages(points, nonlinear, missed)
    nonlinear = np.where(nonlinear > 0, nonlinear, np.nan)
    amplitude = np.where(nonlinear > 0, amplitude, np.nan)
    # v|v| makes the branch leave the Hopf point linearly: its first slope tells, not a coefficient.
    starts = averaged.branch_slope(1e-6 * np.asarray(system.clearance)[..., None])[..., 0]
    kind = np.where(starts < 0, "subcritical", "supercritical")
    return _answer(
        linear=linear,
        nonlinear=nonlinear,
        amplitude=amplitude,
        frequency=averaged.frequency[..., 0],
        criticality=np.where(np.isfinite(linear), kind, "none"),
        windows=_windows(points),
        message=message,
    )


def _exact(
    system: LureSystem, points: HopfPoints, averaged: Averaging, a_fold: Array
) -> tuple[Array, Array, Array]:
    """Return speed and amplitude of the slowest limit cycles, and where they were not found."""
    V, Y = np.full((2, a_fold.size), np.nan)
    missed = np.zeros(a_fold.size, dtype=bool)
    going = np.flatnonzero(np.isfinite(averaged.speed))
    for harmonics in MORE_HARMONICS:
        for first in range(0, len(going), _CHUNK):
            which = going[first : first + _CHUNK]
            part, hopf = system.take(which), points.take(which)
            slowest = slowest_cycles(part, averaging(part, hopf), a_fold.ravel()[which], harmonics)
            V[which], Y[which], missed[which] = slowest.V, slowest.Y, slowest.missed
        going = np.flatnonzero(missed)
    V[going] = Y[going] = np.nan
    for i in going:  # branches that turn more than once: each is looked at as a whole
        fold = limit_cycles(system.take(i), points=points.take(i)).fold
        if fold is not None:
            V[i], Y[i] = fold
            missed[i] = False
    return V.reshape(a_fold.shape), Y.reshape(a_fold.shape), missed.reshape(a_fold.shape)


def _falls_to_the_end(V: Array) -> Array:
    """Whether the branch is slowest at its end: no fold within the amplitudes looked at."""
    return np.argmin(np.where(np.isnan(V), np.inf, V), axis=-1) == V.shape[-1] - 1


def _messages(points: HopfPoints, nonlinear: Array, missed: Array) -> Array:
    no_point = points.hunting_index() < 0
    always = no_point & (points.unstable_pairs()[..., -1] > 0)
    ends = no_point & (points.direction < 0).any(axis=-1)
    return np.select(
        [always, ends, no_point, missed, nonlinear <= 0, np.isnan(nonlinear)],
        [
            "unstable at every speed in range",
            "unstable at low speed only",
            NO_HOPF_POINT,
            "the slowest limit cycle was not found",
            "the branch falls to speed zero, where averaging says nothing",
            f"no fold of the branch up to {REACH} times the clearance",
        ],
        default="",
    )


def _windows(points: HopfPoints) -> Array:
    """Return the unstable ranges below the hunting point, as pairs of speeds padded with NaN."""
    below = points.unstable_pairs()
    opens = (points.direction > 0) & (below[..., :-1] == 0)
    closes = (points.direction < 0) & (below[..., 1:] == 0)
    opens = np.concatenate([(points.unstable_below > 0)[..., None], opens], axis=-1)
    closes = np.concatenate([np.zeros_like(opens[..., :1]), closes], axis=-1)
    speeds = np.concatenate([points.lowest[..., None], points.speed], axis=-1)
    hunting = points.hunting_index()[..., None] + 1
    lower = (np.arange(speeds.shape[-1]) < hunting) | (hunting == 0)
    closes &= lower
    count = int(closes.sum(axis=-1).max(initial=0))
    windows = np.full((*hunting.shape[:-1], count, 2), np.nan)
    for k in range(count):
        end = closes & (np.cumsum(closes, axis=-1) == k + 1)
        begin = opens & (np.cumsum(opens, axis=-1) == k + 1)
        exists = end.any(axis=-1)
        for side, mark in enumerate((begin, end)):
            speed = np.where(mark, speeds, -np.inf).max(axis=-1)
            windows[..., k, side] = np.where(exists, speed, np.nan)
    return windows


def _answer(**values: Any) -> CriticalSpeeds:
    if values["linear"].ndim:
        return CriticalSpeeds(**values)
    windows = [(float(low), float(high)) for low, high in values.pop("windows")]
    return CriticalSpeeds(**{name: value.item() for name, value in values.items()}, windows=windows)
