"""Parameters: what they accept, what they refuse and in which words, and the two presets."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, TABLE_1, Parameters
from tests.model.subjects import FIELDS

TABLE_1_AS_PRINTED = """
    m_w   264.448    kg
    I_wx  625.7      kg m²
    I_wy  133.92     kg m²
    r0    0.533      m
    d     0.71755    m
    lam   0.05       rad
    W_A   1.8e4      N
    b     1          m
    Ky    8.67e4     N/m
    Cy    2.1e4      N s/m
    Kpsi  8.67e5     N/m
    f11   1.5913e6   N
    f22   2000       N m²
    f12   1.2e5      N m
    f33   1.9135e7   N
    Kr    1.617e7    N/m
    delta 0.00923    m
    C1    1.923e4    N s/m
    C2    5.14e5     N s²/m²
    C3    -3.1127e4  N s³/m³
    C4    5.14e6     N s⁴/m⁴
"""
ROWS = {
    name: (float(value), unit)
    for name, value, unit in (
        line.split(maxsplit=2) for line in TABLE_1_AS_PRINTED.strip().splitlines()
    )
}

each_field = pytest.mark.parametrize("field", FIELDS, ids=lambda f: f.name)
any_field = st.sampled_from(FIELDS)
finite = st.floats(allow_nan=False, allow_infinity=False)


def allows(field, value):
    if field.minimum is None:
        return math.isfinite(value)
    return math.isfinite(value) and (
        value > field.minimum if field.exclusive else value >= field.minimum
    )


@st.composite
def parameter_sets(draw):
    """Any allowed parameters; some fields are arrays of one common shape."""
    shape = draw(st.sampled_from([(), (1,), (3,), (2, 3)]))
    values = {}
    for field in FIELDS:
        low = -1e30 if field.minimum is None else field.minimum
        numbers = st.floats(low, 1e30, exclude_min=field.minimum is not None and field.exclusive)
        size = math.prod(shape)
        if draw(st.booleans()):
            values[field.name] = draw(numbers)
        else:
            flat = draw(st.lists(numbers, min_size=size, max_size=size))
            values[field.name] = np.reshape(flat, shape)
    return Parameters(**values)


# ---------------------------------------------------------------- presets


def test_table_1_is_the_papers_table_with_an_assumed_frame_mass():
    expected = {name: value for name, (value, _) in ROWS.items()}
    assert TABLE_1.to_dict() == {**expected, "m_B": 45_000.0}


def test_units_are_those_of_the_papers_table():
    assert {f.name: f.unit for f in FIELDS} == {n: u for n, (_, u) in ROWS.items()} | {"m_B": "kg"}


def test_the_reconstruction_changes_five_values_of_table_1():
    changed = {
        f.name: getattr(RECONSTRUCTED, f.name)
        for f in FIELDS
        if getattr(RECONSTRUCTED, f.name) != getattr(TABLE_1, f.name)
    }
    assert changed == {"m_w": 1380.0, "f11": 1.5913e7, "Kpsi": 8.67e4, "W_A": 1.8e5, "C2": -9.05e5}


def test_the_reconstructed_creep_coefficients_are_in_kalkers_proportion():
    assert pytest.approx(1.2, rel=0.01) == RECONSTRUCTED.f33 / RECONSTRUCTED.f11
    assert TABLE_1.f33 / TABLE_1.f11 > 10


# ---------------------------------------------------------------- what a person reads of a field


def test_there_are_22_parameters_in_the_order_of_the_dataclass():
    assert [f.name for f in FIELDS] == list(TABLE_1.to_dict())
    assert len(FIELDS) == 22


@each_field
def test_a_field_says_everything_about_itself(field):
    assert field.symbol
    assert field.unit
    assert field.label == field.label.strip() != ""
    assert field.description[0].isupper()
    assert field.description.endswith(".")
    assert field.group


def test_no_two_fields_share_symbol_or_label():
    assert len({f.symbol for f in FIELDS}) == len({f.label for f in FIELDS}) == len(FIELDS)


@each_field
def test_a_slider_cannot_reach_a_forbidden_value(field):
    low, high = field.span
    assert low < high
    assert allows(field, low)
    assert not field.log or low > 0


@each_field
def test_both_presets_are_on_the_slider(field):
    low, high = field.span
    assert low <= getattr(RECONSTRUCTED, field.name) <= high
    assert low <= getattr(TABLE_1, field.name) <= high


def test_figures_4_to_14_name_the_parameter_they_vary():
    of_figure = {f.figure: f.name for f in FIELDS if f.figure}
    assert of_figure == {
        4: "m_w", 5: "r0", 6: "d", 7: "lam", 8: "W_A", 9: "Cy",
        10: "Kpsi", 11: "b", 12: "Kr", 13: "delta", 14: "m_B",
    }  # fmt: skip


# ---------------------------------------------------------------- what is refused, and how


@given(field=any_field, value=finite)
def test_a_finite_number_is_accepted_exactly_if_it_is_in_bounds(field, value):
    if allows(field, value):
        assert getattr(RECONSTRUCTED.replace(**{field.name: value}), field.name) == value
    else:
        with pytest.raises(ValueError) as error:
            RECONSTRUCTED.replace(**{field.name: value})
        assert str(error.value) == f"{field.name} must be {field.bounds}, got {value!r}"


@given(field=any_field, value=st.sampled_from([math.nan, math.inf, -math.inf]))
def test_what_is_not_finite_is_refused(field, value):
    with pytest.raises(ValueError, match=rf"^{field.name} must be .*, got {value!r}$"):
        RECONSTRUCTED.replace(**{field.name: value})


@pytest.mark.parametrize(
    "value",
    ["8e4", "", None, True, 1j, [], [[1.0], [1.0, 2.0]], {}, object(), [1.0, "2"], 10**400, [True]],
    ids=[
        "text",
        "nothing typed",
        "None",
        "bool",
        "complex",
        "empty",
        "ragged",
        "dict",
        "object",
        "text in a list",
        "integer beyond floats",
        "bool in a list",
    ],
)
def test_what_is_no_number_is_refused(value):
    for field in FIELDS:
        with pytest.raises(TypeError) as error:
            RECONSTRUCTED.replace(**{field.name: value})
        message = str(error.value)
        assert message.startswith(f"{field.name} must be a real number")
        assert f"[{field.unit}]" in message
        assert message.endswith(f"got {value!r}")


def test_one_bad_entry_of_an_array_is_named():
    with pytest.raises(ValueError, match=r"^Kr must be > 0 N/m, got -3\.0$"):
        RECONSTRUCTED.replace(Kr=[1e7, -3, 2e7])


def test_bounds_read_as_a_person_would_say_them():
    bounds = {f.name: f.bounds for f in FIELDS}
    assert bounds["Kr"] == "> 0 N/m"
    assert bounds["Cy"] == ">= 0 N s/m"
    assert bounds["C2"] == "a finite number"


@pytest.mark.parametrize("make", [RECONSTRUCTED.replace, Parameters.from_dict])
def test_an_unknown_name_is_refused_with_the_known_ones(make):
    arguments = {**RECONSTRUCTED.to_dict(), "K_y": 1.0}
    with pytest.raises(TypeError, match=r"^unknown parameter K_y; .*\bKy\b") as error:
        make(**arguments) if make == RECONSTRUCTED.replace else make(arguments)
    assert all(f.name in str(error.value) for f in FIELDS)


def test_a_missing_name_is_refused():
    values = RECONSTRUCTED.to_dict()
    del values["Ky"], values["m_B"]
    with pytest.raises(TypeError, match=r"^missing parameters: Ky, m_B$"):
        Parameters.from_dict(values)


def test_shapes_that_do_not_broadcast_are_refused_by_name():
    with pytest.raises(ValueError, match="broadcast") as error:
        RECONSTRUCTED.replace(Ky=[1e4, 2e4, 3e4], Cy=[1e4, 2e4])
    assert "Ky (3,)" in str(error.value)
    assert "Cy (2,)" in str(error.value)


@pytest.mark.parametrize("text", ["[1, 2]", "3", '"Ky"', "null"])
def test_json_that_is_no_object_is_refused(text):
    with pytest.raises(TypeError, match="must be a JSON object"):
        Parameters.from_json(text)


def test_text_that_is_no_json_is_refused():
    with pytest.raises(ValueError):
        Parameters.from_json("Ky = 8e4")


def test_json_has_no_way_around_the_bounds():
    text = RECONSTRUCTED.to_json().replace("86700.0", "NaN", 1)
    with pytest.raises(ValueError, match=r"^Ky must be > 0 N/m, got nan$"):
        Parameters.from_json(text)


# ---------------------------------------------------------------- a set of values


@given(parameter_sets())
def test_a_set_survives_dict_and_json(p):
    assert Parameters.from_dict(p.to_dict()) == p
    assert Parameters.from_json(p.to_json()) == p


@given(p=parameter_sets(), other=parameter_sets())
def test_sets_are_equal_exactly_if_all_values_are(p, other):
    assert (p == other) == (p.to_dict() == other.to_dict())
    assert p == p.replace()


@given(p=parameter_sets(), field=any_field)
def test_replacing_changes_one_value_and_leaves_the_original(p, field):
    before = p.to_dict()
    changed = p.replace(**{field.name: 12.5})
    assert changed.to_dict() == {**before, field.name: 12.5}
    assert p.to_dict() == before


def test_a_set_equals_nothing_else():
    assert RECONSTRUCTED.to_dict() != RECONSTRUCTED
    assert RECONSTRUCTED != TABLE_1
    assert RECONSTRUCTED.replace(Ky=[8.67e4]) != RECONSTRUCTED


def test_arrays_broadcast():
    p = RECONSTRUCTED.replace(Ky=np.ones((3, 1)), Cy=np.ones(4))
    assert p.shape == (3, 4)
    assert RECONSTRUCTED.shape == ()


def test_any_kind_of_number_becomes_a_float():
    p = RECONSTRUCTED.replace(Ky=80_000, Cy=np.float32(2.0), b=np.array(1), d=[1, 2])
    assert [type(v) for v in (p.Ky, p.Cy, p.b)] == [float] * 3
    assert p.d.dtype == float


def test_a_set_cannot_be_changed_in_place():
    stiffness = np.array([1e4, 2e4])
    p = RECONSTRUCTED.replace(Ky=stiffness)
    stiffness[0] = -1
    assert p.Ky.tolist() == [1e4, 2e4]
    with pytest.raises(ValueError, match="read-only"):
        p.Ky[0] = -1
    with pytest.raises(AttributeError):
        p.Ky = 1.0
