"""SciPy's Radau, started on the program's limit cycles and beside them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

from hunting import RECONSTRUCTED, LureSystem, Parameters, bogie, simulate, wheelset
from verification.cycles import Cycle, cycles_at, dominant
from verification.radau import Radau
from verification.row import Row, worst

HARMONICS = 63
FREE = (0.3, 0.95)  # peak displacement over the clearance
TOUCHING = (1.02, 1.15)
UNSTABLE, HARD = 0.95, 1.1  # the cycles beside which motions start,
BESIDE = 0.05  # how far beside them,
WATCHED = 20.0  # and how long they last [s]


def rows() -> Iterator[Row]:
    """Start on the program's cycles, and beside its unstable ones."""
    p = RECONSTRUCTED
    for name, system in (("wheelset", wheelset(p)), ("bogie", bogie(p))):
        for where, shares, allowed, multiplier in (
            ("below contact", FREE, 1e-7, 1e-4),
            ("in contact", TOUCHING, 1e-5, 2e-3),
        ):
            cycles = cycles_at(system, [share * float(p.delta) for share in shares], HARMONICS)
            group = f"{name}: worst of {len(cycles)} cycles {where}"
            yield from _cycle_rows(group, p, cycles, allowed, multiplier)
        yield from _motion_rows(name, p, system)


def _cycle_rows(
    group: str, p: Parameters, cycles: list[Cycle], allowed: float, multiplier: float
) -> Iterator[Row]:
    periods, peaks, multipliers = [], [], []
    for cycle in cycles:
        radau = Radau(p, cycle.speed, len(cycle.start))
        period = 2 * np.pi / cycle.frequency
        times, heights, _ = radau.motion(cycle.start, 1.2 * period)
        periods.append(Row(f"{group}, period [s]", period, times[1], allowed))
        peaks.append(
            Row(f"{group}, next peak [mm]", 1e3 * cycle.amplitude, 1e3 * heights[1], allowed)
        )
        multipliers.append(
            Row(
                f"{group}, largest nontrivial |multiplier|",
                cycle.multiplier,
                dominant(radau.multipliers(cycle.start, period)),
                multiplier,
                absolute=True,
            )
        )
    yield from map(worst, (periods, peaks, multipliers))


def _motion_rows(name: str, p: Parameters, system: LureSystem) -> Iterator[Row]:
    """Compare motions that start inside and outside the unstable cycle, and hard in contact."""
    amplitudes = [share * float(p.delta) for share in (UNSTABLE, HARD)]
    unstable, hard = cycles_at(system, amplitudes, HARMONICS)
    for place, cycle, share in (
        ("inside the unstable cycle", unstable, 1 - BESIDE),
        ("outside the unstable cycle", unstable, 1 + BESIDE),
        ("inside a stable cycle in contact", hard, 1 - BESIDE),
    ):
        start = share * cycle.start
        times, heights, _ = Radau(p, cycle.speed, len(start)).motion(start, WATCHED)
        simulated = simulate(system, cycle.speed, start, WATCHED)
        mm = f"{1e3 * cycle.amplitude:.2f} mm"
        started = f"{name}: started {BESIDE:.0%} {place} of {mm}"
        yield Row(
            f"{started}, simulated, peak of the last of {WATCHED:g} s [mm]",
            1e3 * simulated.crest[simulated.crest_time >= WATCHED - 1].max(),
            1e3 * heights[times >= WATCHED - 1].max(),
            1e-4,
        )
        if place.startswith("inside the"):
            yield Row(
                f"{started}, share of {len(heights) - 1} peaks lower than the one before",
                float(cycle.multiplier > 1),
                float(np.mean(np.diff(heights) < 0)),
                0,
                absolute=True,
            )
        else:
            yield Row(
                f"{started}, last peak: the stable cycle [mm]",
                1e3 * _stable_amplitude(system, cycle.speed),
                1e3 * heights[-1],
                1e-5,
            )


def _stable_amplitude(system: LureSystem, speed: float) -> float:
    """Return the amplitude of the cycle in contact at a speed between the folds [m]."""

    def excess(amplitude: float) -> float:
        return cycles_at(system, [amplitude], HARMONICS)[0].speed - speed

    delta = float(system.clearance)
    return float(brentq(excess, 1.0001 * delta, 1.15 * delta, xtol=1e-9 * delta))
