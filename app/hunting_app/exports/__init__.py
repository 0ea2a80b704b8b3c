"""Files to take away: the curves as tables, the plots as pictures, everything as one report."""

from __future__ import annotations
