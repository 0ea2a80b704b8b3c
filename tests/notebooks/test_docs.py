"""The notebooks as HTML: whole, with no network at all."""

from __future__ import annotations

import pytest

import docs

COLOURS = """(canvas) => {
  const context = canvas.getContext("2d");
  if (!context || !canvas.width || !canvas.height) return 0;
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""


@pytest.mark.slow
def test_an_exported_notebook_opens_without_network(new_page, tmp_path):
    file = docs.export(docs.NOTEBOOKS / "01_quickstart.ipynb", tmp_path)
    page = new_page()  # fails on a console error
    refused = []

    def only_this_file(route):
        if route.request.url == file.as_uri():
            route.continue_()
        else:
            refused.append(route.request.url)
            route.abort()

    page.route("**/*", only_this_file)
    page.goto(file.as_uri())
    plot = page.locator(".bk-panel-models-layout-Column.cell .card.stability canvas").first
    plot.wait_for(timeout=60_000)
    page.wait_for_timeout(1000)
    painted = [c.evaluate(COLOURS) for c in page.locator("canvas").all()]
    assert sum(colours > 20 for colours in painted) >= 4  # the diagram twice, and two more
    portraits = page.locator(".card.portraits canvas").all()
    lefts = {round(c.bounding_box()["x"]) for c in portraits if c.is_visible()}
    assert len(lefts) == 3  # side by side
    assert page.locator(".formula").all_inner_texts() == ["Vlin", "Vnl", "Ky", "δ"]
    assert "$" not in page.locator("main").inner_text()
    assert page.locator("nav a").get_attribute("href") == "index.html"
    assert not refused


def test_a_script_is_kept_once_and_cannot_end_its_element():
    script = "load('</script>')"

    def cell():
        output = docs.nbformat.v4.new_output("display_data", {docs.JAVASCRIPT: script})
        return docs.nbformat.v4.new_code_cell("plot", outputs=[output])

    html = docs.body(docs.nbformat.v4.new_notebook(cells=[cell(), cell()]))
    assert html.count(r"load('<\/script>')") == 1
    assert html.count("</script>") == 1


def test_formulas_are_drawn_without_a_script():
    text = "Speed $V_c$:\n\n$$V = \\frac{1}{2}$$"
    html = docs.body(
        docs.nbformat.v4.new_notebook(cells=[docs.nbformat.v4.new_markdown_cell(text)])
    )
    assert "<i>V</i><sub><i>c</i></sub>" in html
    assert 'class="fraction"' in html
    assert "$" not in html


def test_the_index_lists_all_notebooks():
    page = docs.index(sorted(docs.NOTEBOOKS.glob("*.ipynb")))
    assert page.count("At the end you know") == 5
    assert '<a href="01_quickstart.html">Quickstart</a>' in page
