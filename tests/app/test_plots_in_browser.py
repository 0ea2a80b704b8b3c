"""What Bokeh makes of the plots: glyphs, tooltips, canvases and their sizes."""

from __future__ import annotations

import pytest

LOOK = """() => [...Bokeh.documents[0]._all_models.values()]
  .filter((model) => model.type === "Figure" && model.visible)
  .map((figure) => [figure, Bokeh.index.find_one(figure)])
  .filter(([, view]) => view !== null)"""

GLYPHS = f"""() => ({LOOK})().flatMap(([figure, view]) => figure.renderers.map((renderer) => [
  `${{figure.name}}: ${{renderer.name ?? renderer.glyph.type}}`,
  renderer.data_source.get_length(), view.renderer_views.get(renderer).glyph.data_size]))"""

CORNERS = f"""() => ({LOOK})().map(([figure, view]) => {{
  const {{ canvas, ctx }} = view.canvas_view.primary;
  const places = [[canvas.width / 2, 0], [0, canvas.height / 2]];
  return [figure.name, ...places.map(([x, y]) => [...ctx.getImageData(x, y, 1, 1).data])];
}})"""

HEIGHTS = f"""() => ({LOOK})().map(([figure, view]) =>
  [figure.name, view.el.getBoundingClientRect().height, view.frame.bbox.bottom])"""

CURVE = """([figure, name]) => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const plot = models.find((model) => model.name === figure);
  const { data_source: { data }, glyph } = plot.renderers.find((model) => model.name === name);
  const y = data[glyph.y.field];
  const drawn = [...y.keys()].filter((i) => Number.isFinite(y[i]));
  const at = drawn[Math.floor(drawn.length / 2)];
  const { x_scale, y_scale } = Bokeh.index.find_one(plot).frame;
  return [x_scale.compute(data.V[at]), y_scale.compute(y[at]), data.V[at], y[at]];
}"""


def test_curves_that_are_made_late_are_drawn_with_their_data(dashboard):
    dashboard.press("Pin as baseline")
    dashboard.type("Ky", "1.2e5")
    dashboard.choose("both")
    glyphs = dashboard.page.evaluate(GLYPHS)
    names = " ".join(name for name, _, _ in glyphs)
    assert "bifurcation: baseline, wheelset, stable cycle" in names
    assert "damping: wheelset, least damped mode" in names
    assert [name for name, rows, drawn in glyphs if rows != drawn] == []


@pytest.mark.parametrize(
    ("figure", "described", "name", "words"),
    [
        ("bifurcation", "Bifurcation diagram", "bogie, unstable cycle, exact", "{y:.2f} mm at"),
        ("bifurcation", "Bifurcation diagram", "baseline, bogie, unstable cycle", "{y:.2f} mm at"),
        ("damping", "Damping ratio", "bogie, least damped mode", "ζ = {y:.2f} % at"),
    ],
)
def test_the_pointer_reads_a_curve(dashboard, figure, described, name, words):
    dashboard.press("Pin as baseline")
    dashboard.type("Ky", "1.5e5")
    plot = dashboard.page.get_by_role("img", name=described)
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    x, y, V, value = dashboard.page.evaluate(CURVE, [figure, name])
    dashboard.page.mouse.move(box["x"] + x - 2, box["y"] + y)
    dashboard.page.mouse.move(box["x"] + x, box["y"] + y)
    tip = dashboard.page.locator(".bk-tooltip-content", has_text=name)
    assert f"{words.format(y=value)} {V:.1f} km/h" in tip.first.inner_text()


def test_nothing_of_the_other_scheme_stays_at_a_plots_edge(dashboard):
    dashboard.choose("☾ Dark")
    for name, *corners in dashboard.page.evaluate(CORNERS):
        for *colour, opacity in corners:
            assert opacity == 0 or max(colour) < 60, f"{name}: {colour}"


@pytest.mark.parametrize("width", [390, 1000, 1440])
def test_words_that_come_late_leave_the_plots_their_room(open_dashboard, width):
    dashboard = open_dashboard("?pair=yes", viewport={"width": width, "height": 900})
    dashboard.page.get_by_text("grows into a limit cycle").wait_for()
    dashboard.settle()
    for name, height, bottom in dashboard.page.evaluate(HEIGHTS):
        assert bottom <= height, name


def test_a_wheelset_has_no_plots_of_a_frame(dashboard):
    def plots():
        return {name for name, _, _ in dashboard.page.evaluate(HEIGHTS)}

    of_the_frame = {"portrait-z", "history-z"}
    assert of_the_frame <= plots()
    dashboard.choose("wheelset")
    assert not of_the_frame & plots()
    dashboard.choose("both")
    assert of_the_frame <= plots()
