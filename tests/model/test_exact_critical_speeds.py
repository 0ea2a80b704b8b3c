"""The exact nonlinear critical speed: stacks, single systems and whole branches agree."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, TABLE_1, bogie, critical_speeds, limit_cycles, wheelset
from tests.model.subjects import (
    KMH,
    VEHICLES,
    both_vehicles,
    members,
    near_reconstructed,
    reference_cases,
    stack_near_reconstructed,
    system_of,
)


@pytest.mark.parametrize(("vehicle", "kmh"), [(wheelset, 143.73), (bogie, 138.87)])
def test_the_reconstruction_hunts_from_here(vehicle, kmh):
    assert KMH * critical_speeds(vehicle(RECONSTRUCTED)).nonlinear == pytest.approx(kmh, abs=5e-3)


@reference_cases(having="fold")
def test_the_slowest_cycle_is_that_of_the_reference(case):
    speeds = critical_speeds(system_of(case))
    assert speeds.nonlinear == pytest.approx(case["fold"]["speed"], rel=1e-6)
    assert speeds.amplitude == pytest.approx(case["fold"]["amplitude"], rel=3e-4)
    assert speeds.message == ""


def test_exact_is_the_default():
    system = bogie(RECONSTRUCTED)
    assert critical_speeds(system) == critical_speeds(system, method="harmonic_balance")
    assert critical_speeds(system) != critical_speeds(system, method="averaging")


@both_vehicles
def test_a_hardening_damper_leaves_only_the_linear_speed(vehicle):
    speeds = critical_speeds(vehicle(RECONSTRUCTED.replace(C2=5.14e5)))
    assert speeds.nonlinear == speeds.linear
    assert speeds.criticality == "supercritical"
    assert speeds.amplitude == 0


@both_vehicles
def test_the_numbers_of_table_1_do_not_hunt(vehicle):
    speeds = critical_speeds(vehicle(TABLE_1))
    assert np.isnan(speeds.linear)
    assert np.isnan(speeds.nonlinear)
    assert speeds.message == "no Hopf point in range"


@both_vehicles
def test_a_stack_is_answered_as_its_members_are(vehicle):
    p = stack_near_reconstructed(1.3, 60, seed=3)
    stack = critical_speeds(vehicle(p))
    alone = [critical_speeds(vehicle(q)) for q in members(p)]
    np.testing.assert_allclose(stack.nonlinear, [one.nonlinear for one in alone], rtol=1e-9)
    np.testing.assert_allclose(stack.amplitude, [one.amplitude for one in alone], rtol=1e-6)
    assert stack.message.tolist() == [one.message for one in alone]


@both_vehicles
def test_the_slowest_cycle_is_the_fold_of_the_branch(vehicle):
    p = stack_near_reconstructed(1.3, 60, seed=4)
    system = vehicle(p)
    speeds, fold = critical_speeds(system), limit_cycles(system).fold
    both = np.isfinite(fold[0]) & np.isfinite(speeds.nonlinear)
    assert both.mean() > 0.5
    np.testing.assert_allclose(fold[0][both], speeds.nonlinear[both], rtol=2e-5)
    without = np.isnan(fold[0]) & np.isfinite(speeds.nonlinear)
    np.testing.assert_array_equal(speeds.nonlinear[without], speeds.linear[without])


@both_vehicles
def test_answers_have_the_shape_of_the_parameters(vehicle):
    speeds = critical_speeds(
        vehicle(RECONSTRUCTED.replace(Ky=[[8e4], [1e5]], m_w=[1e3, 1.3e3, 2e3]))
    )
    assert speeds.nonlinear.shape == speeds.amplitude.shape == speeds.message.shape == (2, 3)
    assert (np.diff(speeds.nonlinear, axis=0) > 0).all()
    assert (np.diff(speeds.nonlinear, axis=1) < 0).all()


def by_turns(seed, place):
    """Return a vehicle drawn within a factor of 2 of the reconstruction."""
    return members(stack_near_reconstructed(2, 150, seed))[place]


def test_a_fold_below_the_clearance_counts_though_a_grazing_one_follows():
    """Speed falls, rises and falls again before the flange is touched."""
    system = bogie(by_turns(5, 43))
    speeds, branch = critical_speeds(system), limit_cycles(system)
    assert speeds.amplitude < 0.6 * system.clearance
    assert speeds.nonlinear == pytest.approx(branch.speed.min(), rel=1e-5)


def test_a_fold_is_not_stepped_over_when_another_follows_soon():
    """Speed rises between 1.009 and 1.015 delta only, and falls before and after."""
    system = bogie(by_turns(5, 104))
    speeds = critical_speeds(system)
    assert speeds.message == ""
    assert speeds.amplitude == pytest.approx(1.0093 * system.clearance, rel=5e-4)


@settings(max_examples=60)
@given(p=near_reconstructed(2), vehicle=st.sampled_from(list(VEHICLES.values())))
def test_random_systems_get_a_sound_answer(p, vehicle):
    speeds = critical_speeds(vehicle(p))
    assert np.isnan(speeds.nonlinear) == (speeds.message != "")
    assert not speeds.nonlinear > speeds.linear
    assert not speeds.amplitude > 1.2 * p.delta
