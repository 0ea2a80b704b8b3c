"""What simulated motions do, in words."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from hunting_app.blocks import said
from hunting_app.disturbance import BESIDE, HORIZON, threshold
from hunting_app.picture import KMH, MM

if TYPE_CHECKING:
    from hunting.simulation import Decay
    from hunting_app.disturbance import Disturbed
    from hunting_app.picture import Answers, Moment

_FLANGE = "flange force"
_SHRUNK = 0.5  # the share below which what has not died out is said to be dying out


def invitation() -> str:
    """What to do while there is no motion."""
    return (
        "Click anywhere in the bifurcation diagram, or type a displacement above: that disturbance "
        "is simulated, and the motion is drawn here and on the phase portraits."
    )


def no_threshold(answers: Answers, moment: Moment, speed: float) -> str:
    """Why there is no unstable cycle to be beside of at this speed; empty if there is one."""
    if threshold(moment) is not None:
        return ""
    at = f"At {speed:.4g} km/h there is no unstable cycle: "
    linear = KMH * float(answers.critical.linear)
    if not math.isfinite(linear):
        return f"{at}this {answers.vehicle} has no limit cycles."
    if not moment.centre_is_stable:
        return f"{at}the centred motion is unstable itself, any disturbance grows."
    if speed < answers.lowest:
        return f"{at}every disturbance dies out."
    return f"{at}the branch does not reach this speed."


def motion(one: Disturbed, decay: Decay | None) -> str:
    """What was disturbed and how it ends, as HTML; `decay` is None while that is not known."""
    shape = "limit cycle" if one.from_cycle else "least damped mode"
    lines = [
        f'<p class="verdict"><i class="{role}"></i><b>{escape(verdict)}</b></p>'
        for role, verdict in zip(("motion", "hunting"), _verdicts(one, decay), strict=False)
    ]
    peak = float(np.max(one.trajectory.peak_forces[_FLANGE])) / 1e3
    force = f"peak flange force {peak:.1f} kN" if peak else "no flange contact"
    lasted = float(np.max(one.trajectory.ended))
    return "".join(lines) + said(
        f"The {one.vehicle} at {one.speed:.4g} km/h, disturbed in the shape of the {shape}."
        + (f" First {lasted:.2g} s: {force}." if lasted else "")
    )


def _verdicts(one: Disturbed, decay: Decay | None) -> list[str]:
    places = [""]
    if len(one.sizes) > 1:
        places = [f" ({share:g} of the unstable cycle)" for share in BESIDE]
    return [
        f"{MM * size:.2f} mm{place} {end}"
        for size, place, end in zip(one.sizes, places, _ends(one, decay), strict=True)
    ]


def _ends(one: Disturbed, decay: Decay | None) -> list[str]:
    if decay is None:
        return ["…" for _ in one.sizes]
    ends = zip(
        one.sizes,
        np.atleast_1d(decay.decided),
        np.atleast_1d(decay.amplitude),
        np.atleast_1d(decay.message).tolist(),
        strict=True,
    )
    return [
        message
        if decided or amplitude > _SHRUNK * size
        else f"is dying out: {MM * amplitude:.2f} mm left after {HORIZON:.0f} s"
        for size, decided, amplitude, message in ends
    ]
