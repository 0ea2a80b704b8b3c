"""Flange and yaw damper: their laws, slopes and describing functions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from hunting import RECONSTRUCTED, DeadbandSpring, PolynomialDamper

coefficients = st.integers(-(10**6), 10**6).map(float)
springs = st.builds(DeadbandSpring, stiffness=st.floats(1e5, 1e9), gap=st.floats(1e-4, 1e-1))
dampers = st.builds(
    PolynomialDamper, C1=coefficients, C2=coefficients, C3=coefficients, C4=coefficients
)
elements = st.one_of(springs, dampers)


def reach(element):
    """A size of motion that exercises the whole law."""
    return 3 * element.gap if isinstance(element, DeadbandSpring) else 1.5


def at(function, size):
    """Value of an element's function at a number."""
    return function(np.array([size])).item()


@given(element=elements, share=st.floats(-1, 1))
def test_a_force_is_odd(element, share):
    u = share * reach(element)
    assert at(element.nonlinear, -u) == -at(element.nonlinear, u)
    assert at(element.slope, -u) == at(element.slope, u)


@given(elements)
def test_there_is_no_force_at_rest(element):
    assert at(element.nonlinear, 0.0) == 0.0
    assert at(element.slope, 0.0) == 0.0


@given(element=elements, share=st.floats(0.01, 1))
def test_the_describing_function_is_the_first_harmonic_of_the_force(element, share):
    size = share * reach(element)
    kink = element.kink
    corners = [np.pi / 2]  # the force is odd, its law changes where u is 0 and in contact
    if kink is not None and kink < size:
        corners += [np.arccos(kink / size), np.pi - np.arccos(kink / size)]

    def projected(theta):
        return at(element.nonlinear, size * np.cos(theta)) * np.cos(theta)

    largest = np.abs(element.nonlinear(size * np.linspace(0, 1, 50)[:, None])).max() / size
    integral, _ = quad(
        projected, 0, np.pi, points=sorted(corners), epsabs=1e-13 * largest * size, epsrel=1e-11
    )
    assert at(element.describing_function, size) == pytest.approx(
        2 / np.pi * integral / size, rel=1e-10, abs=1e-12 * largest
    )


@given(element=elements, share=st.floats(0.01, 1))
def test_slopes_are_derivatives(element, share):
    size = share * reach(element)
    if element.kink is not None and abs(size / element.kink - 1) < 1e-3:
        size = element.kink * 1.1
    for function, slope in (
        (element.nonlinear, element.slope),
        (element.describing_function, element.describing_slope),
    ):
        h = 1e-4 * size
        difference = (at(function, size + h) - at(function, size - h)) / (2 * h)
        scale = max(abs(at(function, s * size)) for s in (0.25, 0.5, 1.0)) / size
        assert at(slope, size) == pytest.approx(difference, rel=1e-4, abs=1e-4 * scale)


@given(springs)
def test_the_flange_force_is_continuous_at_contact(spring):
    delta = spring.gap
    just_beyond = delta * (1 + 1e-9)
    assert at(spring.nonlinear, delta) == 0.0
    assert at(spring.nonlinear, just_beyond) == pytest.approx(
        spring.stiffness * (just_beyond - delta), rel=1e-6
    )
    assert at(spring.describing_function, delta) == pytest.approx(0.0, abs=1e-9 * spring.stiffness)


@given(spring=springs, share=st.floats(0, 1))
def test_within_the_clearance_the_flange_does_nothing(spring, share):
    y = share * spring.gap
    assert at(spring.nonlinear, y) == at(spring.slope, y) == 0.0
    assert at(spring.describing_slope, y) == 0.0


@given(springs)
def test_a_large_motion_feels_the_bare_rail(spring):
    far = 1e6 * spring.gap
    assert at(spring.describing_function, far) == pytest.approx(spring.stiffness, rel=1e-5)
    assert at(spring.slope, far) == spring.stiffness


@given(spring=springs, shares=st.tuples(st.floats(1, 50), st.floats(1, 50)))
def test_the_flange_stiffens_with_amplitude(spring, shares):
    smaller, larger = (at(spring.describing_function, s * spring.gap) for s in sorted(shares))
    rounding = 1e-15 * spring.stiffness
    assert -rounding <= smaller <= larger + rounding <= spring.stiffness + 2 * rounding


def test_the_linear_damper_coefficient_counts_once():
    damper = PolynomialDamper(C1=5.0, C2=0.0, C3=0.0, C4=0.0)
    assert damper.linear == 5.0
    assert at(damper.nonlinear, 0.3) == 0.0
    assert at(damper.describing_function, 0.3) == 0.0


def test_only_the_flange_has_a_kink_and_no_part_linear_at_rest():
    spring = DeadbandSpring(stiffness=1e7, gap=0.009)
    assert (spring.kink, spring.linear) == (0.009, 0.0)
    p = RECONSTRUCTED
    assert PolynomialDamper(p.C1, p.C2, p.C3, p.C4).kink is None


def test_coefficients_may_be_arrays():
    stiffness, gap = np.array([1e7, 2e7]), np.array([0.009, 0.005])
    spring = DeadbandSpring(stiffness, gap)
    C = np.random.default_rng(1).normal(size=(4, 2))
    damper = PolynomialDamper(*C)
    u = np.array([[0.01], [-0.02]])
    for stack, members in (
        (spring, [DeadbandSpring(k, g) for k, g in zip(stiffness, gap, strict=True)]),
        (damper, [PolynomialDamper(*c) for c in C.T]),
    ):
        for name in ("nonlinear", "slope", "describing_function", "describing_slope"):
            values = getattr(stack, name)(np.abs(u))
            alone = [getattr(m, name)(np.abs(x)) for m, x in zip(members, u, strict=True)]
            np.testing.assert_allclose(values, alone, rtol=1e-14)
        roomy = stack.with_axes(1).nonlinear(u[:, None] * np.ones((1, 3, 1)))
        assert roomy.shape == (2, 3, 1)
        np.testing.assert_array_equal(roomy[:, 0], stack.nonlinear(u))
