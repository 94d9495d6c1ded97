"""Faces, grooves and drilled holes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import whole
from camgeo.milling.cut import AreaCut, PointCut
from camgeo.milling.moves import Feed, Rapid
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from tests.contour.cams import dwell, move, translating
from tests.measuring import polygon
from tests.part.parts import refused
from tests.toolpath.cutting import engagements, levels, swept
from tests.toolpath.strategies.sound import (
    HEIGHTS,
    TOLERANCE,
    TOOL,
    cleared,
    made,
    require_allowance,
    require_sound,
    round_blank,
    round_hole,
)

PLATE = ExactBoundary(
    "stock", hole=False, exact=Contour.polygon(np.array([-30 - 20j, 50 - 20j, 50 + 30j, -30 + 30j]))
)

FACE = AreaCut(
    name="face", strategy="face", tool=replace(TOOL, stepover=6.0), top=2.0, depths=(1.0, 0.0),
    walls=(), stock=PLATE, stepover=6.0,
)  # fmt: skip

INNER = translating(dwell(60), move(120, 15.0), dwell(40), move(140, 0.0))

FLANKS = (
    CurveBoundary("inner flank", hole=False, path=whole(INNER)),
    CurveBoundary("outer flank", hole=True, path=whole(replace(INNER, distance=8.0))),
)
"""Of a groove 16 mm wide."""

GROOVE = cleared("rough", *FLANKS, name="rough groove", tool=TOOL, depths=(-3.0, -6.0))


@pytest.mark.parametrize("blank", [PLATE, round_blank(45.0)])
def test_a_face_is_cut_all_over(blank: Boundary) -> None:
    cut = replace(FACE, stock=blank)
    moves = made(cut)
    require_sound(moves, rapids=3)
    found = levels(moves, cut.top)
    assert tuple(found) == cut.depths
    contour = blank.arcs(TOLERANCE).contour
    whole_face = polygon(contour.points(1e-3))
    for track in found.values():
        assert whole_face.difference(swept(track, TOOL.radius)).area < 1e-6
        most = np.max(engagements(track, contour, TOOL.radius, 40))
        assert most <= math.acos(1.0 - 6.0 / TOOL.radius) + 1e-6


@pytest.mark.parametrize("diameter", [8.0, 10.0, 15.0])
def test_a_groove_is_cleared_to_the_allowance(diameter: float) -> None:
    """Both depths are ways without a break."""
    cut = replace(GROOVE, tool=replace(TOOL, diameter=diameter, stepover=2.0))
    moves = made(cut)
    require_sound(moves, rapids=3)
    found = levels(moves, cut.top)
    assert set(found) == set(cut.depths)
    for track in found.values():
        require_allowance(track, cut, 0.1)


@pytest.mark.parametrize(
    ("changes", "message", "key"),
    [
        ({"walls": FLANKS[:1]}, "outline of the blank", "stock"),
        ({"tool": replace(TOOL, diameter=15.8)}, "narrower than the groove of 16 mm", "tool"),
        ({"stepover": 1e-6}, "more than 500 rounds on each side", "tool.stepover"),  # as spirals
        ({"walls": (*FLANKS, round_hole(5.0))}, "at most one wall", "part"),
    ],
)
def test_what_cannot_be_cleared(changes: dict[str, Any], message: str, key: str) -> None:
    with refused(key, message):
        made(replace(GROOVE, **changes))


def test_moves_end_where_no_program_can_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of one cut alone, before the others are made."""
    count = len(made(GROOVE))
    monkeypatch.setattr("camgeo.milling.walk.PROGRAM_LINES", count // 2)
    with pytest.raises(FileError, match="the limit for a program that is read"):
        made(GROOVE)


def test_holes_are_drilled_in_pecks() -> None:
    cut = PointCut(
        name="holes", strategy="drill", tool=TOOL, top=0.0, depths=(-3.0, -6.0, -9.0),
        points=(10 + 0j, -10 + 5j),
    )  # fmt: skip
    moves = made(cut)
    require_sound(moves, replace(TOOL, plunge_feed=TOOL.feed))
    for place in cut.points:
        there = [move for move in moves if complex(*move.end[:2]) == place]
        down = [move.end[2] for move in there if isinstance(move, Feed)]
        assert tuple(down) == cut.depths
        up = [move.end[2] for move in there if isinstance(move, Rapid)]
        assert up.count(HEIGHTS.retract) == 4  # above the hole, and after each peck
    assert all(move.feed == TOOL.plunge_feed for move in moves if isinstance(move, Feed))
