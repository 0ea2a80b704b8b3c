"""Exact limit cycles: against the reference solutions, the equations of motion and themselves."""

from __future__ import annotations

import numpy as np
import pytest

from hunting import (
    RECONSTRUCTED,
    TABLE_1,
    bogie,
    critical_speeds,
    decays,
    limit_cycles,
    simulate,
    wheelset,
)
from tests.model.subjects import (
    REFERENCE,
    both_vehicles,
    members,
    reference_cases,
    stack_near_reconstructed,
    system_of,
)

NEARER = (3, 7, 15, 31, 63)  # harmonics


def at_the_amplitudes_of(case, harmonics):
    """Return ours at the reference's amplitudes, the reference, and which do not touch."""
    system = system_of(case)
    points = sorted(case["branch"], key=lambda point: point["amplitude"])
    Y = np.array([point["amplitude"] for point in points])
    branch = limit_cycles(system, Y, harmonics=harmonics)
    assert branch.message == ""
    np.testing.assert_allclose(branch.amplitude, [0.0, *Y], rtol=1e-13)
    reference = {
        name: np.array([point[name] for point in points])
        for name in ("speed", "frequency", "multiplier", "stable", "first_harmonic")
    }
    return branch, reference, system.clearance > Y


def errors(case, harmonics, name):
    branch, reference, free = at_the_amplitudes_of(case, harmonics)
    relative = np.abs(getattr(branch, name)[1:] / reference[name] - 1)
    return relative[free].max(), relative[~free].max()


def largest_multiplier(branch):
    return np.abs(branch.multipliers[1:, 1:]).max(axis=-1)


# ---------------------------------------------------------------- reference solutions


@reference_cases(having="branch")
@pytest.mark.parametrize("name", ["speed", "frequency"])
@pytest.mark.parametrize(
    ("harmonics", "free", "touching"), [(15, 1e-6, 3e-4), (63, 1e-8, 1e-5)], ids=["15", "63"]
)
def test_branches_pass_through_the_reference(case, name, harmonics, free, touching):
    found = errors(case, harmonics, name)
    assert found[0] < free
    assert found[1] < touching


@reference_cases(having="branch")
def test_errors_fall_with_every_harmonic(case):
    free, touching = np.transpose([errors(case, highest, "speed") for highest in NEARER])
    assert (free[1:] < 0.5 * free[:-1]).all()
    assert free[-1] < 1e-4 * free[0]
    assert touching[-1] < 0.03 * touching[0]


@reference_cases(having="branch")
def test_multipliers_are_those_of_the_reference(case):
    branch, reference, free = at_the_amplitudes_of(case, 15)
    error = np.abs(largest_multiplier(branch) - reference["multiplier"])
    assert error[free].max() < 1e-4
    assert error[~free].max() < 2e-3


@reference_cases(having="branch")
@pytest.mark.parametrize("harmonics", [7, 15, 63])
def test_stability_is_that_of_the_reference(case, harmonics):
    branch, reference, _ = at_the_amplitudes_of(case, harmonics)
    np.testing.assert_array_equal(branch.stable[1:], reference["stable"])
    np.testing.assert_array_equal(branch.stable[1:], largest_multiplier(branch) < 1)


@reference_cases(having="branch")
def test_the_first_harmonic_is_that_of_the_reference(case):
    branch, reference, _ = at_the_amplitudes_of(case, 63)
    first = np.abs(branch.harmonics[1:, 0, 0])
    np.testing.assert_allclose(first, reference["first_harmonic"], rtol=1e-5)


LAST = [
    pytest.param(case, branch, id=f"{case['name']}-{case['vehicle']}-{branch['hopf_index']}")
    for case in REFERENCE
    for branch in case["branches"]
]


@pytest.mark.parametrize(("case", "branch"), LAST)
def test_folds_are_those_of_the_reference(case, branch):
    """From every Hopf point, not only the hunting one; two ends of a closed branch share a fold."""
    index = branch["hopf_index"]
    found = limit_cycles(system_of(case), hopf=index).fold
    folds = [fold for fold in branch["folds"] if fold["is_minimum"]]
    if not folds and case["hopf"][index]["direction"] == "to stable":
        folds = case["branches"][index - 1]["folds"]
    if not folds:
        assert found is None
        return
    slowest = min(folds, key=lambda fold: fold["speed"])
    assert found[0] == pytest.approx(slowest["speed"], rel=1e-6)
    assert found[1] == pytest.approx(slowest["amplitude"], rel=1e-4)


