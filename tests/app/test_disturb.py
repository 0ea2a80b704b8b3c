"""Disturbances: a click is simulated, drawn, told in words and played."""

from __future__ import annotations

import re

import numpy as np
import pytest

from hunting import RECONSTRUCTED
from hunting_app.disturbance import BESIDE, contacts, disturbed
from hunting_app.picture import KMH, MM, picture
from hunting_app.session import Session

READY = "() => window.Bokeh?.documents?.length && Bokeh.documents[0].is_idle"


@pytest.fixture
def session():
    return Session("")


def column(source, name):
    return np.asarray(source.data[name], dtype=float)


def said(session):
    return re.sub(r"<[^>]*>", " ", session.explore.details.motions.text.html)


@pytest.mark.parametrize(("size", "word"), [(12.0, "limit cycle of 9.4"), (2.0, "dies out")])
def test_the_verdict_is_that_of_the_model(session, size, word):
    session.act({"disturbance": size, "speed": 145.0})
    motion = session.explore.details.motions.motion
    decay = motion.decay()
    assert word in said(session)
    assert not decay.decided[0] or decay.message[0] in said(session)
    assert session.state.speed == 145.0


def test_a_disturbance_below_the_fold_dies_out_in_as_long_as_the_model_says(session):
    session.act({"disturbance": 9.0, "speed": 60.0})
    decay = session.explore.details.motions.motion.decay()
    assert decay.dies_out[0]
    assert f"dies out in {decay.time[0]:.1f} s" in said(session)


def test_a_motion_begins_with_the_displacement_that_was_clicked(session):
    session.act({"disturbance": 6.0, "speed": 142.0})
    motions = session.explore.details.motions
    assert column(motions.curves.sources["motion"], "y")[0] == pytest.approx(6.0)
    assert not column(motions.curves.sources["hunting"], "y").size


def test_the_peak_flange_force_is_that_of_the_spring(session):
    session.act({"disturbance": 12.0, "speed": 145.0})
    motion = session.explore.details.motions.motion
    peak = float(RECONSTRUCTED.Kr * (0.012 - RECONSTRUCTED.delta))
    assert motion.trajectory.peak_forces["flange force"][0] == pytest.approx(peak, rel=1e-3)
    assert f"peak flange force {peak / 1e3:.1f} kN" in said(session)


@pytest.mark.parametrize("vehicle", ["bogie", "wheelset"])
def test_beside_the_unstable_cycle_one_motion_shrinks_and_one_grows(vehicle):
    shown = picture(RECONSTRUCTED, vehicle, 146.0)
    pair = disturbed(shown.answers[vehicle], shown.moments[vehicle], 146.0, None)
    threshold, hunt = (cycle.amplitude for cycle in shown.moments[vehicle].cycles)
    np.testing.assert_allclose(pair.sizes, np.array(BESIDE) * threshold)
    inside, outside = pair.decay().amplitude
    assert inside < 0.5 * pair.sizes[0]
    assert outside == pytest.approx(hunt, rel=1e-2)


def test_both_motions_are_drawn(session):
    session.act({"pair": "yes"})
    motions = session.explore.details.motions
    inside, outside = (column(s, "y") for s in motions.curves.sources.values())
    late = len(inside) // 2
    assert np.abs(inside[late:]).max() < np.abs(inside[:late]).max()
    assert np.abs(outside[late:]).max() > np.abs(outside[:late]).max()


@pytest.mark.parametrize(
    ("speed", "reason"),
    [(100, "no unstable cycle: every disturbance dies out"), (160, "unstable itself")],
)
def test_without_an_unstable_cycle_the_button_says_why(session, speed, reason):
    session.act({"set": "V", "to": speed})
    html = session.explore.details.motions.buttons.html
    assert "disabled" in html
    assert reason in html


def test_table_1_stays_in_words():
    session = Session("?preset=table1")
    assert "has no limit cycles" in session.explore.details.motions.buttons.html
    session.act({"disturbance": 5.0, "speed": 100.0})
    assert "dies out in" in said(session)


