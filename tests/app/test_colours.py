"""Colours that stand for different things look different, to colour-blind eyes too."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from hunting_app.palette import DARK, LIGHT

# Machado, Oliveira and Fernandes (2009), complete deficiency, on linear RGB.
EYES = {
    "usual": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritanopia": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
LINES = ("bogie", "wheelset", "averaged", "motion", "hunting", "cursor")
ZONES = ("safe", "conditional", "hunting")
WASH = 0.16  # how much of a zone's colour is seen


def rgb(colour):
    return np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255


def linear(rgb):
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    xyz = TO_XYZ @ np.clip(rgb, 0, 1) / (TO_XYZ @ np.ones(3))
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def difference(one, other, eye):
    return float(np.linalg.norm(lab(EYES[eye] @ one) - lab(EYES[eye] @ other)))


def luminance(colour):
    return float(TO_XYZ[1] @ linear(rgb(colour)))


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_lines_are_told_apart(colours, eye):
    for one, other in combinations(LINES, 2):
        first, second = (linear(rgb(getattr(colours, name))) for name in (one, other))
        found = difference(first, second, eye)
        assert found > 9, (one, other)  # some four times what is just noticed


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_neighbouring_zones_are_told_apart(colours, eye):
    seen = [WASH * rgb(getattr(colours, z)) + (1 - WASH) * rgb(colours.paper) for z in ZONES]
    for one, other in combinations(seen, 2):
        assert difference(linear(one), linear(other), eye) > 4  # 2.3 is just noticed


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_lines_and_words_stand_out_from_the_paper(colours):
    for name in (*LINES, "ink", "faint"):
        light, dark = sorted((luminance(getattr(colours, name)), luminance(colours.paper)))[::-1]
        least = 4.5 if name in ("ink", "faint") else 3.0
        assert (light + 0.05) / (dark + 0.05) >= least, name
