"""Floquet multipliers: of a linear system, of half a period integrated step by step, at folds."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hunting import RECONSTRUCTED, limit_cycles
from tests.model.subjects import both_vehicles


@both_vehicles
@pytest.mark.parametrize("share", [0.6, 1.02], ids=["free", "touching"])
def test_multipliers_are_those_of_the_integrated_variational_equation(vehicle, share):
    system = vehicle(RECONSTRUCTED)
    branch = limit_cycles(system, [share * RECONSTRUCTED.delta], harmonics=63)
    V, omega, n = branch.speed[1], branch.frequency[1], len(system.states)
    A = system.matrix(V)

    def rate(t, joined):
        x, Phi = joined[:n], joined[n:].reshape(n, n)
        slope = A.copy()
        for link in system.elements:
            slope = slope + link.B * link.element.slope(link.C @ x) @ link.C
        return np.concatenate([system.derivative(t, x, V), (slope @ Phi).ravel()])

    start = np.concatenate([branch.motion(1).state[0], np.eye(n).ravel()])
    end = solve_ivp(
        rate, (0, np.pi / omega), start, method="LSODA", rtol=1e-9, atol=1e-12, max_step=2e-4
    ).y[:, -1]
    np.testing.assert_allclose(end[:n], -start[:n], atol=2e-6)
    expected = np.sort(np.abs(np.linalg.eigvals(end[n:].reshape(n, n))) ** 2)
    found = np.sort(np.abs(branch.multipliers[1]))
    np.testing.assert_allclose(found, expected, atol=1e-3)


@both_vehicles
def test_small_cycles_have_the_multipliers_of_the_hopf_point(vehicle):
    system = vehicle(RECONSTRUCTED)
    branch = limit_cycles(system, [1e-7])
    modes = np.linalg.eigvals(system.matrix(branch.speed[0]))
    expected = np.sort(np.abs(np.exp(2 * np.pi / branch.frequency[0] * modes)))
    np.testing.assert_allclose(np.sort(np.abs(branch.multipliers[0])), expected, rtol=1e-9)
    np.testing.assert_allclose(np.sort(np.abs(branch.multipliers[1])), expected, atol=1e-4)


@both_vehicles
def test_one_multiplier_is_one_and_at_a_smooth_fold_another(vehicle):
    branch = limit_cycles(vehicle(RECONSTRUCTED.replace(C4=5e8)))
    np.testing.assert_array_equal(branch.multipliers[1:, 0], 1)
    at_fold = np.argmin(branch.speed)
    assert np.abs(branch.multipliers[at_fold, 1:]).max() == pytest.approx(1, abs=1e-4)
