"""The page in Firefox, driven by WebDriver BiDi: no driver but the browser itself is needed."""

from __future__ import annotations

import asyncio
import json
import shutil
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import count

import pytest
from tornado.websocket import websocket_connect

from tests.conftest import free_port

NAMES = ("firefox-esr", "firefox")
START_SECONDS = 60
IDLE = "Boolean(window.Bokeh?.documents?.length && Bokeh.documents[0].is_idle)"
DEEP = """(selector) => {
  const found = [];
  const look = (root) => {
    found.push(...root.querySelectorAll(selector));
    for (const node of root.querySelectorAll("*")) if (node.shadowRoot) look(node.shadowRoot);
  };
  look(document);
  return found;
}"""


class Firefox:
    """One tab of a headless Firefox."""

    def __init__(self, program, profile):
        # A thread of its own: Playwright's loop may be running in this one.
        self.loop, self.worker = asyncio.new_event_loop(), ThreadPoolExecutor(1)
        self.port = free_port()
        command = [program, "--headless", "--no-remote", "--profile", str(profile)]
        command += ["--remote-debugging-port", str(self.port), "--width", "1440", "--height", "900"]
        self.process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self.numbers = count(1)
        self.errors = []

    def start(self):
        deadline = time.monotonic() + START_SECONDS
        while True:
            try:
                url = f"ws://127.0.0.1:{self.port}/session"
                self.socket = self.run(self._connected(url))
                break
            except OSError:
                assert time.monotonic() < deadline, "Firefox does not listen"
                time.sleep(0.3)
        self.call("session.new", capabilities={})
        self.call("session.subscribe", events=["log.entryAdded"])
        self.tab = self.call("browsingContext.getTree")["contexts"][0]["context"]

    def run(self, awaitable):
        return self.worker.submit(self.loop.run_until_complete, awaitable).result()

    async def _connected(self, url):
        return await websocket_connect(url, max_message_size=2**28)

    async def _write(self, message):
        await self.socket.write_message(message)

    async def _read(self):
        return await asyncio.wait_for(self.socket.read_message(), START_SECONDS)

    def call(self, method, **params):
        number = next(self.numbers)
        message = json.dumps({"id": number, "method": method, "params": params})
        self.run(self._write(message))
        while True:
            answer = json.loads(self.run(self._read()))
            if answer.get("method") == "log.entryAdded" and answer["params"]["level"] == "error":
                self.errors.append(answer["params"]["text"])
            if answer.get("id") == number:
                assert answer["type"] == "success", answer
                return answer["result"]

    def open(self, url):
        self.call("browsingContext.navigate", context=self.tab, url=url, wait="complete")
        self.wait_for(IDLE)

    def evaluate(self, expression):
        found = self.call(
            "script.evaluate",
            expression=f"JSON.stringify({expression})",
            target={"context": self.tab},
            awaitPromise=True,
        )
        assert found["type"] == "success", found
        return json.loads(found["result"].get("value", "null"))

    def wait_for(self, condition, seconds=40):
        deadline = time.monotonic() + seconds
        while not self.evaluate(condition):
            assert time.monotonic() < deadline, condition
            time.sleep(0.1)

    def press(self, *keys):
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.call(
            "input.performActions",
            context=self.tab,
            actions=[{"type": "key", "id": "keyboard", "actions": actions}],
        )

    def close(self):
        self.process.terminate()
        self.process.wait(timeout=20)
        self.worker.shutdown()
        self.loop.close()


@pytest.fixture
def firefox(tmp_path):
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip("no Firefox found: install firefox-esr")
    browser = Firefox(program, tmp_path)
    try:
        browser.start()
        yield browser
    finally:
        browser.close()


def test_sliders_answers_and_plots_work_in_firefox(served, firefox):
    firefox.open(served.url)
    answer = f"({DEEP})('section.bogie [data-answer=\"linear critical speed\"] dd')[0]?.textContent"
    firefox.wait_for(f"Boolean({answer})")
    before = firefox.evaluate(answer)
    assert before.startswith("149.4")
    firefox.wait_for(f"({DEEP})('canvas').length > 7")
    firefox.evaluate(f"({DEEP})('input[type=range][data-name=Ky]')[0].focus()")
    firefox.press(*["\ue014"] * 10)  # arrow right
    firefox.wait_for(f"{answer} !== {json.dumps(before)}")
    firefox.wait_for("location.search.includes('Ky=')")
    painted = """(canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return data.some((value, i) => value !== data[i % 4]);
    }"""
    plots = f"({DEEP})('canvas').filter((c) => c.width > 200 && c.height > 90)"
    assert firefox.evaluate(f"{plots}.filter({painted}).length") >= 5
    wide = "document.documentElement.scrollWidth <= window.innerWidth"
    assert firefox.evaluate(wide)
    assert firefox.errors == []
