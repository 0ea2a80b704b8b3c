"""How fast exact critical speeds of many bogies come, beside one call for each of them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import hunting

SETTING = """
import json, os, resource, sys, time
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
import numpy as np
from hunting import RECONSTRUCTED, Parameters, bogie, critical_speeds

FIELDS = [f.name for f in Parameters.fields()]
"""
RANDOM = """
rng = np.random.default_rng(1)
p = RECONSTRUCTED.replace(
    **{f: getattr(RECONSTRUCTED, f) * rng.uniform(0.8, 1.2, 10_000) for f in FIELDS}
)
"""
GRID = """
Ky, m_w = np.meshgrid(np.linspace(5e4, 2e5, 100), np.linspace(1000, 2000, 100))
p = RECONSTRUCTED.replace(Ky=Ky.ravel(), m_w=m_w.ravel())
"""
MEASURED = """
columns = {f: np.broadcast_to(getattr(p, f), p.shape) for f in FIELDS}
some = [Parameters(**{f: columns[f][k] for f in FIELDS}) for k in range(0, 10_000, 100)]
critical_speeds(bogie(some[0]))
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
start = time.perf_counter()
speeds = critical_speeds(bogie(p))
seconds = time.perf_counter() - start
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
start = time.perf_counter()
alone = [critical_speeds(bogie(q)).nonlinear for q in some]
one = (time.perf_counter() - start) / len(some)
unit = 1 if sys.platform == "darwin" else 1024
print(json.dumps({
    "seconds": seconds, "one": one, "before": before * unit, "peak": peak * unit,
    "linear": int(np.isfinite(speeds.linear).sum()),
    "missing": int((speeds.message == "the slowest limit cycle was not found").sum()),
    "difference": float(np.nanmax(np.abs(np.array(alone) / speeds.nonlinear[::100] - 1))),
}))
"""


@pytest.mark.parametrize(
    "draw",
    [
        pytest.param(RANDOM, id="22 parameters within 20 %"),
        pytest.param(GRID, id="a map over K_y and m_w"),
    ],
)
def test_ten_thousand_bogies_are_answered_together(draw, report, request):
    """On one core, 10 s and 2 GB are asked for; the yardstick is a call for each bogie."""
    source = str(Path(hunting.__file__).parent.parent)
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", SETTING + draw + MEASURED],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": source, "OMP_NUM_THREADS": "1"},
    )
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout)
    together = found["seconds"] / 10_000
    report(
        f"exact critical speeds of 10,000 bogies, {request.node.callspec.id}: "
        f"{found['seconds']:.1f} s (10 s is asked for), {found['one'] / together:.0f} times as "
        f"fast as one call each; memory {found['peak'] / 1e6:.0f} MB (at most 2000), of it "
        f"{found['before'] / 1e6:.0f} before; {found['missing']} not found"
    )
    assert found["linear"] == 10_000
    assert found["missing"] <= 10
    assert found["difference"] < 1e-6
    assert together <= found["one"] / 5
    assert found["peak"] <= 2e9
