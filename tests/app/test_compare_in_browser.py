"""Undo, links, baseline, designs and files, used the way a person does."""

from __future__ import annotations

import csv
import io
import json
import re

import pytest
from playwright.sync_api import expect

from hunting import RECONSTRUCTED, bogie, critical_speeds, wheelset

V_LIN, V_NL = "linear critical speed", "nonlinear critical speed"


def tenths(vehicle, **changes):
    """V_nl and V_lin [km/h] as they are shown."""
    speeds = critical_speeds(vehicle(RECONSTRUCTED.replace(**changes)))
    return round(3.6 * speeds.nonlinear, 1), round(3.6 * speeds.linear, 1)


def change(vehicle, name, **changes):
    """What the page has to say of a change against the preset."""
    which = (V_NL, V_LIN).index(name)
    return f"{tenths(vehicle, **changes)[which] - tenths(vehicle)[which]:+.1f} km/h".replace(
        "-", "−"
    )


def address(dashboard, search=""):
    return f"{dashboard.url.rstrip('/')}/{search}"


def in_grey(dashboard, plot):
    """How many grey lines with points in them a plot shows."""
    return dashboard.page.evaluate(
        """(name) => Bokeh.documents[0].get_model_by_name(name).renderers.filter((r) => r.visible
          && ["#868e96", "#8b939c"].includes(r.glyph.line_color?.value)
          && r.data_source.get_column(r.glyph.y.field)?.length > 9).length""",
        plot,
    )


# ---------------------------------------------------------------- undo and redo


def test_undo_and_redo_by_buttons_and_keys(dashboard):
    undo = dashboard.page.get_by_role("button", name="Undo")
    expect(undo).to_be_disabled()
    dashboard.type("Ky", "1e5")
    dashboard.type("m_w", "1500")
    dashboard.press("Undo")
    assert (dashboard.value("m_w"), dashboard.value("Ky")) == (1380, 1e5)
    dashboard.page.locator("h1").click()
    dashboard.key("Control+z")
    assert dashboard.value("Ky") == 86_700
    expect(undo).to_be_disabled()
    dashboard.key("Control+Shift+Z")
    dashboard.press("Redo")
    assert (dashboard.value("m_w"), dashboard.value("Ky")) == (1500, 1e5)
    assert dashboard.answer(V_LIN) == tenths(bogie, Ky=1e5, m_w=1500)[1]


def test_a_drag_is_one_step(dashboard):
    slider = dashboard.slider("Ky")
    middle = slider.bounding_box()
    y = middle["y"] + middle["height"] / 2
    dashboard.page.mouse.move(middle["x"] + 0.47 * middle["width"], y)
    dashboard.page.mouse.down()
    for k in range(20):
        dashboard.page.mouse.move(middle["x"] + (0.5 + 0.02 * k) * middle["width"], y)
    dashboard.page.mouse.up()
    dashboard.settle()
    assert dashboard.value("Ky") > 2e5
    dashboard.key("Control+z")
    assert dashboard.value("Ky") == 86_700
    expect(dashboard.page.get_by_role("button", name="Undo")).to_be_disabled()


def test_in_a_box_the_keys_are_the_boxs_own(dashboard):
    dashboard.type("Ky", "1e5")
    dashboard.box("m_w").click()
    dashboard.page.keyboard.type("77")
    dashboard.key("Control+z")
    assert dashboard.value("Ky") == 1e5


def test_a_group_goes_back_with_one_click_and_comes_again_with_undo(dashboard):
    group = dashboard.page.locator("[data-group='primary suspension'] > button")
    expect(group).to_be_disabled()
    for name, text in (("Ky", "1e5"), ("Cy", "3e4"), ("m_w", "1500")):
        dashboard.type(name, text)
    expect(group).to_be_enabled()
    group.click()
    dashboard.settle()
    assert [dashboard.value(n) for n in ("Ky", "Cy", "m_w")] == [86_700, 21_000, 1500]
    expect(group).to_be_disabled()
    dashboard.press("Undo")
    assert [dashboard.value(n) for n in ("Ky", "Cy", "m_w")] == [1e5, 3e4, 1500]


# ---------------------------------------------------------------- the address bar


