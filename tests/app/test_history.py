"""Undo and redo: one step an edit, everything but the page and the colours."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, TABLE_1
from hunting_app.history import LONGEST, History
from hunting_app.session import Session


def drag(session, name, *values):
    for value in values:
        session.act({"set": name, "to": value})
    session.act({"rest": True})


def test_a_drag_is_one_step():
    session = Session("")
    drag(session, "Ky", 9e4, 1e5, 1.1e5)
    session.act({"undo": True})
    assert session.state.parameters == RECONSTRUCTED
    session.act({"redo": True})
    assert session.state.parameters.Ky == 1.1e5


def test_two_sliders_without_a_rest_between_are_two_steps():
    session = Session("")
    drag(session, "Ky", 1e5)
    session.act({"set": "m_w", "to": 1500})
    drag(session, "Cy", 3e4)
    session.act({"undo": True})
    assert session.state.changed() == ["m_w", "Ky"]
    session.act({"undo": True})
    assert session.state.changed() == ["Ky"]


def test_undo_in_the_middle_of_a_drag_takes_that_drag_back():
    session = Session("")
    drag(session, "Ky", 1e5)
    session.act({"set": "Ky", "to": 2e5})
    session.act({"undo": True})
    assert session.state.parameters.Ky == 1e5


def test_every_choice_but_page_and_colours_is_taken_back():
    session = Session("")
    acts = [
        {"preset": "table1"},
        {"vehicle": "both"},
        {"disturbance": 5, "speed": 120},
        {"pair": "yes"},
        {"curve": "locus"},
        {"exact": "hidden"},
        {"averaged": "hidden"},
        {"pin": True},
        {"keep": True},
        {"values": {"Ky": 1e5, "Cy": 3e4}},
        {"reset": ["Ky", "Cy", "V"]},
        {"design": "Design 1", "rename": "first"},
        {"link": "?Ky=1e5"},
    ]
    seen = []
    for act in acts:
        seen.append(session.state.edited())
        session.act(act)
        session.act({"page": "model"})
        session.act({"dark": True})
    last = session.state.edited()
    for before in reversed(seen):
        session.act({"undo": True})
        assert session.state.edited() == before
    assert (session.state.page, session.state.dark) == ("model", True)
    for _ in acts:
        session.act({"redo": True})
    assert session.state.edited() == last


def test_what_was_refused_is_no_step():
    session = Session("")
    drag(session, "Ky", "abc")
    session.act({"preset": "none"})
    session.act({"undo": True})
    assert session.toolbar.undo == session.toolbar.redo == ""
    assert session.state.parameters == RECONSTRUCTED


def test_the_buttons_say_what_they_would_do():
    session = Session("")
    drag(session, "Ky", 1e5)
    assert session.toolbar.undo == "K_y"
    session.act({"preset": "table1"})
    assert session.toolbar.undo == "preset"
    session.act({"undo": True})
    assert (session.toolbar.undo, session.toolbar.redo) == ("K_y", "preset")
    assert session.state.parameters != TABLE_1


@given(st.lists(st.one_of(st.integers(0, 3), st.sampled_from(["undo", "redo"])), max_size=60))
def test_undo_and_redo_walk_along_the_edits(walk):
    history, shown = History({"value": 0}), 0
    line, at = [0], 0
    for step in walk:
        if step == "undo":
            at = max(at - 1, 0)
            shown = history.undo().get("value", shown)
        elif step == "redo":
            at = min(at + 1, len(line) - 1)
            shown = history.redo().get("value", shown)
        elif step != shown:
            line, at, shown = [*line[: at + 1], step], at + 1, step
            history.note({"value": step})
        assert shown == line[at]


def test_the_history_does_not_grow_without_end():
    history = History({"value": 0})
    for value in range(1, 2 * LONGEST):
        history.note({"value": value})
    assert len(history.past) == LONGEST
    assert history.undo() == {"value": 2 * LONGEST - 2}


def test_undo_brings_the_motion_back():
    session = Session("?disturbance=6&V=142")
    drag(session, "Ky", 1e5)
    session.act({"undo": True})
    motions = session.explore.details.motions
    assert motions.motion is not None
    assert (
        motions.motion.trajectory.system.matrix(1.0).tolist()
        == (
            Session("?disturbance=6&V=142").explore.details.motions.motion.trajectory.system.matrix(
                1.0
            )
        ).tolist()
    )
