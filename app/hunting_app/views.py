"""Views of branches, motions and eigenvalues for notebooks, by HoloViews; they only draw."""

from __future__ import annotations

from typing import Any

import holoviews as hv
import numpy as np

from hunting import (
    Branch,
    CriticalSpeeds,
    HopfPoints,
    LureSystem,
    SpeedRamp,
    Sweep,
    Trajectory,
    damping_ratios,
    eigenvalues,
    hopf_points,
)
from hunting.elements import Array
from hunting_app.disturbance import contacts
from hunting_app.numerals import rounded_up
from hunting_app.palette import Palette
from hunting_app.picture import KMH, MM
from hunting_app.plots.bifurcation import branch_columns
from hunting_app.plots.portraits import COORDINATES, Coordinate
from hunting_app.state import FIELDS
from hunting_app.study.dress import dressed, named

HEIGHT = 340
_SPEEDS = 160  # of a curve over speed
_FASTEST = 240.0  # km/h, where nothing says how far to look
_SLOW = -60.0  # 1/s; modes that decay faster are creep, far to the left of the locus
SPEED = hv.Dimension("V", label="forward speed V [km/h]")
AMPLITUDE = hv.Dimension("a", label="amplitude, peak |y| [mm]")
CRITICAL = hv.Dimension("Vc", label="critical speed V [km/h]")
TIME = hv.Dimension("t", label="time t [s]")

Dims = tuple[hv.Dimension, hv.Dimension]


def framed(
    parts: list[Any], dims: Dims, colours: Palette, name: str, described: str, **look: Any
) -> hv.Overlay:
    """Return an overlay in the page's dress."""
    across, upwards = dims
    return hv.Overlay(parts).opts(
        xlabel=across.label,
        ylabel=upwards.label,
        responsive=True,
        height=HEIGHT,
        show_grid=True,
        legend_position="top",
        legend_cols=4,
        hooks=[dressed(colours, name, described)],
        **look,
    )


def vehicle_of(system: LureSystem) -> str:
    """Return what a system is drawn as: a wheelset's frame does not move."""
    moves = set(system.symbols)
    return "bogie" if COORDINATES[-1].symbol in moves else "wheelset"


def diagram(branch: Branch, colours: Palette, label: str | None) -> hv.Overlay:
    """Return amplitude over speed: stable cycles solid, unstable ones dashed, Hopf point, fold."""
    is_exact = branch.multipliers is not None
    vehicle = vehicle_of(branch.system)
    name = label or f"{vehicle}, {'exact' if is_exact else 'averaged'}"
    colour = colours.vehicle(vehicle) if is_exact else colours.averaged
    columns = branch_columns(branch)
    delta = MM * float(np.max(branch.system.clearance))
    dims = (SPEED, AMPLITUDE)
    parts: list[Any] = [hv.HLine(delta).opts(color=colours.clearance, line_dash="dotted")]
    for column, look in (
        ("stable", {"line_width": 3 if is_exact else 1.5}),
        ("unstable", {"line_width": 2.5 if is_exact else 1.5, "line_dash": [7, 5]}),
    ):
        curve = hv.Curve((columns["V"], columns[column]), *dims, label=f"{name}, {column}")
        parts.append(curve.opts(color=colour, tools=["hover"], **look))
    start = (KMH * branch.speed[:1], MM * branch.amplitude[:1])
    parts.append(hv.Scatter(start, *dims).opts(color=colour, size=9))
    if branch.fold is not None:
        fold = [(KMH * float(branch.fold[0]), MM * float(branch.fold[1]))]
        parts.append(hv.Scatter(fold, *dims).opts(color=colour, size=12, marker="diamond"))
    return framed(
        parts,
        dims,
        colours,
        "bifurcation",
        "Bifurcation diagram",
        xlim=(0, _end(KMH * float(branch.speed[0])) if branch.speed.size else _FASTEST),
        ylim=(0, rounded_up(1.2 * delta)),
    )


def zones(speeds: CriticalSpeeds, colours: Palette) -> hv.Overlay:
    """Return the zones safe, conditional and hunting as stripes, to put under a branch."""
    linear, nonlinear = KMH * float(speeds.linear), KMH * float(speeds.nonlinear)
    if not np.isfinite(linear):
        raise ValueError(f"there are no zones to draw: {speeds.message}")
    lowest = nonlinear if np.isfinite(nonlinear) else linear
    end = _end(linear)
    windows = [(KMH * float(low), KMH * float(high)) for low, high in speeds.windows]
    stripes = [
        (0.0, lowest, "safe"),
        (lowest, linear, "conditional"),
        (linear, end, "hunting"),
        *((low, high, "hunting") for low, high in windows),
    ]
    parts = [
        hv.VSpan(low, high).opts(color=getattr(colours, zone), alpha=0.16)
        for low, high, zone in stripes
    ]
    dims = (SPEED, AMPLITUDE)
    return framed(parts, dims, colours, "zones", "Zones: safe, conditional, hunting", xlim=(0, end))


