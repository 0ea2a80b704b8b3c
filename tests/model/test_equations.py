"""The equations of motion, written out a second time, and the units of every entry."""

from __future__ import annotations

import re
from math import fsum

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hunting import (
    RECONSTRUCTED,
    Parameters,
    averaged_branch,
    bogie,
    critical_speeds,
    hopf_points,
    wheelset,
)
from tests.model.subjects import FIELDS, VEHICLES, both_vehicles, members, near_reconstructed

# ---------------------------------------------------------------- a transcription


def flange_force(p, y):
    if y > p.delta:
        return p.Kr * (y - p.delta)
    if y < -p.delta:
        return p.Kr * (y + p.delta)
    return 0.0


def damper_force(p, v):
    size = abs(v)
    return p.C1 * v + p.C2 * v * size + p.C3 * v**3 + p.C4 * v**3 * size


def accelerations(p, state, V):
    """Eqs. 1, 4 and 7, corrected: the terms of m_w y'', I_wx psi'' and m_B z'' by themselves."""
    y, vy, psi, vpsi, z, vz = state
    slip = (1 + p.r0 * p.lam / p.d) * vy - V * psi
    lateral = [
        -2 * p.f11 / V * slip,
        -2 * p.f12 / V * vpsi,
        -p.W_A * p.lam / p.d * y,
        -2 * p.Ky * (y - z),
        -2 * p.Cy * (vy - vz),
        -flange_force(p, y),
    ]
    yaw = [
        -p.I_wy * V * p.lam / (p.r0 * p.d) * vy,
        -2 * p.d * p.lam * p.f33 / p.r0 * y,
        2 * p.f12 / V * slip,
        -2 / V * (p.d**2 * p.f33 + p.f22) * vpsi,
        p.d * p.W_A * p.lam * psi,
        -2 * p.Kpsi * p.b**2 * psi,
        -2 * p.b * damper_force(p, p.b * vpsi),
    ]
    frame = [-2 * p.Ky * (z - y), -2 * p.Cy * (vz - vy)]
    return (lateral, p.m_w), (yaw, p.I_wx), (frame, p.m_B)


unit_interval = st.floats(-1, 1)
SIZES = (0.02, 0.5, 0.05, 1.0, 0.02, 0.5)  # beyond the clearance and any damper speed in use
states = st.tuples(*[unit_interval] * 6).map(
    lambda shares: tuple(share * size for share, size in zip(shares, SIZES, strict=True))
)


@given(p=near_reconstructed(10), state=states, V=st.floats(1, 400))
def test_the_bogie_moves_as_the_corrected_equations_say(p, state, V):
    y, vy, psi, vpsi, z, vz = state
    rates = bogie(p).derivative(0.0, state, V)
    assert rates[[0, 2, 4]].tolist() == [vy, vpsi, vz]
    for rate, (forces, inertia) in zip(rates[1::2], accelerations(p, state, V), strict=True):
        # The slip is a difference: near pure rolling only its two parts set the rounding.
        scale = sum(map(abs, forces)) + 4 * (p.f11 + p.f12) * (abs(vy) / V + abs(psi))
        scale += 4 * p.Ky * (abs(y) + abs(z)) + 4 * p.Cy * (abs(vy) + abs(vz))
        assert abs(rate * inertia - fsum(forces)) <= 1e-13 * scale


@given(p=near_reconstructed(10), state=states, V=st.floats(1, 400))
def test_the_wheelset_moves_like_the_bogie_with_its_frame_held_still(p, state, V):
    alone = wheelset(p)
    rates = alone.derivative(0.0, state[:4], V)
    held = bogie(p).derivative(0.0, (*state[:4], 0.0, 0.0), V)[:4]
    rounding = 1e-14 * (np.abs(alone.matrix(V)) @ np.abs(state[:4]))
    assert (np.abs(rates - held) <= rounding).all()


@both_vehicles
@given(p=near_reconstructed(10), shares=st.tuples(*[unit_interval] * 6))
def test_a_mirrored_motion_is_a_motion(vehicle, p, shares):
    system = vehicle(p)
    x = np.array(shares[: len(system.states)])
    np.testing.assert_array_equal(
        system.derivative(0.0, -x, 40.0), -system.derivative(0.0, x, 40.0)
    )


