"""The Explore page as a widget in a notebook's cell, read and set from Python."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import panel as pn
from bokeh.models import UIElement
from panel.io.notebook import patch_inline_stylesheets
from panel.viewable import Viewer

from hunting import Branch, CriticalSpeeds, Parameters
from hunting_app import notebook
from hunting_app.blocks import block
from hunting_app.picture import KMH, Answers, picture
from hunting_app.session import Session
from hunting_app.state import FIELDS, PRESETS, SPEED, State, with_choice, with_value


def explorer(
    parameters: Parameters | Iterable[str] | None = None,
    *,
    sliders: Iterable[str] | None = None,
    vehicle: str = "bogie",
    speed: float | None = None,
    dark: bool = False,
) -> Explorer:
    """Return the Explore page as a widget for a notebook's cell.

    Parameters
    ----------
    parameters : Parameters, or list of str, optional
        The design to start from, as numbers; or the names of the parameters to put on sliders, of
        the default design.
    sliders : list of str, optional
        Names of the parameters to put on sliders; by default all.
    vehicle : {"bogie", "wheelset", "both"}
        What is drawn.
    speed : float, optional
        The speed to look at first [m/s].
    dark : bool, default False
        Light on dark instead of dark on light.

    Returns
    -------
    Explorer
        Shows itself as the last value of a cell, in JupyterLab and in Notebook. Where only
        ipywidgets are known (VS Code, Colab), show its `ipywidget()`.

    Raises
    ------
    TypeError
        If a name is no parameter.
    ValueError
        If the parameters are arrays, or a value makes no sense.

    Examples
    --------
    >>> from hunting_app import explorer
    >>> widget = explorer(["Ky", "lam"])
    >>> widget.parameters = widget.parameters.replace(Ky=1.2e5)
    >>> print(widget.critical_speeds)
    subcritical: V_nl = 147.84 km/h, V_lin = 162.65 km/h, 2.38 Hz
    """
    if not (parameters is None or isinstance(parameters, Parameters)):
        parameters, sliders = None, parameters
    made = Explorer(sliders, dark)
    made.vehicle = vehicle
    if parameters is not None:
        made.parameters = parameters
    if speed is not None:
        made.speed = speed
    return made


class Explorer(Viewer):
    """The Explore page, what it shows, and what may be set from Python.

    Attributes
    ----------
    state : State
        What is chosen. Watch it to follow the sliders:
        ``explorer.state.param.watch(f, "parameters")``, or ``pn.bind`` on
        ``explorer.state.param.parameters``.
    """

    def __init__(self, sliders: Iterable[str] | None = None, dark: bool = False) -> None:
        super().__init__()
        notebook.load()
        self.state = State(dark=dark)
        self._names = _checked(FIELDS if sliders is None else sliders)
        self._views: list[Session] = []
        shown = ["preset", "parameters", "vehicle", "speed"]
        self.state.param.watch(self._follow, shown, precedence=1)  # after the plots

    @property
    def parameters(self) -> Parameters:
        """The parameters on the sliders; setting them moves sliders and plots."""
        return self.state.parameters

    @parameters.setter
    def parameters(self, parameters: Parameters) -> None:
        if not isinstance(parameters, Parameters):
            raise TypeError(f"parameters must be Parameters, got {type(parameters).__name__}")
        if parameters.shape:
            raise ValueError(f"parameters must be numbers, got arrays of shape {parameters.shape}")
        preset = next((k for k, p in PRESETS.items() if p.parameters == parameters), None)
        self._set(parameters=parameters, **({"preset": preset} if preset else {}))

    @property
    def speed(self) -> float:
        """The chosen forward speed [m/s]: the cursor in the diagrams."""
        return self.state.speed / KMH

    @speed.setter
    def speed(self, speed: float) -> None:
        self._set(**with_value(self.state, SPEED.name, KMH * speed))

    @property
    def vehicle(self) -> str:
        """What is drawn: "bogie", "wheelset" or "both"."""
        return self.state.vehicle

    @vehicle.setter
    def vehicle(self, vehicle: str) -> None:
        self._set(**with_choice("vehicle", vehicle))

    @property
    def critical_speeds(self) -> CriticalSpeeds:
        """The critical speeds shown, of the bogie if both vehicles are; from the exact branch."""
        return self._answers().critical

    @critical_speeds.setter
    def critical_speeds(self, _speeds: CriticalSpeeds) -> None:
        raise AttributeError(
            "critical_speeds follow from the parameters: set those. hunting.design finds "
            "parameters that reach a given nonlinear critical speed"
        )

    @property
    def branch(self) -> Branch:
        """The exact limit cycles shown, of the bogie if both vehicles are."""
        return self._answers().branch

    @branch.setter
    def branch(self, _branch: Branch) -> None:
        raise AttributeError("the branch follows from the parameters: set those")

    def ipywidget(self) -> Any:
        """Return the widget as an ipywidget, for VS Code, Colab and the like.

        Raises
        ------
        ImportError
            If jupyter_bokeh is not installed.
        """
        view = self.__panel__()
        widget = pn.ipywidget(view)
        ((model, _parent),) = view._models.values()
        for part in model.select({"type": UIElement}):
            patch_inline_stylesheets(part)  # those that Panel leaves on its CDN
        widget.update_from_model(model)
        return widget

    def _answers(self) -> Answers:
        chosen = self.state
        shown = picture(chosen.parameters, chosen.vehicle, chosen.speed)
        return next(iter(shown.answers.values()))

    def _set(self, **change: Any) -> None:
        """Change the state if the model can be solved with it, and show it everywhere."""
        trial = {name: getattr(self.state, name) for name in ("parameters", "vehicle", "speed")}
        picture(**trial | {k: v for k, v in change.items() if k in trial}, exact=False)
        self.state.param.update(**change)
        for view in self._views:
            view.explore.run()
            pn.io.push_notebook(view.root)

    def _follow(self, *_events: Any) -> None:
        """Move the sliders of all views; those that a notebook has thrown away are forgotten."""
        self._views = [view for view in self._views if view.root._models]
        for view in self._views:
            view.show()
            pn.io.push_notebook(view.root)

    def __panel__(self) -> pn.viewable.Viewable:
        """Return a new view of the state: an explorer can be shown in several cells."""
        notebook.load()
        view = Session("", self.state, self._names)
        view.explore.view.css_classes = ["parts"]
        view.root = block("cell", block("widget", block("side", view.sidebar), view.explore))
        view.root.styles = {"color-scheme": "dark" if self.state.dark else "light"}
        self._views.append(view)
        return view.root


def _checked(names: Iterable[str]) -> list[str]:
    chosen = [names] if isinstance(names, str) else list(names)
    unknown = [str(name) for name in chosen if name not in FIELDS]
    if unknown:
        raise TypeError(
            f"unknown parameter {', '.join(unknown)}; the parameters are {', '.join(FIELDS)}"
        )
    return chosen
