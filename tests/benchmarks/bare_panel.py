"""Yardstick: a Panel page with as many sliders and nothing else."""

from __future__ import annotations

import panel as pn

pn.extension()
sliders = [pn.widgets.FloatSlider(label=f"p{i}", start=0, end=5, value=1) for i in range(23)]
pn.Column(*sliders).servable(title="bare")
