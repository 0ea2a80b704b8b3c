#!/bin/sh
# Serve the dashboard on this machine only and, where there is a screen, open it in a browser.
set -eu
python=${VENV:-.venv}/bin/python
port=${PORT:-5006}
url=http://localhost:$port

echo "==> serving the dashboard at $url (Ctrl+C stops it)"
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}${BROWSER:-}" ] || [ "$(uname)" = Darwin ]; then
    "$python" tools/open_page.py "$url" &
fi
exec "$python" -m panel serve app --index app --liveness --address 127.0.0.1 --port "$port" \
    --allow-websocket-origin "localhost:$port" --allow-websocket-origin "127.0.0.1:$port"
