"""Clearing of holes: helix, spiral, no core, the wall."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, distances
from camgeo.geometry.outline.path import whole
from camgeo.milling.moves import ArcFeed, Rapid, centre_feed
from camgeo.milling.strategies.clear import HELIX
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import Boundary
from tests.contour.cams import dwell, move, translating
from tests.toolpath.cutting import engagement, levels
from tests.toolpath.plane.tracks import dense
from tests.toolpath.strategies.sound import (
    HEIGHTS,
    LIMIT,
    TOOL,
    cleared,
    descents,
    made,
    require_sound,
    round_hole,
)

RING = CurveBoundary(
    "outline",
    hole=True,
    path=whole(
        replace(translating(dwell(60), move(120, 15.0), dwell(40), move(140, 0.0)), distance=8.0)
    ),
)

CUT = cleared("bore", round_hole(20.0), name="rough bore", top=0.5, allowance=0.1)


@pytest.mark.parametrize(
    "wall", [round_hole(r) for r in (5.6, 8.0, 9.7, 10.2, 12.0, 25.0)] + [RING]
)
def test_a_hole_is_cleared(wall: Boundary) -> None:
    """No core, whatever the width; never nearer to the wall than the allowance."""
    cut = replace(CUT, walls=(wall,))
    moves = made(cut)
    require_sound(moves)
    assert sum(isinstance(move, Rapid) for move in moves) == 3
    last = levels(moves, cut.top)[cut.bottom]
    ring = wall.polyline(1e-3).contour.vertices
    apart = distances(ring, last)
    assert np.min(apart) >= TOOL.radius + cut.allowance - 2e-3
    assert np.max(apart) <= TOOL.radius + cut.allowance + 0.05
    points = dense(last, 30)
    swept = shapely.LineString(np.column_stack((points.real, points.imag))).buffer(TOOL.radius)
    hole = shapely.Polygon(np.column_stack((ring.real, ring.imag)))
    assert hole.buffer(-cut.allowance - 0.08).difference(swept).area < 1e-3


def test_the_way_down_is_a_helix() -> None:
    """No steeper than the tool may run, of a radius that leaves nothing in the middle."""
    moves = made(CUT)
    steep = [drop / way for way, drop in descents(moves) if way > 0.0]
    assert max(steep) == pytest.approx(min(steep), rel=0.5)
    assert max(steep) <= math.tan(math.radians(2.5)) * (1.0 + 1e-9)
    straight = [drop for way, drop in descents(moves) if way == 0.0]
    assert straight == pytest.approx([HEIGHTS.retract - CUT.top])
    helix = [
        move for move, before in zip(moves[1:], moves, strict=False)
        if isinstance(move, ArcFeed) and move.end[2] < before.end[2]
    ]  # fmt: skip
    assert {round(abs(complex(*move.end[:2])), 6) for move in helix} == {HELIX * TOOL.radius}
    assert all(move.ccw for move in helix)


def test_engagement() -> None:
    moves = made(CUT)
    track = levels(moves, CUT.top)[CUT.bottom]
    # What the helix has opened before it is there already.
    turned = 2.0 * math.pi * HELIX * TOOL.radius
    blank = Contour.circle(60.0)
    places = np.linspace(turned + 0.05, track.length - 6.0, 60)
    assert max(engagement(track, blank, TOOL.radius, each) for each in places) <= LIMIT


def test_a_hole_that_is_there_saves_the_helix() -> None:
    cut = replace(CUT, cleared=(round_hole(9.0),))
    moves = made(cut)
    require_sound(moves)
    assert all(way == 0.0 for way, _ in descents(moves))
    assert levels(moves, cut.top)[cut.bottom].length < levels(made(CUT), 0.5)[cut.bottom].length
    assert min(abs(complex(*each.end[:2])) for each in moves) >= 3.5


def test_a_hole_too_small_for_the_cutter_is_ignored() -> None:
    assert made(replace(CUT, cleared=(round_hole(5.2),))) == made(CUT)


def test_feed_is_that_at_the_wall() -> None:
    moves = made(CUT)
    rounds = [move for move in moves if isinstance(move, ArcFeed) and move.end[2] == CUT.bottom]
    slowest = centre_feed(TOOL.feed, HELIX * TOOL.radius, TOOL.radius, inside=True)
    assert min(each.feed for each in rounds) >= 0.5 * slowest
    for each in rounds:
        radius = abs(complex(*each.end[:2]) - complex(*each.centre))
        if each.ccw:
            assert each.feed * (radius + TOOL.radius) / radius == pytest.approx(TOOL.feed)


def test_a_cutter_too_large_is_refused() -> None:
    with pytest.raises(GeometryError):
        made(replace(CUT, walls=(round_hole(5.0),)))
