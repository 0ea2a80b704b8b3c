"""Half a period of a symmetric motion, cut into panels at the instants where a force law changes.

Between those instants - the flange touching or leaving the rail, a damper velocity changing its
sign - every force is smooth, so that Gauss-type quadrature and collocation on the panels converge
as if there were no dead band: it is neither smoothed nor sampled over.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import roots_jacobi

from hunting.elements import Array, Coefficient, Phasor

NODES = 8  # on each panel
_SAMPLES = 65  # at which kinks are looked for
_INSIDE = 1e-9  # a panel's last node keeps this share of its width from the kink


@cache
def radau_nodes() -> tuple[Array, Array]:
    """Return nodes and weights of the right Radau rule on [0, 1], its last node being 1."""
    inner, _ = roots_jacobi(NODES - 1, 1, 0)
    nodes = np.append((inner + 1) / 2, 1.0)
    moments = 1 / np.arange(1, NODES + 1)
    weights = np.linalg.solve(np.vander(nodes, NODES, increasing=True).T, moments)
    return nodes, weights


@dataclass(frozen=True)
class HalfPeriod:
    """Panels, nodes and weights over 0 <= theta <= pi for each of M motions.

    Attributes
    ----------
    edges : ndarray, shape (M, panels + 1)
        Ends of the panels [rad]; a panel may have no width.
    theta : ndarray, shape (M, panels * NODES)
        Radau nodes of all panels.
    weights : ndarray, shape (M, panels * NODES)
        Quadrature weights, adding up to pi.
    """

    edges: Array
    theta: Array
    weights: Array

    @property
    def panels(self) -> int:
        """Number of panels."""
        return self.edges.shape[-1] - 1


def half_period(
    U: Phasor, orders: Array, kinks: list[Coefficient | None], panels: int
) -> HalfPeriod:
    """Cut half a period at the kinks of the motions u(theta) = sum_k Re(U_k exp(i k theta)).

    Parameters
    ----------
    U : ndarray, complex, shape (M, h, q)
        Harmonics of what the q ports see.
    orders : ndarray, shape (h,)
        Odd orders k.
    kinks : list of (float, ndarray of shape (M,), or None), length q
        The size of u at which the law of each port changes; None: where u changes sign.
    panels : int
        Number of panels without kinks.

    Returns
    -------
    HalfPeriod
    """
    cuts = _crossings(U, orders, kinks)
    edges = np.empty((len(U), panels + 1 + cuts.shape[-1]))
    edges[:, : panels + 1] = _equal(panels)
    edges[:, panels + 1 :] = cuts
    edges.sort(axis=-1)
    nodes, weights = radau_nodes()
    nodes = np.minimum(nodes, 1 - _INSIDE)
    width = (edges[:, 1:] - edges[:, :-1])[..., None]
    times = (len(U), width.shape[1] * NODES)
    return HalfPeriod(
        edges=edges,
        theta=(edges[:, :-1, None] + width * nodes).reshape(times),
        weights=(width * weights).reshape(times),
    )


def _crossings(U: Phasor, orders: Array, kinks: list[Coefficient | None]) -> Array:
    """Return where the motions cross their kinks in [0, pi], padded with pi.

    Returns
    -------
    ndarray, shape (M, most crossings)
    """
    port = [q for q, kink in enumerate(kinks) for _ in ((0,) if kink is None else (1, -1))]
    levels = np.zeros((len(U), len(port)))
    for q, kink in enumerate(kinks):
        if kink is not None:
            levels[:, port.index(q)], levels[:, port.index(q) + 1] = kink, -kink
    theta, waves = _samples(tuple(orders.tolist()))
    u = np.swapaxes(U[..., port], -1, -2) @ waves
    u = u.real - levels[..., None]
    positive = u > 0
    motion, at, left = np.nonzero(positive[..., :-1] != positive[..., 1:])
    root = _roots(
        U[motion, :, np.take(port, at)],
        waves[:, left].T,
        orders,
        levels[motion, at],
        theta[left],
        u[motion, at, left],
        u[motion, at, left + 1],
    )
    count = np.bincount(motion, minlength=len(u))
    place = np.arange(len(motion)) - (np.cumsum(count) - count)[motion]
    found = np.full((len(u), int(count.max(initial=0))), np.pi)
    found[motion, place] = root
    return found


@cache
def _equal(panels: int) -> Array:
    return np.linspace(0, np.pi, panels + 1)


@cache
def _samples(orders: tuple[int, ...]) -> tuple[Array, Phasor]:
    theta = np.linspace(0, np.pi, _SAMPLES)
    return theta, np.exp(1j * np.outer(orders, theta))


def wave(theta: Array) -> Phasor:
    """Return exp(i theta) by the tangent of the half angle: a fifth of the time of `exp`."""
    x = np.tan(0.5 * theta)
    z = np.empty(theta.shape, dtype=complex)
    share = 2 / (1 + x * x)
    np.subtract(share, 1.0, out=z.real)
    np.multiply(x, share, out=z.imag)
    return z


def odd_powers(z: Phasor, count: int) -> Phasor:
    """Return z, z^3, z^5, ... of z of shape (M, times): shape (M, count, times)."""
    powers = np.empty((len(z), count, z.shape[-1]), dtype=complex)
    powers[:, 0] = z
    known, step = 1, (z * z)[:, None]
    while known < count:
        more = min(known, count - known)
        np.multiply(powers[:, :more], step, out=powers[:, known : known + more])
        known, step = known + more, step * step
    return powers


def _roots(
    U: Phasor,
    waves: Phasor,
    orders: Array,
    level: Array,
    left: Array,
    u_left: Array,
    u_right: Array,
) -> Array:
    """Return the roots of u = sum Re(U_k exp(i k theta)) - level, one sample beyond `left`.

    A parabola through both samples, with the slope at the left one, is near enough even where
    contact has only begun and u all but touches zero; Newton's method does the rest.
    """
    width = np.pi / (_SAMPLES - 1)
    slope = -((U * waves).imag @ orders)
    b = slope * width
    a = u_right - u_left - b
    disc = np.sqrt(np.maximum(b * b - 4 * a * u_left, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        root = left + width * 2 * np.abs(u_left) / (disc - np.copysign(b, u_left * b))
        for _ in range(2):
            terms = U * odd_powers(wave(root)[None], len(orders))[0].T
            root = root + (terms.real.sum(axis=-1) - level) / (terms.imag @ orders)
            root = np.fmax(np.fmin(root, left + width), left)
    return root
