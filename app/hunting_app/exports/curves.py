"""The curves of each plot as CSV, in the units of its axes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from hunting.tables import header, rows
from hunting_app.picture import KMH, MM

if TYPE_CHECKING:
    from hunting import Parameters
    from hunting.branch import Branch
    from hunting_app.disturbance import Disturbed
    from hunting_app.picture import Picture

EXACT = "harmonic balance (exact limit cycles)"
AVERAGED = "averaging after Bogoliubov"
_EIGENVALUES = "eigenvalues of the centred motion"
_HERTZ = 1 / (2 * math.pi)
_UNITS = {"y": "mm", "ψ": "mrad", "z": "mm"}
Table = Mapping[str, list[Any]]


def csv(what: str, parameters: Parameters, shown: Picture, motion: Disturbed | None = None) -> str:
    """Return the curves of a plot with all that they follow from in the header.

    Parameters
    ----------
    what : str
        One of `TABLES`.
    parameters : Parameters
        Those that `shown` was computed with.
    shown : Picture
        What the page shows.
    motion : Disturbed, optional
        What a disturbance does, if one is shown.
    """
    title, method, records = TABLES[what]
    about = [title]
    if what in ("portraits", "motion"):
        about.append(f"forward speed V = {shown.speed!r} km/h")
    vehicles = ", ".join(shown.answers)
    return header("; ".join(about), vehicles, method, parameters, set()) + rows(
        _columns(list(records(shown, motion)))
    )


def _columns(records: list[dict[str, Any]]) -> Table:
    """Return records as columns; what a record does not have is empty."""
    names = dict.fromkeys(name for record in records for name in record)
    return {name: [record.get(name, math.nan) for record in records] for name in names}


def _diagram(shown: Picture, _: Disturbed | None) -> Iterator[dict[str, Any]]:
    for vehicle, one in shown.answers.items():
        for speed, omega in zip(one.hopf.speed, one.hopf.frequency, strict=True):
            yield _cycle(vehicle, _EIGENVALUES, "Hopf point", speed, 0.0, omega)
        for method, branch in ((EXACT, one.exact), (AVERAGED, one.averaged)):
            if branch is not None:
                yield from _branch(vehicle, method, branch)


def _branch(vehicle: str, method: str, branch: Branch) -> Iterator[dict[str, Any]]:
    if branch.fold is not None:
        speed, amplitude = map(float, branch.fold)
        omega = np.interp(amplitude, branch.amplitude, branch.frequency)
        yield _cycle(vehicle, method, "fold", speed, amplitude, omega)
    points = zip(branch.stable, branch.speed, branch.amplitude, branch.frequency, strict=True)
    for stable, *point in points:
        yield _cycle(vehicle, method, _kind(stable), *point)


def _kind(stable: bool) -> str:
    return "stable" if stable else "unstable"


def _cycle(
    vehicle: str, method: str, kind: str, speed: float, amplitude: float, omega: float
) -> dict[str, Any]:
    return {
        "vehicle": vehicle,
        "method": method,
        "kind": kind,
        "forward speed V [km/h]": KMH * float(speed),
        "amplitude, peak |y| [mm]": MM * float(amplitude),
        "frequency [Hz]": _HERTZ * float(omega),
    }


def _portraits(shown: Picture, _: Disturbed | None) -> Iterator[dict[str, Any]]:
    for vehicle, moment in shown.moments.items():
        symbols = shown.answers[vehicle].branch.system.symbols
        for cycle in moment.cycles:
            for t, x in zip(cycle.motion.time, cycle.motion.state, strict=True):
                yield {
                    "vehicle": vehicle,
                    "kind": _kind(cycle.stable),
                    "amplitude, peak |y| [mm]": MM * cycle.amplitude,
                    "time t [s]": float(t),
                } | {_named(s): MM * float(value) for s, value in zip(symbols, x, strict=True)}


def _motion(shown: Picture, motion: Disturbed | None) -> Iterator[dict[str, Any]]:
    for index, size in enumerate(() if motion is None else motion.sizes):
        assert motion is not None
        symbols = motion.trajectory.system.symbols
        columns = {_named(s): motion.column(s, index) for s in symbols}
        columns |= {f"{name} [N]": force[index] for name, force in motion.trajectory.forces.items()}
        for k, t in enumerate(motion.trajectory.time):
            yield {
                "vehicle": motion.vehicle,
                "disturbance, peak |y| [mm]": MM * float(size),
                "time t [s]": float(t),
            } | {name: float(column[k]) for name, column in columns.items()}


def _named(symbol: str) -> str:
    unit = _UNITS[symbol.rstrip("'")]
    return f"{symbol} [{unit}{'/s' if symbol.endswith(chr(39)) else ''}]"


def _damping(shown: Picture, _: Disturbed | None) -> Iterator[dict[str, Any]]:
    for vehicle, ratios in shown.damping.items():
        for speed, at in zip(shown.speeds, ratios, strict=True):
            yield {"vehicle": vehicle, "forward speed V [km/h]": float(speed)} | {
                f"damping ratio of eigenvalue {k} [%]": 100 * float(ratio)
                for k, ratio in enumerate(at, start=1)
            }


def _locus(shown: Picture, _: Disturbed | None) -> Iterator[dict[str, Any]]:
    for vehicle, sweep in shown.sweeps.items():
        for speed, roots in zip(shown.speeds, sweep, strict=True):
            for s in roots:
                yield {
                    "vehicle": vehicle,
                    "forward speed V [km/h]": float(speed),
                    "growth rate Re s [1/s]": float(s.real),
                    "Im s / 2π [Hz]": _HERTZ * float(s.imag),
                }


Records = Callable[["Picture", "Disturbed | None"], Iterator[dict[str, Any]]]
TABLES: dict[str, tuple[str, str, Records]] = {
    "bifurcation": ("Bifurcation diagram", "in the column of that name", _diagram),
    "portraits": ("Phase portraits: limit cycles", EXACT, _portraits),
    "motion": ("Simulated motion", "time integration of the full nonlinear equations", _motion),
    "damping": ("Damping ratios, the least first", _EIGENVALUES, _damping),
    "locus": ("Root locus", _EIGENVALUES, _locus),
}
