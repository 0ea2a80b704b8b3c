"""One long step of the motion between two contacts: exponential collocation.

While no contact opens or closes, elements with a kink (the flange) are linear, and the system is
x' = A x + B w(t) + B_c f, with w = phi(C x) from the smooth elements (the damper) and constant
preloads f of the closed contacts. Take w(t) as the polynomial through its values w_j at the Gauss
points of a step; variation of constants is then exact::

    x(t) = exp(A t) x(0) + sum_j w_j integral_0^t exp(A (t - s)) B l_j(s) ds + ...

The creep modes, however stiff, cost nothing, and only the few values of C x at the Gauss points are
left to solve for. In modal coordinates the integrals of the powers of s are phi functions::

    phi_0(z) = exp(z),    phi_{k+1}(z) = (phi_k(z) - 1/k!)/z

See M. Hochbruck and A. Ostermann, Exponential integrators, Acta Numerica 19 (2010), 209-286.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial, prod
from typing import Self

import numpy as np

from hunting.elements import Array, Phasor
from hunting.lure import Connection, LureSystem

STAGES = 8
GAUSS = (np.polynomial.legendre.leggauss(STAGES)[0] + 1) / 2
GRID = np.concatenate([[0.0], GAUSS, [1.0]])  # where a step is looked at

_POWERS = np.linalg.inv(np.vander(GAUSS, increasing=True))  # from values w_j to coefficients
_LEGENDRE = np.polynomial.legendre.legvander(2 * GAUSS - 1, STAGES - 1)
_FACTORIALS = np.array([float(factorial(k)) for k in range(STAGES)])
_SMALL, _TAYLOR = 1.5, 22  # below |z| = 1.5 so many terms give phi to rounding
_INVERSE_FACTORIALS = np.array([1 / factorial(i) for i in range(2 * _TAYLOR)])
_NEAR_REST = 1e-6  # an input that counts as small, in its SI unit
_DEFECTIVE = 1e8  # condition of the eigenvectors beyond which they are no basis


def phi_functions(z: Phasor, order: int) -> Phasor:
    """Return phi_0(z) to phi_order(z), accurate for small and for large z.

    Parameters
    ----------
    z : ndarray, complex
        Arguments.
    order : int
        The highest function.

    Returns
    -------
    ndarray, complex, shape (order + 1, ...)

    Examples
    --------
    >>> phi_functions(np.array([0.0, -1e4]), 2).real
    array([[1.0, 0.0],
           [1.0, 0.0001],
           [0.5, 0.0001]])
    """
    z = np.asarray(z, dtype=complex)
    phi = np.empty((order + 1, *z.shape), dtype=complex)
    small = np.abs(z) < _SMALL
    divisor = np.where(small, 1.0, z)
    phi[0] = np.exp(z)
    for k in range(order):  # loses digits where z is small
        phi[k + 1] = (phi[k] - 1 / factorial(k)) / divisor
    powers = np.empty((_TAYLOR, np.count_nonzero(small)), dtype=complex)
    powers[0], powers[1:] = 1.0, z[small]
    np.multiply.accumulate(powers, out=powers)
    i = np.arange(order + 1)[:, None] + np.arange(_TAYLOR)
    phi[:, small] = _INVERSE_FACTORIALS[i] @ powers
    return phi


def lagrange(theta: Array) -> Array:
    """Return l_j at the instants theta (in steps), shape (..., STAGES)."""
    return theta[..., None] ** np.arange(STAGES) @ _POWERS


@dataclass(frozen=True)
class SortedPorts:
    """The elements of a system side by side: the smooth ones, and contacts (those with a kink).

    Attributes
    ----------
    C, B : ndarray, shape (M, p, n) and (M, n, p)
        What the smooth elements see and where they push, for each of M cases.
    contact_C, contact_B : ndarray, shape (M, c, n) and (M, n, c)
        The same of the contacts.
    watched : ndarray, shape (M, c + p, n)
        C of the contacts, then of the smooth elements.
    kink : ndarray, shape (M, c + p)
        Size of the input at which the law of a port has a kink: where a contact closes; 0 for a
        smooth element whose curvature jumps at rest, infinity for one that is smooth there too.
    bend : ndarray, shape (M, p)
        That jump, halved: the smooth elements' curvature just above zero input.
    stiffness : ndarray, shape (M, 2, c)
        Slope of the law of an open and of a closed contact.
    preload : ndarray, shape (M, c)
        Force of a closed contact extended to zero input.
    """

    C: Array
    B: Array
    contact_C: Array
    contact_B: Array
    watched: Array
    kink: Array
    bend: Array
    stiffness: Array
    preload: Array

    @classmethod
    def of(cls, system: LureSystem, shape: tuple[int, ...]) -> Self:
        """Return the ports of `system` for cases of `shape`, which its own axes broadcast to."""
        n = system.A0.shape[-1]

        def cases(parts: list[Array], axis: int, empty: tuple[int, ...]) -> Array:
            whole = [np.broadcast_to(part, (*shape, *part.shape[-len(empty) :])) for part in parts]
            joined = np.concatenate([np.zeros((*shape, *empty)), *whole], axis=axis)
            return joined.reshape(prod(shape), *joined.shape[len(shape) :])

        smooth = [link for link in system.elements if link.element.kink is None]
        contacts = [link for link in system.elements if link.element.kink is not None]
        kinks, bends, slopes, preloads = [], [], [], []
        for link in contacts:
            kink = np.asarray(link.element.kink)[..., None] * np.ones(link.C.shape[-2])
            beyond = 2 * kink
            slope = link.element.slope(beyond)
            kinks.append(kink)
            slopes.append(np.stack([link.element.slope(0 * kink), slope], axis=-2))
            preloads.append(link.element.nonlinear(beyond) - slope * beyond)
        for link in smooth:
            bend = _curvature_at_rest(link)
            bends.append(bend)
            kinks.append(np.where(bend == 0, np.inf, 0.0))
        return cls(
            C=cases([link.C for link in smooth], -2, (0, n)),
            B=cases([link.B for link in smooth], -1, (n, 0)),
            contact_C=cases([link.C for link in contacts], -2, (0, n)),
            contact_B=cases([link.B for link in contacts], -1, (n, 0)),
            watched=cases([link.C for link in contacts + smooth], -2, (0, n)),
            kink=cases(kinks, -1, (0,)),
            bend=cases(bends, -1, (0,)),
            stiffness=cases(slopes, -1, (2, 0)),
            preload=cases(preloads, -1, (0,)),
        )


def smooth_elements(system: LureSystem, member: Array) -> tuple[Connection, ...]:
    """Return the smooth elements for motions of the members (N,) of a stack of systems.

    They take inputs of shape (N, STAGES, ports).
    """
    each = system.take(member) if system.shape else system
    return tuple(link.with_axes(1) for link in each.elements if link.element.kink is None)


def _curvature_at_rest(link: Connection) -> Array:
    """Return the second derivative of a smooth element's force just above zero input."""
    u = np.full(link.C.shape[-2], _NEAR_REST)
    near, twice = link.element.slope(u) / u, link.element.slope(2 * u) / (2 * u)
    curvature = 2 * near - twice
    return np.where(np.abs(curvature) > 1e-6 * np.abs(near), curvature, 0.0)


