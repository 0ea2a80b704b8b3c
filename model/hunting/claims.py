"""What the paper says about its figures 3 to 14, held against the curves.

Only the paper's statements and the numbers in them stand here as they are printed; every verdict is
computed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from hunting.critical_speeds import Method, critical_speeds
from hunting.elements import Array
from hunting.parameters import RECONSTRUCTED, Field, Parameters
from hunting.study import NUMBERS, POINTS, Figure
from hunting.study import figures as computed

VISIBLE = 0.01  # smallest relative change that a reader of a printed curve sees
SMALL = 0.1  # largest relative change that we call small
CLOSE = 0.02  # largest relative difference between two speeds that we call the same
KMH = 3.6


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and whether the curves bear it out.

    Attributes
    ----------
    figure : int or None
        The figure it is about; None if about all.
    statement : str
        What the paper says.
    holds : bool
        Whether the curves agree.
    verdict : str
        By how much they do, or do not, in words and numbers.
    """

    figure: int | None
    statement: str
    holds: bool
    verdict: str

    def __str__(self) -> str:
        where = "All figures" if self.figure is None else f"Fig. {self.figure}"
        answer = "holds" if self.holds else "does not hold"
        return f"{where}: {self.statement} - {answer}: {self.verdict}."


@dataclass(frozen=True)
class Curves:
    """Speeds over one parameter, a curve each.

    Attributes
    ----------
    x : ndarray, shape (m,)
        Values of the parameter, rising.
    V : ndarray, shape (c, m)
        Speeds [m/s]; NaN where there is none.
    field : Field
        The parameter.
    """

    x: Array
    V: Array
    field: Field

    def within(self, low: float, high: float) -> Curves:
        """Return the part of the curves from `low` to `high`."""
        here = (low <= self.x) & (self.x <= high)
        return Curves(self.x[here], self.V[:, here], self.field)

    def each(self) -> list[tuple[Array, Array]]:
        """Return x and V of each curve without its gaps."""
        return [(self.x[ok], V[ok]) for V, ok in zip(self.V, np.isfinite(self.V), strict=True)]


Answer = tuple[bool, str]
Test = Callable[[Curves], Answer]


def goes(curves: Curves, up: bool) -> Answer:
    """Test that every curve rises (falls) visibly and never turns back visibly."""
    changes, setbacks = _changes(curves, up)
    ahead = changes if up else -changes
    good = (setbacks <= VISIBLE) & (ahead > VISIBLE)
    word, against = "rise" if up else "fall", setbacks.max()
    if good.all():
        return True, f"all {len(good)} curves {word}, by {_percents(ahead)}"
    count = f"{good.sum()} of {len(good)} curves {word}"
    if against <= VISIBLE:
        return False, f"{count} by more than {_percent(VISIBLE)}, the others by less"
    return False, f"{count}; the others go the other way by up to {_percent(against)}"


def stays(curves: Curves) -> Answer:
    """Test that no curve changes visibly."""
    most = max(np.ptp(V) / V.mean() for _, V in curves.each() if len(V))
    return bool(most <= VISIBLE), f"it changes by up to {_percent(most)}"


def rises_a_little(curves: Curves) -> Answer:
    """Test that every curve rises visibly, but not by much."""
    rises, words = goes(curves, up=True)
    most = _changes(curves, up=True)[0].max()
    if rises and most > SMALL:
        words += f", which for the steepest is more than {_percent(SMALL)}"
    return rises and bool(most <= SMALL), words


def falls_and_flattens(curves: Curves) -> Answer:
    """Test that every curve falls, and in the last quarter of the range less than in the first."""
    falls, words = goes(curves, up=False)
    if not falls:
        return False, words
    first, last = curves.x[0], curves.x[-1]
    quarter = 0.25 * (last - first)
    early, late = (
        np.array([-np.diff(np.interp(ends, x, V)).item() for x, V in curves.each()])
        for ends in ((first, first + quarter), (last - quarter, last))
    )
    share = np.divide(late, early, out=np.full(len(early), np.inf), where=early > 0).max()
    words += f"; in the last quarter of the range by up to {_percent(share)} of that in the first"
    return bool(share < 1), words


def follows_no_rule(curves: Curves) -> Answer:
    """Test that the curves do not all rise, nor all fall."""
    kinds = []
    for up in (True, False):
        changes, setbacks = _changes(curves, up)
        kinds.append((setbacks <= VISIBLE) & (np.abs(changes) > VISIBLE))
    rises, falls = kinds
    turns = ~rises & ~falls
    words = f"{rises.sum()} curves rise, {falls.sum()} fall and {turns.sum()} turn"
    return not (rises.all() or falls.all()), words


