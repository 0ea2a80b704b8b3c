"""Sweeps over parameters, the paper's figures, and what it claims about them."""

from __future__ import annotations

import csv
import dataclasses
import os
import signal
import subprocess
import sys
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

from hunting import (
    RECONSTRUCTED,
    TABLE_1,
    Cancelled,
    Parameters,
    bogie,
    cases,
    claims,
    critical_speeds,
    figure,
    limit_cycles,
    sweep,
    wheelset,
)
from hunting.claims import Curves, falls_and_flattens, follows_no_rule, goes, stays, turns_down
from hunting.study import KY_FACTORS, NUMBERS
from tests.model.subjects import both_vehicles

AXES = {"Ky": np.geomspace(4e4, 2e5, 7), "lam": np.linspace(0.03, 0.2, 5)}
QUANTITIES = ("linear", "nonlinear", "amplitude", "frequency", "criticality", "message")


def assert_identical(one, other):
    for name in QUANTITIES:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.csv() == other.csv()


@pytest.fixture
def small_chunks(monkeypatch):
    """Cut 35 points into 9 chunks."""
    monkeypatch.setattr(cases, "CHUNK", 4)


# ---------------------------------------------------------------- grids


@both_vehicles
@pytest.mark.parametrize("method", ["averaging", "harmonic_balance"])
def test_each_point_of_a_sweep_is_what_its_parameters_give_alone(vehicle, method):
    grid = sweep(vehicle, RECONSTRUCTED, AXES, method)
    assert grid.linear.shape == grid.shape == (7, 5)
    for i, j in [(0, 0), (2, 4), (6, 1)]:
        p = RECONSTRUCTED.replace(Ky=AXES["Ky"][i], lam=AXES["lam"][j])
        alone = critical_speeds(vehicle(p), method)
        for name in ("linear", "nonlinear", "frequency"):
            assert getattr(grid, name)[i, j] == pytest.approx(getattr(alone, name), rel=1e-7)
        assert grid.criticality[i, j] == alone.criticality


def test_chunks_do_not_show_in_the_answer(small_chunks):
    grid = sweep(bogie, RECONSTRUCTED, AXES, "averaging")
    stack = RECONSTRUCTED.replace(Ky=AXES["Ky"][:, None], lam=AXES["lam"])
    whole = critical_speeds(bogie(stack), "averaging")
    np.testing.assert_allclose(grid.nonlinear, whole.nonlinear, rtol=1e-12)


def test_a_gap_has_its_reason():
    grid = sweep(bogie, TABLE_1, {"m_w": [264.448, 2000.0]}, "averaging")
    np.testing.assert_array_equal(np.isnan(grid.nonlinear), grid.message != "")
    assert grid.gaps() == {str(grid.message[0]): 1}


def test_a_table_says_what_it_was_computed_from():
    text = sweep(bogie, TABLE_1, {"m_w": [264.448, 2000.0]}, "averaging").csv()
    head = [line for line in text.splitlines() if line.startswith("#")]
    body = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    assert head[1].startswith("# bogie-hunting 0.")
    assert "# vehicle: bogie" in head
    assert "# method: averaging" in head
    assert "# Kpsi = 867000.0 N/m (yaw stiffness)" in head
    assert not any(line.startswith("# m_w") for line in head)
    assert float(body[0]["m_w [kg]"]) == 264.448
    assert body[0]["nonlinear critical speed V_nl [km/h]"] == ""
    assert body[0]["reason for a gap"] == "no Hopf point in range"


@pytest.mark.parametrize(
    ("axes", "error", "words"),
    [
        ({}, TypeError, "axes must be one or more of m_w, .* got"),
        ({"mass": [1.0]}, TypeError, r"got \['mass'\]"),
        ({"Kr": [1.0, -2.0]}, ValueError, "Kr must be > 0 N/m, got -2.0"),
        ({"Kr": [[1.0, 2.0]]}, ValueError, "axis Kr must be one-dimensional"),
        ({"Kr": "soft"}, TypeError, "Kr must be a real number"),
    ],
)
def test_a_wrong_axis_is_refused_by_its_name(axes, error, words):
    with pytest.raises(error, match=words):
        sweep(bogie, RECONSTRUCTED, axes)


