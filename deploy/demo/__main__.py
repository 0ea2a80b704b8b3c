"""Serve the dashboard: ``python -m demo``, with its settings in the environment."""

from __future__ import annotations

import asyncio
import os
import resource
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import panel as pn
from bokeh.application.handlers.handler import Handler
from bokeh.events import ConnectionLost
from bokeh.models import CustomJS
from bokeh.server.server import BaseServer
from panel.io.application import build_applications
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop

from demo.gate import KIB, LARGEST_MESSAGE, Gate
from demo.log import LOG, start_logging
from demo.settings import Settings
from hunting_app import dashboard

if TYPE_CHECKING:
    from bokeh.application.application import SessionContext
    from bokeh.document import Document

LOST = (Path(__file__).parent / "lost.js").read_text(encoding="utf-8")
TITLE = "bogie hunting"


def page() -> pn.viewable.Viewable:
    """Return the dashboard of one visitor, which loads anew when its connection is lost."""
    document: Document = pn.state.curdoc
    # Bokeh would go on with the values the page was loaded with, or not at all.
    document.config.update(
        reconnect_session=False, notifications=None, notify_connection_status=False
    )
    document.js_on_event(ConnectionLost, CustomJS(code=LOST))
    try:
        return dashboard()
    except Exception:  # Panel would show, and print, the traceback
        LOG.exception("the dashboard did not start")
        return pn.Column("The dashboard could not be started. Please tell who runs it.")


class Visits(Handler):  # type: ignore[misc]
    """Logs when visitors come and go."""

    gate: Gate

    def modify_document(self, doc: Document) -> None:
        """Change nothing."""

    async def on_session_created(self, session_context: SessionContext) -> None:
        """Log that one came, and tell the gate."""
        self.gate.has_come()
        LOG.info("session opened, %d before it", self.gate.visitors)

    async def on_session_destroyed(self, session_context: SessionContext) -> None:
        """Log that one is gone."""
        LOG.info("session closed, %d left", self.gate.visitors)


def serve(settings: Settings) -> None:
    """Serve until SIGTERM or SIGINT."""
    (application,) = build_applications(page, title=TITLE).values()
    application.add(visits := Visits())
    visits.gate = gate = Gate(application, settings)
    http = HTTPServer(
        gate,
        max_header_size=16 * KIB,
        max_body_size=0,
        max_buffer_size=2 * LARGEST_MESSAGE,
        idle_connection_timeout=30,
        body_timeout=5,
    )
    http.listen(settings.port)
    server = BaseServer(IOLoop.current(), gate, http)
    server.start()
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_event_loop().add_signal_handler(number, server.io_loop.stop)
    LOG.info(
        "serving at port %d, prefix %s, origins %s, at most %d sessions",
        settings.port,
        settings.prefix or "/",
        ", ".join(sorted(settings.allowed_origins)) or "its own only",
        settings.session_limit,
    )
    server.io_loop.start()
    LOG.info("stopped, %d sessions open", gate.visitors)


def main() -> None:
    """Read and check the settings, then serve."""
    start_logging()
    try:
        settings = Settings.read(os.environ)
    except ValueError as refusal:
        sys.exit(f"error: {refusal}")
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(most, 65536), most))
    serve(settings)
    # A computation may still be running; its visitors are gone.
    os._exit(0)


if __name__ == "__main__":
    main()
