"""Half a period cut at the instants where a force law changes."""

from __future__ import annotations

import numpy as np
import pytest

from hunting.half_period import NODES, half_period, radau_nodes

ORDERS = np.array([1, 3])


def cut(U, kink):
    U = np.asarray(U, dtype=complex).reshape(1, -1, 1)
    return half_period(U, ORDERS[: U.shape[1]], [kink], panels=4)


def test_the_rule_is_exact_for_polynomials():
    nodes, weights = radau_nodes()
    assert nodes[-1] == 1
    for power in range(2 * NODES - 1):
        assert weights @ nodes**power == pytest.approx(1 / (power + 1), rel=1e-13)


@pytest.mark.parametrize("excess", [1e-8, 1e-4, 0.1, 3.0])
def test_contact_opens_and_closes_at_edges(excess):
    """However short it is."""
    angle = np.arccos(1 / (1 + excess))
    edges = cut([1 + excess], 1.0).edges[0]
    for instant in (angle, np.pi - angle):
        assert np.abs(edges - instant).min() < 1e-8
    for base in np.linspace(0, np.pi, 5):
        assert np.abs(edges - base).min() < 1e-14


def test_a_change_of_sign_is_an_edge_where_there_is_no_kink():
    edges = cut([np.exp(0.7j), 0.1], None).edges[0]
    u = np.cos(edges + 0.7) + 0.1 * np.cos(3 * edges)
    assert np.abs(u).min() < 1e-13


def test_weights_add_up_and_nodes_stay_within_their_panels():
    half = cut([1.2, 0.1j], 1.0)
    assert half.weights.sum() == pytest.approx(np.pi, rel=1e-14)
    theta = half.theta[0].reshape(half.panels, NODES)
    assert (theta >= half.edges[0, :-1, None]).all()
    assert (theta <= half.edges[0, 1:, None]).all()


def test_motions_that_do_not_touch_are_cut_evenly():
    edges = cut([0.9], 1.0).edges[0]
    assert set(np.unique(edges)) == set(np.linspace(0, np.pi, 5))
