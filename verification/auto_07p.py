"""AUTO-07p as a yardstick: compile the equations, follow a branch, read back what was found.

AUTO's own Python front end is left out: its executable reads constants from standard input and
writes text files, which is all that is needed here, and all that is timed.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hunting import Parameters

Array = NDArray[np.float64]

LIBRARY = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p")) / "lib"
EQUATIONS = Path(__file__).with_name("hunting.f90")
WHEELSET, BOGIE = 4, 6  # states
ROUNDING = 1e-6  # of the dead band [m]

SPEED, AMPLITUDE, PERIOD, FIRST, EPS = 1, 2, 11, 21, 43  # places in PAR, see hunting.f90
_VEHICLE = (
    *("m_w", "I_wx", "I_wy", "r0", "d", "lam", "W_A", "b", "Ky", "Cy", "Kpsi"),
    *("f11", "f22", "f12", "f33", "Kr", "delta", "C1", "C2", "C3", "C4", "m_B"),
)

# Arclength is lateral displacement in mm, and nothing else: with AUTO's own weights, which let V
# swamp y, a step jumps over the corner that the dead band puts into the branch, or the run stalls
# there.
WEIGHTS = {"THU": {1: 1e6}, "THL": {SPEED: 0.0, PERIOD: 0.0}}
CONSTANTS: dict[str, Any] = {
    "NPAR": EPS,
    "JAC": 1,
    "NTST": 800,
    "NCOL": 4,
    "IAD": 3,
    "ISP": 2,
    "IID": 2,
    "NPR": 0,
    "EPSL": 1e-9,
    "EPSU": 1e-9,
    "EPSS": 1e-8,
    "ITMX": 20,
    "ITNW": 9,
    "NWTN": 3,
    **WEIGHTS,
}
_KINDS = {1: "BP", 2: "LP", 3: "HB", 5: "LP", 6: "BP", -4: "UZ", 9: "EP", -9: "MX"}


@dataclass(frozen=True)
class Point:
    """A labelled point of a continuation.

    Attributes
    ----------
    kind : str
        AUTO's two letters: HB, LP (fold), UZ (asked for), EP (end), MX (no convergence).
    label : int
    speed, period, amplitude : float
        V [m/s], T [s] and the peak of |y| [m], read off the collocation polynomials.
    multipliers : ndarray, complex
        Floquet multipliers to the six digits AUTO prints; empty for the centred motion.
    """

    kind: str
    label: int
    speed: float
    period: float
    amplitude: float
    multipliers: NDArray[np.complex128]


@dataclass(frozen=True)
class Run:
    """What a continuation found: its labelled points, how many it took, and how long."""

    points: list[Point]
    steps: int
    seconds: float

    def of_kind(self, kind: str) -> list[Point]:
        """Return the labelled points of one kind."""
        return [point for point in self.points if point.kind == kind]

    def fold(self, index: int) -> float:
        """Return the speed of a fold [m/s]; NaN if it was missed."""
        folds = self.of_kind("LP")
        return folds[index].speed if index < len(folds) else np.nan


def missing() -> str:
    """Return what AUTO-07p lacks on this machine, in words; empty if nothing."""
    if not LIBRARY.is_dir():
        return f"AUTO-07p is not at {LIBRARY.parent} (Debian: apt-get install auto-07p gfortran)"
    if not shutil.which("gfortran"):
        return "AUTO-07p needs gfortran (Debian: apt-get install gfortran)"
    return ""


class Auto:
    """AUTO-07p on the equations in ``hunting.f90``.

    Parameters
    ----------
    folder : Path
        Where to compile and run.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        objects = [str(path) for path in sorted(LIBRARY.glob("*.o"))]
        compiler = ["gfortran", "-O3", "-fopenmp", str(EQUATIONS), *objects, "-o", "hunting"]
        subprocess.run(compiler, cwd=folder, check=True, capture_output=True, text=True)

    def centred(
        self, p: Parameters, states: int, speeds: tuple[float, float], eps: float = ROUNDING
    ) -> Run:
        """Follow the centred motion over a range of speeds [m/s]; its HB are the Hopf points."""
        values = [getattr(p, name) for name in _VEHICLE]
        par = {SPEED: speeds[0], EPS: eps, **dict(enumerate(values, FIRST))}
        step = (speeds[1] - speeds[0]) / 200
        return self.run(
            "centred",
            NDIM=states,
            IPS=1,
            ILP=0,
            PAR=par,
            ICP=[SPEED, PERIOD, AMPLITUDE],
            THL={},
            DS=step,
            DSMIN=step / 1e6,
            DSMAX=step,
            NMX=10_000,
            UZSTOP={SPEED: speeds[1]},
        )

    def branch(
        self, states: int, start: Point, amplitudes: list[float], end: float, **constants: Any
    ) -> Run:
        """Follow the limit cycles from a Hopf point of ``centred`` up to amplitude `end` [m].

        Cycles whose largest |y| at the collocation points is one of `amplitudes` [m] are labelled.
        """
        return self.run(
            "branch",
            **{
                "s": "'centred'",
                "IRS": start.label,
                "NDIM": states,
                "IPS": 2,
                "ILP": 1,
                "ICP": [SPEED, PERIOD, AMPLITUDE],
                "UZR": {AMPLITUDE: amplitudes},
                "UZSTOP": {AMPLITUDE: end},
                "DS": -0.01,
                "DSMIN": 1e-9,
                "DSMAX": 0.1,
                "NMX": 20_000,
                **constants,
            },
        )

    def run(self, name: str, **constants: Any) -> Run:
        """Run AUTO with the given constants beside `CONSTANTS`."""
        text = "".join(f"{key} = {value}\n" for key, value in {**CONSTANTS, **constants}.items())
        began = time.perf_counter()
        subprocess.run(
            ["./hunting"],
            cwd=self.folder,
            input=f"{text}sv = '{name}'\n",
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            check=True,
            capture_output=True,
            text=True,
        )
        seconds = time.perf_counter() - began
        rows = list(_diagram(self.folder / f"b.{name}"))
        multipliers = _multipliers(self.folder / f"d.{name}")
        peaks = _peaks(self.folder / f"s.{name}")
        points = [
            Point(
                kind=_KINDS.get(kind, str(kind)),
                label=label,
                speed=values[0],
                period=values[-2],
                amplitude=peaks[label],
                multipliers=np.array(multipliers.get(label, []), dtype=complex),
            )
            for kind, label, values in rows
            if label
        ]
        return Run(points, len(rows), seconds)