@both_vehicles
def test_forces_are_those_of_the_two_elements(vehicle):
    system = vehicle(RECONSTRUCTED)
    x = np.zeros((3, len(system.states)))
    x[:, 0] = 0.005, 0.01, -0.01
    x[:, 3] = 0.2, -0.6, 0.0
    forces = system.forces(x)
    assert set(forces) == {"flange force", "yaw damper force"}
    p = RECONSTRUCTED
    np.testing.assert_allclose(forces["flange force"], [flange_force(p, y) for y in x[:, 0]])
    np.testing.assert_allclose(
        forces["yaw damper force"], [damper_force(p, p.b * v) for v in x[:, 3]]
    )


def test_the_reconstructed_damper_pushes_the_wrong_way_between_0_021_and_0_41_m_per_s():
    for v, sign in ((0.020, 1), (0.022, -1), (0.40, -1), (0.42, 1)):
        assert np.sign(damper_force(RECONSTRUCTED, v)) == sign


@both_vehicles
def test_the_slope_of_the_matrix_is_its_derivative(vehicle):
    system, V, h = vehicle(RECONSTRUCTED), 40.0, 1e-3
    difference = (system.matrix(V + h) - system.matrix(V - h)) / (2 * h)
    np.testing.assert_allclose(system.matrix_slope(V), difference, rtol=1e-8, atol=1e-7)


# ---------------------------------------------------------------- arrays


@both_vehicles
def test_a_stack_moves_as_its_members_do(vehicle):
    p = RECONSTRUCTED.replace(Ky=[5e4, 9e4, 2e5], delta=[0.005, 0.009, 0.02], b=[0.8, 1.0, 1.2])
    stack = vehicle(p)
    n = len(stack.states)
    x = np.linspace(-0.02, 0.03, n)
    V = np.array([20.0, 40.0, 60.0])
    alone = [vehicle(q).derivative(0.0, x, v) for q, v in zip(members(p), V, strict=True)]
    np.testing.assert_allclose(stack.derivative(0.0, x, V), alone, rtol=1e-14)
    assert stack.shape == (3,)
    forces = stack.forces(x)
    for name, values in forces.items():
        np.testing.assert_allclose(values, [vehicle(q).forces(x)[name] for q in members(p)])


@both_vehicles
def test_axes_of_parameters_lead_those_of_the_matrix(vehicle):
    p = RECONSTRUCTED.replace(Ky=np.linspace(5e4, 2e5, 3)[:, None], m_B=np.linspace(2e4, 5e4, 4))
    system = vehicle(p)
    n = len(system.states)
    assert system.A0.shape == system.A1.shape == system.A2.shape == (3, 4, n, n)
    assert system.matrix(np.full(4, 30.0)).shape == (3, 4, n, n)
    one = vehicle(RECONSTRUCTED.replace(Ky=float(p.Ky[2, 0]), m_B=float(p.m_B[1])))
    np.testing.assert_array_equal(system.matrix(30.0)[2, 1], one.matrix(30.0))


@both_vehicles
def test_room_for_speeds_is_made_behind_the_stack(vehicle):
    system = vehicle(RECONSTRUCTED.replace(Ky=[5e4, 9e4, 2e5], delta=[0.005, 0.009, 0.02]))
    n = len(system.states)
    speeds = np.linspace(10, 50, 5)
    roomy = system.with_axes()
    assert roomy.matrix(speeds).shape == (3, 5, n, n)
    x = np.full(n, 0.015)
    rates = roomy.derivative(0.0, x, speeds)
    for j, V in enumerate(speeds):
        np.testing.assert_allclose(rates[:, j], system.derivative(0.0, x, V), rtol=1e-14)


# ---------------------------------------------------------------- units

BASE = {"kg": (1, 0, 0), "m": (0, 1, 0), "s": (0, 0, 1), "N": (1, 1, -2), "rad": (0, 0, 0)}
POWERS = {"": 1, "²": 2, "³": 3, "⁴": 4}


def exponents(unit):
    """Return the powers of mass, length and time in a unit such as "N s²/m²"."""
    total = np.zeros(3, dtype=int)
    for sign, part in zip((1, -1), unit.split("/"), strict=False):
        for factor in part.split():
            symbol, power = re.fullmatch(r"([a-zA-Z]+)([²³⁴]?)", factor).groups()
            total += sign * POWERS[power] * np.array(BASE[symbol])
    return total


scales = st.tuples(*[st.floats(0.2, 5)] * 3).map(np.array)


def in_other_units(p, scale):
    """Return the same vehicle with mass, length and time counted in units of 1/scale."""
    return Parameters(
        **{f.name: getattr(p, f.name) * np.prod(scale ** exponents(f.unit)) for f in FIELDS}
    )


def test_units_are_read_as_they_are_meant():
    assert exponents("N s²/m²").tolist() == [1, -1, 0]
    assert exponents("rad/s").tolist() == [0, 0, -1]
    assert exponents("kg m²").tolist() == [1, 2, 0]


