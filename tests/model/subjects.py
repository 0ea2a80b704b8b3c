"""What the model's tests are about: two vehicles, random parameters, reference solutions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, Parameters, bogie, wheelset

KMH = 3.6  # km/h in a m/s
FIELDS = Parameters.fields()
VEHICLES = {"wheelset": wheelset, "bogie": bogie}
REFERENCE = json.loads((Path(__file__).parent / "reference.json").read_text(encoding="utf-8"))

both_vehicles = pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES)


def reference_cases(having=None):
    """Parametrise a test by the reference cases, or those that have something of that name."""
    cases = [case for case in REFERENCE if having is None or case[having]]
    names = [f"{case['name']}-{case['vehicle']}" for case in cases]
    return pytest.mark.parametrize("case", cases, ids=names)


def system_of(case):
    return VEHICLES[case["vehicle"]](Parameters.from_dict(case["parameters"]))


def near_reconstructed(factor):
    """Parameter sets with each of the 22 values within a factor of the reconstruction's."""

    def scaled(powers):
        return RECONSTRUCTED.replace(
            **{
                f.name: getattr(RECONSTRUCTED, f.name) * factor**power
                for f, power in zip(FIELDS, powers, strict=True)
            }
        )

    return st.tuples(*[st.floats(-1, 1)] * len(FIELDS)).map(scaled)


def stack_near_reconstructed(factor, count, seed):
    """As `near_reconstructed`, but a stack of independent sets, evenly spread."""
    rng = np.random.default_rng(seed)
    return RECONSTRUCTED.replace(
        **{
            f.name: getattr(RECONSTRUCTED, f.name) * factor ** rng.uniform(-1, 1, count)
            for f in FIELDS
        }
    )


def stack_within_spans(count, seed):
    """A stack of independent sets, each value somewhere on its slider."""
    rng = np.random.default_rng(seed)

    def drawn(f):
        low, high = f.span
        if f.log:
            return low * (high / low) ** rng.uniform(0, 1, count)
        return rng.uniform(low, high, count)

    return Parameters(**{f.name: drawn(f) for f in FIELDS})


def members(p):
    """Return the parameter sets of a one-dimensional stack one by one."""
    (count,) = p.shape
    columns = {f.name: np.broadcast_to(getattr(p, f.name), count) for f in FIELDS}
    return [
        Parameters(**{name: column[k] for name, column in columns.items()}) for k in range(count)
    ]
