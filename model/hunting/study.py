"""The paper's figures 3 to 14, for any parameters."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from hunting.bogoliubov import averaged_branch
from hunting.branch import Branch
from hunting.cases import Progress, Vehicle
from hunting.critical_speeds import Method
from hunting.elements import Array
from hunting.limit_cycles import limit_cycles
from hunting.parameters import RECONSTRUCTED, Field, Parameters
from hunting.sweeps import Sweep, sweeps
from hunting.tables import header, rows
from hunting.vehicles import bogie, wheelset

#: What K_y is multiplied by for the five curves of each figure.
KY_FACTORS = (0.5, 0.5**0.5, 1.0, 2.0**0.5, 2.0)
POINTS = 41
_FAMILIES = {f.figure: f for f in Parameters.fields() if f.figure is not None}
NUMBERS = (3, *sorted(_FAMILIES))


@dataclass(frozen=True)
class Figure:
    """The data of one of the paper's figures.

    Attributes
    ----------
    number : int
        3 to 14.
    title : str
        What it shows.
    parameters : Parameters
        The design it was computed for.
    method : str
        How limit cycles were found.
    field : Field or None
        The parameter along the axis of figures 4 to 14.
    sweep : Sweep or None
        Figures 4 to 14: critical speeds on the grid of five K_y and the field's span.
    branches : dict of str to Branch
        Figure 3: the limit cycles of "wheelset" and "bogie".
    """

    number: int
    title: str
    parameters: Parameters
    method: Method
    field: Field | None
    sweep: Sweep | None
    branches: Mapping[str, Branch]

    def csv(self) -> str:
        """Return the data as CSV, with parameters, units and version in the header."""
        if self.sweep is not None:
            return self.sweep.csv()
        names = [name for name, branch in self.branches.items() for _ in branch.speed]
        parts = self.branches.values()
        return header(
            self.title, " and ".join(self.branches), self.method, self.parameters, set()
        ) + rows(
            {
                "vehicle": names,
                "forward speed V [km/h]": np.concatenate([3.6 * b.speed for b in parts]),
                "amplitude [mm]": np.concatenate([1e3 * b.amplitude for b in parts]),
                "frequency [Hz]": np.concatenate([b.frequency / (2 * np.pi) for b in parts]),
                "stable": np.concatenate([b.stable for b in parts]),
            }
        )


def figure(
    number: int,
    parameters: Parameters = RECONSTRUCTED,
    vehicle: Vehicle = bogie,
    method: Method = "harmonic_balance",
    points: int = POINTS,
    executor: Executor | None = None,
    progress: Progress | None = None,
    store: str | os.PathLike[str] | None = None,
) -> Figure:
    """Return the data of one of the paper's figures.

    Parameters
    ----------
    number : int
        3: limit cycles of wheelset and bogie over speed. 4 to 14: linear and nonlinear critical
        speed over one parameter, a curve for each of five K_y around the present one.
    parameters : Parameters, default RECONSTRUCTED
        The design, as numbers.
    vehicle : callable, default bogie
        For figures 4 to 14.
    method : {"harmonic_balance", "averaging"}
        How limit cycles are found.
    points : int, default 41
        Values of the parameter over its span, evenly spaced (by their logarithm, where the field
        says so).
    executor, progress, store : optional
        As for `sweep`, for figures 4 to 14.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there is no such figure.

    Examples
    --------
    >>> from hunting import figure
    >>> family = figure(13, method="averaging", points=3)
    >>> family.title, family.sweep.shape
    ('Fig. 13: flange clearance', (5, 3))
    >>> family.sweep.nonlinear[2] < family.sweep.linear[2]
    array([ True, True, True])
    """
    return figures([number], parameters, vehicle, method, points, executor, progress, store)[number]


def figures(
    numbers: Iterable[int] = NUMBERS,
    parameters: Parameters = RECONSTRUCTED,
    vehicle: Vehicle = bogie,
    method: Method = "harmonic_balance",
    points: int = POINTS,
    executor: Executor | None = None,
    progress: Progress | None = None,
    store: str | os.PathLike[str] | None = None,
) -> dict[int, Figure]:
    """Return the data of several of the paper's figures, solved together.

    Parameters
    ----------
    numbers : iterable of int, default all
        3 to 14.
    parameters, vehicle, method, points, executor, progress, store
        As for `figure`, which also says what is raised.

    Returns
    -------
    dict of int to Figure
    """
    numbers = list(numbers)
    for number in numbers:
        if number not in NUMBERS:
            raise ValueError(f"number must be one of {NUMBERS[0]} to {NUMBERS[-1]}, got {number!r}")
    shown = {n: _figure_3(parameters, method) for n in numbers if n == 3}
    fields = {n: _FAMILIES[n] for n in numbers if n != 3}
    curves = np.multiply(KY_FACTORS, parameters.Ky)
    grids = [{"Ky": curves, field.name: span_of(field, points)} for field in fields.values()]
    families = sweeps(vehicle, parameters, grids, method, executor, progress, store)
    for (number, field), family in zip(fields.items(), families, strict=True):
        title = f"Fig. {number}: {field.label}"
        shown[number] = Figure(number, title, parameters, method, field, family, {})
    return shown


def _figure_3(parameters: Parameters, method: Method) -> Figure:
    cycles = averaged_branch if method == "averaging" else limit_cycles
    branches = {v.__name__: cycles(v(parameters)) for v in (wheelset, bogie)}
    return Figure(3, "Fig. 3: wheelset and bogie", parameters, method, None, None, branches)


def span_of(field: Field, points: int = POINTS) -> Array:
    """Return values over a field's span, evenly spaced as the field is best compared.

    Parameters
    ----------
    field : Field
        The parameter.
    points : int, default 41
        How many.
    """
    return (np.geomspace if field.log else np.linspace)(*field.span, points)
