"""AUTO-07p, which follows the branch by collocation on equations of its own (``hunting.f90``).

It needs smooth equations: the corners of the dead band are rounded by 1e-6 m. That alone moves its
Hopf speed by 1.3e-7, its cycles in contact by 6e-6 and a fold at the clearance by 2e-5. Rounded by
1e-7 m its folds come nearer accordingly; the stiffness that the rounding leaves at rest is known,
and added to our equations it closes the gap between the Hopf points.
"""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hunting import (
    RECONSTRUCTED,
    LureSystem,
    Parameters,
    bogie,
    hopf_points,
    limit_cycles,
    wheelset,
)
from verification.auto_07p import BOGIE, ROUNDING, WHEELSET, Auto, Point, missing
from verification.cycles import cycles_at, dominant
from verification.row import Row, worst

HARMONICS = 63
FREE = (0.25, 0.5, 0.75, 0.95)  # peak displacement over the clearance
TOUCHING = (1.01, 1.03, 1.1)
END = 1.17  # beyond the second fold of RECONSTRUCTED


@dataclass(frozen=True)
class Subject:
    """A vehicle with its parameters and the speeds among which its Hopf points are [m/s]."""

    name: str
    vehicle: Callable[[Parameters], LureSystem]
    states: int
    p: Parameters
    speeds: tuple[float, float] = (30.0, 60.0)

    @property
    def system(self) -> LureSystem:
        """The program's own equations."""
        return self.vehicle(self.p)

    @property
    def delta(self) -> float:
        """Clearance [m]."""
        return float(self.p.delta)


_EARLY = RECONSTRUCTED.replace(C4=5e8, Kpsi=1.0404e5, Cy=1.89e4)
_SOFT = RECONSTRUCTED.replace(r0=0.7462, lam=0.04, b=0.65, Ky=1.3872e5, Kpsi=1.3872e5, Cy=1.47e4)
TWO_FOLDS = [
    Subject("wheelset", wheelset, WHEELSET, RECONSTRUCTED),
    Subject("bogie", bogie, BOGIE, RECONSTRUCTED),
]
ONE_FOLD = [
    Subject("wheelset, damper hardening early", wheelset, WHEELSET, _EARLY),
    Subject("bogie, damper hardening early", bogie, BOGIE, _EARLY),
]
WINDOW = Subject("bogie with a window of hunting at low speed", bogie, BOGIE, _SOFT, (2.0, 80.0))


def rows() -> Iterator[Row]:
    """Compare Hopf points, cycles, multipliers and folds; nothing where AUTO is missing."""
    if missing():
        return
    with tempfile.TemporaryDirectory() as folder:
        auto = Auto(Path(folder))
        for subject in (*TWO_FOLDS, *ONE_FOLD, WINDOW):
            yield from _hopf_rows(auto, subject)
        for subject in (*TWO_FOLDS, *ONE_FOLD):
            yield from _branch_rows(auto, subject)
        for subject in TWO_FOLDS:
            yield from _second_fold_rows(auto, subject)


def _hopf_rows(auto: Auto, subject: Subject) -> Iterator[Row]:
    theirs = auto.centred(subject.p, subject.states, subject.speeds).of_kind("HB")
    for note, system, allowed in (
        ("", subject.system, 5e-7),
        (" with the rounding's stiffness added", _with_rounding(subject), 1e-8),
    ):
        ours = hopf_points(system, subject.speeds)
        found = zip(ours.speed, ours.frequency, theirs, strict=True)
        for i, (V, omega, point) in enumerate(found, 1):
            where = f"{subject.name}: Hopf point {i} of {len(theirs)}{note}"
            yield Row(f"{where}, speed [km/h]", 3.6 * V, 3.6 * point.speed, allowed)
            yield Row(f"{where}, frequency [Hz]", omega / (2 * np.pi), 1 / point.period, allowed)


def _branch_rows(auto: Auto, subject: Subject) -> Iterator[Row]:
    delta = subject.delta
    asked = [delta * share for share in (*FREE, *TOUCHING)]
    for eps, allowed in ((ROUNDING, 3e-5), (ROUNDING / 10, 3e-6)):
        (start,) = auto.centred(subject.p, subject.states, subject.speeds, eps).of_kind("HB")
        run = auto.branch(subject.states, start, asked, 1.12 * delta)
        if eps == ROUNDING:
            yield from _cycle_rows(subject, run.of_kind("UZ"))
        ours = limit_cycles(subject.system, harmonics=HARMONICS).fold
        yield Row(
            f"{subject.name}: fold, dead band rounded by {eps:g} m, speed [km/h]",
            3.6 * float(ours[0]) if ours else np.nan,
            3.6 * run.fold(0),
            allowed,
        )


def _cycle_rows(subject: Subject, theirs: list[Point]) -> Iterator[Row]:
    """Compare our cycles of exactly the amplitudes that AUTO's turned out to have."""
    delta = subject.delta
    for where, low, high, allowed, multiplier in (
        ("below contact", 0.0, 1.0, 1e-6, 1e-4),
        ("in contact", 1.0, 1.11, 1e-5, 2e-3),
    ):
        points = [point for point in theirs if low * delta < point.amplitude < high * delta]
        points.sort(key=lambda point: point.amplitude)
        ours = cycles_at(subject.system, [point.amplitude for point in points], HARMONICS)
        name = f"{subject.name}: worst of {len(points)} cycles {where}"
        pairs = list(zip(ours, points, strict=True))
        yield worst(
            Row(f"{name}, speed [km/h]", 3.6 * mine.speed, 3.6 * point.speed, allowed)
            for mine, point in pairs
        )
        yield worst(
            Row(f"{name}, frequency [Hz]", mine.hertz, 1 / point.period, allowed)
            for mine, point in pairs
        )
        yield worst(
            Row(
                f"{name}, largest nontrivial |multiplier|",
                mine.multiplier,
                dominant(point.multipliers),
                multiplier,
                absolute=True,
            )
            for mine, point in pairs
        )


def _second_fold_rows(auto: Auto, subject: Subject) -> Iterator[Row]:
    (start,) = auto.centred(subject.p, subject.states, subject.speeds).of_kind("HB")
    run = auto.branch(subject.states, start, [], END * subject.delta)
    yield Row(
        f"{subject.name}: second fold, hard against the flange, speed [km/h]",
        3.6 * limit_cycles(subject.system, harmonics=HARMONICS).speed.max(),
        3.6 * run.fold(1),
        1e-5,
    )


def _with_rounding(subject: Subject) -> LureSystem:
    """Return the system with the stiffness that the rounded dead band has at rest."""
    p = subject.p
    stiffness = -p.Kr * np.expm1(-0.5 * np.log1p((ROUNDING / p.delta) ** 2))
    A0 = subject.system.A0.copy()
    A0[1, 0] -= stiffness / p.m_w
    return dataclasses.replace(subject.system, A0=A0)
