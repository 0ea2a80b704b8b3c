"""The dashboard: every parameter of a bogie on a slider, its critical speeds live.

In a notebook the same as a widget, `explorer`, and one call that draws any result, `plot`.
"""

from __future__ import annotations

from typing import Any

from hunting_app.explorer import Explorer, explorer
from hunting_app.session import dashboard

__all__ = ["Explorer", "dashboard", "explorer", "plot"]


def __getattr__(name: str) -> Any:
    """Import `plot` when it is asked for: it takes HoloViews along, a second."""
    if name == "plot":
        from hunting_app.plotting import plot

        globals()["plot"] = plot
        return plot
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
