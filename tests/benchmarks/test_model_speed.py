"""How fast the model answers, beside eigenvalues on a grid of speeds in the same run."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import hunting
from hunting import RECONSTRUCTED, averaged_branch, bogie, hopf_points

SYSTEM = bogie(RECONSTRUCTED)
MATRICES = SYSTEM.with_axes().matrix(np.linspace(1.0, 400.0, 1000))
AMPLITUDES = np.linspace(0.0, 1.2 * RECONSTRUCTED.delta, 400)


def yardstick():
    """Eigenvalues at 1000 speeds: what a grid costs."""
    return np.linalg.eigvals(MATRICES)


def seconds(function, rounds):
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return times


def ratio_to_yardstick(function):
    """Median time over that of the yardstick; the two take turns, so both meet the same noise."""
    mine, grid = [], []
    for _ in range(25):
        mine += seconds(function, 4)
        grid += seconds(yardstick, 1)
    return np.median(mine) / np.median(grid)


@pytest.mark.benchmark(group="model")
def test_yardstick_eigenvalues_of_a_bogie_at_1000_speeds(benchmark):
    assert benchmark(yardstick).shape == (1000, 6)


@pytest.mark.benchmark(group="model")
def test_all_hopf_points_cost_an_eighth_of_a_grid(benchmark, report):
    assert len(benchmark(hopf_points, SYSTEM).speed) == 1
    ratio = ratio_to_yardstick(lambda: hopf_points(SYSTEM))
    report(f"all Hopf points of a bogie: {ratio:.3f} of eigvals at 1000 speeds (at most 0.125)")
    assert ratio <= 1 / 8


@pytest.mark.benchmark(group="model")
def test_an_averaged_branch_costs_half_of_a_grid(benchmark, report):
    branch = benchmark(averaged_branch, SYSTEM, AMPLITUDES)
    assert branch.speed.shape == (400,)
    ratio = ratio_to_yardstick(lambda: averaged_branch(SYSTEM, AMPLITUDES))
    report(f"averaged branch, 400 amplitudes: {ratio:.3f} of eigvals at 1000 speeds (at most 0.5)")
    assert ratio <= 1 / 2


ALL_AT_ONCE = """
import json, os, resource, time
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
import numpy as np
from hunting import RECONSTRUCTED, Parameters, bogie, critical_speeds

rng = np.random.default_rng(1)
p = RECONSTRUCTED.replace(**{
    f.name: getattr(RECONSTRUCTED, f.name) * 2 ** rng.uniform(-1, 1, 10_000)
    for f in Parameters.fields()
})
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
times = []
for _ in range(3):
    start = time.perf_counter()
    speeds = critical_speeds(bogie(p), method="averaging")
    times.append(time.perf_counter() - start)
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({
    "seconds": sorted(times)[1], "answers": int(np.isfinite(speeds.linear).sum()),
    "before": before * 1024, "peak": peak * 1024,
}))
"""


def test_ten_thousand_bogies_on_one_core_fit_in_a_gigabyte(report):
    """Every one of the 22 parameters is an array of 10,000 random values."""
    source = str(Path(hunting.__file__).parent.parent)
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", ALL_AT_ONCE],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": source, "OMP_NUM_THREADS": "1"},
    )
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout)
    grid = np.median(seconds(yardstick, 15))
    report(
        f"averaged critical speeds of 10,000 bogies: {found['seconds']:.2f} s "
        f"(3 s is asked for), {found['seconds'] / grid:.0f} times eigvals at 1000 speeds; "
        f"memory {found['peak'] / 1e6:.0f} MB (at most 1000), of it {found['before'] / 1e6:.0f} "
        "before"
    )
    assert found["answers"] > 9000
    assert found["peak"] <= 1e9