def history(motion: Trajectory, colours: Palette, coordinate: Coordinate) -> hv.Overlay:
    """Return a displacement over time, flange contact shaded."""
    dims = (TIME, _displacement(coordinate))
    parts: list[Any] = []
    for force in _each(motion.forces["flange force"], 1):
        for begin, end in zip(*contacts(motion.time, force), strict=True):
            stripe = hv.VSpan(float(begin), float(end))
            parts.append(stripe.opts(color=colours.hunting, alpha=0.25))
    for path, colour in zip(_of(motion, coordinate.symbol), _inks(colours), strict=False):
        parts.append(hv.Curve((motion.time, path), *dims).opts(color=colour, line_width=1))
    ends = (float(motion.time[0]), float(motion.time[-1]))
    return framed(parts, dims, colours, "history", "Motion over time", xlim=ends)


def portrait(motion: Trajectory, colours: Palette, coordinate: Coordinate) -> hv.Overlay:
    """Return a rate over its displacement."""
    symbol = coordinate.symbol
    paths = zip(_of(motion, symbol), _of(motion, f"{symbol}'"), _inks(colours), strict=False)
    dims = _plane(coordinate)
    parts = [hv.Path([(x, v)], list(dims)).opts(color=ink, line_width=1) for x, v, ink in paths]
    return framed(parts, dims, colours, "portrait", f"Phase portrait, {coordinate.label}")


def cycles(branch: Branch, colours: Palette, coordinate: Coordinate, speed: float) -> hv.Overlay:
    """Return the limit cycles at a speed [m/s] as closed curves."""
    symbols = branch.system.symbols
    at = [symbols.index(coordinate.symbol + rate) for rate in ("", "'")]
    colour, dims = colours.vehicle(vehicle_of(branch.system)), _plane(coordinate)
    parts = [
        hv.Path([MM * cycle.motion.state[:, at]], list(dims)).opts(
            color=colour, line_width=2.5, line_dash="solid" if cycle.stable else "dashed"
        )
        for cycle in branch.at_speed(speed)
    ]
    if not parts:
        raise ValueError(f"the branch has no limit cycle at {KMH * speed:.5g} km/h")
    return framed(parts, dims, colours, "portrait", f"Limit cycles, {coordinate.label}")


def damping(system: LureSystem, colours: Palette, speeds: Array | None) -> hv.Overlay:
    """Return the damping ratio of every mode over speed, with the Hopf points."""
    V = _speeds(system) if speeds is None else np.asarray(speeds, dtype=float)
    ratios = 100 * np.sort(damping_ratios(eigenvalues(system, V)), axis=-1)
    vehicle = vehicle_of(system)
    dims = (SPEED, hv.Dimension("ζ", label="damping ratio ζ [%]"))
    parts: list[Any] = [hv.HLine(0.0).opts(color=colours.hunting, line_width=1.5)]
    for k in range(0, min(5, ratios.shape[-1]), 2):  # a pair of eigenvalues is one mode
        curve = hv.Curve((KMH * V, ratios[:, k]), *dims, label=vehicle if k == 0 else "")
        look = {"color": colours.vehicle(vehicle), "line_width": 1.5 if k else 3}
        parts.append(curve.opts(tools=["hover"], **look))
    at = KMH * hopf_points(system).speed
    marks = hv.Scatter((at, np.zeros_like(at)), *dims)
    parts.append(marks.opts(color=colours.vehicle(vehicle), size=9))
    low, high = float(ratios[:, 0].min()), float(ratios[:, 0].max())
    reach = max(rounded_up(1.15 * high), 1.0)
    below = min(rounded_up(max(-1.1 * low, 0.3)), reach)
    return framed(
        parts,
        dims,
        colours,
        "damping",
        "Damping ratios over speed",
        ylim=(-below, reach),
        xlim=(0.0, KMH * float(V[-1])),
    )


