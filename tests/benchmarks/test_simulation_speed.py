"""How fast motions are simulated, beside a loop of SciPy's LSODA that is as accurate."""

from __future__ import annotations

import time

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hunting import RECONSTRUCTED, averaging, bogie, simulate

P = RECONSTRUCTED
SYSTEM = bogie(P)
DURATION = 20.0  # s
ASKED = 1e-4  # relative error of the peak displacement in the last second
RTOL = 1e-7  # the loosest power of ten at which LSODA is that accurate, too

# On the mode that becomes unstable, from small to hard in contact, below the fold and up to V_lin.
SPEEDS = np.linspace(37.0, 41.4, 100)
SHARES = np.random.default_rng(0).uniform(0.3, 1.05, 100)
STATES = SHARES[:, None] * P.delta * averaging(SYSTEM).right[0].real


def hand_written(V):
    """The equations of motion, for one motion at a time, with nothing that costs time."""
    A = SYSTEM.matrix(V)
    stiffness, damping = P.Kr / P.m_w, 2 * P.b / P.I_wx

    def derivative(_, x):
        rates = A @ x
        y = x[0]
        if y > P.delta:
            rates[1] -= stiffness * (y - P.delta)
        elif y < -P.delta:
            rates[1] -= stiffness * (y + P.delta)
        v = P.b * x[3]
        size = abs(v)
        rates[3] -= damping * v * size * (P.C2 + size * (P.C3 + size * P.C4))
        return rates

    return derivative


def lsoda(i, rtol=RTOL, method="LSODA", duration=DURATION):
    times = np.linspace(0, duration, round(200 * duration) + 1)
    found = solve_ivp(
        hand_written(SPEEDS[i]),
        (0, duration),
        STATES[i],
        method=method,
        rtol=rtol,
        atol=1e-3 * rtol,
        t_eval=times,
    )
    return found.y.T


def at_once(**options):
    return simulate(SYSTEM, SPEEDS, STATES, DURATION, **options)


def seconds(function):
    start = time.perf_counter()
    function()
    return time.perf_counter() - start


def errors(states, exact):
    """Relative errors of the largest |y| among the samples of the last second."""
    peak, truth = (np.abs(part[:, -201:, 0]).max(axis=1) for part in (states, exact))
    return np.abs(peak / truth - 1)


@pytest.mark.benchmark(group="simulation")
def test_a_hundred_motions_of_20_s(benchmark, report):
    moved = benchmark.pedantic(at_once, rounds=5, warmup_rounds=1)
    assert not moved.message.any()

    exact = at_once(tolerance=1e-9, step=0.01).state
    loop, found = 0.0, []
    for i in range(len(SPEEDS)):
        start = time.perf_counter()
        found.append(lsoda(i))
        loop += time.perf_counter() - start
    mine = np.median([seconds(at_once) for _ in range(5)])
    error, its_error = errors(moved.state, exact), errors(np.array(found), exact)
    report(
        f"100 motions of 20 s: {mine:.2f} s, LSODA in a loop {loop:.1f} s, {loop / mine:.0f} times "
        f"as long (at least 20); error of the peak {error.max():.0e}, LSODA's {its_error.max():.0e}"
    )
    assert error.max() <= its_error.max() <= ASKED
    assert loop >= 20 * mine


@pytest.mark.benchmark(group="simulation")
def test_the_motion_of_a_click(benchmark, report):
    i = 70

    def click():
        return simulate(SYSTEM, SPEEDS[i], STATES[i], 10.0)

    benchmark(click)
    mine = np.median([seconds(click) for _ in range(5)])
    yardstick = np.median([seconds(lambda: lsoda(i, duration=10.0)) for _ in range(5)])
    report(
        f"one motion of 10 s: {mine:.3f} s, {mine / yardstick:.2f} of LSODA's time "
        "(0.5 s until it is on screen)"
    )
    assert mine <= yardstick
