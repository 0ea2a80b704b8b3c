"""The exact branch with its multipliers, beside AUTO-07p's continuation of it in the same run.

Both on one thread, both warm: AUTO's equations are compiled with -O3 and an analytic Jacobian, its
executable is run directly, and the Hopf point it starts from is there already. It goes from there
to 1.155 delta with NTST 40 and NCOL 4; ours goes a little further, to the second fold.
"""

from __future__ import annotations

import time
from functools import partial

import numpy as np
import pytest

from hunting import RECONSTRUCTED, bogie, limit_cycles
from verification.auto_07p import BOGIE, PERIOD, SPEED, Auto, missing

ROUNDS = 9
END = 1.155  # peak displacement over the clearance
AUTO_SETTINGS = {  # tolerances and DSMAX 0.1 are AUTO's defaults
    "NTST": 40,
    "DSMIN": 1e-7,
    "EPSL": 1e-7,
    "EPSU": 1e-7,
    "EPSS": 1e-5,
    "ITMX": 9,
    "ITNW": 5,
    "IID": 0,
}
# With y in m AUTO does not get past the corner of the branch at the clearance, so it is in mm for
# both. The second leaves V out of the arclength: fewer steps, but only this branch is parametrised
# by amplitude alone.
WEIGHTS = {
    "V weighs as much as y in mm": {PERIOD: 0.0},
    "V weighs nothing": {SPEED: 0.0, PERIOD: 0.0},
}


@pytest.fixture(scope="module")
def continuations(tmp_path_factory):
    """AUTO's continuation of the branch, ready to run, with each set of weights."""
    if reason := missing():
        pytest.skip(reason)
    auto = Auto(tmp_path_factory.mktemp("auto"))
    (start,) = auto.centred(RECONSTRUCTED, BOGIE, (30.0, 60.0)).of_kind("HB")
    end = END * RECONSTRUCTED.delta
    return {
        name: partial(auto.branch, BOGIE, start, [], end, **AUTO_SETTINGS, THL=weights)
        for name, weights in WEIGHTS.items()
    }


def test_the_exact_branch_costs_an_eighth_of_a_continuation(continuations, benchmark, report):
    system = bogie(RECONSTRUCTED)
    branch = benchmark(limit_cycles, system)
    assert len(branch.amplitude) > 60
    assert branch.multipliers is not None
    assert branch.amplitude.max() > END * RECONSTRUCTED.delta
    ours, theirs = [], {name: [] for name in continuations}
    for _ in range(ROUNDS):
        for _ in range(5):  # another program has just had the caches
            began = time.perf_counter()
            limit_cycles(system)
            ours.append(time.perf_counter() - began)
        for name, continuation in continuations.items():
            theirs[name].append(continuation())
    mine = np.median(ours)
    shares = []
    for name, runs in theirs.items():
        assert runs[0].points[-1].amplitude == pytest.approx(END * RECONSTRUCTED.delta, rel=1e-3)
        auto = np.median([run.seconds for run in runs])
        shares.append(mine / auto)
        report(
            f"exact branch of the bogie, {len(branch.amplitude)} points with multipliers: "
            f"{1e3 * mine:.1f} ms; AUTO-07p, {name}, {runs[0].steps} points: {1e3 * auto:.0f} ms; "
            f"ratio {mine / auto:.3f} = 1/{auto / mine:.1f}"
        )
    assert shares[0] <= 1 / 8
