"""The Study page in a real browser, and the pool its work runs in."""

from __future__ import annotations

import re
import time

import pytest

from hunting_app.study.jobs import Workers

LONG = 90_000  # ms; a loaded machine starts processes slowly


@pytest.fixture
def study(served, page):
    page.set_default_timeout(LONG)
    page.goto(f"{served.url}/app?page=study")
    wait_for_the_figures(page)
    return page


def wait_for_the_figures(page):
    """Tornado complains of a page that goes while it is being drawn on."""
    page.get_by_text(re.compile(r"of the paper’s \d+ statements hold")).wait_for()


def turn_to(study, section):
    study.get_by_role("button", name=section, exact=True).click()


def saved(study, download):
    with study.expect_download() as made:
        download.click()
    return made.value.path().read_text(encoding="utf-8")


def test_the_page_is_made_when_it_is_first_opened(served, page):
    page.set_default_timeout(LONG)
    page.goto(f"{served.url}/app")
    page.get_by_role("button", name="Study", exact=True).wait_for()
    assert page.get_by_text("Studied here").count() == 0
    page.get_by_role("button", name="Study", exact=True).click()
    wait_for_the_figures(page)
    assert not page.get_by_text("Phase portraits").first.is_visible()


def test_figures_come_with_their_verdicts_and_as_csv(study):
    assert study.get_by_role("img", name=re.compile(r"^Fig\. \d+: ")).count() == 11
    verdict = study.get_by_text("a heavier wheelset lowers the linear speed")
    assert re.search(r"(Holds|Does not hold).*curves fall", verdict.inner_text())
    text = saved(study, study.get_by_text("Download CSV").nth(1))
    assert text.startswith("# Fig. 4: wheelset mass\n")
    assert "# bogie-hunting " in text
    assert "# I_wx = 625.7 kg m² (yaw inertia)" in text
    assert "m_w [kg]" in text
    assert "V_nl [km/h]" in text
    assert len([line for line in text.splitlines() if not line.startswith("#")]) == 1 + 5 * 41


def test_a_long_map_shows_progress_and_can_be_cancelled(study):
    turn_to(study, "Map")
    study.get_by_label("method").select_option("exact limit cycles")
    study.get_by_label("resolution").select_option("200 × 200 points")
    turn_to(study, "Compute the map")
    study.get_by_text("of 40,000 points").wait_for()
    assert study.get_by_role("progressbar", name="progress").count()
    turn_to(study, "Cancel")
    study.get_by_text("Cancelled.").wait_for()


def test_a_click_on_the_map_takes_that_design_to_explore(study):
    turn_to(study, "Map")
    study.get_by_label("resolution").select_option("25 × 25 points")
    turn_to(study, "Compute the map")
    study.get_by_text(re.compile("km/h, by averaging")).wait_for()
    chart = study.get_by_role("img", name=re.compile("^Map of the"))
    chart.wait_for()
    box = chart.bounding_box()
    study.wait_for_timeout(1500)
    study.mouse.click(box["x"] + 0.3 * box["width"], box["y"] + 0.3 * box["height"])
    study.wait_for_url(re.compile(r"lam=.*Ky="))
    assert "page=study" not in study.url
    assert study.get_by_text("Phase portraits").first.is_visible()


def test_a_design_for_a_wanted_speed_is_found(study):
    turn_to(study, "Design target")
    turn_to(study, "Find the smallest change")
    study.get_by_text("160.0 km/h is reached").wait_for()
    turn_to(study, "Take this design to Explore")
    study.wait_for_url(re.compile("Kpsi="))


def _nap(mark):
    time.sleep(0.05)
    return mark


def test_lines_take_turns():
    workers = Workers(1)
    first, second = workers.line(), workers.line()
    order = []
    long = [first.submit(_nap, "long") for _ in range(6)]
    short = second.submit(_nap, "short")
    for future in [*long, short]:
        future.add_done_callback(lambda done: order.append(done.result()))
    for future in [*long, short]:
        future.result(60)
    assert order.index("short") <= 2


def test_what_is_cancelled_is_never_begun():
    workers = Workers(1)
    line = workers.line()
    futures = [line.submit(_nap, number) for number in range(4)]
    assert futures[-1].cancel()
    assert [future.result(60) for future in futures[:3]] == [0, 1, 2]