def test_each_edit_is_one_step_back_and_forward(dashboard):
    length = "() => history.length"
    before = dashboard.count(length)
    for text in ("9e4", "1e5", "1.1e5"):
        dashboard.type("Ky", text)
    dashboard.choose("both")
    assert dashboard.count(length) == before + 4
    for search in ("?Ky=110000", "?Ky=100000", "?Ky=90000", ""):
        dashboard.page.go_back()
        dashboard.page.wait_for_url(address(dashboard, search))
    dashboard.settle()
    assert dashboard.value("Ky") == 86_700
    dashboard.page.go_forward()
    dashboard.page.go_forward()
    expect(dashboard.box("Ky")).to_have_value("100,000")
    dashboard.settle()
    assert dashboard.page.url.endswith("?Ky=100000")
    assert dashboard.count(length) == before + 4
    assert dashboard.answer(V_NL) == tenths(bogie, Ky=1e5)[0]


def test_steps_back_in_a_hurry_end_where_the_address_does(dashboard):
    for text in ("9e4", "1e5", "1.1e5"):
        dashboard.type("Ky", text)
    dashboard.page.evaluate(
        "() => { for (const t of [0, 15, 30]) setTimeout(() => history.back(), t); }"
    )
    expect(dashboard.box("Ky")).to_have_value("86,700")
    dashboard.settle()
    assert dashboard.page.url == address(dashboard)


def test_a_copied_link_opens_the_same_picture(open_dashboard):
    one = open_dashboard("", permissions=["clipboard-read", "clipboard-write"])
    one.choose("both")
    one.type("m_w", "1500")
    one.press("Pin as baseline")
    one.type("Ky", "1.2e5")
    one.type("V", "150")
    one.press("Just inside and outside")
    one.press("Copy link")
    expect(one.page.locator(".said[role=status]")).to_contain_text("Link copied")
    link = one.page.evaluate("() => navigator.clipboard.readText()")
    other = open_dashboard(link[link.index("?") :])
    other.page.locator(".verdict").first.wait_for()
    for vehicle in ("bogie", "wheelset"):
        assert other.change(V_NL, vehicle) == one.change(V_NL, vehicle) is not None
        assert other.answer(V_NL, vehicle) == one.answer(V_NL, vehicle)
    assert in_grey(other, "bifurcation") == in_grey(one, "bifurcation") == 4
    assert other.said() == one.said()
    other.settle()
    assert other.page.url == link


# ---------------------------------------------------------------- the baseline


def test_a_pinned_baseline_stays_in_grey_and_every_answer_shows_its_change(dashboard):
    assert dashboard.change(V_NL) is None
    dashboard.press("Pin as baseline")
    dashboard.type("Ky", "1.2e5")
    dashboard.choose("both")
    for name in (V_NL, V_LIN):
        assert dashboard.change(name, "bogie") == change(bogie, name, Ky=1.2e5)
        assert dashboard.change(name, "wheelset") == change(wheelset, name, Ky=1.2e5)
    for name, unit in (
        ("conditional band", "km/h"),
        ("hunting frequency", "Hz"),
        ("wavelength", "m"),
    ):
        assert re.fullmatch(rf"[+−]\d+\.\d+ {unit}|±0", dashboard.change(name))
    assert in_grey(dashboard, "bifurcation") == 4
    assert in_grey(dashboard, "damping") == 2
    dashboard.choose("wheelset")
    assert in_grey(dashboard, "bifurcation") == 2
    unpin = dashboard.page.get_by_role("button", name="Unpin")
    expect(unpin).to_be_visible()
    dashboard.press("Unpin")
    expect(unpin).to_be_hidden()
    assert in_grey(dashboard, "bifurcation") == in_grey(dashboard, "damping") == 0
    assert dashboard.change(V_NL, "wheelset") is None
    dashboard.press("Undo")
    assert dashboard.change(V_NL, "wheelset") == change(wheelset, V_NL, Ky=1.2e5)


def test_by_averaging_the_change_is_that_of_averaging(dashboard):
    dashboard.press("Pin as baseline")
    dashboard.type("Ky", "1.2e5")
    dashboard.press("Exact")
    now, before = (
        round(3.6 * critical_speeds(bogie(p), method="averaging").nonlinear, 1)
        for p in (RECONSTRUCTED.replace(Ky=1.2e5), RECONSTRUCTED)
    )
    assert dashboard.change(V_NL) == f"{now - before:+.1f} km/h"


