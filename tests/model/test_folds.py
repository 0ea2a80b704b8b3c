"""Turning points from cycles on both sides, across the clearance too."""

from __future__ import annotations

import numpy as np
import pytest

from hunting.folds import FREE, turning_amplitude


def turned(V, slope, low, high, delta):
    Y = np.array([[low], [high]])
    return turning_amplitude(Y, V(Y), slope(Y), np.array([delta]))[0]


def test_a_parabola_turns_at_its_vertex():
    found = turned(lambda Y: (Y - 0.3) ** 2, lambda Y: 2 * (Y - 0.3), 0.1, 0.6, 1.0)
    assert found == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize("stiffness", [1.0, 100.0, 1e4])
def test_a_grazing_fold_is_found_in_the_root_of_the_excess(stiffness):
    """V = -Y + c (Y - 1)^1.5 turns at 1 + (2 / (3 c))^2."""

    def V(Y):
        return -Y + stiffness * np.maximum(Y - 1, 0) ** 1.5

    def slope(Y):
        return -1 + 1.5 * stiffness * np.maximum(Y - 1, 0) ** 0.5

    excess = (2 / (3 * stiffness)) ** 2
    found = turned(V, slope, FREE, 1 + 9 * excess, 1.0)
    assert found - 1 == pytest.approx(excess, rel=1e-6)
