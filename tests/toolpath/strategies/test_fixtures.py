"""Roughing of fixture cams from round stock: one way a depth, at a limited engagement."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgeo.contour.contour import Contour
from camgeo.outline.path import whole
from camgeo.part.boundaries import CurveBoundary
from camgeo.toolpath.cut import AreaCut
from camgeo.toolpath.moves import Rapid
from camgeo.toolpath.strategies import STRATEGIES
from tests.contour.cams import flank
from tests.toolpath.cutting import engagement, levels
from tests.toolpath.strategies.sound import HEIGHTS, TOLERANCE, TOOL, require_sound, round_blank

LIMIT = math.radians(50.0)


@pytest.mark.parametrize(
    "scene", ["setzhub", "vorschub", "schnitt", "querhub", "plate_translating"]
)
def test_roughing_of_a_fixture(scene: str) -> None:
    wall = CurveBoundary("outline", hole=False, path=whole(flank(scene, -1)))
    size = float(np.max(np.abs(wall.polyline(0.01, "fast").contour.vertices))) + 2.0
    cut = AreaCut(
        name="rough outline", strategy="rough", tool=replace(TOOL, engagement=LIMIT), top=0.0,
        depths=(-5.0, -10.0), allowance=0.25, walls=(wall,), stock=round_blank(size), stepover=2.0,
    )  # fmt: skip
    moves = STRATEGIES[cut.strategy](cut, HEIGHTS, TOLERANCE, "fast")
    require_sound(moves)
    assert sum(isinstance(move, Rapid) for move in moves) == 3
    track = levels(moves, 0.0)[-10.0]
    places = np.linspace(0.05, track.length - 0.05, 25)
    blank = Contour.circle(size)
    there = np.array([engagement(track, blank, TOOL.radius, each) for each in places])
    assert np.max(there) <= LIMIT
    assert np.mean(there < 1e-3) <= 0.15