def forces(
    smooth: tuple[Connection, ...], u: Array, half: Array, bend: Array
) -> tuple[Array, Array]:
    """Return forces and slopes of the smooth elements, each by one half of its law.

    A law such as v|v| is odd, and its curvature jumps at rest. What jumps, bend u|u|/2, is
    replaced by half bend u^2/2, the law of u > 0 or u < 0 continued to the other side.

    Parameters
    ----------
    smooth : tuple of Connection
        The elements.
    u : ndarray, shape (N, STAGES, p)
        Their inputs.
    half, bend : ndarray, shape (N, p)
        1 or -1, and the curvature just above rest.

    Returns
    -------
    force, slope : ndarray, shape (N, STAGES, p)
    """
    half, bend = half[:, None], bend[:, None]
    off = half * u - np.abs(u)  # zero on the right side
    force, slope = 0.5 * bend * u * off, bend * off
    start = 0
    for link in smooth:
        port = slice(start, start + link.C.shape[-2])
        force[..., port] += link.element.nonlinear(u[..., port])
        slope[..., port] += link.element.slope(u[..., port])
        start = port.stop
    return force, slope


@dataclass(frozen=True)
class Modes:
    """The linear part in modal coordinates zeta = L x, x = Re(R zeta).

    Of a conjugate pair only one mode is kept; R holds it twice.

    Attributes
    ----------
    A : ndarray, shape (M, n, n)
        The matrices.
    packed : ndarray, complex, shape (M, modes, 1 + 2 n + p + c)
        For each mode side by side: its eigenvalue, its column of R, its rows of L, of L B and of
        L B_c.
    """

    A: Array
    packed: Phasor

    @classmethod
    def of(cls, A: Array, ports: SortedPorts) -> Self:
        """Return the modes of the matrices A (M, n, n)."""
        n = A.shape[-1]
        lam, R = (part.astype(complex) for part in np.linalg.eig(A))
        defective = ~(np.linalg.cond(R) < _DEFECTIVE)
        if defective.any():  # move A by about the rounding of its entries
            noise = np.random.default_rng(0).standard_normal((n, n))
            size = np.abs(A[defective]).max(axis=(-2, -1), keepdims=True)
            lam[defective], R[defective] = np.linalg.eig(A[defective] + 1e-13 * size * noise)
        L = np.linalg.inv(R)
        R = R * np.select([lam.imag > 0, lam.imag < 0], [2.0, 0.0], 1.0)[:, None]
        parts = [lam[..., None], np.swapaxes(R, -1, -2), L, L @ ports.B, L @ ports.contact_B]
        kept_first = np.argsort(lam.imag < 0, axis=-1, kind="stable")[..., None]
        packed = np.take_along_axis(np.concatenate(parts, axis=-1), kept_first, axis=-2)
        return cls(A, packed[:, : (lam.imag >= 0).sum(axis=-1).max()])


