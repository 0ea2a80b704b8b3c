"""One session of the dashboard: the state, what may change it, and the views that show it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import panel as pn

from hunting_app import designs, files, link, notebook, words
from hunting_app.advice import Advice
from hunting_app.blocks import block
from hunting_app.drawer import Drawer
from hunting_app.explore import Explore
from hunting_app.header import Header
from hunting_app.hints import Hints
from hunting_app.history import History
from hunting_app.markup import Html
from hunting_app.model_page import model_page
from hunting_app.pace import after, open_page, send_at_once, style_from_this_server, then
from hunting_app.picture import picture
from hunting_app.sidebar import Sidebar
from hunting_app.state import (
    CHOICES,
    FIELDS,
    State,
    with_choice,
    with_disturbance,
    with_preset,
    with_reset,
    with_value,
    with_values,
)
from hunting_app.toolbar import Toolbar
from hunting_app.units import SI, scale

_SLOW = {
    *("rest", "link", "page", "curve", "exact", "averaged", "disturbance", "pair"),
    *("undo", "redo", "design", "values", "file"),
}  # acts after which motions are simulated: too slow for a moving hand

_BY_ITSELF = {"rest", "stored"}  # acts of the page, after which refusals are still news
_LAID_OUT = 500  # ms; a page has its layout by then


def dashboard(search: str | None = None) -> pn.viewable.Viewable:
    """Return the dashboard, to be served or to be shown in a notebook cell.

    Parameters
    ----------
    search : str, optional
        A query string to start from, such as ``"?Ky=1e5&vehicle=both"``; by default the one in
        the address bar, if there is one.
    """
    if doc := open_page():
        pn.extension()
        style_from_this_server(doc)
    notebook.load()
    return Session(search).root


class Session:
    """Wires the state to its views; every change of the state goes through `act`.

    A state may be shared: then nothing is taken from the link, and only the parameters of these
    names have a row.
    """

    def __init__(
        self,
        search: str | None = None,
        state: State | None = None,
        names: Sequence[str] = tuple(FIELDS),
    ) -> None:
        served = None if notebook.kernel() else pn.state.location
        if search is None:
            search = served.search if served else ""
        start, self.notices = link.changes(search)
        dark = pn.state.cookies.get("hunting-dark") == "true" if served else False
        self.state = state or State(**start, dark=dark)
        self.refused: dict[str, str] = {}
        try:
            self._check({})
        except ValueError as refusal:
            self.notices.append(str(refusal))
            self.state = State(dark=dark)
        self.header = Header(
            self.act,
            page=self.state.page,
            dark=dark,
            address=link.query(self.state) if served else None,
        )
        self.history = History(self.state.edited())
        self._moving: str | None = None  # whose slider the hand is on
        self._said = ""
        self.sidebar = Sidebar(self.act_all, names)
        self.advice = Advice(self.state, self.show)
        self.toolbar = Toolbar(self.state, self.act, served=bool(served))
        self.drawer = Drawer(self.state, self.act, served=bool(served))
        self.show()
        self.explore = Explore(self.state, self.act, self.advice)
        self.pages = {
            "explore": block("page", self.sidebar, self.explore, *([Hints()] if served else [])),
            "study": block("page"),
            "model": block("page"),
        }
        self.root = block(
            "root",
            block("top", self.header, self.toolbar, self.drawer),
            *self.pages.values(),
        )
        self._show_page()
        self._choose_scheme()
        self.state.param.watch(lambda *_: self._turn_page(), ["page"])
        self.state.param.watch(lambda *_: self._choose_scheme(), ["dark"])

    def act_all(self, acts: list[dict[str, Any]]) -> None:
        """Do what clicks, keys and sliders ask for; the browser gets it all in one update.

        The exact branch follows in a second one, when the first has been written to the socket.
        """
        send_at_once()
        with pn.io.hold():
            try:
                with self.explore.feed.one_update():
                    for act in acts:
                        self._do(act)
            finally:
                self.show()
        then(self.explore.settle)
        pn.io.push_notebook(self.root)  # there, what bare Bokeh models change waits to be sent

    def act(self, act: dict[str, Any]) -> None:
        """Do one thing."""
        self.act_all([act])

    def _do(self, act: dict[str, Any]) -> None:
        name = act.get("set", "")
        if self._moving not in (None, name):
            self._end_edit()  # of the slider that the hand was on before
        self.refused.pop(name, None)
        if act.keys().isdisjoint(_BY_ITSELF):
            self.notices = []
        try:
            change = self._change(act)
            self._check(change)
        except (ValueError, TypeError) as refusal:
            if name:
                self.refused[name] = str(refusal)
            else:
                self.notices = [str(refusal)]
            return
        self.state.param.update(**change)
        if not act.keys().isdisjoint(_SLOW):
            self.explore.run()
        if name:
            self._moving = name
        else:
            self._end_edit()

    def _end_edit(self) -> None:
        """Make what was changed one step of the history and one of the Back button."""
        self._moving = None
        self.history.note(self.state.edited())
        if self.header.address is not None:
            self.header.address = link.query(self.state)

    def _check(self, change: dict[str, Any]) -> None:
        """Raise what the model has against a change before it is made."""
        now = self.state
        baseline = change.get("baseline", now.baseline)
        picture(
            change.get("parameters", now.parameters),
            change.get("vehicle", now.vehicle),
            change.get("speed", now.speed),
            exact=False,
            baseline=baseline and baseline.parameters,
        )

    def _change(self, act: dict[str, Any]) -> dict[str, Any]:
        match act:
            case {"set": name, "to": value, **rest}:
                if name in FIELDS:  # the browser may not know yet that the units have changed
                    value = scale(name, rest.get("units", SI)).read(value)
                return with_value(self.state, name, value)
            case {"values": dict(values)}:
                return with_values(self.state, values)
            case {"reset": list(names)}:
                for name in names:
                    self.refused.pop(name, None)
                return with_reset(self.state, names)
            case {"preset": name}:
                self.refused.clear()
                return with_preset(name)
            case {"link": search}:
                change, self.notices = link.changes(search)
                return change
            case {"undo": True}:
                return self.history.undo()
            case {"redo": True}:
                return self.history.redo()
            case {"design": _}:
                return designs.with_change(self.state, act)
            case {"keep": True}:
                return designs.with_kept(self.state)
            case {"pin": bool(pinned)}:
                return {"baseline": self.state.design() if pinned else None}
            case {"file": name, "text": text, "size": size}:
                self.refused.clear()
                change, self._said = files.with_file(self.state, name, text, size)
                return change
            case {"stored": text}:
                self.history.take(change := {"designs": files.stored(text)})
                return change
            case {"dark": bool()}:
                return act
            case {"disturbance": size, "speed": speed}:
                return with_disturbance(size) | with_value(self.state, "V", speed)
            case {"disturbance": size}:
                return with_disturbance(size)
            case _ if len(act) == 1 and (name := next(iter(act))) in CHOICES:
                return with_choice(name, act[name])
        return {}

    def show(self) -> None:
        """Bring the controls up to date; the plots watch the state themselves."""
        self.sidebar.present(self.state, dict(self.refused), words.provenance(self.state))
        self.sidebar.idle = self.advice.idle
        self.header.param.update(page=self.state.page, dark=self.state.dark)
        self.toolbar.present(self.history, self.notices, self._said)
        self._said = ""
        self.drawer.present()

    def _turn_page(self) -> None:
        self._show_page()
        after(_LAID_OUT, self.explore.complete)  # not in the same update

    def _show_page(self) -> None:
        if self.state.page == "model" and not len(self.pages["model"]):
            self.pages["model"].append(Html(html=model_page(), css_classes=["whole"], scrolls=True))
        if self.state.page == "study" and not len(self.pages["study"]):
            from hunting_app.study_page import StudyPage  # takes HoloViews along: a second

            self.pages["study"].append(StudyPage(self.state, self.act))
        for name, page in self.pages.items():
            page.visible = name == self.state.page
            page.css_classes = ["page"] if page.visible else []  # its layout would show it again

    def _choose_scheme(self) -> None:
        self.root.styles = {"color-scheme": "dark" if self.state.dark else "light"}
