"""Floquet multipliers of limit cycles, by half a period of the variational equation.

A symmetric cycle repeats after half a period with the opposite sign, and so do its neighbours: the
multipliers of the whole period are the squares of those of the half. The variational equation is
x' = (A + B s(t) C) x with the slopes s(t) of the elements. It is solved by Radau collocation on
the panels of the half period, which end where contact opens or closes, in the eigenvectors of A:
there the linear part of any stiffness is a division, and what remains are the q ports at the nodes
of a panel.

Eigenvectors come in conjugate pairs v, v* and real ones. What goes in and out of a panel is counted
in the real basis Re v, Im v; a pair's coordinates z, z* are 2 Re z and -2 Im z there.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from hunting.elements import Array, Phasor
from hunting.half_period import NODES, radau_nodes
from hunting.ports import Ports, Response


@cache
def _collocation() -> tuple[Phasor, Phasor, Phasor]:
    """Return the Radau IIA matrix a as P diag(alpha) P^-1: alpha, P and P^-1."""
    nodes, _ = radau_nodes()
    powers = np.arange(NODES)
    vandermonde = nodes[:, None] ** powers
    integrals = nodes[:, None] ** (powers + 1) / (powers + 1)
    alpha, P = np.linalg.eig(integrals @ np.linalg.inv(vandermonde))
    return alpha, P, np.linalg.inv(P)


def half_multipliers(ports: Ports, V: Array, omega: Array, answer: Response) -> Phasor:
    """Return the Floquet multipliers of half a period of M limit cycles, with the sign turned.

    Parameters
    ----------
    ports : Ports
        What the elements see and do.
    V, omega : ndarray, shape (M,)
        Speed [m/s] and angular frequency [rad/s] of each cycle.
    answer : Response
        Panels and slopes of each cycle.

    Returns
    -------
    ndarray, complex, shape (M, n)
        The first one belongs to the motion along the cycle itself and is 1; the squares of all
        are the multipliers of the whole period.

    Notes
    -----
    At a fold a second multiplier meets the trivial one, and two equal eigenvalues split by the
    square root of any error. Their product does not, so the second one is taken as the product.
    """
    modes = np.linalg.eig(ports.system.matrix(V))
    lam, R = modes.eigenvalues.astype(complex), modes.eigenvectors.astype(complex)
    gamma = ports.C[..., :-1, :] @ R
    beta = np.linalg.solve(R, np.broadcast_to(ports.B, (len(V), *ports.B.shape[-2:])))
    steps = np.diff(answer.half.edges) / omega[:, None]
    slopes = answer.slopes.reshape(*steps.shape, NODES, ports.B.shape[-1])
    panels = _panels(lam, gamma, beta, steps, slopes)
    whole: Array = panels[:, 0]
    for i in range(1, panels.shape[1]):
        whole = np.matmul(panels[:, i], whole)
    mu: Phasor = -np.linalg.eigvals(whole).astype(complex)
    mu = np.take_along_axis(mu, np.argsort(np.abs(mu - 1), axis=-1), axis=-1)
    mu[:, 1] *= mu[:, 0]
    mu[:, 0] = 1.0
    return mu


def _panels(lam: Phasor, gamma: Phasor, beta: Phasor, h: Array, s: Array) -> Array:
    """Return the transition matrix of each panel, in the real basis: (M, panels, n, n)."""
    n = lam.shape[-1]
    out = np.zeros((*h.shape, n, n))
    out[..., np.arange(n), np.arange(n)] = 1.0
    ports = np.arange(s.shape[-1])
    pushing = ((s != 0).any(axis=2) << ports).sum(axis=-1)  # one bit a port
    pushing[h <= 0] = -1
    for pattern in np.unique(pushing[h > 0]):
        which = pushing == pattern
        of = np.nonzero(which)[0]
        active = np.flatnonzero(pattern >> ports & 1)
        out[which] = _transitions(
            lam[of], gamma[of][:, active], beta[of][..., active], h[which], s[which][..., active]
        )
    return out


def _transitions(lam: Phasor, gamma: Phasor, beta: Phasor, h: Array, s: Array) -> Array:
    """Return the transition matrices of P panels with q ports at work, shape (P, n, n).

    With stages Z_j of mode j, Z_j = M_j (1 x_j + h a beta_j s W) and M_j = (1 - h lam_j a)^-1,
    the ports' signals W = sum_j gamma_j Z_j obey a real system of the size nodes times q.
    """
    alpha, P, P_inv = _collocation()
    (p, q, n), m = gamma.shape, len(alpha)
    inverse = 1 / (1 - (h[:, None] * lam)[..., None] * alpha)  # (p, n, m)
    started = inverse * P_inv.sum(axis=1)  # P^-1 1
    driven = inverse * (h[:, None, None] * alpha)

    # K[(i, q), (l, r)] = sum_j gamma_qj beta_jr h (M_j a)_il; real, as modes come in pairs.
    pairs = (gamma[:, :, None] * np.swapaxes(beta, -1, -2)[:, None]).reshape(p, q * q, n)
    spread = (P.T[:, :, None] * P_inv[:, None, :]).reshape(m, m * m)
    K = ((pairs @ driven).reshape(-1, m) @ spread).real.reshape(p, q, q, m, m)
    K = (K.transpose(0, 3, 1, 4, 2) * s[:, None, None]).reshape(p, m * q, m * q)

    # Re v sets z = z* = 1/2 going, Im v sets z = -i/2 and z* = i/2.
    leads, size = (lam.imag >= 0)[..., None], np.where(lam.imag == 0, 1.0, 2.0)[..., None]
    free = gamma.swapaxes(-1, -2)[:, :, None] * (started @ P.T)[..., None]
    free = free.reshape(p, n, m * q)
    free = np.where(leads, free.real, -free.imag)
    signals = np.linalg.solve(np.eye(m * q) - K, free.swapaxes(-1, -2))

    push = (driven * P[-1]) @ P_inv  # the last stage is the end of the panel
    push = (push[..., None] * beta[:, :, None] * s[:, None]).reshape(p, n, m * q)
    out: Array = (size * np.where(leads, push.real, push.imag)) @ signals
    passed, mode = started @ P[-1], np.arange(n)
    out[:, mode, mode] += passed.real
    partner = mode + np.sign(lam.imag).astype(int)
    out[np.arange(p)[:, None], mode, partner] += passed.imag
    return out
