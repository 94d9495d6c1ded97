"""The picture of the region: what is in it, where, and the same bytes."""

from __future__ import annotations

import importlib.metadata
import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

import camgeo
from camgeo.check.judge import transmission_angle_limit
from camgeo.check.sizing.smallest import Sizing, size
from camgeo.check.sizing.task import Task
from camgeo.cli.plot import RENDERERS
from camgeo.cli.size import RENDERER
from camgeo_export.plots.size import draw, render, seen, window
from camgeo_export.plots.style import RC

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"


def sized(name: str, angle: float | None = None) -> tuple[Task, Sizing]:
    design = camgeo.load(SCENES / f"{name}.toml")
    task = Task(design.cam)
    required = transmission_angle_limit(design.cam, design.scene.limits) if angle is None else angle
    return task, size(task, required, design.scene.limits.radius_ratio)


def axes_of(task: Task, sizing: Sizing) -> Axes:
    with rc_context(RC):
        figure = draw("cam", task, sizing)
        figure.canvas.draw()
    (axes,) = figure.axes
    return axes


def lines_of(axes: Axes) -> dict[str, Line2D]:
    return {str(line.get_label()): line for line in axes.lines}


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "schnitt"])
def test_everything_is_marked_inside_the_picture(name: str) -> None:
    task, sizing = sized(name)
    assert sizing.answer is not None
    assert sizing.flocke is not None
    axes = axes_of(task, sizing)
    marked = lines_of(axes)
    places = {
        "present design": task.present,
        "Flocke": sizing.flocke.place,
        "smallest, exact": sizing.answer.place,
    }
    left, right = axes.get_xlim()
    low, high = axes.get_ylim()
    for label, place in places.items():
        (x,), (y,) = np.asarray(marked[label].get_xdata()), np.asarray(marked[label].get_ydata())
        expected = seen(task, np.array([place.real]), np.array([place.imag]))
        assert (x, y) == (expected[0][0], expected[1][0])
        assert left < x < right
        assert low < y < high
    texts = [text.get_text() for text in axes.get_legend().get_texts()]  # type: ignore[union-attr]
    assert any("Flocke" in text and "μ" in text for text in texts)
    assert any("exact" in text and "μ" in text for text in texts)
    assert any("r$_K$" in text for text in texts)


def test_the_window_is_square() -> None:
    for name in ("plate_translating", "setzhub"):
        columns, rows = window(*sized(name))
        assert np.ptp(columns) == pytest.approx(np.ptp(rows))


def test_a_picture_of_what_cannot_be_met() -> None:
    task, sizing = sized("setzhub", math.radians(80.0))
    assert sizing.answer is None
    marked = lines_of(axes_of(task, sizing))
    assert "present design" in marked
    assert "smallest, exact" not in marked


def test_same_input_same_bytes() -> None:
    task, sizing = sized("schnitt")
    assert render("a", task, sizing, ".svg") == render("a", task, sizing, ".svg")
    with pytest.raises(ValueError, match="gif"):
        render("a", task, sizing, ".gif")


def test_the_command_finds_it() -> None:
    (entry,) = importlib.metadata.entry_points(group=RENDERERS, name=RENDERER)
    assert entry.load() is render
