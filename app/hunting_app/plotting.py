"""One call that draws whatever the model returns, for notebooks and scripts."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

import holoviews as hv
from numpy.typing import ArrayLike

from hunting import (
    Branch,
    CriticalSpeeds,
    Design,
    Figure,
    HopfPoints,
    Indices,
    LureSystem,
    Sensitivity,
    SpeedRamp,
    Sweep,
    Trajectory,
    Uncertainty,
)
from hunting_app import notebook, views
from hunting_app.palette import palette
from hunting_app.picture import KMH
from hunting_app.plots.portraits import COORDINATES, Coordinate
from hunting_app.study.bars import sensitivity_bars
from hunting_app.study.figures import family
from hunting_app.study.limits import histogram, index_bars
from hunting_app.study.map import speed_map
from hunting_app.study.target import change_bars

_COORDINATES = {c.symbol: c for c in COORDINATES} | {"psi": COORDINATES[1]}


def plot(x: Any, /, *, dark: bool = False, **options: Any) -> hv.Overlay:
    """Return a view of what the model returns, with the page's colours, labels and units.

    Views lie on top of each other with ``*`` and side by side with ``+``.

    Parameters
    ----------
    x : object
        ========================  ========================================================
        Branch                    bifurcation diagram; with ``speed=`` [m/s] its limit cycles
                                  there as a phase portrait; ``label=`` for the legend
        CriticalSpeeds            the zones safe, conditional, hunting: to put under a branch
        Trajectory                displacement over time; ``against="rate"``: phase portrait
        LureSystem                damping ratios over speed; ``kind="locus"``: root locus;
                                  ``speeds=`` [m/s]
        HopfPoints                frequencies over speed
        SpeedRamp                 amplitude on the way up and down
        Figure, Sweep             curves over one parameter; over two a map, of ``quantity=``
                                  "nonlinear", "linear" or "band"
        Sensitivity, Design       bars
        Uncertainty               histogram; ``speed=`` [m/s] marks the operating speed
        Indices                   bars: what explains the scatter
        ========================  ========================================================

    dark : bool, default False
        Light on dark instead of dark on light.
    **options
        As above; for motions and limit cycles also ``coordinate=``, one of "y", "ψ" (or "psi")
        and "z".

    Returns
    -------
    holoviews.Overlay

    Raises
    ------
    TypeError
        If there is no view of such an object, or an option is not one of its own.
    ValueError
        If there is nothing to draw.

    Examples
    --------
    >>> from hunting import RECONSTRUCTED, averaged_branch, bogie, critical_speeds, limit_cycles
    >>> from hunting_app import plot
    >>> system = bogie(RECONSTRUCTED)
    >>> both = plot(limit_cycles(system)) * plot(averaged_branch(system))
    >>> zones = plot(critical_speeds(system))
    >>> type(zones * both).__name__, type(both + plot(system)).__name__
    ('Overlay', 'Layout')
    """
    notebook.load()
    return _composable(_view(x, palette(dark), **options))


@singledispatch
def _view(x: Any, _colours: Any, **_options: Any) -> hv.Overlay:
    known = sorted(kind.__name__ for kind in _view.registry if kind is not object)
    raise TypeError(f"cannot plot a {type(x).__name__}; there are views of {', '.join(known)}")


@_view.register
def _branch(
    x: Branch,
    colours: Any,
    *,
    speed: float | None = None,
    coordinate: str = "y",
    label: str | None = None,
) -> hv.Overlay:
    if x.speed.ndim > 1:
        raise ValueError(f"choose one branch of the stack of shape {x.speed.shape[:-1]}")
    if speed is None:
        return views.diagram(x, colours, label)
    return views.cycles(x, colours, _named(coordinate), speed)


@_view.register
def _speeds(x: CriticalSpeeds, colours: Any) -> hv.Overlay:
    return views.zones(x, colours)


@_view.register
def _motion(
    x: Trajectory, colours: Any, *, coordinate: str = "y", against: str = "time"
) -> hv.Overlay:
    draw = {"time": views.history, "rate": views.portrait}
    return _choice("against", against, draw)(x, colours, _named(coordinate))


@_view.register
def _system(
    x: LureSystem, colours: Any, *, kind: str = "damping", speeds: ArrayLike | None = None
) -> hv.Overlay:
    return _choice("kind", kind, {"damping": views.damping, "locus": views.locus})(
        x, colours, speeds
    )


@_view.register
def _hopf(x: HopfPoints, colours: Any) -> hv.Overlay:
    return views.hopf_marks(x, colours)


@_view.register
def _ramp(x: SpeedRamp, colours: Any) -> hv.Overlay:
    return views.ramp(x, colours)


@_view.register
def _figure(x: Figure, colours: Any) -> hv.Overlay:
    if x.sweep is not None:
        return family(x, colours)
    parts = [views.diagram(b, colours, f"{name}") for name, b in x.branches.items()]
    return hv.Overlay([_composable(part) for part in parts]).collate()


@_view.register
def _sweep(x: Sweep, colours: Any, *, quantity: str = "nonlinear") -> hv.Overlay:
    if len(x.axes) == 1:
        return views.curves(x, colours)
    if len(x.axes) == 2:
        known = {name: name for name in ("nonlinear", "linear", "band")}
        return speed_map(x, _choice("quantity", quantity, known), colours)[0]
    raise ValueError(f"a sweep over {len(x.axes)} parameters has no view; one or two have")


@_view.register
def _sensitivity(x: Sensitivity, colours: Any) -> hv.Overlay:
    return sensitivity_bars(x, colours)


@_view.register
def _design(x: Design, colours: Any) -> hv.Overlay:
    return change_bars(x, colours)


@_view.register
def _uncertainty(x: Uncertainty, colours: Any, *, speed: float | None = None) -> hv.Overlay:
    return histogram(x, float("nan") if speed is None else KMH * speed, colours)


@_view.register
def _indices(x: Indices, colours: Any) -> hv.Overlay:
    return index_bars(x, colours)


def _named(coordinate: str) -> Coordinate:
    return _choice("coordinate", coordinate, _COORDINATES)


def _choice(name: str, value: str, known: dict[str, Any]) -> Any:
    if value not in known:
        raise ValueError(f"{name} must be one of {', '.join(known)}, got {value!r}")
    return known[value]


def _composable(view: hv.Overlay) -> hv.Overlay:
    """Give the look of an overlay to its parts too: ``*`` keeps theirs alone."""
    look = view.opts.get("plot").kwargs
    for part in view:
        known = hv.Store.options(backend="bokeh")[type(part).__name__].groups["plot"]
        part.opts(**{k: v for k, v in look.items() if k in known.allowed_keywords})
    return view
