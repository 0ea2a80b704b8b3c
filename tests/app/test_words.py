"""The sentences on the page say what the picture shows."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hunting import RECONSTRUCTED, TABLE_1
from hunting_app import words
from hunting_app.glossary import GLOSSARY, explained
from hunting_app.picture import KMH, MM, picture

factors = st.floats(0.6, 1.6)
designs = st.builds(
    lambda **f: RECONSTRUCTED.replace(**{n: x * getattr(RECONSTRUCTED, n) for n, x in f.items()}),
    **dict.fromkeys(("Ky", "Kpsi", "lam", "C1", "C2", "delta", "f11", "m_B"), factors),
)
speeds = st.floats(20.0, 260.0)
vehicles = st.sampled_from(["bogie", "wheelset"])


def numbers(text):
    return [float(x) for x in re.findall(r"[-−]?\d+(?:\.\d+)?", text.replace("−", "-"))]


@settings(max_examples=40)
@given(designs, vehicles, speeds)
def test_the_sentence_of_the_diagram_is_what_its_curves_say(parameters, vehicle, speed):
    shown = picture(parameters, vehicle, speed)
    one, moment, said = shown.answers[vehicle], shown.moments[vehicle], words.diagram(shown)
    said_numbers = numbers(said)
    assert said_numbers[0] == pytest.approx(speed, rel=1e-3)
    linear, nonlinear = KMH * one.critical.linear, KMH * one.critical.nonlinear
    sizes = {c.stable: round(MM * c.amplitude, 1) for c in moment.cycles}
    if "conditionally stable" in said:
        assert one.lowest - 0.1 <= speed <= linear + 0.1
        assert sizes[False] in said_numbers
    elif "is safe" in said:
        assert not speed > nonlinear
        assert moment.centre_is_stable
        assert not moment.cycles
    elif "hunts by itself" in said:
        assert not moment.centre_is_stable
    else:
        assert re.search("runs stably|branch ends|hunts: its centred", said), said
    if "with an amplitude of" in said:
        assert any(round(MM * c.amplitude, 1) in said_numbers for c in moment.cycles if c.stable)


@settings(max_examples=40)
@given(designs, vehicles, speeds)
def test_the_sentences_of_portraits_and_damping_give_the_cycles_and_the_least_damping(
    parameters, vehicle, speed
):
    shown = picture(parameters, vehicle, speed)
    moment, said = shown.moments[vehicle], words.portraits(shown)
    expected = [
        round(x, digits)
        for c in moment.cycles
        for x, digits in ((MM * c.amplitude, 1), (c.frequency / (2 * math.pi), 2))
    ]
    assert numbers(said)[1:] == expected
    assert said.count("unstable cycle") == sum(not c.stable for c in moment.cycles)
    assert ("centre stable" in said) == moment.centre_is_stable
    damping = numbers(words.stability(shown))
    assert damping[1] == pytest.approx(100 * moment.damping.min(), abs=0.0051)


@settings(max_examples=30)
@given(designs, vehicles)
def test_the_damper_is_said_to_push_where_its_force_is_negative(parameters, vehicle):
    shown = picture(parameters, vehicle, 145.0)
    one = shown.answers[vehicle]
    warning = next((w for w in words.warnings(shown).values() if "damper" in w), None)
    largest = one.branch.motion(int(np.argmax(one.branch.amplitude)))
    v = parameters.b * largest.state[:, 3]  # psi'
    v = np.linspace(0, np.abs(v).max(), 4000)[1:]
    C1, C2, C3, C4 = (getattr(parameters, f"C{k}") for k in (1, 2, 3, 4))
    force = C1 * v + C2 * v**2 + C3 * v**3 + C4 * v**4
    assert (warning is not None) == bool((force < 0).any())
    if warning:
        assert numbers(warning)[0] == pytest.approx(v[force < 0][0], rel=0.02)


def test_where_the_branch_ends_is_said_even_beside_a_fold():
    shown = picture(RECONSTRUCTED, "bogie", 145.0)
    assert shown.answers["bogie"].exact.fold is not None
    (ending,) = (w for w in words.warnings(shown).values() if "second fold" in w)
    assert numbers(ending)[-1] == round(3.6 * shown.answers["bogie"].exact.speed[-1])


def test_nothing_hunts_without_a_warning_too_many():
    shown = picture(TABLE_1, "bogie", 145.0)
    assert words.warnings(shown) == {}
    assert "no Hopf point" in words.diagram(shown)


def test_a_term_is_explained_once_in_a_sentence():
    html = explained("a fold, a low-speed window & another fold")
    assert html.count("bubble") == 2
    assert "&amp;" in html
    assert GLOSSARY["fold"] in html


def test_an_averaged_branch_that_falls_to_speed_zero_says_nothing_beside_the_exact_one():
    shown = picture(RECONSTRUCTED.replace(W_A=57649219.0), "bogie", 145.0)
    one, said = shown.answers["bogie"], words.answers(shown)
    assert one.averaged.fold is not None
    assert math.isnan(one.averaging.nonlinear)
    assert math.isfinite(one.critical.nonlinear)
    assert "nan" not in said
    assert "averaging says" not in said