# ---------------------------------------------------------------- designs


def names(dashboard):
    return [box.input_value() for box in dashboard.page.locator("tr[data-design] input").all()]


def design(dashboard, name):
    return dashboard.page.locator(f"tr[data-design='{name}']")


def within(dashboard, name, label):
    design(dashboard, name).get_by_role("button", name=re.compile(label)).click()
    dashboard.settle()


def rename(dashboard, name, text):
    design(dashboard, name).locator("input").fill(text)
    design(dashboard, name).locator("input").press("Enter")
    dashboard.settle()


@pytest.fixture
def two_designs(dashboard):
    """The drawer with a soft design and a stiff one; the sliders show the stiff one."""
    dashboard.press("Designs")
    for text in ("6e4", "1.2e5"):
        dashboard.type("Ky", text)
        dashboard.press("Keep this design")
    rename(dashboard, "Design 1", "soft")
    rename(dashboard, "Design 2", "stiff")
    return dashboard


def test_designs_are_named_compared_and_switched(two_designs):
    dashboard = two_designs
    assert names(dashboard) == ["soft", "stiff"]
    for name, Ky in (("soft", 6e4), ("stiff", 1.2e5)):
        for speed in tenths(bogie, Ky=Ky):
            expect(design(dashboard, name)).to_contain_text(f"{speed:.1f}")
    expect(design(dashboard, "soft")).to_contain_text("Ky = 60,000 N/m")
    within(dashboard, "soft", "show")
    assert dashboard.value("Ky") == 6e4
    within(dashboard, "stiff", "pin")
    expect(dashboard.page.get_by_role("button", name="Unpin stiff")).to_be_visible()
    assert dashboard.change(V_NL).startswith("−")
    dashboard.key("Control+z")
    dashboard.key("Control+z")
    assert dashboard.value("Ky") == 1.2e5


def test_designs_are_moved_deleted_and_brought_back(two_designs):
    dashboard = two_designs
    within(dashboard, "stiff", "up")
    assert names(dashboard) == ["stiff", "soft"]
    within(dashboard, "stiff", "delete")
    assert names(dashboard) == ["soft"]
    dashboard.press("Undo")
    assert names(dashboard) == ["stiff", "soft"]
    rename(dashboard, "soft", "stiff")
    expect(dashboard.page.locator(".notices")).to_contain_text("there is a design ‘stiff’ already")
    assert names(dashboard) == ["stiff", "soft"]


def test_designs_survive_a_reload_and_reach_another_tab(two_designs):
    tab = two_designs.page.context.new_page()
    tab.goto(two_designs.url)
    tab.get_by_role("button", name="Designs (2)").click()
    expect(tab.locator("tr[data-design]")).to_have_count(2)
    within(two_designs, "soft", "delete")
    expect(tab.locator("tr[data-design]")).to_have_count(1)
    two_designs.open()
    two_designs.press("Designs")
    assert names(two_designs) == ["stiff"]
    expect(two_designs.page.get_by_role("button", name="Undo")).to_be_disabled()


def test_kept_designs_do_not_disturb_the_page_as_it_opens(two_designs):
    """The number on the button comes while the plots are laid out; Bokeh would stumble."""
    complaints = []
    two_designs.page.on("pageerror", lambda error: complaints.append(str(error)))
    for search in ("", "?Ky=1e5"):
        two_designs.open(search)
        expect(two_designs.page.get_by_role("button", name="Designs (2)")).to_be_visible()
        two_designs.settle()
    assert not complaints


def test_designs_are_saved_as_csv_and_json(two_designs):
    page = two_designs.page
    with page.expect_download() as csv_file:
        page.get_by_role("button", name="CSV", exact=True).last.click()
    text = csv_file.value.path().read_text()
    comments = [line for line in text.splitlines() if line.startswith("#")]
    assert re.search(r"bogie-hunting \d", comments[1])
    found = list(csv.DictReader(io.StringIO(text.split("\n", len(comments))[-1])))
    assert [row["design"] for row in found] == ["soft", "stiff"]
    assert float(found[0]["V_nl of the bogie [km/h]"]) == tenths(bogie, Ky=6e4)[0]
    assert float(found[1]["Ky [N/m]"]) == 1.2e5
    with page.expect_download() as json_file:
        page.get_by_role("button", name="JSON", exact=True).last.click()
    kept = json.loads(json_file.value.path().read_text())["designs"]
    assert [one["name"] for one in kept] == ["soft", "stiff"]
    within(two_designs, "soft", "delete")
    page.locator("input[type=file]").set_input_files(json_file.value.path())
    two_designs.settle()
    assert names(two_designs) == ["stiff", "soft"]  # what is kept already is not kept twice
    assert "2 designs from" in page.locator(".said[role=status]").first.inner_text()


