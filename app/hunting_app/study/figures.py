"""Figures 4 to 14 of the paper for the present design, with the paper's claims judged."""

from __future__ import annotations

from concurrent.futures import Executor, as_completed
from html import escape
from typing import Any

import holoviews as hv
import numpy as np
import panel as pn

from hunting import Cancelled, Claim, Figure, claims, figure
from hunting.cases import Progress
from hunting_app.palette import Palette
from hunting_app.picture import KMH
from hunting_app.study.dress import dressed, named, ramp, shown
from hunting_app.study.section import Section, download, markup, part

NUMBERS = tuple(range(4, 15))
_HEIGHT = 370


_KEPT = 8  # designs: most visitors begin with the same
_KNOWN: dict[tuple[Any, ...], tuple[dict[int, Figure], tuple[Claim, ...]]] = {}


class Figures(Section):
    """Eleven families of curves."""

    key = "figures"
    label = "Figures 4 to 14"
    call = "Compute the figures"
    things = "steps"
    explained = (
        "Each figure varies one parameter and leaves the others as they are on the sliders. Its "
        "five colours are five lateral stiffnesses K<sub>y</sub>, from half to twice the present "
        "one. <b>Solid: linear critical speed V<sub>lin</sub></b>, above which the vehicle hunts "
        "by itself. <b>Dashed: nonlinear critical speed V<sub>nl</sub></b>, below which every "
        "motion dies out. The grey line marks the present design. Under each figure stands what "
        "the paper says about it, and whether these curves agree."
    )

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.fresh: dict[int, Figure] = {}  # in the order in which they came
        self.cards = {number: _Card(number, self) for number in NUMBERS}
        self.body.append(part("gallery", *self.cards.values()))

    def opened(self) -> None:
        """Compute at once what is not there."""
        if (self.result is None and self.job is None) or self.outdated():
            self.start()

    def work(self, executor: Executor, progress: Progress) -> Any:
        """Show figures as they come, then judge the claims about them all."""
        total = len(NUMBERS) + 1
        key = (self.vehicle, *self.parameters.to_dict().values())
        if key in _KNOWN:
            self.fresh = _KNOWN[key][0]
            for done in range(len(self.fresh) + 1):
                _tell(progress, done, total)
            return _KNOWN[key]
        futures = [executor.submit(figure, n, self.parameters, self.model) for n in NUMBERS]
        found: dict[int, Figure] = {}
        self.fresh = found
        try:
            _tell(progress, 0, total)
            for future in as_completed(futures):
                one: Figure = future.result()
                found[one.number] = one
                _tell(progress, len(found), total)
        finally:
            for future in futures:
                future.cancel()
        judged = executor.submit(claims, found, self.parameters).result()
        _KNOWN[key] = dict(sorted(found.items())), judged
        while len(_KNOWN) > _KEPT:
            _KNOWN.pop(next(iter(_KNOWN)), None)
        return dict(sorted(found.items())), judged

    def show_progress(self, done: int, total: int) -> None:
        """Move the bar and draw what has come."""
        super().show_progress(done, total)
        if done:  # one at a time: meanwhile other visitors get their turn
            one = list(self.fresh.values())[min(done, len(self.fresh)) - 1]
            self.cards[one.number].draw(one)

    def draw(self) -> None:
        """Write the verdicts under the figures."""
        figures, judged = self.result
        for number, one in figures.items():
            self.cards[number].draw(one)
            self.cards[number].judge([c for c in judged if c.figure == number])
        general = [c for c in judged if c.figure in (None, 3)]
        agreed = sum(c.holds for c in judged)
        self.said.html = (
            f"<p><b>{agreed} of the paper’s {len(judged)} statements hold</b> for this design. "
            f"Those about Fig. 3 and about all figures:</p>{verdicts(general)}"
        )

    def redraw(self) -> None:
        """Draw in other colours."""
        for card in self.cards.values():
            if card.figure is not None:
                card.draw(card.figure)
        if self.result is not None:
            self.draw()

    def csv(self) -> str:
        """Return all figures, one after the other."""
        figures, judged = self.result
        said = "".join(f"# {claim}\n" for claim in judged)
        parts = (f"# {one.title}\n{one.csv()}" for one in figures.values())
        return said + "\n".join(parts)


