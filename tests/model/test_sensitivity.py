"""What each parameter does to the critical speeds, beside central differences."""

from __future__ import annotations

import numpy as np
import pytest

from hunting import (
    RECONSTRUCTED,
    TABLE_1,
    Parameters,
    averaging,
    bogie,
    critical_speeds,
    sensitivity,
    wheelset,
)
from tests.model.subjects import FIELDS, REFERENCE, both_vehicles, reference_cases, system_of

NAMES = [f.name for f in FIELDS]
VEHICLES = {"wheelset": wheelset, "bogie": bogie}


def central_differences(vehicle, parameters, speed, method, step):
    """d ln V/d ln p of all parameters to fourth order in the step, from critical speeds alone."""
    nodes = 1 + step * np.array([-2, -1, 1, 2])
    changed = {
        name: getattr(parameters, name) * (1 + np.eye(len(NAMES))[k][:, None] * (nodes - 1))
        for k, name in enumerate(NAMES)
    }
    V = getattr(critical_speeds(vehicle(Parameters(**changed)), method), speed)
    here = getattr(critical_speeds(vehicle(parameters), method), speed)
    return V @ np.array([1, -8, 8, -1]) / (12 * step) / here


@reference_cases(having="hopf")
def test_the_linear_speeds_agree_with_central_differences(case):
    vehicle, p = VEHICLES[case["vehicle"]], Parameters.from_dict(case["parameters"])
    found = sensitivity(vehicle, p)
    expected = central_differences(vehicle, p, "linear", "averaging", 1e-3)
    np.testing.assert_allclose(found.linear, expected, rtol=1e-5, atol=1e-11)


@reference_cases(having="fold")
def test_the_nonlinear_speeds_agree_with_central_differences(case):
    """K_r moves a grazing fold by a millionth, of which the harmonics left out make a hundredth."""
    vehicle, p = VEHICLES[case["vehicle"]], Parameters.from_dict(case["parameters"])
    found = sensitivity(vehicle, p)
    expected = central_differences(vehicle, p, "nonlinear", "harmonic_balance", 1e-3)
    rail = np.array([name == "Kr" for name in NAMES])
    np.testing.assert_allclose(found.nonlinear[~rail], expected[~rail], rtol=1e-3, atol=3e-8)
    np.testing.assert_allclose(found.nonlinear[rail], expected[rail], rtol=1e-2, atol=1e-12)
    assert np.abs(expected[rail]) < 1e-5


def test_a_supercritical_hopf_point_has_one_sensitivity():
    found = sensitivity(bogie, RECONSTRUCTED.replace(C2=5.14e5))
    np.testing.assert_array_equal(found.linear, found.nonlinear)
    assert np.isfinite(found.linear).all()


@both_vehicles
def test_the_linear_speed_does_not_know_the_nonlinear_elements(vehicle):
    found = sensitivity(vehicle, RECONSTRUCTED)
    for name in ("Kr", "delta", "C2", "C3", "C4"):
        assert found.of(name)[0] == 0


def test_the_wheelset_does_not_know_the_frame():
    assert sensitivity(wheelset, RECONSTRUCTED).of("m_B") == (0, 0)


def test_a_smooth_fold_does_not_know_the_flange():
    """A damper that hardens early: the fold is below the clearance."""
    (hardening, *_) = [case for case in REFERENCE if case["name"] == "set02_smooth_fold"]
    p = Parameters.from_dict(hardening["parameters"])
    assert critical_speeds(bogie(p)).amplitude < 0.9 * p.delta
    found = sensitivity(bogie, p)
    assert found.of("delta")[1] == found.of("Kr")[1] == 0


def test_speeds_in_other_units_are_the_same_speeds():
    """d ln V of lengths, masses and times that are all measured in other units must cancel.

    V is a length over a time: scaling every parameter by its unit's power of a length scales V
    by that length.
    """
    metres = {
        "m": 1, "m²": 2, "N": 1, "N/m": 0, "N m": 2, "N m²": 3, "N s/m": 0, "N s²/m²": -1,
        "N s³/m³": -2, "N s⁴/m⁴": -3, "kg": 0, "kg m²": 2, "rad": 0,
    }  # fmt: skip
    powers = np.array([metres[f.unit] for f in FIELDS])
    found = sensitivity(bogie, RECONSTRUCTED)
    assert powers @ found.linear == pytest.approx(1, rel=1e-8)
    assert powers @ found.nonlinear == pytest.approx(1, rel=1e-5)


def test_forces_in_other_units_change_no_speed():
    """Scaling all masses and forces alike."""
    kilograms = np.array([f.unit.startswith(("N", "kg")) for f in FIELDS])
    found = sensitivity(bogie, RECONSTRUCTED)
    assert kilograms @ found.linear == pytest.approx(0, abs=1e-8)
    assert kilograms @ found.nonlinear == pytest.approx(0, abs=1e-5)


def test_what_is_zero_has_no_relative_change():
    assert sensitivity(bogie, RECONSTRUCTED.replace(f22=0.0, C3=0.0)).of("f22") == (0, 0)


def test_without_a_critical_speed_there_is_none_and_a_reason():
    found = sensitivity(bogie, TABLE_1)
    assert np.isnan([*found.linear, *found.nonlinear, found.V_linear, found.V_nonlinear]).all()
    assert found.message == "no Hopf point in range"


def test_a_stack_is_refused():
    with pytest.raises(ValueError, match=r"parameters must be numbers, got .* \(2,\)"):
        sensitivity(bogie, RECONSTRUCTED.replace(Ky=[1e4, 2e4]))


@reference_cases(having="hopf")
def test_the_speeds_come_with_them(case):
    found = sensitivity(VEHICLES[case["vehicle"]], Parameters.from_dict(case["parameters"]))
    assert found.V_linear == averaging(system_of(case)).speed[0]
    assert 0 < found.V_nonlinear <= found.V_linear