def _diagram(path: Path) -> Iterator[tuple[int, int, list[float]]]:
    """Yield type, label and values of each point in AUTO's b-file."""
    for line in path.read_text().splitlines():
        branch, *words = line.split()
        if branch != "0":
            yield int(words[1]), int(words[2]), [float(word) for word in words[3:]]


def _multipliers(path: Path) -> Mapping[int, list[complex]]:
    """Return the multipliers AUTO's d-file lists ahead of each labelled point."""
    found: dict[int, list[complex]] = {}
    current: list[complex] = []
    for line in path.read_text().splitlines():
        words = line.split()
        if "Multipliers:" in words:
            current = []
        elif "Multiplier" in words:
            current.append(complex(float(words[4]), float(words[5])))
        elif len(words) > 4 and words[2] in _KINDS.values() and words[3].isdigit():
            found[int(words[3])] = current
    return found


def _peaks(path: Path) -> Mapping[int, float]:
    """Return the peak of |y| of each solution in AUTO's s-file."""
    peaks = {}
    lines = iter(path.read_text().splitlines())
    for line in lines:
        header = [int(word) for word in line.split()]
        label, count, width, rows, degree = (header[i] for i in (3, 6, 7, 8, 10))
        words = " ".join(next(lines) for _ in range(rows)).split()
        table = np.array([float(word) for word in words[: count * width]]).reshape(count, width)
        peaks[label] = _peak(table[:, 0], table[:, 1], degree) if count > 1 else 0.0
    return peaks


def _peak(t: Array, y: Array, degree: int) -> float:
    """Return the largest |y| of polynomials with `degree` + 1 values on each piece."""
    pieces = (len(t) - 1) // degree
    piece = min(int(np.argmax(np.abs(y))) // degree, pieces - 1)
    largest = 0.0
    for first in {piece * degree, (piece - 1) % pieces * degree}:
        part = slice(first, first + degree + 1)
        fit = np.polynomial.Polynomial.fit(t[part], y[part], degree)
        turns = [root.real for root in fit.deriv().roots() if abs(root.imag) < 1e-12]
        inside = [root for root in turns if t[part][0] <= root <= t[part][-1]]
        largest = max(largest, np.abs(fit([*t[part], *inside])).max())
    return float(largest)
