"""JavaScript of components: Panel loads one module for each, so parts are put together here."""

from __future__ import annotations

from pathlib import Path

_HERE = Path(__file__).parent


def script(*names: str) -> str:
    """Return files as one module, in this order: ``script("dom", "drawer")``."""
    return "\n".join((_HERE / f"{name}.js").read_text(encoding="utf-8") for name in names)
