"""The stored reference solutions of ``tests/model/reference.json``."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hunting import (
    LureSystem,
    Parameters,
    averaged_branch,
    bogie,
    hopf_points,
    limit_cycles,
    wheelset,
)
from hunting.limit_cycles import HARMONICS
from verification.cycles import cycles_at
from verification.row import Row, worst

REFERENCE = Path(__file__).parent.parent / "tests" / "model" / "reference.json"
VEHICLES = {"wheelset": wheelset, "bogie": bogie}
FINE = 63

Case = dict[str, Any]


def rows() -> Iterator[Row]:
    """Compare with all cases, the worst of each kind in a row."""
    cases: list[Case] = json.loads(REFERENCE.read_text(encoding="utf-8"))
    yield from _hopf_rows(cases)
    yield _averaging_row(cases)
    for harmonics, free, touching in ((HARMONICS, 1e-6, 3e-4), (FINE, 1e-8, 1e-5)):
        yield from _cycle_rows(cases, harmonics, free, touching)
    yield _fold_row(cases)


def _system(case: Case) -> LureSystem:
    return VEHICLES[case["vehicle"]](Parameters.from_dict(case["parameters"]))


def _hopf_rows(cases: list[Case]) -> Iterator[Row]:
    found = [(hopf_points(_system(case)), case["hopf"]) for case in cases]
    count = sum(len(theirs) for _, theirs in found)
    yield Row(
        f"Hopf points of {len(cases)} cases, number",
        sum(ours.speed.size for ours, _ in found),
        count,
        0,
        absolute=True,
    )
    pairs = [
        (V, omega, theirs)
        for ours, hopf in found
        for V, omega, theirs in zip(ours.speed, ours.frequency, hopf, strict=False)
    ]
    name = f"worst of {count} Hopf points"
    yield worst(
        Row(f"{name}, speed [km/h]", 3.6 * V, 3.6 * theirs["speed"], 1e-12)
        for V, _, theirs in pairs
    )
    yield worst(
        Row(f"{name}, frequency [rad/s]", omega, theirs["frequency"], 1e-12)
        for _, omega, theirs in pairs
    )


def _averaging_row(cases: list[Case]) -> Row:
    answers = []
    for case in cases:
        theirs = (case["averaging"] or {}).get("values", [])
        if theirs:
            ours = averaged_branch(_system(case), [value["first_harmonic"] for value in theirs])
            answers += [(V, value["speed"]) for V, value in zip(ours.speed, theirs, strict=True)]
    name = f"first-order averaging: worst of {len(answers)} points, speed [km/h]"
    return worst(Row(name, 3.6 * V, 3.6 * theirs, 1e-10) for V, theirs in answers)


def _cycle_rows(cases: list[Case], harmonics: int, free: float, touching: float) -> Iterator[Row]:
    pairs = []
    for case in cases:
        amplitudes = [point["amplitude"] for point in case["branch"]]
        if amplitudes:
            ours = cycles_at(_system(case), amplitudes, harmonics)
            pairs += list(zip(ours, case["branch"], strict=True))
    for where, in_contact, allowed, multiplier in (
        ("below contact", False, free, 1e-4),
        ("in contact", True, touching, 2e-3),
    ):
        chosen = [pair for pair in pairs if pair[1]["in_contact"] == in_contact]
        name = f"harmonics={harmonics}: worst of {len(chosen)} cycles {where}"
        yield worst(
            Row(f"{name}, speed [km/h]", 3.6 * mine.speed, 3.6 * theirs["speed"], allowed)
            for mine, theirs in chosen
        )
        yield worst(
            Row(f"{name}, frequency [rad/s]", mine.frequency, theirs["frequency"], allowed)
            for mine, theirs in chosen
        )
        yield worst(
            Row(
                f"{name}, largest nontrivial |multiplier|",
                mine.multiplier,
                theirs["multiplier"],
                multiplier,
                absolute=True,
            )
            for mine, theirs in chosen
        )
    yield Row(
        f"harmonics={harmonics}: stable ones among {len(pairs)} cycles, flags that agree",
        sum(mine.stable == theirs["stable"] for mine, theirs in pairs),
        len(pairs),
        0,
        absolute=True,
    )


def _fold_row(cases: list[Case]) -> Row:
    answers = []
    for case in cases:
        for branch in case["branches"]:
            ours = limit_cycles(_system(case), hopf=branch["hopf_index"]).fold
            V = float(ours[0]) if ours else np.nan
            answers += [(V, fold["speed"]) for fold in branch["folds"]]
    name = f"harmonics={HARMONICS}: worst of {len(answers)} folds, speed [km/h]"
    return worst(Row(name, 3.6 * V, 3.6 * theirs, 1e-5) for V, theirs in answers)