def test_a_stack_of_parameters_is_no_design():
    with pytest.raises(ValueError, match=r"parameters must be numbers, got .* \(2,\)"):
        sweep(bogie, RECONSTRUCTED.replace(Ky=[1e4, 2e4]), AXES)


def test_an_unknown_method_is_refused():
    with pytest.raises(ValueError, match="method must be one of"):
        sweep(bogie, RECONSTRUCTED, AXES, "guess")


# ---------------------------------------------------------------- progress


def test_progress_counts_the_points(small_chunks):
    seen = []
    sweep(bogie, RECONSTRUCTED, AXES, "averaging", progress=lambda *n: seen.append(n))
    assert seen == [(done, 35) for done in (*range(0, 35, 4), 35)]


def test_no_chunk_is_begun_once_progress_says_false(small_chunks, monkeypatch):
    begun = []
    answers = cases.Cases.answers
    monkeypatch.setattr(cases.Cases, "answers", lambda self: begun.append(1) or answers(self))
    with pytest.raises(Cancelled, match="cancelled after 12 of 35 cases"):
        sweep(bogie, RECONSTRUCTED, AXES, "averaging", progress=lambda done, total: done < 12)
    assert len(begun) == 3


def test_what_was_finished_before_a_cancel_is_kept(small_chunks, tmp_path):
    with pytest.raises(Cancelled):
        sweep(
            bogie, RECONSTRUCTED, AXES, "averaging",
            progress=lambda done, total: done < 12, store=tmp_path,
        )  # fmt: skip
    seen = []
    again = sweep(
        bogie, RECONSTRUCTED, AXES, "averaging",
        progress=lambda done, total: seen.append(done), store=tmp_path,
    )  # fmt: skip
    assert seen[0] == 12
    assert_identical(again, sweep(bogie, RECONSTRUCTED, AXES, "averaging"))


# ---------------------------------------------------------------- the store


def files(store):
    return {path.name: path.read_bytes() for path in store.rglob("*") if path.is_file()}


def test_a_finished_sweep_is_read_not_computed(small_chunks, tmp_path, monkeypatch):
    first = sweep(bogie, RECONSTRUCTED, AXES, "averaging", store=tmp_path)
    monkeypatch.setattr(cases.Cases, "answers", None)
    assert_identical(sweep(bogie, RECONSTRUCTED, AXES, "averaging", store=tmp_path), first)


@pytest.mark.parametrize(
    "other",
    [
        {"vehicle": wheelset},
        {"parameters": RECONSTRUCTED.replace(C1=1.9e4)},
        {"axes": AXES | {"lam": AXES["lam"] * (1 + 1e-15)}},
        {"axes": {"Ky": AXES["Ky"], "Cy": AXES["lam"]}},
        {"method": "harmonic_balance"},
    ],
    ids=["vehicle", "parameters", "values", "names", "method"],
)
def test_another_sweep_has_chunks_of_its_own(small_chunks, tmp_path, other):
    asked = {"vehicle": bogie, "parameters": RECONSTRUCTED, "axes": AXES, "method": "averaging"}
    sweep(**asked, store=tmp_path)
    sweep(**(asked | other), store=tmp_path)
    assert len(list(tmp_path.iterdir())) == 2


