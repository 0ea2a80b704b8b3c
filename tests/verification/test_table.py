"""The table of `make verify`: a line fails when it must, and what is left out is said."""

from __future__ import annotations

import numpy as np
import pytest

from verification import __main__ as runner
from verification import auto_07p
from verification.cycles import dominant
from verification.row import Row, worst


def test_a_difference_is_relative_to_the_yardstick_unless_said_otherwise():
    assert Row("speed", 101.0, 100.0, allowed=0.02).difference == pytest.approx(0.01)
    assert Row("count", 101.0, 100.0, allowed=0.0, absolute=True).difference == 1.0


@pytest.mark.parametrize(("ours", "passes"), [(100.0, True), (102.0, False), (np.nan, False)])
def test_a_line_passes_within_what_is_allowed_and_never_without_an_answer(ours, passes):
    assert Row("speed", ours, 100.0, allowed=0.01).passes is passes


def test_the_worst_line_of_a_group_stands_for_it():
    good, close, none = (Row("speed", ours, 100.0, 0.01) for ours in (100.1, 100.5, np.nan))
    assert worst([good, close]) is close
    assert worst([close, none, good]) is none


def test_the_trivial_multiplier_is_left_out():
    assert dominant(np.array([0.5, 1.0000001, -0.8j])) == pytest.approx(0.8)


@pytest.fixture
def table(monkeypatch, tmp_path):
    """Return a function that runs the table of given lines and returns exit code and page."""

    def run(*rows, missing=""):
        monkeypatch.setattr(runner, "YARDSTICKS", {"AUTO-07p": lambda: iter(rows)})
        monkeypatch.setattr(runner, "PAGE", tmp_path / "docs" / "verification.md")
        monkeypatch.setattr(auto_07p, "missing", lambda: missing)
        code = runner.main()
        page = runner.PAGE
        return code, page.read_text(encoding="utf-8") if page.exists() else None

    return run


def test_a_failing_line_fails_the_run(table):
    good, bad = Row("|multiplier|", 1.0, 1.0, 1e-9), Row("speed [km/h]", 1.0, 2.0, 1e-9)
    assert table(good)[0] == 0
    code, page = table(good, bad)
    assert code == 1
    assert "1 of 2 lines agree" in page
    assert "| speed [km/h] | 1 | 2 | 5.0e-01 | 1e-09 | FAILS |" in page


def test_a_missing_yardstick_is_said_in_one_line_and_leaves_the_page_alone(table, capsys):
    code, page = table(missing="AUTO-07p is not at /nowhere")
    said = [line for line in capsys.readouterr().out.splitlines() if "left out" in line]
    assert code == 0
    assert page is None
    assert said[0].strip() == "left out: AUTO-07p is not at /nowhere"
