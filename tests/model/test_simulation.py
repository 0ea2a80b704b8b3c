"""Motion in time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from hunting import (
    RECONSTRUCTED,
    Connection,
    DeadbandSpring,
    LureSystem,
    PolynomialDamper,
    State,
    averaged_branch,
    bogie,
    decays,
    simulate,
    speed_ramp,
    wheelset,
)
from hunting.collocation import phi_functions
from hunting.crossings import first_crossing
from tests.model.subjects import (
    KMH,
    REFERENCE,
    both_vehicles,
    members,
    near_reconstructed,
    reference_cases,
    stack_near_reconstructed,
    system_of,
)
from verification.radau import Radau

DELTA = RECONSTRUCTED.delta
CONDITIONAL = {wheelset: 147 / KMH, bogie: 142 / KMH}  # between V_nl and V_lin


def on_the_cycle(vehicle, which=0):
    """A speed in the conditional zone and a state on the averaged cycle there: 0 is unstable."""
    speed = CONDITIONAL[vehicle]
    cycle = averaged_branch(vehicle(RECONSTRUCTED)).at_speed(speed)[which]
    return speed, cycle.motion.state[0]


def aside(system, displacement):
    """The state with nothing but a displacement [m]; arrays lead the states."""
    return np.asarray(displacement)[..., None] * system.output


def free_body(*elements, gap=0.01):
    """A mass of 2 kg on no spring at all: the matrix has no basis of eigenvectors."""
    C, B = np.array([[1.0, 0.0]]), np.array([[0.0], [-0.5]])
    rows = {"kink": C, "smooth": np.array([[0.0, 1.0]])}
    zero = np.zeros((2, 2))
    return LureSystem(
        A0=np.array([[0.0, 1.0], [0.0, 0.0]]),
        A1=zero,
        A2=zero,
        elements=tuple(
            Connection(e, C=rows["smooth" if e.kink is None else "kink"], B=B) for e in elements
        ),
        states=(State("displacement", "q", "m"), State("velocity", "v", "m/s")),
        output=C[0],
        clearance=gap,
    )


# ---------------------------------------------------------------- what is known in closed form


@both_vehicles
@pytest.mark.parametrize("samples", [7.0, 200.0, 1234.0])
def test_without_flange_and_damper_motion_is_the_matrix_exponential(vehicle, samples):
    system = replace(vehicle(RECONSTRUCTED), elements=())
    start = np.random.default_rng(1).normal(size=len(system.states)) * 1e-3
    moved = simulate(system, 41.0, start, 1.0, samples=samples)
    some = np.linspace(0, len(moved.time) - 1, 8).astype(int)
    exact = expm(system.matrix(41.0) * moved.time[some, None, None]) @ start
    scale = np.abs(exact).max(axis=0)
    assert np.abs((moved.state[some] - exact) / scale).max() < 1e-10


def test_a_free_body_between_two_rails_bounces_with_the_period_of_flight_and_rebound():
    system = free_body(DeadbandSpring(stiffness=8e5, gap=0.01))
    rebound, flight = np.pi / np.sqrt(8e5 / 2), 0.02 / 0.5
    period = 2 * (rebound + flight)
    moved = simulate(system, 1.0, [0.0, 0.5], 20 * period)
    assert np.diff(moved.crest_time) == pytest.approx(period / 2, rel=1e-6)
    depth = 0.5 / np.sqrt(8e5 / 2)
    assert moved.crest == pytest.approx(0.01 + depth, rel=1e-9)
    assert moved.peak_forces["flange force"] == pytest.approx(8e5 * depth, rel=1e-7)


def test_a_body_between_two_rails_keeps_its_energy():
    system = free_body(DeadbandSpring(stiffness=8e5, gap=0.01))
    moved = simulate(system, 1.0, [0.0, 0.5], 10.0, samples=977)
    q, v = moved.state.T
    depth = np.maximum(np.abs(q) - 0.01, 0)
    energy = v**2 + 4e5 * depth**2
    assert energy == pytest.approx(0.25, rel=1e-6)


def test_a_body_slowed_by_a_quadratic_damper_follows_the_closed_form():
    system = free_body(PolynomialDamper(C1=0.0, C2=3.0, C3=0.0, C4=0.0), gap=100.0)
    moved = simulate(system, 1.0, [[0.0, 0.5], [0.0, -0.5]], 5.0)
    exact = 0.5 / (1 + 0.5 * 1.5 * moved.time)
    assert moved.state[0, :, 1] == pytest.approx(exact, rel=1e-6)
    assert moved.state[1, :, 1] == pytest.approx(-exact, rel=1e-6)


@pytest.mark.parametrize("z", [0.0, 1e-3, -1.49, -1.51, 3j, -40.0 + 5j, -1e3])
def test_phi_functions_are_the_entries_of_a_matrix_exponential(z):
    A = np.diag(np.ones(8, dtype=complex), 1)
    A[0, 0] = z
    assert phi_functions(np.array([z]), 8)[:, 0] == pytest.approx(expm(A)[0], rel=1e-9, abs=1e-14)


def test_a_crossing_between_two_instants_is_found_though_both_lie_below():
    t = np.linspace(0, 1, 5)
    low = 0.001 - (t - 0.4) ** 2  # above zero from 0.368 to 0.432, between 0.25 and 0.5
    assert first_crossing(t, low[None], -2 * (t - 0.4)[None]) == pytest.approx(
        0.4 - np.sqrt(0.001), abs=2e-4
    )


# ---------------------------------------------------------------- against other programs


@pytest.mark.slow
@pytest.mark.parametrize(
    ("vehicle", "share"),
    [(wheelset, 0.9), (bogie, 1.1), (bogie, 1.3)],
    ids=["inside the unstable cycle", "outside", "from within contact"],
)
def test_motions_equal_those_of_radau(vehicle, share):
    speed, cycle = on_the_cycle(vehicle)
    times, heights, end = Radau(RECONSTRUCTED, speed, len(cycle)).motion(share * cycle, 20.0)
    moved = simulate(vehicle(RECONSTRUCTED), speed, share * cycle, 20.0)
    assert moved.peak(since=19.0) == pytest.approx(heights[times >= 19].max(), rel=1e-5)
    assert (np.abs(moved.state[-1] - end) / np.abs(moved.state).max(axis=0)).max() < 1e-4
    close = simulate(vehicle(RECONSTRUCTED), speed, share * cycle, 20.0, tolerance=1e-8)
    assert close.peak(since=19.0) == pytest.approx(heights[times >= 19].max(), rel=1e-7)


@reference_cases(having="fold")
def test_motions_that_start_beside_a_stable_cycle_in_contact_end_on_it(case):
    cycles = [p for p in case["branch"] if p["stable"] and p["amplitude"] > system_gap(case)]
    assert cycles
    system = system_of(case)
    amplitude = np.array([p["amplitude"] for p in cycles])
    speed = np.array([p["speed"] for p in cycles])
    moved = simulate(system, speed, aside(system, amplitude), 60.0)
    # What is left of a disturbance after n periods is the largest multiplier to the n.
    n = 59 * np.array([p["frequency"] / (2 * np.pi) for p in cycles])
    left = np.array([p["multiplier"] for p in cycles]) ** n
    error = np.abs(moved.peak(since=59.0) / amplitude - 1)
    assert (error < 2e-5 + left).all()


def system_gap(case):
    return case["parameters"]["delta"]


def test_elements_that_see_and_push_two_ports_act_on_both():
    @dataclass(frozen=True)
    class Pair:
        """Two cubic dampers in one element."""

        name = "pair"
        unit = "N"
        linear = 0.0
        kink = None

        def nonlinear(self, u):
            return u**3 * np.array([1.0, 3.0])

        def slope(self, u):
            return 3 * u**2 * np.array([1.0, 3.0])

        def with_axes(self, count):
            return self

    zero = np.zeros((4, 4))
    A = np.array([[0, 1, 0, 0], [-40, -0.1, 15, 0], [0, 0, 0, 1], [15, 0, -90, -0.1]], dtype=float)
    C = np.array([[0.0, 1, 0, 0], [0, 0, 0, 1]])
    states = tuple(State(s, s, "m") for s in "abcd")
    pair = Connection(Pair(), C=C, B=-C.T)
    system = LureSystem(A, zero, zero, (pair,), states, np.array([1.0, 0, 0, 0]), 10.0)
    start = np.array([1.0, 0.0, -0.5, 0.0])
    moved = simulate(system, 1.0, start, 10.0, tolerance=1e-7)
    exact = solve_ivp(
        lambda t, x: system.derivative(t, x, 1.0),
        (0, 10),
        start,
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
        t_eval=moved.time,
    )
    assert np.abs(moved.state - exact.y.T).max() < 1e-7


# ---------------------------------------------------------------- what motions do


@both_vehicles
def test_a_disturbance_inside_the_unstable_cycle_dies_out_and_one_outside_grows(vehicle):
    speed, cycle = on_the_cycle(vehicle)
    moved = simulate(vehicle(RECONSTRUCTED), speed, np.outer([0.9, 1.1], cycle), 30.0)
    inside, outside = moved.peak(since=28.0)
    assert inside < 0.9 * cycle[0]
    assert outside > DELTA
    found = decays(vehicle(RECONSTRUCTED), speed, np.outer([0.9, 1.1], cycle), share=0.1)
    assert found.dies_out.tolist() == [True, False]
    assert found.decided.all()


@both_vehicles
def test_a_mirrored_disturbance_gives_the_mirrored_motion(vehicle):
    speed, cycle = on_the_cycle(vehicle)
    one, other = simulate(vehicle(RECONSTRUCTED), speed, [1.2 * cycle, -1.2 * cycle], 5.0).state
    assert one == pytest.approx(-other, abs=1e-14)


def test_a_motion_taken_up_half_way_goes_on_as_before():
    speed, cycle = on_the_cycle(bogie)
    whole = simulate(bogie(RECONSTRUCTED), speed, 1.2 * cycle, 6.0, tolerance=1e-7)
    rest = simulate(bogie(RECONSTRUCTED), speed, whole.state[523], 6 - 523 / 200, tolerance=1e-7)
    assert np.abs(rest.state - whole.state[523:]).max() < 1e-7 * np.abs(whole.state).max()


def test_the_number_of_samples_has_no_bearing_on_the_motion():
    speed, cycle = on_the_cycle(bogie)
    many, few, odd = (
        simulate(bogie(RECONSTRUCTED), speed, 1.2 * cycle, 6.0, samples=samples)
        for samples in (1000, 2, 200 / 7)
    )
    scale = np.abs(many.state).max(axis=0)
    assert np.abs((many.state[::500] - few.state) / scale).max() < 1e-4
    assert odd.time[-1] == 6.0
    assert many.peak(since=1.0) == pytest.approx(few.peak(since=1.0), rel=1e-5)


def test_a_smaller_tolerance_gives_a_smaller_error():
    speed, cycle = on_the_cycle(bogie)
    states = [
        simulate(bogie(RECONSTRUCTED), speed, 1.2 * cycle, 10.0, tolerance=tolerance).state
        for tolerance in (1e-3, 1e-5, 1e-7, 1e-10)
    ]
    errors = [np.abs(state - states[-1]).max() for state in states[:-1]]
    assert errors[0] > 5 * errors[1] > 25 * errors[2]


def test_forces_are_those_of_the_elements_and_peak_where_the_motion_does():
    speed, cycle = on_the_cycle(bogie, which=1)
    moved = simulate(bogie(RECONSTRUCTED), speed, cycle, 5.0)
    system = bogie(RECONSTRUCTED)
    force = system.forces(moved.state)["flange force"]
    assert moved.forces["flange force"] == pytest.approx(force)
    assert set(moved.forces) == set(moved.peak_forces) == {"flange force", "yaw damper force"}
    peak = RECONSTRUCTED.Kr * (moved.peak() - DELTA)
    assert moved.peak_forces["flange force"] == pytest.approx(peak, rel=1e-6)
    assert moved.peak_forces["flange force"] >= force.max()


def test_crests_are_the_extremes_of_the_motion():
    speed, cycle = on_the_cycle(bogie)
    moved = simulate(bogie(RECONSTRUCTED), speed, cycle, 5.0, samples=5000)
    y = np.abs(moved.state[:, 0])
    top = 1 + np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] > y[2:]))
    seen = moved.crest_time > moved.time[1]  # the first one may be closer to the start
    assert moved.crest_time[seen] == pytest.approx(moved.time[top], abs=3e-4)
    assert moved.crest[seen] == pytest.approx(y[top], rel=1e-5)


def test_a_motion_that_runs_away_is_stopped_and_says_so():
    system = wheelset(RECONSTRUCTED)
    start = aside(system, [1e-6, 1.1 * DELTA, 2 * DELTA])
    moved = simulate(system, 200 / KMH, start, 20.0)
    small, large, beyond = moved.message
    assert small == ""
    assert "left the model's range, 1.6 times the clearance" in large
    assert 0 < moved.ended[1] < 20
    assert moved.ended[2] == 0
    assert "after 0.00 s" in beyond
    after = moved.time > moved.ended[1] + 1e-9
    assert np.isnan(moved.state[1, after]).all()
    assert np.isfinite(moved.state[1, ~after]).all()
    assert np.isnan(moved.peak(since=19.0)).tolist() == [False, True, True]


def test_a_motion_that_takes_too_many_steps_is_given_up_and_says_so():
    system = wheelset(RECONSTRUCTED)
    start = aside(system, [0.3 * DELTA, 0.9 * DELTA])
    whole = simulate(system, 150 / KMH, start, 20.0)
    moved = simulate(system, 150 / KMH, start, 20.0, most_steps=100)
    assert whole.message.tolist() == ["", ""]
    assert all(
        "too fast to follow: given up after" in m and "100 steps" in m for m in moved.message
    )
    for k, end in enumerate(moved.ended):
        assert 0 < end < 20
        before = moved.time < end - 1e-9
        assert moved.state[k, before] == pytest.approx(whole.state[k, before], abs=1e-12)
        assert np.isnan(moved.state[k, moved.time > end + 1e-9]).all()
    verdict = decays(system, 150 / KMH, start, most_steps=100)
    assert not verdict.dies_out.any()
    assert "given up" in verdict.message[0]


def test_rest_stays_rest():
    moved = simulate(bogie(RECONSTRUCTED), 60.0, np.zeros(6), 3.0)
    assert not moved.state.any()
    assert moved.peak() == 0


@pytest.mark.parametrize("speed", [0.05, 1.0, 300.0])
def test_slow_and_fast_extremes_of_speed_are_no_trouble(speed):
    system = bogie(RECONSTRUCTED)
    start = aside(system, 1e-12)
    moved = simulate(system, speed, start, 0.5, samples=50)
    linear = expm(system.matrix(speed) * moved.time[:, None, None]) @ start
    assert np.abs(moved.state - linear).max() < 1e-3 * np.abs(linear).max()


# ---------------------------------------------------------------- arrays


def test_leading_axes_equal_a_loop():
    p = stack_near_reconstructed(1.2, 3, seed=4)
    speeds = np.array([[38.0], [44.0]])
    starts = aside(bogie(p), np.array([0.4, 1.0, 1.2]) * np.asarray(p.delta))
    together = simulate(bogie(p), speeds, starts, 4.0)
    assert together.state.shape == (2, 3, 801, 6)
    assert together.peak().shape == together.message.shape == together.ended.shape == (2, 3)
    for j, one in enumerate(members(p)):
        for i, V in enumerate(speeds[:, 0]):
            alone = simulate(bogie(one), V, starts[j], 4.0)
            assert alone.message == together.message[i, j] == ""
            assert alone.state == pytest.approx(together.state[i, j], abs=1e-9)
            assert alone.peak() == pytest.approx(together.peak()[i, j], rel=1e-8)
            for name, force in alone.forces.items():
                assert force == pytest.approx(together.forces[name][i, j], rel=1e-5, abs=1e-2)


def test_a_crowd_of_which_most_have_ended_goes_on_alike():
    system = wheelset(RECONSTRUCTED)
    starts = aside(system, np.append(np.full(30, 2 * DELTA), 0.5 * DELTA))
    crowd = simulate(system, 41.0, starts, 5.0)
    alone = simulate(system, 41.0, starts[-1], 5.0)
    assert (crowd.ended[:-1] == 0).all()
    assert crowd.state[-1] == pytest.approx(alone.state, abs=1e-12)
    assert crowd.peak()[-1] == pytest.approx(alone.peak())


# ---------------------------------------------------------------- does it die out?


def test_below_the_nonlinear_critical_speed_every_disturbance_dies_out():
    starts = aside(bogie(RECONSTRUCTED), np.array([1e-5, 0.3, 0.9, 1.3]) * DELTA)
    found = decays(bogie(RECONSTRUCTED), 130 / KMH, starts)
    assert found.dies_out.all()
    assert found.decided.all()
    for text, seconds in zip(found.message, found.time, strict=True):
        assert text == f"dies out in {seconds:.1f} s"


def test_the_time_to_die_out_follows_from_the_eigenvalue_of_a_small_disturbance():
    system = wheelset(RECONSTRUCTED)
    decay = -np.linalg.eigvals(system.matrix(38.0)).real.max()
    found = decays(system, 38.0, aside(system, 1e-6))
    assert found.dies_out is True
    half_a_period = 0.25
    assert found.time == pytest.approx(np.log(100) / decay, abs=half_a_period)


def test_above_the_linear_critical_speed_no_disturbance_dies_out():
    found = decays(bogie(RECONSTRUCTED), 165 / KMH, aside(bogie(RECONSTRUCTED), [1e-4, 5e-3]))
    assert not found.dies_out.any()
    assert found.decided.all()
    assert np.ptp(found.amplitude) < 1e-4 * DELTA
    assert all("grows into a limit cycle of 9." in text for text in found.message)


def test_what_a_disturbance_settles_into_is_the_stable_cycle_of_the_reference():
    case = next(c for c in REFERENCE if c["name"] == "reconstructed" and c["vehicle"] == "bogie")
    cycle = case["branch"][-1]
    system = system_of(case)
    found = decays(system, cycle["speed"], aside(system, [0.95, 1.1]) * cycle["amplitude"])
    assert found.amplitude == pytest.approx(cycle["amplitude"], rel=1e-4)
    grows, shrinks = found.message
    assert grows.startswith("grows into a limit cycle")
    assert shrinks.startswith("shrinks into a limit cycle")


def test_a_short_horizon_leaves_it_undecided_and_says_so():
    speed, cycle = on_the_cycle(bogie)
    found = decays(bogie(RECONSTRUCTED), speed, 0.98 * cycle, horizon=3.0)
    assert not found.decided
    assert not found.dies_out
    assert np.isnan(found.time)
    assert found.message.startswith("undecided after 3 s: ")


def test_what_shrinks_ever_faster_dies_out_though_the_horizon_comes_first():
    speed, cycle = on_the_cycle(bogie)
    found = decays(bogie(RECONSTRUCTED), speed, 0.8 * cycle, horizon=50.0)
    assert found.dies_out
    assert found.decided
    assert np.isnan(found.time)
    assert found.message.startswith("dies out, but not within 50 s: ")


def test_a_runaway_does_not_die_out():
    system = wheelset(RECONSTRUCTED)
    found = decays(system, 200 / KMH, aside(system, 1.1 * DELTA))
    assert found.decided
    assert not found.dies_out
    assert "left the model's range" in found.message
    assert np.isnan(found.amplitude)


# ---------------------------------------------------------------- ramps


@pytest.mark.slow
@reference_cases(having="fold")
def test_a_ramp_down_loses_the_hunt_within_half_a_km_h_of_the_fold(case):
    fold = KMH * case["fold"]["speed"]
    step = 0.25
    speeds = np.arange(fold - 3.6 * step, fold + 8 * step, step) / KMH
    dwell = 60.0 if case["fold"]["kind"] == "smooth" else 20.0  # about a smooth one all is slow
    found = speed_ramp(system_of(case), speeds, dwell=dwell)
    assert 0 <= KMH * found.jump_down - fold <= 0.5
    assert found.step == pytest.approx(step / KMH)
    assert found.dwell == dwell


def test_a_ramp_up_finds_hunting_at_a_higher_speed_than_a_ramp_down():
    found = speed_ramp(
        wheelset(RECONSTRUCTED), np.arange(142, 163, 2.5) / KMH, dwell=15.0, disturbance=0.3
    )
    V_lin, V_nl = 156.46 / KMH, 143.73 / KMH
    assert found.jump_down == pytest.approx(V_nl, abs=2.5 / KMH)
    assert found.jump_up > found.jump_down + 5 / KMH
    assert found.jump_up < V_lin + 5 / KMH
    between = (found.speed > V_nl + 1) & (found.speed < found.jump_up)
    assert (found.down[between] > DELTA).all()
    assert (found.up[between] < 0.7 * DELTA).all()
    assert found.message == ""


def test_a_ramp_says_why_a_jump_is_missing():
    system = bogie(RECONSTRUCTED)
    too_slow = speed_ramp(system, np.array([100.0, 110.0]) / KMH, dwell=8.0)
    assert np.isnan([too_slow.jump_up, too_slow.jump_down]).all()
    assert too_slow.message == "no hunting at the highest speed"
    too_fast = speed_ramp(system, np.array([175.0, 178.0]) / KMH, dwell=20.0, disturbance=0.5)
    assert np.isnan(too_fast.jump_down)
    assert too_fast.message == "still hunting at the lowest speed"


def test_a_stack_of_systems_ramps_together():
    p = RECONSTRUCTED.replace(C1=[1.9e4, 2.0e4])
    speeds = np.arange(138, 150, 4.0) / KMH
    together = speed_ramp(bogie(p), speeds, dwell=8.0)
    assert together.down.shape == (2, len(speeds))
    alone = speed_ramp(bogie(RECONSTRUCTED.replace(C1=2.0e4)), speeds, dwell=8.0)
    assert together.down[1] == pytest.approx(alone.down, rel=1e-6)
    assert together.jump_down[1] == pytest.approx(alone.jump_down, nan_ok=True)


# ---------------------------------------------------------------- bad input, random input


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"speed": 0.0}, r"speed must be finite and > 0 m/s, got 0\.0"),
        ({"speed": [40.0, np.nan]}, "speed must be finite and > 0 m/s, got nan"),
        ({"initial": [1e-3, 0, 0]}, r"initial must have the 4 states y, y', ψ, ψ' .* \(3,\)"),
        ({"initial": [np.inf, 0, 0, 0]}, "initial must be finite, got inf"),
        ({"speed": [40.0, 41.0], "initial": np.zeros((3, 4))}, r"broadcast, got \(\), \(2,\) and"),
        ({"duration": -1.0}, r"duration must be finite and > 0 s, got -1\.0"),
        ({"samples": 0}, "samples must be finite and > 0 1/s, got 0"),
        ({"tolerance": np.nan}, "tolerance must be finite and > 0, got nan"),
        ({"step": 0.0}, r"step must be finite and > 0 s, got 0\.0"),
        ({"most_steps": 0}, "most_steps must be finite and > 0, got 0"),
        ({"reach": 0.0}, r"reach must be > 0 \(times the clearance\), got 0\.0"),
    ],
)
def test_bad_input_is_named(change, says):
    given_values = {"speed": 40.0, "initial": [1e-3, 0, 0, 0], "duration": 1.0, **change}
    with pytest.raises(ValueError, match=says):
        simulate(wheelset(RECONSTRUCTED), **given_values)


def test_bad_speeds_of_a_ramp_are_named():
    with pytest.raises(ValueError, match="speeds must be rising"):
        speed_ramp(wheelset(RECONSTRUCTED), [41.0, 40.0])
    with pytest.raises(ValueError, match="speeds must be at least two finite speeds > 0 m/s"):
        speed_ramp(wheelset(RECONSTRUCTED), [41.0])


@settings(max_examples=40)
@given(
    near_reconstructed(2),
    st.sampled_from([wheelset, bogie]),
    st.floats(2.0, 90.0),
    st.floats(-1.5, 1.5),
)
def test_every_motion_is_finite_or_says_why_not(p, vehicle, speed, share):
    system = vehicle(p)
    moved = simulate(system, speed, aside(system, share * p.delta), 3.0)
    assert np.isfinite(moved.state).all() or moved.message
    assert np.isfinite(moved.crest).all()
    until = moved.time <= moved.ended
    assert np.isfinite(moved.state[until]).all()
