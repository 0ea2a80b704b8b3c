"""`plot` draws whatever the model returns, as the page does."""

from __future__ import annotations

import holoviews as hv
import numpy as np
import pytest
from bokeh.models import Legend, Line

from hunting import (
    RECONSTRUCTED,
    averaged_branch,
    bogie,
    critical_speeds,
    design,
    figure,
    hopf_points,
    limit_cycles,
    sensitivity,
    simulate,
    speed_ramp,
    sweep,
    uncertainty,
    wheelset,
)
from hunting_app import plot
from hunting_app.palette import DARK, LIGHT

SYSTEM = bogie(RECONSTRUCTED)
SPEED = "forward speed V [km/h]"
AMPLITUDE = "amplitude, peak |y| [mm]"
CRITICAL = "critical speed V [km/h]"


@pytest.fixture(scope="module")
def branch():
    return limit_cycles(SYSTEM)


@pytest.fixture(scope="module")
def motion(branch):
    inside = 0.9 * branch.at_speed(40.0)[0].motion.state[0]
    return simulate(SYSTEM, 40.0, [inside, 1.3 * inside], 5.0)


def drawn(view):
    return hv.render(view, backend="bokeh")


def labels(view):
    figure_ = drawn(view)
    return figure_.xaxis[0].axis_label, figure_.yaxis[0].axis_label


@pytest.mark.parametrize(
    ("result", "expected"),
    [
        (lambda: limit_cycles(SYSTEM), (SPEED, AMPLITUDE)),
        (lambda: critical_speeds(SYSTEM), (SPEED, AMPLITUDE)),
        (lambda: SYSTEM, (SPEED, "damping ratio ζ [%]")),
        (lambda: hopf_points(SYSTEM), (SPEED, "frequency f [Hz]")),
        (
            lambda: speed_ramp(SYSTEM, np.linspace(35.0, 44.0, 4), dwell=2.0),
            (SPEED, AMPLITUDE),
        ),
        (lambda: figure(3, method="averaging"), (SPEED, AMPLITUDE)),
        (
            lambda: figure(13, method="averaging", points=3),
            ("flange clearance δ [m]", CRITICAL),
        ),
        (
            lambda: sweep(bogie, RECONSTRUCTED, {"Cy": [1e4, 3e4]}, "averaging"),
            ("lateral damping C_y [N s/m]", CRITICAL),
        ),
        (
            lambda: sweep(bogie, RECONSTRUCTED, {"lam": [0.05, 0.1], "b": [0.9, 1]}, "averaging"),
            ("equivalent conicity λ [rad]", "half spring distance b [m]"),
        ),
        (
            lambda: sensitivity(bogie, RECONSTRUCTED),
            ("change of the critical speed [%] for 10 % more of the parameter", ""),
        ),
        (
            lambda: design(bogie, RECONSTRUCTED, ["Ky", "Kpsi"], 41.0),
            ("change of the parameter [%]", ""),
        ),
        (
            lambda: uncertainty(bogie, RECONSTRUCTED, {"Ky": 0.1, "lam": 0.1}, samples=64),
            (CRITICAL, "share of the samples [%]"),
        ),
    ],
    ids=lambda value: "" if callable(value) else value[1],
)
def test_every_result_has_a_view_with_units_on_both_axes(result, expected):
    assert labels(plot(result())) == expected


def test_motions_are_drawn_over_time_and_as_phase_portraits(branch, motion):
    assert labels(plot(motion)) == ("time t [s]", "lateral displacement y [mm]")
    assert labels(plot(motion, coordinate="psi")) == ("time t [s]", "yaw angle ψ [mrad]")
    portrait = plot(motion, against="rate") * plot(branch, speed=40.0)
    assert labels(portrait) == ("lateral displacement y [mm]", "y′ [mm/s]")
    assert len(drawn(portrait).renderers) == 4  # two motions, two cycles


def test_views_on_top_of_each_other_keep_axes_curves_and_legend(branch):
    averaged = averaged_branch(SYSTEM)
    both = plot(critical_speeds(SYSTEM)) * plot(branch) * plot(averaged)
    assert labels(both) == (SPEED, AMPLITUDE)
    figure_ = drawn(both)
    (legend,) = figure_.select({"type": Legend})
    assert [item.label.value for item in legend.items] == [
        "bogie, exact, stable",
        "bogie, exact, unstable",
        "bogie, averaged, stable",
        "bogie, averaged, unstable",
    ]
    assert legend.label_text_font == "system-ui, sans-serif"
    assert figure_.x_range.end == 200
    assert figure_.sizing_mode == "stretch_width"


def test_views_side_by_side_are_a_layout(branch):
    assert isinstance(plot(branch) + plot(SYSTEM), hv.Layout)


def test_the_colours_are_the_pages(branch):
    def inks(figure_):
        return {line.line_color for line in figure_.select({"type": Line})}

    for dark, colours in ((False, LIGHT), (True, DARK)):
        figure_ = drawn(plot(branch, dark=dark))
        assert figure_.background_fill_color == colours.paper
        assert colours.bogie in inks(figure_)
    wheelsets = drawn(plot(limit_cycles(wheelset(RECONSTRUCTED))))
    assert LIGHT.wheelset in inks(wheelsets)


def test_the_curve_is_the_branch(branch):
    curve = next(c for c in plot(branch) if c.label == "bogie, exact, unstable")
    unstable = ~branch.stable
    np.testing.assert_array_equal(curve.dimension_values(0), 3.6 * branch.speed)
    np.testing.assert_array_equal(
        curve.dimension_values(1)[unstable], 1e3 * branch.amplitude[unstable]
    )


def test_what_cannot_be_drawn_is_refused_in_words(branch, motion):
    with pytest.raises(TypeError, match="cannot plot a list; there are views of Branch"):
        plot([1, 2])
    with pytest.raises(ValueError, match="no limit cycle at 36 km/h"):
        plot(branch, speed=10.0)
    with pytest.raises(ValueError, match="coordinate must be one of y, ψ, z, psi, got 'x'"):
        plot(motion, coordinate="x")
    with pytest.raises(ValueError, match="against must be one of time, rate"):
        plot(motion, against="velocity")
    with pytest.raises(TypeError, match="unexpected keyword argument 'speeed'"):
        plot(branch, speeed=3.0)
