"""A vehicle as a Lur'e system: x' = A(V) x + sum_k B_k phi_k(C_k x).

The matrix depends on the forward speed as A(V) = A0 + A1/V + A2 V: creep forces fall with speed,
gyroscopic ones grow. Nothing behind this file knows how many states there are or what they are
called.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from hunting.elements import Array, Element


@dataclass(frozen=True)
class State:
    """Name, symbol and SI unit of one state."""

    name: str
    symbol: str
    unit: str


@dataclass(frozen=True)
class Connection:
    """An element and where it sits: it sees C x and pushes with B.

    Attributes
    ----------
    element : Element
        The nonlinearity.
    C : ndarray, shape (..., p, n)
        What it sees of the states.
    B : ndarray, shape (..., n, q)
        What its forces do to the states.
    """

    element: Element
    C: Array
    B: Array

    def with_axes(self, count: int) -> Self:
        """Return the connection with `count` axes of length one before the matrix axes."""
        return dataclasses.replace(
            self,
            element=self.element.with_axes(count),
            C=_with_axes(self.C, count),
            B=_with_axes(self.B, count),
        )


@dataclass(frozen=True)
class LureSystem:
    """Linear part, nonlinear elements and names of a vehicle.

    Attributes
    ----------
    A0, A1, A2 : ndarray, shape (..., n, n)
        A(V) = A0 + A1/V + A2 V. The leading axes are those of the parameters. The slope of each
        element at rest is part of A0.
    elements : tuple of Connection
        The nonlinearities beyond that slope.
    states : tuple of State
        Names of the n states.
    output : ndarray, shape (n,)
        The combination of states whose peak is called *amplitude*: the wheelset's lateral
        displacement y.
    clearance : float or ndarray
        The amplitude at which the flange touches, delta [m].
    """

    A0: Array
    A1: Array
    A2: Array
    elements: tuple[Connection, ...]
    states: tuple[State, ...]
    output: Array
    clearance: float | Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the stack of systems; ``()`` for a single one."""
        return self.A0.shape[:-2]

    @property
    def symbols(self) -> list[str]:
        """Symbols of the n states."""
        return [state.symbol for state in self.states]

    def matrix(self, V: ArrayLike) -> Array:
        """Return A(V).

        Parameters
        ----------
        V : array_like
            Forward speed [m/s], > 0; broadcasts with the leading axes of the system.

        Returns
        -------
        ndarray, shape (..., n, n)
        """
        V = np.asarray(V, dtype=float)[..., None, None]
        return self.A0 + self.A1 / V + self.A2 * V

    def matrix_slope(self, V: ArrayLike) -> Array:
        """Return dA/dV [shape as `matrix`]."""
        V = np.asarray(V, dtype=float)[..., None, None]
        return self.A2 - self.A1 / V**2

    def derivative(self, t: float, x: ArrayLike, V: ArrayLike) -> Array:
        """Return x', the right-hand side of the equations of motion.

        Parameters
        ----------
        t : float
            Time [s]; the system does not depend on it.
        x : array_like, shape (..., n)
            States.
        V : array_like
            Forward speed [m/s].

        Returns
        -------
        ndarray, shape (..., n)
        """
        x = np.asarray(x, dtype=float)[..., None]
        xdot = self.matrix(V) @ x
        for link in self.elements:
            xdot = xdot + link.B @ link.element.nonlinear((link.C @ x)[..., 0])[..., None]
        return xdot[..., 0]

    def forces(self, x: ArrayLike) -> dict[str, Array]:
        """Return the whole force of each element, its linear part included.

        Parameters
        ----------
        x : array_like, shape (..., n)
            States.

        Returns
        -------
        dict of str to ndarray, shape (...)
            By the element's name, in its unit.
        """
        x = np.asarray(x, dtype=float)[..., None]
        forces = {}
        for link in self.elements:
            u = (link.C @ x)[..., 0]
            linear = np.asarray(link.element.linear)[..., None]
            forces[link.element.name] = (linear * u + link.element.nonlinear(u))[..., 0]
        return forces

    def with_axes(self, count: int = 1) -> Self:
        """Return the system with `count` axes of length one behind its leading axes.

        They make room for speeds or amplitudes: ``system.with_axes().matrix(speeds)`` has shape
        (..., n_speeds, n, n).
        """
        return dataclasses.replace(
            self,
            A0=_with_axes(self.A0, count),
            A1=_with_axes(self.A1, count),
            A2=_with_axes(self.A2, count),
            elements=tuple(link.with_axes(count) for link in self.elements),
            clearance=np.reshape(self.clearance, np.shape(self.clearance) + (1,) * count),
        )

    def take(self, index: ArrayLike) -> Self:
        """Return the systems at `index` of the flattened stack, as a stack of one axis.

        Parameters
        ----------
        index : array_like of int, shape (m,)
            Places in the stack in C order; they may repeat.
        """
        index = np.asarray(index)

        def flat(values: Array, core: int) -> Array:
            matrix = values.shape[values.ndim - core :]
            full = np.broadcast_to(values, self.shape + matrix)
            return np.asarray(full.reshape(-1, *matrix)[index])

        def own(values: Array, core: int) -> Array:
            """What is the same for all systems needs no copies."""
            return values if values.ndim == core else flat(values, core)

        links = [
            Connection(
                dataclasses.replace(
                    link.element,  # type: ignore[type-var]
                    **{
                        name: own(np.asarray(value), 0)
                        for name, value in vars(link.element).items()
                        if not isinstance(value, str)
                    },
                ),
                C=own(link.C, 2),
                B=own(link.B, 2),
            )
            for link in self.elements
        ]
        return dataclasses.replace(
            self,
            A0=flat(self.A0, 2),
            A1=flat(self.A1, 2),
            A2=flat(self.A2, 2),
            elements=tuple(links),
            clearance=flat(np.asarray(self.clearance), 0),
        )


def _with_axes(matrix: Array, count: int) -> Array:
    return matrix.reshape(matrix.shape[:-2] + (1,) * count + matrix.shape[-2:])
