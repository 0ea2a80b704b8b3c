"""The scalar nonlinearities: flange behind its clearance, yaw damper.

An element sees a few combinations u of the states and answers with a few forces; inputs and
outputs are the last axis of its arrays, of length one for both elements here. Its coefficients
may be arrays; they lead that axis. The part that is linear at rest belongs to the matrix A(V) of
the system, so that every element splits its force into ``linear * u + nonlinear(u)``; C1 is counted
once that way (the paper's text counts it twice).
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # real; docstrings give the shapes
Phasor = NDArray[Any]  # complex
Coefficient = float | Array


class Element(Protocol):
    """What averaging, harmonic balance and simulation need to know of a nonlinearity."""

    @property
    def name(self) -> str:
        """What the force is called."""

    @property
    def unit(self) -> str:
        """SI unit of the force."""

    @property
    def linear(self) -> Coefficient:
        """Slope of the force at rest, which the system keeps in A(V)."""

    @property
    def kink(self) -> Coefficient | None:
        """The size |u| at which the law changes: contact. None if it is smooth but at rest."""

    def nonlinear(self, u: Array) -> Array:
        """Force beyond its linear part at rest."""

    def slope(self, u: Array) -> Array:
        """Derivative of `nonlinear`."""

    def describing_function(self, size: Array) -> Array:
        """First harmonic of `nonlinear` per unit amplitude for ``u = size * cos(theta)``."""

    def describing_slope(self, size: Array) -> Array:
        """Derivative of `describing_function` with the amplitude."""

    def with_axes(self, count: int) -> Self:
        """Return the element with `count` axes of length one behind those of its coefficients."""


@dataclass(frozen=True)
class _Scalar:
    """One input, one output; every coefficient a number or an array."""

    def with_axes(self, count: int) -> Self:
        """Return the element with `count` axes of length one behind those of its coefficients."""
        return dataclasses.replace(
            self,
            **{
                f.name: np.reshape(value, np.shape(value) + (1,) * count)
                for f in dataclasses.fields(self)
                if f.name not in ("name", "unit") and np.ndim(value := getattr(self, f.name))
            },
        )


def _on_ports(coefficient: Coefficient) -> Coefficient:
    """Put the axis of the element's inputs behind those of its coefficient."""
    return coefficient[..., None] if isinstance(coefficient, np.ndarray) else coefficient


@dataclass(frozen=True)
class DeadbandSpring(_Scalar):
    """Flange force F_T: a spring of stiffness K_r behind the clearance delta (Eq. 3).

    Parameters
    ----------
    stiffness : float or ndarray
        Rail stiffness K_r [N/m].
    gap : float or ndarray
        Clearance delta [m].

    Examples
    --------
    >>> flange = DeadbandSpring(stiffness=1.617e7, gap=0.00923)
    >>> flange.nonlinear(np.array([[0.009], [0.01]])).ravel()
    array([    0. , 12450.9])
    """

    stiffness: Coefficient
    gap: Coefficient
    name: str = "flange force"
    unit: str = "N"

    linear = 0.0

    @property
    def kink(self) -> Coefficient:
        """The clearance: contact opens and closes there."""
        return self.gap

    def nonlinear(self, u: Array) -> Array:
        """F_T(y) of Eq. 3."""
        delta = _on_ports(self.gap)
        return _on_ports(self.stiffness) * (u - np.clip(u, -delta, delta))

    def slope(self, u: Array) -> Array:
        """K_r in contact, zero within the clearance."""
        return _on_ports(self.stiffness) * (np.abs(u) > _on_ports(self.gap))

    def describing_function(self, size: Array) -> Array:
        """K_r [1 - (2/pi)(asin rho + rho sqrt(1 - rho^2))] with rho = delta/Y; 0 for Y <= delta."""
        rho = self._rho(size)
        inside = np.arcsin(rho) + rho * np.sqrt(1 - rho**2)
        return _on_ports(self.stiffness) * (1 - 2 / np.pi * inside)

    def describing_slope(self, size: Array) -> Array:
        """(4/pi) K_r rho sqrt(1 - rho^2)/Y."""
        rho = self._rho(size)
        Y = np.maximum(size, _on_ports(self.gap))
        return 4 / np.pi * _on_ports(self.stiffness) * rho * np.sqrt(1 - rho**2) / Y

    def _rho(self, size: Array) -> Array:
        delta = _on_ports(self.gap)
        return np.asarray(delta / np.maximum(size, delta))


