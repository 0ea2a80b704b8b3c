"""The web demo behind nginx: prefixes, and the loss of a replica."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.conftest import free_port
from tests.container.conftest import DEPLOY, Demo, ask
from tests.container.test_demo import ANSWERED, opened, slider

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from tests.conftest import NewPage

pytestmark = pytest.mark.skipif(
    shutil.which("nginx") is None, reason="nginx is not installed (Debian: nginx-light)"
)
Start = Callable[..., Demo]
Proxy = Callable[..., str]


@pytest.fixture
def proxy(tmp_path: Path) -> Iterator[Proxy]:
    """Start nginx with the project's own configuration before some demos; returns its address."""
    running: list[subprocess.Popen[bytes]] = []

    def start(*demos: Demo) -> str:
        port = free_port()
        text = (DEPLOY / "nginx.conf").read_text()
        (replica,) = re.findall(r"^ *server demo:5006(.*);$", text, flags=re.MULTILINE)
        replicas = "".join(f"server 127.0.0.1:{demo.port}{replica};\n" for demo in demos)
        text = text.replace(f"server demo:5006{replica};\n", replicas)
        text = text.replace("listen 8080;", f"listen 127.0.0.1:{port};")
        text = text.replace("/tmp/", f"{tmp_path}/")
        text = text.replace("worker_processes auto;", "worker_processes 1;")
        (tmp_path / "nginx.conf").write_text(text)
        command = ["nginx", "-c", str(tmp_path / "nginx.conf"), "-g", "daemon off;"]
        with (tmp_path / "nginx.log").open("wb") as log:
            running.append(subprocess.Popen(command, stderr=log))
        url = f"http://127.0.0.1:{port}"
        for _ in range(50):
            try:
                ask(f"{url}/liveness")
            except OSError:
                time.sleep(0.1)
        return url

    yield start
    for process in running:
        process.terminate()
        process.wait(timeout=10)


@pytest.mark.parametrize(("prefix", "path"), [("/hunting", "/hunting/"), ("", "/demo/"), ("", "/")])
def test_page_websocket_and_link_work_behind_a_prefix(
    prefix: str, path: str, demo: Start, proxy: Proxy, new_page: NewPage
) -> None:
    served = demo(PREFIX=prefix)
    url = proxy(served)
    page = opened(new_page(), f"{url}{path}?vehicle=both")
    slider(page)
    assert page.url.startswith(f"{url}{path}?")
    link = page.url
    (Ky,) = re.findall(r"Ky=(\d+)", link)
    again = opened(new_page(), link)
    assert again.locator("input[type=text][data-name=Ky]").input_value() == f"{int(Ky):,}"
    assert again.locator("input[value=both]").is_checked()


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
VISITORS = 30


def entered(page: Page, url: str) -> None:
    """Open the page as a visitor does: a page that says "wait" comes again by itself."""
    page.goto(url, wait_until="commit")
    page.locator("input[type=range][data-name=Ky]").wait_for(timeout=120_000, state="attached")


@pytest.mark.slow
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
        answered = page.evaluate(f"window.first ? ({ANSWERED})() : null") if number >= 0 else None
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
