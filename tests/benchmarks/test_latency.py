"""From a slider's move to the painted picture, beside a bare Bokeh page in the same run."""

from __future__ import annotations

import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
WATCH = (HERE / "latency.js").read_text(encoding="utf-8")
PLOTS = 5
IDLE = "() => window.Bokeh?.documents?.length && Bokeh.documents[0].is_idle && painted.last > 0"


@pytest.fixture(scope="module")
def yardsticks(tmp_path_factory):
    """Serve a page of this folder; return its address."""
    processes = []

    def start(script, tool):
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            port = listener.getsockname()[1]
        command = [sys.executable, "-m", tool, "serve", str(HERE / script)]
        command += [
            "--address",
            "127.0.0.1",
            "--port",
            str(port),
            "--allow-websocket-origin",
            f"127.0.0.1:{port}",
        ]
        log = (tmp_path_factory.mktemp("yardstick") / "log").open("wb")
        processes.append(subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT))
        return f"http://127.0.0.1:{port}/{Path(script).stem}"

    yield start
    for process in processes:
        process.terminate()
        process.wait(timeout=10)


def opened(new_page, url, kind):
    page = new_page()
    page.add_init_script(WATCH)
    for attempt in range(100):
        try:
            page.goto(url)
            break
        except Exception:
            if attempt == 99:
                raise
            page.wait_for_timeout(200)
    page.wait_for_function(IDLE)
    page.wait_for_timeout(1000)
    page.evaluate("([kind, plots]) => prepare(kind, plots)", [kind, PLOTS])
    return page


def move(page, name, position):
    return page.evaluate("([n, p, k]) => timedMove(n, p, k)", [name, position, PLOTS])


@pytest.mark.parametrize("query", ["", "?vehicle=both"], ids=["bogie", "both"])
def test_a_move_is_painted_in_one_and_a_half_times_what_a_bare_page_takes(
    served, new_page, yardsticks, report, query
):
    ours = opened(new_page, served.url + query, "ours")
    bare = opened(new_page, yardsticks("bare_bokeh.py", "bokeh"), "bare")
    assert ours.evaluate("sliders") == bare.evaluate("sliders") == 23
    mine, yardstick = [], []
    for k in range(66):
        mine.append(move(ours, "Ky", 120 + 2 * k))
        yardstick.append(move(bare, "p3", 120 + 2 * k))
    (m50, m95), (y50, y95) = (np.percentile(times[6:], (50, 95)) for times in (mine, yardstick))
    report(
        f"slider to paint{query}: median {m50:.0f} ms, 95 % {m95:.0f} ms; "
        f"bare Bokeh page {y50:.0f} and {y95:.0f} ms: {m50 / y50:.2f} times (at most 1.5)"
    )
    assert m50 <= 1.5 * y50


def test_the_final_picture_follows_a_long_drag_within_300_ms(served, new_page, report):
    page = opened(new_page, served.url, "ours")
    tails = []
    for turn in range(3):
        tails.append(
            page.evaluate("([a, b]) => drag('Ky', a, b)", [[100, 300], [300, 100]][turn % 2])
        )
        box = page.locator("input[type=range][data-name=Ky]").input_value()
        assert int(box) == [300, 100][turn % 2]
    report(
        f"after a 2 s drag at 60 events/s the last picture comes after {np.median(tails):.0f} ms"
    )
    assert np.median(tails) <= 300
