"""Units that a person may choose between; the state and the model stay SI.

Speeds are in km/h whatever is chosen, as on every axis and in every answer.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from hunting.parameters import Field
from hunting_app.numerals import parsed
from hunting_app.state import FIELDS, SPEED

SI, ENGINEERING = "si", "engineering"
UNITS = {SI: "SI", ENGINEERING: "kN, mm, t"}

_ENGINEERS = {"m": ("mm", 1e-3), "kg": ("t", 1e3), "N": ("kN", 1e3)}
_UNIT_BEHIND = re.compile(r"(?<=[\d.])\s*([^\W\d].*)$")


@dataclass(frozen=True)
class Scale:
    """How the values of a parameter are shown.

    Attributes
    ----------
    field : Field
        The parameter with its unit, usual range and bound in the unit shown.
    factor : float
        SI units in one unit shown.
    """

    field: Field
    factor: float

    def shown(self, value: float) -> float:
        """Return an SI value in the unit shown.

        Examples
        --------
        >>> scale("delta", ENGINEERING).shown(0.00923)
        9.23
        """
        return _rounded(value / self.factor)

    def si(self, value: float) -> float:
        """Return what is shown as an SI value.

        Examples
        --------
        >>> scale("delta", ENGINEERING).si(9.23)
        0.00923
        """
        return _rounded(value * self.factor)

    def read(self, value: float | str) -> float:
        """Return the SI value of what was typed or slid to; a unit may be typed behind it.

        Raises
        ------
        ValueError
            If it is no number, or not allowed, in the unit shown.

        Examples
        --------
        >>> K_y = scale("Ky", ENGINEERING)
        >>> K_y.read("86.7"), K_y.read("86,700 N/m"), K_y.read("90 kN/m")
        (86700.0, 86700.0, 90000.0)
        >>> K_y.read("-5")
        Traceback (most recent call last):
            ...
        ValueError: Ky must be > 0 kN/m, got -5.0
        """
        unit = self.field.unit
        if isinstance(value, str):
            value, unit = _without_unit(value, self.field)
        for one in (self, scale(self.field.name, SI), scale(self.field.name, ENGINEERING)):
            if one.field.unit == unit:
                return one.si(float(one.field.checked(value)))
        raise AssertionError(unit)


def scale(name: str, units: str) -> Scale:
    """Return how a parameter (or the speed ``"V"``) is shown.

    Examples
    --------
    >>> [scale(name, ENGINEERING).field.unit for name in ("Ky", "m_B", "C2", "f22", "V")]
    ['kN/m', 't', 'kN s²/m²', 'kN m²', 'km/h']
    """
    return _SCALES[units][name]


def _scale(field: Field, units: str) -> Scale:
    first, *rest = re.split(r"(?=[ /])", field.unit, maxsplit=1)
    if units == SI or field is SPEED or first not in _ENGINEERS or (first == "kg" and rest):
        return Scale(field, 1.0)
    unit, factor = _ENGINEERS[first]
    low, high = (_rounded(value / factor) for value in field.span)
    limit = None if field.minimum is None else _rounded(field.minimum / factor)
    shown = replace(field, unit="".join([unit, *rest]), span=(low, high), minimum=limit)
    return Scale(shown, factor)


def _rounded(value: float) -> float:
    """Return a value without what changing units adds in the last digits."""
    return float(f"{value:.15g}")


def _without_unit(text: str, field: Field) -> tuple[float, str]:
    """Return the number typed and its unit; without one, that of the field."""
    found = _UNIT_BEHIND.search(text.strip())
    typed = _plain(found[1]) if found else ""
    for unit in {field.unit, *(scale(field.name, units).field.unit for units in UNITS)}:
        if found and typed == _plain(unit):
            return parsed(text.strip()[: found.start()]), unit
    return parsed(text), field.unit


def _plain(unit: str) -> str:
    """Return a unit as it may be typed: ``kN s²/m²`` as ``kNs2/m2``."""
    return re.sub(r"[\s·*^]", "", unit).translate(str.maketrans("²³⁴", "234"))


_SCALES = {
    units: {field.name: _scale(field, units) for field in (SPEED, *FIELDS.values())}
    for units in UNITS
}
