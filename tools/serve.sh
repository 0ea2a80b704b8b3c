#!/bin/sh
# Serve the dashboard on this machine only and, where there is a screen, open it in a browser.
set -eu
port=${PORT:-5006}
url=http://localhost:$port

show=
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}${BROWSER:-}" ] || [ "$(uname)" = Darwin ]; then
    show=--show
fi
echo "==> serving the dashboard at $url (Ctrl+C stops it)"
exec "${VENV:-.venv}/bin/python" -m panel serve app --index app $show --address 127.0.0.1 --port "$port" \
    --allow-websocket-origin "localhost:$port" --allow-websocket-origin "127.0.0.1:$port"
