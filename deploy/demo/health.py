"""Ask the running demo whether it answers: ends with 0 if so, with 1 if not."""

from __future__ import annotations

import os
import sys
import urllib.request

from demo.settings import Settings


def main() -> None:
    """Ask for /liveness on this machine."""
    settings = Settings.read(os.environ)
    url = f"http://127.0.0.1:{settings.port}{settings.prefix}/liveness"
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    try:
        opener.open(url, timeout=4).close()
    except OSError as error:
        sys.exit(f"{url}: {error}")


if __name__ == "__main__":
    main()
