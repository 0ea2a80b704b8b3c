"""Critical speeds: Fig. 3, the paper's claims figure by figure, and an answer for every input."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hunting import (
    RECONSTRUCTED,
    TABLE_1,
    bogie,
    critical_speeds,
    eigenvalues,
    hopf_points,
    wheelset,
)
from tests.model.subjects import (
    KMH,
    both_vehicles,
    members,
    near_reconstructed,
    reference_cases,
    stack_near_reconstructed,
    stack_within_spans,
    system_of,
)

HARDENING = RECONSTRUCTED.replace(C2=5.14e5)  # as Table 1 prints it: supercritical
SPRINGS = np.array([5e4, 8.67e4, 2e5])[:, None]  # K_y [N/m], the second parameter of each figure


def answer(system, **options):
    return critical_speeds(system, method="averaging", **options)


def sweep(vehicle, **values):
    """Critical speeds over one parameter, a row for each K_y."""
    return answer(vehicle(RECONSTRUCTED.replace(Ky=SPRINGS, **values)))


def rises(speed):
    return (np.diff(speed, axis=-1) > 0).all()


def falls(speed):
    return (np.diff(speed, axis=-1) < 0).all()


def stays(speed, rel):
    return (np.ptp(speed, axis=-1) <= rel * speed.mean(axis=-1)).all()


# ---------------------------------------------------------------- Fig. 3


@pytest.mark.parametrize(
    ("vehicle", "linear", "nonlinear"),
    [(wheelset, 156.46, 145.09), (bogie, 149.42, 140.03)],
    ids=["wheelset", "bogie"],
)
def test_the_reconstruction_has_the_four_speeds_of_fig_3(vehicle, linear, nonlinear):
    speeds = answer(vehicle(RECONSTRUCTED))
    assert speeds.linear * KMH == pytest.approx(linear, abs=0.005)
    assert speeds.nonlinear * KMH == pytest.approx(nonlinear, abs=0.005)
    assert speeds.criticality == "subcritical"
    assert speeds.windows == []
    assert speeds.message == ""


@pytest.mark.parametrize(
    ("vehicle", "linear", "nonlinear"),
    [(wheelset, 155, 144), (bogie, 151, 140)],
    ids=["wheelset", "bogie"],
)
def test_they_are_within_1_1_percent_of_the_papers(vehicle, linear, nonlinear):
    speeds = answer(vehicle(RECONSTRUCTED))
    assert speeds.linear * KMH == pytest.approx(linear, rel=0.011)
    assert speeds.nonlinear * KMH == pytest.approx(nonlinear, rel=0.011)


@both_vehicles
def test_table_1_as_printed_has_no_critical_speed(vehicle):
    speeds = answer(vehicle(TABLE_1))
    assert np.isnan([speeds.linear, speeds.nonlinear, speeds.amplitude, speeds.frequency]).all()
    assert speeds.criticality == "none"
    assert speeds.message == "no Hopf point in range"
    assert str(speeds) == "no Hopf point in range"


# ---------------------------------------------------------------- Figs. 4 to 14, where they hold


@both_vehicles
def test_a_stiffer_lateral_suspension_hunts_later(vehicle):
    speeds = answer(vehicle(RECONSTRUCTED.replace(Ky=np.geomspace(3e4, 4e5, 12))))
    assert rises(speeds.linear)
    assert rises(speeds.nonlinear)


@both_vehicles
def test_a_heavier_wheelset_hunts_earlier(vehicle):
    """Fig. 4."""
    speeds = sweep(vehicle, m_w=np.linspace(800, 2400, 9))
    assert falls(speeds.linear)
    assert falls(speeds.nonlinear)


@both_vehicles
def test_larger_wheels_hunt_later(vehicle):
    """Fig. 5."""
    speeds = sweep(vehicle, r0=np.linspace(0.4, 0.65, 9))
    assert rises(speeds.linear)
    assert rises(speeds.nonlinear)


@both_vehicles
def test_wider_contact_raises_the_nonlinear_speed_and_narrows_the_gap(vehicle):
    """Fig. 6; that the linear speed falls holds only for a bogie on soft springs."""
    speeds = sweep(vehicle, d=np.linspace(0.55, 0.8, 6))
    assert rises(speeds.nonlinear)
    assert falls(speeds.linear - speeds.nonlinear)
    assert falls(speeds.linear[0]) == (vehicle is bogie)
    assert rises(speeds.linear[1:])


@both_vehicles
def test_a_steeper_conicity_hunts_earlier_and_matters_less_and_less(vehicle):
    """Fig. 7."""
    speeds = sweep(vehicle, lam=np.linspace(0.03, 0.2, 9))
    for speed in (speeds.linear, speeds.nonlinear):
        assert falls(speed)
        assert (np.diff(speed, n=2, axis=-1) > 0).all()


@both_vehicles
def test_the_axle_load_has_next_to_no_effect(vehicle):
    """Fig. 8; with the misprinted load too."""
    speeds = sweep(vehicle, W_A=[1.8e4, 1.0e5, 1.8e5])
    assert stays(speeds.linear, rel=0.005)
    assert stays(speeds.nonlinear, rel=0.005)


def test_more_lateral_damping_lowers_the_nonlinear_speed_of_the_bogie_once_there_is_much():
    """Fig. 9."""
    speeds = sweep(bogie, Cy=np.linspace(3e4, 7e4, 5))
    assert falls(speeds.nonlinear)


def test_lateral_damping_first_raises_then_lowers_the_linear_speed_of_the_bogie():
    """Fig. 9 calls it unpredictable."""
    speeds = answer(bogie(RECONSTRUCTED.replace(Ky=2e5, Cy=np.linspace(5e3, 6e4, 12))))
    peak = speeds.linear.argmax()
    assert rises(speeds.linear[: peak + 1])
    assert falls(speeds.linear[peak:])
    assert 0 < peak < 11


@both_vehicles
def test_a_stiffer_yaw_suspension_hunts_later(vehicle):
    """Fig. 10."""
    speeds = sweep(vehicle, Kpsi=np.geomspace(5e4, 2e5, 9))
    assert rises(speeds.linear)
    assert rises(speeds.nonlinear)


@both_vehicles
def test_a_wider_spring_base_hunts_later(vehicle):
    """Fig. 11; the nonlinear speed turns down beyond b = 1 m on the stiffest springs alone."""
    b = np.linspace(0.7, 1.4, 15)
    speeds = sweep(vehicle, b=b)
    assert rises(speeds.linear)
    assert rises(speeds.nonlinear[:, b <= 0.95])
    assert 1.0 <= b[speeds.nonlinear[2].argmax()] <= 1.15
    assert b[speeds.nonlinear[1].argmax()] > 1.2


@both_vehicles
def test_the_rail_stiffness_has_no_effect(vehicle):
    """Fig. 12."""
    speeds = sweep(vehicle, Kr=np.geomspace(4e6, 1e8, 7))
    assert stays(speeds.linear, rel=1e-12)
    assert stays(speeds.nonlinear, rel=1e-4)


@both_vehicles
def test_a_larger_clearance_lowers_the_nonlinear_speed_alone(vehicle):
    """Fig. 13."""
    speeds = sweep(vehicle, delta=np.linspace(0.005, 0.013, 9))
    assert stays(speeds.linear, rel=1e-12)
    assert falls(speeds.nonlinear)


def test_a_heavier_frame_hunts_a_little_later():
    """Fig. 14; from 15 t on the increase is not small."""
    speeds = sweep(bogie, m_B=np.linspace(15e3, 45e3, 7))
    assert rises(speeds.linear)
    assert rises(speeds.nonlinear)
    assert (speeds.linear[:, -1] < 1.2 * speeds.linear[:, 0]).all()
    assert (speeds.linear[:2, -1] > 1.1 * speeds.linear[:2, 0]).all()


def test_the_bogie_hunts_earlier_than_its_wheelset():
    alone, framed = (answer(v(RECONSTRUCTED)) for v in (wheelset, bogie))
    assert framed.linear < alone.linear
    assert framed.nonlinear < alone.nonlinear


# ---------------------------------------------------------------- what the answer means


@both_vehicles
def test_the_centred_motion_loses_its_stability_at_the_linear_speed(vehicle):
    system = vehicle(RECONSTRUCTED)
    V = answer(system).linear
    below, above = eigenvalues(system, [V * (1 - 1e-6), V * (1 + 1e-6)]).real.max(axis=-1)
    assert below < 0 < above


@both_vehicles
def test_a_supercritical_hopf_point_is_its_own_nonlinear_speed(vehicle):
    speeds = answer(vehicle(HARDENING))
    assert speeds.criticality == "supercritical"
    assert speeds.nonlinear == speeds.linear
    assert speeds.amplitude == 0


@reference_cases(having="averaging")
def test_the_speeds_are_those_of_the_reference(case):
    speeds = answer(system_of(case))
    hunting = case["hopf"][case["branch_hopf_index"]]
    fold = case["averaging"]["fold"] or hunting
    assert speeds.linear == pytest.approx(hunting["speed"], rel=1e-11)
    assert speeds.frequency == pytest.approx(hunting["frequency"], rel=1e-11)
    assert speeds.nonlinear == pytest.approx(fold["speed"], rel=1e-10)


@reference_cases()
def test_windows_are_those_of_the_reference(case):
    below = case["hopf"][: case["branch_hopf_index"]]
    expected = [h["speed"] for h in below]
    windows = answer(system_of(case)).windows
    assert [speed for window in windows for speed in window] == pytest.approx(expected)


@both_vehicles
def test_known_hopf_points_are_taken_as_they_are(vehicle):
    system = vehicle(RECONSTRUCTED)
    assert answer(system, points=hopf_points(system)) == answer(system)
    below = hopf_points(system, speed_range=(1, 30))
    assert answer(system, points=below).criticality == "none"


def test_an_unknown_method_is_refused_by_its_name():
    with pytest.raises(ValueError, match=r"method must be .*'averaging'.*, got 'guess'"):
        critical_speeds(bogie(RECONSTRUCTED), method="guess")


def test_an_answer_reads_as_a_person_would_say_it():
    text = "subcritical: V_nl = 140.03 km/h, V_lin = 149.42 km/h, 2.20 Hz"
    assert str(answer(bogie(RECONSTRUCTED))) == text
    many = answer(bogie(RECONSTRUCTED.replace(Ky=[8e4, 9e4, 1e5])))
    assert str(many) == "critical speeds of 3 systems"


def test_one_system_is_answered_in_numbers():
    speeds = answer(bogie(RECONSTRUCTED.replace(Ky=2e5)))
    for value in (speeds.linear, speeds.nonlinear, speeds.amplitude, speeds.frequency):
        assert type(value) is float
    assert type(speeds.criticality) is type(speeds.message) is str
    ((low, high),) = speeds.windows
    assert 0 < low < high < speeds.nonlinear


# ---------------------------------------------------------------- stacks


@both_vehicles
def test_a_stack_is_answered_as_its_members_are(vehicle):
    p = stack_near_reconstructed(3, 80, seed=7)
    stack = answer(vehicle(p))
    kinds = set()
    for k, q in enumerate(members(p)):
        alone = answer(vehicle(q))
        kinds.add(alone.criticality)
        for name in ("linear", "nonlinear", "frequency"):
            expected = pytest.approx(getattr(alone, name), rel=1e-9, nan_ok=True)
            assert getattr(stack, name)[k] == expected
        assert stack.amplitude[k] == pytest.approx(alone.amplitude, rel=1e-6, nan_ok=True)
        assert stack.criticality[k] == alone.criticality
        assert stack.message[k] == alone.message
        count = len(alone.windows)
        np.testing.assert_allclose(stack.windows[k, :count], np.reshape(alone.windows, (-1, 2)))
        assert np.isnan(stack.windows[k, count:]).all()
    assert {"subcritical", "none"} <= kinds


def test_answers_have_the_shape_of_the_parameters():
    speeds = answer(bogie(RECONSTRUCTED.replace(Ky=SPRINGS, Cy=np.linspace(1e4, 3e4, 4))))
    for values in (
        speeds.linear, speeds.nonlinear, speeds.amplitude, speeds.frequency,
        speeds.criticality, speeds.message,
    ):  # fmt: skip
        assert values.shape == (3, 4)
    assert speeds.windows.shape == (3, 4, 1, 2)


# ---------------------------------------------------------------- an answer for every input


def assert_the_answer_is_sound(system, speeds):
    """Whatever the system, the numbers agree with each other and what is missing is explained."""
    linear, nonlinear, amplitude = speeds.linear, speeds.nonlinear, speeds.amplitude
    criticality, message = np.asarray(speeds.criticality), np.asarray(speeds.message)
    none = np.isnan(linear)
    np.testing.assert_array_equal(none, criticality == "none")
    np.testing.assert_array_equal(none, np.isnan(speeds.frequency))
    assert np.isnan(nonlinear[none]).all()
    assert np.isnan(amplitude[none]).all()
    np.testing.assert_array_equal(np.isnan(nonlinear), message != "")

    above = nonlinear == linear
    assert (criticality[above] == "supercritical").all()
    assert (amplitude[above] == 0).all()
    below = np.isfinite(nonlinear) & ~above
    assert (nonlinear[below] < linear[below]).all()
    assert (nonlinear[below] > 0).all()
    assert (amplitude[below] > 0).all()
    assert (amplitude <= 1.2 * np.asarray(system.clearance))[below].all()

    windows = np.where(np.isnan(speeds.windows), -np.inf, speeds.windows)
    fastest = windows.max(axis=(-2, -1), initial=-np.inf)
    assert (fastest < np.where(none, np.inf, linear)).all()


@both_vehicles
@pytest.mark.parametrize("factor", [2, 10])
@settings(max_examples=60)
@given(data=st.data())
def test_random_systems_get_a_sound_answer(vehicle, factor, data):
    p = data.draw(near_reconstructed(factor))
    system = vehicle(p.replace(m_w=[p.m_w]))
    assert_the_answer_is_sound(system, answer(system))


@both_vehicles
@pytest.mark.parametrize(
    "stack",
    [stack_near_reconstructed(10, 3000, seed=8), stack_within_spans(3000, seed=9)],
    ids=["within a factor of 10", "on the sliders"],
)
def test_so_do_stacks_of_them(vehicle, stack):
    system = vehicle(stack)
    speeds = answer(system)
    assert_the_answer_is_sound(system, speeds)
    assert set(speeds.criticality) == {"none", "subcritical", "supercritical"}
    assert len(set(speeds.message)) >= 4


@both_vehicles
@pytest.mark.parametrize(
    "stack",
    [stack_near_reconstructed(10, 3000, seed=8), stack_within_spans(3000, seed=9)],
    ids=["within a factor of 10", "on the sliders"],
)
def test_a_window_begins_before_it_ends(vehicle, stack):
    windows = answer(vehicle(stack)).windows
    low, high = windows[..., 0], windows[..., 1]
    np.testing.assert_array_equal(np.isnan(low), np.isnan(high))
    assert (low < high)[np.isfinite(low)].all()


def test_a_fold_below_speed_zero_is_not_called_missing():
    """The damper weakens so much that the averaged branch reaches V = 0 before the flange."""
    speeds = answer(wheelset(RECONSTRUCTED.replace(C2=-9e6, C4=0.0, delta=0.02)))
    assert np.isnan([speeds.nonlinear, speeds.amplitude]).all()
    assert "no fold" not in speeds.message


def test_hunting_that_only_ends_is_not_called_no_hopf_point():
    stack = stack_within_spans(300, seed=10)
    points = hopf_points(bogie(stack))
    only_ends = (points.direction < 0).any(axis=-1) & (points.direction <= 0).all(axis=-1)
    assert only_ends.any()
    messages = answer(bogie(stack), points=points).message[only_ends]
    assert "no Hopf point in range" not in messages
