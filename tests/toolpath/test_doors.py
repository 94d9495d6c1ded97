"""Refusals of the classes of a program, beyond those that tests/mechanism/test_values.py covers."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.cut import MOST_PASSES, ContourCut, passes
from camgeo.milling.machine import load
from camgeo.milling.moves import ArcFeed, Feed, Heights, Operation, Rapid, Toolpath
from camgeo.milling.tool import Tool
from camgeo.part.boundaries import ExactBoundary

TOOL = Tool(number=1, diameter=6.0, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0)

BORE = ExactBoundary("bore", hole=True, exact=Contour.circle(5.0))

CUT = ContourCut(
    name="bore",
    strategy="profile",
    tool=TOOL,
    top=0.0,
    depths=(-2.0, -4.0),
    centre=BORE,
    right="bore",
    room=1.0,
)

HOME = Rapid((0.0, 0.0, 5.0))


def test_places_have_their_coordinates() -> None:
    with pytest.raises(GeometryError, match="must be 3 coordinates"):
        Feed((0.0, 0.0), 1.0)  # type: ignore[arg-type]  # wrong on purpose
    with pytest.raises(GeometryError, match="must be 2 coordinates"):
        ArcFeed((0.0, 0.0, 0.0), 0j, ccw=True, feed=1.0)  # type: ignore[arg-type]  # wrong on purpose
    with pytest.raises(GeometryError, match="true or false"):
        ArcFeed((0.0, 0.0, 0.0), (0.0, 0.0), ccw=1, feed=1.0)  # type: ignore[arg-type]  # wrong on purpose


@pytest.mark.parametrize(
    "change",
    [
        {"depths": ()},
        {"depths": (-4.0, -2.0)},
        {"depths": (-2.0, math.nan)},
        {"top": -3.0},
        {"allowance": -0.1},
        {"compensation": "left"},
    ],
)
def test_cuts(change: dict[str, Any]) -> None:
    with pytest.raises(GeometryError) as caught:
        replace(CUT, **change)
    assert caught.value.key == "toolpath"


def test_operations_begin_above_the_part_and_have_names_of_their_own() -> None:
    with pytest.raises(GeometryError, match="must begin with a traverse"):
        Operation(CUT, ())
    with pytest.raises(GeometryError, match="must begin with a traverse"):
        Operation(CUT, (Feed((0.0, 0.0, -1.0), 100.0), HOME))
    operation = Operation(CUT, (HOME,))
    with pytest.raises(GeometryError, match="its own name"):
        Toolpath(Heights.of(5.0), (operation, operation))
    with pytest.raises(GeometryError) as caught:
        Heights(math.nan, 2.0)
    assert caught.value.key == "output.gcode.clearance_height"
    with pytest.raises(GeometryError, match="to 5") as caught:
        Heights(5.0, 6.0)
    assert caught.value.key == "output.gcode.retract_height"


@given(st.floats(0.01, 60.0), st.floats(0.1, 80.0))
def test_passes_are_equal_and_no_more_than_needed(depth: float, stepdown: float) -> None:
    found = passes(1.0, 1.0 - depth, stepdown)
    assert found[-1] == 1.0 - depth
    assert -np.diff((1.0, *found)) == pytest.approx(depth / len(found))
    assert depth / len(found) <= stepdown * (1.0 + 1e-9)
    assert len(found) == 1 or depth / (len(found) - 1) > stepdown


def test_no_more_passes_than_sense() -> None:
    assert len(passes(0.0, -10.0, 10.0 / MOST_PASSES)) == MOST_PASSES
    with pytest.raises(GeometryError, match=r"must be at least 0\.01 mm") as caught:
        passes(0.0, -10.0, 1e-9)
    assert caught.value.key == "tool.stepdown"


def test_blocks_of_a_machine_can_be_filled_in() -> None:
    with pytest.raises(GeometryError, match="no braces but") as caught:
        replace(load("linuxcnc").program, end=("M{two}",))
    assert caught.value.key == "program.end"
