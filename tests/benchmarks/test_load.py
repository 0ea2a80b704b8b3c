"""Many visitors on one process: ``make load``."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

from hunting import RECONSTRUCTED, bogie, critical_speeds

HERE = Path(__file__).parent
VISITORS = 50
MB = 2**20
MODELS = "() => Bokeh.documents[0]._all_models.size"


def memory(server):
    """Resident memory of the process that serves the pages [MB]."""
    return psutil.Process(server.pid).memory_info().rss / MB


def visit(url, count, bursts):
    command = [sys.executable, str(HERE / "visitors.py"), url, str(count), str(bursts)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def ended(visitors):
    out, errors = visitors.communicate(timeout=400)
    assert visitors.returncode == 0, errors
    return json.loads(out)


def percentiles(visitors):
    return np.percentile([1e3 * w for one in visitors for w in one["waits"]], [50, 95, 100])


@pytest.fixture
def server(serve):
    started = serve(
        "--index", "app", "--unused-session-lifetime", "1000", "--check-unused-sessions", "500"
    )
    yield started
    started.stop()


def check(visitors):
    assert not any(one["gone"] for one in visitors)
    assert all(len(one["waits"]) == len(visitors[0]["waits"]) for one in visitors)
    for one in visitors:
        speeds = critical_speeds(bogie(RECONSTRUCTED.replace(Ky=one["Ky"])))
        right = [f"{3.6 * V:.1f}" for V in (float(speeds.nonlinear), float(speeds.linear))]
        assert one["shown"] == right, one["Ky"]


def test_fifty_visitors_are_answered_and_none_waits_behind_a_study(server, new_page, report):
    ended(visit(server.url, 2, 1))  # everything imported
    before = memory(server)
    visitors = visit(server.url, VISITORS, 2)
    visitors.stderr.readline()
    each = (memory(server) - before) / VISITORS
    alone = ended(visitors)
    page = new_page()
    page.goto(server.url)
    page.get_by_role("button", name="Study", exact=True).click()
    page.get_by_role("button", name="Map").click()
    start = page.get_by_role("button", name="Compute", exact=False).locator("visible=true").first
    beside = visit(server.url, VISITORS, 2)
    beside.stderr.readline()
    start.click()
    page.wait_for_timeout(2000)
    beside = ended(beside)
    check(alone)
    check(beside)
    (p50, p95, worst), (q50, q95, slowest) = percentiles(alone), percentiles(beside)
    report(
        f"{VISITORS} visitors on one process, {each:.1f} MB each: a move is answered in {p50:.0f} "
        f"ms (median), {p95:.0f} ms (95th percentile), {worst:.0f} ms (longest); beside a Study "
        f"run {q50:.0f}, {q95:.0f} and {slowest:.0f} ms"
    )


def test_two_hundred_visitors_come_and_go_and_leave_nothing(server, report):
    sizes = []
    for _ in range(6):
        ended(visit(server.url, 40, 0))
        time.sleep(4)
        gc.collect()
        sizes.append(memory(server))
    grown = sizes[-1] - sizes[1]
    report(
        "resident memory after each 40 visitors that came and went: "
        + ", ".join(f"{size:.0f}" for size in sizes)
        + f" MB; {1e3 * grown / 160:.0f} kB a visitor"
    )
    assert grown < 0.5 * 160  # a tenth of what one takes


def test_a_thousand_moves_leave_nothing_behind(server, new_page, report):
    page = new_page()
    page.goto(f"{server.url}/?baseline=reconstructed")
    page.locator(".card.stability canvas").first.wait_for(state="attached")
    page.wait_for_timeout(2000)
    cdp = page.context.new_cdp_session(page)

    def state():
        page.wait_for_timeout(2000)
        cdp.send("HeapProfiler.collectGarbage")
        found = {m["name"]: m["value"] for m in cdp.send("Performance.getMetrics")["metrics"]}
        return found["JSHeapUsedSize"] / MB, found["Nodes"], page.evaluate(MODELS), memory(server)

    cdp.send("Performance.enable")
    slider = page.locator("input[type=range][data-name=Ky]")
    states = []
    for k in range(11):
        if k:
            slider.evaluate(
                """async (slider, k) => {
                  for (let i = 0; i < 100; i += 1) {
                    slider.value = 100 + ((37 * i + k) % 200);
                    slider.dispatchEvent(new Event("input"));
                    await new Promise((resolve) => setTimeout(resolve, 60));
                  }
                }""",
                k,
            )
        states.append(state())
    heap, nodes, models, size = (np.array(column) for column in zip(*states, strict=True))
    report(
        f"1,000 moves: heap {heap[1]:.1f} MB after 100, {heap[-1]:.1f} MB at the end; DOM nodes "
        f"{nodes[1]:.0f}, {nodes[-1]:.0f}; models {models[1]}, {models[-1]}; server memory "
        f"{size[1]:.0f}, {size[-1]:.0f} MB"
    )
    assert heap[-1] <= 1.1 * heap[1]
    assert nodes[-1] <= 1.02 * nodes[1] + 20
    assert models[-1] == models[1]
    assert size[-1] <= size[1] + 10
