"""Units change what is read and typed, never what is computed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hunting_app import link
from hunting_app.numerals import written
from hunting_app.session import Session
from hunting_app.state import FIELDS, PRESETS
from hunting_app.units import ENGINEERING, UNITS, scale

names = st.sampled_from(list(FIELDS))
systems = st.sampled_from(list(UNITS))


@given(names, systems, st.integers(1, 9_999_999), st.integers(-8, 8))
def test_what_is_shown_can_be_typed_back(name, units, digits, exponent):
    value = float(f"{digits}e{exponent}")  # seven digits are shown
    shown = scale(name, units)
    assert shown.read(written(shown.shown(value))) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("preset", PRESETS.values(), ids=PRESETS)
def test_a_preset_is_still_itself_after_its_values_were_typed(preset, units):
    for name in FIELDS:
        value = getattr(preset.parameters, name)
        assert scale(name, units).read(written(scale(name, units).shown(value))) == value


@given(names, st.floats(0.1, 1e6))
def test_a_unit_typed_behind_the_number_counts(name, value):
    units = [scale(name, units).field.unit for units in UNITS]
    read = [scale(name, ENGINEERING).read(f"{value!r} {unit}") for unit in units]
    assert read == [scale(name, units).si(value) for units in UNITS]


@pytest.mark.parametrize(
    ("name", "typed", "words"),
    [
        ("Ky", "0", "Ky must be > 0 kN/m, got 0.0"),
        ("delta", "-9", "delta must be > 0 mm, got -9.0"),
        ("m_B", "-1", "m_B must be > 0 t, got -1.0"),
        ("Ky", "86.7 k", "“86.7 k” is not a number"),
        ("Ky", "5 kg", "“5 kg” is not a number"),
    ],
)
def test_a_refusal_speaks_in_the_unit_shown(name, typed, words):
    session = Session("?units=engineering")
    session.act({"set": name, "to": typed, "units": ENGINEERING})
    assert session.sidebar.refused == {name: words}
    assert session.sidebar.values == Session("?units=engineering").sidebar.values


def test_the_link_keeps_the_units_and_gives_values_in_si():
    session = Session("?units=engineering&Ky=90000")
    assert session.sidebar.values["Ky"] == 90.0
    session.act({"set": "Ky", "to": "95", "units": ENGINEERING})
    assert link.query(session.state) == "?Ky=95000&units=engineering"


def test_a_value_on_its_way_while_the_units_change_is_not_misread():
    session = Session("")
    session.act({"units": ENGINEERING})
    session.act({"set": "Ky", "to": 9e4, "units": "si"})
    assert session.state.parameters.Ky == 9e4
    assert session.sidebar.values["Ky"] == 90.0
