"""What the page says of parameters is what the model does when they are changed."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, TABLE_1, bogie, critical_speeds, wheelset
from hunting_app.advice import NOTICED, advice, best, effects, idle
from hunting_app.session import Session

VEHICLES = {"bogie": bogie, "wheelset": wheelset}
factors = st.floats(0.7, 1.4)
designs = st.builds(
    lambda **f: RECONSTRUCTED.replace(**{n: x * getattr(RECONSTRUCTED, n) for n, x in f.items()}),
    **dict.fromkeys(("Ky", "Kpsi", "lam", "m_w", "C1", "m_B"), factors),
)


def found(parameters, vehicle):
    return effects(tuple(parameters.to_dict().values()), vehicle)


def km_h(parameters, vehicle):
    speeds = critical_speeds(VEHICLES[vehicle](parameters))
    return 3.6 * speeds.linear, 3.6 * speeds.nonlinear


@settings(max_examples=12)
@given(designs, st.sampled_from(list(VEHICLES)))
def test_the_advice_raises_the_nonlinear_critical_speed(parameters, vehicle):
    _, before = km_h(parameters, vehicle)
    gains = best(tuple(parameters.to_dict().values()), vehicle)
    assert len(gains) == 3
    for name, share, gain in gains:
        changed = parameters.replace(**{name: (1 + share) * getattr(parameters, name)})
        _, after = km_h(changed, vehicle)
        assert after - before == pytest.approx(gain, abs=0.01), name
        symbol = f"{100 * share:+.0f} % <b>({gain:+.1f} km/h)</b>".replace("-", "−")
        assert symbol in advice({vehicle: gains})


@settings(max_examples=8)
@given(designs)
def test_a_slider_said_to_be_idle_moves_neither_speed_of_either_vehicle(parameters):
    still = idle({vehicle: found(parameters, vehicle) for vehicle in VEHICLES})
    assert "Kr" in still  # the fold is where the flange just touches
    for name in still:
        changed = parameters.replace(**{name: 1.1 * getattr(parameters, name)})
        for vehicle in VEHICLES:
            assert km_h(changed, vehicle) == pytest.approx(
                km_h(parameters, vehicle), abs=1.5 * NOTICED
            ), name


def test_the_frame_is_idle_for_a_wheelset_alone():
    assert "m_B" in idle({"wheelset": found(RECONSTRUCTED, "wheelset")})
    assert "m_B" not in idle({v: found(RECONSTRUCTED, v) for v in VEHICLES})


def test_a_parameter_that_is_zero_is_not_called_idle():
    assert "f22" in idle({"bogie": found(RECONSTRUCTED, "bogie")})
    assert "f22" not in idle({"bogie": found(RECONSTRUCTED.replace(f22=0), "bogie")})


def test_no_advice_is_given_where_nothing_hunts():
    assert best(tuple(TABLE_1.to_dict().values()), "bogie") == []
    assert "there is none" in advice({"bogie": []})
    assert idle({"bogie": found(TABLE_1, "bogie")}) == {}


def test_advice_of_another_design_is_taken_away_at_once():
    session = Session("")
    session.explore.complete() if session.explore.details is None else None
    assert "To raise" in session.advice.content.html
    session.act({"set": "Ky", "to": 9e4})
    assert "To raise" not in session.advice.content.html
    session.act({"rest": True})
    assert "To raise" in session.advice.content.html


def test_a_browser_shows_the_advice_and_greys_idle_sliders(dashboard):
    said = dashboard.page.locator(".advice p")
    said.get_by_text("To raise").wait_for()
    first = re.search(r"rolling radius r0 \+10 % \(\+([\d.]+) km/h\)", said.inner_text())
    assert float(first[1]) > 5
    assert "idle" in dashboard.row("Kr").get_attribute("class")
    assert "idle" not in dashboard.row("Ky").get_attribute("class")
    dashboard.row("Kr").hover()
    assert "Moves no answer here" in dashboard.page.locator(".tip.shown").inner_text()
