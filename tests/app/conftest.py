"""The Explore page in a browser: opened, and looked at the way a person does."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

IDLE = "() => window.Bokeh?.documents?.length && Bokeh.documents[0].is_idle"
SETTLED_MS = 150


class Dashboard:
    """A page with the dashboard on it."""

    def __init__(self, page, url):
        self.page = page
        self.url = url

    def open(self, search="", hints=False):
        if not hints:
            self.page.add_init_script("localStorage.setItem('hunting-hints', 'seen')")
        self.page.goto(f"{self.url}{search}")
        self.page.wait_for_function(IDLE)
        if "page=" not in search:
            self.page.locator(".card.stability canvas").first.wait_for(state="attached")
        self.page.wait_for_function(IDLE)
        self.page.get_by_text(re.compile("☀ Light|☾ Dark")).wait_for()
        return self

    def slider(self, name):
        return self.page.locator(f"input[type=range][data-name={name}]")

    def box(self, name):
        return self.page.locator(f"input[type=text][data-name={name}]")

    def row(self, name):
        return self.page.locator(f"[data-row={name}]")

    def refusal(self, name):
        return self.row(name).locator(".refusal")

    def type(self, name, text):
        self.box(name).fill(text)
        self.box(name).press("Enter")
        self.settle()

    def choose(self, label):
        self.page.get_by_text(label, exact=True).first.click()
        self.settle()

    def press(self, label):
        """Press a button by its beginning: ``"Undo"``, ``"Pin as baseline"``."""
        self.page.get_by_role("button", name=re.compile(rf"^\W*{label}")).first.click()
        self.settle()

    def key(self, keys):
        self.page.keyboard.press(keys)
        self.settle()

    def settle(self):
        """Wait until nothing is under way any more, the address bar included."""
        self.page.wait_for_timeout(SETTLED_MS)
        busy = self.page.locator("[data-busy=yes]")
        expect(busy).to_have_count(0, timeout=30_000)

    def answer(self, name, vehicle="bogie"):
        """The number shown for, say, ``"linear critical speed"``; None where it says none."""
        cell = self.page.locator(f"section.{vehicle} [data-answer='{name}'] dd")
        found = re.match(r"-?[\d.]+", cell.inner_text())
        return float(found[0]) if found else None

    def change(self, name, vehicle="bogie"):
        """The change against the baseline as it is shown, such as ``"+4.2 km/h"``."""
        change = self.page.locator(f"section.{vehicle} [data-answer='{name}'] .change")
        return change.inner_text() if change.count() else None

    def value(self, name):
        return float(self.box(name).input_value().replace(",", "").replace("−", "-"))

    def said(self):
        """The sentence under the diagram."""
        return self.page.locator(".bifurcation p").first.inner_text()

    def count(self, script):
        return self.page.evaluate(script)

    def models(self):
        return self.page.evaluate("() => Bokeh.documents[0]._all_models.size")

    def canvases_painted(self):
        """How many plots show more than one colour."""
        return self.page.evaluate(
            """() => {
              const all = function* (root) {
                for (const node of root.querySelectorAll("*")) {
                  if (node.tagName === "CANVAS") yield node;
                  if (node.shadowRoot) yield* all(node.shadowRoot);
                }
              };
              const painted = (canvas) => {
                const { width, height } = canvas;
                const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
                const first = data.slice(0, 4).join();
                for (let i = 4; i < data.length; i += 4) {
                  if (data.slice(i, i + 4).join() !== first) return true;
                }
                return false;
              };
              const plots = [...all(document)].filter((c) => c.width > 200 && c.height > 90);
              return plots.filter(painted).length;
            }"""
        )


@pytest.fixture
def open_dashboard(served, new_page):
    """Open the served dashboard; options as for `new_page`."""

    opened = []

    def open_it(search="", url=None, **options):
        opened.append(Dashboard(new_page(**options), url or f"{served.url}/"))
        return opened[-1].open(search)

    yield open_it
    for dashboard in opened:  # a page closed in the middle of an update leaves a complaint
        dashboard.settle()


@pytest.fixture
def dashboard(open_dashboard):
    """The dashboard as a first visitor sees it."""
    return open_dashboard()
