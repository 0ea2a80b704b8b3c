"""Settings, limits, log and end of the web demo."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING
from urllib.parse import quote

import pytest

from tests.container.conftest import DEPLOY, Demo, ask, command

if TYPE_CHECKING:
    from playwright.sync_api import Page

    from tests.conftest import NewPage

Start = Callable[..., Demo]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("PORT", "http"),
        ("PORT", "70000"),
        ("PREFIX", "hunting"),
        ("PREFIX", "/a b"),
        ("ALLOWED_ORIGINS", "*"),
        ("ALLOWED_ORIGINS", "demo.example.org"),
        ("SESSION_LIMIT", "0"),
        ("SESSION_LIMIT", "many"),
    ],
)
def test_a_setting_that_makes_no_sense_is_refused_by_name(name: str, value: str) -> None:
    arguments, environment = command(**{name: value})
    ended = subprocess.run(arguments, env=environment, capture_output=True, text=True, cwd=DEPLOY)
    assert ended.returncode == 1
    (line,) = ended.stderr.splitlines()
    assert line.startswith(f"error: {name} must be")
    assert repr(value) in line


# How many moves of sliders the server has answered with new data.
ANSWERED = """() => [...Bokeh.documents[0]._all_models.values()]
    .find((model) => model.class_name === "Sidebar").data.answered"""


def slider(page: Page, name: str = "Ky") -> None:
    """Move a slider with the arrow keys, and wait until the address bar has its value."""
    handle = page.locator(f"input[type=range][data-name={name}]")
    handle.focus()
    for _ in range(20):
        handle.press("ArrowRight")
    page.wait_for_url(f"**{name}=*", timeout=15_000)


def opened(page: Page, url: str) -> Page:
    page.goto(url)
    page.locator("input[type=range][data-name=Ky]").wait_for(timeout=30_000)
    return page


def test_who_comes_over_the_limit_reads_why_and_those_inside_go_on(
    demo: Start, new_page: NewPage
) -> None:
    served = demo(SESSION_LIMIT="1")
    inside = opened(new_page(), served.url)
    code, text = ask(f"{served.url}/?Ky=1e5")
    assert code == 503
    assert "All 1 places of this demo are taken" in text
    assert 'http-equiv="refresh"' in text
    before = inside.evaluate(ANSWERED)
    slider(inside)
    assert inside.evaluate(ANSWERED) > before
    inside.goto("about:blank")
    for _ in range(30):
        if ask(served.url)[0] == 200:
            return
        time.sleep(1)
    pytest.fail("the place of one who left was not given to another")


def test_the_log_has_a_line_an_event_and_nothing_of_the_visitor(
    demo: Start, new_page: NewPage
) -> None:
    served = demo()
    page = opened(new_page(user_agent="telltale-browser"), f"{served.url}/?Ky=123456&vehicle=tram7")
    slider(page, "Cy")
    page.goto("about:blank")
    time.sleep(8)
    assert served.stop() == 0
    lines = served.logged().splitlines()
    assert all(re.match(r"\d{4}-\d\d-\d\dT[\d:.]+Z (info|warning|error) ", line) for line in lines)
    events = [line.split(" ", 2)[2].split(",")[0] for line in lines]
    # A visitor may leave in the middle of a message.
    assert [event for event in events if not event.startswith("trouble in asyncio")] == [
        f"serving at port {served.port}",
        "session opened",
        "session closed",
        "stopped",
    ]
    assert not re.search("telltale|123456|tram7|127.0.0.1", served.logged())


def test_scripts_in_a_link_are_shown_but_never_run(demo: Start, new_page: NewPage) -> None:
    served = demo()
    attack = "<img src=x onerror='window.hacked=1'><script>window.hacked=1</script>"
    query = f"?Ky={quote(attack)}&vehicle={quote(attack)}&{quote(attack)}=1"
    page = opened(new_page(), f"{served.url}/{query}")
    page.get_by_text("onerror").first.wait_for()
    assert page.evaluate("window.hacked") is None


def test_hostile_input_leaves_it_standing(demo: Start) -> None:
    served = demo()
    script = [sys.executable, str(DEPLOY / "hostile.py"), served.url]
    ended = subprocess.run(
        [*script, "--pid", str(served.process.pid)], capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr + served.logged()
    assert served.stop() == 0