@dataclass(frozen=True)
class PolynomialDamper(_Scalar):
    """Yaw damper F_d(v) = C1 v + C2 v|v| + C3 v^3 + C4 v^3|v| (Eq. 6, odd in v).

    Parameters
    ----------
    C1, C2, C3, C4 : float or ndarray
        Coefficients [N s/m, N s2/m2, N s3/m3, N s4/m4].

    Examples
    --------
    >>> damper = PolynomialDamper(C1=2.0, C2=-3.0, C3=0.0, C4=1.0)
    >>> float(damper.describing_function(np.array([0.1])).item())  # beyond C1
    -0.25396...
    """

    C1: Coefficient
    C2: Coefficient
    C3: Coefficient
    C4: Coefficient
    name: str = "yaw damper force"
    unit: str = "N"

    kink = None

    @property
    def linear(self) -> Coefficient:
        """C1."""
        return self.C1

    def nonlinear(self, u: Array) -> Array:
        """F_d(v) - C1 v."""
        C2, C3, C4 = self._beyond_C1()
        size = np.abs(u)
        return u * size * (C2 + size * (C3 + size * C4))

    def slope(self, u: Array) -> Array:
        """Derivative of F_d(v) - C1 v."""
        C2, C3, C4 = self._beyond_C1()
        size = np.abs(u)
        return size * (2 * C2 + size * (3 * C3 + size * 4 * C4))

    def describing_function(self, size: Array) -> Array:
        """8 C2 v/(3 pi) + 3/4 C3 v^2 + 32 C4 v^3/(15 pi)."""
        C2, C3, C4 = self._beyond_C1()
        return size * (8 / (3 * np.pi) * C2 + size * (3 / 4 * C3 + size * 32 / (15 * np.pi) * C4))

    def describing_slope(self, size: Array) -> Array:
        """8 C2/(3 pi) + 3/2 C3 v + 32 C4 v^2/(5 pi)."""
        C2, C3, C4 = self._beyond_C1()
        return 8 / (3 * np.pi) * C2 + size * (3 / 2 * C3 + size * 32 / (5 * np.pi) * C4)

    def pushes(self) -> tuple[float, float] | None:
        """Return the lowest speeds at which the force is negative: from where to where.

        There the damper helps the motion that it should brake.

        Returns
        -------
        tuple of float, or None
            Ends of the interval [m/s], the upper one perhaps infinite. None if there is none.

        Examples
        --------
        >>> PolynomialDamper(C1=1.0, C2=-3.0, C3=2.0, C4=0.0).pushes()
        (0.5, 1.0)
        >>> PolynomialDamper(C1=1.0, C2=0.0, C3=0.0, C4=1.0).pushes()
        """
        factors = [float(np.squeeze(c)) for c in (self.C1, self.C2, self.C3, self.C4)]
        roots = np.roots(factors[::-1])
        real = np.sort(roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 0)])
        for low, high in pairwise([0.0, *real.tolist(), np.inf]):
            middle = (low + high) / 2 if np.isfinite(high) else 2 * low + 1.0
            # Over v^3 beyond 1 m/s, where powers of v might overflow.
            terms = (factors[::-1], middle) if middle <= 1 else (factors, 1 / middle)
            if np.polyval(*terms) < 0:
                return low, high
        return None

    def _beyond_C1(self) -> tuple[Coefficient, Coefficient, Coefficient]:
        return _on_ports(self.C2), _on_ports(self.C3), _on_ports(self.C4)
