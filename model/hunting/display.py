"""How parameters and critical speeds show themselves, as text and as HTML, in a reader's units.

They use this file and not the other way round: here they are known by their attributes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from html import escape
from itertools import chain
from typing import Any

import numpy as np

_LISTED = 3  # values of an array that are written out
_SHOWN = 10  # systems of a stack that get a line
_KMH, _MM, _HERTZ = 3.6, 1e3, 1 / (2 * np.pi)
_SPEEDS = {
    "V_nl [km/h]": ("nonlinear", _KMH),
    "V_lin [km/h]": ("linear", _KMH),
    "amplitude at V_nl [mm]": ("amplitude", _MM),
    "frequency at V_lin [Hz]": ("frequency", _HERTZ),
}

Rows = list[Sequence[str]]


def written(value: float) -> str:
    """Return a number as people write it, to seven digits.

    Examples
    --------
    >>> written(86700.0), written(1.5913e7), written(0.00923), written(-905000.0)
    ('86,700', '1.5913e7', '0.00923', '−905,000')
    """
    size = abs(value)
    if size and not 1e-4 <= size < 1e6:
        digits, exponent = f"{value:.6e}".split("e")
        text = f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}"
    else:
        places = 0 if size == 0 else max(0, 6 - math.floor(math.log10(size)))
        text = f"{value:,.{places}f}"
        text = text.rstrip("0").rstrip(".") if "." in text else text
    return text.replace("-", "−")


def parameters_text(parameters: Any) -> str:
    """Return a line for each parameter: name in the code, symbol, value, unit, name in words."""
    return "\n".join(_aligned(list(_parameter_rows(parameters)), "<<><<"))


def parameters_html(parameters: Any) -> str:
    """Return the parameters as a table; what each one does is its row's tooltip."""
    lines = [
        f'<tr title="{escape(field.description)}"><td><code>{name}</code></td>'
        f"<td>{_symbol(symbol)}</td><td>{value}</td><td>{unit}</td><td>{escape(label)}</td></tr>"
        for field, (name, symbol, value, unit, label) in zip(
            parameters.fields(), _parameter_rows(parameters), strict=True
        )
    ]
    return _table(("name", "symbol", "value", "unit", "parameter"), lines)


def _parameter_rows(parameters: Any) -> Iterator[tuple[str, str, str, str, str]]:
    for f in parameters.fields():
        values = np.asarray(getattr(parameters, f.name))
        yield f.name, f.symbol, _values(values), f.unit, f.label


def _values(values: np.ndarray) -> str:
    """Return a number, a short list, or how many values there are and from where to where."""
    if not values.ndim:
        return written(float(values))
    if values.ndim == 1 and len(values) <= _LISTED:
        return "; ".join(map(written, values.tolist()))
    count = " × ".join(map(str, values.shape))
    low, high = written(float(values.min())), written(float(values.max()))
    return f"{count} values, {low}" if low == high else f"{count} values, {low} to {high}"


def speeds_text(speeds: Any) -> str:
    """Return a sentence, and the numbers below it."""
    head, body, rest = _speed_rows(speeds)
    lines = _aligned([head, *body], ">" * (len(head) - 1) + "<") if body else []
    return "\n".join([sentence(speeds), *lines, *rest])


def speeds_html(speeds: Any) -> str:
    """Return a sentence, and the numbers as a table below it."""
    head, body, rest = _speed_rows(speeds)
    lines = ["<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in body]
    return (
        f"<p>{_subscripted(sentence(speeds))}</p>"
        + (_table([_subscripted(name) for name in head], lines) if body else "")
        + "".join(f"<p>{escape(line)}</p>" for line in rest)
    )


def sentence(speeds: Any) -> str:
    """Return in words at what speeds the vehicle hunts.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, critical_speeds, wheelset
    >>> print(sentence(critical_speeds(wheelset(RECONSTRUCTED))))
    Below V_nl = 143.73 km/h every motion dies out; from there to V_lin = 156.46 km/h it depends on
    the disturbance; above, the vehicle hunts by itself, at 2.29 Hz (subcritical Hopf point).
    """
    if np.ndim(speeds.linear):
        return _of_many(speeds)
    linear, nonlinear = _KMH * float(speeds.linear), _KMH * float(speeds.nonlinear)
    if not math.isfinite(linear):
        return f"No critical speed: {speeds.message}."
    above = (
        f"the vehicle hunts by itself, at {float(speeds.frequency) * _HERTZ:.2f} Hz "
        f"({speeds.criticality} Hopf point)."
    )
    if not math.isfinite(nonlinear):
        said = f"Above V_lin = {linear:.2f} km/h {above} V_nl is not known: {speeds.message}."
    elif nonlinear < linear:
        said = (
            f"Below V_nl = {nonlinear:.2f} km/h every motion dies out; from there to "
            f"V_lin = {linear:.2f} km/h it depends on the disturbance; above, {above}"
        )
    else:
        said = f"Below V_lin = {linear:.2f} km/h every motion dies out; above, {above}"
    windows = [(_KMH * float(low), _KMH * float(high)) for low, high in speeds.windows]
    return said + "".join(
        f" But it also hunts from {low:.1f} to {high:.1f} km/h (primary hunting)."
        for low, high in windows
    )


def _of_many(speeds: Any) -> str:
    said = [f"Critical speeds of {' × '.join(map(str, np.shape(speeds.linear)))} systems"]
    for name, values in (("V_nl", speeds.nonlinear), ("V_lin", speeds.linear)):
        V = _KMH * np.asarray(values)[np.isfinite(values)]
        missing = np.size(values) - V.size
        gap = f" ({missing} without)" if missing else ""
        said.append(f"{name} {V.min():.2f} to {V.max():.2f} km/h{gap}" if V.size else f"no {name}")
    return f"{said[0]}: {', '.join(said[1:])}."


def _speed_rows(speeds: Any) -> tuple[Sequence[str], Rows, list[str]]:
    """Return names of columns, a row for each of the first systems, and what is said of others."""
    index = list(np.ndindex(np.shape(speeds.linear)))
    many = index != [()]
    if not many and not math.isfinite(float(speeds.linear)):
        return (), [], []
    head = (*(("system",) if many else ()), *_SPEEDS, "criticality")
    rows = [
        (
            *((", ".join(map(str, i)),) if many else ()),
            *(
                _number(factor * float(np.asarray(getattr(speeds, name))[i]))
                for name, factor in _SPEEDS.values()
            ),
            str(np.asarray(speeds.criticality)[i]),
        )
        for i in index[:_SHOWN]
    ]
    left = len(index) - _SHOWN
    return head, list(rows), [f"… and {left} more"] if left > 0 else []


def _number(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "–"


def _aligned(rows: Rows, sides: str) -> list[str]:
    """Return rows as lines with columns aligned left (<) or right (>)."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(f"{c:{s}{w}}" for c, s, w in zip(row, sides, widths, strict=True)).rstrip()
        for row in rows
    ]


def _table(head: Sequence[str], lines: Sequence[str]) -> str:
    names = "".join(f"<th>{name}</th>" for name in head)
    return "".join(chain([f"<table><thead><tr>{names}</tr></thead><tbody>"], lines)) + (
        "</tbody></table>"
    )


def _symbol(text: str) -> str:
    letter, _, subscript = text.partition("_")
    return f"<i>{letter}</i>" + (f"<sub>{subscript}</sub>" if subscript else "")


def _subscripted(text: str) -> str:
    """Return plain words as HTML in which V_nl and V_lin have their subscripts."""
    for name in ("V_nl", "V_lin"):
        text = text.replace(name, _symbol(name))
    return text
