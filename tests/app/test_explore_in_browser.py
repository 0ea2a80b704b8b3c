"""The Explore page in a real browser."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from hunting import RECONSTRUCTED, Parameters, bogie, critical_speeds, wheelset

ROOT = Path(__file__).parents[2]
V_LIN, V_NL = "linear critical speed", "nonlinear critical speed"
PLOTS = 5


def km_h(vehicle, **changes):
    """What the model says: V_lin and V_nl [km/h] to the tenth that the page shows."""
    speeds = critical_speeds(vehicle(RECONSTRUCTED.replace(**changes)))
    return round(3.6 * speeds.linear, 1), round(3.6 * speeds.nonlinear, 1)


def shown(dashboard, vehicle="bogie"):
    return dashboard.answer(V_LIN, vehicle), dashboard.answer(V_NL, vehicle)


def test_the_first_picture_is_the_papers_bogie(dashboard):
    assert shown(dashboard) == km_h(bogie)
    assert "145 km/h" in dashboard.said()
    assert dashboard.canvases_painted() >= PLOTS


def test_every_parameter_has_a_labelled_slider_a_box_and_a_meaning(dashboard):
    for field in Parameters.fields():
        assert dashboard.slider(field.name).get_attribute("aria-label").startswith(field.label)
        assert dashboard.box(field.name).get_attribute("aria-label").startswith(field.label)
        assert field.unit in dashboard.row(field.name).inner_text()
        meaning = dashboard.row(field.name).locator(f"#row-{field.name}-meaning")
        assert meaning.text_content().startswith(field.description)
    dashboard.row("Ky").hover()
    tip = dashboard.page.locator(".tip.shown")
    assert "lateral stiffness" in tip.inner_text().lower()


def test_a_slider_moved_by_keys_moves_the_answers(dashboard):
    slider = dashboard.slider("Ky")
    slider.focus()
    for _ in range(12):
        slider.press("ArrowRight")
    dashboard.settle()
    value = float(dashboard.box("Ky").input_value().replace(",", ""))
    assert value > RECONSTRUCTED.Ky
    assert shown(dashboard) == km_h(bogie, Ky=value)


@pytest.mark.parametrize(("typed", "value"), [("1.2e5", 1.2e5), ("86,700", 86700.0), ("2e6", 2e6)])
def test_a_typed_value_counts_and_widens_the_slider_if_need_be(dashboard, typed, value):
    dashboard.type("Ky", typed)
    assert float(dashboard.box("Ky").input_value().replace(",", "")) == value
    assert shown(dashboard)[0] == km_h(bogie, Ky=value)[0]
    assert 0 < int(dashboard.slider("Ky").input_value()) <= 400
    dashboard.slider("Ky").press("ArrowLeft")
    dashboard.settle()
    assert float(dashboard.box("Ky").input_value().replace(",", "")) < value


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("abc", "“abc” is not a number"),
        ("-5", "Ky must be > 0 N/m, got -5.0"),
        ("1,5", "write a point for decimals"),
        ("", "a number is missing"),
    ],
)
def test_rubbish_is_refused_beside_the_box_and_the_page_lives_on(dashboard, typed, words):
    before = shown(dashboard)
    dashboard.type("Ky", typed)
    assert words in dashboard.refusal("Ky").inner_text()
    assert "Still 86,700 N/m" in dashboard.refusal("Ky").inner_text()
    expect(dashboard.page.locator(".tip.shown")).to_have_count(0)  # it would cover that
    assert shown(dashboard) == before
    dashboard.type("m_w", "1500")
    assert shown(dashboard) == km_h(bogie, m_w=1500.0)
    dashboard.type("Ky", "9e4")
    assert dashboard.refusal("Ky").inner_text() == ""
    assert shown(dashboard) == km_h(bogie, m_w=1500.0, Ky=9e4)


def test_units_can_be_those_of_engineers_and_nothing_else_changes(dashboard):
    dashboard.choose("kN, mm, t")
    shown_values = {"Ky": "86.7", "delta": "9.23", "m_B": "45", "C2": "−905", "lam": "0.05"}
    for name, value in shown_values.items():
        assert dashboard.box(name).input_value() == value
    assert "kN/m" in dashboard.row("Ky").inner_text()
    assert shown(dashboard) == km_h(bogie)
    assert not dashboard.page.locator(".row.changed").count()
    dashboard.type("Ky", "100")
    assert shown(dashboard) == km_h(bogie, Ky=1e5)
    dashboard.type("Ky", "-1")
    assert "Ky must be > 0 kN/m, got -1.0. Still 100 kN/m." in dashboard.refusal("Ky").inner_text()
    dashboard.slider("Ky").press("ArrowRight")
    dashboard.settle()
    assert 100 < float(dashboard.box("Ky").input_value()) < 103
    dashboard.page.wait_for_url("**/*units=engineering")
    dashboard.choose("SI")
    assert float(dashboard.box("Ky").input_value().replace(",", "")) > 1e5


def test_a_changed_parameter_is_marked_and_goes_back_with_one_click(dashboard):
    assert "changed" not in dashboard.row("m_w").get_attribute("class")
    dashboard.type("m_w", "2000")
    assert "changed" in dashboard.row("m_w").get_attribute("class")
    dashboard.row("m_w").get_by_role("button").click()
    dashboard.settle()
    assert "changed" not in dashboard.row("m_w").get_attribute("class")
    assert shown(dashboard) == km_h(bogie)


def test_all_parameters_go_back_with_one_click(dashboard):
    dashboard.type("m_w", "2000")
    dashboard.type("Cy", "30000")
    dashboard.choose("Put all back")
    assert shown(dashboard) == km_h(bogie)


def test_both_vehicles_are_answered_side_by_side(dashboard):
    dashboard.choose("both")
    assert shown(dashboard, "bogie") == km_h(bogie)
    assert shown(dashboard, "wheelset") == km_h(wheelset)


def test_table_1_has_no_hopf_point_in_words_and_labelled_plots(dashboard):
    dashboard.choose("Table 1 as printed")
    assert "no Hopf point in range" in dashboard.said()
    assert shown(dashboard) == (None, None)
    assert dashboard.canvases_painted() >= PLOTS
    assert "NaN" not in dashboard.page.locator("body").inner_text()
    dashboard.choose("Reconstructed")
    assert shown(dashboard) == km_h(bogie)


def test_the_speed_slider_moves_the_sentence(dashboard):
    dashboard.type("V", "100")
    assert "is safe" in dashboard.said()
    dashboard.type("V", "160")
    assert "hunts by itself" in dashboard.said()


def test_a_flood_of_moves_ends_at_its_last_value_and_rebuilds_nothing(dashboard):
    dashboard.slider("Ky").press("ArrowRight")
    dashboard.settle()
    models = dashboard.models()
    nodes = "() => document.querySelectorAll('*').length"
    before = dashboard.count(nodes)
    dashboard.page.evaluate(
        """async () => {
          const find = (root) => {
            for (const node of root.querySelectorAll("*")) {
              if (node.matches("input[type=range][data-name=Ky]")) return node;
              const found = node.shadowRoot && find(node.shadowRoot);
              if (found) return found;
            }
            return null;
          };
          const slider = find(document);
          for (let i = 0; i < 120; i += 1) {
            slider.value = 60 + 2 * i;
            slider.dispatchEvent(new Event("input"));
            await new Promise((resolve) => setTimeout(resolve, 16));
          }
        }"""
    )
    dashboard.settle()
    value = float(dashboard.box("Ky").input_value().replace(",", ""))
    assert value == pytest.approx(1e4 * 100 ** (298 / 400), rel=0.005)
    assert shown(dashboard) == km_h(bogie, Ky=value)
    assert dashboard.models() == models
    assert dashboard.count(nodes) == before


def test_a_link_opens_its_state(open_dashboard):
    dashboard = open_dashboard("?Ky=1e5&vehicle=both&V=150")
    assert shown(dashboard, "wheelset") == km_h(wheelset, Ky=1e5)
    assert "150 km/h" in dashboard.said()
    assert dashboard.page.url.endswith("?Ky=100000&V=150&vehicle=both")


def test_rubbish_in_a_link_is_refused_in_words_and_the_rest_counts(open_dashboard):
    dashboard = open_dashboard("?Ky=abc&m_w=1500&nonsense=1")
    notices = dashboard.page.locator(".notices")
    assert "Ky: “abc” is not a number" in notices.inner_text()
    assert "nonsense" in notices.inner_text()
    assert shown(dashboard) == km_h(bogie, m_w=1500.0)
    assert dashboard.page.url.endswith("/?m_w=1500")
    notices.get_by_role("button").click()
    dashboard.settle()
    assert notices.inner_text() == ""


def test_the_address_follows_when_the_hand_rests_and_back_goes_back(dashboard):
    dashboard.type("Ky", "1e5")
    dashboard.page.wait_for_url("**/?Ky=100000")
    dashboard.type("m_w", "1500")
    dashboard.page.wait_for_url("**/?m_w=1500&Ky=100000")
    dashboard.page.go_back()
    dashboard.page.wait_for_timeout(600)
    assert shown(dashboard) == km_h(bogie, Ky=1e5)
    assert dashboard.page.url.endswith("/?Ky=100000")


def test_dark_is_remembered(dashboard):
    dashboard.choose("☾ Dark")
    assert dashboard.page.get_by_text("☀ Light").is_visible()
    dashboard.open()
    assert dashboard.page.get_by_text("☀ Light").is_visible()
    paper = "() => Bokeh.documents[0].get_model_by_name('bifurcation').background_fill_color"
    assert dashboard.count(paper) == "#15191f"


def test_a_visitor_who_prefers_dark_gets_dark(open_dashboard):
    dashboard = open_dashboard(color_scheme="dark")
    dashboard.page.get_by_text("☀ Light").wait_for()


def test_the_root_locus_takes_the_place_of_the_damping_ratio(dashboard):
    dashboard.choose("Root locus")
    visible = "n => Bokeh.documents[0].get_model_by_name(n).visible"
    assert dashboard.page.evaluate(visible, "locus")
    assert not dashboard.page.evaluate(visible, "damping")


def test_all_plots_fit_a_screen_of_1440_by_900(dashboard):
    size = dashboard.count(
        "() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    assert size == [1440, 900]
    for name in ("diagram", "portraits", "stability"):
        box = dashboard.page.locator(f".card.{name}").bounding_box()
        assert box["x"] + box["width"] <= 1440
        assert box["y"] + box["height"] <= 900


def test_on_a_phone_the_sliders_are_folded_away(open_dashboard):
    dashboard = open_dashboard(viewport={"width": 390, "height": 844})
    assert not dashboard.slider("Ky").is_visible()
    assert dashboard.slider("V").is_visible()
    assert dashboard.count("() => document.documentElement.scrollWidth") <= 390
    dashboard.page.get_by_text("Parameters", exact=True).click()
    assert dashboard.slider("Ky").is_visible()


def test_everything_is_reached_by_keyboard(dashboard):
    reached = set()
    for _ in range(170):
        dashboard.page.keyboard.press("Tab")
        reached.add(
            dashboard.count(
                """() => {
                  let node = document.activeElement;
                  while (node?.shadowRoot?.activeElement) node = node.shadowRoot.activeElement;
                  const name = node?.dataset?.name;
                  return name ? `${node.type} ${name}` : node?.textContent;
                }"""
            )
        )
    for field in Parameters.fields():
        assert {f"range {field.name}", f"text {field.name}"} <= reached
    assert {"Model", "Damping ratio", "Root locus"} <= reached


def test_the_model_page_shows_equations_misprints_and_presets(dashboard):
    dashboard.page.get_by_role("button", name="Model").click()
    page = dashboard.page
    page.get_by_role("heading", name="The model").wait_for()
    assert page.locator(".formula").count() >= 13
    misprints = page.locator("section", has_text="Where the paper cannot be right").locator(
        "tbody tr"
    )
    assert misprints.count() == 14
    presets = page.locator("section", has_text="how it was reconstructed").locator("tbody tr")
    assert presets.count() == 22
    assert re.search(r"\?page=model$", page.url)


def test_the_picture_in_the_readme_is_this_page(open_dashboard):
    dashboard = open_dashboard("?vehicle=both")
    dashboard.page.wait_for_timeout(500)
    picture = ROOT / "docs" / "explore.png"
    picture.parent.mkdir(exist_ok=True)
    dashboard.page.screenshot(path=picture)
    assert picture.stat().st_size > 50_000
