"""Critical speeds as CSV, with what they were computed from in the header."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from importlib.metadata import version

import numpy as np

from hunting.cases import Answers
from hunting.critical_speeds import Method
from hunting.elements import Array
from hunting.parameters import Parameters

#: What a column is called, and what its SI value is multiplied by.
COLUMNS = {
    "linear": ("linear critical speed V_lin [km/h]", 3.6),
    "nonlinear": ("nonlinear critical speed V_nl [km/h]", 3.6),
    "amplitude": ("amplitude at V_nl [mm]", 1e3),
    "frequency": ("frequency at V_lin [Hz]", 1 / (2 * np.pi)),
}


def header(title: str, vehicle: str, method: str, parameters: Parameters, varied: set[str]) -> str:
    """Return lines that begin with ``#``: title, version, vehicle, method, other parameters.

    Parameters
    ----------
    title : str
        What the table shows.
    vehicle, method : str
        How it was computed.
    parameters : Parameters
        All parameters, as numbers.
    varied : set of str
        The fields that the table itself gives.
    """
    lines = [title, f"bogie-hunting {version('bogie-hunting')}", f"vehicle: {vehicle}"]
    lines += [f"method: {method}"]
    lines += [
        f"{f.name} = {getattr(parameters, f.name)!r} {f.unit} ({f.label})"
        for f in Parameters.fields()
        if f.name not in varied
    ]
    return "".join(f"# {line}\n" for line in lines)


def rows(columns: Mapping[str, Array | list[str]]) -> str:
    """Return a line of names and a line for each case; gaps are empty.

    Parameters
    ----------
    columns : dict of str to sequence
        Names and values, as long as each other.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    values = [np.asarray(column).tolist() for column in columns.values()]
    for row in zip(*values, strict=True):
        writer.writerow(["" if value != value else value for value in row])
    return text.getvalue()


def speeds_table(
    title: str,
    vehicle: str,
    method: Method,
    parameters: Parameters,
    varied: Mapping[str, Array],
    answers: Answers,
) -> str:
    """Return the CSV of critical speeds over the parameters that vary.

    Parameters
    ----------
    title : str
        What the table shows.
    vehicle, method : str
        How it was computed.
    parameters : Parameters
        All parameters, as numbers.
    varied : dict of str to ndarray, shape (m,)
        The values [SI] of those that vary.
    answers : dict of str to ndarray, shape (m,)
        By the names of `hunting.cases.QUANTITIES`.
    """
    units = {f.name: f.unit for f in Parameters.fields()}
    columns: dict[str, Array | list[str]] = {
        f"{name} [{units[name]}]": values for name, values in varied.items()
    }
    columns |= {name: factor * answers[key] for key, (name, factor) in COLUMNS.items()}
    columns["criticality"] = answers["criticality"]
    columns["reason for a gap"] = answers["message"]
    return header(title, vehicle, method, parameters, set(varied)) + rows(columns)
