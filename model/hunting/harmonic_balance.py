"""Harmonic balance with the exact dead band, for many limit cycles at once.

A symmetric limit cycle x(t + T/2) = -x(t) has odd harmonics only: x = sum_k Re(X_k exp(i k w t)),
k = 1, 3, ..., N. What the elements see are the harmonics U_k = C X_k, and they answer with F_k(U),
integrated between the instants where their laws change. The equations are::

    X_k = (i k w I - A(V))^-1 B F_k,   U_k = C X_k
    y(0) = Y,  y'(0) = 0               the peak sits at t = 0

The matrix of k = 1 is singular at the Hopf point. It is therefore bordered with the eigenvectors r
and l there: (i w I - A) X_1 + r g = B F_1 and l X_1 = kappa, with kappa as an unknown and g = 0 as
its equation. The unknowns U_k, kappa, V, w and the peak Y are tied by one more equation that says
along which line of the (V, Y) plane the cycle is sought: at given Y, at given V, or between.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from hunting.elements import Array, Phasor
from hunting.ports import Ports, Response, orders_up_to, response

Line = tuple[Array, Array, Array]  # v V + a Y = s

_TOLERANCE = 1e-6  # relative Newton step after which the error is its square
_STEPS = 12
_PATIENCE = 5  # steps that may grow
_TRUST = 0.01  # largest correction by the higher harmonics after which another one is idle
_CORRECTIONS = 6  # tried at most
_AT_ONCE = 125  # cycles: the Jacobians of more do not fit the cache

# Freed at once: glibc's malloc then keeps twice as much for the next arrays, where it would give
# pages back after each Newton step and take new ones before the next, a tenth of a branch's time.
np.empty(31 << 20, dtype=np.uint8)


@dataclass(frozen=True)
class Cycles:
    """M candidates for a limit cycle.

    Attributes
    ----------
    U : ndarray, complex, shape (M, h, q)
        Harmonics of what the ports see, over the amplitude Y.
    kappa : ndarray, complex, shape (M,)
        l X_1 over the amplitude Y.
    V, omega, Y : ndarray, shape (M,)
        Speed [m/s], angular frequency [rad/s], peak displacement [m].
    tail : ndarray, complex, shape (M, t, n)
        Higher harmonics of the states, over Y, which Newton's method leaves as they are: none, or
        as many as are solved for.
    """

    U: Phasor
    kappa: Phasor
    V: Array
    omega: Array
    Y: Array
    tail: Phasor

    def __len__(self) -> int:
        return len(self.V)

    def __getitem__(self, index: Array | slice) -> Cycles:
        return Cycles(*(part[index] for part in vars(self).values()))

    def put(self, index: Array, other: Cycles) -> None:
        """Write `other` over the cycles `index`, in place."""
        for mine, theirs in zip(vars(self).values(), vars(other).values(), strict=True):
            mine[index] = theirs

    def towards(self, other: Cycles, share: Array) -> Cycles:
        """Return the cycles at `share` of the way to `other`."""
        return Cycles(
            *(
                mine + share.reshape(-1, *(1,) * (mine.ndim - 1)) * (theirs - mine)
                for mine, theirs in zip(vars(self).values(), vars(other).values(), strict=True)
            )
        )

    def resized(self, harmonics: int) -> Cycles:
        """Return the cycles with `harmonics` harmonics, new ones being zero, and no tail."""
        if self.U.shape[1] == harmonics:
            return self[np.arange(len(self))]
        U = np.zeros((len(self), harmonics, self.U.shape[-1]), dtype=complex)
        kept = min(harmonics, self.U.shape[1])
        U[:, :kept] = self.U[:, :kept]
        return replace(self, U=U, tail=self.tail[:, :0])


@cache
def _places(count: int) -> tuple[Array, Array, Array]:
    """Return where S_(k-j) and S_(k+j) stand among S_0, S_2, ..., and whether k < j."""
    k = 2 * np.arange(count) + 1
    difference = (k[:, None] - k) // 2
    return np.abs(difference), (k[:, None] + k) // 2, difference < 0


def _force_derivative(S: Phasor, count: int) -> Array:
    """Return dF/dU in real form, shape (M, q, h, 2, 2 h): dF_k = S_(k-j) dU_j + S_(k+j) dU_j*."""
    minus, plus, mirrored = _places(count)
    lower, upper = S[..., minus], S[..., plus]
    np.conj(lower, out=lower, where=mirrored)
    D = np.empty((*S.shape[:2], count, 2, 2 * count))
    D[..., 0, 0::2] = lower.real + upper.real
    D[..., 0, 1::2] = upper.imag - lower.imag
    D[..., 1, 0::2] = lower.imag + upper.imag
    D[..., 1, 1::2] = lower.real - upper.real
    return D


@dataclass(frozen=True)
class Balance:
    """The equations of harmonic balance of one system, or of each of M systems.

    Attributes
    ----------
    ports : Ports
        What the elements see and do.
    right, left : ndarray, complex, shape (n,) or (M, n)
        Eigenvectors r and l at the Hopf point, l r = 1.
    orders : ndarray, shape (h,)
        Odd orders.
    """

    ports: Ports
    right: Phasor
    left: Phasor
    orders: Array

    def take(self, index: Array) -> Balance:
        """Return the equations of the systems `index`; those of a single system as they are."""
        if not self.ports.system.shape:
            return self
        return Balance(self.ports.take(index), self.right[index], self.left[index], self.orders)

    def inverses(self, V: Array, omega: Array) -> Phasor:
        """Return (i k w I - A(V))^-1 for every k, bordered: shape (M, h, n + 1, n + 1)."""
        pencils = _pencils(self.ports.system.matrix(V), omega, self.orders)
        M, h, n, _ = pencils.shape
        out = np.zeros((M, h, n + 1, n + 1), dtype=complex)
        out[:, 0] = np.linalg.inv(self.bordered(pencils[:, 0]))
        out[:, 1:, :n, :n] = np.linalg.inv(pencils[:, 1:])
        out[:, 1:, n, n] = 1.0
        return out

    def bordered(self, pencil: Phasor) -> Phasor:
        """Return i w I - A(V), bordered with the eigenvectors: shape (M, n + 1, n + 1)."""
        M, n, _ = pencil.shape
        out = np.zeros((M, n + 1, n + 1), dtype=complex)
        out[:, :n, :n] = pencil
        out[:, :n, n], out[:, n, :n] = self.right, self.left
        return out

    def states(self, cycles: Cycles, F: Phasor) -> Phasor:
        """Return the harmonics of the states that answer to the forces F, over Y.

        Parameters
        ----------
        cycles : Cycles
            M cycles; of their motions only kappa counts.
        F : ndarray, complex, shape (M, H, q)
            Harmonics of the forces over Y, h or more.

        Returns
        -------
        ndarray, complex, shape (M, H, n)
        """
        pencil = _pencils(self.ports.system.matrix(cycles.V), cycles.omega, np.ones(1))[:, 0]
        push = np.concatenate(
            [self.ports.B @ F[:, 0, :, None], cycles.kappa[:, None, None]], axis=1
        )
        first = np.linalg.solve(self.bordered(pencil), push)[:, None, :-1, 0]
        orders = orders_up_to(2 * F.shape[1] - 1)
        return np.concatenate([first, self._driven(cycles, orders[1:], F[:, 1:])], axis=1)

    def _driven(self, cycles: Cycles, orders: Array, F: Phasor) -> Phasor:
        """Return the harmonics X_k of these orders > 1 that answer to the forces F_k."""
        pencils = _pencils(self.ports.system.matrix(cycles.V), cycles.omega, orders)
        X: Phasor = np.linalg.solve(pencils, self.ports.B[..., None, :, :] @ F[..., None])[..., 0]
        return X

    def tail(self, cycles: Cycles) -> Phasor:
        """Return the higher harmonics of the states that answer to the cycles' forces, over Y."""
        h, Y = len(self.orders), cycles.Y[:, None, None]
        orders = orders_up_to(4 * h - 1)
        F = response(self.ports, self.motion(cycles), orders, 1).F / Y
        return self._driven(cycles, orders[h:], F[:, h:])

    def orders_of(self, cycles: Cycles) -> Array:
        """Return the orders solved for, and those of the tail."""
        return orders_up_to(2 * (len(self.orders) + cycles.tail.shape[1]) - 1)

    def motion(self, cycles: Cycles) -> Phasor:
        """Return all harmonics of what the ports see [SI], shape (M, h + t, q)."""
        U = np.concatenate([cycles.U, self.seen(cycles.tail)], axis=1)
        return U * cycles.Y[:, None, None]

    def seen(self, X: Phasor) -> Phasor:
        """Return what the ports see of the harmonics X of the states, shape (M, h, q)."""
        return X @ np.swapaxes(self.ports.C[..., :-1, :], -1, -2)

    def newton_step(self, cycles: Cycles, line: Line) -> tuple[Array, Array]:
        """Return Newton's step from `cycles`, and the unknowns' change along the branch.

        Parameters
        ----------
        cycles, line
            As for `newton_system`.

        Returns
        -------
        step, along : ndarray, shape (M, N)
            The unknowns in its order.
        """
        M, (h, q) = len(cycles), cycles.U.shape[1:]
        out = np.empty((2, M, 2 * q * h + 5))
        for first in range(0, M, _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            here = self.take(np.arange(M)[part]) if M > _AT_ONCE else self
            r, J = here.newton_system(cycles[part], _some_of(line, part))
            right_sides = np.zeros((*r.shape, 2))
            right_sides[..., 0] = -r
            right_sides[:, -1, 1] = 1.0
            out[:, part] = np.moveaxis(np.linalg.solve(J, right_sides), -1, 0)
        return out[0], out[1]

    def newton_system(self, cycles: Cycles, line: Line) -> tuple[Array, Array]:
        """Return residual and Jacobian at `cycles`.

        Parameters
        ----------
        cycles : Cycles
            M candidates.
        line : tuple of three ndarray, shape (M,)
            The line ``v V + a Y = s`` on which each cycle is sought, as (v, a, s).

        Returns
        -------
        residual : ndarray, shape (M, N)
        jacobian : ndarray, shape (M, N, N)
            Unknowns in order: Re and Im of U_k for each k, port by port; Re kappa, Im kappa, V, w,
            Y. The last equation is the line.
        """
        system, C, B, k = self.ports.system, self.ports.C, self.ports.B, self.orders
        (M, h, q), n = cycles.U.shape, C.shape[-1]
        answer = response(self.ports, self.motion(cycles), self.orders_of(cycles), 2 * h)
        D = _force_derivative(answer.S, h)
        F = answer.F[:, :h] / cycles.Y[:, None, None]
        F_Y = (_times(D, cycles.U) - F) / cycles.Y[:, None, None]

        # X_k and g, and what they do when kappa, V, w, Y and F change.
        T = self.inverses(cycles.V, cycles.omega)
        TB = T[..., :n] @ B[..., None, :, :]
        X = (TB @ F[..., None])[..., 0]
        X[:, 0] += T[:, 0, :, n] * cycles.kappa[:, None]
        dA = system.matrix_slope(cycles.V)[:, None]
        causes = np.empty((M, h, n, 2), dtype=complex)
        causes[..., 0] = (dA @ X[..., :n, None])[..., 0]
        causes[..., 1] = -1j * k[:, None] * X[..., :n]
        effects = np.zeros((M, h, n + 1, 5), dtype=complex)
        effects[:, 0, :, 0] = T[:, 0, :, n]
        effects[:, 0, :, 1] = 1j * T[:, 0, :, n]
        effects[..., 2:4] = T[..., :n] @ causes
        effects[..., 4] = (TB @ F_Y[..., None])[..., 0]
        seen = C[..., None, :, :] @ np.concatenate(
            [X[..., :n, None], effects[..., :n, :], TB[..., :n, :]], axis=-1
        )  # rows: the ports, then the output y
        u, u_by, u_F = seen[:, :, :q, 0], seen[:, :, :q, 1:6], seen[:, :, :q, 6:]
        y, y_by, y_F = seen[:, :, q, 0], seen[:, :, q, 1:6], seen[:, :, q, 6:]
        size = 2 * q * h
        r = np.zeros((M, size + 5))
        J = np.zeros((M, size + 5, size + 5))

        # U_k = C X_k.
        rows = r[:, :size].reshape(M, q, h, 2)
        rows[..., 0] = np.swapaxes(cycles.U.real - u.real, 1, 2)
        rows[..., 1] = np.swapaxes(cycles.U.imag - u.imag, 1, 2)
        by = J[:, :size, size:].reshape(M, q, h, 2, 5)
        by[..., 0, :] = -np.swapaxes(u_by.real, 1, 2)
        by[..., 1, :] = -np.swapaxes(u_by.imag, 1, 2)
        for port in range(q):
            here = J[:, port * 2 * h : (port + 1) * 2 * h, :size]
            _chain(-u_F[:, :, port], D, here.reshape(M, h, 2, q, 2 * h))
        diagonal = np.arange(size)
        J[:, diagonal, diagonal] += 1.0

        # g = 0.
        r[:, size], r[:, size + 1] = X[:, 0, n].real, X[:, 0, n].imag
        J[:, size, size:], J[:, size + 1, size:] = effects[:, 0, n].real, effects[:, 0, n].imag
        _chain(TB[:, :1, n], D[:, :, :1], J[:, size : size + 2, :size].reshape(M, 1, 2, q, 2 * h))

        # The peak: y(0) = Y, y'(0) = 0.
        higher = self.orders_of(cycles)[h:]
        r[:, size + 2] = y.real.sum(axis=1) - 1 + (cycles.tail @ system.output).real.sum(axis=1)
        r[:, size + 3] = y.imag @ k + (cycles.tail @ system.output).imag @ higher
        y_U = np.empty((M, h, 2, q, 2 * h))
        _chain(y_F, D, y_U)
        J[:, size + 2, :size] = y_U[:, :, 0].sum(axis=1).reshape(M, size)
        J[:, size + 3, :size] = k @ y_U[:, :, 1].reshape(M, h, size)
        J[:, size + 2, size:] = y_by.real.sum(axis=1)
        J[:, size + 3, size:] = k @ y_by.imag

        v, a, s = line
        r[:, size + 4] = v * cycles.V + a * cycles.Y - s
        J[:, size + 4, size + 2], J[:, size + 4, size + 4] = v, a
        return r, J


def _pencils(A: Array, omega: Array, orders: Array) -> Phasor:
    """Return i k w I - A for every k, shape (M, h, n, n)."""
    pencils = np.repeat(-A[:, None].astype(complex), len(orders), axis=1)
    diagonal = np.arange(A.shape[-1])
    pencils[..., diagonal, diagonal] += 1j * (omega[:, None] * orders)[..., None]
    return pencils


def _times(D: Array, U: Phasor) -> Phasor:
    """Return the derivative of F along U, shape (M, h, q)."""
    M, h, q = U.shape
    parts = np.stack([U.real, U.imag], axis=-1).transpose(0, 2, 1, 3).reshape(M, q, 1, 2 * h, 1)
    along = np.swapaxes((D @ parts)[..., 0], 1, 2)
    return along[..., 0] + 1j * along[..., 1]


def _chain(G: Phasor, D: Array, out: Array) -> None:
    """Write d(sum_q G_kq F_kq)/dU in real form to `out`, shape (M, h, 2, q, 2 h)."""
    real, imag = D[..., 0, :].swapaxes(1, 2), D[..., 1, :].swapaxes(1, 2)
    G = G[..., None]
    np.multiply(G.real, real, out=out[:, :, 0])
    out[:, :, 0] -= G.imag * imag
    np.multiply(G.imag, real, out=out[:, :, 1])
    out[:, :, 1] += G.real * imag


@dataclass(frozen=True)
class Solution:
    """Limit cycles found by Newton's method.

    Attributes
    ----------
    cycles : Cycles
        The M cycles; meaningless where `converged` is false.
    line : tuple of three ndarray, shape (M,)
        The line ``v V + a Y = s`` each was sought on, as (v, a, s).
    converged : ndarray of bool, shape (M,)
        Whether the last step was negligible.
    V_slope, Y_slope : ndarray, shape (M,)
        dV/ds and dY/ds along the branch.
    """

    cycles: Cycles
    line: Line
    converged: Array
    V_slope: Array
    Y_slope: Array

    def __len__(self) -> int:
        return len(self.converged)

    def __getitem__(self, index: Array | slice) -> Solution:
        return Solution(
            self.cycles[index],
            _some_of(self.line, index),
            self.converged[index],
            self.V_slope[index],
            self.Y_slope[index],
        )

    def put(self, index: Array, other: Solution) -> None:
        """Write `other` over the cycles `index`, in place."""
        self.cycles.put(index, other.cycles)
        for mine, theirs in zip(self.line, other.line, strict=True):
            mine[index] = theirs
        for name in ("converged", "V_slope", "Y_slope"):
            getattr(self, name)[index] = getattr(other, name)

    def copy(self) -> Solution:
        """Return a copy that `put` leaves alone."""
        return self[np.arange(len(self))]

    def joined(self, other: Solution) -> Solution:
        """Return these cycles followed by `other`."""

        def both(mine: Array, theirs: Array) -> Array:
            return np.concatenate([mine, theirs])

        line = tuple(both(*parts) for parts in zip(self.line, other.line, strict=True))
        cycles = zip(vars(self.cycles).values(), vars(other.cycles).values(), strict=True)
        return Solution(
            Cycles(*(both(*parts) for parts in cycles)),
            (line[0], line[1], line[2]),
            both(self.converged, other.converged),
            both(self.V_slope, other.V_slope),
            both(self.Y_slope, other.Y_slope),
        )


def _some_of(line: Line, index: Array | slice) -> Line:
    v, a, s = line
    return v[index], a[index], s[index]


def at_amplitude(Y: Array) -> Line:
    """Return the lines of given peak Y."""
    return np.zeros_like(Y), np.ones_like(Y), Y


def solve(balance: Balance, guess: Cycles, line: Line, tolerance: float = _TOLERANCE) -> Solution:
    """Return the limit cycles next to `guess`, each on its line in the (V, Y) plane.

    Parameters
    ----------
    balance : Balance
        The equations of one system, or of the system of each guess.
    guess : Cycles
        M first guesses.
    line : tuple of three ndarray, shape (M,)
        ``v V + a Y = s`` as (v, a, s).
    tolerance : float, default 1e-6
        Relative Newton step that ends the search.

    Returns
    -------
    Solution
    """
    M = len(guess)
    cycles = guess.resized(len(balance.orders))
    converged = np.zeros(M, dtype=bool)
    V_slope, Y_slope = np.full((2, M), np.nan)
    going, before = np.arange(M), np.full(M, np.inf)
    here = balance  # the equations of those still going
    for step_number in range(_STEPS):
        if len(going) == 0:
            break
        part = cycles[going]
        step, along = here.newton_step(part, _some_of(line, going))
        part, size = _stepped(part, step)
        cycles.put(going, part)
        V_slope[going], Y_slope[going] = along[:, -3], along[:, -1]
        done = size < tolerance
        converged[going[done]] = True
        possible = np.isfinite(size) & (part.V > 0) & (part.omega > 0) & (part.Y > 0)
        shrinks = (step_number < _PATIENCE) | (size < before[going])
        before[going] = size
        still = np.flatnonzero(~done & possible & shrinks)
        if len(still) < len(going):
            going, here = going[still], here.take(still)
    return Solution(cycles, line, converged, V_slope, Y_slope)


def polished(balance: Balance, found: Solution, trust: float = _TRUST) -> Solution:
    """Return the cycles corrected by as many higher harmonics as were solved for.

    The higher harmonics follow from the forces, and a Newton step answers to them: what is left of
    the truncation error is that of twice the harmonics.

    Parameters
    ----------
    balance : Balance
        The equations.
    found : Solution
        Cycles that have converged.
    trust : float, default 0.01
        Largest correction after which another one is idle.

    Returns
    -------
    Solution
        Not converged where the higher harmonics would change the cycle beyond recognition.
    """
    h, n = len(balance.orders), balance.right.shape[-1]
    cycles = replace(found.cycles, tail=np.zeros((len(found), h, n), dtype=complex))
    cycles = cycles[np.arange(len(found))]  # a copy, to be written to
    size = np.full(len(found), np.inf)
    going, here = np.arange(len(found)), balance
    for _ in range(_CORRECTIONS):
        if len(going) == 0:
            break
        part = cycles[going]
        part = replace(part, tail=here.tail(part))
        step, _ = here.newton_step(part, _some_of(found.line, going))
        part, size[going] = _stepped(part, step)
        cycles.put(going, part)
        still = np.flatnonzero((size[going] > trust) & (size[going] < 1) & (part.V > 0))
        if len(still) < len(going):
            going, here = going[still], here.take(still)
    failed = ~(size < trust)
    cycles.put(failed, replace(found.cycles[failed], tail=np.zeros_like(cycles.tail[failed])))
    return replace(found, cycles=cycles, converged=found.converged & ~failed)


def completed(balance: Balance, found: Solution) -> tuple[Response, Phasor]:
    """Return what the ports do in the cycles, and the harmonics of their states.

    Parameters
    ----------
    balance : Balance
        The equations.
    found : Solution
        M cycles, corrected by higher harmonics.

    Returns
    -------
    Response
    ndarray, complex, shape (M, 2 h, n)
        In SI units.
    """
    cycles, Y = found.cycles, found.cycles.Y[:, None, None]
    answer = response(balance.ports, balance.motion(cycles), balance.orders_of(cycles), 1)
    return answer, balance.states(cycles, answer.F / Y) * Y


def _stepped(cycles: Cycles, step: Array) -> tuple[Cycles, Array]:
    """Return the cycles after a Newton step, held to 30 % in V, w and Y, and the step's size."""
    M, h, q = cycles.U.shape
    dU = step[:, :-5].reshape(M, q, h, 2)
    dU = np.swapaxes(dU[..., 0] + 1j * dU[..., 1], 1, 2)
    dkappa = step[:, -5] + 1j * step[:, -4]
    dV, dw, dY = step[:, -3:].T
    relative = np.abs([dV / cycles.V, dw / cycles.omega, dY / cycles.Y]).max(axis=0)
    size = np.maximum(relative, np.abs(dU).max(axis=(-1, -2)))
    share = np.minimum(1.0, 0.3 / np.maximum(relative, 1e-300))
    moved = Cycles(
        cycles.U + share[:, None, None] * dU,
        cycles.kappa + share * dkappa,
        cycles.V + share * dV,
        cycles.omega + share * dw,
        cycles.Y + share * dY,
        cycles.tail,
    )
    return moved, size
