"""Small updates leave at once."""

from __future__ import annotations

import panel as pn


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
