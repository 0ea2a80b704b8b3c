"""The equations of harmonic balance: their derivatives and the integrals of the forces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hunting import RECONSTRUCTED, averaging, limit_cycles
from hunting.harmonic_balance import Balance, Cycles, at_amplitude
from hunting.ports import Ports, orders_up_to, response
from tests.model.subjects import both_vehicles

DELTA = RECONSTRUCTED.delta
AMPLITUDES = pytest.mark.parametrize("Y", [0.4 * DELTA, 1.02 * DELTA], ids=["free", "touching"])


def near_a_cycle(vehicle, Y, harmonics=7):
    """Return the equations, and something near a cycle but off it in every unknown."""
    system = vehicle(RECONSTRUCTED)
    averaged = averaging(system)
    orders = orders_up_to(harmonics)
    balance = Balance(Ports.of(system), averaged.right[0], averaged.left[0], orders)
    branch = limit_cycles(system, [Y], harmonics=harmonics)
    X = branch.harmonics[1:, : len(orders)] / Y
    rng = np.random.default_rng(2)
    U = balance.seen(X) * (1 + 0.02 * rng.standard_normal((1, len(orders), 1)))
    cycles = Cycles(
        U=U,
        kappa=X[:, 0] @ averaged.left[0] * (1 + 0.01j),
        V=branch.speed[1:] * 1.01,
        omega=branch.frequency[1:] * 0.99,
        Y=np.array([Y]),
        tail=np.zeros((1, 0, X.shape[-1]), dtype=complex),
    )
    return balance, cycles


def moved(cycles, unknown, step):
    """Return the cycles with one unknown of `newton_system` moved."""
    _, h, q = cycles.U.shape
    if unknown < 2 * h * q:
        port, k, part = np.unravel_index(unknown, (q, h, 2))
        U = cycles.U.copy()
        U[:, k, port] += step * (1j if part else 1)
        return replace(cycles, U=U)
    unknown -= 2 * h * q
    if unknown < 2:
        return replace(cycles, kappa=cycles.kappa + step * (1j if unknown else 1))
    name = ("V", "omega", "Y")[unknown - 2]
    return replace(cycles, **{name: getattr(cycles, name) + step})


@both_vehicles
@AMPLITUDES
def test_the_jacobian_is_that_of_finite_differences(vehicle, Y):
    balance, cycles = near_a_cycle(vehicle, Y)
    line = at_amplitude(cycles.Y)
    _, jacobian = balance.newton_system(cycles, line)
    for unknown in range(jacobian.shape[-1]):
        step = 1e-8 if unknown == jacobian.shape[-1] - 1 else 1e-6
        ahead, behind = (
            balance.newton_system(moved(cycles, unknown, sign * step), line)[0][0]
            for sign in (1, -1)
        )
        expected = (ahead - behind) / (2 * step)
        scale = max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(jacobian[0, :, unknown], expected, atol=2e-5 * scale)


@both_vehicles
@AMPLITUDES
def test_forces_are_integrated_between_their_kinks(vehicle, Y):
    """A million plain samples come to the same harmonics."""
    balance, cycles = near_a_cycle(vehicle, Y)
    U = balance.motion(cycles)
    answer = response(balance.ports, U, balance.orders, 3)
    theta = (np.arange(1_000_000) + 0.5) * np.pi / 1_000_000
    u = sum(np.outer(np.exp(1j * k * theta), U[0, i]).real for i, k in enumerate(balance.orders))
    force, slope = (part[0] for part in balance.ports.over_time(u[None]))
    for i, k in enumerate(balance.orders):
        expected = 2 * np.mean(force * np.exp(-1j * k * theta)[:, None], axis=0)
        size = np.abs(force).max(axis=0)
        assert (np.abs(answer.F[0, i] - expected) <= 1e-8 * size).all()
    for m in range(3):
        expected = np.mean(slope * np.exp(-2j * m * theta)[:, None], axis=0)
        assert (np.abs(answer.S[0, :, m] - expected) <= 1e-5 * np.abs(slope).max(axis=0)).all()
