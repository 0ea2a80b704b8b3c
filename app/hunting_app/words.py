"""What the picture says, in words and numbers."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

from hunting_app.picture import KMH, MM
from hunting_app.state import PRESETS, State

if TYPE_CHECKING:
    from hunting.critical_speeds import CriticalSpeeds
    from hunting_app.picture import Answers, Moment, Picture

_TERMS = {
    "V<sub>nl</sub>": (
        "nonlinear critical speed",
        "Below it every motion dies out, whatever the disturbance.",
    ),
    "V<sub>lin</sub>": (
        "linear critical speed",
        "Above it the bogie hunts by itself: the centred motion is unstable.",
    ),
    "band": (
        "conditional band",
        "Between the two speeds it depends on the size of the disturbance.",
    ),
    "f": ("hunting frequency", "Frequency of the motion at V_lin."),
    "λ": ("wavelength", "Distance travelled in one hunting period at V_lin."),
}

_LINE = '<svg width="26" height="10" aria-hidden="true"><path d="M1 5h24" class="{}"/></svg>'
_DOT = '<svg width="12" height="12" aria-hidden="true"><path d="{}" class="mark"/></svg>'
_KEY = (
    (_LINE.format("stable"), "stable limit cycle", "Neighbouring motions approach it."),
    (
        _LINE.format("unstable"),
        "unstable limit cycle",
        "Larger disturbances grow, smaller die out.",
    ),
    (_LINE.format("averaged"), "averaged", "Bogoliubov's first order, the paper's method."),
    (_DOT.format("M6 2a4 4 0 1 0 .01 0z"), "Hopf point", "The centred motion loses stability."),
    (_DOT.format("M6 0l4 6-4 6-4-6z"), "fold", "The lowest speed at which a limit cycle exists."),
    (_LINE.format("clearance"), "flange clearance δ", "Beyond it the flange touches the rail."),
    ('<i class="safe"></i>', "safe", "Every motion dies out."),
    ('<i class="conditional"></i>', "conditional", "It depends on the disturbance."),
    ('<i class="hunting"></i>', "hunting", "Any disturbance grows."),
)


def legend(shown: Picture) -> str:
    """What the marks of the bifurcation diagram mean."""
    entries = [*_KEY]
    if len(shown.answers) > 1:
        whose = next(iter(shown.answers))
        entries = [
            (mark, f"{label} ({whose})" if mark.startswith("<i") else label, note)
            for mark, label, note in entries
        ]
    if shown.baseline:
        note = "The design that was pinned: everything is compared with it."
        entries.append((_LINE.format("baseline"), "baseline", note))
    items = "".join(f'<li title="{note}">{mark} {label}</li>' for mark, label, note in entries)
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
        f'<div class="answer {"big" if i < 2 else ""}" data-answer="{escape(_TERMS[symbol][0])}">'
        f'<dt title="{escape(_TERMS[symbol][1])}"><b>{symbol}</b> {_TERMS[symbol][0]}</dt>'
        f"<dd>{value}</dd>{notes.get(symbol, '')}</div>"
        for i, (symbol, value) in enumerate(values.items())
    )
    kind = _kind(critical)
    if baseline and (was := _kind(baseline.critical)) != kind:
        kind = f"{kind}; baseline: {was}"
    return (
        f'<section class="answers {one.vehicle}" aria-label="critical speeds of the {one.vehicle}">'
        f'<h2><i></i>{one.vehicle}<span class="kind">{escape(str(kind))}</span></h2>'
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
        "λ": (linear / KMH / hertz if hertz else math.nan, "m", 1),
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
        return f"{start} hunts by itself{', in its low-speed window' * in_window}{amplitude}."
    if threshold:
        size = MM * threshold.amplitude
        return (
            f"{start} is conditionally stable: "
            f"a disturbance above {size:.1f} mm makes it hunt{amplitude}."
        )
    if speed > one.lowest:
        return f"{start} is stable against small disturbances; the branch ends before this speed."
    return f"{start} is safe: every disturbance dies out."


def warnings(shown: Picture) -> list[str]:
    """What a reader of the answers must know besides."""
    return [text for one in shown.answers.values() for text in _warnings(one)]


def _warnings(one: Answers) -> list[str]:
    found = [
        f"The {one.vehicle} also hunts from {KMH * low:.0f} to {KMH * high:.0f} km/h "
        "(a low-speed window, primary hunting)."
        for low, high in one.critical.windows
    ]
    if one.critical.message and math.isfinite(one.critical.linear):
        found.append(f"{one.vehicle}: {one.critical.message}.")
    return found


def portraits(shown: Picture) -> str:
    """The phase portraits, read aloud."""
    parts = []
    for vehicle, moment in shown.moments.items():
        cycles = ", ".join(
            f"{'a stable' if c.stable else 'an unstable'} cycle of {MM * c.amplitude:.1f} mm "
            f"at {c.frequency / (2 * math.pi):.2f} Hz"
            for c in moment.cycles
        )
        centre = "stable" if moment.centre_is_stable else "unstable"
        parts.append(f"{vehicle}: {cycles or 'no limit cycle'}; the centre is {centre}.")
    text = " ".join(parts)
    return f"At {shown.speed:.4g} km/h, {text}" + (
        " The wheelset's frame is held still (z = 0)." if "wheelset" in shown.moments else ""
    )


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
