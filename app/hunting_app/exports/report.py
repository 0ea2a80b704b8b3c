"""The report: one page of HTML that opens without a network, its plots still interactive."""

from __future__ import annotations

from datetime import date
from functools import cache
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from bokeh.document import Document
from bokeh.embed import components
from bokeh.resources import Resources

from hunting_app import link, words
from hunting_app.blocks import LAYOUT, said
from hunting_app.equations import SOURCES
from hunting_app.formula import with_subscripts
from hunting_app.markup import STYLE
from hunting_app.palette import LIGHT
from hunting_app.parameter_table import parameter_table
from hunting_app.plots.bifurcation import Bifurcation
from hunting_app.plots.feed import Feed
from hunting_app.plots.history import History, Motion
from hunting_app.plots.portraits import Portraits
from hunting_app.plots.stability import Damping, Locus
from hunting_app.state import PRESETS, VEHICLES

if TYPE_CHECKING:
    from hunting_app.disturbance import Disturbed
    from hunting_app.picture import Picture
    from hunting_app.plots.base import Plot
    from hunting_app.state import State

_STYLE = (Path(__file__).parent / "report.css").read_text(encoding="utf-8")


def report(state: State, shown: Picture, motion: Disturbed | None, verdict: str) -> str:
    """Return the page.

    Parameters
    ----------
    state : State
        The choices that `shown` follows from.
    shown : Picture
        What the page shows.
    motion : Disturbed or None
        What a disturbance does, if one is shown.
    verdict : str
        What is said of `motion`, as HTML.
    """
    plots = _plots(state, shown, motion)
    page = Document()
    with page.models.freeze():  # else what they refer to is collected anew for each of them
        for plot in plots.values():
            page.add_root(plot.figure)
    script, divs = components({name: plot.figure for name, plot in plots.items()})
    vehicles = " and ".join(shown.answers)
    title = f"Hunting of the {vehicles}"
    drawn = {name: f'<div class="plot {name}">{div}</div>' for name, div in divs.items()}
    portraits = "".join(drawn[name] for name in drawn if name.startswith("portrait"))
    lanes = "".join(drawn[name] for name in drawn if name.startswith("history"))
    moved = f"<section><h2>Simulated motion</h2>{verdict}{lanes}</section>" if motion else ""
    warnings = "".join(
        f'<p class="warning">{escape(w)}</p>' for w in words.warnings(shown).values()
    )
    table = parameter_table({"value": state.parameters, PRESETS[state.preset].label: state.base()})
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{LAYOUT}{STYLE}{_STYLE}</style>
{_bokeh()}
</head>
<body><main>
<h1>{title}</h1>
<p>Parameters: {escape(words.provenance(state))} Forward speed {shown.speed:.4g} km/h.
Made on {date.today():%d %B %Y} with bogie-hunting {version("bogie-hunting")}.</p>
<section>{words.answers(shown)}{warnings}</section>
<section><h2>Bifurcation diagram</h2>{said(words.diagram(shown))}{words.legend(shown)}
{drawn["bifurcation"]}</section>
<section><h2>Phase portraits</h2>{said(words.portraits(shown))}
<div class="row">{portraits}</div></section>
{moved}
<section><h2>Stability of the centred motion</h2>{said(words.stability(shown))}
<div class="row">{drawn["damping"]}{drawn["locus"]}</div></section>
<section><h2>Parameters</h2>{table}</section>
<section><h2>Method</h2>{_method(state, shown)}</section>
</main>{script}</body>
</html>
"""


@cache
def _bokeh() -> str:
    """What draws and moves the plots; mathematics and widgets stay out."""
    scripts = Resources(mode="inline", components=["bokeh"]).js_raw
    return "".join(f"<script>{script}</script>" for script in scripts)


def _plots(state: State, shown: Picture, motion: Disturbed | None) -> dict[str, Plot]:
    """Return all plots with their data, in light colours: a report is printed."""
    feed = Feed()
    bifurcation, portraits = Bifurcation(feed), Portraits(feed)
    stability = {"damping": Damping(feed, bifurcation.cursor), "locus": Locus(feed)}
    plots: dict[str, Plot] = {"bifurcation": bifurcation, **stability}
    plots |= {f"portrait-{symbol}": plot for symbol, plot in portraits.plots.items()}
    if motion is not None:
        curves = Motion(feed)
        portraits.follow(curves.sources)
        history = History(feed, curves.sources)
        plots |= {f"history-{symbol}": lane for symbol, lane in history.lanes.items()}
        reach = curves.put(motion)
        portraits.include(reach)
        history.draw(reach, motion)
        history.show(motion.trajectory.system.symbols)
    for plot in plots.values():
        plot.dress(LIGHT)
        plot.show_vehicles(set(VEHICLES[state.vehicle]))
        plot.draw_baseline(shown)
    bifurcation.draw(shown, averaging=state.averaged == "shown")
    bifurcation.draw_moment(shown)
    portraits.draw_moment(shown)
    for plot in stability.values():
        plot.draw(shown)
        plot.draw_moment(shown)
    feed.send()
    return plots


def _method(state: State, shown: Picture) -> str:
    """How all this was computed, from what, and how to get it again."""
    exact = [one.exact for one in shown.answers.values() if one.exact is not None]
    statements = [
        "V_lin is a Hopf point: the speed above which the centred motion stays unstable, from the "
        "eigenvalues of the linear equations, without a grid of speeds.",
        "Averaged limit cycles are those of Bogoliubov's first order, the method of the paper.",
        "Simulated motions integrate the full nonlinear equations over time, with the instants of "
        "flange contact located.",
        "The wheelset runs on linear creep; creep saturation and a second wheelset are not in the "
        "model.",
    ]
    if exact:
        harmonics = max(max(branch.orders) for branch in exact)
        statements.insert(
            1,
            "Exact limit cycles, and V_nl from them, come from harmonic balance with "
            f"harmonics up to order {harmonics}; their stability from Floquet multipliers.",
        )
    items = "".join(f"<li>{with_subscripts(text)}</li>" for text in statements)
    used = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "bokeh"))
    sources = "".join(f"<li>{escape(source)}</li>" for source in SOURCES)
    query = escape(link.query(state))
    again = f"with <code>{query}</code> behind its address" if query else "as it opens"
    return (
        f"<ul>{items}</ul><p>Sources:</p><ul>{sources}</ul>"
        f"<p>bogie-hunting {version('bogie-hunting')}, {used}. The dashboard shows the same "
        f"picture {again}.</p>"
    )
