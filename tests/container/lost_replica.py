"""The loss of a replica while many visitors drag: minutes of browsers' work.

Reached by naming it: VISITORS=30 pytest -s tests/container/lost_replica.py
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from tests.container.conftest import Demo
from tests.container.test_demo import ANSWERED

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

Start = Callable[..., Demo]
Proxy = Callable[..., str]

# Drags a slider to and fro, twenty moves a second.
DRAG = """(n) => {
    const slider = (root) => {
        const own = root.querySelector("input[type=range][data-name=Ky]");
        if (own) return own;
        const roots = [...root.querySelectorAll("*")].map((e) => e.shadowRoot).filter(Boolean);
        return roots.map(slider).find(Boolean);
    };
    const input = slider(document);
    let at = n;
    setInterval(() => {
        at = (at + 7) % 400;
        input.value = at;
        input.dispatchEvent(new Event("input"));
    }, 50);
}"""
VISITORS = int(os.environ.get("VISITORS", "30"))


def entered(page: Page, url: str) -> None:
    """Open the page as a visitor does: a page that says "wait" comes again by itself."""
    page.goto(url, wait_until="commit")
    page.locator("input[type=range][data-name=Ky]").wait_for(timeout=120_000, state="attached")


def test_the_loss_of_a_replica_ends_nobodys_visit(
    demo: Start, proxy: Proxy, chromium: Browser
) -> None:
    replicas = [demo(), demo()]
    url = proxy(*replicas)
    pages = [chromium.new_context().new_page() for _ in range(VISITORS)]
    for number, page in enumerate(pages):
        entered(page, f"{url}/?Cy={1000 + number}")
        page.evaluate("window.first = true")
    for number, page in enumerate(pages):
        page.evaluate(DRAG, 10 * number)
    time.sleep(3)
    replicas[0].stop(signal.SIGKILL)
    time.sleep(1)
    entered(newcomer := chromium.new_context().new_page(), url)
    # Who lost the connection comes back by itself, to the same address; the others just go on.
    stayed = came_back = 0
    for number, page in enumerate(pages):
        answered = page.evaluate(f"window.first ? ({ANSWERED})() : null")
        if answered is not None and "was lost" not in page.locator("body").inner_text():
            page.wait_for_function(f"({ANSWERED})() > {answered}", timeout=30_000)
            stayed += 1
            continue
        page.wait_for_function("!window.first", timeout=120_000)
        page.locator("input[type=range][data-name=Ky]").wait_for(timeout=120_000, state="attached")
        assert f"Cy={1000 + number}" in page.url
        box = page.locator("input[type=text][data-name=Cy]")
        assert box.input_value().replace(",", "") == str(1000 + number)
        came_back += 1
    print(f"{stayed} stayed, {came_back} came back")
    assert stayed > 0
    assert came_back > 0
    for page in (*pages, newcomer):
        page.context.close()
