"""The notebooks as they are stored; that they run is seen by running them (pytest notebooks)."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))

each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def cells(path, kind):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == kind]


def test_there_are_five():
    assert [path.stem[:2] for path in NOTEBOOKS] == ["01", "02", "03", "04", "05"]


def test_the_quickstart_begins_with_the_readmes_ten_lines():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (ten_lines,) = re.findall(r"```python\n(.*?)\n```", readme, re.DOTALL)
    assert cells(NOTEBOOKS[0], "code")[0] == ten_lines
    assert len(ten_lines.splitlines()) == 10


@each_notebook
def test_it_is_stored_without_outputs(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


@each_notebook
def test_it_says_first_what_the_reader_will_know(path):
    first = cells(path, "markdown")[0]
    assert first.startswith("# ")
    assert "**At the end you know**" in first


@each_notebook
def test_it_asserts_its_own_numbers(path):
    assert any(re.search(r"^ *assert ", source, re.MULTILINE) for source in cells(path, "code"))
