"""SciPy's Radau on equations of its own that stop at every contact and every turn of the damper.

Between those events the right-hand side is a polynomial, so that Radau's error control holds what
it promises.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from hunting import Parameters

Array = NDArray[np.float64]

RTOL = 1e-10


@dataclass(frozen=True)
class Radau:
    """Motions of a wheelset, with its bogie frame or without, at speed V [m/s].

    With q = (y, psi, z): M q'' + D q' + K q + flange and damper = 0.
    """

    p: Parameters
    V: float
    states: int

    def matrices(self) -> tuple[Array, Array, Array]:
        """Return M, D and K."""
        p, V = self.p, self.V
        s = 1 + p.r0 * p.lam / p.d
        M = np.diag([p.m_w, p.I_wx, p.m_B])
        D = np.array(
            [
                [2 * p.f11 * s / V + 2 * p.Cy, 2 * p.f12 / V, -2 * p.Cy],
                [
                    p.I_wy * V * p.lam / (p.r0 * p.d) - 2 * p.f12 * s / V,
                    2 * (p.d**2 * p.f33 + p.f22) / V + 2 * p.b**2 * p.C1,
                    0,
                ],
                [-2 * p.Cy, 0, 2 * p.Cy],
            ]
        )
        K = np.array(
            [
                [p.W_A * p.lam / p.d + 2 * p.Ky, -2 * p.f11, -2 * p.Ky],
                [
                    2 * p.d * p.lam * p.f33 / p.r0,
                    2 * p.f12 - p.d * p.W_A * p.lam + 2 * p.Kpsi * p.b**2,
                    0,
                ],
                [-2 * p.Ky, 0, 2 * p.Ky],
            ]
        )
        size = self.states // 2
        return M[:size, :size], D[:size, :size], K[:size, :size]

    def phase(self, side: int, turn: int) -> tuple[Callable[..., Array], Callable[..., Array]]:
        """Return x' and its derivative while the flange is at `side` and psi' has sign `turn`.

        The states are y, y', psi, psi', z, z'; `side` is 1, 0 or -1.
        """
        p = self.p
        M, D, K = self.matrices()
        size = len(M)
        A = np.zeros((self.states, self.states))
        A[0::2, 1::2] = np.eye(size)
        A[1::2, 0::2] = -np.linalg.solve(M, K)
        A[1::2, 1::2] = -np.linalg.solve(M, D)
        A[1, 0] -= abs(side) * p.Kr / p.m_w
        push = side * p.Kr * p.delta / p.m_w

        def slope(_: float, x: Array) -> Array:
            v = p.b * x[3]
            out = A @ x
            out[1] += push
            force = turn * p.C2 * v**2 + p.C3 * v**3 + turn * p.C4 * v**4
            out[3] -= 2 * p.b * force / p.I_wx
            return out

        def derivative(_: float, x: Array) -> Array:
            v = p.b * x[3]
            out = A.copy()
            stiff = 2 * turn * p.C2 * v + 3 * p.C3 * v**2 + 4 * turn * p.C4 * v**3
            out[3, 3] -= 2 * p.b**2 * stiff / p.I_wx
            return out

        return slope, derivative

    def motion(self, x: Array, duration: float) -> tuple[Array, Array, Array]:
        """Return the times and the heights of the peaks of |y|, and the last state."""
        t, times, heights = 0.0, [], []
        side = int(np.sign(x[0])) if abs(x[0]) > self.p.delta else 0
        turn = -1 if x[3] < 0 else 1
        while t < duration:
            slope, derivative = self.phase(side, turn)
            found = solve_ivp(
                slope,
                (t, duration),
                x,
                method="Radau",
                rtol=RTOL,
                atol=1e-15,
                jac=derivative,
                events=self._events(side, turn),
            )
            t, x = float(found.t[-1]), found.y[:, -1]
            instants, states = found.t_events or [], found.y_events or []
            times += list(instants[0])
            heights += [abs(state[0]) for state in states[0]]
            _, right, left, swing = (len(times_of) > 0 for times_of in instants)
            if right or left:
                side = 0 if side else 1 if right else -1
            if swing:
                turn = -turn
        later = np.array(times) > 1e-6  # a start at a peak counts none
        return np.array(times)[later], np.array(heights)[later], x

    def _events(self, side: int, turn: int) -> list[Any]:
        """Return the events: peak of |y|, contact on the right and on the left, turn of psi'."""
        delta = self.p.delta
        return [
            _event(lambda x: x[1], 0, stops=False),
            _event(lambda x: x[0] - delta, -1 if side else 1),
            _event(lambda x: x[0] + delta, 1 if side else -1),
            _event(lambda x: x[3], -turn),
        ]

    def multipliers(self, x: Array, period: float) -> NDArray[np.complex128]:
        """Return Floquet multipliers by central differences of the motion over one period."""
        scale = 1e-4 * np.maximum(np.abs(x), 1e-2 * np.abs(x).max())
        columns = []
        for i, step in enumerate(scale):
            aside = np.zeros(len(x))
            aside[i] = step
            ends = [self.motion(x + way * aside, period)[2] for way in (1, -1)]
            columns.append((ends[0] - ends[1]) / (2 * step))
        return np.linalg.eigvals(np.column_stack(columns)).astype(complex)


def _event(
    value: Callable[[Array], float], direction: int, stops: bool = True
) -> Callable[..., float]:
    def event(_: float, x: Array) -> float:
        return float(value(x))

    event.terminal = stops  # type: ignore[attr-defined]
    event.direction = direction  # type: ignore[attr-defined]
    return event
