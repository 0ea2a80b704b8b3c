"""How fast parameters are studied, beside a loop that asks for one critical speed at a time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

from hunting import RECONSTRUCTED, Parameters, bogie, critical_speeds, sensitivity, sweep

ONE_BY_ONE = 300  # points of the loop, from which its time for all is reckoned; some are hard

MEASURED = """
import json, os, resource, time
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
import numpy as np
from hunting import RECONSTRUCTED, Parameters, bogie, critical_speeds, figure, sweep, uncertainty
from hunting import study
from hunting.study import NUMBERS

FIELDS = Parameters.fields()

def figures():
    shown = [f.sweep for f in study.figures(NUMBERS[1:]).values()]
    return [p for s in shown for p in points(s.axes)], 0

def map_of(method):
    axes = {{"Ky": np.geomspace(4e4, 4e5, 200), "lam": np.linspace(0.03, 0.2, 200)}}
    sweep(bogie, RECONSTRUCTED, axes, method)
    return points(axes), 0

def samples():
    spreads = {{f.name: 0.1 for f in FIELDS}}
    found = uncertainty(bogie, RECONSTRUCTED, spreads, samples=100_000)
    values = zip(*(v.tolist() for v in found.columns.values()))
    drawn = [dict(zip(found.columns, v)) for v in values]
    return drawn, len(spreads) * found.indices["nonlinear"].base

def points(axes):
    grid = np.meshgrid(*axes.values(), indexing="ij")
    return [dict(zip(axes, values)) for values in zip(*(g.ravel().tolist() for g in grid))]

def timed(work):
    start, cpu = time.perf_counter(), time.process_time()
    answer = work()
    return answer, time.perf_counter() - start, time.process_time() - cpu

figure_4 = figure(4, points=3)  # imports and caches
(asked, further), seconds, cpu = timed(lambda: {work})
rng = np.random.default_rng(1)
some = [asked[i] for i in rng.permutation(len(asked))[:{loop}]]
_, _, loop = timed(lambda: [
    critical_speeds(bogie(RECONSTRUCTED.replace(**p)), "{method}") for p in some
])
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(json.dumps({{
    "seconds": seconds, "cpu": cpu, "peak": peak,
    "loop": loop / len(some) * (len(asked) + further),
}}))
"""


def measured(work, method):
    """Seconds, memory and the loop's seconds of a piece of work, in a process on one core."""
    script = MEASURED.format(work=work, method=method, loop=ONE_BY_ONE)
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


@pytest.mark.parametrize(
    ("what", "work", "method", "stated"),
    [
        ("11 figures of 5 x 41 points, exact", "figures()", "harmonic_balance", 6),
        ("map of 200 x 200, averaging", 'map_of("averaging")', "averaging", 12),
        ("map of 200 x 200, exact", 'map_of("harmonic_balance")', "harmonic_balance", 60),
        ("100000 uncertain designs with indices, averaging", "samples()", "averaging", 30),
    ],
    ids=["figures", "averaged-map", "exact-map", "uncertainty"],
)
def test_arrays_beat_a_loop_fifteen_times(what, work, method, stated, report):
    found = measured(work, method)
    ratio = found["loop"] / found["cpu"]
    report(
        f"{what}: {found['cpu']:.1f} s of one core (at most {stated}), "
        f"{found['seconds']:.1f} s by the clock, {found['peak'] / 2**20:.0f} MB; "
        f"one at a time {found['loop']:.0f} s, {ratio:.0f} times (at least 15)"
    )
    assert ratio >= 15
    assert found["peak"] <= 2**30


def spun(_):
    """Work that needs no memory, to see what two processes can bring on this machine now."""
    total = 0
    for k in range(6_000_000):
        total += k & 3
    return total


def test_two_processes_halve_the_time(report):
    """Beside the same for plain arithmetic: other work on the machine slows both down alike."""
    if (os.cpu_count() or 1) < 2:
        pytest.skip("one core")
    axes = {"Ky": np.geomspace(4e4, 4e5, 120), "lam": np.linspace(0.03, 0.2, 100)}
    gains, possible = [], []
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        list(pool.map(spun, range(2)))
        sweep(bogie, RECONSTRUCTED, {"Ky": np.linspace(8e4, 9e4, 1500)}, "averaging", pool)
        for _ in range(3):
            start = time.perf_counter()
            sweep(bogie, RECONSTRUCTED, axes)
            alone = time.perf_counter()
            sweep(bogie, RECONSTRUCTED, axes, executor=pool)
            gains.append((alone - start) / (time.perf_counter() - alone))
            start = time.perf_counter()
            [spun(k) for k in range(4)]
            alone = time.perf_counter()
            list(pool.map(spun, range(4)))
            possible.append((alone - start) / (time.perf_counter() - alone))
    gain, best = np.median(gains), np.median(possible)
    report(
        f"two processes: {gain:.2f} times as fast (at least 1.7); "
        f"plain arithmetic in the same run {best:.2f}"
    )
    assert gain >= 1.7 / 2 * min(best, 2)


@pytest.mark.benchmark(group="study")
def test_sensitivities_cost_less_than_their_differences(benchmark, report):
    def differences():
        changes = 1 + 1e-3 * np.eye(22)[:, :, None] * np.array([-1, 1])
        fields = Parameters.fields()
        changed = {
            f.name: getattr(RECONSTRUCTED, f.name) * c for f, c in zip(fields, changes, strict=True)
        }
        return critical_speeds(bogie(Parameters(**changed)))

    benchmark(sensitivity, bogie, RECONSTRUCTED)
    mine, theirs = [], []
    for _ in range(9):
        start = time.perf_counter()
        sensitivity(bogie, RECONSTRUCTED)
        middle = time.perf_counter()
        differences()
        mine.append(middle - start)
        theirs.append(time.perf_counter() - middle)
    ratio = np.median(mine) / np.median(theirs)
    report(f"sensitivities to 22 parameters: {ratio:.2f} of central differences in one stack")
    assert ratio < 2
