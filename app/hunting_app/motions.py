"""Simulated motions: what a disturbance does, over time and in words."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import TYPE_CHECKING, Any

import panel as pn

from hunting_app import verdicts
from hunting_app.blocks import block, button, column, said
from hunting_app.disturbance import Disturbed, disturbed
from hunting_app.markup import Html, text
from hunting_app.numerals import written
from hunting_app.pace import beside
from hunting_app.picture import picture
from hunting_app.plan import Plan
from hunting_app.plots.history import History, Motion

if TYPE_CHECKING:
    from collections.abc import Callable

    from hunting.simulation import Decay
    from hunting_app.exports.menu import Menu
    from hunting_app.picture import Picture
    from hunting_app.plots.feed import Feed
    from hunting_app.state import State

_JUDGES = ThreadPoolExecutor(1, thread_name_prefix="verdict")


class Motions:
    """The card below the bifurcation diagram.

    The motion itself comes at once. How it ends takes about a second more and follows from a
    thread, so that the sliders stay free. A motion of other parameters than those shown is taken
    away, and simulated anew when the hand rests.
    """

    def __init__(
        self, state: State, feed: Feed, act: Callable[[dict[str, Any]], None], menu: Menu
    ) -> None:
        self.state, self.feed, self.menu = state, feed, menu
        self.curves = Motion(feed)
        self.history = History(feed, self.curves.sources)
        self.plots = self.history.lanes
        self.text, self.pane = text("motion")
        self.buttons = Html(act, margin=(0, 26, 0, 0))  # beside the menu
        self.plan = Plan()
        self.motion: Disturbed | None = None
        self.on_reach: Callable[[dict[str, float]], None] = lambda reach: None
        self._of: tuple[Any, ...] = ()

    def _wanted(self) -> tuple[Any, ...]:
        s = self.state
        return (s.parameters, s.vehicle, s.speed, s.disturbance, s.pair, s.exact)

    def draw_moment(self, shown: Picture, settled: bool) -> None:
        """Take away what no longer holds; say whether there is a threshold to be beside of."""
        if self.motion is not None and self._of != self._wanted():
            self._clear()
        if settled:
            self._offer(shown)

    def _offer(self, shown: Picture) -> None:
        vehicle, moment = next(iter(shown.moments.items()))
        self.plan.frame = vehicle == "bogie"
        self.history.show(shown.answers[vehicle].branch.system.symbols)
        self.buttons.html = _buttons(
            verdicts.no_threshold(shown.answers[vehicle], moment, shown.speed),
            pair=self.state.pair == "yes",
            size=0.0 if self.state.pair == "yes" else self.state.disturbance,
        )
        if self.motion is None:
            self.text.html = said(verdicts.invitation())

    def run(self) -> None:
        """Simulate what is asked for, unless that is what is shown."""
        wanted = self._wanted()
        if wanted == self._of:
            return
        self._clear()
        self._of = wanted
        s = self.state
        shown = picture(s.parameters, s.vehicle, s.speed, s.exact == "shown", s.pinned())
        self._offer(shown)
        if s.disturbance or s.pair == "yes":
            self._simulate(shown, None if s.pair == "yes" else s.disturbance)
        self.feed.send()

    def _simulate(self, shown: Picture, size: float | None) -> None:
        vehicle, answers = next(iter(shown.answers.items()))
        moment = shown.moments[vehicle]
        self.motion = disturbed(answers, moment, shown.speed, size)
        if self.motion is None:
            self.text.html = said(verdicts.no_threshold(answers, moment, shown.speed))
        else:
            self._show(self.motion, shown.clearance)

    def _show(self, motion: Disturbed, clearance: float) -> None:
        reach = self.curves.put(motion)
        self.on_reach(reach)
        self.history.draw(reach, motion)
        self.plan.param.update(clearance=clearance, present=True)
        self.text.html = verdicts.motion(motion, None)
        self._judge(motion)

    def _judge(self, motion: Disturbed) -> None:
        """Find out how it ends; in the background if there is a page to be told."""

        def judge() -> Decay | None:
            return motion.decay() if motion is self.motion else None

        beside(_JUDGES, judge, partial(self._say, motion))

    def _say(self, motion: Disturbed, decay: Decay | None) -> None:
        if motion is self.motion:
            self.text.html = verdicts.motion(motion, decay)

    def _clear(self) -> None:
        self.motion = None
        self._of = ()
        self.curves.clear()
        self.history.clear()
        self.on_reach({})
        self.plan.present = False

    def __panel__(self) -> pn.viewable.Viewable:
        """Buttons and words on top, time history left, plan view right."""
        lanes = [lane.figure for lane in self.plots.values()]
        return block(
            "card motion",
            self.menu,
            self.buttons,
            column("said", self.pane),
            block("side-by-side", column("curves", *lanes), self.plan),
        )


def _buttons(why_not: str, *, pair: bool, size: float) -> str:
    beside = button(
        {"pair": "no" if pair else "yes"},
        "Just inside and outside the unstable cycle",
        pressed=pair,
        why_not=why_not,
    )
    typed = (
        '<label class="asks">Disturb by <input type="text" inputmode="decimal" autocomplete="off" '
        f'data-asks="disturbance" value="{written(size) if size else ""}"> mm</label>'
    )
    return (
        beside
        + typed
        + (button({"disturbance": 0}, "Clear", pressed=False) if size or pair else "")
    )
