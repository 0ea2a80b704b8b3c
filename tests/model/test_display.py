"""Parameters and critical speeds as a person sees them, in a terminal and in a notebook."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import numpy as np
import pytest

from hunting import RECONSTRUCTED, TABLE_1, Parameters, bogie, critical_speeds, wheelset


class _Balance(HTMLParser):
    """Fails where a tag is closed that is not the last one opened."""

    def __init__(self):
        super().__init__()
        self.open, self.rows = [], 0

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.rows += tag == "tr"

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def rows_of(html):
    parser = _Balance()
    parser.feed(html)
    assert not parser.open
    return parser.rows


def test_parameters_are_a_table_of_names_symbols_values_and_units():
    lines = repr(RECONSTRUCTED).splitlines()
    assert len(lines) == len(Parameters.fields())
    for line, field in zip(lines, Parameters.fields(), strict=True):
        name, symbol, _, *rest = line.split()
        assert (name, symbol) == (field.name, field.symbol)
        assert " ".join(rest) == f"{field.unit} {field.label}"
    assert any(re.fullmatch(r"C2 +C_2 +−905,000 +N s²/m² .*", line) for line in lines)


def test_in_a_notebook_symbols_have_their_subscripts():
    html = RECONSTRUCTED._repr_html_()
    assert rows_of(html) == 1 + len(Parameters.fields())
    assert "<i>K</i><sub>ψ</sub></td><td>86,700</td><td>N/m</td>" in html
    assert "<i>λ</i></td><td>0.05</td>" in html


@pytest.mark.parametrize(
    ("values", "shown"),
    [
        ([6e4], "60,000"),
        ([6e4, 8e4], "60,000; 80,000"),
        (np.linspace(1e4, 1e6, 41), "41 values, 10,000 to 1e6"),
        (np.full(5, 7e4), "5 values, 70,000"),
        (np.array([[1e4], [2e4]]), "2 × 1 values, 10,000 to 20,000"),
    ],
)
def test_an_array_is_shown_by_its_values_or_its_ends(values, shown):
    parameters = RECONSTRUCTED.replace(Ky=values)
    assert f" {shown}  N/m" in repr(parameters)
    assert f"<td>{shown}</td><td>N/m</td>" in parameters._repr_html_()


def test_critical_speeds_are_a_sentence_and_numbers_in_km_h():
    speeds = critical_speeds(bogie(RECONSTRUCTED))
    sentence, head, numbers = repr(speeds).splitlines()
    assert sentence.startswith("Below V_nl = 138.87 km/h every motion dies out")
    assert "V_lin = 149.42 km/h" in sentence
    assert head.split("  ")[0] == "V_nl [km/h]"
    assert numbers.split() == ["138.87", "149.42", "9.23", "2.20", "subcritical"]
    html = speeds._repr_html_()
    assert "<i>V</i><sub>nl</sub> = 138.87 km/h" in html
    assert "<td>149.42</td>" in html
    assert rows_of(html) == 2


def test_without_a_band_nothing_is_said_of_one():
    supercritical = critical_speeds(wheelset(RECONSTRUCTED.replace(C2=5e5)))
    assert "depends on the disturbance" not in repr(supercritical)
    assert "supercritical Hopf point" in repr(supercritical)


def test_low_speed_windows_are_part_of_the_sentence():
    speeds = critical_speeds(bogie(RECONSTRUCTED.replace(Ky=2e5)))
    assert len(speeds.windows) == 1
    assert "(primary hunting)" in repr(speeds)


def test_where_there_is_no_critical_speed_the_reason_is_all():
    speeds = critical_speeds(bogie(TABLE_1))
    assert repr(speeds) == "No critical speed: no Hopf point in range."
    assert speeds._repr_html_() == "<p>No critical speed: no Hopf point in range.</p>"


def test_a_stack_shows_its_range_and_its_first_systems():
    speeds = critical_speeds(wheelset(RECONSTRUCTED.replace(Ky=np.linspace(4e4, 9e4, 12))))
    sentence, _, *systems, rest = repr(speeds).splitlines()
    assert sentence.startswith("Critical speeds of 12 systems: V_nl ")
    assert len(systems) == 10
    assert rest == "… and 2 more"
    assert rows_of(speeds._repr_html_()) == 11


def test_a_gap_in_a_stack_is_a_dash():
    mixed = {name: [getattr(RECONSTRUCTED, name), getattr(TABLE_1, name)] for name in
             ("m_w", "f11", "Kpsi", "W_A", "C2")}  # fmt: skip
    speeds = critical_speeds(wheelset(RECONSTRUCTED.replace(**mixed)))
    sentence, _, _, second = repr(speeds).splitlines()
    assert "(1 without)" in sentence
    assert second.split() == ["1", "–", "–", "–", "–", "none"]
