"""The settings of the demo: from the environment, checked."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

if TYPE_CHECKING:
    from collections.abc import Mapping

_PREFIX = re.compile(r"(/[A-Za-z0-9._~-]+)*")
_ORIGIN = re.compile(r"https?://([A-Za-z0-9.-]+|\[[0-9A-Fa-f:]+\])(:[0-9]{1,5})?")
_USUAL_PORTS = {"http": 80, "https": 443}


@dataclass(frozen=True)
class Settings:
    """What whoever runs the demo may choose.

    Attributes
    ----------
    port : int
        The TCP port to listen on.
    prefix : str
        What every path begins with: ``""`` or, say, ``"/hunting"``.
    allowed_origins : frozenset of str
        The origins whose pages may open a websocket; empty: only the demo's own page, under
        whichever address it was reached.
    session_limit : int
        How many visitors there may be at once.
    """

    port: int = 5006
    prefix: str = ""
    allowed_origins: frozenset[str] = frozenset()
    session_limit: int = 50

    @classmethod
    def read(cls, environment: Mapping[str, str]) -> Settings:
        """Return the settings that environment variables ask for; empty ones leave defaults.

        Raises
        ------
        ValueError
            If a variable has a value that is not allowed, naming both.

        Examples
        --------
        >>> Settings.read({"PREFIX": "/hunting", "SESSION_LIMIT": "30"}).prefix
        '/hunting'
        """
        set_ones = {name: value.strip() for name, value in environment.items() if value.strip()}
        return cls(
            port=_whole_number(set_ones, "PORT", cls.port, 65535),
            prefix=_prefix(set_ones.get("PREFIX", "")),
            allowed_origins=_origins(set_ones.get("ALLOWED_ORIGINS", "")),
            session_limit=_whole_number(set_ones, "SESSION_LIMIT", cls.session_limit, 10_000),
        )


def origin(text: str) -> str:
    """Return ``scheme://host[:port]`` in the one way a browser writes it.

    Examples
    --------
    >>> origin("HTTPS://Demo.Example.org:443")
    'https://demo.example.org'
    """
    parts = urlsplit(text.lower())
    port = "" if parts.port in (None, _USUAL_PORTS.get(parts.scheme)) else f":{parts.port}"
    host = f"[{parts.hostname}]" if ":" in (parts.hostname or "") else parts.hostname
    return f"{parts.scheme}://{host}{port}"


def _whole_number(environment: Mapping[str, str], name: str, default: int, most: int) -> int:
    text = environment.get(name, str(default))
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:9]) <= most):
        raise ValueError(f"{name} must be a whole number from 1 to {most}, got {text[:40]!r}")
    return int(text)


def _prefix(text: str) -> str:
    prefix = text.rstrip("/")
    if not _PREFIX.fullmatch(prefix):
        raise ValueError(
            "PREFIX must begin with / and hold letters, digits and . _ ~ - / only, such as "
            f"/hunting, got {text[:40]!r}"
        )
    return prefix


def _origins(text: str) -> frozenset[str]:
    entries = [entry.strip().rstrip("/") for entry in text.split(",") if entry.strip()]
    for entry in entries:
        port = entry.rpartition(":")[2] if _ORIGIN.fullmatch(entry.lower()) else "-"
        if port == "-" or (port.isdigit() and not 1 <= int(port) <= 65535):
            raise ValueError(
                "ALLOWED_ORIGINS must be origins with commas between them, such as "
                f"https://demo.example.org,http://localhost:8080, got {entry[:60]!r}"
            )
    return frozenset(map(origin, entries))
