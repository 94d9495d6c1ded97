"""Roughing of an outside: engagement, air, what is left and what is not touched."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, distances
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.milling.moves import ArcFeed
from camgeo.numeric.arrays import FloatArray
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from tests.contour.cams import curves, flank
from tests.long_form import examples
from tests.measuring import polygon
from tests.part.parts import refused
from tests.toolpath.cutting import engagements, levels, swept
from tests.toolpath.strategies.sound import (
    DISC,
    LIMIT,
    TOLERANCE,
    TOOL,
    cleared,
    descents,
    made,
    require_allowance,
    require_sound,
    round_blank,
)

CUT = cleared("rough", DISC, stock=round_blank(54.0))


CORNERS = np.array([-56 - 60j, 56 - 60j, 56 + 60j, -56 + 60j])

PLATE = ExactBoundary("stock", hole=False, exact=Contour.polygon(CORNERS))


@pytest.mark.parametrize("changes", [{"depths": (-4.0, -8.0)}, {"climb": False}])
def test_engagement(changes: dict[str, Any]) -> None:
    """What comes before the first contact at a depth, and the way out again, is air."""
    for there in engaged({"depths": (-4.0,), **changes}, LIMIT):
        assert np.mean(there < 1e-3) <= 0.15
        assert np.quantile(there, 0.9) > math.radians(35.0)


@pytest.mark.parametrize(
    ("changes", "limit"),
    [
        ({"stock": PLATE}, LIMIT),
        # Where the blank has no allowance the cutter runs in air there.
        ({"stock": round_blank(52.0)}, LIMIT),
        # Without a limit it is that on a straight wall at the stepover.
        ({"tool": TOOL}, math.acos(1.0 - 2.0 / TOOL.radius)),
    ],
    ids=["a plate", "a blank as large as the part", "no limit"],
)
def test_engagement_in_other_blanks(changes: dict[str, Any], limit: float) -> None:
    assert engaged({"depths": (-4.0,), **changes}, limit)


def engaged(changes: dict[str, Any], limit: float) -> list[FloatArray]:
    """At each depth (n,) [rad], at most `limit`; a plate is cut up to its corners."""
    cut = replace(CUT, **changes)
    moves = made(cut)
    require_sound(moves)
    found = levels(moves, 0.0)
    assert tuple(found) == cut.depths
    assert cut.stock is not None
    blank = cut.stock.arcs(TOLERANCE).contour
    if cut.stock is PLATE:
        for track in found.values():
            assert np.max(distances(0.999 * PLATE.exact.vertices, track)) <= TOOL.radius
    there = [engagements(track, blank, TOOL.radius, 60) for track in found.values()]
    assert np.max(there) <= limit
    return there


@pytest.mark.parametrize(
    "scene", ["setzhub", "vorschub", "schnitt", "querhub", "plate_translating"]
)
def test_roughing_of_a_fixture(scene: str) -> None:
    """From round stock: one way a depth, at a limited engagement."""
    wall = CurveBoundary("outline", hole=False, path=whole(flank(scene, -1)))
    size = float(np.max(np.abs(wall.polyline(0.01, "fast").contour.vertices))) + 2.0
    depths, blank = (-5.0, -10.0), round_blank(size)
    moves = made(cleared("rough", wall, depths=depths, allowance=0.25, stock=blank))
    require_sound(moves, rapids=3)
    there = engagements(levels(moves, 0.0)[-10.0], blank.exact, TOOL.radius, 25)
    assert np.max(there) <= LIMIT
    assert np.mean(there < 1e-3) <= 0.15


def test_one_way_to_the_wall_in_few_arcs() -> None:
    """What is left, by shapely, is the disc and its allowance, to the chords of both."""
    moves = made(CUT)
    require_sound(moves, rapids=3)
    # Straight down beside the blank: from the retract height, and from depth to depth.
    assert [way for way, _ in descents(moves)] == [0.0, 0.0]
    places = [complex(*move.end[:2]) for move in moves if move.end[2] in CUT.depths]
    assert abs(places[0]) >= 54.0 + TOOL.radius
    tracks = levels(moves, 0.0).values()
    disc = polygon(DISC.polyline(1e-3).contour.vertices)
    blank = shapely.Point(0.0, 0.0).buffer(54.0, quad_segs=200)
    for track in tracks:
        require_allowance(track, CUT, 0.05)
        left = blank.difference(swept(track, TOOL.radius))
        assert left.buffer(1e-2).contains(disc)
        # Chords of arcs of 10 mm at most leave cusps below 0.05 mm of the buffer's own 16 sides.
        assert left.difference(disc.buffer(CUT.allowance + 0.08)).area < 1e-3
    arcs = sum(isinstance(move, ArcFeed) for move in moves)
    assert sum(track.length for track in tracks) / arcs > 8.0  # mm


def test_a_blank_without_room_is_refused() -> None:
    with refused("stock", "blank is too small: "):
        made(replace(CUT, stock=round_blank(48.0)))
    with pytest.raises(GeometryError, match="needs the outline of the blank"):
        made(replace(CUT, stock=None))


@settings(max_examples=examples(8, long=15), deadline=None)
@given(curve=curves(), diameter=st.floats(2.0, 12.0), step=st.floats(0.2, 0.6))
def test_any_disc(curve: WorkingCurve, diameter: float, step: float) -> None:
    """Never nearer to the disc than the allowance, sound, and swept up to the wall."""
    wall = CurveBoundary("outline", hole=False, path=whole(curve))
    tool = replace(TOOL, diameter=diameter, stepover=step * 0.5 * diameter)
    try:
        size = float(np.max(np.abs(wall.polyline(1e-3, "fast").contour.vertices)))
        cut = replace(
            CUT, tool=tool, walls=(wall,), depths=(-2.0,), stock=round_blank(size + 1.0),
            stepover=step * 0.5 * diameter,
        )  # fmt: skip
        moves = made(cut)
    except GeometryError:
        return  # no disc, or none for such a cutter
    require_sound(moves, tool)
    (track,) = levels(moves, 0.0).values()
    require_allowance(track, cut, 0.06)
