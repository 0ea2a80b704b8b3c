"""The exact branch beside the averaged one."""

from __future__ import annotations

import numpy as np
import pytest

from hunting import RECONSTRUCTED, bogie, critical_speeds, limit_cycles
from hunting_app import link
from hunting_app.picture import KMH, MM, picture
from hunting_app.session import Session


@pytest.fixture
def session():
    return Session("")


def column(source, name):
    return np.asarray(source.data[name], dtype=float)


def test_the_nonlinear_critical_speed_shown_is_the_exact_one(session):
    exact = KMH * critical_speeds(bogie(RECONSTRUCTED)).nonlinear
    averaged = KMH * critical_speeds(bogie(RECONSTRUCTED), method="averaging").nonlinear
    strip = session.explore.texts["answers"].html
    assert f"{exact:.1f}<small> km/h" in strip
    assert f"averaging says {averaged:.1f}, {averaged - exact:.1f} km/h too high" in strip


def test_the_exact_branch_can_be_hidden_and_averaging_answers_instead(session):
    session.act({"exact": "hidden"})
    diagram = session.explore.bifurcation
    assert not column(diagram.branches["bogie"], "V").size
    assert column(diagram.averaged["bogie"], "V").size
    assert "by averaging" in session.explore.texts["answers"].html
    cycle = picture(RECONSTRUCTED, "bogie", 145.0, exact=False).moments["bogie"].cycles[0]
    drawn = column(session.explore.details.portraits.cycles.unstable["bogie"], "y").max()
    assert drawn == pytest.approx(MM * cycle.amplitude, rel=1e-4)


def test_the_averaged_branch_can_be_hidden(session):
    session.act({"averaged": "hidden"})
    diagram = session.explore.bifurcation
    assert not column(diagram.averaged["bogie"], "V").size
    assert column(diagram.branches["bogie"], "V").size


def test_a_link_keeps_what_is_hidden(session):
    session.act({"averaged": "hidden"})
    assert link.query(session.state) == "?averaged=hidden"
    assert Session("?averaged=hidden").state.averaged == "hidden"


def test_portraits_show_the_exact_cycles(session):
    cycles = limit_cycles(bogie(RECONSTRUCTED)).at_speed(145.0 / KMH)
    drawn = column(session.explore.details.portraits.cycles.unstable["bogie"], "y").max()
    assert drawn == pytest.approx(MM * cycles[0].amplitude, rel=1e-4)


def test_the_exact_branch_follows_a_slider_in_the_browser(served, page):
    from playwright.sync_api import expect  # not there where browser tests are skipped

    page.goto(served.url)
    shown = page.locator("[data-answer='nonlinear critical speed'] dd")
    page.locator("input[type=range][data-name=Ky]").wait_for()
    stiffer = RECONSTRUCTED.replace(Ky=1.2e5)
    page.locator("input[type=text][data-name=Ky]").fill("1.2e5")
    page.locator("input[type=text][data-name=Ky]").press("Enter")
    exact = KMH * critical_speeds(bogie(stiffer)).nonlinear
    expect(shown).to_contain_text(f"{exact:.1f}", timeout=20_000)
