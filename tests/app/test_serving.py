"""``panel serve app`` in the ways people serve it."""

from __future__ import annotations

import pytest

V_LIN = "linear critical speed"


@pytest.mark.parametrize(
    ("arguments", "path"),
    [
        ((), "/app"),
        (("--prefix", "/rail"), "/rail/app"),
        (("--index", "app", "--num-procs", "2"), "/"),
        (("--index", "app", "--num-threads", "2"), "/"),
    ],
    ids=["plain", "prefix", "num-procs", "num-threads"],
)
def test_the_dashboard_lives_and_moves(serve, open_dashboard, arguments, path):
    server = serve(*arguments)
    for _ in range(3):  # with two processes, page and websocket meet different ones
        dashboard = open_dashboard("", url=server.url + path)
        before = dashboard.answer(V_LIN)
        dashboard.type("Ky", "1e5")
        assert dashboard.answer(V_LIN) > before
    server.stop()