@reference_cases(having="upper_folds_in_contact")
def test_the_branch_ends_at_its_second_fold(case):
    (upper,) = (fold for fold in case["upper_folds_in_contact"] if not fold["is_minimum"])
    branch = limit_cycles(system_of(case))
    assert "second fold" in branch.message
    assert branch.speed[-1] == pytest.approx(upper["speed"], rel=3e-6)
    assert branch.amplitude[-1] == pytest.approx(upper["amplitude"], rel=1e-4)
    assert branch.frequency[-1] == pytest.approx(upper["frequency"], rel=1e-4)
    assert branch.speed[-1] == branch.speed.max()


@pytest.mark.parametrize("name", ["set03_low_speed_window", "set06_light_frame"])
def test_a_closed_branch_is_the_same_from_both_of_its_ends(name):
    (case,) = (c for c in REFERENCE if c["name"] == name and c["vehicle"] == "bogie")
    up, down = (limit_cycles(system_of(case), hopf=index) for index in (0, 1))
    assert up.message == down.message == "the branch ends at another Hopf point"
    for start, other in ((up, down), (down, up)):
        assert start.speed[-1] == pytest.approx(other.speed[0], rel=1e-3)
        assert start.frequency[-1] == pytest.approx(other.frequency[0], rel=1e-3)
        assert start.amplitude[-1] < 0.05 * start.amplitude.max()
    assert up.amplitude.max() == pytest.approx(down.amplitude.max(), rel=1e-3)
    top = np.argmax(up.amplitude)
    across = np.interp(up.amplitude[top + 1], *_rising(down.amplitude, down.speed))
    assert up.speed[top + 1] == pytest.approx(across, rel=1e-2)


def _rising(x, y):
    top = np.argmax(x)
    return x[: top + 1], y[: top + 1]


# ---------------------------------------------------------------- the branch as a whole


@both_vehicles
def test_the_branch_begins_at_the_hopf_point(vehicle):
    system = vehicle(RECONSTRUCTED)
    branch, speeds = limit_cycles(system), critical_speeds(system)
    assert branch.amplitude[0] == 0
    assert branch.speed[0] == speeds.linear
    assert branch.frequency[0] == speeds.frequency
    assert (np.diff(branch.amplitude) > 0).all()
    assert len(branch.speed) >= 60


@both_vehicles
def test_cycles_are_unstable_up_to_the_fold_and_stable_above(vehicle):
    branch = limit_cycles(vehicle(RECONSTRUCTED))
    at_fold = np.flatnonzero(branch.amplitude == branch.fold[1])
    assert len(at_fold) == 1
    assert not branch.stable[: at_fold[0]].any()
    assert branch.stable[at_fold[0] + 1 : -1].all()
    assert branch.speed.min() == branch.fold[0]


@both_vehicles
def test_without_a_hopf_point_the_branch_is_empty_and_says_so(vehicle):
    branch = limit_cycles(vehicle(TABLE_1))
    assert len(branch.speed) == 0
    assert branch.fold is None
    assert branch.message == "no Hopf point in range"


def test_given_amplitudes_are_the_only_ones_and_the_fold_is_found_between_them():
    system = bogie(RECONSTRUCTED)
    branch = limit_cycles(system, [0.003, 0.006, 0.00925, 0.0095])
    np.testing.assert_allclose(branch.amplitude, [0, 0.003, 0.006, 0.00925, 0.0095], rtol=1e-13)
    assert branch.fold[0] == pytest.approx(limit_cycles(system).fold[0], rel=1e-5)


@pytest.mark.parametrize("harmonics", [0, 2, -1])
def test_even_harmonics_are_refused(harmonics):
    with pytest.raises(ValueError, match=f"odd number >= 1, got {harmonics}"):
        limit_cycles(bogie(RECONSTRUCTED), harmonics=harmonics)


def test_falling_amplitudes_are_refused():
    with pytest.raises(ValueError, match="rising"):
        limit_cycles(bogie(RECONSTRUCTED), [0.004, 0.002])


def test_a_hopf_point_that_is_not_there_is_refused():
    with pytest.raises(IndexError, match="got 1"):
        limit_cycles(bogie(RECONSTRUCTED), hopf=1)


def test_a_wheelset_under_a_heavy_frame_moves_as_one_alone():
    Y = [0.003, 0.008, 0.0095]
    alone = limit_cycles(wheelset(RECONSTRUCTED), Y)
    framed = limit_cycles(bogie(RECONSTRUCTED.replace(m_B=1e9)), Y)
    np.testing.assert_allclose(framed.speed, alone.speed, rtol=1e-4)
    np.testing.assert_allclose(framed.frequency, alone.frequency, rtol=1e-4)


