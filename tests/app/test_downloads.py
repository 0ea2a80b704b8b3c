"""Files to take away: tables, pictures and the report, taken in a real browser."""

from __future__ import annotations

import csv
import re
from importlib.metadata import version
from xml.etree import ElementTree

import pytest
from playwright.sync_api import expect

from hunting import RECONSTRUCTED, Parameters, bogie, critical_speeds, limit_cycles

PNG = b"\x89PNG\r\n\x1a\n"
CARDS = {
    "the bifurcation diagram": "bogie-bifurcation",
    "the phase portraits": "bogie-portraits-at-145-km-h",
    "the motion over time": "bogie-motion-at-145-km-h",
    "the stability over speed": "bogie-damping",
}


def take(dashboard, what, kind, folder):
    """The file that a card's menu gives, opened by keyboard."""
    opener = dashboard.page.get_by_label(f"download {what}", exact=True)
    opener.focus()
    opener.press("Enter")
    with dashboard.page.expect_download() as download:
        dashboard.page.locator(f"details[open] [data-kind={kind}]").press("Enter")
    path = folder / download.value.suggested_filename
    download.value.save_as(path)
    return path


def table(path):
    """Header lines, and the rows as dicts."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [x for x in lines if x[0] == "#"], list(csv.DictReader(x for x in lines if x[0] != "#"))


def test_the_table_of_the_diagram_is_the_branch_with_all_it_follows_from(dashboard, tmp_path):
    dashboard.type("Ky", "1e5")
    header, rows = table(take(dashboard, "the bifurcation diagram", "csv", tmp_path))
    parameters = RECONSTRUCTED.replace(Ky=1e5)
    for field in Parameters.fields():
        value = getattr(parameters, field.name)
        assert f"# {field.name} = {value!r} {field.unit} ({field.label})" in header
    assert f"# bogie-hunting {version('bogie-hunting')}" in header
    exact = [row for row in rows if "exact" in row["method"] and row["kind"] != "fold"]
    branch = limit_cycles(bogie(parameters))
    speeds = [float(row["forward speed V [km/h]"]) for row in exact]
    assert speeds == pytest.approx(3.6 * branch.speed)
    (fold,) = (row for row in rows if "exact" in row["method"] and row["kind"] == "fold")
    V_nl = 3.6 * critical_speeds(bogie(parameters)).nonlinear
    assert float(fold["forward speed V [km/h]"]) == pytest.approx(V_nl, rel=1e-6)


def test_every_card_gives_its_curves_and_its_pictures(dashboard, tmp_path):
    dashboard.page.get_by_role("button", name="Just inside and outside").click()
    dashboard.settle()
    for what, name in CARDS.items():
        _, rows = table(take(dashboard, what, "csv", tmp_path))
        assert len(rows) > 100
        png = take(dashboard, what, "png", tmp_path)
        assert png.name == f"{name}.png"
        assert png.read_bytes().startswith(PNG)
        svg = take(dashboard, what, "svg", tmp_path)
        drawing = ElementTree.parse(svg).getroot()
        words = " ".join(node.text or "" for node in drawing.iter() if node.tag.endswith("text"))
        assert "145 km/h" in words
        assert f"bogie-hunting {version('bogie-hunting')}" in words
        assert sum(node.tag.endswith("path") for node in drawing.iter()) > 10


def test_the_menu_closes_with_escape_and_gives_the_keyboard_back(dashboard):
    opener = dashboard.page.get_by_label("download the bifurcation diagram", exact=True)
    opener.focus()
    opener.press("Enter")
    first = dashboard.page.get_by_role("button", name="Curves (CSV)")
    assert first.is_visible()
    dashboard.page.keyboard.press("Tab")
    dashboard.page.keyboard.press("Escape")
    assert not first.is_visible()
    assert opener.evaluate("node => node.getRootNode().activeElement === node")


def test_the_mouse_reaches_the_menus_from_the_plots(dashboard):
    mouse = dashboard.page.mouse
    for what in CARDS:
        opener = dashboard.page.get_by_label(f"download {what}", exact=True)
        box = opener.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        mouse.move(x - 80, y + 160)
        mouse.move(x, y, steps=12)
        mouse.down()
        mouse.up()
        expect(opener.locator("xpath=..")).to_have_attribute("open", "")
        dashboard.page.keyboard.press("Escape")


def test_the_report_opens_without_a_network_and_its_plots_move(open_dashboard, chromium, tmp_path):
    dashboard = open_dashboard("?Ky=1e5&vehicle=both&disturbance=8")
    dashboard.settle()
    path = take(dashboard, "the bifurcation diagram", "report", tmp_path)
    assert path.name == "bogie-and-wheelset-report.html"
    with chromium.new_context(offline=True) as context:
        page, complaints = context.new_page(), []
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
        page.route(re.compile("^(?!file:)"), lambda route: route.abort())
        page.on("requestfailed", lambda request: complaints.append(request.url))
        page.goto(path.as_uri())
        page.wait_for_function("() => window.Bokeh?.documents?.[0]?.is_idle")
        text = page.locator("main").inner_text()
        assert f"{dashboard.answer('nonlinear critical speed'):.1f} km/h" in text
        assert "100,000\t86,700\tN/m" in text
        assert dashboard.said() in text
        assert f"bogie-hunting {version('bogie-hunting')}" in text
        assert "disturbed in the shape of" in text
        start = "() => Bokeh.documents[0].get_model_by_name('bifurcation').x_range.start"
        assert page.evaluate(start) == 0
        page.locator(".plot.bifurcation").scroll_into_view_if_needed()
        box = page.locator(".plot.bifurcation canvas").first.bounding_box()
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0] - 100, middle[1], steps=4)
        page.mouse.up()
        assert page.evaluate(start) > 10
        page.screenshot(path=tmp_path / "report.png", full_page=True)
        assert complaints == []
