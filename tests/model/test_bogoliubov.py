"""Averaging: Eqs. 9 to 13, the branch they give, its stability and its fold."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hunting import (
    RECONSTRUCTED,
    TABLE_1,
    averaged_branch,
    averaging,
    bogie,
    hopf_points,
    wheelset,
)
from tests.model.subjects import (
    FIELDS,
    both_vehicles,
    members,
    near_reconstructed,
    reference_cases,
    stack_near_reconstructed,
    system_of,
)

HARDENING = RECONSTRUCTED.replace(C2=5.14e5)  # as Table 1 prints it: supercritical
HARDENING_LATE = RECONSTRUCTED.replace(C4=5e8)  # smooth fold below the clearance
WITH_WINDOW = RECONSTRUCTED.replace(Ky=2e5)  # the bogie is also unstable in a low-speed window


# ---------------------------------------------------------------- the integrals of Eq. 13


def slow_rates_by_quadrature(system, averaged, a, V):
    """Return A1 and B1 of Eq. 13 by quadrature.

    With x = Re(c r), l r = 1 and l conj(r) = 0 the amplitude is c = a exp(i phi) = 2 l x, so that
    a' + i a (phi' - omega) is the mean over phi of 2 exp(-i phi) l (x' - A(V_c) x).
    """
    r, l = averaged.right[0], averaged.left[0]
    V_c = averaged.speed[0]
    corners = {0.5 * np.pi, 1.5 * np.pi}
    for link in system.elements:
        seen = (link.C @ r).item()
        sizes = {0.0}
        if link.element.kink is not None and link.element.kink < a * abs(seen):
            sizes = {link.element.kink, -link.element.kink}
        for size in sizes:
            angle = np.arccos(size / (a * abs(seen)))
            corners |= {(s * angle - np.angle(seen)) % (2 * np.pi) for s in (1, -1)}

    def projected(phi):
        x = (a * r * np.exp(1j * phi)).real
        extra = (V - V_c) * (system.matrix_slope(V_c) @ x)
        for link in system.elements:
            extra = extra + link.B @ link.element.nonlinear(link.C @ x)
        return 2 * np.exp(-1j * phi) * (l @ extra)

    # Between the corners the forces are polynomials in sines and cosines.
    nodes, weights = np.polynomial.legendre.leggauss(40)
    edges = [0.0, *sorted(corners), 2 * np.pi]
    mean = sum(
        0.5 * (high - low) * weight * projected(0.5 * (low + high) + 0.5 * (high - low) * node)
        for low, high in itertools.pairwise(edges)
        for node, weight in zip(nodes, weights, strict=True)
    ) / (2 * np.pi)
    return mean.real, mean.imag / a


@both_vehicles
@settings(max_examples=25)
@given(
    p=near_reconstructed(1.5),
    share=st.floats(0.05, 1.5),
    faster=st.floats(-0.3, 0.3),
)
def test_closed_forms_are_the_integrals_of_eq_13(vehicle, p, share, faster):
    system = vehicle(p)
    averaged = averaging(system)
    if np.isnan(averaged.speed[0]):
        return
    a, V = share * p.delta, averaged.speed[0] * (1 + faster)
    A1, B1 = slow_rates_by_quadrature(system, averaged, a, V)
    scale = abs(averaged.gain(a)[0]) + abs(averaged.growth[0] * (V - averaged.speed[0]))
    assert averaged.A1(a, V)[0] == pytest.approx(A1, rel=1e-9, abs=1e-10 * a * scale)
    assert averaged.B1(a, V)[0] == pytest.approx(B1, rel=1e-9, abs=1e-10 * scale)


@both_vehicles
def test_a_small_motion_grows_as_its_eigenvalue_says(vehicle):
    averaged = averaging(vehicle(RECONSTRUCTED))
    a, V = 1e-9, averaged.speed + 1.0
    assert averaged.A1(a, V) / a == pytest.approx(averaged.growth.real, rel=1e-6)
    assert averaged.B1(a, V) == pytest.approx(averaged.growth.imag, rel=1e-6)


@both_vehicles
@given(share=st.floats(0.01, 1.19))
def test_slopes_along_the_branch_are_derivatives(vehicle, share):
    averaged = averaging(vehicle(RECONSTRUCTED))
    a = share * RECONSTRUCTED.delta
    h = 1e-6 * a
    if abs(share - 1) < 1e-3:
        return  # the curvature is unbounded at contact
    for function, slope in (
        (averaged.gain, averaged.gain_slope),
        (averaged.branch_speed, averaged.branch_slope),
    ):
        difference = (function(a + h) - function(a - h)) / (2 * h)
        assert slope(a) == pytest.approx(difference, rel=1e-4)


# ---------------------------------------------------------------- against the reference solutions


@reference_cases(having="averaging")
def test_the_branch_is_that_of_the_reference(case):
    values = case["averaging"]["values"]
    amplitudes = sorted(v["first_harmonic"] for v in values)
    branch = averaged_branch(system_of(case), amplitudes)
    expected = [v["speed"] for v in sorted(values, key=lambda v: v["first_harmonic"])]
    assert branch.amplitude.tolist() == amplitudes
    assert branch.speed == pytest.approx(expected, rel=1e-11)


@reference_cases(having="averaging")
def test_the_fold_is_that_of_the_reference(case):
    fold = averaged_branch(system_of(case)).fold
    expected = case["averaging"]["fold"]
    if expected is None:
        assert fold is None
    else:
        speed, amplitude = fold
        assert speed == pytest.approx(expected["speed"], rel=1e-11)
        assert amplitude == pytest.approx(expected["amplitude"], rel=1e-7)  # a flat minimum


@reference_cases(having="branch")
def test_averaging_is_near_the_exact_branch_while_the_motion_is_small(case):
    exact = case["branch"][0]
    branch = averaged_branch(system_of(case), [exact["amplitude"]])
    assert branch.speed[0] == pytest.approx(exact["speed"], rel=2e-3)


# ---------------------------------------------------------------- the branch


@both_vehicles
@given(p=near_reconstructed(2))
def test_the_branch_begins_at_the_hopf_point_exactly(vehicle, p):
    system = vehicle(p)
    points = hopf_points(system)
    start = points.hunting_index()
    if start < 0:
        return
    branch = averaged_branch(system, points=points)
    assert branch.amplitude[0] == 0
    assert branch.speed[0] == points.speed[start]
    assert branch.frequency[0] == points.frequency[start]


@both_vehicles
@given(p=near_reconstructed(2))
def test_along_the_branch_the_amplitude_is_at_rest(vehicle, p):
    system = vehicle(p)
    branch, averaged = averaged_branch(system), averaging(system)
    rates = averaged.A1(branch.amplitude, branch.speed)
    terms = np.abs(averaged.growth * branch.speed) * branch.amplitude
    assert (np.abs(rates) <= 1e-12 * terms).all()


@both_vehicles
@given(p=near_reconstructed(2))
def test_a_cycle_is_stable_where_a_larger_amplitude_shrinks(vehicle, p):
    """The sign of dA1/da, by differences."""
    system = vehicle(p)
    branch, averaged = averaged_branch(system), averaging(system)
    a, V = branch.amplitude, branch.speed
    turns = [p.delta] if branch.fold is None else [p.delta, branch.fold[1]]
    clear = (a > 0) & (np.abs(a[:, None] / turns - 1) > 1e-3).all(axis=-1)
    h = 1e-5 * a
    slope = averaged.A1(a + h, V) - averaged.A1(a - h, V)
    np.testing.assert_array_equal(branch.stable[clear], slope[clear] < 0)


@both_vehicles
@pytest.mark.parametrize("p", [RECONSTRUCTED, HARDENING], ids=["weakening", "hardening"])
def test_the_branch_leaves_the_hopf_point_linearly_in_amplitude(vehicle, p):
    """v|v| has no second derivative at rest."""
    averaged = averaging(vehicle(p))
    near, nearer = averaged.branch_speed([1e-5, 1e-6]) - averaged.speed
    assert near / nearer == pytest.approx(10, rel=0.01)


def test_default_amplitudes_go_past_the_clearance_and_touch_it():
    branch = averaged_branch(bogie(RECONSTRUCTED))
    a, delta = branch.amplitude, RECONSTRUCTED.delta
    assert (a[0], a[-1]) == (0, pytest.approx(1.2 * delta))
    assert delta in a
    assert (np.diff(a) > 0).all()


@pytest.mark.parametrize(
    "amplitudes", [[0.002, 0.001], [0.001, 0.001], [-0.001, 0.001], [0.0, np.nan], [np.inf]]
)
def test_amplitudes_that_do_not_rise_are_refused(amplitudes):
    with pytest.raises(ValueError, match="amplitudes must be finite, >= 0 m and rising, got"):
        averaged_branch(bogie(RECONSTRUCTED), amplitudes)


def test_averaging_has_no_multipliers_and_one_harmonic():
    branch = averaged_branch(bogie(RECONSTRUCTED))
    assert branch.multipliers is None
    assert branch.orders == (1,)
    assert branch.harmonics.shape == (*branch.speed.shape, 1, 6)


# ---------------------------------------------------------------- folds


def test_the_reconstruction_folds_just_beyond_the_clearance():
    for vehicle in (wheelset, bogie):
        _, amplitude = averaged_branch(vehicle(RECONSTRUCTED)).fold
        assert 0 < amplitude / RECONSTRUCTED.delta - 1 < 1e-5


def test_a_damper_that_hardens_early_folds_smoothly_below_the_clearance():
    for vehicle in (wheelset, bogie):
        branch = averaged_branch(vehicle(HARDENING_LATE))
        speed, amplitude = branch.fold
        assert amplitude < 0.99 * HARDENING_LATE.delta
        assert speed < branch.speed[0]
        slope = averaging(vehicle(HARDENING_LATE)).branch_slope(amplitude)
        assert slope == pytest.approx(0, abs=1e-9)


def test_a_hardening_damper_makes_a_supercritical_branch_without_fold():
    for vehicle in (wheelset, bogie):
        branch = averaged_branch(vehicle(HARDENING))
        assert branch.fold is None
        assert branch.stable.all()
        assert (np.diff(branch.speed) > 0).all()


@both_vehicles
@given(p=near_reconstructed(3))
def test_the_fold_is_the_slowest_point_of_the_branch(vehicle, p):
    branch = averaged_branch(vehicle(p))
    if not branch.speed.size:
        return
    averaged = averaging(vehicle(p))
    dense = averaged.branch_speed(np.linspace(0, 1.2 * p.delta, 20001))
    if branch.fold is None:
        slowest = dense.argmin()
        assert slowest in (0, len(dense) - 1) or dense[slowest] >= branch.speed[0]
    else:
        speed, amplitude = branch.fold
        V_lin = branch.speed[0]
        assert speed <= dense.min() + 1e-11 * V_lin
        assert speed == pytest.approx(dense.min(), abs=1e-4 * V_lin)
        assert speed == averaged.branch_speed(amplitude)


def test_stability_changes_at_the_fold():
    branch = averaged_branch(bogie(RECONSTRUCTED))
    _, amplitude = branch.fold
    np.testing.assert_array_equal(branch.stable, branch.amplitude > amplitude)


def test_a_stiffer_rail_does_not_move_the_fold():
    """Fig. 12: a rail a hundred times stiffer moves it by one part in a hundred thousand."""
    p = RECONSTRUCTED.replace(Kr=RECONSTRUCTED.Kr * np.array([0.1, 1.0, 10.0]))
    for vehicle in (wheelset, bogie):
        speed, _ = averaged_branch(vehicle(p)).fold
        assert np.ptp(speed) < 1.2e-5 * speed[1]
        assert (np.diff(speed) > 0).all()


def test_a_larger_clearance_lowers_the_fold():
    """Fig. 13."""
    p = RECONSTRUCTED.replace(delta=np.linspace(0.004, 0.014, 11))
    for vehicle in (wheelset, bogie):
        speed, amplitude = averaged_branch(vehicle(p)).fold
        assert (np.diff(speed) < 0).all()
        assert amplitude == pytest.approx(p.delta, rel=1e-3)


# ---------------------------------------------------------------- other Hopf points, and none


def test_a_branch_may_start_at_any_hopf_point():
    system = bogie(WITH_WINDOW)
    points = hopf_points(system)
    starts = [averaged_branch(system, hopf=k).speed[0] for k in range(3)]
    assert starts == points.speed.tolist()
    assert averaged_branch(system).speed[0] == points.speed[2]


@pytest.mark.parametrize("index", [-1, 1, 7])
def test_a_hopf_point_that_is_not_there_is_refused_by_its_index(index):
    with pytest.raises(IndexError, match=rf"one of 1 Hopf points, got {index}$"):
        averaged_branch(wheelset(RECONSTRUCTED), hopf=index)
    with pytest.raises(IndexError, match="one of 0 Hopf points"):
        averaged_branch(wheelset(TABLE_1), hopf=0)


def test_without_hopf_point_the_branch_is_empty_and_says_why():
    branch = averaged_branch(bogie(TABLE_1))
    for values in (branch.amplitude, branch.speed, branch.frequency, branch.stable):
        assert values.shape == (0,)
    assert branch.harmonics.shape == (0, 1, 6)
    assert branch.fold is None
    assert branch.message == "no Hopf point in range"
    assert branch.at_speed(40.0) == []


# ---------------------------------------------------------------- stacks


@both_vehicles
def test_branches_of_a_stack_are_those_of_its_members(vehicle):
    p = stack_near_reconstructed(3, 40, seed=6)
    stack = averaged_branch(vehicle(p))
    missing = 0
    for k, q in enumerate(members(p)):
        alone = averaged_branch(vehicle(q))
        if not alone.speed.size:
            missing += 1
            assert np.isnan(stack.speed[k]).all()
            assert np.isnan([values[k] for values in stack.fold]).all()
            continue
        assert stack.amplitude[k] == pytest.approx(alone.amplitude)
        assert stack.speed[k] == pytest.approx(alone.speed, rel=1e-9)
        assert stack.frequency[k] == pytest.approx(alone.frequency, rel=1e-9)
        np.testing.assert_array_equal(stack.stable[k], alone.stable)
        fold = alone.fold or (np.nan, np.nan)
        assert [f[k] for f in stack.fold] == pytest.approx(fold, rel=1e-7, nan_ok=True)
    assert 0 < missing < 20


def test_each_member_of_a_stack_may_have_amplitudes_of_its_own():
    p = RECONSTRUCTED.replace(delta=[0.006, 0.009])
    amplitudes = np.linspace(0, 1.1, 30) * np.array([[0.006], [0.009]])
    branch = averaged_branch(bogie(p), amplitudes)
    np.testing.assert_array_equal(branch.amplitude, amplitudes)
    shared = averaged_branch(bogie(p), amplitudes[1])
    assert shared.amplitude.shape == (2, 30)
    np.testing.assert_array_equal(shared.speed[1], branch.speed[1])


# ---------------------------------------------------------------- what a branch answers


def test_at_one_speed_there_are_an_unstable_and_a_stable_cycle_between_the_critical_speeds():
    branch = averaged_branch(bogie(RECONSTRUCTED))
    V_nl, V_lin = branch.fold[0], branch.speed[0]
    inner, outer = branch.at_speed(0.5 * (V_nl + V_lin))
    assert (inner.stable, outer.stable) == (False, True)
    assert inner.amplitude < RECONSTRUCTED.delta < outer.amplitude
    assert branch.at_speed(V_nl - 0.5) == []
    (only,) = branch.at_speed(V_lin + 0.5)
    assert only.stable


@given(share=st.floats(0.02, 0.98))
def test_a_cycle_at_a_speed_lies_on_the_branch(share):
    system = bogie(RECONSTRUCTED)
    branch, averaged = averaged_branch(system), averaging(system)
    V_nl, V_lin = branch.fold[0], branch.speed[0]
    V = V_nl + share * (V_lin - V_nl)
    for cycle in branch.at_speed(V):
        assert averaged.branch_speed(cycle.amplitude) == pytest.approx(V, rel=1e-4)
        expected = averaged.frequency + averaged.B1(cycle.amplitude, V)
        assert cycle.frequency == pytest.approx(expected, rel=1e-4)


@both_vehicles
def test_a_motion_is_one_closed_period_with_the_amplitude_as_its_peak(vehicle):
    system = vehicle(RECONSTRUCTED)
    branch = averaged_branch(system)
    motion = branch.motion(150, samples=101)
    assert motion.state.shape == (101, len(system.states))
    assert motion.time[-1] == pytest.approx(2 * np.pi / branch.frequency[150])
    np.testing.assert_allclose(motion.state[-1], motion.state[0], atol=1e-12)
    np.testing.assert_allclose(motion.state[50], -motion.state[0], atol=1e-12)
    y, vy = motion.state[:, 0], motion.state[:, 1]
    assert np.abs(y).max() == pytest.approx(branch.amplitude[150], rel=1e-12)
    # To first order velocities have the frequency of the Hopf point, not of the cycle.
    rate = np.gradient(y, motion.time)[1:-1]
    assert np.abs(rate - vy[1:-1]).max() < 0.1 * np.abs(vy).max()


def test_a_motion_carries_its_forces():
    branch = averaged_branch(bogie(RECONSTRUCTED))
    motion = branch.motion(-1)
    beyond = np.abs(motion.state[:, 0]) - RECONSTRUCTED.delta
    force = np.abs(motion.forces["flange force"])
    np.testing.assert_allclose(force, RECONSTRUCTED.Kr * np.maximum(beyond, 0), atol=1e-6)
    assert set(motion.forces) == {"flange force", "yaw damper force"}


def test_nothing_of_the_result_depends_on_parameters_the_branch_does_not_contain():
    """The frame's mass, and only it, is nothing to the wheelset's branch."""
    base = averaged_branch(wheelset(RECONSTRUCTED)).speed
    for field in FIELDS:
        value = 1.01 * getattr(RECONSTRUCTED, field.name)
        moved = averaged_branch(wheelset(RECONSTRUCTED.replace(**{field.name: value}))).speed
        assert np.array_equal(moved, base) == (field.name == "m_B"), field.name
