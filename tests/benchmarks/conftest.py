"""Timings on one thread, and ratios to a yardstick of the same run in plain words at the end."""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")  # read once, when numpy is loaded

import pytest  # noqa: E402

collect_ignore = ["bare_bokeh.py", "bare_panel.py"]  # served, not tested
FINDINGS = pytest.StashKey[list[str]]()


@pytest.fixture
def report(request):
    """Return a function that adds a line to the end of the run's output."""
    return request.config.stash.setdefault(FINDINGS, []).append


def pytest_terminal_summary(terminalreporter, config):
    if lines := config.stash.get(FINDINGS, []):
        terminalreporter.section("beside their yardsticks")
        for line in lines:
            terminalreporter.line(line)