def locus(system: LureSystem, colours: Palette, speeds: Array | None) -> hv.Overlay:
    """Return the eigenvalues in the upper half plane as the speed rises."""
    V = _speeds(system) if speeds is None else np.asarray(speeds, dtype=float)
    s = eigenvalues(system, V)
    here = (s.imag > 0) & (s.real > _SLOW)
    at = np.broadcast_to(KMH * V[:, None], s.shape)[here]
    dims = (
        hv.Dimension("re", label="growth rate Re s [1/s]"),
        hv.Dimension("im", label="Im s / 2π [Hz]"),
    )
    dots = hv.Points((s[here].real, s[here].imag / (2 * np.pi), at), list(dims), SPEED)
    parts = [
        hv.VLine(0.0).opts(color=colours.hunting, line_width=1.5),
        dots.opts(color="V", cmap="viridis", size=3, tools=["hover"], colorbar=True),
    ]
    return framed(parts, dims, colours, "locus", "Root locus")


def hopf_marks(points: HopfPoints, colours: Palette) -> hv.Overlay:
    """Return the frequency of each Hopf point over its speed."""
    dims = (SPEED, hv.Dimension("f", label="frequency f [Hz]"))
    parts = []
    for direction, label, look in (
        (1, "loses stability", {"color": colours.hunting}),
        (-1, "regains stability", {"color": colours.safe, "marker": "diamond"}),
    ):
        which = points.direction == direction
        at = (KMH * points.speed[which], points.frequency[which] / (2 * np.pi))
        parts.append(hv.Scatter(at, *dims, label=label).opts(size=10, tools=["hover"], **look))
    return framed(parts, dims, colours, "hopf", "Hopf points")


def ramp(found: SpeedRamp, colours: Palette) -> hv.Overlay:
    """Return the amplitude on the way up and on the way down."""
    V = KMH * found.speed
    parts = []
    for way, label, look in (
        (found.up, "speed rising", {"color": colours.motion, "marker": "triangle"}),
        (found.down, "speed falling", {"color": colours.hunting, "marker": "inverted_triangle"}),
    ):
        dots = hv.Scatter((V, MM * way), SPEED, AMPLITUDE, label=label)
        parts.append(dots.opts(size=6, tools=["hover"], **look))
    return framed(
        parts, (SPEED, AMPLITUDE), colours, "ramp", "Amplitude over a rising and a falling speed"
    )


def curves(found: Sweep, colours: Palette) -> hv.Overlay:
    """Return both critical speeds over the one parameter of a sweep."""
    ((name, x),) = found.axes.items()
    field = FIELDS[name]
    dims = (hv.Dimension(name, label=named(field)), CRITICAL)
    parts: list[Any] = [
        hv.VLine(float(getattr(found.parameters, name))).opts(color=colours.faint, line_width=1)
    ]
    for V, label, look in (
        (found.linear, "V_lin, linear", {"color": colours.hunting}),
        (found.nonlinear, "V_nl, nonlinear", {"color": colours.conditional, "line_dash": "dashed"}),
    ):
        curve = hv.Curve((x, KMH * V), *dims, label=label)
        parts.append(curve.opts(line_width=2.5, tools=["hover"], **look))
    return framed(parts, dims, colours, "sweep", "Critical speeds", logx=field.log)


def _end(linear: float) -> float:
    """Return where the speed axis ends [km/h], as on the page."""
    return 50.0 * float(np.ceil(1.25 * linear / 50.0))


def _speeds(system: LureSystem) -> Array:
    """Return speeds [m/s] to a little beyond the last Hopf point."""
    last = KMH * float(np.max(hopf_points(system).speed, initial=_FASTEST / KMH / 1.25))
    return np.linspace(1 / _SPEEDS, 1, _SPEEDS) * 1.25 * last / KMH


def _of(motion: Trajectory, symbol: str) -> Array:
    """Return a state [mm, mrad or per second] of each motion, one a row."""
    index = motion.system.symbols.index(symbol)
    return MM * _each(motion.state[..., index], 1)


def _each(values: Array, axes: int) -> Array:
    return values.reshape(-1, *values.shape[values.ndim - axes :])


def _displacement(c: Coordinate) -> hv.Dimension:
    return hv.Dimension(c.symbol, label=f"{c.label} [{c.unit}]")


def _plane(c: Coordinate) -> Dims:
    return _displacement(c), hv.Dimension(f"{c.symbol}'", label=c.rate)


def _inks(colours: Palette) -> list[str]:
    inks = (colours.motion, colours.hunting, colours.safe, colours.conditional, colours.faint)
    return list(inks) * 20
