"""Numbers as people type and read them."""

from __future__ import annotations

import math
import re

from hunting.display import written as written

_GROUPED = re.compile(r"[+-]?\d{1,3}(,\d{3})+(\.\d*)?([eE][+-]?\d+)?")
_PLAIN = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def parsed(text: str) -> float:
    """Return the number that `text` stands for: ``1.2e5``, ``86,700``, ``86 700``, ``−3``.

    Raises
    ------
    ValueError
        If it is none; the message says in words what is expected.

    Examples
    --------
    >>> parsed("86,700"), parsed("1.2e5"), parsed("−3")
    (86700.0, 120000.0, -3.0)
    >>> parsed("1,5")
    Traceback (most recent call last):
        ...
    ValueError: “1,5” is not clear: write a point for decimals, commas only between thousands
    """
    stripped = text.strip()
    compact = re.sub(r"(?<=\d)[\s'](?=\d{3})", "", stripped).replace("−", "-")
    if _GROUPED.fullmatch(compact):
        return float(compact.replace(",", ""))
    if _PLAIN.fullmatch(compact):
        return float(compact)
    shown = stripped if len(stripped) <= 24 else f"{stripped[:23]}…"
    if re.fullmatch(r"[+-]?[\d.,]*,[\d.,]*", compact):
        raise ValueError(
            f"“{shown}” is not clear: write a point for decimals, commas only between thousands"
        )
    raise ValueError(f"“{shown}” is not a number" if shown else "a number is missing")


def compact(value: float) -> str:
    """Return the shortest text that Python reads back as the same number, for links.

    Examples
    --------
    >>> compact(100000.0), compact(0.05)
    ('100000', '0.05')
    """
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e7 else repr(value)


def rounded_up(value: float) -> float:
    """Return the next of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten: a steady axis end.

    Examples
    --------
    >>> rounded_up(0.23), rounded_up(7.1)
    (0.3, 8.0)
    """
    if not math.isfinite(value) or value <= 0:
        return 1.0
    power: float = 10.0 ** math.floor(math.log10(value))
    steps = (1, 1.5, 2, 3, 4, 5, 6, 8, 10)
    return next((s * power for s in steps if s * power >= value * (1 - 1e-12)), 10 * power)
