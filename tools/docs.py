"""Run the notebooks, and write them as HTML that opens without network: docs.py [NAME ...].

A page holds all it needs: plots with their JavaScript, formulas as plain HTML.
"""

from __future__ import annotations

import sys
from html import escape
from pathlib import Path
from typing import Any

import nbformat
from jinja2 import pass_context
from nbclient import NotebookClient
from nbconvert import HTMLExporter
from nbconvert.filters import Highlight2HTML
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from nbformat import NotebookNode
from pygments.formatters import HtmlFormatter

from hunting_app.formula import STYLE, formula

ROOT = Path(__file__).parents[1]
NOTEBOOKS = ROOT / "notebooks"
HTML = ROOT / "docs" / "html"
CSS = Path(__file__).with_name("docs.css").read_text(encoding="utf-8") + STYLE
JAVASCRIPT = "application/javascript"


class _Markdown(IPythonRenderer):
    """Markdown whose formulas are drawn by us: no script, no font to fetch."""

    def inline_math(self, body: str) -> str:
        return formula(body)

    def block_math(self, body: str) -> str:
        return f'<div class="displayed">{formula(body)}</div>'


class _Exporter(HTMLExporter):
    """The body of a page: nbconvert's smallest template, without its scripts from elsewhere."""

    template_name = "basic"

    @pass_context
    def markdown2html(self, _context: Any, source: str) -> str:
        renderer = _Markdown(escape=False, anchor_link_text="")
        return MarkdownWithMath(renderer=renderer).render(source)


def executed(path: Path) -> NotebookNode:
    """Return a notebook with the outputs of a run in a kernel of its own."""
    notebook = nbformat.read(path, as_version=4)
    folder = {"metadata": {"path": str(path.parent)}}
    return NotebookClient(notebook, timeout=600, resources=folder).execute()


def once(notebook: NotebookNode) -> NotebookNode:
    """Leave each script in a notebook only where it comes first, and outputs that show nothing out.

    Plots bring Bokeh's and Panel's along, three megabytes, as a cell cannot know what is above.
    """
    seen: set[str] = set()
    for cell in notebook.cells:
        kept = []
        for output in cell.get("outputs", []):
            data = output.get("data", {"text": output.get("text")})
            if script := data.pop(JAVASCRIPT, None):
                if script in seen:
                    continue
                seen.add(script)
                whole = script.replace("</script", r"<\/script")
                data["text/html"] = f"<script>{whole}</script>"
            if data:
                kept.append(output)
        if "outputs" in cell:
            cell.outputs = kept
    return notebook


def body(notebook: NotebookNode) -> str:
    """Return an executed notebook as HTML, without the page around it."""
    exporter = _Exporter(exclude_input_prompt=True, exclude_output_prompt=True)
    exporter.register_filter("highlight_code", Highlight2HTML(pygments_lexer="python"))
    html, _ = exporter.from_notebook_node(once(notebook))
    return html


def page(title: str, inside: str) -> str:
    """Return a whole HTML page."""
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<link rel="icon" href="data:,">\n<title>{escape(title)} · bogie-hunting</title>\n'
        f"<style>\n{CSS}{HtmlFormatter().get_style_defs('.highlight')}\n</style>\n</head>\n"
        f"<body>\n<main>\n{inside}\n</main>\n</body>\n</html>\n"
    )


def title_and_aim(notebook: NotebookNode) -> tuple[str, str]:
    """Return a notebook's title, and its paragraph on what the reader will know."""
    title, aim, *_ = notebook.cells[0].source.split("\n\n")
    return title.removeprefix("# "), aim


def export(path: Path, folder: Path) -> Path:
    """Run a notebook, write it into `folder` as HTML, and return the file."""
    notebook = executed(path)
    title, _ = title_and_aim(notebook)
    contents = '<nav><a href="index.html">All notebooks</a></nav>\n'
    file = folder / f"{path.stem}.html"
    file.write_text(page(title, contents + body(notebook)), encoding="utf-8")
    return file


def index(paths: list[Path]) -> str:
    """Return the page that lists the notebooks."""
    entries = []
    for path in paths:
        title, aim = title_and_aim(nbformat.read(path, as_version=4))
        said = MarkdownWithMath(renderer=_Markdown(escape=False)).render(aim)
        entries.append(f'<h2><a href="{path.stem}.html">{escape(title)}</a></h2>\n{said}')
    return page("Notebooks", "<h1>bogie-hunting: the notebooks</h1>\n" + "\n".join(entries))


def main() -> None:
    """Write the notebooks whose names begin with the arguments, all without any."""
    every = sorted(NOTEBOOKS.glob("*.ipynb"))
    HTML.mkdir(parents=True, exist_ok=True)
    for path in every:
        if path.stem.startswith(tuple(sys.argv[1:] or [""])):
            print(f"==> {export(path, HTML).relative_to(ROOT)}", flush=True)
    (HTML / "index.html").write_text(index(every), encoding="utf-8")
    print(f"==> {HTML.relative_to(ROOT) / 'index.html'}")


if __name__ == "__main__":
    main()
