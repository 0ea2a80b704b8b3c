"""The program against independent programs: AUTO-07p, SciPy's Radau, references, closed forms.

Run it by ``make verify``. One file per yardstick; each has one function ``rows``.
"""

from __future__ import annotations