@both_vehicles
@given(p=near_reconstructed(2), scale=scales)
def test_every_matrix_entry_has_the_units_of_its_row_and_column(vehicle, p, scale):
    system, rescaled = vehicle(p), vehicle(in_other_units(p, scale))
    state = np.array([np.prod(scale ** exponents(s.unit)) for s in system.states])
    speed, time = scale[1] / scale[2], scale[2]
    entry = state[:, None] / state / time
    for name, power in (("A0", 0), ("A1", 1), ("A2", -1)):
        expected = getattr(system, name) * entry * speed**power
        np.testing.assert_allclose(getattr(rescaled, name), expected, rtol=1e-12)


@both_vehicles
@given(p=near_reconstructed(2), scale=scales)
def test_every_element_has_the_units_of_its_states(vehicle, p, scale):
    system, rescaled = vehicle(p), vehicle(in_other_units(p, scale))
    state = np.array([np.prod(scale ** exponents(s.unit)) for s in system.states])
    x = np.array(SIZES[: len(state)])

    def pushes(system, x):
        return [link.B @ link.element.nonlinear(link.C @ x) for link in system.elements]

    for push, other in zip(pushes(system, x), pushes(rescaled, state * x), strict=True):
        assert other == pytest.approx(push * state / scale[2], rel=1e-12, abs=0)
    for link in rescaled.elements:
        force = rescaled.forces(state * x)[link.element.name]
        expected = system.forces(x)[link.element.name]
        unit = np.prod(scale ** exponents(link.element.unit))
        assert force == pytest.approx(expected * unit, rel=1e-10)


@both_vehicles
@given(scale=scales)
def test_dimensionless_results_do_not_depend_on_the_units(vehicle, scale):
    _, length, time = scale
    speed = length / time
    system, rescaled = vehicle(RECONSTRUCTED), vehicle(in_other_units(RECONSTRUCTED, scale))
    points = hopf_points(system)
    others = hopf_points(rescaled, speed_range=(1 * speed, 400 * speed))
    assert others.speed == pytest.approx(points.speed * speed, rel=1e-11)
    assert others.frequency == pytest.approx(points.frequency / time, rel=1e-11)

    answer, other = (
        critical_speeds(s, "averaging", points=q) for s, q in ((system, points), (rescaled, others))
    )
    # Eigenvectors carry the rounding of the fast creep modes, which depends on the units.
    assert other.nonlinear == pytest.approx(answer.nonlinear * speed, rel=1e-9)
    assert other.amplitude == pytest.approx(answer.amplitude * length, rel=1e-9)

    branch, other = averaged_branch(system), averaged_branch(rescaled, points=others)
    np.testing.assert_allclose(other.speed, branch.speed * speed, rtol=1e-9)
    np.testing.assert_allclose(other.frequency, branch.frequency / time, rtol=1e-9)


# ---------------------------------------------------------------- limits


def test_the_wheelset_is_the_bogie_with_an_infinitely_heavy_frame():
    mass = 10.0 ** np.arange(6, 10)
    alone = hopf_points(wheelset(RECONSTRUCTED))
    heavy = hopf_points(bogie(RECONSTRUCTED.replace(m_B=mass)))
    last = heavy.hunting_index()[:, None]
    gap = alone.speed[0] - np.take_along_axis(heavy.speed, last, axis=-1)[:, 0]
    np.testing.assert_allclose(gap[:-1] / gap[1:], 10, rtol=0.02)  # first order in 1/m_B
    assert abs(gap[-1]) < 1e-3

    nonlinear = critical_speeds(bogie(RECONSTRUCTED.replace(m_B=mass)), "averaging").nonlinear
    gap = critical_speeds(wheelset(RECONSTRUCTED), "averaging").nonlinear - nonlinear
    np.testing.assert_allclose(gap[:-1] / gap[1:], 10, rtol=0.02)


def test_the_frame_mass_means_nothing_to_the_wheelset():
    light, heavy = (wheelset(RECONSTRUCTED.replace(m_B=m)) for m in (1e3, 1e6))
    np.testing.assert_array_equal(light.matrix(40.0), heavy.matrix(40.0))


def test_both_vehicles_name_their_states():
    symbols = {
        name: [s.symbol for s in vehicle(RECONSTRUCTED).states]
        for name, vehicle in VEHICLES.items()
    }
    assert symbols["wheelset"] == ["y", "y'", "ψ", "ψ'"]
    assert symbols["bogie"] == ["y", "y'", "ψ", "ψ'", "z", "z'"]
