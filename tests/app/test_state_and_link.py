"""What a person types and what a link holds: understood, or refused in words."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, TABLE_1
from hunting_app import link
from hunting_app.numerals import compact, parsed, rounded_up, written
from hunting_app.state import FIELDS, PRESETS, State, with_preset, with_reset, with_value

numbers = st.floats(allow_nan=False, allow_infinity=False, width=64)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1.2e5", 1.2e5),
        ("86,700", 86700.0),
        ("86 700", 86700.0),
        ("1,234,567.5", 1234567.5),
        (" +3. ", 3.0),
        ("−905,000", -905000.0),
        (".5", 0.5),
        ("1E-3", 1e-3),
    ],
)
def test_numbers_are_read_in_the_usual_notations(text, value):
    assert parsed(text) == value


@pytest.mark.parametrize(
    "text", ["", "abc", "1,5", "12,34", "1e", "nan", "inf", "1_000", "0x1", "--1"]
)
def test_what_is_no_number_is_refused_in_words(text):
    with pytest.raises(ValueError, match=r"number|not clear"):
        parsed(text)


@given(numbers)
def test_what_is_written_can_be_typed_back(value):
    assert parsed(written(value)) == pytest.approx(value, rel=1e-6, abs=0)


@given(numbers)
def test_a_link_keeps_every_digit(value):
    assert float(compact(value)) == value


@given(st.floats(1e-12, 1e12))
def test_an_axis_end_is_just_beyond_what_it_shows(value):
    assert value * (1 - 1e-9) <= rounded_up(value) <= 2 * value


def test_a_fresh_state_needs_no_link():
    assert link.query(State()) == ""
    assert link.changes("") == ({**_choices(State())}, [])


def test_a_link_holds_only_what_differs_from_the_preset():
    state = State(**with_preset("table1"), vehicle="both")
    state.param.update(**with_value(state, "Ky", "1e5"))
    assert link.query(state) == "?preset=table1&Ky=100000&vehicle=both"


@given(
    st.sampled_from(list(PRESETS)),
    st.dictionaries(st.sampled_from(list(FIELDS)), st.floats(1e-3, 1e6), max_size=4),
    st.sampled_from(["bogie", "wheelset", "both"]),
    st.floats(1, 400),
)
def test_a_link_opens_the_state_it_was_made_of(preset, values, vehicle, speed):
    state = State(**with_preset(preset), vehicle=vehicle, speed=speed)
    for name, value in values.items():
        state.param.update(**with_value(state, name, value))
    again, refused = link.changes(link.query(state))
    assert refused == []
    assert again == _choices(state)


def _choices(state):
    return {name: getattr(state, name) for name in link.changes("")[0]}


@pytest.mark.parametrize(
    ("search", "word"),
    [
        ("?Ky=abc", "Ky"),
        ("?Ky=-5", "Ky must be > 0 N/m"),
        ("?Ky=", "Ky"),
        ("?Ky=nan", "Ky"),
        ("?vehicle=tram", "bogie, wheelset, both"),
        ("?preset=none", "reconstructed, table1"),
        ("?nonsense=1", "nonsense"),
        ("?V=0", "V must be > 0 km/h"),
        ("?V=9999", "V must be at most 1440 km/h"),
        ("?page=<script>", "explore, study, model"),
    ],
)
def test_rubbish_in_a_link_is_refused_in_words_and_the_rest_counts(search, word):
    made, refused = link.changes(search + "&delta=0.01")
    assert len(refused) == 1
    assert word in refused[0]
    assert made == _choices(State(parameters=RECONSTRUCTED.replace(delta=0.01)))


@given(st.text(max_size=60))
def test_no_link_is_an_exception(search):
    made, _ = link.changes(f"?{search}")
    State(**made)


def test_resetting_one_parameter_keeps_the_others():
    state = State()
    for name, value in (("Ky", 1e5), ("m_w", 2000.0)):
        state.param.update(**with_value(state, name, value))
    assert state.changed() == ["m_w", "Ky"]
    state.param.update(**with_reset(state, ["Ky"]))
    assert state.changed() == ["m_w"]


def test_table_1_is_the_base_once_it_is_chosen():
    state = State(**with_preset("table1"))
    assert state.parameters == TABLE_1
    assert state.changed() == []
    assert math.isclose(state.base().m_w, 264.448)
