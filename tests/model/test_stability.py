"""Eigenvalues and Hopf points: every crossing, each with its frequency and direction."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hunting import (
    RECONSTRUCTED,
    TABLE_1,
    bogie,
    damping_ratios,
    eigenvalues,
    hopf_points,
    wheelset,
)
from tests.model.subjects import (
    both_vehicles,
    members,
    near_reconstructed,
    reference_cases,
    stack_near_reconstructed,
    stack_within_spans,
    system_of,
)

LOW, HIGH = 1.0, 400.0
WITH_WINDOW = RECONSTRUCTED.replace(Ky=2e5)  # the bogie is also unstable in a low-speed window

# ---------------------------------------------------------------- against the reference solutions


@reference_cases()
def test_hopf_points_are_those_of_the_reference(case):
    points = hopf_points(system_of(case))
    expected = case["hopf"]
    assert points.speed == pytest.approx([h["speed"] for h in expected], rel=1e-12)
    assert points.frequency == pytest.approx([h["frequency"] for h in expected], rel=1e-12)
    signs = {"to unstable": 1, "to stable": -1}
    assert points.direction.tolist() == [signs[h["direction"]] for h in expected]


@reference_cases(having="hopf")
def test_the_hunting_point_is_that_of_the_reference_branch(case):
    assert hopf_points(system_of(case)).hunting_index() == case["branch_hopf_index"]


# ---------------------------------------------------------------- against a fine grid of speeds


def assert_unstable_pairs_are_those_of_a_grid(system, points, speeds):
    """At each speed the unstable eigenvalues are as many as the crossings below it say."""
    values = eigenvalues(system, speeds)
    rounding = 8 * np.finfo(float).eps * np.abs(values).max(axis=-1, keepdims=True)
    clear = (np.abs(values.real) > rounding).all(axis=-1)
    on_grid = np.where(clear, (values.real > 0).sum(axis=-1), -1)

    pairs = points.unstable_pairs()[..., None, :]
    crossed = (points.speed[..., None, :] < speeds[:, None]).sum(axis=-1, keepdims=True)
    predicted = 2 * np.take_along_axis(pairs, crossed, axis=-1)[..., 0]
    np.testing.assert_array_equal(on_grid[clear], predicted[clear])
    assert clear.mean() > 0.99


def assert_every_point_is_a_crossing(system, points):
    """At each point +-i omega is a pair of eigenvalues, and r and l are its eigenvectors."""
    found = np.isfinite(points.speed)
    V = np.where(found, points.speed, 1.0)
    A = system.with_axes().matrix(V)
    right, left, omega = points.right, points.left, points.frequency[..., None]
    residual_right = (A @ right[..., None])[..., 0] - 1j * omega * right
    residual_left = (left[..., None, :] @ A)[..., 0, :] - 1j * omega * left
    scale_right = (np.abs(A) @ np.abs(right)[..., None])[..., 0]
    scale_left = (np.abs(left)[..., None, :] @ np.abs(A))[..., 0, :]
    assert (np.abs(residual_right) <= 1e-8 * scale_right)[found].all()
    assert (np.abs(residual_left) <= 1e-8 * scale_left)[found].all()
    np.testing.assert_allclose((left * right).sum(axis=-1)[found], 1, rtol=1e-9)
    np.testing.assert_allclose((right @ system.output)[found], 1, rtol=1e-12)
    assert (points.frequency[found] > 0).all()
    assert (np.diff(points.speed, axis=-1)[found[..., 1:]] > 0).all()
    assert set(points.direction[found].tolist()) <= {-1, 1}
    assert (points.direction[~found] == 0).all()


GRID = np.geomspace(LOW, HIGH, 3000)


@both_vehicles
@pytest.mark.parametrize("factor", [2, 10])
@settings(max_examples=40)
@given(data=st.data())
def test_no_crossing_is_missed_and_none_invented(vehicle, factor, data):
    system = vehicle(data.draw(near_reconstructed(factor)))
    points = hopf_points(system)
    assert_unstable_pairs_are_those_of_a_grid(system, points, GRID)
    assert_every_point_is_a_crossing(system, points)


@both_vehicles
@pytest.mark.parametrize(
    "stack",
    [
        stack_near_reconstructed(2, 150, seed=1),
        stack_near_reconstructed(10, 600, seed=2),
        stack_within_spans(250, seed=3),
    ],
    ids=["within a factor of 2", "within a factor of 10", "on the sliders"],
)
def test_nor_in_stacks_of_random_systems(vehicle, stack):
    system = vehicle(stack)
    points = hopf_points(system)
    assert_unstable_pairs_are_those_of_a_grid(system, points, np.geomspace(LOW, HIGH, 500))
    assert_every_point_is_a_crossing(system, points)


@both_vehicles
def test_nor_where_parameters_are_zero(vehicle):
    may_vanish = ("I_wy", "W_A", "Cy", "Kpsi", "f22", "f12", "C1")
    keep = np.array(list(itertools.product([0.0, 1.0], repeat=len(may_vanish)))).T
    system = vehicle(
        RECONSTRUCTED.replace(
            **{n: k * getattr(RECONSTRUCTED, n) for n, k in zip(may_vanish, keep, strict=True)}
        )
    )
    points = hopf_points(system)
    assert_unstable_pairs_are_those_of_a_grid(system, points, np.geomspace(LOW, HIGH, 500))
    assert_every_point_is_a_crossing(system, points)


def test_a_point_is_found_where_fast_creep_modes_hide_the_slow_pair_by_their_rounding():
    p = RECONSTRUCTED.replace(
        m_w=192.5, I_wx=65.9, I_wy=949.5, r0=4.407, d=3.598, lam=0.4272, W_A=9.16e4, b=0.4371,
        Ky=1.68e4, Cy=1.434e4, Kpsi=4.605e5, f11=1.5285e8, f22=1.22e4, f12=2.319e4, f33=1.7239e8,
        C1=3388.0, m_B=6268.0,
    )  # fmt: skip
    system = bogie(p)
    (V,) = hopf_points(system).speed
    below, above = eigenvalues(system, [0.9 * V, 1.1 * V]).real.max(axis=-1)
    assert below < 0 < above
    assert np.abs(eigenvalues(system, [V])).max() > 1e6


# ---------------------------------------------------------------- what a Hopf point knows


@both_vehicles
@pytest.mark.parametrize("p", [RECONSTRUCTED, WITH_WINDOW], ids=["default", "stiffer springs"])
def test_growth_is_the_derivative_of_the_eigenvalue_with_speed(vehicle, p):
    system = vehicle(p)
    points = hopf_points(system)
    assert len(points.speed)
    for V, omega, growth in zip(points.speed, points.frequency, points.growth, strict=True):
        h = 1e-4 * V
        near = eigenvalues(system, [V - h, V + h])
        pick = np.abs(near - 1j * omega).argmin(axis=-1)
        low, high = near[[0, 1], pick]
        assert growth == pytest.approx((high - low) / (2 * h), rel=1e-5)


@both_vehicles
@given(p=near_reconstructed(3))
def test_the_direction_is_the_sign_of_the_growth(vehicle, p):
    points = hopf_points(vehicle(p))
    np.testing.assert_array_equal(points.direction, np.sign(points.growth.real))


def test_the_damping_ratio_is_zero_at_a_hopf_point():
    system = bogie(RECONSTRUCTED)
    (V,) = hopf_points(system).speed
    below, at, above = damping_ratios(eigenvalues(system, [0.9 * V, V, 1.1 * V])).min(axis=-1)
    assert above < 0 < below
    assert at == pytest.approx(0, abs=1e-10)


def test_the_damping_ratio_of_an_oscillator_is_its_textbook_value():
    zeta, omega = np.array([-0.1, 0.0, 0.3, 0.9]), 12.0
    roots = -zeta * omega + 1j * omega * np.sqrt(1 - zeta**2)
    np.testing.assert_allclose(damping_ratios(roots), zeta, atol=1e-15)


# ---------------------------------------------------------------- low-speed windows


def test_a_frame_on_stiffer_springs_has_a_low_speed_window():
    points = hopf_points(bogie(WITH_WINDOW))
    assert points.direction.tolist() == [1, -1, 1]
    assert points.unstable_pairs().tolist() == [0, 1, 0, 1]
    assert points.hunting_index() == 2
    assert len(hopf_points(wheelset(WITH_WINDOW)).speed) == 1


def test_a_window_that_has_just_opened_is_found():
    """Its width grows with the square root of the distance from where it opens."""

    def points(Ky):
        return hopf_points(bogie(RECONSTRUCTED.replace(Ky=Ky))).speed

    closed, opened = RECONSTRUCTED.Ky, WITH_WINDOW.Ky
    while (middle := 0.5 * (closed + opened)) not in (closed, opened):
        closed, opened = (middle, opened) if len(points(middle)) == 1 else (closed, middle)
    distance = np.array([1e-4, 1e-6, 1e-8, 1e-10])
    width = [np.diff(points(opened * (1 + share)))[0] for share in distance]
    np.testing.assert_allclose(width / np.sqrt(distance), width[0] / 1e-2, rtol=0.02)


def test_the_hunting_point_is_where_the_last_unstable_range_begins():
    """A second pair that crosses within an unstable range does not begin one."""
    p = stack_near_reconstructed(10, 3000, seed=4)
    points = hopf_points(bogie(p))
    pairs = points.unstable_pairs()
    index = points.hunting_index()
    assert (pairs.max(axis=-1) > 1).any()
    for k in range(len(index)):
        begins = [j for j, d in enumerate(points.direction[k]) if d > 0 and pairs[k, j] == 0]
        assert index[k] == (begins[-1] if begins else -1)


# ---------------------------------------------------------------- stacks


@both_vehicles
def test_a_stack_answers_as_its_members_do(vehicle):
    p = stack_near_reconstructed(4, 60, seed=5)
    stack = hopf_points(vehicle(p))
    depth = stack.speed.shape[-1]
    counts = set()
    for k, q in enumerate(members(p)):
        alone = hopf_points(vehicle(q))
        count = len(alone.speed)
        counts.add(count)
        assert stack.speed[k, :count] == pytest.approx(alone.speed, rel=1e-12)
        assert stack.frequency[k, :count] == pytest.approx(alone.frequency, rel=1e-12)
        assert stack.direction[k, :count].tolist() == alone.direction.tolist()
        assert stack.growth[k, :count] == pytest.approx(alone.growth, rel=1e-6)
        np.testing.assert_allclose(stack.right[k, :count], alone.right, rtol=1e-6, atol=1e-9)
        assert stack.unstable_below[k] == alone.unstable_below
        assert stack.hunting_index()[k] == alone.hunting_index()
        for padded in (stack.speed, stack.frequency, stack.growth, stack.right, stack.left):
            assert np.isnan(padded[k, count:]).all()
    assert len(counts) > 1
    assert max(counts) == depth


def test_a_stack_may_have_any_number_of_axes():
    p = RECONSTRUCTED.replace(Ky=np.geomspace(5e4, 2e5, 3)[:, None], Cy=np.linspace(1e4, 4e4, 4))
    points = hopf_points(bogie(p))
    assert points.speed.shape[:2] == points.hunting_index().shape == (3, 4)
    assert points.right.shape == (*points.speed.shape, 6)
    one = hopf_points(bogie(RECONSTRUCTED.replace(Ky=2e5, Cy=4e4)))
    assert points.speed[2, 3] == pytest.approx(one.speed, rel=1e-12)


# ---------------------------------------------------------------- the range


def test_the_range_keeps_what_lies_in_it():
    system = bogie(WITH_WINDOW)
    opens, closes, hunting = hopf_points(system).speed
    middle = 0.5 * (closes + hunting)
    assert hopf_points(system, (LOW, middle)).speed.tolist() == [opens, closes]
    upper = hopf_points(system, (middle, HIGH))
    assert upper.speed.tolist() == [hunting]
    assert upper.unstable_pairs().tolist() == [0, 1]

    within = hopf_points(system, (0.5 * (opens + closes), middle))
    assert within.speed.tolist() == [closes]
    assert within.unstable_pairs().tolist() == [1, 0]
    assert within.hunting_index() == -1


@both_vehicles
def test_the_range_ends_where_it_says(vehicle):
    system = vehicle(RECONSTRUCTED)
    (V,) = hopf_points(system).speed
    for just_outside in ((LOW, V * (1 - 1e-9)), (V * (1 + 1e-9), HIGH)):
        assert hopf_points(system, just_outside).speed.size == 0
    for just_inside in ((LOW, V * (1 + 1e-9)), (V * (1 - 1e-9), HIGH)):
        assert hopf_points(system, just_inside).speed == pytest.approx([V], rel=1e-13)


@pytest.mark.parametrize(
    "speed_range",
    [(0, 400), (-1, 400), (40, 40), (50, 40), (1, np.inf), (np.nan, 400), (1, np.nan)],
)
def test_a_range_that_is_none_is_refused(speed_range):
    with pytest.raises(ValueError, match="speed_range must be 0 < low < high m/s, got"):
        hopf_points(bogie(RECONSTRUCTED), speed_range)


@both_vehicles
@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
def test_no_hopf_point_is_an_answer(vehicle, shape):
    """Table 1 as printed does not hunt."""
    p = TABLE_1.replace(Ky=np.full(shape, TABLE_1.Ky))
    points = hopf_points(vehicle(p))
    assert points.speed.shape == points.frequency.shape == points.direction.shape == (*shape, 0)
    assert points.right.shape == points.left.shape == (*shape, 0, len(vehicle(p).states))
    assert (points.unstable_pairs() == 0).all()
    assert points.hunting_index().shape == shape
    assert (points.hunting_index() == -1).all()


def test_table_1_does_not_hunt_below_900_km_per_h():
    for vehicle in (wheelset, bogie):
        assert len(hopf_points(vehicle(TABLE_1), (1, 250)).speed) == 0


# ---------------------------------------------------------------- eigenvalues


@both_vehicles
def test_eigenvalues_are_those_of_the_matrix_at_each_speed(vehicle):
    system = vehicle(RECONSTRUCTED)
    speeds = np.array([10.0, 40.0, 90.0])
    values = eigenvalues(system, speeds)
    n = len(system.states)
    assert values.shape == (3, n)
    assert values.dtype == complex
    for V, row in zip(speeds, values, strict=True):
        assert row.sum() == pytest.approx(np.trace(system.matrix(V)), rel=1e-10)
        assert row.prod() == pytest.approx(np.linalg.det(system.matrix(V)), rel=1e-8)


@both_vehicles
def test_speeds_follow_the_axes_of_the_stack(vehicle):
    p = RECONSTRUCTED.replace(Ky=np.geomspace(5e4, 2e5, 3)[:, None], Cy=np.linspace(1e4, 4e4, 4))
    system = vehicle(p)
    n = len(system.states)
    values = eigenvalues(system, np.linspace(20, 60, 5))
    assert values.shape == (3, 4, 5, n)
    assert eigenvalues(system, []).shape == (3, 4, 0, n)


@pytest.mark.parametrize("speeds", [[10.0, 0.0], [-3.0], [np.nan], [10.0, np.inf]])
def test_a_speed_that_is_none_is_refused_by_its_value(speeds):
    with pytest.raises(ValueError, match=rf"^speeds must be > 0 m/s, got {speeds[-1]!r}$"):
        eigenvalues(bogie(RECONSTRUCTED), speeds)
