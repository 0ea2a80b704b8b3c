"""What Panel leaves to the app between server and browser."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import panel as pn
from panel.io.resources import LOCAL_DIST

if TYPE_CHECKING:
    from collections.abc import Callable
    from concurrent.futures import Executor, Future

    from bokeh.document import Document

T = TypeVar("T")
_WRITTEN = 2  # ms; an update has been written to the socket by then


def open_page() -> Document | None:
    """Return the page that somebody has open; None in a notebook, a script or a test."""
    doc: Document | None = pn.state.curdoc
    return doc if doc and doc.session_context else None


def after(milliseconds: int, work: Callable[[], None]) -> Any:
    """Do something when the page has had that time, and return a handle; at once without a page."""
    doc = open_page()
    return doc.add_timeout_callback(work, milliseconds) if doc else work()


def then(work: Callable[[], None]) -> None:
    """Do something after the update that has just been held and let go.

    At once, as that was written to the socket already; but a thread of ``--num-threads`` may hold
    updates only once, and leaves it to the page's loop.
    """
    if pn.config.nthreads is None:
        work()
    else:
        after(_WRITTEN, work)


def beside(executor: Executor, work: Callable[[], T], then: Callable[[T], None]) -> None:
    """Do work that would stop the page in a thread, `then` something with the result on the page.

    Without a page both are done at once.
    """
    doc = open_page()
    if doc is None:
        then(work())
        return

    def tell(done: Future[T]) -> None:
        doc.add_next_tick_callback(partial(then, done.result()))

    executor.submit(work).add_done_callback(tell)


def send_at_once() -> None:
    """Switch off Nagle's algorithm on this session's websockets.

    Bokeh writes one update as many small frames. With Nagle's algorithm the last of them waits
    until the browser has acknowledged the first, up to 40 ms. Bokeh has no setting for it; the
    way to the sockets is the one Panel takes. In a notebook there are none.
    """
    doc = open_page()
    session = getattr(doc.session_context, "session", None) if doc else None
    for connection in getattr(session, "_subscribed_connections", ()):
        connection._socket.set_nodelay(True)


def style_from_this_server(doc: Document) -> None:
    """Let a session's style sheets come from the server it runs on.

    Panel names those on its CDN and changes that when it writes the page. With several processes
    the websocket may meet another one than the page did, which never writes one.
    """
    above = f"{pn.state.rel_path}/" if pn.state.rel_path else ""
    doc.template_variables["dist_url"] = above + LOCAL_DIST