@both_vehicles
def test_a_larger_vehicle_of_the_same_shape_moves_alike(vehicle):
    """Units of length, mass and time may be chosen at will."""
    length, mass, time = 2.0, 3.0, 0.5
    dimensions = {  # powers of kg, m, s
        "m_w": (1, 0, 0), "I_wx": (1, 2, 0), "I_wy": (1, 2, 0), "r0": (0, 1, 0), "d": (0, 1, 0),
        "b": (0, 1, 0), "lam": (0, 0, 0), "W_A": (1, 1, -2), "Ky": (1, 0, -2), "Cy": (1, 0, -1),
        "Kpsi": (1, 0, -2), "f11": (1, 1, -2), "f22": (1, 3, -2), "f12": (1, 2, -2),
        "f33": (1, 1, -2), "Kr": (1, 0, -2), "delta": (0, 1, 0), "C1": (1, 0, -1),
        "C2": (1, -1, 0), "C3": (1, -2, 1), "C4": (1, -3, 2), "m_B": (1, 0, 0),
    }  # fmt: skip
    scaled = RECONSTRUCTED.replace(
        **{
            name: getattr(RECONSTRUCTED, name) * mass**m * length**l * time**t
            for name, (m, l, t) in dimensions.items()
        }
    )
    Y = np.array([0.002, 0.007, 0.0095])
    ours, theirs = (
        limit_cycles(vehicle(RECONSTRUCTED), Y),
        limit_cycles(vehicle(scaled), length * Y),
    )
    np.testing.assert_allclose(theirs.speed, ours.speed * length / time, rtol=1e-7)
    np.testing.assert_allclose(theirs.frequency, ours.frequency / time, rtol=1e-7)
    np.testing.assert_allclose(largest_multiplier(theirs), largest_multiplier(ours), rtol=1e-5)


# ---------------------------------------------------------------- motions


@both_vehicles
def test_motions_obey_the_equations_of_motion(vehicle):
    system = vehicle(RECONSTRUCTED)
    residuals = []
    for harmonics in (15, 31, 63):
        branch = limit_cycles(system, [0.003, 0.009, 0.0095], harmonics=harmonics)
        residuals.append([_residual(branch, i) for i in (1, 2, 3)])
    assert (
        np.array(residuals) < [[2e-3, 5e-3, 0.15], [5e-4, 1e-3, 0.08], [2e-4, 6e-4, 0.04]]
    ).all()


def _residual(branch, i):
    """Return the largest error of a state's rate over its largest rate.

    It falls slowly, with the last harmonic of a force that has a kink.
    """
    motion, omega = branch.motion(i, 513), branch.frequency[i]
    waves = np.exp(1j * np.outer(omega * motion.time, branch.orders))
    rate = (waves @ (1j * omega * np.array(branch.orders)[:, None] * branch.harmonics[i])).real
    expected = branch.system.derivative(0.0, motion.state, branch.speed[i])
    return (np.abs(rate - expected).max(axis=0) / np.abs(expected).max(axis=0)).max()


@both_vehicles
def test_motions_reach_the_amplitude_and_come_back(vehicle):
    system = vehicle(RECONSTRUCTED)
    branch = limit_cycles(system)
    for i in range(1, len(branch.speed), 10):
        motion = branch.motion(i, 1025)
        y = motion.state @ system.output
        assert np.abs(y).max() == pytest.approx(branch.amplitude[i], rel=1e-4)
        assert y[0] == pytest.approx(branch.amplitude[i], rel=1e-4)
        np.testing.assert_allclose(motion.state[512], -motion.state[0], atol=1e-9)
        assert motion.time[-1] == pytest.approx(2 * np.pi / branch.frequency[i])
        for name, force in system.forces(motion.state).items():
            np.testing.assert_array_equal(motion.forces[name], force)
        assert motion.forces["flange force"].any() == (branch.amplitude[i] > RECONSTRUCTED.delta)


def test_between_the_critical_speeds_there_are_two_cycles():
    branch = limit_cycles(bogie(RECONSTRUCTED))
    small, large = branch.at_speed(40.0)
    assert not small.stable
    assert large.stable
    for cycle in (small, large):
        exact = limit_cycles(branch.system, [cycle.amplitude])
        assert exact.speed[1] == pytest.approx(40.0, rel=1e-4)
        assert exact.frequency[1] == pytest.approx(cycle.frequency, rel=1e-3)
        assert np.abs(cycle.motion.state[:, 0]).max() == pytest.approx(cycle.amplitude, rel=1e-3)
    assert branch.at_speed(38.0) == []
    (only,) = branch.at_speed(45.0)
    assert only.stable


