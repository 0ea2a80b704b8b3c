"""What all tests share: hypothesis profiles, a Chromium, and servers of the dashboard."""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol
from urllib.parse import urlsplit

import hypothesis
import pytest
from find_chromium import find_chromium, obstacle

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator

    from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, Request

ROOT = Path(__file__).parent.parent
IN_CI = os.environ.get("CI") == "true"
CHROMIUM_FLAGS = [
    "--no-sandbox",  # Chromium's own does not start for root or in most containers
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]

hypothesis.settings.register_profile("dev", deadline=None)
hypothesis.settings.register_profile("ci", deadline=None, derandomize=True, database=None)
hypothesis.settings.load_profile("ci" if IN_CI else "dev")


# ---------------------------------------------------------------- notebooks

STARTUP = """import warnings
warnings.simplefilter("error")
"""


def pytest_sessionstart(session: pytest.Session) -> None:
    """Make a warning in a notebook an error, as it is in every test."""
    folder = Path(tempfile.mkdtemp(prefix="ipython-"))
    session.config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))
    startup = folder / "profile_default" / "startup"
    startup.mkdir(parents=True)
    (startup / "00-strict.py").write_text(STARTUP)
    os.environ["IPYTHONDIR"] = str(folder)


# ---------------------------------------------------------------- browser tests

FAILED = pytest.StashKey[bool]()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whatever uses the browser is a browser test, marked or not."""
    for item in items:
        if "chromium" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.browser)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Make skipped browser tests failures under CI, and one line of the summary elsewhere."""
    report = yield
    is_skip = report.skipped and not hasattr(report, "wasxfail")
    if is_skip and item.get_closest_marker("browser") and isinstance(report.longrepr, tuple):
        *_, reason = report.longrepr
        if IN_CI:
            report.outcome = "failed"
            report.longrepr = f"CI=true, and a browser test was skipped. {reason}"
        else:
            report.longrepr = (__file__, 1, reason)
    item.stash[FAILED] = report.failed or item.stash.get(FAILED, False)
    return report


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """A headless Chromium; the tests that need one are skipped where there is none."""
    if reason := obstacle():
        pytest.skip(reason)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=CHROMIUM_FLAGS)
        yield browser
        browser.close()


class NewPage(Protocol):
    """Opens a page in a context of its own; options as for ``Browser.new_context``."""

    def __call__(self, **options: Any) -> Page: ...


@pytest.fixture
def new_page(chromium: Browser, request: pytest.FixtureRequest) -> Iterator[NewPage]:
    """A factory of pages that fail the test on a JavaScript error or a request to another machine.

    Of a failed test each page leaves a picture in test-results/.
    """
    contexts: list[BrowserContext] = []
    complaints: list[str] = []

    def on_console(message: ConsoleMessage) -> None:
        url = message.location["url"]
        # Behind --prefix Bokeh does not find the icon of the browser's tab.
        if message.type == "error" and not url.endswith("/favicon.ico"):
            complaints.append(f"console error: {message.text} {url}".rstrip())

    def on_request(sent: Request) -> None:
        if urlsplit(sent.url).hostname not in {"127.0.0.1", "localhost", None, ""}:
            complaints.append(f"request to another machine: {sent.url}")

    def open_page(**options: Any) -> Page:
        context = chromium.new_context(**{"viewport": {"width": 1440, "height": 900}, **options})
        contexts.append(context)
        page = context.new_page()
        page.on("console", on_console)
        page.on("pageerror", lambda error: complaints.append(f"page error: {error}"))
        page.on("request", on_request)
        return page

    yield open_page
    pages = [page for context in contexts for page in context.pages]
    if request.node.stash.get(FAILED, False):
        for number, page in enumerate(pages):
            name = re.sub(r"\W+", "-", request.node.name)
            page.screenshot(path=ROOT / "test-results" / f"{name}-{number}.png")
    for context in contexts:
        context.close()
    assert not complaints, "\n".join(complaints)


@pytest.fixture
def page(new_page: NewPage) -> Page:
    """One page of 1440 x 900 pixels."""
    return new_page()


# ---------------------------------------------------------------- the dashboard, served

TROUBLE = re.compile(r"Traceback \(most recent call last\)|RuntimeWarning|\bE-\d{4} \(")
LEFT = re.compile(
    r"Task exception was never retrieved\nfuture: [^\n]*exception=WebSocketClosedError\(\)>\n"
    r"Traceback (?:.*\n)*?tornado\.websocket\.WebSocketClosedError\n",
)  # Panel forgets what it was still sending when a page is closed
START_SECONDS = 90


@dataclass
class Server:
    """A running ``panel serve app``."""

    url: str
    log: Path
    process: subprocess.Popen[bytes] = field(repr=False)
    looked_at: int = field(default=0, repr=False)
    stopped_at: int | None = field(default=None, repr=False)

    @property
    def pid(self) -> int:
        return self.process.pid

    def logged(self) -> str:
        return self.log.read_text(errors="replace")

    def trouble(self) -> str:
        """What was logged since the last call, if a traceback or the like is in it."""
        new = self.logged()[self.looked_at : self.stopped_at]
        self.looked_at += len(new)
        return new if TROUBLE.search(LEFT.sub("", new)) else ""

    def wait_until_it_answers(self) -> None:
        deadline = time.monotonic() + START_SECONDS
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                urllib.request.urlopen(f"{self.url}/liveness", timeout=5).close()
            except urllib.error.HTTPError:  # answered, if only to say no
                return
            except OSError:
                time.sleep(0.1)
            else:
                return
        pytest.fail(f"the server did not start:\n{self.logged()}")

    def stop(self) -> None:
        """End the server with the worker processes that ``--num-procs`` gave it.

        What it logs from here on is not looked at: Bokeh fails to close a websocket whose session
        is not there yet.
        """
        self.stopped_at = len(self.logged())
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGTERM)
            try:
                self.process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.wait()


def free_port() -> int:
    """A port nothing listens on."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        port: int = listener.getsockname()[1]
        return port


SERVERS = pytest.StashKey[list[Server]]()


@pytest.fixture(scope="session")
def serve(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Callable[..., Server]]:
    """Start ``panel serve app`` with further arguments, say ``serve("--prefix", "/x")``.

    It listens on a free port and lives until the session ends, or the test calls its `stop`.
    """
    servers = request.config.stash.setdefault(SERVERS, [])

    def start(*arguments: str) -> Server:
        port = free_port()
        command = [sys.executable, "-m", "panel", "serve", str(ROOT / "app"), *arguments]
        command += ["--address", "127.0.0.1", "--port", str(port), "--liveness"]
        for host in ("127.0.0.1", "localhost"):
            command += ["--allow-websocket-origin", f"{host}:{port}"]
        log = tmp_path_factory.mktemp("serve") / "server.log"
        with log.open("wb") as output:
            process = subprocess.Popen(
                command,
                cwd=ROOT,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        server = Server(f"http://127.0.0.1:{port}", log, process)
        servers.append(server)
        server.wait_until_it_answers()
        return server

    yield start
    for server in servers:
        server.stop()


@pytest.fixture(scope="session")
def served(serve: Callable[..., Server]) -> Server:
    """One server of the dashboard for all the tests that need nothing special of it."""
    return serve("--index", "app")


@pytest.fixture(autouse=True)
def _servers_log_no_trouble(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fail the test during which a server logged a traceback."""
    yield
    troubles = [server.trouble() for server in request.config.stash.get(SERVERS, [])]
    assert not any(troubles), "\n".join(filter(None, troubles))