def test_another_version_has_chunks_of_its_own(small_chunks, tmp_path, monkeypatch):
    sweep(bogie, RECONSTRUCTED, AXES, "averaging", store=tmp_path)
    monkeypatch.setattr(cases, "version", lambda name: "99")
    sweep(bogie, RECONSTRUCTED, AXES, "averaging", store=tmp_path)
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 rubbish", None], ids=["empty", "cut", "half"])
def test_a_damaged_chunk_is_computed_again(small_chunks, tmp_path, damage):
    first = sweep(bogie, RECONSTRUCTED, AXES, "averaging", store=tmp_path)
    before = files(tmp_path)
    (chunk,) = tmp_path.rglob("chunk-000003.npz")
    chunk.write_bytes(before[chunk.name][: chunk.stat().st_size // 2] if damage is None else damage)
    assert_identical(sweep(bogie, RECONSTRUCTED, AXES, "averaging", store=tmp_path), first)
    assert files(tmp_path) == before


KILLED = """
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
import numpy as np
from hunting import RECONSTRUCTED, bogie, cases, sweep

if __name__ == "__main__":
    axes = {"Ky": np.geomspace(4e4, 2e5, 120), "lam": np.linspace(0.03, 0.2, 100)}
    workers = int(sys.argv[2])
    pool = ProcessPoolExecutor(workers, get_context("spawn")) if workers else None
    sweep(
        bogie, RECONSTRUCTED, axes, "averaging", pool,
        progress=lambda done, total: print(done, flush=True), store=sys.argv[1],
    )
"""


@pytest.mark.parametrize("workers", [0, 2], ids=["here", "in two processes"])
def test_a_killed_sweep_goes_on_where_it_stopped(tmp_path, workers):
    script, store = tmp_path / "killed.py", tmp_path / "store"
    script.write_text(KILLED)
    process = subprocess.Popen(
        [sys.executable, script, store, str(workers)],
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    told = 0
    for line in process.stdout:
        told = int(line)
        if told >= 3000:
            break
    os.killpg(process.pid, signal.SIGKILL)
    told = max([told, *map(int, process.stdout.read().split())])
    process.stdout.close()
    process.wait()
    assert 3000 <= told < 12_000

    axes = {"Ky": np.geomspace(4e4, 2e5, 120), "lam": np.linspace(0.03, 0.2, 100)}
    seen = []
    again = sweep(
        bogie, RECONSTRUCTED, axes, "averaging",
        progress=lambda done, total: seen.append(done), store=store,
    )  # fmt: skip
    assert told <= seen[0] < 12_000
    unharmed = sweep(bogie, RECONSTRUCTED, axes, "averaging", store=tmp_path / "other")
    assert_identical(again, unharmed)
    kept = {name: data for name, data in files(store).items() if not name.endswith(".tmp")}
    assert kept == files(tmp_path / "other")


# ---------------------------------------------------------------- executors


def test_processes_and_threads_give_the_same_numbers(small_chunks):
    here = sweep(bogie, RECONSTRUCTED, AXES, "averaging")
    with ThreadPoolExecutor(2) as threads:
        assert_identical(sweep(bogie, RECONSTRUCTED, AXES, "averaging", threads), here)
    with ProcessPoolExecutor(2, get_context("spawn")) as processes:
        assert_identical(sweep(bogie, RECONSTRUCTED, AXES, "averaging", processes), here)


def test_only_so_many_chunks_are_under_way(monkeypatch):
    monkeypatch.setattr(cases, "CHUNK", 1)
    pending, most = [], []

    class Counting(ThreadPoolExecutor):
        def submit(self, *work):
            pending[:] = [future for future in pending if not future.done()]
            pending.append(super().submit(*work))
            most.append(len(pending))
            return pending[-1]

    with Counting(1) as threads:
        sweep(bogie, RECONSTRUCTED, {"Ky": np.linspace(5e4, 9e4, 200)}, "averaging", threads)
    assert len(most) == 200
    assert max(most) <= cases._IN_FLIGHT


def ends_its_process(p):
    """A vehicle that kills the worker which is asked for a stiff one."""
    if np.max(p.Ky) > 1.5e5:
        os.kill(os.getpid(), signal.SIGKILL)
    return bogie(p)


def test_a_pool_whose_process_was_killed_is_reported_and_what_was_done_is_kept(
    small_chunks, tmp_path
):
    with (
        ProcessPoolExecutor(1, get_context("spawn")) as processes,
        pytest.raises(BrokenExecutor, match=r"was killed .* with a new executor"),
    ):
        sweep(
            ends_its_process, RECONSTRUCTED, AXES, "averaging", processes, store=tmp_path
        )  # fmt: skip
    assert len(list(tmp_path.rglob("*.npz"))) >= 1


def test_an_error_in_a_worker_is_raised_here(small_chunks):
    with ThreadPoolExecutor(2) as threads, pytest.raises(ValueError, match="method must be"):
        sweep(bogie, RECONSTRUCTED, AXES, "guess", threads)


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_numbers_though_a_worker_is_killed():
    distributed = pytest.importorskip("distributed")
    axes = {"Ky": np.geomspace(4e4, 2e5, 80), "lam": np.linspace(0.03, 0.2, 100)}
    here = sweep(bogie, RECONSTRUCTED, axes, "averaging")
    killed = []

    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
            host="127.0.0.1",
        ) as cluster,
        distributed.Client(cluster) as client,
    ):  # fmt: skip
        client.wait_for_workers(2, timeout=60)

        def kill_one_half_way(done, total):
            if done >= total / 2 and not killed:
                worker, pid = next(iter(client.run(os.getpid).items()))
                killed.append(worker)
                os.kill(pid, signal.SIGKILL)

        there = sweep(
            bogie, RECONSTRUCTED, axes, "averaging", client.get_executor(), kill_one_half_way
        )
    assert killed
    assert_identical(there, here)


# ---------------------------------------------------------------- figures


@pytest.mark.parametrize("number", NUMBERS[1:])
def test_a_figure_is_a_curve_for_each_of_five_stiffnesses(number):
    shown = figure(number, method="averaging", points=5)
    (stiffness, Ky), (name, x) = shown.sweep.axes.items()
    field = next(f for f in Parameters.fields() if f.figure == number)
    assert stiffness == "Ky"
    assert Ky[2] == RECONSTRUCTED.Ky
    assert len(Ky) == len(KY_FACTORS) == 5
    assert name == field.name
    np.testing.assert_allclose(x[[0, -1]], field.span)
    assert shown.title == f"Fig. {number}: {field.label}"
    middle = critical_speeds(bogie(RECONSTRUCTED.replace(**{name: x})), "averaging")
    np.testing.assert_allclose(shown.sweep.linear[2], middle.linear, rtol=1e-10)


def test_a_parameter_best_compared_by_its_logarithm_is_drawn_that_way():
    ratios = np.diff(np.log(figure(10, method="averaging", points=5).sweep.axes["Kpsi"]))
    np.testing.assert_allclose(ratios, ratios[0])


def test_figures_start_from_the_design_at_hand():
    design = RECONSTRUCTED.replace(Ky=2e5, C1=2.5e4)
    shown = figure(4, design, wheelset, "averaging", points=3)
    p = design.replace(m_w=shown.sweep.axes["m_w"][1])
    alone = critical_speeds(wheelset(p), "averaging")
    assert shown.sweep.nonlinear[2, 1] == pytest.approx(alone.nonlinear, rel=1e-10)


def test_figure_3_is_wheelset_and_bogie():
    shown = figure(3)
    assert list(shown.branches) == ["wheelset", "bogie"]
    for vehicle in (wheelset, bogie):
        branch = limit_cycles(vehicle(RECONSTRUCTED))
        np.testing.assert_array_equal(shown.branches[vehicle.__name__].speed, branch.speed)
    rows = [line for line in shown.csv().splitlines() if not line.startswith("#")]
    assert len(rows) == 1 + sum(len(branch.speed) for branch in shown.branches.values())
    assert rows[0] == "vehicle,forward speed V [km/h],amplitude [mm],frequency [Hz],stable"


@pytest.mark.parametrize("number", [2, 15, "4"])
def test_there_is_no_other_figure(number):
    with pytest.raises(ValueError, match="number must be one of 3 to 14"):
        figure(number)


# ---------------------------------------------------------------- claims


@pytest.fixture(scope="module")
def judged():
    return claims()


def test_most_of_what_the_paper_says_holds(judged):
    assert sum(claim.holds for claim in judged) >= 0.7 * len(judged)
    assert {claim.figure for claim in judged} == {None, *NUMBERS}


def verdict_on(judged, number, word):
    (claim,) = [c for c in judged if c.figure == number and word in c.statement]
    return claim


@pytest.mark.parametrize(
    ("number", "words", "holds"),
    [
        (3, "linear speed is 155", True),
        (3, "nonlinear speed is 144", True),
        (4, "the nonlinear", True),
        (6, "lowers the linear", False),
        (6, "raises the nonlinear", True),
        (6, "narrows", True),
        (8, "the linear", True),
        (11, "nonlinear", False),
        (12, "nonlinear", True),
        (13, "lowers the nonlinear", True),
        (14, "raises the linear", False),
    ],
)
def test_verdicts_are_those_known_of_the_model(judged, number, words, holds):
    assert verdict_on(judged, number, words).holds == holds


def test_a_verdict_gives_figures(judged):
    for claim in judged:
        assert any(character.isdigit() for character in claim.verdict), claim
    assert str(judged[0]).startswith("Fig. 3: the wheelset's linear speed is 155 km/h")
    assert "156.5 and 149.4 km/h" in str(judged[0])


def test_verdicts_come_from_the_curves(judged):
    """Turned upside down, the curves of Fig. 4 are judged the other way."""
    shown = figure(4, points=5)
    upside_down = dataclasses.replace(shown.sweep, linear=shown.sweep.linear[:, ::-1])
    turned = dataclasses.replace(shown, sweep=upside_down)
    known = {n: figure(n, method="averaging", points=3) for n in NUMBERS} | {4: turned}
    assert not verdict_on(claims(known), 4, "the linear").holds
    assert verdict_on(judged, 4, "the linear").holds


def test_claims_are_judged_where_nothing_hunts_too():
    judged = claims(parameters=TABLE_1, method="averaging", points=5)
    assert not judged[0].holds
    assert "no Hopf point in range" in judged[0].verdict


X = np.linspace(1.0, 2.0, 21)
FIELD = Parameters.fields()[0]


def curves(*functions):
    return Curves(X, np.array([f(X) for f in functions]), FIELD)


def test_what_rises_goes_up_and_nothing_else_does():
    assert goes(curves(lambda x: x, lambda x: x**2), up=True)[0]
    assert not goes(curves(lambda x: x, lambda x: 3 - x), up=True)[0]
    assert not goes(curves(lambda x: 1 + 0.001 * x), up=True)[0]
    assert not goes(curves(lambda x: x + 0.4 * np.sin(9 * x)), up=True)[0]
    assert goes(curves(lambda x: -x + 3), up=False)[0]


def test_what_changes_by_half_a_percent_stays():
    assert stays(curves(lambda x: 100 + 0.5 * x))[0]
    assert not stays(curves(lambda x: 100 + 5 * x))[0]


def test_flattening_is_falling_ever_less():
    assert falls_and_flattens(curves(lambda x: 1 / x**3))[0]
    assert not falls_and_flattens(curves(lambda x: 9 - x**3))[0]
    assert not falls_and_flattens(curves(lambda x: x))[0]


def test_curves_that_agree_in_direction_follow_a_rule():
    assert not follows_no_rule(curves(lambda x: x, lambda x: x**2))[0]
    assert not follows_no_rule(curves(lambda x: -x + 3, lambda x: 1 / x))[0]
    assert follows_no_rule(curves(lambda x: x, lambda x: 1 / x))[0]


def test_a_peak_is_where_the_paper_puts_it_or_not():
    parabola = curves(lambda x: 2 - (x - 1.5) ** 2)
    assert turns_down(parabola, at=1.45)[0]
    assert not turns_down(parabola, at=1.2)[0]
    assert not turns_down(curves(lambda x: x), at=1.9)[0]
    assert "at 1.5 kg" in turns_down(parabola, at=1.2)[1]


def test_gaps_are_left_out_of_a_verdict():
    V = np.array([np.where(X > 1.8, np.nan, X)])
    assert goes(Curves(X, V, FIELD), up=True)[0]
