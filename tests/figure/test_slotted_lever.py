"""The diagram of a slotted lever: curves, marked extremes, the same bytes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from camgeo.kinematics.mechanism.slotted_lever import DrivenLever, SlottedLever
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.slotted_lever import PANELS, crank_angles, figure
from camgeo.units import RPM
from tests.figure import drawing

LEVERS = {
    "exercise": SlottedLever(75.0, 150.0),
    "turning": SlottedLever(100.0, 50.0),
    "equal": SlottedLever(50.0, 50.0),
    "nearly equal": SlottedLever(1e9, 1e9 + 1.0),
    "short": SlottedLever(1.0, 1e8),
}


def drawn(driven: DrivenLever) -> tuple[Figure, list[Axes]]:
    page = drawing.drawn(figure(driven))
    return page, page.axes[: len(PANELS)]


def driven_by(name: str) -> DrivenLever:
    return DrivenLever(LEVERS[name], 90.0 * RPM)


def curve_of(axes: Axes) -> FloatArray:
    (line,) = [line for line in axes.lines if len(np.asarray(line.get_xdata())) > 1000]
    return np.asarray(line.get_xydata(), dtype=np.float64)


def dots_of(axes: Axes) -> list[tuple[float, float]]:
    return [
        (float(x), float(y))
        for line in axes.lines
        if line.get_marker() == "o"
        for x, y in np.asarray(line.get_xydata(), dtype=np.float64)
    ]


@pytest.mark.parametrize("name", LEVERS)
def test_a_dot_lies_on_the_curve_at_every_extreme(name: str) -> None:
    driven = driven_by(name)
    _, panels = drawn(driven)
    for axes, (quantity, _, _) in zip(panels, PANELS, strict=True):
        curve, dots = curve_of(axes), dots_of(axes)
        own = [extreme for extreme in driven.extremes if extreme.quantity == quantity]
        texts = [text.get_text() for text in axes.texts]
        assert len(texts) == len(own)
        for extreme in own:
            scale = 180.0 / math.pi if quantity == "phi" else 1.0
            place, value = math.degrees(extreme.crank), scale * extreme.value
            assert min(abs(x - place) + abs(y - value) for x, y in dots) <= 1e-9 * abs(value)
            # Nothing drawn goes beyond it, and the curve reaches it.
            reached = curve[:, 1].max() if extreme.largest else curve[:, 1].min()
            assert reached == pytest.approx(value, rel=1e-6)


def test_the_values_of_the_exercise_label_the_dots() -> None:
    _, panels = drawn(driven_by("exercise"))
    assert [[text.get_text() for text in axes.texts] for axes in panels] == [
        ["−30° at 60°", "30° at 300°"],
        ["−9.4248 rad/s at 0°", "3.1416 rad/s at 180°"],
        ["119.88 rad/s² at 22.9°", "−119.88 rad/s² at 337.1°"],
    ]


def test_the_time_stands_above_the_crank_angle() -> None:
    driven = driven_by("exercise")
    page, panels = drawn(driven)
    assert panels[-1].get_xlim() == (0.0, 360.0)
    above = page.axes[-1]
    assert above.get_xlim() == pytest.approx((0.0, 2.0 / 3.0))


@pytest.mark.parametrize("rpm", [0.01, 90.0, 3000.0])
@pytest.mark.parametrize("name", LEVERS)
def test_the_labels_lie_within_the_figure(name: str, rpm: float) -> None:
    page, panels = drawn(DrivenLever(LEVERS[name], rpm * RPM))
    width, height = page.canvas.get_width_height()
    for axes in panels:
        for text in (*axes.texts, axes.yaxis.label, axes.yaxis.get_offset_text()):
            if not text.get_text():
                continue
            box = text.get_window_extent()
            assert 0 <= box.x0 < box.x1 <= width
            assert 0 <= box.y0 < box.y1 <= height


def test_where_the_angle_is_undefined_the_curve_is_open() -> None:
    _, panels = drawn(driven_by("equal"))
    curve = curve_of(panels[0])
    assert 0.0 < curve[0, 0] < curve[-1, 0] < 360.0
    assert dots_of(panels[0]) == [(0.0, -90.0), (360.0, 90.0)]


def test_the_crank_angles_are_dense_where_the_acceleration_peaks() -> None:
    driven = driven_by("nearly equal")
    theta = crank_angles(driven)
    assert (theta[0], theta[-1]) == (0.0, 2.0 * math.pi)
    assert np.all(np.diff(theta) > 0.0)
    peak = driven.lever.largest_acceleration.place
    assert np.count_nonzero((theta > 0.1 * peak) & (theta < 10.0 * peak)) > 100