def _tell(progress: Progress, done: int, total: int) -> None:
    if progress(done, total) is False:
        raise Cancelled(f"cancelled after {done} of {total} steps")


class _Card:
    """One figure with what is said of it."""

    def __init__(self, number: int, section: Figures) -> None:
        self.number, self.section = number, section
        self.figure: Figure | None = None
        self._drawn: tuple[Figure, bool] | None = None
        self.title, self.verdict = markup(), markup()
        self.plot = part("plot")
        self.download = part("download")
        self.title.html = f"<h2>Fig. {number}</h2>"

    def draw(self, one: Figure) -> None:
        """Draw a figure, unless it is there."""
        if (one, self.section.state.dark) == self._drawn:
            return
        self.figure, self._drawn = one, (one, self.section.state.dark)
        self.title.html = f"<h2>{escape(one.title)}</h2>"
        self.verdict.html = f"{gaps(one)}<p>The verdict comes with the last figure.</p>"
        self.plot[:] = [shown(family(one, self.section.colours), _HEIGHT)]
        if not len(self.download):
            self.download.append(download(self._csv, f"figure-{self.number}.csv"))

    def judge(self, judged: list[Claim]) -> None:
        """Say what the paper claims and whether it holds."""
        assert self.figure is not None
        self.verdict.html = gaps(self.figure) + verdicts(judged)

    def _csv(self) -> str:
        assert self.figure is not None
        return f"# {self.figure.title}\n{self.figure.csv()}"

    def __panel__(self) -> pn.viewable.Viewable:
        """Title, plot, words."""
        return part("family", self.title, self.plot, self.verdict, self.download)


def family(one: Figure, colours: Palette) -> hv.Overlay:
    """Return the curves of one figure."""
    assert one.sweep is not None
    assert one.field is not None
    sweep, field = one.sweep, one.field
    K_y, x = sweep.axes["Ky"], sweep.axes[field.name]
    present = float(getattr(one.parameters, field.name))
    parts: list[Any] = [hv.VLine(present).opts(color=colours.faint, line_width=1)]
    for k, colour in enumerate(ramp(colours)):
        label = f"K_y = {K_y[k] / 1e3:.3g} kN/m"
        for speeds, dash, name in ((sweep.linear, "solid", label), (sweep.nonlinear, "dashed", "")):
            curve = hv.Curve((x, KMH * speeds[k]), "x", "V", label=name)
            parts.append(curve.opts(color=colour, line_dash=dash, line_width=2.2))
    for name, dash in (("V_lin, linear", "solid"), ("V_nl, nonlinear", "dashed")):
        key = hv.Curve((x[:1], [np.nan]), "x", "V", label=name)
        parts.append(key.opts(color=colours.ink, line_dash=dash, line_width=2.2))
    top = KMH * float(np.nanmax([sweep.linear, sweep.nonlinear], initial=0.0))
    return hv.Overlay(parts).opts(
        hv.opts.Curve(tools=["hover"]),
        hv.opts.Overlay(
            responsive=True,
            height=_HEIGHT,
            xlabel=named(field),
            ylabel="critical speed V [km/h]",
            logx=field.log,
            ylim=(0, 1.05 * top or 1.0),
            xlim=(float(x[0]), float(x[-1])),
            legend_position="top",
            legend_cols=3,
            show_grid=True,
            hooks=[dressed(colours, f"figure-{one.number}", one.title)],
        ),
    )


def gaps(one: Figure) -> str:
    """Return why curves have gaps, in words."""
    assert one.sweep is not None
    return "".join(
        f'<p class="warning">{count} of {one.sweep.linear.size} points are missing: '
        f"{escape(reason)}.</p>"
        for reason, count in one.sweep.gaps().items()
    )


def verdicts(judged: list[Claim]) -> str:
    """Return claims with their verdicts as a list."""
    items = "".join(
        f'<li class="{"holds" if c.holds else "fails"}">'
        f"<b>{'Holds' if c.holds else 'Does not hold'}</b> "
        f"– “{escape(c.statement)}”: {escape(c.verdict)}.</li>"
        for c in judged
    )
    return f'<ul class="verdicts">{items}</ul>'
