"""The figures of the Explore page: built once, afterwards only their data is replaced."""

from __future__ import annotations
