"""The picture of the region: what is in it, where, and the same bytes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.check.judge import transmission_angle_limit
from camgeo.check.sizing.smallest import Sizing, size
from camgeo.check.sizing.task import Task, task_of
from camgeo.pictures.model import Circle, Field, Line, Panel
from camgeo.pictures.size import figure, seen, window

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"


def sized(name: str, angle: float | None = None) -> tuple[Task, Sizing]:
    design = camgeo.load(SCENES / f"{name}.toml")
    task = task_of(design.cam)
    required = transmission_angle_limit(design.cam, design.scene.limits) if angle is None else angle
    return task, size(task, required, design.scene.limits.radius_ratio)


def panel_of(task: Task, sizing: Sizing) -> Panel:
    (panel,) = figure("cam", [(task, sizing)]).panels
    return panel


def lines_of(panel: Panel) -> dict[str, Line]:
    return {mark.label: mark for mark in panel.marks if isinstance(mark, Line)}


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "schnitt"])
def test_everything_is_marked_inside_the_picture(name: str) -> None:
    task, sizing = sized(name)
    assert sizing.answer is not None
    assert sizing.flocke is not None
    panel = panel_of(task, sizing)
    marked = lines_of(panel)
    places = {
        "present design": task.present,
        "Flocke": sizing.flocke.place,
        "smallest": sizing.answer.place,
    }
    (left, right), (low, high) = panel.x.limits, panel.y.limits
    for label, place in places.items():
        ((x, y),) = marked[label].points
        expected = seen(task, np.array([place.real]), np.array([place.imag]))
        assert (x, y) == (expected[0][0], expected[1][0])
        assert left < x < right
        assert low < y < high
    assert panel.legend is not None
    texts = [entry.label for entry in panel.legend.entries]
    assert any("Flocke" in text and "μ" in text for text in texts)
    assert any("exact" in text and "μ" in text for text in texts)
    assert any("r$_K$" in text for text in texts) == (name == "schnitt")
    assert any(isinstance(mark, Field) for mark in panel.marks) == (name == "schnitt")


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "schnitt"])
def test_base_circles_are_whole_and_each_name_has_its_region(name: str) -> None:
    """What is named is in the picture: a level of the ratio where the region has such places."""
    task, sizing = sized(name)
    sides = [(each, size(each, sizing.angle, sizing.ratio)) for each in task.sides]
    (panel,) = figure("cam", sides).panels
    circles = [mark for mark in panel.marks if isinstance(mark, Circle) and mark.style.dashes]
    assert len(circles) == len(sides)
    (left, right), (low, high) = panel.x.limits, panel.y.limits
    for circle in circles:
        x, y = circle.centre
        assert left < x - circle.radius
        assert x + circle.radius < right
        assert low < y - circle.radius
        assert y + circle.radius < high
    assert panel.legend is not None
    labels = [entry.label for entry in panel.legend.entries]
    assert len(set(labels)) == len(labels)
    bent = [mark for mark in panel.marks if isinstance(mark, Field)]
    assert any("r$_K$" in label for label in labels) == bool(bent)


def test_the_window_is_square() -> None:
    for name in ("plate_translating", "setzhub"):
        columns, rows = window([sized(name)])
        assert np.ptp(columns) == pytest.approx(np.ptp(rows))


def test_a_picture_of_what_cannot_be_met() -> None:
    task, sizing = sized("setzhub", math.radians(80.0))
    assert sizing.answer is None
    marked = lines_of(panel_of(task, sizing))
    assert "present design" in marked
    assert "smallest" not in marked