def test_a_motion_of_other_parameters_is_taken_away_until_the_hand_rests(session):
    session.act({"disturbance": 6.0, "speed": 142.0})
    session.act({"set": "Ky", "to": 1e5})
    assert not column(session.explore.details.motions.curves.sources["motion"], "y").size
    session.act({"rest": True})
    assert column(session.explore.details.motions.curves.sources["motion"], "y").size


def test_the_portraits_make_room_for_the_motion():
    session = Session("?preset=table1&disturbance=5")
    details = session.explore.details
    largest = np.abs(column(details.motions.curves.sources["motion"], "z")).max()
    axis = details.portraits.plots["z"].figure.x_range
    assert axis.end > largest > 1
    session.act({"disturbance": 0})
    assert axis.end < largest


def test_contact_begins_and_ends_where_the_force_does():
    time = np.arange(6.0)
    begins, ends = contacts(time, np.array([0.0, 5.0, 5.0, 0.0, 0.0, 5.0]))
    assert begins.tolist() == [1.0, 5.0]
    assert ends.tolist() == [3.0, 5.0]


def test_a_link_keeps_the_disturbance():
    session = Session("?disturbance=6&V=142")
    assert session.state.disturbance == 6.0
    assert session.explore.details.motions.motion.sizes[0] * MM == pytest.approx(6.0)
    assert session.explore.details.motions.motion.speed / KMH == pytest.approx(142.0 / KMH)


@pytest.mark.parametrize("text", ["-3", "abc", "1e999", ""])
def test_a_disturbance_that_makes_no_sense_is_refused_in_words(text):
    session = Session(f"?disturbance={text}")
    assert session.notices
    assert session.state.disturbance == 0.0


def test_what_was_refused_is_forgotten_with_the_next_thing_done():
    session = Session("?disturbance=abc")
    session.act({"rest": True})
    assert session.notices
    session.act({"disturbance": 3.0})
    assert session.notices == []


def test_a_motion_that_leaves_the_range_at_once_is_all_there_is_to_say():
    session = Session("?disturbance=100")
    assert "range, 1.6 times the clearance, after 0.00 s" in said(session)
    assert "First" not in said(session)
    lane = session.explore.details.motions.plots["y"].figure
    assert lane.y_range.end > 100
    session.act({"disturbance": 0})
    assert (lane.x_range.end, lane.y_range.start, lane.y_range.end) == (1.0, 0.0, 1.0)


@pytest.mark.parametrize(("vehicle", "frame"), [("bogie", True), ("wheelset", False)])
def test_only_a_bogie_has_a_frame_that_moves(vehicle, frame):
    assert Session(f"?vehicle={vehicle}").explore.details.motions.plan.frame is frame


def test_a_click_simulates_and_the_animation_plays_and_pauses(served, page):
    page.goto(served.url)
    page.wait_for_function(READY)
    page.wait_for_timeout(500)
    diagram = page.locator("[aria-label^='Bifurcation diagram']").first.bounding_box()
    page.mouse.click(diagram["x"] + 0.7 * diagram["width"], diagram["y"] + 0.4 * diagram["height"])
    page.get_by_text("peak flange force").or_(page.get_by_text("no flange contact")).wait_for()
    page.locator(".verdict", has_text="limit cycle").wait_for(timeout=30_000)
    pause = page.get_by_role("button", name="pause the motion")
    clock = page.locator("output")
    pause.wait_for()
    before = clock.text_content()
    page.wait_for_timeout(400)
    assert clock.text_content() != before
    pause.click()
    stopped = clock.text_content()
    page.wait_for_timeout(300)
    assert clock.text_content() == stopped


def test_nothing_moves_by_itself_for_those_who_want_less_motion(served, new_page):
    page = new_page(reduced_motion="reduce")
    page.goto(served.url)
    page.wait_for_function(READY)
    page.get_by_role("button", name="Just inside and outside").click()
    page.locator(".verdict").first.wait_for()
    play = page.get_by_role("button", name="play the motion")
    play.wait_for()
    assert "t = 0.0 s" in page.locator("output").text_content()
