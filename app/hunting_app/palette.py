"""Colours with one meaning each, told apart by colour-blind eyes, in a light and a dark set.

The hues are those of Okabe and Ito (2008), lightened or darkened until they stand out from the
background.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Palette:
    """What each colour means."""

    safe: str
    conditional: str
    hunting: str
    bogie: str
    wheelset: str
    averaged: str
    motion: str
    baseline: str
    clearance: str
    cursor: str
    paper: str
    ink: str
    faint: str
    grid: str

    def vehicle(self, name: str) -> str:
        """The colour of ``"bogie"`` or ``"wheelset"``."""
        return {"bogie": self.bogie, "wheelset": self.wheelset}[name]


LIGHT = Palette(
    safe="#009e73",
    conditional="#e69f00",
    hunting="#d55e00",
    bogie="#0072b2",
    wheelset="#a8487f",
    averaged="#7a4d1a",
    motion="#5b3fb0",
    baseline="#868e96",
    clearance="#6b6b6b",
    cursor="#1b1f24",
    paper="#ffffff",
    ink="#1b1f24",
    faint="#57606a",
    grid="#e3e6ea",
)

DARK = Palette(
    safe="#2fc297",
    conditional="#f0b429",
    hunting="#ff8a4c",
    bogie="#56b4e9",
    wheelset="#e39ac4",
    averaged="#d8ab74",
    motion="#9b70ff",
    baseline="#8b939c",
    clearance="#a0a0a0",
    cursor="#f0f3f6",
    paper="#15191f",
    ink="#e6e9ed",
    faint="#a3acb6",
    grid="#2b323b",
)


def palette(dark: bool) -> Palette:
    """The dark set or the light one."""
    return DARK if dark else LIGHT
