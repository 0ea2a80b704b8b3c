"""The smallest change that brings the nonlinear critical speed to a target."""

from __future__ import annotations

import numpy as np
import pytest

from hunting import RECONSTRUCTED, TABLE_1, bogie, critical_speeds, design, wheelset

KMH = 3.6


def V_nl(p, vehicle=bogie):
    return KMH * critical_speeds(vehicle(p)).nonlinear


@pytest.mark.parametrize("target", [120, 137, 150])
@pytest.mark.parametrize("vehicle", [wheelset, bogie], ids=["wheelset", "bogie"])
def test_the_changed_design_has_the_target_speed(vehicle, target):
    found = design(vehicle, RECONSTRUCTED, ["Ky", "Kpsi", "lam"], target / KMH)
    assert found.reached
    assert found.smallest
    assert V_nl(found.parameters, vehicle) == pytest.approx(target, rel=2e-4)
    assert KMH * found.V_nonlinear == pytest.approx(target, rel=1e-4)


def test_only_free_parameters_change_and_by_what_is_said():
    found = design(bogie, RECONSTRUCTED, ["Ky", "Kpsi"], 145 / KMH)
    changed = {name: getattr(RECONSTRUCTED, name) * (1 + x) for name, x in found.changes.items()}
    assert found.parameters == RECONSTRUCTED.replace(**changed)
    assert list(changed) == ["Ky", "Kpsi"]


def test_no_neighbour_with_the_target_speed_is_a_smaller_change():
    """Every K_y needs its own K_psi; the pair found has the least sum of squares."""
    target = 145
    found = design(bogie, RECONSTRUCTED, ["Ky", "Kpsi"], target / KMH)
    size = sum(x**2 for x in found.changes.values())
    for Ky in np.linspace(-0.08, 0.08, 9):
        fixed = RECONSTRUCTED.replace(Ky=RECONSTRUCTED.Ky * (1 + found.changes["Ky"] + Ky))
        other = design(bogie, fixed, ["Kpsi"], target / KMH)
        Kpsi = other.parameters.Kpsi / RECONSTRUCTED.Kpsi - 1
        assert (found.changes["Ky"] + Ky) ** 2 + Kpsi**2 >= size * (1 - 1e-3)


def test_the_target_at_hand_needs_no_change():
    here = critical_speeds(bogie(RECONSTRUCTED)).nonlinear
    found = design(bogie, RECONSTRUCTED, ["Ky", "b"], here)
    assert max(map(abs, found.changes.values())) < 1e-3


def test_bounds_are_kept():
    found = design(bogie, RECONSTRUCTED, {"Ky": (8e4, 9e4), "Kpsi": None}, 150 / KMH)
    assert found.reached
    assert 8e4 <= found.parameters.Ky <= 9e4
    free = design(bogie, RECONSTRUCTED, ["Ky", "Kpsi"], 150 / KMH)
    assert free.parameters.Ky > 9e4


def test_out_of_reach_says_so_and_what_is_best():
    found = design(bogie, RECONSTRUCTED, {"Ky": (8e4, 1e5), "Cy": (2e4, 3e4)}, 170 / KMH)
    assert not found.reached
    assert found.message.startswith("170.0 km/h is out of reach within the bounds; the nearest is")
    corners = [V_nl(RECONSTRUCTED.replace(Ky=Ky, Cy=Cy)) for Ky in (8e4, 1e5) for Cy in (2e4, 3e4)]
    assert KMH * found.V_nonlinear == pytest.approx(max(corners), rel=1e-3)


def test_a_speed_beyond_the_peak_over_the_spring_base_is_out_of_reach():
    """V_nl over b has a peak (Fig. 11): following its slope from b = 1 m finds it."""
    found = design(bogie, RECONSTRUCTED, ["b"], 160 / KMH)
    b = np.linspace(1.0, 1.3, 121)
    peak = np.nanmax(V_nl(RECONSTRUCTED.replace(b=b)))
    assert not found.reached
    assert KMH * found.V_nonlinear == pytest.approx(peak, rel=1e-3)


@pytest.mark.parametrize(
    ("free", "target", "error", "words"),
    [
        ([], 40, TypeError, "free must be one or more of m_w"),
        (["mass"], 40, TypeError, r"got \['mass'\]"),
        (["Ky"], -1, ValueError, "target must be > 0 m/s, got -1"),
        (["Ky"], np.nan, ValueError, "target must be > 0 m/s, got nan"),
        ({"Ky": (1e5, 2e5)}, 40, ValueError, "Ky must be between its bounds 100000 and 200000 N/m"),
        ({"Kr": (-1, 1e9)}, 40, ValueError, "Kr must be > 0 N/m, got -1.0"),
    ],
)
def test_a_wrong_wish_is_refused_by_its_name(free, target, error, words):
    with pytest.raises(error, match=words):
        design(bogie, RECONSTRUCTED, free, target)


def test_zero_cannot_change_relatively():
    with pytest.raises(ValueError, match="f22 is 0 N m², it has no relative change"):
        design(bogie, RECONSTRUCTED.replace(f22=0.0), ["f22"], 40.0)


def test_a_design_that_does_not_hunt_is_refused_with_the_reason():
    with pytest.raises(ValueError, match=r"no nonlinear critical speed: no Hopf point in range"):
        design(bogie, TABLE_1, ["Ky"], 40.0)
