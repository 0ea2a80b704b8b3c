"""Random sequences of everything that can be done: no exception, and the page shows the state.

``make fuzz`` runs five hundred sequences; here are a few of them.
"""

from __future__ import annotations

import json
import math
import os
import random
import re

import numpy as np
import pytest

from hunting_app import link
from hunting_app.designs import LONGEST, MOST
from hunting_app.picture import KMH, picture
from hunting_app.session import Session
from hunting_app.state import FIELDS, PRESETS, State
from hunting_app.units import UNITS, scale

SEQUENCES = int(os.environ.get("FUZZ", "40"))
IN_BROWSER = max(4, SEQUENCES // 16)
NAMES = [*FIELDS, "V"]
RUBBISH = [
    "",
    "abc",
    "-5",
    "0",
    "nan",
    "1e400",
    "1,5",
    "1e308",
    "1e-300",
    "<b>",
    "−1",
    "∞",
    "9" * 400,
]
LINKS = [
    "",
    "?",
    "??&&==",
    "?Ky=abc&V=",
    "?Ky=1e5&vehicle=both&baseline=table1&baseline.Ky=3",
    "?baseline=x",
    "?baseline.Ky=1",
    "?baseline=reconstructed&baseline.V=3&baseline.name=",
    "?preset=table1&disturbance=1e9",
    "?Kr=1e300&baseline=reconstructed&baseline.Kr=1e300",
    "?units=engineering&page=nowhere",
    "?%ff%00=%zz",
]
FILES = [
    "",
    "{",
    "[]",
    "null",
    "{}",
    '{"Ky": 1e5}',
    '{"Ky": true}',
    '{"Ky": [1, 2]}',
    '{"Ky": 1e999}',
    '{"Ky": NaN}',
    '{"Ky": 1, "Ky": 2}',
    '{"preset": "table1"}',
    '{"preset": ["table1"], "parameters": {}}',
    '{"parameters": {"Ky": 9e4}, "units": {"Ky": "kN/mm"}}',
    '{"designs": [{"name": "a", "parameters": {"Ky": 5e4}}, {"name": "a", "parameters": {}}]}',
    '{"designs": [{"name": "", "parameters": {}}]}',
    '{"designs": {"a": 1}}',
    json.dumps({"designs": [{"name": str(k), "parameters": {}} for k in range(60)]}),
    "[" * 5000,
    "9" * 5000,
    "x" * 200_000,
    None,
]


def any_act(roll, session):
    """One thing a person, a link, a file or a broken browser may ask for."""
    names = [design.name for design in session.state.designs] + ["nobody"]
    value = roll.choice([roll.uniform(*FIELDS["Ky"].span), roll.choice(RUBBISH)])
    name = roll.choice(NAMES)
    field = FIELDS.get(name)
    near = roll.uniform(*field.span) if field else roll.uniform(1, 300)
    design = {"design": roll.choice(names)}
    return roll.choice(
        [
            lambda: {"set": name, "to": near},
            lambda: {"set": name, "to": near},
            lambda: {"set": name, "to": value},
            lambda: {"set": name, "to": str(near), "units": roll.choice(list(UNITS))},
            lambda: {"rest": True},
            lambda: {"undo": True},
            lambda: {"undo": True},
            lambda: {"redo": True},
            lambda: {"reset": roll.sample(NAMES, 3)},
            lambda: {"preset": roll.choice([*PRESETS, "none"])},
            lambda: {"vehicle": roll.choice(["bogie", "wheelset", "both", "tram"])},
            lambda: {"units": roll.choice([*UNITS, "ells"])},
            lambda: {"curve": roll.choice(["damping", "locus", ""])},
            lambda: {roll.choice(["exact", "averaged"]): roll.choice(["shown", "hidden"])},
            lambda: {"page": roll.choice(["explore", "model", "nowhere"])},
            lambda: {"dark": roll.random() < 0.5},
            lambda: {"disturbance": roll.choice([0, 3.0, 9.0, -1, "abc"])},
            lambda: {"disturbance": roll.uniform(0, 12), "speed": roll.choice([142.0, -5, 1e9])},
            lambda: {"link": roll.choice(LINKS)},
            lambda: {"file": "f.json", "text": roll.choice(FILES), "size": 9},
            lambda: {"stored": roll.choice(FILES)},
            lambda: {"pin": True},
            lambda: {"pin": roll.random() < 0.7},
            lambda: {"keep": True},
            lambda: design | {"show": True},
            lambda: design | {"pin": True},
            lambda: design | {"delete": True},
            lambda: design | {"move": roll.choice([-1, 1, 5, "x"])},
            lambda: (
                design | {"rename": roll.choice(["", "a", " b  c ", "x" * 90, "<i>", "Design 1"])}
            ),
            lambda: {"dismiss": True},
            lambda: {"nonsense": 1},
        ]
    )()


def check(session):
    """What is shown is the state, and what is drawn is what the model says of it."""
    state = session.state
    units = {name: scale(name, state.units) for name in NAMES}
    values = state.parameters.to_dict() | {"V": state.speed}
    assert session.sidebar.values == pytest.approx(
        {n: units[n].shown(v) for n, v in values.items()}
    )
    assert (session.sidebar.preset, session.sidebar.vehicle) == (state.preset, state.vehicle)
    assert session.sidebar.units == state.units
    assert session.toolbar.baseline == (state.baseline.name if state.baseline else "")
    assert bool(session.toolbar.undo) == bool(session.history.past)
    assert session.drawer.count == len(state.designs) <= MOST
    assert [row["name"] for row in session.drawer.rows] == [d.name for d in state.designs]
    assert len({d.name for d in state.designs}) == len(state.designs)
    assert all(0 < len(d.name) <= LONGEST for d in state.designs)
    drawn = session.explore.bifurcation
    shown = picture(
        state.parameters, state.vehicle, state.speed, state.exact == "shown", state.pinned()
    )
    for vehicle, source in drawn.hopf.items():
        found = shown.answers[vehicle].hopf.speed if vehicle in shown.answers else np.zeros(0)
        np.testing.assert_array_equal(np.asarray(source.data["V"]), KMH * found)
    for vehicle, source in drawn.baseline.items():
        answers = shown.baseline.get(vehicle)
        assert len(source.data["V"]) == (answers.branch.speed.size if answers else 0)
    for plot in session.explore.plots:
        axes = plot.figure.x_range, plot.figure.y_range
        assert all(math.isfinite(r.start) and r.start < r.end < math.inf for r in axes)
    answers = re.sub(r"<[^>]*>", " ", session.explore.texts["answers"].html)
    assert not re.search(r"\b(nan|inf)\b", answers)
    again, refused = link.changes(link.query(state))
    assert refused == []
    assert again["parameters"] == state.parameters
    assert again["baseline"] == state.baseline


@pytest.mark.parametrize("batch", range(10))
def test_no_sequence_of_acts_breaks_the_page(batch):
    session = Session("")
    session.drawer._handle_msg({"act": {"open": True}, "number": 1})
    for k in range(SEQUENCES // 10):
        seed = 1000 * batch + k
        roll = random.Random(seed)
        acts = []
        for _ in range(roll.randint(4, 16)):
            acts.append(any_act(roll, session))
            try:
                session.act_all(acts[-1:])
                check(session)
            except Exception as error:
                raise AssertionError(f"seed {seed}: {acts}") from error
        steps = len(session.history.past)
        before = session.state.edited()
        for _ in range(steps):
            session.act({"undo": True})
        for _ in range(steps):
            session.act({"redo": True})
        assert session.state.edited() == before, f"seed {seed}"
        session.act({"link": ""})
        session.act({"stored": '{"designs": []}'})
        session.history.past.clear()
        assert session.state.parameters == State().parameters


def test_no_sequence_of_clicks_and_keys_breaks_the_page(open_dashboard):
    dashboard = open_dashboard("")
    page = dashboard.page
    choices = page.locator("fieldset.choice")
    dashboard.press("Designs")

    def press(pattern):
        buttons = page.get_by_role("button", name=re.compile(pattern), disabled=False)
        if buttons.count():
            buttons.first.click()

    def drag(name):
        slider = dashboard.slider(name)
        slider.focus()
        for _ in range(roll.randint(1, 8)):
            page.keyboard.press(roll.choice(["ArrowRight", "ArrowLeft", "PageUp", "End"]))

    def open_file():
        text = roll.choice(FILES) or ""
        file = {"name": "f.json", "mimeType": "application/json", "buffer": text.encode()}
        page.locator("input[type=file]").set_input_files(file)

    def type_something():
        name = roll.choice(NAMES)
        dashboard.box(name).fill(roll.choice([*RUBBISH, "1e5", "3", "0.05"]))
        dashboard.box(name).press("Enter")

    acts = [
        lambda: drag(roll.choice(NAMES)),
        lambda: drag("Ky"),
        type_something,
        type_something,
        lambda: page.keyboard.press("Escape"),
        lambda: page.evaluate("() => document.activeElement?.blur()"),
        lambda: page.keyboard.press("Control+z"),
        lambda: page.keyboard.press("Control+Shift+Z"),
        lambda: press(
            roll.choice(["Undo", "Redo", "Pin as", "Unpin", "Dismiss", "Root", "Damping"])
        ),
        lambda: press(
            roll.choice(["Keep this", "^show ", "^pin ", "^delete ", "^move ", "Put all"])
        ),
        lambda: press(roll.choice(["Exact", "Averaged", "Just inside", "Clear", "Dark|Light"])),
        lambda: choices.get_by_text(roll.choice(["bogie", "both", "wheelset"]), exact=True).click(),
        lambda: choices.get_by_text(roll.choice(["Reconstructed", "Table 1 as printed"])).click(),
        open_file,
        lambda: page.evaluate("() => history.back()"),
        lambda: page.evaluate("() => history.forward()"),
    ]
    for seed in range(IN_BROWSER):
        roll = random.Random(seed)
        if seed % 8 == 7:
            dashboard.open(roll.choice([one for one in LINKS if one.isprintable()]))
            dashboard.press("Designs")
        for _ in range(roll.randint(4, 10)):
            roll.choice(acts)()
        dashboard.settle()
        dashboard.settle()
        assert dashboard.canvases_painted() >= 5, f"seed {seed}"
        shown = {
            name: dashboard.value(name)
            for name in NAMES
            if not dashboard.refusal(name).inner_text()
        }
        start, _ = link.changes(page.evaluate("() => location.search"))
        values = start["parameters"].to_dict() | {"V": start["speed"]}
        expected = {n: scale(n, start["units"]).shown(values[n]) for n in shown}
        assert shown == pytest.approx(expected, rel=1e-6), f"seed {seed}"
