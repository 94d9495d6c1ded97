"""Clearing of holes: helix, spiral, no core, the wall."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import whole
from camgeo.milling.clear import HELIX
from camgeo.milling.walk import centre_feed
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import Boundary
from tests.contour.cams import dwell, move, translating
from tests.measuring import polygon
from tests.toolpath.cutting import engagements, levels, steps_of, swept
from tests.toolpath.strategies.sound import (
    HEIGHTS,
    LIMIT,
    TOOL,
    cleared,
    descents,
    made,
    require_allowance,
    require_sound,
    round_hole,
    steepest,
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
    require_sound(moves, rapids=3)
    last = levels(moves, cut.top)[cut.bottom]
    require_allowance(last, cut, 0.05)
    hole = polygon(wall.polyline(1e-3).contour.vertices)
    left = hole.buffer(-cut.allowance - 0.08).difference(swept(last, TOOL.radius))
    assert left.area < 1e-3


def test_the_way_down_is_a_helix() -> None:
    """No steeper than the tool may run, of a radius that leaves nothing in the middle."""
    moves = made(CUT)
    slopes = [drop / way for way, drop in descents(moves) if way > 0.0]
    assert steepest(moves) == pytest.approx(min(slopes), rel=0.5)
    straight = [drop for way, drop in descents(moves) if way == 0.0]
    assert straight == pytest.approx([HEIGHTS.retract - CUT.top])
    helix = [step for step in steps_of(moves) if step.way and step.low < step.high]
    assert {round(abs(step.end), 6) for step in helix} == {HELIX * TOOL.radius}
    assert all(step.sweep > 0.0 for step in helix)


def test_engagement() -> None:
    track = levels(made(CUT), CUT.top)[CUT.bottom]
    # What the helix has opened before it is there already.
    turned = 2.0 * math.pi * HELIX * TOOL.radius
    there = engagements(track, Contour.circle(60.0), TOOL.radius, 60, turned + 0.05, 6.0)
    assert np.max(there) <= LIMIT


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
    rounds = [step for step in steps_of(made(CUT)) if step.sweep and step.low == CUT.bottom]
    slowest = centre_feed(TOOL.feed, HELIX * TOOL.radius, TOOL.radius, inside=True)
    assert min(each.feed for each in rounds) >= 0.5 * slowest
    for each in rounds:
        if each.sweep > 0.0:
            at_wall = each.feed * (each.radius + TOOL.radius) / each.radius
            assert at_wall == pytest.approx(TOOL.feed)


def test_a_cutter_too_large_is_refused() -> None:
    with pytest.raises(GeometryError):
        made(replace(CUT, walls=(round_hole(5.0),)))
