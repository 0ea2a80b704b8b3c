"""What a notebook needs before it shows a plot or a widget: their JavaScript, from this machine."""

from __future__ import annotations

import sys
from typing import Any

import panel as pn

from hunting_app.pace import open_page

_loaded_by: list[tuple[Any, ...]] = []  # the cell that holds the JavaScript, and its run


def kernel() -> Any:
    """Return the notebook's shell; None in a server, a script or a terminal."""
    if open_page():
        return None
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return shell if hasattr(shell, "kernel") else None


def load() -> None:
    """Send the JavaScript into the output of the running cell; elsewhere do nothing.

    Once is enough for all cells below, but a cell that runs again has lost its output: then once
    more.
    """
    shell = kernel()
    if shell is None:
        return
    cell = shell.get_parent().get("metadata", {}).get("cellId")
    run = (cell, shell.execution_count)
    if _loaded_by and (run == _loaded_by[0] or cell != _loaded_by[0][0]):
        return
    _loaded_by[:] = [run]
    import holoviews as hv  # a second; only notebooks need it at once

    hv.extension("bokeh", inline=True, logo=False)  # Bokeh's and Panel's, the larger part
    pn.extension(inline=True)  # stylesheets, too
    from holoviews.core.dimension import LabelledData

    hv.Store.set_display_hook("html+js", LabelledData, _shown)


def _shown(view: Any) -> Any:
    """Show a HoloViews object as Panel does: HoloViews itself leaves stylesheets on a CDN."""
    return pn.pane.HoloViews(view, sizing_mode="stretch_width")._repr_mimebundle_()
