"""The explorer in a real JupyterLab: sliders move Python, Python moves sliders."""

from __future__ import annotations

import pytest

from hunting import RECONSTRUCTED, bogie, critical_speeds
from tests.notebooks.conftest import PATIENCE, code_of

pytestmark = pytest.mark.slow

KMH = 3.6
START = KMH * critical_speeds(bogie(RECONSTRUCTED), "averaging").linear


def linear(K_y):
    return KMH * critical_speeds(bogie(RECONSTRUCTED.replace(Ky=K_y)), "averaging").linear


def shows(widget, K_y):
    """Wait until slider, answer and diagram show the bogie of this stiffness."""
    widget.until(lambda: widget.value("Ky"), lambda value: value == pytest.approx(K_y))
    widget.until(widget.linear, lambda value: value == pytest.approx(linear(K_y), abs=0.06))
    widget.until(widget.hopf_point, lambda value: value == pytest.approx(linear(K_y), rel=1e-6))


def test_the_quickstart_both_ways(lab, open_notebook):
    code = code_of("01_quickstart")
    at = next(i for i, source in enumerate(code) if source.endswith("\nexplore"))
    lab.write("quickstart", [*code[: at + 1], "explore.parameters.Ky", "explore.parameters = p"])
    notebook = open_notebook("quickstart")
    for index in range(at + 1):
        notebook.run(index)
    widget = notebook.explorer().wait()
    assert widget.linear() == pytest.approx(START, abs=0.06)

    widget.drag("Ky", 0.2)
    moved = widget.until(lambda: widget.value("Ky"), lambda value: value > 1.3e5)
    shows(widget, moved)
    assert float(notebook.run(at + 1)) == moved

    notebook.run(at + 2)  # p, whose K_y is 1.2e5
    shows(widget, 1.2e5)
    widget.type("Ky", "1e5")  # keys that JupyterLab has shortcuts for
    shows(widget, 1e5)
    assert float(notebook.run(at + 1)) == 1e5


def test_as_an_ipywidget_both_ways(lab, open_notebook):
    lab.write(
        "ipywidget",
        [
            "from hunting_app import explorer\ne = explorer(['Ky', 'lam'])\ne.ipywidget()",
            "e.parameters.Ky",
            "e.parameters = e.parameters.replace(Ky=1.5e5)",
        ],
    )
    notebook = open_notebook("ipywidget")
    notebook.run(0)
    widget = notebook.explorer().wait()
    widget.drag("Ky", 0.2)
    moved = widget.until(lambda: widget.value("Ky"), lambda value: value > 1.3e5)
    shows(widget, moved)
    assert float(notebook.run(1)) == moved
    notebook.run(2)
    shows(widget, 1.5e5)


def test_two_explorers_leave_each_other_alone(lab, open_notebook):
    show = "from hunting_app import explorer\n{0} = explorer(['Ky'])\n{0}"
    lab.write("two", [show.format("a"), show.format("b"), "a.parameters.Ky, b.parameters.Ky", "b"])
    notebook = open_notebook("two")
    address = notebook.page.url
    notebook.run(0)
    notebook.run(1)
    first, second = (notebook.explorer(k).wait() for k in (0, 1))
    second.type("Ky", "2e5")
    shows(second, 2e5)
    shows(first, RECONSTRUCTED.Ky)
    assert notebook.run(2) == f"({RECONSTRUCTED.Ky}, 200000.0)"

    notebook.run(3)  # one of them again: both of its views live
    again = notebook.explorer(2).wait()
    again.type("Ky", "3e5")
    shows(again, 3e5)
    shows(second, 3e5)
    assert notebook.page.url == address
    assert not [c for c in notebook.page.context.cookies() if "hunting" in c["name"]]


def test_after_a_restart_the_cells_run_again_and_an_old_widget_is_only_dead(lab, open_notebook):
    code = code_of("01_quickstart")
    at = next(i for i, source in enumerate(code) if source.endswith("\nexplore"))
    lab.write("restart", [*code[: at + 1], "explore.parameters.Ky"])
    notebook = open_notebook("restart")
    for index in range(at + 1):
        notebook.run(index)
    old = notebook.explorer().wait()
    answered = old.linear()

    prompt = notebook.cells.nth(at + 1).locator(".jp-InputPrompt")
    notebook.choose("Kernel", "Restart Kernel…")
    notebook.page.wait_for_timeout(1000)
    notebook.wait_for_the_kernel()
    old.type("Ky", "2e5")  # nobody listens
    notebook.page.wait_for_timeout(500)
    assert old.linear() == answered

    notebook.choose("Kernel", "Restart Kernel and Run All Cells…")
    notebook.page.wait_for_function(
        "(node) => /\\d/.test(node.innerText)", arg=prompt.element_handle(), timeout=PATIENCE
    )
    widget = notebook.explorer().wait()
    shows(widget, RECONSTRUCTED.Ky)
    widget.type("Ky", "1.1e5")
    shows(widget, 1.1e5)
    assert float(notebook.run(at + 1)) == 1.1e5
    assert notebook.errors() == []
