"""A real JupyterLab, and its notebooks in a browser, worked the way a person does."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from tests.conftest import ROOT, free_port

START_SECONDS = 120
PATIENCE = 120_000  # ms; a cell imports HoloViews, and the machine may be slow
NOTEBOOKS = ROOT / "notebooks"


class Lab:
    """A running JupyterLab and its folder."""

    def __init__(self, url, folder, process):
        self.url, self.folder, self.process = url, folder, process

    def write(self, name, sources):
        """Put a notebook with these code cells into the folder."""
        cells = [
            {
                "cell_type": "code",
                "id": f"cell-{i}",
                "metadata": {},
                "execution_count": None,
                "outputs": [],
                "source": source,
            }
            for i, source in enumerate(sources)
        ]
        kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
        text = json.dumps(
            {"nbformat": 4, "nbformat_minor": 5, "metadata": {"kernelspec": kernel}, "cells": cells}
        )
        (self.folder / f"{name}.ipynb").write_text(text, encoding="utf-8")


@pytest.fixture(scope="session")
def lab(chromium, tmp_path_factory):
    """One JupyterLab for all tests, with nothing of the person's own in it."""
    pytest.importorskip("jupyterlab")
    folder, own = tmp_path_factory.mktemp("lab"), tmp_path_factory.mktemp("lab-settings")
    port = free_port()
    names = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    names += ("JUPYTERLAB_SETTINGS_DIR", "JUPYTERLAB_WORKSPACES_DIR")
    environment = os.environ | {name: str(own / name.lower()) for name in names}
    with (own / "lab.log").open("wb") as log:
        process = subprocess.Popen(
            [
                *(sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root"),
                *("--ServerApp.ip=127.0.0.1", f"--ServerApp.port={port}"),
                *("--ServerApp.port_retries=0", f"--ServerApp.root_dir={folder}"),
                *("--IdentityProvider.token=", "--LabApp.news_url=None"),
                "--ServerApp.disable_check_xsrf=True",  # for the requests that end kernels
            ],
            env=environment,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    url = f"http://127.0.0.1:{port}"
    deadline = time.monotonic() + START_SECONDS
    while process.poll() is None and time.monotonic() < deadline:
        try:
            urllib.request.urlopen(f"{url}/api", timeout=5).close()
            break
        except OSError:
            time.sleep(0.2)
    else:
        pytest.fail(f"JupyterLab did not start:\n{(own / 'lab.log').read_text()}")
    yield Lab(url, folder, process)
    os.killpg(process.pid, signal.SIGTERM)
    try:
        process.wait(timeout=20)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


class Notebook:
    """A notebook open in JupyterLab."""

    def __init__(self, page):
        self.page = page
        self.cells = page.locator(".jp-CodeCell")

    def wait_for_the_kernel(self):
        self.page.get_by_text("| Idle").wait_for(timeout=PATIENCE)

    def run(self, index):
        """Run a code cell, and return what it says."""
        cell = self.cells.nth(index)
        prompt = cell.locator(".jp-InputPrompt")
        before = prompt.inner_text()
        cell.locator(".cm-content").first.click()
        self.page.keyboard.press("Shift+Enter")
        self.page.wait_for_function(
            "([node, before]) => /\\d/.test(node.innerText) && node.innerText !== before",
            arg=[prompt.element_handle(), before],
            timeout=PATIENCE,
        )
        error = cell.locator("[data-mime-type='application/vnd.jupyter.stderr']")
        assert error.count() == 0, error.first.inner_text()
        return "\n".join(cell.locator(".jp-OutputArea-output").all_inner_texts())

    def choose(self, menu, command):
        """Choose from JupyterLab's menu, and say yes if it asks."""
        self.page.locator(".lm-MenuBar-item").get_by_text(menu, exact=True).click()
        self.page.locator(".lm-Menu-item").get_by_text(command, exact=True).click()
        self.page.locator(".jp-Dialog .jp-mod-accept").click()

    def errors(self):
        """What the cells say went wrong."""
        kinds = ("application/vnd.jupyter.error", "application/vnd.jupyter.stderr")
        selector = ", ".join(f"[data-mime-type='{kind}']" for kind in kinds)
        return self.page.locator(selector).all_inner_texts()

    def explorer(self, index=0):
        return Widget(
            self.page, self.page.locator(".bk-panel-models-layout-Column.cell").nth(index)
        )


class Widget:
    """An explorer in the output of a cell."""

    def __init__(self, page, root):
        self.page, self.root = page, root

    def wait(self):
        self.root.locator("[data-answer]").first.wait_for(timeout=PATIENCE)
        self.root.locator(".card.stability canvas").first.wait_for(timeout=PATIENCE)
        return self

    def value(self, name):
        """What the box beside a slider shows."""
        return float(self.box(name).input_value().replace(",", ""))

    def box(self, name):
        return self.root.locator(f"input[type=text][data-name={name}]")

    def linear(self):
        """The linear critical speed shown [km/h]."""
        text = self.root.locator("[data-answer='linear critical speed'] dd").inner_text()
        return float(re.match(r"[\d.]+", text)[0])

    def type(self, name, text):
        self.box(name).click()
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")

    def drag(self, name, share):
        """Move a slider with the mouse by a share of its length, in some steps."""
        slider = self.root.locator(f"input[type=range][data-name={name}]")
        slider.scroll_into_view_if_needed()
        box = slider.bounding_box()
        at = float(slider.input_value()) / float(slider.get_attribute("max"))
        thumb = 16
        start = box["x"] + thumb / 2 + at * (box["width"] - thumb)
        y = box["y"] + box["height"] / 2
        self.page.mouse.move(start, y)
        self.page.mouse.down()
        for step in range(1, 6):
            self.page.mouse.move(start + share * box["width"] * step / 5, y)
            self.page.wait_for_timeout(50)
        self.page.mouse.up()

    def hopf_point(self):
        """Where the bifurcation diagram in the browser has its fastest Hopf point [km/h]."""
        return self.page.evaluate(
            """(root) => {
              const view = [...Bokeh.index].find((view) => view.el === root);
              const figure = view.model.document.get_model_by_name("bifurcation");
              const marks = figure.renderers.filter((r) => r.visible && r.glyph.type === "Scatter");
              const speeds = marks.flatMap((r) => {
                const { data } = r.data_source;
                const { V, a } = data instanceof Map ? Object.fromEntries(data) : data;
                return V && a ? [...V].filter((_, i) => a[i] === 0) : [];
              });
              return Math.max(...speeds);
            }""",
            self.root.element_handle(),
        )

    def until(self, what, reached, seconds=60):
        """Wait until something that the page shows is as it should be, and return it."""
        deadline = time.monotonic() + seconds
        while not reached(value := what()):
            assert time.monotonic() < deadline, f"still {value}"
            self.page.wait_for_timeout(100)
        return value


@pytest.fixture
def open_notebook(lab, new_page):
    """Open a notebook of the Lab's folder; a kernel each, ended with the test."""

    def open_it(name):
        page = new_page(viewport={"width": 1300, "height": 1100})
        page.goto(f"{lab.url}/lab/tree/{name}.ipynb?reset")
        notebook = Notebook(page)
        notebook.cells.first.wait_for(timeout=PATIENCE)
        notebook.wait_for_the_kernel()
        return notebook

    yield open_it
    with urllib.request.urlopen(f"{lab.url}/api/sessions") as answer:
        for session in json.load(answer):
            request = urllib.request.Request(
                f"{lab.url}/api/sessions/{session['id']}", method="DELETE"
            )
            urllib.request.urlopen(request).close()


def code_of(name):
    """Return the code cells of one of the project's notebooks."""
    stored = json.loads((Path(NOTEBOOKS) / f"{name}.ipynb").read_text(encoding="utf-8"))
    return ["".join(c["source"]) for c in stored["cells"] if c["cell_type"] == "code"]