def states_in_step(
    packed: Phasor, H: Array, x: Array, f: Array, w: Array, t: Array
) -> tuple[Array, Array]:
    """Return states within steps, and their rates.

    Parameters
    ----------
    packed : ndarray, complex, shape (s, modes, ...)
        Modes of each step.
    H : ndarray, shape (s,)
        Lengths of the steps [s].
    x, f, w : ndarray, shape (s, n), (s, c) and (s, STAGES, p)
        States at the start, preloads, and forces of the smooth elements at the stages.
    t : ndarray, shape (s,)
        Instants [s] from the start of each step.

    Returns
    -------
    states, rates : ndarray, shape (s, n)
    """
    n, p = x.shape[-1], w.shape[-1]
    lam, R = packed[..., 0], np.swapaxes(packed[..., 1 : 1 + n], -1, -2)
    L, B, contact_B = np.split(packed[..., 1 + n :], [n, n + p], axis=-1)
    force = B @ np.swapaxes(_POWERS @ w, -1, -2)  # powers of theta
    force[..., 0] += (contact_B @ f[..., None])[..., 0]
    phi = phi_functions(lam * t[:, None], STAGES)
    powers = (t / H)[:, None, None] ** np.arange(STAGES)
    pushed = np.moveaxis(phi[1:], 0, -1) * force * powers * _FACTORIALS
    zeta = phi[0] * (L @ x[..., None])[..., 0] + t[:, None] * pushed.sum(axis=-1)
    rates = lam * zeta + (force * powers).sum(axis=-1)
    both = (R @ np.stack([zeta, rates], axis=-1)).real
    return both[..., 0], both[..., 1]


