"""Values at the ends of the sliders are answered; absurd ones are answered or refused in words."""

from __future__ import annotations

import pytest

from hunting_app.session import Session
from hunting_app.state import FIELDS, SPEED


@pytest.fixture(scope="module")
def session():
    return Session("")


@pytest.mark.parametrize("name", list(FIELDS))
def test_both_ends_of_each_slider_are_answered(session, name):
    field = FIELDS[name]
    ends = set(field.span) | ({field.minimum} if not field.exclusive else set())
    for value in ends - {None}:
        session.act({"set": name, "to": value})
        assert session.sidebar.refused == {}, value
        assert getattr(session.state.parameters, name) == value
    session.act({"reset": [name]})


@pytest.mark.parametrize("typed", ["1e300", "1e-300", "1e30", "1e12", "1e-12"])
def test_an_absurd_value_is_answered_or_refused_in_words(session, typed):
    for name in FIELDS:
        session.act({"set": name, "to": typed})
        accepted = getattr(session.state.parameters, name) == float(typed)
        assert accepted != (name in session.sidebar.refused), name
        assert session.explore.texts["bifurcation"].html
        session.act({"reset": [name]})


@pytest.mark.parametrize("speed", [1e-9, 1.0, SPEED.span[1], 1440.0])
def test_any_speed_is_answered(session, speed):
    session.act({"set": "V", "to": speed})
    assert session.state.speed == speed
    session.act({"reset": ["V"]})


def test_the_motion_of_an_impossible_vehicle_is_given_up_in_words():
    session = Session("?lam=6.4e5&f11=4.4e10&Cy=5.6e7&V=142&disturbance=10")
    said = session.explore.details.motions.text.html
    assert "too fast to follow" in said or "could not be resolved" in said