@both_vehicles
def test_a_simulation_stays_on_stable_cycles_and_leaves_unstable_ones(vehicle):
    system = vehicle(RECONSTRUCTED)
    for cycle in limit_cycles(system, harmonics=31).at_speed(41.0):
        inside, outside = (
            simulate(system, 41.0, share * cycle.motion.state[0], 30.0).peak(since=28.0)
            for share in (0.97, 1.03)
        )
        if cycle.stable:
            assert inside == pytest.approx(cycle.amplitude, rel=2e-3)
            assert outside == pytest.approx(cycle.amplitude, rel=2e-3)
        else:
            assert inside < 0.97 * cycle.amplitude
            assert outside > 1.03 * cycle.amplitude


# ---------------------------------------------------------------- stacks


def test_a_stack_is_answered_in_its_shape():
    p = RECONSTRUCTED.replace(Ky=[[8e4], [2e5], [1e5]], C2=[-9e5, 5e5])
    stack = limit_cycles(bogie(p))
    assert stack.speed.shape[:2] == stack.message.shape == stack.fold[0].shape == (3, 2)
    assert stack.harmonics.shape == (*stack.speed.shape, len(stack.orders), 6)
    assert stack.multipliers.shape == (*stack.speed.shape, 6)
    for place in np.ndindex(3, 2):
        alone = limit_cycles(bogie(p.replace(Ky=p.Ky[place[0], 0], C2=p.C2[place[1]])))
        count = len(alone.speed)
        for name in ("amplitude", "speed", "frequency"):
            row = getattr(stack, name)[place]
            np.testing.assert_allclose(row[:count], getattr(alone, name), rtol=1e-9)
            assert np.isnan(row[count:]).all()
        np.testing.assert_array_equal(stack.stable[place][:count], alone.stable)
        fold = [speed[place] for speed in stack.fold]
        np.testing.assert_allclose(fold, alone.fold or [np.nan, np.nan], rtol=1e-9)
        assert stack.message[place] == alone.message


def test_members_of_a_stack_without_a_hopf_point_are_nan():
    stack = limit_cycles(bogie(RECONSTRUCTED.replace(f11=[1.5913e7, 1.5913e6], Kpsi=[8.67e4, 9e6])))
    assert np.isfinite(stack.speed[0]).any()
    assert np.isnan(stack.speed[1]).all()
    assert np.isnan(stack.fold[0][1])
    assert stack.message[1] == "no Hopf point in range"


def test_each_member_of_a_stack_may_have_amplitudes_of_its_own():
    p = RECONSTRUCTED.replace(delta=[0.008, 0.01])
    own = limit_cycles(bogie(p), p.delta[:, None] * [0.5, 1.01])
    np.testing.assert_allclose(own.amplitude[:, 1:], p.delta[:, None] * [0.5, 1.01])


# ---------------------------------------------------------------- an answer for every input


@pytest.mark.slow
@both_vehicles
def test_random_vehicles_have_sound_branches_and_their_stable_cycles_attract(vehicle):
    """All 22 parameters within a factor of 2, however wild the vehicle."""
    p = stack_near_reconstructed(2, 150, seed=5)
    speeds = critical_speeds(vehicle(p))
    assert (np.isnan(speeds.nonlinear) == (speeds.message != "")).all()
    assert not (speeds.nonlinear > speeds.linear).any()
    unfound = speeds.message == "the slowest limit cycle was not found"
    assert unfound.mean() < 0.1
    confirmed = 0
    for k, q in enumerate(members(p)):
        system = vehicle(q)
        branch = limit_cycles(system)
        for values in (branch.speed, branch.frequency, branch.amplitude, branch.multipliers):
            assert np.isfinite(values).all()
        if branch.fold is not None and speeds.nonlinear[k] < speeds.linear[k]:
            assert branch.fold[0] == pytest.approx(speeds.nonlinear[k], rel=2e-5)
        if np.isnan(speeds.linear[k]) or len(branch.speed) < 2:
            assert branch.message != ""
        confirmed += _attracts(system, branch)
    assert confirmed >= 45


def _attracts(system, branch):
    """Check that a simulation settles on a stable cycle well inside the branch, if it has one."""
    size = np.abs(branch.multipliers[:, 1:]).max(axis=-1, initial=0.0)
    clear = branch.stable & (size < 0.97) & (branch.amplitude < 1.15 * float(system.clearance))
    clear[:1] = False
    if not clear.any():
        return False
    i = int(np.argmin(np.where(clear, size, np.inf)))
    V, cycle = branch.speed[i], branch.motion(i)
    settled = decays(system, V, 1.01 * cycle.state[0], horizon=150.0)
    assert not settled.dies_out
    assert settled.amplitude == pytest.approx(branch.amplitude[i], rel=5e-3)
    return True
