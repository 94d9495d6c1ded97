"""Roughing of fixture cams from round stock: one way a depth, at a limited engagement."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.outline.path import whole
from camgeo.milling.moves import Rapid
from camgeo.part.boundaries import CurveBoundary
from tests.contour.cams import flank
from tests.toolpath.cutting import engagement, levels
from tests.toolpath.strategies.sound import LIMIT, TOOL, cleared, made, require_sound, round_blank


@pytest.mark.parametrize(
    "scene", ["setzhub", "vorschub", "schnitt", "querhub", "plate_translating"]
)
def test_roughing_of_a_fixture(scene: str) -> None:
    wall = CurveBoundary("outline", hole=False, path=whole(flank(scene, -1)))
    size = float(np.max(np.abs(wall.polyline(0.01, "fast").contour.vertices))) + 2.0
    depths, blank = (-5.0, -10.0), round_blank(size)
    moves = made(cleared("rough", wall, depths=depths, allowance=0.25, stock=blank))
    require_sound(moves)
    assert sum(isinstance(move, Rapid) for move in moves) == 3
    track = levels(moves, 0.0)[-10.0]
    places = np.linspace(0.05, track.length - 0.05, 25)
    there = np.array([engagement(track, blank.exact, TOOL.radius, each) for each in places])
    assert np.max(there) <= LIMIT
    assert np.mean(there < 1e-3) <= 0.15