def turns_down(curves: Curves, at: float) -> Answer:
    """Test that every curve rises up to `at` and falls beyond, give or take a tenth."""
    each = [(x, V) for x, V in curves.each() if len(x)]
    peaks = np.array([x[np.argmax(V)] for x, V in each])
    losses = np.array([1 - V[-1] / V.max() for _, V in each])
    turned = losses > 0
    words = f"{turned.sum()} of {len(curves.V)} curves turn down"
    if turned.any():
        unit = curves.field.unit
        words += f", at {_span(peaks[turned])} {unit}, and lose {_percents(losses[turned])}"
    return bool((turned & (np.abs(peaks / at - 1) <= 0.1)).all()), words


def _changes(curves: Curves, up: bool) -> tuple[Array, Array]:
    """Return the change of each curve from end to end over its first value, and its largest step
    back over its largest one.
    """  # noqa: D205
    changes, setbacks = np.zeros((2, len(curves.V)))
    for k, (_, V) in enumerate(curves.each()):
        if len(V) > 1 and V[0] > 0:
            best = np.maximum.accumulate(V) if up else np.minimum.accumulate(V)
            changes[k] = V[-1] / V[0] - 1
            setbacks[k] = np.abs(V - best).max() / V.max()
    return changes, setbacks


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share < 0.1 else f"{100 * share:.0f} %"


def _percents(shares: Array) -> str:
    low, high = _percent(shares.min()), _percent(shares.max())
    return low if low == high else f"{low[:-2]} to {high}"


