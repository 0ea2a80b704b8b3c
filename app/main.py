"""Start of ``panel serve app``: runs once for each session."""

from __future__ import annotations

from hunting_app import dashboard

dashboard().servable(title="bogie hunting")
