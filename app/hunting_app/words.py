"""What the picture says, in words and numbers."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

from hunting_app.glossary import GLOSSARY, bubbled, term
from hunting_app.picture import KMH, MM
from hunting_app.state import PRESETS, State

if TYPE_CHECKING:
    from hunting.critical_speeds import CriticalSpeeds
    from hunting_app.picture import Answers, Moment, Picture

_TERMS = {
    "V<sub>nl</sub>": "nonlinear critical speed",
    "V<sub>lin</sub>": "linear critical speed",
    "band": "conditional band",
    "f": "hunting frequency",
    "L": "wavelength",
}

_LINE = '<svg width="26" height="10" aria-hidden="true"><path d="M1 5h24" class="{}"/></svg>'
_DOT = '<svg width="12" height="12" aria-hidden="true"><path d="{}" class="mark"/></svg>'
_KEY = (
    (_LINE.format("stable"), "stable limit cycle", "stable limit cycle: hunting"),
    (_LINE.format("unstable"), "unstable limit cycle", "unstable limit cycle: the threshold"),
    (_LINE.format("averaged"), "averaged", "averaged"),
    (_DOT.format("M6 2a4 4 0 1 0 .01 0z"), "Hopf point", "Hopf point"),
    (_DOT.format("M6 0l4 6-4 6-4-6z"), "fold", "fold"),
    (_LINE.format("clearance"), "flange clearance", "flange clearance δ"),
    ('<i class="safe"></i>', "safe", "safe"),
    ('<i class="conditional"></i>', "conditional", "conditional"),
    ('<i class="hunting"></i>', "hunting", "hunting"),
)


def legend(shown: Picture) -> str:
    """What the marks of the bifurcation diagram mean."""
    entries = [*_KEY]
    if len(shown.answers) > 1:
        whose = next(iter(shown.answers))
        entries = [
            (mark, word, f"{label} ({whose})" if mark.startswith("<i") else label)
            for mark, word, label in entries
        ]
    if shown.baseline:
        entries.append((_LINE.format("baseline"), "baseline", "baseline"))
    items = "".join(term(word, f"{mark} {label}", tag="li") for mark, word, label in entries)
    return f'<ul class="legend" aria-label="legend">{items}</ul>'


def answers(shown: Picture) -> str:
    """The critical speeds of each vehicle, as a strip of HTML."""
    return "".join(_answer_row(one, shown.baseline.get(v)) for v, one in shown.answers.items())


def _answer_row(one: Answers, baseline: Answers | None) -> str:
    critical = one.critical
    before = _quantities(baseline) if baseline else {}
    values = {
        symbol: _number(value, unit, digits)
        + (_change(value, before[symbol][0], unit, digits) if before else "")
        for symbol, (value, unit, digits) in _quantities(one).items()
    }
    notes = {"V<sub>nl</sub>": _method(one)}
    cells = "".join(
        f'<div class="answer {"big" if i < 2 else ""}" data-answer="{_TERMS[symbol]}">'
        f"<dt>{term(_TERMS[symbol], f'<b>{symbol}</b> {_TERMS[symbol]}')}</dt>"
        f"<dd>{value}{notes.get(symbol, '')}</dd></div>"
        for i, (symbol, value) in enumerate(values.items())
    )
    kind = _kind(critical)
    kind = term(kind) if kind in GLOSSARY else escape(kind)
    if baseline and (was := _kind(baseline.critical)) != _kind(critical):
        kind = f"{kind}; baseline: {escape(was)}"
    return (
        f'<section class="answers {one.vehicle}" aria-label="critical speeds of the {one.vehicle}">'
        f'<h2><i></i>{one.vehicle}<span class="kind">{kind}</span></h2>'
        f"<dl>{cells}</dl>"
        "</section>"
    )


def _quantities(one: Answers) -> dict[str, tuple[float, str, int]]:
    """Return each answer, its unit and its decimals."""
    critical = one.critical
    linear, nonlinear = KMH * float(critical.linear), KMH * float(critical.nonlinear)
    hertz = float(critical.frequency) / (2 * math.pi)
    return {
        "V<sub>nl</sub>": (nonlinear, "km/h", 1),
        "V<sub>lin</sub>": (linear, "km/h", 1),
        "band": (linear - nonlinear, "km/h", 1),
        "f": (hertz, "Hz", 2),
        "L": (linear / KMH / hertz if hertz else math.nan, "m", 1),
    }


def _kind(critical: CriticalSpeeds) -> str:
    return str(critical.criticality if critical.criticality != "none" else critical.message)


def _change(now: float, before: float, unit: str, digits: int) -> str:
    """Return the change against the baseline, of the numbers as they are shown."""
    if not math.isfinite(before):
        text = "baseline: none" if math.isfinite(now) else ""
    elif not math.isfinite(now):
        text = f"baseline: {before:.{digits}f} {unit}"
    else:
        change = round(now, digits) - round(before, digits)
        text = f"{change:+.{digits}f} {unit}".replace("-", "−") if abs(change) > 1e-9 else "±0"
    return f'<span class="change" title="change against the baseline">{text}</span>' if text else ""


def _method(one: Answers) -> str:
    """Which method V_nl comes from, and how far averaging is off."""
    if one.exact is None:
        return '<small class="method">by averaging</small>'
    off = one.error_of_averaging
    if not math.isfinite(one.critical.nonlinear):
        return ""
    if math.isnan(off):
        return '<small class="method">exact</small>'
    averaged = KMH * float(one.averaging.nonlinear)
    way = "high" if off > 0 else "low"
    return (
        f'<small class="method">exact; averaging says {averaged:.1f}, '
        f"{abs(off):.1f} km/h too {way}</small>"
    )


def _number(value: float, unit: str, digits: int = 1) -> str:
    if not math.isfinite(value):
        return '<span class="none">none</span>'
    return f"{value:.{digits}f}<small> {unit}</small>"


def diagram(shown: Picture) -> str:
    """The bifurcation diagram, read aloud."""
    return " ".join(
        _diagram(one, shown.moments[v], shown.speed) for v, one in shown.answers.items()
    )


def _diagram(one: Answers, moment: Moment, speed: float) -> str:
    start = f"At {speed:.4g} km/h this {one.vehicle}"
    threshold = next((c for c in moment.cycles if not c.stable), None)
    hunt = next((c for c in reversed(moment.cycles) if c.stable), None)
    amplitude = f" with an amplitude of {MM * hunt.amplitude:.1f} mm" if hunt else ""
    if one.unstable_everywhere:
        return f"{start} hunts: its centred motion is unstable at every speed looked at."
    if not math.isfinite(one.critical.linear):
        return (
            f"{start} runs stably: there is {one.critical.message} (3.6 to 1440 km/h). Small "
            "disturbances die out at every speed, and no limit cycle branches off."
        )
    if not moment.centre_is_stable:
        in_window = speed < KMH * float(one.critical.linear)
        where = ", in its low-speed window" if in_window else ""
        known = "" if hunt or in_window else ": the branch of limit cycles ends before this speed"
        return f"{start} hunts by itself{where}{amplitude}{known}."
    if threshold:
        size = MM * threshold.amplitude
        return (
            f"{start} is conditionally stable: "
            f"a disturbance above {size:.1f} mm makes it hunt{amplitude}."
        )
    if speed > one.lowest:
        return f"{start} is stable against small disturbances; the branch ends before this speed."
    return f"{start} is safe: every disturbance dies out."


def warnings(shown: Picture) -> dict[str, str]:
    """What a reader of the answers must know besides, by a short name for each."""
    several = len(shown.answers) > 1
    return {
        f"{vehicle}: {short}" if several else short: text
        for vehicle, one in shown.answers.items()
        for short, text in _warnings(one).items()
    } | _pushing_damper(shown)


def warning_signs(shown: Picture) -> str:
    """The short names in a row, as HTML; each has its sentence in a bubble."""
    signs = "".join(bubbled(short, text, tag="li") for short, text in warnings(shown).items())
    return f'<ul class="warnings" aria-label="warnings">{signs}</ul>' if signs else ""


def _warnings(one: Answers) -> dict[str, str]:
    found = {}
    for low, high in one.critical.windows:
        at = f"{KMH * low:.0f} to {KMH * high:.0f} km/h"
        found[f"hunts at {at}, too"] = (
            f"The {one.vehicle} also hunts from {at} (a low-speed window, primary hunting)."
        )
    if not math.isfinite(one.critical.linear):
        return found
    message, end = str(one.critical.message), str(one.branch.message)
    if message:
        found["no fold"] = f"{one.vehicle}: {message}."
    if end and end not in message and one.branch.speed.size:
        at = f"{KMH * one.branch.speed[-1]:.0f} km/h"
        found[f"branch ends at {at}"] = f"{one.vehicle}: {end} (at {at})."
    return found


def _pushing_damper(shown: Picture) -> dict[str, str]:
    """Say so where the yaw damper's force helps the motion it should brake."""
    for one in shown.answers.values():
        if one.damper_pushes is not None:
            low, high = one.damper_pushes
            at = f"from {low:.3g} to {high:.3g} m/s" if high < math.inf else f"above {low:.3g} m/s"
            text = f"The yaw damper pushes instead of braking {at}, and limit cycles are that fast."
            return {"yaw damper pushes": text}
    return {}


