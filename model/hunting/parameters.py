"""The parameters of Table 1 as a frozen set of SI values, and the two presets.

Names follow the paper's nomenclature. What the paper misprints is listed in the notes of the
presets; entry 12 of those errata adds the frame mass ``m_B``, which Table 1 leaves out.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from hunting.display import parameters_html, parameters_text
from hunting.elements import Coefficient


@dataclass(frozen=True)
class Field:
    """What a person needs to know of one parameter.

    Attributes
    ----------
    name : str
        The attribute of `Parameters`.
    symbol : str
        The paper's symbol; what follows the underscore is a subscript.
    unit : str
        SI unit.
    label : str
        The name in words.
    description : str
        One sentence on what the parameter does.
    group : str
        Where it belongs on the vehicle.
    span : tuple of float
        The range of values met in practice (a slider's range); not a limit.
    minimum : float or None
        Physical lower bound; None if any finite value is allowed.
    exclusive : bool
        Whether `minimum` itself is excluded.
    log : bool
        Whether the values are best compared on a logarithmic scale.
    figure : int or None
        The figure of the paper that varies the parameter.
    """

    name: str
    symbol: str
    unit: str
    label: str
    description: str
    group: str
    span: tuple[float, float]
    minimum: float | None = 0.0
    exclusive: bool = True
    log: bool = False
    figure: int | None = None

    @property
    def bounds(self) -> str:
        """The allowed values in words, such as ``"> 0 N/m"``."""
        if self.minimum is None:
            return "a finite number"
        return f"{'>' if self.exclusive else '>='} {self.minimum:g} {self.unit}"

    def checked(self, value: ArrayLike) -> Coefficient:
        """Return `value` as a float or a read-only array of allowed values.

        Raises
        ------
        TypeError
            If the value is not a real number or an array of them.
        ValueError
            If it is not finite or outside the field's bounds.
        """
        try:
            raw = np.asarray(value)
        except ValueError:
            raise self._wrong_type(value) from None
        if raw.dtype.kind not in "iuf" or raw.size == 0:
            raise self._wrong_type(value)
        array = raw.astype(float)
        allowed = np.isfinite(array)
        if self.minimum is not None:
            allowed &= array > self.minimum if self.exclusive else array >= self.minimum
        if not allowed.all():
            first = array[~allowed].flat[0]
            raise ValueError(f"{self.name} must be {self.bounds}, got {float(first)!r}")
        if array.ndim == 0:
            return float(array)
        array.flags.writeable = False
        return array

    def _wrong_type(self, value: object) -> TypeError:
        return TypeError(
            f"{self.name} must be a real number or a non-empty array of them [{self.unit}], "
            f"got {value!r}"
        )


def _of(
    symbol: str,
    unit: str,
    label: str,
    description: str,
    group: str,
    span: tuple[float, float],
    **options: Any,
) -> Any:
    return dataclasses.field(
        metadata={
            "symbol": symbol,
            "unit": unit,
            "label": label,
            "description": description,
            "group": group,
            "span": span,
            **options,
        }
    )


_WHEELSET = "wheelset"
_CONTACT = "wheel and rail"
_SUSPENSION = "primary suspension"
_DAMPER = "yaw damper"
_FRAME = "frame"


@dataclass(frozen=True, eq=False, repr=False)
class Parameters:
    """The 22 parameters of the wheelset and its bogie frame, in SI units.

    Any field may be a number or an array; arrays broadcast like numpy's, and every function that
    takes the parameters answers in the broadcast shape: a sweep is a parameter set, not a loop.

    Raises
    ------
    TypeError
        If a value is not a real number or an array of them, or a name is unknown.
    ValueError
        If a value is not finite or outside its physical bounds, or the shapes do not broadcast.

    See Also
    --------
    TABLE_1, RECONSTRUCTED : the two presets.

    Notes
    -----
    Source: Table 1 and the nomenclature of the paper; symbols, units and bounds of each field are
    given by `Parameters.fields`.

    Examples
    --------
    >>> softer = RECONSTRUCTED.replace(Ky=6e4)
    >>> softer.Ky
    60000.0
    >>> print(repr(softer).splitlines()[8])
    Ky     K_y      60,000  N/m      lateral stiffness
    >>> RECONSTRUCTED.replace(Ky=np.linspace(4e4, 8e4, 5)).shape
    (5,)
    >>> RECONSTRUCTED.replace(Kr=-3)
    Traceback (most recent call last):
        ...
    ValueError: Kr must be > 0 N/m, got -3.0
    """

    m_w: Coefficient = _of(
        "m_w",
        "kg",
        "wheelset mass",
        "Mass of the wheelset; a heavier one hunts earlier.",
        _WHEELSET,
        (200.0, 3000.0),
        figure=4,
    )
    I_wx: Coefficient = _of(
        "I_wx",
        "kg m²",
        "yaw inertia",
        "Moment of inertia of the wheelset that resists yaw (Eq. 4 calls it I_wx).",
        _WHEELSET,
        (300.0, 1500.0),
    )
    I_wy: Coefficient = _of(
        "I_wy",
        "kg m²",
        "spin inertia",
        "Moment of inertia of the wheelset about its axle: the gyroscopic coupling.",
        _WHEELSET,
        (0.0, 400.0),
        exclusive=False,
    )
    r0: Coefficient = _of(
        "r_0",
        "m",
        "rolling radius",
        "Wheel radius with the wheelset centred.",
        _CONTACT,
        (0.35, 0.65),
        figure=5,
    )
    d: Coefficient = _of(
        "d",
        "m",
        "half contact distance",
        "Half the lateral distance between the two contact points.",
        _CONTACT,
        (0.5, 0.9),
        figure=6,
    )
    lam: Coefficient = _of(
        "λ",
        "rad",
        "equivalent conicity",
        "Slope of the wheel tread: steers the wheelset, and makes it hunt.",
        _CONTACT,
        (0.02, 0.3),
        figure=7,
    )
    W_A: Coefficient = _of(
        "W_A",
        "N",
        "axle load",
        "Vertical load on the wheelset: the small gravity stiffness.",
        _CONTACT,
        (1e4, 3e5),
        exclusive=False,
        figure=8,
    )
    b: Coefficient = _of(
        "b",
        "m",
        "half spring distance",
        "Half the lateral distance of the yaw springs and yaw dampers.",
        _SUSPENSION,
        (0.6, 1.4),
        figure=11,
    )
    Ky: Coefficient = _of(
        "K_y",
        "N/m",
        "lateral stiffness",
        "Lateral stiffness of the primary suspension, one side; two act on a wheelset.",
        _SUSPENSION,
        (1e4, 1e6),
        log=True,
    )
    Cy: Coefficient = _of(
        "C_y",
        "N s/m",
        "lateral damping",
        "Lateral damping of the primary suspension, one side.",
        _SUSPENSION,
        (0.0, 6e4),
        exclusive=False,
        figure=9,
    )
    Kpsi: Coefficient = _of(
        "K_ψ",
        "N/m",
        "yaw stiffness",
        "Longitudinal stiffness of the primary suspension, one side: holds the wheelset in yaw.",
        _SUSPENSION,
        (1e4, 1e6),
        exclusive=False,
        log=True,
        figure=10,
    )
    f11: Coefficient = _of(
        "f_11",
        "N",
        "lateral creep coefficient",
        "Creep force in the lateral direction for unit creepage, one wheel.",
        _CONTACT,
        (1e6, 5e7),
        log=True,
    )
    f22: Coefficient = _of(
        "f_22",
        "N m²",
        "spin creep coefficient",
        "Spin moment for unit spin creepage, one wheel.",
        _CONTACT,
        (10.0, 1e4),
        exclusive=False,
        log=True,
    )
    f12: Coefficient = _of(
        "f_12",
        "N m",
        "lateral/spin creep coefficient",
        "Lateral force for unit spin creepage (and the moment that answers it), one wheel.",
        _CONTACT,
        (1e3, 4e5),
        exclusive=False,
        log=True,
    )
    f33: Coefficient = _of(
        "f_33",
        "N",
        "forward creep coefficient",
        "Creep force in the direction of travel for unit creepage, one wheel.",
        _CONTACT,
        (1e6, 5e7),
        log=True,
    )
    Kr: Coefficient = _of(
        "K_r",
        "N/m",
        "rail stiffness",
        "Lateral stiffness of the rail that the flange runs against.",
        _CONTACT,
        (1e6, 1e8),
        log=True,
        figure=12,
    )
    delta: Coefficient = _of(
        "δ",
        "m",
        "flange clearance",
        "Lateral play of the wheelset before the flange touches the rail.",
        _CONTACT,
        (0.002, 0.02),
        figure=13,
    )
    C1: Coefficient = _of(
        "C_1",
        "N s/m",
        "yaw damper, linear",
        "First coefficient of the yaw damper force F_d (Eq. 6).",
        _DAMPER,
        (0.0, 6e4),
        exclusive=False,
    )
    C2: Coefficient = _of(
        "C_2",
        "N s²/m²",
        "yaw damper, quadratic",
        "Second coefficient of F_d; negative: the damper weakens with speed, the Hopf point is "
        "subcritical.",
        _DAMPER,
        (-2e6, 2e6),
        minimum=None,
    )
    C3: Coefficient = _of(
        "C_3",
        "N s³/m³",
        "yaw damper, cubic",
        "Third coefficient of the yaw damper force F_d.",
        _DAMPER,
        (-2e6, 2e6),
        minimum=None,
    )
    C4: Coefficient = _of(
        "C_4",
        "N s⁴/m⁴",
        "yaw damper, quartic",
        "Fourth coefficient of the yaw damper force F_d.",
        _DAMPER,
        (-2e7, 2e7),
        minimum=None,
    )
    m_B: Coefficient = _of(
        "m_B",
        "kg",
        "frame mass",
        "Mass of the bogie frame on one wheelset; Table 1 leaves it out, Fig. 14 varies it.",
        _FRAME,
        (15_000.0, 60_000.0),
        figure=14,
    )

    def __post_init__(self) -> None:
        for f in self.fields():
            object.__setattr__(self, f.name, f.checked(getattr(self, f.name)))
        try:
            self.shape  # noqa: B018 - broadcasting is the check
        except ValueError:
            shapes = {f.name: np.shape(getattr(self, f.name)) for f in self.fields()}
            arrays = ", ".join(f"{name} {shape}" for name, shape in shapes.items() if shape)
            raise ValueError(f"parameter shapes must broadcast, got {arrays}") from None

    @classmethod
    def fields(cls) -> tuple[Field, ...]:
        """Return symbol, unit, label, bounds and more of each parameter, in Table 1's order.

        Examples
        --------
        >>> next(f for f in Parameters.fields() if f.name == "Ky").unit
        'N/m'
        """
        return _FIELDS

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape that all fields broadcast to; ``()`` for plain numbers."""
        return np.broadcast_shapes(*(np.shape(value) for value in self._values()))

    def _values(self) -> Iterator[Coefficient]:
        return (getattr(self, f.name) for f in self.fields())

    def replace(self, **changes: ArrayLike) -> Self:
        """Return a copy with some fields changed.

        Raises
        ------
        TypeError
            If a name is unknown or a value is not a number.
        ValueError
            If a value is out of its bounds.
        """
        _check_names(changes)
        return dataclasses.replace(self, **changes)  # type: ignore[arg-type]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Parameters):
            return NotImplemented
        return all(
            np.array_equal(mine, theirs)
            for mine, theirs in zip(self._values(), other._values(), strict=True)
        )

    __hash__ = None  # type: ignore[assignment]  # arrays have none

    def __repr__(self) -> str:
        return parameters_text(self)

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        return parameters_html(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as a dict of floats and (nested) lists."""
        return {f.name: np.asarray(getattr(self, f.name)).tolist() for f in self.fields()}

    @classmethod
    def from_dict(cls, values: Mapping[str, ArrayLike]) -> Self:
        """Return the parameters named in `values`; every field must be there.

        Raises
        ------
        TypeError
            If a name is unknown, a field is missing, or a value is not a number.
        ValueError
            If a value is out of its bounds.
        """
        _check_names(values)
        missing = [f.name for f in cls.fields() if f.name not in values]
        if missing:
            raise TypeError(f"missing parameters: {', '.join(missing)}")
        return cls(**values)  # type: ignore[arg-type]

    def to_json(self) -> str:
        """Return the fields as a JSON object."""
        return json.dumps(self.to_dict(), indent=2)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Return the parameters of a JSON object made by `to_json`.

        Raises
        ------
        TypeError
            If the JSON is not an object, or as for `from_dict`.
        ValueError
            If the text is not JSON, or a value is out of its bounds.
        """
        values = json.loads(text)
        if not isinstance(values, dict):
            raise TypeError(f"parameters must be a JSON object, got {type(values).__name__}")
        return cls.from_dict(values)


def check_one_design(parameters: Parameters) -> None:
    """Raise ValueError unless the parameters are plain numbers."""
    if parameters.shape:
        raise ValueError(f"parameters must be numbers, got arrays of shape {parameters.shape}")


def _check_names(values: Mapping[str, object]) -> None:
    known = {f.name for f in Parameters.fields()}
    unknown = [str(name) for name in values if name not in known]
    if unknown:
        raise TypeError(
            f"unknown parameter {', '.join(unknown)}; the parameters are "
            + ", ".join(f.name for f in Parameters.fields())
        )


_FIELDS = tuple(Field(name=f.name, **f.metadata) for f in dataclasses.fields(Parameters))

#: Table 1 as printed (``f13`` read as f33, see Eq. 4), with an assumed frame mass: Table 1 has
#: none, and 45 t is the end of Fig. 14's range. With these numbers neither vehicle hunts below
#: 900 km/h: several entries must be misprints.
TABLE_1 = Parameters(
    m_w=264.448,
    I_wx=625.7,
    I_wy=133.92,
    r0=0.533,
    d=0.71755,
    lam=0.05,
    W_A=1.8e4,
    b=1.0,
    Ky=8.67e4,
    Cy=2.1e4,
    Kpsi=8.67e5,
    f11=1.5913e6,
    f22=2000.0,
    f12=1.2e5,
    f33=1.9135e7,
    Kr=1.617e7,
    delta=0.00923,
    C1=1.923e4,
    C2=5.14e5,
    C3=-3.1127e4,
    C4=5.14e6,
    m_B=45_000.0,
)

#: Our reconstruction of what the paper must have computed with; not the paper's. It gives the four
#: speeds of Fig. 3 within 1.1 %. The exponents of f11 (Kalker: f33/f11 near 1.2), K_psi (equal to
#: K_y but for the exponent) and W_A (an axle load of 18 t) and the sign of C2 (only C2 < 0 makes
#: the Hopf point subcritical with the fold at the clearance) are repaired, m_w and C2 fitted. The
#: damper force is negative for 0.021 < |b psi'| < 0.41 m/s.
RECONSTRUCTED = TABLE_1.replace(m_w=1380.0, f11=1.5913e7, Kpsi=8.67e4, W_A=1.8e5, C2=-9.05e5)
