"""The smallest change of the design that reaches a wanted speed."""

from __future__ import annotations

from concurrent.futures import Executor
from html import escape
from typing import Any

import holoviews as hv
import numpy as np

from hunting.cases import Progress
from hunting.design import Design, design
from hunting.tables import header, rows
from hunting_app.numerals import written
from hunting_app.palette import Palette
from hunting_app.picture import KMH
from hunting_app.state import FIELDS
from hunting_app.study.bars import bars, height_of
from hunting_app.study.choices import number, ticks
from hunting_app.study.dress import shown
from hunting_app.study.section import Section, part


class Target(Section):
    """A design with a wanted nonlinear critical speed."""

    key = "design"
    label = "Design target"
    call = "Find the smallest change"
    things = "steps"
    explained = (
        "Say which nonlinear critical speed V<sub>nl</sub> you want and which parameters may "
        "change. The answer is the design with that speed whose relative changes are the smallest "
        "(the least sum of their squares) – or, if the target is out of reach, the nearest "
        "there is."
    )

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.speed = number("wanted V_nl [km/h]", 160.0, 1.0, 1440.0, 5.0)
        self.most = number("largest change, ± [%]", 50.0, 1.0, 95.0, 5.0)
        self.names = ticks("parameters that may change", ["Ky", "Cy", "Kpsi", "C1"])
        self.controls[:] = [self.speed, self.most, self.names]

    def ask(self) -> None:
        """Take target and limits from the boxes."""
        if not self.names.value or not self.speed.value or not self.most.value:
            raise ValueError("Give a speed, a largest change, and tick at least one parameter.")
        share = np.array([-1.0, 1.0]) * self.most.value / 100
        self.free = {}
        for name in self.names.value:
            low, high = np.sort(getattr(self.parameters, name) * (1 + share)).tolist()
            self.free[name] = (low, high)
        self.wanted = self.speed.value / KMH

    def work(self, executor: Executor, _progress: Progress) -> Any:
        """Ask the model."""
        return executor.submit(design, self.model, self.parameters, self.free, self.wanted).result()

    def draw(self) -> None:
        """Draw the changes and say what they reach."""
        found = self.result
        order = _by_size(found)
        chart = change_bars(found, self.colours)
        self.body[:] = [part("plot", shown(chart, height_of(chart)))]
        V, wanted = KMH * found.V_nonlinear, KMH * found.target
        verdict = (
            f"<b>{wanted:.1f} km/h is reached</b>"
            if found.reached
            else f"<b>{wanted:.1f} km/h is out of reach</b> within these limits; the nearest is"
        )
        lines = "".join(
            f"<tr><th>{escape(FIELDS[n].label)} {FIELDS[n].symbol}</th>"
            f"<td>{written(getattr(self.parameters, n))}</td>"
            f"<td>{written(float(f'{getattr(found.parameters, n):.5g}'))}</td>"
            f"<td>{escape(FIELDS[n].unit)}</td><td>{_signed(100 * found.changes[n])} %</td></tr>"
            for n in order
        )
        self.said.html = (
            f"<p>{verdict}: V<sub>nl</sub> = {V:.2f} km/h.</p><table><tr><th>parameter</th>"
            f"<th>now</th><th>proposed</th><th>unit</th><th>change</th></tr>{lines}</table>"
            "<p><button data-act='{\"take\": true}'>Take this design to Explore</button></p>"
        )

    def clicked(self, act: dict[str, Any]) -> None:
        """Take the proposed values to the sliders."""
        if act.get("take") and self.result is not None:
            found = {n: float(getattr(self.result.parameters, n)) for n in self.result.changes}
            self.act({"values": {n: float(f"{value:.7g}") for n, value in found.items()}})
            self.act({"page": "explore"})

    def csv(self) -> str:
        """Return the values before and after."""
        found, names = self.result, list(self.result.changes)
        title = f"smallest change for V_nl = {KMH * found.target:.6g} km/h: {found.message}"
        return header(title, self.vehicle, "harmonic_balance", self.parameters, set()) + rows(
            {
                "parameter": names,
                "now": [getattr(self.parameters, n) for n in names],
                "proposed": [getattr(found.parameters, n) for n in names],
                "unit": [FIELDS[n].unit for n in names],
                "lowest": [self.free[n][0] for n in names],
                "highest": [self.free[n][1] for n in names],
                "change [%]": [100 * found.changes[n] for n in names],
            }
        )


def change_bars(found: Design, colours: Palette) -> hv.Overlay:
    """Return how much each parameter changes, the most on top."""
    order = _by_size(found)
    labels = [f"{FIELDS[name].label}  {FIELDS[name].symbol}" for name in order]
    changes = 100 * np.array([found.changes[name] for name in order])
    axis = "change of the parameter [%]"
    return bars(labels, {"change": (changes, colours.bogie)}, axis, colours, "change")


def _by_size(found: Design) -> list[str]:
    return sorted(found.changes, key=lambda name: -abs(found.changes[name]))


def _signed(percent: float) -> str:
    return f"{percent:+.2f}".replace("-", "−")