def portraits(shown: Picture) -> str:
    """The phase portraits, read aloud."""
    parts = []
    for vehicle, moment in shown.moments.items():
        cycles = ", ".join(
            f"{'stable' if c.stable else 'unstable'} cycle of {MM * c.amplitude:.1f} mm "
            f"({c.frequency / (2 * math.pi):.2f} Hz)"
            for c in moment.cycles
        )
        centre = "stable" if moment.centre_is_stable else "unstable"
        parts.append(f"{vehicle}: {cycles or 'no limit cycle'}, centre {centre}.")
    return f"At {shown.speed:.4g} km/h, {' '.join(parts)}"


def stability(shown: Picture) -> str:
    """The damping curves, read aloud."""
    parts = []
    for vehicle, moment in shown.moments.items():
        s, ratio = moment.eigenvalues[moment.damping.argmin()], 100 * moment.damping.min()
        verb = "is damped by" if ratio >= 0 else "grows, with a damping ratio of"
        rate = f", at {abs(s.imag) / (2 * math.pi):.2f} Hz" if s.imag else ""
        parts.append(f"the {vehicle}'s least damped mode {verb} {ratio:.2f} %{rate}")
    return f"At {shown.speed:.4g} km/h {' and '.join(parts)}.".replace("-", "−")


def provenance(state: State) -> str:
    """Whose numbers these are."""
    changed = len(state.changed())
    note = PRESETS[state.preset].note
    return f"{note} {changed} changed." if changed else note
