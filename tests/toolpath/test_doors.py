"""Refusals of the classes of a program, beyond those that tests/mechanism/test_values.py covers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.cut import ContourCut
from camgeo.milling.machine import load
from camgeo.milling.making import MOST_PASSES, passes
from camgeo.milling.milling import Heights, Tool
from camgeo.milling.moves import ArcFeed, Feed, Operation, Rapid, Toolpath
from camgeo.part.boundaries import ExactBoundary
from tests.part.parts import refused

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
    with refused("toolpath"):
        replace(CUT, **change)


def once() -> Operation:
    return Operation(CUT, (HOME,))


REFUSED: list[tuple[Callable[[], object], str, str]] = [
    (lambda: Feed((0.0, 0.0), 1.0), "must be 3 coordinates", "toolpath"),  # type: ignore[arg-type]  # wrong on purpose
    (lambda: ArcFeed((0.0, 0.0, 0.0), 0j, True, 1.0), "must be 2 coordinates", "toolpath"),  # type: ignore[arg-type]  # wrong on purpose
    (lambda: ArcFeed((0.0, 0.0, 0.0), (0.0, 0.0), 1, 1.0), "true or false", "toolpath"),  # type: ignore[arg-type]  # wrong on purpose
    (lambda: Operation(CUT, ()), "must begin with a traverse", "toolpath"),
    (
        lambda: Operation(CUT, (Feed((0.0, 0.0, -1.0), 100.0), HOME)),
        "must begin with a traverse",
        "toolpath",
    ),
    (lambda: Toolpath(Heights(5.0, 5.0), (once(), once())), "its own name", "toolpath"),
    (lambda: Heights(math.nan, 2.0), "above 0", "output.gcode.clearance_height"),
    (lambda: Heights(5.0, 6.0), "to 5", "output.gcode.retract_height"),
    (lambda: passes(0.0, -10.0, 1e-9), r"must be at least 0\.01 mm", "tool.stepdown"),
    (
        lambda: replace(load("linuxcnc").program, end=("M{two}",)),
        "no braces but",
        "program.end",
    ),
]


@pytest.mark.parametrize(("make", "message", "key"), REFUSED)
def test_what_is_wrong_is_refused_with_its_key(
    make: Callable[[], object], message: str, key: str
) -> None:
    with refused(key, message):
        make()


@given(st.floats(0.01, 60.0), st.floats(0.1, 80.0))
def test_passes_are_equal_and_no_more_than_needed(depth: float, stepdown: float) -> None:
    found = passes(1.0, 1.0 - depth, stepdown)
    assert found[-1] == 1.0 - depth
    assert -np.diff((1.0, *found)) == pytest.approx(depth / len(found))
    assert depth / len(found) <= stepdown * (1.0 + 1e-9)
    assert len(found) == 1 or depth / (len(found) - 1) > stepdown


def test_no_more_passes_than_sense() -> None:
    assert len(passes(0.0, -10.0, 10.0 / MOST_PASSES)) == MOST_PASSES