def step_map(modes: Modes, ports: SortedPorts, H: float, theta: Array) -> Array:
    """Return the linear map from (x, f, w) at the start of a step to the states within it.

    Parameters
    ----------
    modes : Modes
    ports : SortedPorts
    H : float
        Length of the step [s].
    theta : ndarray, shape (T,)
        Instants in units of H.

    Returns
    -------
    ndarray, shape (M, T, n, n + c + STAGES * p)
    """
    n, p = modes.A.shape[-1], ports.C.shape[-2]
    lam, R = modes.packed[..., :1], np.swapaxes(modes.packed[..., 1 : 1 + n], -1, -2)
    L, B, contact_B = np.split(modes.packed[..., 1 + n :], [n, n + p], axis=-1)
    phi = np.swapaxes(phi_functions(lam * H * theta, STAGES), -1, -2)[..., None]
    k = np.arange(STAGES).reshape(-1, 1, 1, 1, 1)
    powers = H * _FACTORIALS[k] * theta[:, None, None] ** (k + 1) * phi[1:]
    stages = np.tensordot(powers[..., 0], _POWERS, axes=(0, 0))[..., None] * B[:, None, :, None]
    columns = [
        phi[0] * L[:, None],
        powers[0] * contact_B[:, None],
        stages.reshape(*stages.shape[:-2], STAGES * p),
    ]
    return (R[:, None] @ np.concatenate(columns, axis=-1)).real


@dataclass(frozen=True)
class Operators:
    """Everything a step of one length needs, as matrices that act on (x, f, w).

    Attributes
    ----------
    free : ndarray, shape (M, STAGES * p, n + c)
        From (x, f) to what the smooth elements see at the stages, without their forces.
    kernel : ndarray, shape (M, STAGES * p, STAGES * p)
        From w to the same.
    view : ndarray, shape (M, rows, n + c + STAGES * p)
        To the state at the end (n rows); what contacts, smooth elements and the output see on
        GRID, and its rates (c + p + 1 times GRID each); the parts of the inputs (2 p rows) that
        stem from the last and the last but one Legendre coefficient of w, the error estimate.
    """

    free: Array
    kernel: Array
    view: Array

    @classmethod
    def of(cls, modes: Modes, ports: SortedPorts, output: Array, H: float) -> Self:
        """Return the operators of steps of H seconds."""
        M, n, _ = modes.A.shape
        p, c = ports.C.shape[-2], ports.contact_C.shape[-2]
        X = step_map(modes, ports, H, GRID)
        columns = X.shape[-1]
        stages = (ports.C[:, None] @ X[:, 1:-1]).reshape(M, STAGES * p, columns)
        free, kernel = stages[..., : n + c], stages[..., n + c :]

        f = np.zeros((c, columns))
        f[:, n : n + c] = np.eye(c)
        w = np.zeros((len(GRID), p, columns))
        w[..., n + c :] = np.kron(lagrange(GRID), np.eye(p)).reshape(len(GRID), p, STAGES * p)
        rates = modes.A[:, None] @ X + ports.B[:, None] @ w + (ports.contact_B @ f)[:, None]
        seen = np.concatenate([ports.watched, np.broadcast_to(output, (M, 1, n))], axis=1)

        response = kernel.reshape(M, STAGES, p, STAGES, p)
        last = np.einsum("mipjq,jk->mkipq", response, _LEGENDRE[:, -2:])
        gain = np.abs(last).max(axis=2)[:, :, :, None]
        coefficient = np.linalg.inv(_LEGENDRE)[-2:, None, :, None]
        error = np.zeros((M, 2 * p, columns))
        error[..., n + c :] = (gain * coefficient).reshape(M, 2 * p, STAGES * p)

        def on_grid(states: Array) -> Array:
            return np.swapaxes(seen[:, None] @ states, 1, 2).reshape(M, -1, columns)

        view = np.concatenate([X[:, -1], on_grid(X), on_grid(rates), error], axis=1)
        return cls(*(np.ascontiguousarray(part) for part in (free, kernel, view)))
