"""Designs known only within limits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm, truncnorm

from hunting import RECONSTRUCTED, TABLE_1, bogie, critical_speeds, sensitivity, uncertainty

SPREADS = {"lam": 0.05, "Kpsi": (8e4, 9.5e4), "Kr": 0.5}


@pytest.fixture(scope="module")
def known():
    return uncertainty(bogie, RECONSTRUCTED, SPREADS, samples=2000, seed=4)


def test_values_fill_their_limits_evenly(known):
    for name, (low, high) in {"lam": (0.0475, 0.0525), "Kpsi": (8e4, 9.5e4)}.items():
        values = known.columns[name]
        assert len(values) == 2000
        counts, _ = np.histogram(values, 20, range=(low, high))
        assert counts.sum() == 2000
        assert np.abs(counts - 100).max() <= 3  # random ones would be off by 10 and more


def test_speeds_are_those_of_the_values(known):
    few = {name: values[:40] for name, values in known.columns.items()}
    alone = critical_speeds(bogie(RECONSTRUCTED.replace(**few)), "averaging")
    np.testing.assert_allclose(known.nonlinear[:40], alone.nonlinear, rtol=1e-9)
    np.testing.assert_allclose(known.linear[:40], alone.linear, rtol=1e-9)


def test_the_same_seed_gives_the_same_numbers_and_another_gives_others(known):
    again = uncertainty(bogie, RECONSTRUCTED, SPREADS, samples=2000, seed=4)
    np.testing.assert_array_equal(again.nonlinear, known.nonlinear)
    other = uncertainty(bogie, RECONSTRUCTED, SPREADS, samples=2000, seed=5)
    assert (other.nonlinear != known.nonlinear).all()


def test_a_distribution_may_be_any_of_scipys():
    law = truncnorm(-3, 3, loc=8.67e4, scale=2e3)
    drawn = uncertainty(bogie, RECONSTRUCTED, {"Ky": law}, samples=512).columns["Ky"]
    assert drawn.mean() == pytest.approx(8.67e4, rel=1e-3)
    assert drawn.std() == pytest.approx(law.std(), rel=0.02)


def test_small_spreads_act_as_the_sensitivities_say():
    """To first order V varies by the root of the sum of squared effects, and each has its share."""
    names, s = ("lam", "Ky", "Kpsi", "m_w"), 0.01
    known = uncertainty(bogie, RECONSTRUCTED, dict.fromkeys(names, s), samples=4096)
    slopes = sensitivity(bogie, RECONSTRUCTED)
    effects = np.array([slopes.of(name)[0] for name in names]) * s / np.sqrt(3)
    V = known.linear
    assert V.std() / V.mean() == pytest.approx(np.linalg.norm(effects), rel=0.02)
    shares = effects**2 / (effects @ effects)
    np.testing.assert_allclose(known.indices["linear"].first_order, shares, atol=0.03)
    np.testing.assert_allclose(known.indices["linear"].total, shares, atol=0.03)


def test_indices_name_what_matters_and_what_does_not(known):
    for speed in ("linear", "nonlinear"):
        found = known.indices[speed]
        assert found.names == ("lam", "Kpsi", "Kr")
        lam, Kpsi, Kr = found.total
        assert lam > 0.1
        assert Kpsi > 0.1
        assert abs(Kr) < 1e-3
        assert found.base == 512


def test_the_probability_is_a_share_with_an_interval_around_it(known):
    V = np.sort(known.nonlinear)
    probability, low, high = known.probability_below(V[500])
    assert probability == 500 / 2000
    assert 0.22 < low < 0.25 < high < 0.28
    assert known.probability_below(1.0) == (0, 0, pytest.approx(0.002, rel=0.1))
    wider = known.probability_below(V[500], confidence=0.999)
    assert wider[1] < low < high < wider[2]


def test_the_interval_covers_the_truth():
    truth = uncertainty(bogie, RECONSTRUCTED, SPREADS, samples=20_000, seed=9)
    V = float(truth.quantiles(0.3))
    hits = 0
    for seed in range(8):
        few = uncertainty(bogie, RECONSTRUCTED, SPREADS, samples=200, seed=seed)
        _, low, high = few.probability_below(V)
        hits += low < 0.3 < high
    assert hits >= 7


def test_quantiles_rise(known):
    low, middle, high = known.quantiles([0.05, 0.5, 0.95])
    assert low < middle < high
    assert (known.nonlinear < middle).mean() == pytest.approx(0.5, abs=1e-3)


def test_sets_without_a_speed_are_counted_and_explained():
    """Table 1 hunts only when the wheelset is heavier than printed."""
    known = uncertainty(bogie, TABLE_1, {"m_w": (200.0, 3000.0)}, samples=400)
    missing = int(np.isnan(known.nonlinear).sum())
    assert 0 < missing < 400
    assert sum(known.gaps().values()) == missing
    assert "no Hopf point in range" in known.gaps()
    probability, *_ = known.probability_below(1e3)
    assert probability == 1


def test_nothing_at_all_is_an_answer_too():
    known = uncertainty(bogie, TABLE_1, {"Kr": 0.1}, samples=64)
    assert known.gaps() == {"no Hopf point in range": 64}
    assert np.isnan(known.probability_below(40.0)).all()
    assert np.isnan(known.quantiles([0.1, 0.9])).all()
    assert np.isnan(known.indices["nonlinear"].total).all()


def test_a_table_has_a_line_for_each_set(known):
    lines = known.csv().splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    assert rows[0].startswith("lam [rad],Kpsi [N/m],Kr [N/m],linear critical speed V_lin [km/h]")
    assert len(rows) == 1 + 2000


@pytest.mark.parametrize(
    ("spreads", "error", "words"),
    [
        ({}, TypeError, "spreads must be of one or more of m_w"),
        ({"mass": 0.1}, TypeError, "spreads must be of"),
        ({"m_w": 1.5}, ValueError, "m_w must be > 0 kg, got -"),
        ({"m_w": (2e3, 1e3)}, ValueError, "spread of m_w must be low, high"),
        ({"m_w": norm(1000, 1000)}, ValueError, "m_w must be > 0 kg, got -"),
    ],
)
def test_a_wrong_spread_is_refused_by_its_name(spreads, error, words):
    with pytest.raises(error, match=words):
        uncertainty(bogie, RECONSTRUCTED, spreads, samples=256)


def test_one_sample_is_too_few():
    with pytest.raises(ValueError, match="samples must be 2 or more, got 1"):
        uncertainty(bogie, RECONSTRUCTED, SPREADS, samples=1)
