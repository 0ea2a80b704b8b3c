"""Which parameters raise the critical speed, and which sliders move no answer of this design."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache, partial
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
import panel as pn

from hunting import Parameters, bogie, critical_speeds, sensitivity, wheelset
from hunting_app.formula import with_subscripts
from hunting_app.markup import text
from hunting_app.pace import beside
from hunting_app.picture import KMH
from hunting_app.state import FIELDS, VEHICLES

if TYPE_CHECKING:
    from hunting_app.state import State

CHANGE = 0.1  # of a parameter: small enough that effects are in proportion, large enough to see
NOTICED = 0.05  # km/h; less does not change an answer's last digit
BEST = 3
_CANDIDATES = 6
_MODELS = {"bogie": bogie, "wheelset": wheelset}
_THREAD = ThreadPoolExecutor(1, thread_name_prefix="advice")

Effects = dict[str, tuple[float, float]]
Gains = list[tuple[str, float, float]]
Found = dict[str, tuple[Effects, Gains]]


class Advice:
    """Works out the sensitivities when the hand rests, beside the page's own work.

    Parameters
    ----------
    state : State
        The design.
    on_known : callable
        Called when there is something new to show.
    """

    def __init__(self, state: State, on_known: Callable[[], None]) -> None:
        self.state, self._on_known = state, on_known
        self.content, self.pane = text("advice")
        self._keep_room()
        self.idle: dict[str, str] = {}
        self._asked: tuple[Any, ...] = ()
        self._known: tuple[Any, ...] = ()
        state.param.watch(lambda *_: self._forget(), ["parameters", "vehicle"])

    def _wanted(self) -> tuple[Any, ...]:
        values = tuple(self.state.parameters.to_dict().values())
        return (values, VEHICLES[self.state.vehicle])

    def _forget(self) -> None:
        if self._known and self._known != self._wanted():
            self._known = self._asked = ()
            self._keep_room()

    def _keep_room(self) -> None:
        """Say nothing, in as many lines as there will be: the plots must not move."""
        self.content.html = "<p>&nbsp;</p>"

    def run(self) -> None:
        """Find out what each parameter does, unless that is known or being found out."""
        wanted = self._wanted()
        if wanted in (self._asked, self._known):
            return
        self._asked = wanted
        beside(_THREAD, partial(_all, *wanted), partial(self._say, wanted))

    def _say(self, of: tuple[Any, ...], found: Found) -> None:
        if of != self._wanted():
            return
        self._known = of
        with pn.io.hold():
            self.content.html = f"<p>{advice({v: gains for v, (_, gains) in found.items()})}</p>"
            self.idle = idle({vehicle: effects for vehicle, (effects, _) in found.items()})
            self._on_known()


def _all(values: tuple[float, ...], vehicles: tuple[str, ...]) -> Found:
    return {vehicle: (effects(values, vehicle), best(values, vehicle)) for vehicle in vehicles}


@lru_cache(maxsize=64)
def effects(values: tuple[float, ...], vehicle: str) -> Effects:
    """Return by how much V_lin and V_nl rise with ten percent more of each parameter [km/h].

    NaN where there is no such speed; a parameter that is zero is left out.
    """
    parameters = Parameters(*values)
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            found = sensitivity(_MODELS[vehicle], parameters)
    except (np.linalg.LinAlgError, ArithmeticError, ValueError):
        return {}
    linear = KMH * CHANGE * found.V_linear * found.linear
    nonlinear = KMH * CHANGE * found.V_nonlinear * found.nonlinear
    return {
        name: (float(V_lin), float(V_nl))
        for name, V_lin, V_nl in zip(found.names, linear, nonlinear, strict=True)
        if getattr(parameters, name) != 0
    }


@lru_cache(maxsize=64)
def best(values: tuple[float, ...], vehicle: str) -> Gains:
    """Return what raises V_nl most: parameters, their relative change, and the gain [km/h].

    The sensitivities choose them; the gain is that of the whole change, which need not be in
    proportion.
    """
    slopes = {n: V_nl for n, (_, V_nl) in effects(values, vehicle).items() if np.isfinite(V_nl)}
    strongest = sorted(slopes, key=lambda name: -abs(slopes[name]))[:_CANDIDATES]
    if not strongest:
        return []
    parameters = Parameters(*values)
    shares = np.copysign(CHANGE, [slopes[name] for name in strongest])
    changes = 1 + np.diag(shares)
    tried = parameters.replace(
        **{n: getattr(parameters, n) * row for n, row in zip(strongest, changes, strict=True)}
    )
    before = critical_speeds(_MODELS[vehicle](parameters)).nonlinear
    gains = KMH * np.asarray(critical_speeds(_MODELS[vehicle](tried)).nonlinear - before)
    found = zip(strongest, shares.tolist(), gains.tolist(), strict=True)
    return sorted((one for one in found if one[2] >= NOTICED), key=lambda one: -one[2])[:BEST]


def advice(found: dict[str, Gains]) -> str:
    """What to change to raise V_nl, as HTML; for two vehicles without the names of parameters."""
    alone = len(found) == 1
    of = [f"{vehicle}: {_changes(gains, alone)}" for vehicle, gains in found.items()]
    return f"To raise V<sub>nl</sub>{'' if alone else ' [km/h]'} of the {'; of the '.join(of)}"


def _changes(gains: Gains, named: bool) -> str:
    return (
        ", ".join(
            f"{escape(FIELDS[name].label) if named else ''} "
            f"<b>{with_subscripts(FIELDS[name].symbol)}</b> "
            f"{100 * share:+.0f} % <b>({gain:+.1f}{' km/h' if named else ''})</b>".replace("-", "−")
            for name, share, gain in gains
        )
        or "there is none to raise"
    )


def idle(found: dict[str, Effects]) -> dict[str, str]:
    """Return, for parameters that move no critical speed of any vehicle shown, the words for it."""
    still = [
        name
        for name in FIELDS
        if all(
            name in one and all(abs(effect) < NOTICED for effect in one[name])
            for one in found.values()
        )
    ]
    words = "Moves no answer here: 10 % more changes neither V_nl nor V_lin by 0.1 km/h."
    return dict.fromkeys(still, words)
