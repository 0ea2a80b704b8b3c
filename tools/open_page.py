"""Open a page in the browser once its server answers: open_page.py URL.

Panel's own ``--show`` opens two tabs where an app is also the index.
"""

from __future__ import annotations

import sys
import time
import urllib.request
import webbrowser

SECONDS = 60


def main(url: str) -> None:
    """Wait for the server, then open `url`; give up silently, the server says why itself."""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline:
        try:
            urllib.request.urlopen(f"{url}/liveness", timeout=5).close()
        except OSError:
            time.sleep(0.2)
        else:
            webbrowser.open(url)
            return


if __name__ == "__main__":
    main(sys.argv[1])
