"""What the person has chosen; everything the page shows follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import param

from hunting import RECONSTRUCTED, TABLE_1, Parameters
from hunting.parameters import Field
from hunting_app.numerals import parsed


@dataclass(frozen=True)
class Preset:
    """A named set of parameters to start from."""

    label: str
    parameters: Parameters
    note: str


PRESETS = {
    "reconstructed": Preset(
        "Reconstructed",
        RECONSTRUCTED,
        "Our reconstruction from Fig. 3 of the paper of 2013, not its own Table 1.",
    ),
    "table1": Preset(
        "Table 1 as printed",
        TABLE_1,
        "The paper's Table 1 as printed, with an assumed frame mass. It holds misprints: "
        "with these numbers nothing hunts.",
    ),
}
VEHICLES = {"bogie": ("bogie",), "wheelset": ("wheelset",), "both": ("bogie", "wheelset")}
CURVES = {"damping": "Damping ratio", "locus": "Root locus"}
CHOICES = ("vehicle", "curve", "page", "exact", "averaged", "pair", "units")
SHOWN = ("shown", "hidden")
PAGES = {"explore": "Explore", "study": "Study", "model": "Model"}

FIELDS = {field.name: field for field in Parameters.fields()}
SPEED = Field(
    name="V",
    symbol="V",
    unit="km/h",
    label="forward speed",
    description="The speed at which the phase portraits are drawn; the cursor in the diagrams.",
    group="speed",
    span=(10.0, 300.0),
)
FASTEST = 1440.0  # km/h; the model looks for Hopf points up to 400 m/s
EDITED = (
    *("preset", "parameters", "vehicle", "speed", "disturbance", "pair"),
    *("curve", "exact", "averaged", "baseline", "designs"),
)  # what undo takes back: all that is chosen but the page and the colours


@dataclass(frozen=True)
class Design:
    """Parameters under a name, and the preset that they are changes of."""

    name: str
    preset: str
    parameters: Parameters

    def changed(self) -> list[str]:
        """Names of the parameters that differ from the preset."""
        base = PRESETS[self.preset].parameters
        return [n for n in FIELDS if getattr(self.parameters, n) != getattr(base, n)]

    def same(self, other: Design) -> bool:
        """Whether the other has the same preset and parameters, whatever its name."""
        return self.preset == other.preset and self.parameters == other.parameters


class State(param.Parameterized):
    """The person's choices. No widget, no plot: views watch it and draw."""

    preset: Any = param.Selector(
        default="reconstructed", objects=list(PRESETS), doc="Where we started."
    )
    parameters = param.ClassSelector(class_=Parameters, default=RECONSTRUCTED, doc="SI values.")
    vehicle: Any = param.Selector(default="bogie", objects=list(VEHICLES), doc="What is drawn.")
    speed = param.Number(default=145.0, bounds=(0, FASTEST), doc="Chosen forward speed [km/h].")
    curve: Any = param.Selector(
        default="damping", objects=list(CURVES), doc="The stability plot shown."
    )
    exact: Any = param.Selector(default="shown", objects=list(SHOWN), doc="The exact branch.")
    averaged: Any = param.Selector(default="shown", objects=list(SHOWN), doc="The averaged branch.")
    disturbance = param.Number(
        default=0.0, bounds=(0, None), doc="Peak displacement that is simulated [mm]; 0: none."
    )
    pair: Any = param.Selector(
        default="no", objects=["no", "yes"], doc="Two motions, on either side of the threshold."
    )
    units: Any = param.Selector(
        default="si", objects=["si", "engineering"], doc="Units of the parameters on the page."
    )
    baseline = param.ClassSelector(
        class_=Design, allow_None=True, default=None, doc="What everything is compared with."
    )
    designs = param.ClassSelector(class_=tuple, default=(), doc="The designs that were kept.")
    page: Any = param.Selector(default="explore", objects=list(PAGES), doc="The page shown.")
    dark = param.Boolean(default=False, doc="Light on dark instead of dark on light.")

    def base(self) -> Parameters:
        """The parameters of the preset we started from."""
        return PRESETS[self.preset].parameters

    def changed(self) -> list[str]:
        """Names of the parameters that differ from the preset."""
        return self.design().changed()

    def design(self, name: str = "") -> Design:
        """The present parameters under a name."""
        return Design(name, self.preset, self.parameters)

    def pinned(self) -> Parameters | None:
        """The parameters of the baseline, if there is one."""
        return None if self.baseline is None else self.baseline.parameters

    def edited(self) -> dict[str, Any]:
        """What undo takes back."""
        return {name: getattr(self, name) for name in EDITED}


def with_value(state: State, name: str, value: float | str) -> dict[str, Any]:
    """Return the change of `state` that gives the parameter (or the speed ``"V"``) a value.

    Raises
    ------
    ValueError, TypeError
        If the text is no number or the value is not allowed, in words.
    """
    number = parsed(value) if isinstance(value, str) else value
    if name == SPEED.name:
        speed = float(SPEED.checked(number))
        if speed > FASTEST:
            raise ValueError(f"V must be at most {FASTEST:.0f} km/h, got {speed:g}")
        return {"speed": speed}
    return {"parameters": state.parameters.replace(**{name: number})}


def with_values(state: State, values: dict[str, float]) -> dict[str, Any]:
    """Return the change of `state` that gives several parameters their values at once.

    Raises
    ------
    ValueError, TypeError
        If a name is unknown or a value is not allowed, in words.
    """
    return {"parameters": state.parameters.replace(**values)}


def with_choice(name: str, value: Any) -> dict[str, Any]:
    """Return the change of a state that chooses the vehicle, the page or the stability plot.

    Raises
    ------
    ValueError
        If there is no such choice.
    """
    allowed = State.param[name].objects
    if value not in allowed:
        raise ValueError(f"{name} must be one of {', '.join(allowed)}, got ‘{str(value)[:40]}’")
    return {name: value}


def with_disturbance(size: float | str) -> dict[str, Any]:
    """Return the change of a state that simulates a disturbance [mm]; 0 for none.

    Raises
    ------
    ValueError
        If it is no finite number >= 0.
    """
    number = parsed(size) if isinstance(size, str) else float(size)
    if not 0 <= number < math.inf:
        raise ValueError(f"the disturbance must be finite and >= 0 mm, got {number:g}")
    return {"disturbance": number, "pair": "no"}


def with_preset(name: str) -> dict[str, Any]:
    """Return the change of a state that starts again from a preset.

    Raises
    ------
    ValueError
        If there is no such preset.
    """
    if name not in PRESETS:
        raise ValueError(f"preset must be one of {', '.join(PRESETS)}, got ‘{str(name)[:40]}’")
    return {"preset": name, "parameters": PRESETS[name].parameters}


def with_reset(state: State, names: list[str]) -> dict[str, Any]:
    """Return the change of `state` that gives parameters (or ``"V"``) their first values again."""
    base = state.base()
    known = {n: getattr(base, n) for n in names if n in FIELDS}
    change: dict[str, Any] = {"parameters": state.parameters.replace(**known)}
    return change | ({"speed": State.param.speed.default} if SPEED.name in names else {})
