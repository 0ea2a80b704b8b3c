"""A session without a browser: acts in, state and Bokeh models out."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, averaged_branch, bogie, critical_speeds, limit_cycles
from hunting_app.picture import KMH, MM, picture
from hunting_app.session import Session
from hunting_app.state import FIELDS


@pytest.fixture
def session():
    return Session("")


def values(source):
    return {name: np.asarray(column, dtype=float) for name, column in source.data.items()}


@pytest.mark.parametrize(
    ("method", "curves"), [(limit_cycles, "branches"), (averaged_branch, "averaged")]
)
def test_the_diagram_is_the_branch(session, method, curves):
    branch = method(bogie(RECONSTRUCTED))
    drawn = values(getattr(session.explore.bifurcation, curves)["bogie"])
    np.testing.assert_array_equal(drawn["V"], KMH * branch.speed)
    np.testing.assert_array_equal(
        drawn["stable"][branch.stable], MM * branch.amplitude[branch.stable]
    )
    unstable = ~branch.stable
    np.testing.assert_array_equal(drawn["unstable"][unstable], MM * branch.amplitude[unstable])
    assert np.isnan(drawn["stable"][unstable]).all()


def test_solid_and_dashed_curves_meet(session):
    drawn = values(session.explore.bifurcation.branches["bogie"])
    both = np.isfinite(drawn["stable"]) & np.isfinite(drawn["unstable"])
    assert both.sum() == 1


def test_zones_change_at_the_critical_speeds(session):
    speeds = critical_speeds(bogie(RECONSTRUCTED))
    zones = {name: values(source) for name, source in session.explore.bifurcation.zones.items()}
    starts, ends = zones["conditional"]["left"], zones["conditional"]["right"]
    assert zones["safe"]["right"][-1] == starts[0] == pytest.approx(KMH * speeds.nonlinear)
    assert ends[0] == zones["hunting"]["left"][0] == KMH * speeds.linear


def test_a_low_speed_window_is_drawn_as_hunting_and_named():
    session = Session("?Cy=2000&Ky=30000")
    windows = critical_speeds(
        bogie(RECONSTRUCTED.replace(Cy=2000, Ky=30000)), method="averaging"
    ).windows
    assert windows, "these parameters are meant to have one"
    hunting = values(session.explore.bifurcation.zones["hunting"])
    for low, high in windows:
        assert (KMH * low, KMH * high) in set(zip(hunting["left"], hunting["right"], strict=True))
    assert "low-speed window" in session.explore.texts["bifurcation"].html


def test_portraits_show_the_two_cycles_at_the_chosen_speed(session):
    session.act({"set": "V", "to": 145.0})
    portraits = session.explore.details.portraits
    shown = picture(RECONSTRUCTED, "bogie", 145.0).moments["bogie"]
    small, big = (MM * cycle.amplitude for cycle in shown.cycles)
    assert values(portraits.cycles.unstable["bogie"])["y"].max() == pytest.approx(small, rel=1e-4)
    assert values(portraits.cycles.stable["bogie"])["y"].max() == pytest.approx(big, rel=1e-4)


def test_at_a_safe_speed_there_is_no_cycle(session):
    session.act({"set": "V", "to": "100"})
    assert not values(session.explore.details.portraits.cycles.stable["bogie"])["y"].size
    assert "is safe: every disturbance dies out" in session.explore.texts["bifurcation"].html


@pytest.mark.parametrize(
    ("speed", "words"),
    [
        (100, "this bogie is safe: every disturbance dies out"),
        (145, "conditionally stable: a disturbance above 4.1 mm makes it hunt"),
        (160, "this bogie hunts by itself"),
    ],
)
def test_the_sentence_under_the_diagram_is_true(session, speed, words):
    session.act({"set": "V", "to": speed})
    assert words in session.explore.texts["bifurcation"].html


def test_table_1_says_in_words_that_nothing_hunts(session):
    session.act({"preset": "table1"})
    assert "no Hopf point in range" in session.explore.texts["answers"].html
    assert "no Hopf point in range" in session.explore.texts["bifurcation"].html
    assert "nan" not in session.explore.texts["answers"].html.lower()
    bifurcation = session.explore.bifurcation
    assert not values(bifurcation.branches["bogie"])["V"].size
    assert bifurcation.figure.xaxis.axis_label == "forward speed V [km/h]"


@pytest.mark.parametrize("typed", ["abc", "", "-5", "0", "nan", "1e400", "1,5"])
def test_a_refused_value_changes_nothing_but_is_named_beside_its_box(session, typed):
    before = session.explore.texts["answers"].html
    session.act({"set": "Ky", "to": typed})
    assert session.state.parameters == RECONSTRUCTED
    assert session.sidebar.refused["Ky"]
    assert session.explore.texts["answers"].html == before
    session.act({"set": "Ky", "to": "1e5"})
    assert session.sidebar.refused == {}
    assert session.state.parameters.Ky == 1e5


def test_a_move_rebuilds_no_model(session):
    session.act({"vehicle": "both"})  # what shows a vehicle is made when it is first shown
    before = {model.id for model in session.root.get_root().references()}
    for k in range(20):
        session.act({"set": "Ky", "to": 5e4 + 5e3 * k})
        session.act({"vehicle": ("bogie", "both", "wheelset")[k % 3]})
        session.act({"preset": ("table1", "reconstructed")[k % 2]})
    figures = session.explore.plots
    after = {model.id for plot in figures for model in plot.figure.references()}
    assert after <= before


def test_the_address_follows_when_the_hand_rests():
    session = Session("")
    session.header.address = ""  # as if served
    session.act({"set": "Ky", "to": 1e5})
    assert session.header.address == ""
    session.act({"rest": True})
    assert session.header.address == "?Ky=100000"


def test_going_back_restores_the_state_of_that_link(session):
    session.act({"set": "Ky", "to": 1e5})
    session.act({"link": "?vehicle=both"})
    assert session.state.vehicle == "both"
    assert session.state.parameters == RECONSTRUCTED


acts = st.one_of(
    st.builds(
        lambda name, to: {"set": name, "to": to},
        st.sampled_from([*FIELDS, "V"]),
        st.one_of(
            st.floats(-1e8, 1e8),
            st.sampled_from(["abc", "1e5", "", "−1", "1e308", "0", "86,700", "1e-300"]),
        ),
    ),
    st.builds(lambda name: {"reset": [name]}, st.sampled_from([*FIELDS, "V"])),
    st.builds(lambda name: {"preset": name}, st.sampled_from(["table1", "reconstructed", "x"])),
    st.builds(lambda name: {"vehicle": name}, st.sampled_from(["bogie", "wheelset", "both", "x"])),
    st.builds(lambda name: {"curve": name}, st.sampled_from(["damping", "locus"])),
    st.builds(lambda name: {"page": name}, st.sampled_from(["model", "explore"])),
    st.builds(lambda dark: {"dark": dark}, st.booleans()),
    st.builds(
        lambda text: {"link": text}, st.sampled_from(["?V=abc", "?Ky=1e5", "?Kr=1e300", "??"])
    ),
    st.just({"rest": True}),
    st.just({"dismiss": True}),
)


@settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(acts, min_size=1, max_size=12))
def test_no_sequence_of_acts_breaks_the_page(sequence):
    session = Session("")
    for act in sequence:
        session.act(act)
        state = session.state
        assert session.sidebar.values == state.parameters.to_dict() | {"V": state.speed}
        assert (session.sidebar.preset, session.sidebar.vehicle) == (state.preset, state.vehicle)
        assert all(text.html for text in session.explore.texts.values())
        shown = re.sub(r"<[^>]*>", " ", session.explore.texts["answers"].html)
        assert "nan" not in shown
        assert "inf" not in shown
        drawn = session.explore.bifurcation.figure
        ends = (drawn.x_range.start, drawn.x_range.end, drawn.y_range.start, drawn.y_range.end)
        assert all(map(math.isfinite, ends))
        assert ends[0] < ends[1]
        assert ends[2] < ends[3]
