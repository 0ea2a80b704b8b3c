"""What all sections of the Study page share: a heading, a button, progress and a download."""

from __future__ import annotations

import io
import logging
from concurrent.futures import Executor
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import panel as pn

from hunting import Parameters, bogie, wheelset
from hunting.cases import Progress, Vehicle
from hunting_app import blocks
from hunting_app.markup import Html
from hunting_app.palette import Palette, palette
from hunting_app.state import VEHICLES, State
from hunting_app.study.jobs import Job

if TYPE_CHECKING:
    from collections.abc import Callable

STYLE = (Path(__file__).parent / "study.css").read_text(encoding="utf-8")
part = partial(blocks.block, style=STYLE, sizing_mode="stretch_width")  # of the Study page
_MODELS: dict[str, Vehicle] = {"bogie": bogie, "wheelset": wheelset}
_LOG = logging.getLogger(__name__)


class Section:
    """One kind of study. A subclass says what is asked of the model and how the answer is drawn.

    Parameters
    ----------
    state : State
        Parameters and vehicle are taken from here when the work begins.
    act : callable
        Does what a click asks for, as on every page.
    """

    key: str
    label: str
    explained: str
    call = "Compute"
    things = "points"

    def __init__(self, state: State, act: Callable[[dict[str, Any]], None]) -> None:
        self.state, self.act = state, act
        self.job: Job | None = None
        self.result: Any = None
        self.parameters: Parameters = state.parameters  # those of the result, or of work under way
        self.vehicle = VEHICLES[state.vehicle][0]
        self.buttons = markup(self._clicked)
        self.progress, self.said = markup(), markup(self._clicked)
        self.controls = part("controls")
        self.body = part("body")
        self.download = part("download")
        self._show_buttons()

    # ---- what a subclass gives

    def work(self, executor: Executor, progress: Progress) -> Any:
        """Return the result; runs in a thread."""
        raise NotImplementedError

    def draw(self) -> None:
        """Draw the result."""
        raise NotImplementedError

    def csv(self) -> str:
        """Return the result as CSV."""
        raise NotImplementedError

    def ask(self) -> None:
        """Take from the controls what `work` needs; ValueError says what makes no sense."""

    # ---- the work

    @property
    def colours(self) -> Palette:
        """The present palette."""
        return palette(self.state.dark)

    @property
    def model(self) -> Vehicle:
        """The vehicle as the model knows it."""
        return _MODELS[self.vehicle]

    def start(self) -> None:
        """Begin anew with the parameters now on the sliders."""
        self.cancel()
        self.parameters = self.state.parameters
        self.vehicle = VEHICLES[self.state.vehicle][0]
        try:
            self.ask()
        except ValueError as refusal:
            self.progress.html = warning(str(refusal))
            return
        self.show_progress(0, 0)
        self.job = Job(self.work, self.show_progress, self._finish)
        self._show_buttons()

    def cancel(self) -> None:
        """Stop what is under way; what is shown stays."""
        if self.job is not None:
            self.job.cancel()
            self.job = None
            self.progress.html = "<p>Cancelled.</p>"
            self._show_buttons()

    def show_progress(self, done: int, total: int) -> None:
        """Move the bar."""
        bar = f'value="{done}" max="{total}"' if total else ""
        count = f"{done:,} of {total:,} {self.things}" if total else "starting …"
        self.progress.html = f'<progress {bar} aria-label="progress"></progress> {count}'

    def _finish(self, result: Any) -> None:
        self.job = None
        self._show_buttons()
        if isinstance(result, Exception):
            if not isinstance(result, ValueError):
                _LOG.error("a study failed", exc_info=result)
            self.progress.html = warning(str(result) or type(result).__name__)
            return
        self.progress.html = ""
        self.result = result
        if not len(self.download):
            self.download.append(download(self.csv, f"{self.key}.csv"))
        self.draw()

    def _clicked(self, act: dict[str, Any]) -> None:
        with pn.io.hold():
            match act:
                case {"start": True}:
                    self.start()
                case {"cancel": True}:
                    self.cancel()
                case _:
                    self.clicked(act)

    def clicked(self, act: dict[str, Any]) -> None:
        """Do what another button of the section asks for."""

    def _show_buttons(self) -> None:
        if self.job is not None:
            self.buttons.html = "<button data-act='{\"cancel\": true}'>Cancel</button>"
        else:
            self.buttons.html = (
                f'<button class="primary" data-act=\'{{"start": true}}\'>{self.call}</button>'
            )

    # ---- the page

    def opened(self) -> None:
        """Do what is due when the person turns to the section."""

    def outdated(self) -> bool:
        """Whether the result is of other parameters than those now on the sliders."""
        if self.result is None and self.job is None:
            return False
        now = (self.state.parameters, VEHICLES[self.state.vehicle][0])
        return (self.parameters, self.vehicle) != now

    def redraw(self) -> None:
        """Draw the result in other colours."""
        if self.result is not None:
            self.draw()

    def __panel__(self) -> pn.viewable.Viewable:
        """Explanation and controls on top, the figure below."""
        bar = part("bar", self.buttons, self.progress, self.download)
        intro = markup(html=f"<h2>{self.label}</h2><p>{self.explained}</p>")
        return part("section", intro, self.controls, bar, self.said, self.body)


def download(csv: Callable[[], str], filename: str, label: str = "CSV") -> pn.widgets.FileDownload:
    """Return a button that makes a file when clicked."""
    return pn.widgets.FileDownload(
        callback=lambda: io.StringIO(csv()),
        filename=filename,
        label=f"Download {label}",
        stylesheets=[STYLE],
        margin=0,
    )


def warning(words: str) -> str:
    """Return a sentence that something is amiss."""
    return f'<p class="warning">{escape(words)}</p>'


def markup(act: Callable[[dict[str, Any]], None] | None = None, html: str = "") -> Html:
    """Return HTML whose buttons act."""
    return Html(act, html=html, stylesheets=[STYLE])
