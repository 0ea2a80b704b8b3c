"""The web demo behind nginx: prefixes and links."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

from tests.container.conftest import Demo
from tests.container.test_demo import opened, slider

if TYPE_CHECKING:
    from tests.conftest import NewPage

pytestmark = pytest.mark.skipif(
    shutil.which("nginx") is None, reason="nginx is not installed (Debian: nginx-light)"
)
Start = Callable[..., Demo]
Proxy = Callable[..., str]


@pytest.mark.parametrize(("prefix", "path"), [("/hunting", "/hunting/"), ("", "/demo/"), ("", "/")])
def test_page_websocket_link_and_downloads_work_behind_a_prefix(
    prefix: str, path: str, demo: Start, proxy: Proxy, new_page: NewPage
) -> None:
    served = demo(PREFIX=prefix)
    url = proxy(served)
    page = opened(new_page(), f"{url}{path}?vehicle=both")
    slider(page)
    assert page.url.startswith(f"{url}{path}?")
    link = page.url
    (Ky,) = re.findall(r"Ky=(\d+)", link)
    again = opened(new_page(), link)
    assert again.locator("input[type=text][data-name=Ky]").input_value() == f"{int(Ky):,}"
    assert again.locator("input[value=both]").is_checked()
    for kind, begins in (("csv", "# "), ("report", "<!DOCTYPE html>")):
        again.get_by_label("download the bifurcation diagram", exact=True).press("Enter")
        with again.expect_download() as download:
            again.locator(f"details[open] [data-kind={kind}]").press("Enter")
        assert download.value.path().read_text(encoding="utf-8").startswith(begins)
