"""Yardstick: a Bokeh page without Panel, as many sliders and plots, patched with constant data."""

from __future__ import annotations

import os

import numpy as np
from bokeh.io import curdoc
from bokeh.layouts import column, gridplot, row
from bokeh.models import ColumnDataSource, Slider
from bokeh.plotting import figure

SLIDERS, POINTS = 23, 500
PLOTS = int(os.environ["PLOTS"])
X = np.linspace(0, 10, POINTS)
CURVES = [np.sin(X), -np.sin(X)]

sources = [ColumnDataSource({"x": X, "y": CURVES[0]}) for _ in range(PLOTS)]
figures = []
for source in sources:
    plot = figure(width=400, height=270)
    plot.line("x", "y", source=source)
    figures.append(plot)
sliders = [Slider(title=f"p{i}", start=0, end=5, step=0.001, value=1) for i in range(SLIDERS)]
moves = 0


def move(attr, old, new):
    global moves
    moves += 1
    for source in sources:
        source.data = {"x": X, "y": CURVES[moves % 2]}


for slider in sliders:
    slider.on_change("value", move)
curdoc().add_root(row(column(*sliders), gridplot(figures, ncols=2)))