def test_the_designs_are_reached_by_keyboard_alone(dashboard):
    toggle = dashboard.page.get_by_role("button", name="Designs")
    toggle.focus()
    dashboard.key("Enter")
    dashboard.key("Enter")  # the focus is on "Keep this design"
    assert names(dashboard) == ["Design 1"]
    dashboard.page.keyboard.press("Escape")
    expect(toggle).to_be_focused()
    expect(dashboard.page.locator("#designs")).to_be_hidden()


def test_the_plots_stay_on_one_screen_and_a_phone_shows_the_table(open_dashboard):
    size = "() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    wide = open_dashboard("?vehicle=both&baseline=reconstructed&Ky=1.2e5")
    wide.press("Designs")
    wide.press("Keep this design")
    assert wide.count(size) == [1440, 900]
    diagram = wide.page.locator(".card.diagram").bounding_box()
    drawer = wide.page.locator("#designs").bounding_box()
    assert diagram["y"] + diagram["height"] < drawer["y"]
    phone = open_dashboard("", viewport={"width": 390, "height": 844})
    phone.press("Designs")
    phone.press("Keep this design")
    assert phone.count(size)[0] <= 390
    expect(design(phone, "Design 1")).to_be_in_viewport()


# ---------------------------------------------------------------- files


def upload(dashboard, content, name="mine.json"):
    text = content if isinstance(content, str) else json.dumps(content)
    dashboard.page.locator("input[type=file]").set_input_files(
        {"name": name, "mimeType": "application/json", "buffer": text.encode()}
    )
    dashboard.settle()


def test_parameters_go_out_as_a_file_and_come_back(dashboard):
    dashboard.type("Ky", "1.2e5")
    dashboard.choose("Table 1 as printed")
    dashboard.type("m_w", "1500")
    with dashboard.page.expect_download() as file:
        dashboard.page.get_by_role("button", name="Save file", exact=True).click()
    saved = file.value.path().read_text()
    dashboard.choose("Reconstructed")
    upload(dashboard, saved)
    assert "22 parameters" in dashboard.page.locator(".said[role=status]").inner_text()
    assert dashboard.page.url.endswith("?preset=table1&m_w=1500")
    dashboard.press("Undo")
    assert dashboard.page.url == address(dashboard)


def test_a_wrong_file_is_refused_in_words_and_changes_nothing(dashboard):
    dashboard.type("m_w", "1500")
    notices = dashboard.page.locator(".notices")
    for content, words in (
        ("{", "it is not JSON"),
        ({"KY": 5}, "‘KY’ is no parameter"),
        ({"Ky": -5}, "Ky must be > 0 N/m"),
        ("x" * 500_000, "500 kB is too large"),
    ):
        upload(dashboard, content, "wrong.json")
        assert "‘wrong.json’ is refused" in notices.inner_text()
        assert words in notices.inner_text()
        assert dashboard.page.url.endswith("/?m_w=1500")
        assert dashboard.value("Ky") == 86_700
    notices.get_by_role("button").click()
    expect(notices).to_be_empty()


def test_a_file_is_dropped_on_the_page(dashboard):
    drop = """() => {
      const carried = new DataTransfer();
      carried.items.add(new File(['{"Ky": 1.2e5}'], "dropped.json", { type: "application/json" }));
      for (const kind of ["dragover", "drop"]) {
        document.body.dispatchEvent(new DragEvent(kind,
          { dataTransfer: carried, bubbles: true, composed: true, cancelable: true }));
      }
    }"""
    dashboard.page.evaluate(drop)
    dashboard.page.wait_for_url("**/?Ky=120000")
    dashboard.settle()
    assert dashboard.answer(V_NL) == tenths(bogie, Ky=1.2e5)[0]
