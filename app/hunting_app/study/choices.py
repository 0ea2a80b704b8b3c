"""Boxes and lists in which a person chooses what is studied."""

from __future__ import annotations

from typing import Any

import panel as pn

from hunting_app.state import FIELDS
from hunting_app.study.section import STYLE

METHODS = {"averaging: fast": "averaging", "exact limit cycles": "harmonic_balance"}
PARAMETERS = {f"{field.symbol}  {field.label}": name for name, field in FIELDS.items()}


def select(label: str, options: dict[str, Any], value: Any, width: int = 170) -> pn.widgets.Select:
    """Return a list to choose from."""
    return pn.widgets.Select(
        label=label, options=options, value=value, width=width, stylesheets=[STYLE], margin=0
    )


def number(
    label: str, value: float, low: float, high: float, step: float = 1.0
) -> pn.widgets.FloatInput:
    """Return a box for a number within limits."""
    return pn.widgets.FloatInput(
        label=label,
        value=value,
        start=low,
        end=high,
        step=step,
        width=170,
        stylesheets=[STYLE],
        margin=0,
    )


def ticks(label: str, value: list[str]) -> pn.widgets.CheckBoxGroup:
    """Return a box to tick for each parameter."""
    return pn.widgets.CheckBoxGroup(
        label=label,
        options={field.symbol: name for name, field in FIELDS.items()},
        value=value,
        inline=True,
        stylesheets=[STYLE],
        css_classes=["ticks"],
        sizing_mode="stretch_width",
        margin=0,
    )
