"""The parts of the Study page: each asks the model for one kind of study and draws it."""

from __future__ import annotations
