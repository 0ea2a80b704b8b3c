"""The page is for everyone: keyboard, assistive technology, eyes of all kinds, small screens."""

from __future__ import annotations

from importlib.resources import files

import pytest

AXE = files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8")
SERIOUS = """async () => {
  const { violations } = await axe.run(document, { resultTypes: ["violations"] });
  return violations
    .filter((v) => v.impact === "serious" || v.impact === "critical")
    .flatMap((v) => v.nodes.map((n) => `${v.id}: ${n.html.slice(0, 160)} ${n.failureSummary}`));
}"""
BEYOND = """() => {
  const width = document.documentElement.clientWidth, found = [];
  const look = (root) => {
    for (const node of root.querySelectorAll("*")) {
      const box = node.getBoundingClientRect();
      if (box.width && box.height && (box.right > width + 0.5 || box.left < -0.5)) {
        found.push(`${node.tagName} ${node.className} ${box.left} to ${box.right}`);
      }
      if (node.shadowRoot && !node.matches(".bk-Figure")) look(node.shadowRoot);
    }
  };
  look(document);
  return found;
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("search", ["?vehicle=both&disturbance=8", "?page=study", "?page=model"])
def test_axe_finds_nothing_serious(open_dashboard, search, scheme):
    dashboard = open_dashboard(search, color_scheme=scheme, bypass_csp=True)
    if "study" in search:  # its figures are there
        dashboard.page.get_by_text("statements hold").wait_for(timeout=240_000)
    dashboard.page.wait_for_timeout(1500)
    dashboard.page.evaluate(AXE)
    assert "\n".join(dashboard.page.evaluate(SERIOUS)) == ""


@pytest.mark.parametrize("width", [390, 800, 1100, 1920])
def test_nothing_sticks_out_of_the_window(open_dashboard, width):
    dashboard = open_dashboard("?vehicle=both", viewport={"width": width, "height": 900})
    assert "\n".join(dashboard.count(BEYOND)) == ""


def test_a_disturbance_is_typed_where_others_click(dashboard):
    box = dashboard.page.get_by_label("Disturb by")
    box.focus()
    dashboard.page.keyboard.type("8")
    dashboard.page.keyboard.press("Enter")
    verdict = dashboard.page.locator(".verdict", has_text="8.00 mm grows into a limit cycle")
    verdict.wait_for()
    focused = "node => node.getRootNode().activeElement === node"
    assert dashboard.page.get_by_label("Disturb by").evaluate(focused)
    dashboard.page.keyboard.type("-1")
    dashboard.page.keyboard.press("Enter")
    dashboard.page.get_by_text("the disturbance must be finite and >= 0 mm").wait_for()


def test_a_term_explains_itself_to_the_keyboard(dashboard):
    term = dashboard.page.locator(".legend .term", has_text="unstable limit cycle")
    bubble = term.get_by_role("tooltip")
    assert not bubble.is_visible()
    term.focus()
    assert bubble.is_visible()
    assert bubble.inner_text() == "The threshold: larger disturbances grow, smaller ones die out."


def test_three_hints_are_shown_once(open_dashboard):
    dashboard = open_dashboard()
    dashboard.page.evaluate("localStorage.clear()")
    page = dashboard.page.context.new_page()
    for visit in range(2):
        page.goto(dashboard.url)
        page.locator(".card.stability canvas").first.wait_for(state="attached")
        page.wait_for_timeout(800)
        hints = page.get_by_label("hints")
        if visit:
            assert not hints.is_visible()
            break
        for label in ("Next (1 of 3)", "Next (2 of 3)", "Got it"):
            page.get_by_role("button", name=label).click()
        assert not hints.is_visible()
