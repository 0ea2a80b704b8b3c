"""Parts that pages are laid out from."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import panel as pn
from bokeh.models import Column

if TYPE_CHECKING:
    from bokeh.models import UIElement

LAYOUT = (Path(__file__).parent / "layout.css").read_text(encoding="utf-8")


def column(classes: str, *children: UIElement) -> Column:
    """A part of the page made of bare Bokeh models."""
    return Column(
        *children,
        css_classes=classes.split(),
        stylesheets=[LAYOUT],
        sizing_mode="stretch_both",
    )


def said(sentence: str) -> str:
    """A sentence as a paragraph."""
    return f"<p>{escape(sentence)}</p>"


def button(act: dict[str, Any], label: str, *, pressed: bool, why_not: str = "") -> str:
    """A button that sends an act, shown as pressed or not; disabled if there is a reason."""
    off = f'disabled title="{escape(why_not)}"' if why_not else ""
    data = escape(json.dumps(act))
    return (
        f'<button data-act="{data}" aria-pressed="{str(pressed).lower()}" {off}>{label}</button>'
        + (f'<small class="why-not">{escape(why_not)}</small>' if why_not else "")
    )


def block(
    classes: str, *objects: Any, style: str = LAYOUT, sizing_mode: str = "stretch_both"
) -> pn.Column:
    """A part of the page."""
    return pn.Column(
        *objects,
        css_classes=classes.split(),
        stylesheets=[style],
        sizing_mode=sizing_mode,
        margin=0,
    )
