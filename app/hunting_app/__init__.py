"""The dashboard: every parameter of a bogie on a slider, its critical speeds live."""

from __future__ import annotations

from hunting_app.explorer import Explorer, explorer
from hunting_app.session import dashboard

__all__ = ["Explorer", "dashboard", "explorer"]