def _span(values: Array) -> str:
    low, high = (f"{float(f'{end:.3g}'):,.12g}" for end in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def where_it_holds(curves: Curves, test: Test, present: float) -> str:
    """Return the widest range around the present value on which the test is passed, in words.

    Parameters
    ----------
    curves : Curves
        Curves that fail it as a whole.
    test : callable
        The test.
    present : float
        The parameter's value in the present design.
    """
    m = len(curves.x)
    present = float(np.clip(present, curves.x[0], curves.x[-1]))
    for length in range(m - 1, m // 4, -1):
        for first in range(m - length + 1):
            part = curves.within(curves.x[first], curves.x[first + length - 1])
            if part.x[0] <= present <= part.x[-1] and test(part)[0]:
                return f"; from {_span(part.x)} {curves.field.unit} it does"
    return ""


_rises, _falls = partial(goes, up=True), partial(goes, up=False)


@dataclass(frozen=True)
class _Statement:
    """A statement about a quantity of figures 4 to 14, where it is about, and its test."""

    figure: int
    text: str
    quantity: str
    test: Test
    within: tuple[float, float] | None = None


def _statements(parameters: Parameters) -> list[_Statement]:
    """Return what the paper says; "low" and "high" C_y are those below and above the present."""
    C = float(getattr(parameters, "Cy"))  # noqa: B009 - no field of this file's
    low, high = (0.0, C), (C, np.inf)
    linear, nonlinear = "linear", "nonlinear"
    return [
        _Statement(4, "a heavier wheelset lowers the linear speed", linear, _falls),
        _Statement(4, "a heavier wheelset lowers the nonlinear speed", nonlinear, _falls),
        _Statement(5, "larger wheels raise the linear speed", linear, _rises),
        _Statement(5, "larger wheels raise the nonlinear speed", nonlinear, _rises),
        _Statement(6, "wider contact lowers the linear speed", linear, _falls),
        _Statement(6, "wider contact raises the nonlinear speed", nonlinear, _rises),
        _Statement(6, "wider contact narrows the gap between the two", "gap", _falls),
        _Statement(7, "conicity lowers the linear speed, ever less", linear, falls_and_flattens),
        _Statement(
            7, "conicity lowers the nonlinear speed, ever less", nonlinear, falls_and_flattens
        ),
        _Statement(8, "the axle load has no effect on the linear speed", linear, stays),
        _Statement(8, "the axle load has no effect on the nonlinear speed", nonlinear, stays),
        _Statement(
            9, "lateral damping acts unpredictably on the linear speed", linear, follows_no_rule
        ),
        _Statement(
            9, "little lateral damping leaves the nonlinear speed flat", nonlinear, stays, low
        ),
        _Statement(9, "much lateral damping lowers the nonlinear speed", nonlinear, _falls, high),
        _Statement(10, "yaw stiffness raises the linear speed", linear, _rises),
        _Statement(10, "yaw stiffness raises the nonlinear speed", nonlinear, _rises),
        _Statement(11, "a wider spring base raises the linear speed", linear, _rises),
        _Statement(
            11,
            "a wider spring base raises the nonlinear speed up to b = 1 m and lowers it beyond",
            nonlinear,
            partial(turns_down, at=1.0),
        ),
        _Statement(12, "the rail stiffness has no effect on the linear speed", linear, stays),
        _Statement(12, "the rail stiffness has no effect on the nonlinear speed", nonlinear, stays),
        _Statement(13, "the clearance has no effect on the linear speed", linear, stays),
        _Statement(13, "a larger clearance lowers the nonlinear speed", nonlinear, _falls),
        _Statement(
            14, "a frame of 15 t to 45 t raises the linear speed a little as it gets heavier",
            linear, rises_a_little, (15e3, 45e3),
        ),
        _Statement(
            14, "a frame of 15 t to 45 t raises the nonlinear speed a little as it gets heavier",
            nonlinear, rises_a_little, (15e3, 45e3),
        ),
    ]  # fmt: skip


#: Fig. 3's speeds as printed, wheelset and bogie [km/h].
PRINTED = {"linear": (155.0, 151.0), "nonlinear": (144.0, 140.0)}


def claims(
    figures: Mapping[int, Figure] | None = None,
    parameters: Parameters = RECONSTRUCTED,
    method: Method = "harmonic_balance",
    points: int = POINTS,
) -> tuple[Claim, ...]:
    """Return the paper's statements about its figures 3 to 14, each with a computed verdict.

    Parameters
    ----------
    figures : dict of int to Figure, optional
        Figures that are known already; the others are computed.
    parameters : Parameters, default RECONSTRUCTED
        The design, as numbers.
    method : {"harmonic_balance", "averaging"}
        How limit cycles are found in the figures computed here.
    points : int, default 41
        Values of the parameter in the figures computed here.

    Returns
    -------
    tuple of Claim
        In the order of the figures.

    Notes
    -----
    A change of less than 1 % counts as none, one of at most 10 % as small, and speeds within 2 %
    as the same.

    Examples
    --------
    >>> from hunting import claims
    >>> print(claims(method="averaging", points=5)[0])
    Fig. 3: the wheelset's linear speed is 155 km/h, the bogie's 151 - holds: 156.5 and 149.4 km/h,
    within 1.0 %.
    """
    known = dict(figures or {})
    missing = [number for number in NUMBERS if number not in known]
    known |= computed(missing, parameters, method=method, points=points)
    families = {number: known[number] for number in NUMBERS if known[number].sweep is not None}
    about_all = [_about_all(families, quantity) for quantity in PRINTED]
    about_each = [
        _about_one(families[statement.figure], statement) for statement in _statements(parameters)
    ]
    return (*_about_figure_3(known[3]), *about_all, *about_each)


def _about_figure_3(shown: Figure) -> list[Claim]:
    """Compare the numbers."""
    systems = [branch.system for branch in shown.branches.values()]
    speeds = [critical_speeds(system, shown.method) for system in systems]
    found = []
    for quantity, printed in PRINTED.items():
        values = np.array([KMH * getattr(s, quantity) for s in speeds])
        off = np.abs(values / printed - 1).max()
        near = "within" if off <= CLOSE else "off by up to"
        text = f"the wheelset's {quantity} speed is {printed[0]:.0f} km/h, the bogie's"
        found.append(
            Claim(
                3,
                f"{text} {printed[1]:.0f}",
                bool(off <= CLOSE),
                f"{values[0]:.1f} and {values[1]:.1f} km/h, {near} {_percent(off)}"
                if np.isfinite(off)
                else "there is none: " + "; ".join(str(s.message) for s in speeds),
            )
        )
    return found


def _about_all(families: Mapping[int, Figure], quantity: str) -> Claim:
    """Judge K_y over every value of every parameter."""
    fields = {f.name: f for f in Parameters.fields()}
    lines, name, x = [], "", np.zeros(0)
    for shown in families.values():
        assert shown.sweep is not None
        (name, x), _ = shown.sweep.axes.items()
        lines.append(getattr(shown.sweep, quantity).T)
    holds, verdict = goes(Curves(x, np.concatenate(lines), fields[name]), up=True)
    return Claim(None, f"lateral stiffness raises the {quantity} speed", holds, verdict)


def _about_one(shown: Figure, statement: _Statement) -> Claim:
    """Judge the five curves of one figure."""
    family = shown.sweep
    assert family is not None
    assert shown.field is not None
    gap = family.linear - family.nonlinear
    V = gap if statement.quantity == "gap" else getattr(family, statement.quantity)
    curves = Curves(family.axes[shown.field.name], V, shown.field)
    if statement.within is not None:
        curves = curves.within(*statement.within)
    missing = int(np.isnan(curves.V).sum())
    if np.isnan(curves.V).all():
        return Claim(shown.number, statement.text, False, "there is no such speed")
    holds, verdict = statement.test(curves)
    if not holds and statement.test is not follows_no_rule:
        present = float(getattr(family.parameters, shown.field.name))
        verdict += where_it_holds(curves, statement.test, present)
    if missing:
        verdict += f" ({missing} of {curves.V.size} points have none)"
    return Claim(shown.number, statement.text, holds, verdict)
