"""Critical speeds on a grid of parameters: families of curves and maps."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from hunting.cases import QUANTITIES, Cases, Progress, Vehicle, name_of, solve_cases
from hunting.critical_speeds import Method
from hunting.elements import Array
from hunting.parameters import Parameters, check_one_design
from hunting.tables import speeds_table


@dataclass(frozen=True)
class Sweep:
    """Critical speeds on a grid of parameters.

    Attributes
    ----------
    vehicle : str
        The vehicle's name.
    parameters : Parameters
        The parameters of the present design; those of the axes too.
    axes : dict of str to ndarray
        The values [SI] along each axis of the grid, in order.
    method : str
        How limit cycles were found.
    linear, nonlinear : ndarray
        V_lin and V_nl [m/s], NaN where there is none. The shape is that of the grid.
    amplitude : ndarray
        Peak lateral displacement of the limit cycle at V_nl [m].
    frequency : ndarray
        Angular frequency at V_lin [rad/s].
    criticality : ndarray of str
        "subcritical", "supercritical" or "none".
    message : ndarray of str
        Why a value is missing; empty if none is.
    """

    units: ClassVar[Mapping[str, str]] = {
        "linear": "m/s",
        "nonlinear": "m/s",
        "amplitude": "m",
        "frequency": "rad/s",
    }

    vehicle: str
    parameters: Parameters
    axes: Mapping[str, Array]
    method: Method
    linear: Array
    nonlinear: Array
    amplitude: Array
    frequency: Array
    criticality: Array
    message: Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the grid."""
        return tuple(map(len, self.axes.values()))

    def gaps(self) -> dict[str, int]:
        """Return how many points lack a critical speed, by the reason."""
        reasons, counts = np.unique(self.message[self.message != ""], return_counts=True)
        return dict(zip(reasons.tolist(), counts.tolist(), strict=True))

    def csv(self) -> str:
        """Return the grid as CSV: a line for each point, the other parameters in the header."""
        return speeds_table(
            "critical speeds over " + " and ".join(self.axes),
            self.vehicle,
            self.method,
            self.parameters,
            _columns(self.axes),
            {name: getattr(self, name).ravel() for name in QUANTITIES},
        )


def sweep(
    vehicle: Vehicle,
    parameters: Parameters,
    axes: Mapping[str, ArrayLike],
    method: Method = "harmonic_balance",
    executor: Executor | None = None,
    progress: Progress | None = None,
    store: str | os.PathLike[str] | None = None,
) -> Sweep:
    """Return the critical speeds on the grid of the axes.

    Parameters
    ----------
    vehicle : callable
        `wheelset` or `bogie`.
    parameters : Parameters
        The present design, as numbers.
    axes : dict of str to array_like
        Fields of the parameters and the values [SI] they take, one axis of the grid each.
    method : {"harmonic_balance", "averaging"}
        How limit cycles are found: exactly, or by Bogoliubov's first order.
    executor : concurrent.futures.Executor, optional
        Where chunks of the grid are computed: a process pool on this machine, or
        ``dask.distributed.Client(...).get_executor()`` for many. By default here.
    progress : callable, optional
        Called in this thread with the numbers of points done and of all points, before the first
        chunk and after each. If it returns False, no further chunk is begun and `Cancelled`
        is raised.
    store : path, optional
        A folder that keeps finished chunks. The same sweep, asked for again, goes on from there
        with the same numbers to the last bit, whatever stopped it.

    Returns
    -------
    Sweep

    Raises
    ------
    TypeError
        If an axis is no field of the parameters, or its values are no numbers.
    ValueError
        If the parameters are arrays, an axis is not one-dimensional, or a value is out of bounds.
    Cancelled
        If `progress` has returned False.
    concurrent.futures.BrokenExecutor
        If a process of the pool was killed. (Dask gives a lost worker's chunks to another one.)

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, bogie, sweep
    >>> map_ = sweep(bogie, RECONSTRUCTED, {"Ky": [8e4, 9e4], "Cy": [2e4, 2.2e4]}, "averaging")
    >>> (3.6 * map_.nonlinear).round(1)
    array([[138.2, 137.7],
           [141.2, 140.8]])
    """
    return sweeps(vehicle, parameters, [axes], method, executor, progress, store)[0]


def sweeps(
    vehicle: Vehicle,
    parameters: Parameters,
    grids: Sequence[Mapping[str, ArrayLike]],
    method: Method = "harmonic_balance",
    executor: Executor | None = None,
    progress: Progress | None = None,
    store: str | os.PathLike[str] | None = None,
) -> list[Sweep]:
    """Return the critical speeds on several grids around one design, solved together.

    Small grids cost less that way than one after the other.

    Parameters
    ----------
    vehicle, parameters, method, executor, progress, store
        As for `sweep`, which also says what is raised.
    grids : sequence of dict of str to array_like
        The axes of each grid.

    Returns
    -------
    list of Sweep
        One for each grid.
    """
    check_one_design(parameters)
    if not grids:
        return []
    checked = [checked_axes(axes) for axes in grids]
    answers = solve_cases(
        Cases(vehicle, parameters, _joined(parameters, list(map(_columns, checked))), method),
        executor,
        progress,
        store,
    )
    found, first = [], 0
    for axes in checked:
        shape = tuple(map(len, axes.values()))
        here = slice(first, first := first + math.prod(shape))
        values = {name: answers[name][here].reshape(shape) for name in QUANTITIES}
        found.append(Sweep(name_of(vehicle), parameters, axes, method, **values))
    return found


def checked_axes(axes: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Return the axes as arrays of allowed values; TypeError or ValueError names what is not."""
    fields = {f.name: f for f in Parameters.fields()}
    unknown = [name for name in axes if name not in fields]
    if unknown or not axes:
        raise TypeError(f"axes must be one or more of {', '.join(fields)}, got {list(axes)}")
    values = {name: np.asarray(fields[name].checked(axis)) for name, axis in axes.items()}
    for name, axis in values.items():
        if axis.ndim != 1:
            raise ValueError(f"axis {name} must be one-dimensional, got shape {axis.shape}")
    return values


def _columns(axes: Mapping[str, Array]) -> dict[str, Array]:
    grid = np.meshgrid(*axes.values(), indexing="ij")
    return {name: values.ravel() for name, values in zip(axes, grid, strict=True)}


def _joined(parameters: Parameters, grids: list[dict[str, Array]]) -> dict[str, Array]:
    """Return columns of all grids in a row; a parameter stays as it is where it is no axis."""
    names = dict.fromkeys(name for columns in grids for name in columns)
    counts = [len(next(iter(columns.values()))) for columns in grids]
    return {
        name: np.concatenate(
            [
                columns.get(name, np.full(count, getattr(parameters, name)))
                for columns, count in zip(grids, counts, strict=True)
            ]
        )
        for name in names
    }
