"""All elements of a system as one vector of ports, and what they do over a period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hunting.elements import Array, Phasor
from hunting.half_period import HalfPeriod, half_period, odd_powers, wave
from hunting.lure import LureSystem


@dataclass(frozen=True)
class Ports:
    """All elements of a system as one vector of ports.

    Attributes
    ----------
    C : ndarray, shape (..., q + 1, n)
        What the ports see, and as the last row the output whose peak is the amplitude.
    B : ndarray, shape (..., n, q)
        What the ports' forces do.
    """

    system: LureSystem
    C: Array
    B: Array

    @classmethod
    def of(cls, system: LureSystem) -> Ports:
        """Collect the ports of `system`."""
        n = system.A0.shape[-1]
        rows = [link.C for link in system.elements] + [system.output[None, :]]
        columns = [link.B for link in system.elements]
        lead = np.broadcast_shapes(*(part.shape[:-2] for part in (*rows, *columns)))
        C = np.concatenate([np.broadcast_to(r, (*lead, *r.shape[-2:])) for r in rows], axis=-2)
        B = np.concatenate([np.broadcast_to(b, (*lead, n, b.shape[-1])) for b in columns], axis=-1)
        return cls(system, C, B)

    def take(self, index: Array) -> Ports:
        """Return the ports of the systems `index` of a stack; those of a single system as is."""
        return Ports.of(self.system.take(index)) if self.system.shape else self

    def kinks(self) -> list[Array | float | None]:
        """Return the kink of each port."""
        return [link.element.kink for link in self.system.elements for _ in range(link.C.shape[-2])]

    def over_time(self, u: Array) -> tuple[Array, Array]:
        """Return force (beyond its linear part) and slope of every port, for u (M, times, q)."""
        forces, slopes = np.empty_like(u), np.empty_like(u)
        first = 0
        for link in self.system.elements:
            last = first + link.C.shape[-2]
            element, seen = link.element, u[..., first:last]
            if self.system.shape:
                element = element.with_axes(1)
            forces[..., first:last], slopes[..., first:last] = (
                element.nonlinear(seen),
                element.slope(seen),
            )
            first = last
        return forces, slopes


@dataclass(frozen=True)
class Response:
    """What the ports do in a period.

    Attributes
    ----------
    half : HalfPeriod
        Panels between the kinks of the forces.
    slopes : ndarray, shape (M, times, q)
        Derivative of each force at the nodes.
    F : ndarray, complex, shape (M, h, q)
        Harmonics of the forces, F_k = (2/pi) int_0^pi phi exp(-i k theta).
    S : ndarray, complex, shape (M, q, s)
        Harmonics of the slopes, S_2m = (1/pi) int_0^pi phi' exp(-2 i m theta).
    """

    half: HalfPeriod
    slopes: Array
    F: Phasor
    S: Phasor


def orders_up_to(harmonics: int) -> Array:
    """Return the odd orders 1, 3, ... up to `harmonics`."""
    return np.arange(1, harmonics + 1, 2)


def response(ports: Ports, U: Phasor, orders: Array, slope_orders: int) -> Response:
    """Return the forces and slopes of the ports to the motion U.

    Parameters
    ----------
    ports : Ports
        The ports, their leading axes broadcasting with M.
    U : ndarray, complex, shape (M, h, q)
        What the ports see.
    orders : ndarray, shape (h,)
        Odd orders.
    slope_orders : int
        How many harmonics of the slopes are wanted.

    Returns
    -------
    Response
    """
    half = half_period(U, orders, ports.kinks(), panels=max(6, round(orders[-1] / 5)))
    # z^k for odd k serves the forces, and times z* the even harmonics of the slopes.
    z = wave(-half.theta)
    odd = odd_powers(z, max(slope_orders, len(orders)))
    waves = odd[:, : len(orders)]
    u = (np.swapaxes(waves, -1, -2) @ np.conj(U)).real
    force, slopes = ports.over_time(u)
    weights = half.weights[..., None]
    F = 2 / np.pi * (waves @ (force * weights))
    turned = np.swapaxes(slopes * weights * np.conj(z)[..., None], -1, -2)
    S = 1 / np.pi * (turned @ np.swapaxes(odd[:, :slope_orders], -1, -2))
    return Response(half, slopes, F, S)
