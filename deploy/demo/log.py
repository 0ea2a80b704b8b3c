"""One line an event, and nothing of a visitor in it.

What libraries log may hold addresses, query strings and messages, so of their records only the
place and the kind of trouble are kept.
"""

from __future__ import annotations

import logging
import sys
import time
import traceback
from pathlib import Path

LOG = logging.getLogger("demo")


class OneLine(logging.Formatter):
    """Time, level, event; of a library's record where it came from instead of its text."""

    converter = staticmethod(time.gmtime)
    default_msec_format = "%s.%03dZ"
    default_time_format = "%Y-%m-%dT%H:%M:%S"

    def format(self, record: logging.LogRecord) -> str:
        """Return a record as one line."""
        if record.name == LOG.name:
            said = record.getMessage()
        else:
            said = f"trouble in {record.name}, line {record.lineno}"
        if record.exc_info and record.exc_info[0]:
            frames = traceback.extract_tb(record.exc_info[2])[-4:]
            way = " > ".join(f"{Path(frame.filename).name}:{frame.lineno}" for frame in frames)
            said += f": {record.exc_info[0].__name__} at {way}"
        said = " ".join(said.split())
        return f"{self.formatTime(record)} {record.levelname.lower()} {said}"


class Seldom(logging.Filter):
    """Lets an event that comes again and again through once in ten seconds."""

    def __init__(self) -> None:
        super().__init__()
        self._last: dict[tuple[str, int], float] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        """Say whether a record is logged; what went well always is."""
        place = record.pathname, record.lineno
        if record.levelno < logging.WARNING:
            return True
        if record.created - self._last.get(place, 0) < 10:
            return False
        self._last[place] = record.created
        return True


def start_logging() -> None:
    """Send this program's events and the libraries' warnings to standard output."""
    handler = logging.StreamHandler(sys.stdout)
    handler.setFormatter(OneLine())
    handler.addFilter(Seldom())
    for name in ("panel", "bokeh", "tornado", "asyncio"):
        library = logging.getLogger(name)
        library.handlers.clear()
        library.propagate = True
        library.setLevel(logging.WARNING)
    # Advice on layouts, for developers; and that a visitor left before all was said.
    for name in ("bokeh.core.validation", "bokeh.server.views.ws"):
        logging.getLogger(name).setLevel(logging.ERROR)
    logging.captureWarnings(True)
    logging.basicConfig(handlers=[handler], level=logging.WARNING, force=True)
    LOG.setLevel(logging.INFO)
