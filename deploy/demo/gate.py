"""What is let in: a Bokeh server with the dashboard at its root that refuses what is no visit."""

from __future__ import annotations

import time
from collections import deque
from typing import TYPE_CHECKING, Any

from bokeh.server.tornado import BokehTornado
from bokeh.util.token import get_session_id
from tornado.web import OutputTransform, RequestHandler

from demo.log import LOG
from demo.settings import Settings, origin

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bokeh.application import Application
    from tornado.httputil import HTTPHeaders, HTTPMessageDelegate, HTTPServerRequest

KIB = 1024
LONGEST_ADDRESS = 4 * KIB  # a link with every parameter changed has some 600 characters
LARGEST_MESSAGE = 256 * KIB  # a slider's move is some 300 bytes
WAIT = 5  # s
GONE = 60  # s after which someone let in has gone away without a session
MOST_COMING = 10  # a new session takes a third of a second, in which those inside wait
AGAIN = f"This page tries again by itself every {WAIT} seconds; the values in its address are kept."
# Bokeh compiles callbacks in the browser and Panel imports components from blobs.
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; "
    "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; "
    "connect-src 'self' blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'none'",
    "Referrer-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
}
PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark">
{again}
<title>bogie hunting</title>
<style>body {{ max-width: 32em; margin: 20vh auto; padding: 0 1em; font: 1.1em system-ui }}</style>
<h1>bogie hunting</h1>
<p>{said}</p>
</html>
"""


class Gate(BokehTornado):  # type: ignore[misc]
    """Serves one application; knows how many visitors there are and who may not come in."""

    def __init__(self, application: Application, settings: Settings) -> None:
        self.chosen = settings
        # When those were let in whose session has not begun: many may arrive in one moment.
        self._coming: deque[float] = deque()
        super().__init__(
            {"/": application},
            prefix=settings.prefix,
            extra_patterns=[(r"/liveness", Liveness)],
            # Whose websockets are taken is decided in `refusal`.
            extra_websocket_origins=["*"],
            # Nothing of the visitor goes into the session but the choice of light or dark.
            include_headers=[],
            include_cookies=["hunting-dark"],
            # Who comes back later gets a new session from the address.
            unused_session_lifetime_milliseconds=5000,
            check_unused_sessions_milliseconds=1000,
            websocket_max_message_size_bytes=LARGEST_MESSAGE,
            # A visitor who reads nothing any more is sent away.
            websocket_ping_interval=20,
            websocket_ping_timeout=20,
            transforms=[ExtraHeaders],
            log_function=lambda handler: None,
        )

    @property
    def visitors(self) -> int:
        """How many sessions there are, those included whose page is still loading."""
        return sum(len(self.get_sessions(path)) for path in self.app_paths)

    def find_handler(self, request: HTTPServerRequest, **kwargs: Any) -> HTTPMessageDelegate:
        """Return what answers a request: the usual handler, or a refusal."""
        if refused := self.refusal(request):
            status, said = refused
            return self.get_handler_delegate(request, Refusal, {"status": status, "said": said})
        return super().find_handler(request, **kwargs)

    def refusal(self, request: HTTPServerRequest) -> tuple[int, str] | None:
        """Return why a request is refused, as status and words, or None."""
        place = request.path.removeprefix(self.prefix)
        if request.method not in ("GET", "HEAD"):
            return 405, "Nothing can be sent here."
        if len(request.uri or "") > LONGEST_ADDRESS:
            return 414, "This address is too long."
        if place in ("/autoload.js", "/metadata"):
            return 404, "There is nothing here."
        if place == "/ws" and not self._has_allowed_origin(request.headers):
            LOG.warning("refused: a websocket from a page of another origin")
            return 403, "Pages of other origins may not use this demo."
        if place in ("", "/"):
            return self._no_room(self.chosen.session_limit, MOST_COMING)
        if place == "/ws" and not self._has_session(request):
            # Another replica let this page in: it is not to be left without its data.
            most = self.chosen.session_limit + MOST_COMING
            return self._no_room(most, most)
        return None

    def _no_room(self, limit: int, most_coming: int) -> tuple[int, str] | None:
        while self._coming and self._coming[0] < time.monotonic() - GONE:
            self._coming.popleft()
        sessions = self.get_sessions("/")
        if len(sessions) + len(self._coming) >= limit:
            LOG.warning("refused: all %d places are taken", limit)
            return 503, f"All {limit} places of this demo are taken just now. {AGAIN}"
        loading = sum(session.connection_count == 0 for session in sessions)
        if loading + len(self._coming) >= most_coming:
            LOG.warning("refused: %d pages are still loading", most_coming)
            return 503, f"Many visitors are coming in at this moment. {AGAIN}"
        self._coming.append(time.monotonic())
        return None

    def has_come(self) -> None:
        """Take note that a session begins for someone who was let in."""
        if self._coming:
            self._coming.popleft()

    def _has_allowed_origin(self, headers: Mapping[str, str]) -> bool:
        came_from = headers.get("Origin")
        if came_from is None:  # no browser: they always say
            return True
        try:
            came_from = origin(came_from)
        except ValueError:
            return False
        if self.chosen.allowed_origins:
            return came_from in self.chosen.allowed_origins
        return came_from in {origin(f"{s}://{headers.get('Host')}") for s in ("http", "https")}

    def _has_session(self, request: HTTPServerRequest) -> bool:
        """Say whether a websocket belongs to a page that has been let in."""
        token = request.headers.get("Sec-WebSocket-Protocol", "").rpartition(",")[2].strip()
        try:
            wanted = get_session_id(token)
        except Exception:  # whatever it is, it is no token
            return False
        return any(session.id == wanted for session in self.get_sessions("/"))


class Liveness(RequestHandler):
    """Says that the server answers."""

    def get(self) -> None:
        """Answer with a word."""
        self.write({"alive": True})


class Refusal(RequestHandler):
    """A page that says in words why there is nothing else."""

    def initialize(self, status: int, said: str) -> None:
        """Keep what the page will say."""
        self.status, self.said = status, said

    def prepare(self) -> None:
        """Answer, whatever the method."""
        self.set_status(self.status)
        self.set_header("Cache-Control", "no-store")
        again = ""
        if self.status == 503:
            self.set_header("Retry-After", str(WAIT))
            again = f'<meta http-equiv="refresh" content="{WAIT}">'
        self.finish(PAGE.format(again=again, said=self.said))


class ExtraHeaders(OutputTransform):
    """Adds what browsers shall keep to, and leaves out which program this is."""

    def transform_first_chunk(
        self, status_code: int, headers: HTTPHeaders, chunk: bytes, finishing: bool
    ) -> tuple[int, HTTPHeaders, bytes]:
        """Change the headers of a response."""
        headers.update(HEADERS)
        headers.pop("Server", None)
        return status_code, headers, chunk
