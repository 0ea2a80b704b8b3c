"""What Panel leaves to the app between server and browser."""

from __future__ import annotations

from typing import TYPE_CHECKING

import panel as pn
from panel.io.resources import LOCAL_DIST

if TYPE_CHECKING:
    from bokeh.document import Document


def send_at_once() -> None:
    """Switch off Nagle's algorithm on this session's websockets.

    Bokeh writes one update as many small frames. With Nagle's algorithm the last of them waits
    until the browser has acknowledged the first, up to 40 ms. Bokeh has no setting for it; the
    way to the sockets is the one Panel takes. In a notebook there are none.
    """
    context = pn.state.curdoc.session_context if pn.state.curdoc else None
    session = getattr(context, "session", None)
    for connection in getattr(session, "_subscribed_connections", ()):
        connection._socket.set_nodelay(True)


def style_from_this_server(doc: Document) -> None:
    """Let a session's style sheets come from the server it runs on.

    Panel names those on its CDN and changes that when it writes the page. With several processes
    the websocket may meet another one than the page did, which never writes one.
    """
    above = f"{pn.state.rel_path}/" if pn.state.rel_path else ""
    doc.template_variables["dist_url"] = above + LOCAL_DIST
