"""The Model page: equations, misprints, presets and sources. It never changes."""

from __future__ import annotations

from html import escape

from hunting import RECONSTRUCTED, TABLE_1
from hunting_app.equations import (
    METHOD,
    MISPRINTS,
    MOTION,
    RECONSTRUCTION,
    SOURCES,
    Equation,
)
from hunting_app.formula import formula, with_subscripts
from hunting_app.parameter_table import parameter_table
from hunting_app.picture import KMH, picture

_PAPER = {"V_lin": (155.0, 151.0), "V_nl": (144.0, 140.0)}  # Fig. 3: wheelset, bogie [km/h]


def model_page() -> str:
    """Return the whole page as HTML."""
    presets = parameter_table(
        {"Table 1 as printed": TABLE_1, "Reconstructed": RECONSTRUCTED},
        "how it was reconstructed",
        RECONSTRUCTION,
    )
    return f"""
<article class="model">
<section><h1>The model</h1>
<p>A wheelset moves sideways (y) and turns about the vertical (ψ) between two rails. Springs and
dampers hold it in a bogie frame that moves sideways (z); yaw dampers resist its turning, not in
proportion to the speed of it; beyond the clearance δ the flange runs against the rail. Creep forces
between wheel and rail feed energy from the forward motion into the sideways one: above some speed
the bogie hunts.</p>{_equations(MOTION)}</section>
<section><h2>Averaging after Bogoliubov</h2>{_equations(METHOD)}</section>
<section><h2>Critical speeds</h2>
<p><b>V<sub>lin</sub></b>, the linear critical speed, is the Hopf point above which the centred
motion stays unstable. <b>V<sub>nl</sub></b>, the nonlinear critical speed, is the lowest speed at
which a limit cycle exists on the branch that begins there. Below V<sub>nl</sub> every disturbance
dies out (safe); between the two it depends on its size (conditional); above V<sub>lin</sub> any
disturbance grows (hunting). A frame on soft springs can add a window of instability at low
speed.</p>
{_fig_3()}</section>
<section><h2>Where the paper cannot be right</h2>{_misprints()}</section>
<section><h2>Presets</h2>
<p>The numbers of Table 1 as printed give no hunting at all: with the corrected equations neither
vehicle has a Hopf point below 900 km/h, while Fig. 3 shows 155 and 151 km/h. The reconstruction is
ours, not the paper's, and it is not unique: other sets come as near. Its damper force is negative
for 0.021 m/s < |b ψ′| < 0.41 m/s, which the paper's own bifurcation diagram needs.</p>
{presets}</section>
<section><h2>Sources</h2><ul>{"".join(f"<li>{escape(source)}</li>" for source in SOURCES)}</ul>
</section></article>"""


def _equations(equations: tuple[Equation, ...]) -> str:
    return "".join(
        f'<figure class="equation"><figcaption>{escape(e.name)}</figcaption>'
        f"{formula(e.formula)}"
        f'<span class="number">{f"(Eq. {e.number})" if e.number else ""}</span>'
        f"{f'<p>{e.note}</p>' if e.note else ''}</figure>"
        for e in equations
    )


def _fig_3() -> str:
    shown = picture(RECONSTRUCTED, "both", 145.0, exact=False).answers
    vehicles = ("wheelset", "bogie")
    ours = {
        "V_lin": [KMH * float(shown[v].critical.linear) for v in vehicles],
        "V_nl": [KMH * float(shown[v].critical.nonlinear) for v in vehicles],
    }
    rows = [
        ("the paper, Fig. 3", [*_PAPER["V_lin"], *_PAPER["V_nl"]], 0),
        ("reconstructed parameters", [*ours["V_lin"], *ours["V_nl"]], 2),
    ]
    body = "".join(
        f"<tr><th scope='row'>{name}</th>"
        + "".join(f"<td>{value:.{digits}f}</td>" for value in values)
        + "</tr>"
        for name, values, digits in rows
    )
    heads = "".join(
        f"<th scope='col'>{kind}, {vehicle}</th>"
        for kind in ("V<sub>lin</sub>", "V<sub>nl</sub>")
        for vehicle in vehicles
    )
    return (
        "<table class='numbers'><caption>Critical speeds by averaging [km/h]</caption>"
        f"<thead><tr><td></td>{heads}</tr></thead><tbody>{body}</tbody></table>"
    )


def _misprints() -> str:
    rows = "".join(
        f"<tr><td>{i}</td>" + "".join(f"<td>{with_subscripts(text)}</td>" for text in m) + "</tr>"
        for i, m in enumerate(MISPRINTS, start=1)
    )
    return (
        "<table><thead><tr><th scope='col'>#</th><th scope='col'>printed</th>"
        "<th scope='col'>why it cannot be meant</th><th scope='col'>used here</th></tr></thead>"
        f"<tbody>{rows}</tbody></table>"
    )
