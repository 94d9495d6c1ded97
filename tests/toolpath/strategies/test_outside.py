"""Roughing of an outside: engagement, air, what is left and what is not touched."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, distances
from camgeo.geometry.outline.path import whole
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.milling.moves import ArcFeed, Rapid
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from tests.contour.cams import curves
from tests.long_form import examples
from tests.toolpath.cutting import engagement, levels
from tests.toolpath.plane.tracks import dense
from tests.toolpath.strategies.sound import (
    DISC,
    LIMIT,
    TOLERANCE,
    TOOL,
    cleared,
    descents,
    made,
    require_sound,
    round_blank,
)

CUT = cleared("rough", DISC, stock=round_blank(54.0))


@pytest.mark.parametrize("climb", [True, False])
def test_engagement_and_air(climb: bool) -> None:
    cut = replace(CUT, climb=climb)
    moves = made(cut)
    require_sound(moves)
    found = levels(moves, 0.0)
    assert tuple(found) == cut.depths
    assert cut.stock is not None
    blank = cut.stock.arcs(TOLERANCE).contour
    for number, track in enumerate(found.values()):
        places = np.linspace(0.05, track.length - 0.05, 60)
        there = np.array([engagement(track, blank, TOOL.radius, each) for each in places])
        # What comes before the first contact at a depth, and the way out again, is air.
        assert np.max(there) <= LIMIT, number
        assert np.mean(there < 1e-3) <= 0.15
        assert np.quantile(there, 0.9) > math.radians(35.0)


def test_one_entry_and_no_retract() -> None:
    moves = made(CUT)
    assert sum(isinstance(move, Rapid) for move in moves) == 3  # over the place, down, and up
    down = descents(moves)
    # Straight down beside the blank: from the retract height, and from depth to depth.
    assert [way for way, _ in down] == [0.0, 0.0]
    places = [complex(*move.end[:2]) for move in moves if move.end[2] in CUT.depths]
    assert abs(places[0]) >= 54.0 + TOOL.radius


def test_it_ends_with_a_full_round_at_the_allowance() -> None:
    moves = made(CUT)
    ring = DISC.polyline(1e-4).contour.vertices
    for track in levels(moves, 0.0).values():
        points = dense(track, 12)
        apart = np.min(np.abs(points[:, None] - ring[None, ::2]), axis=1)
        # Chords of at most 0.2 mm, hence 1e-3 mm nearer than their ends.
        assert np.min(apart) >= TOOL.radius + CUT.allowance - 2e-3
        assert np.max(distances(ring, track)) <= TOOL.radius + CUT.allowance + 0.05


def test_all_of_the_blank_is_swept() -> None:
    """What is left, by shapely, is the disc and its allowance, to the chords of both."""
    moves = made(CUT)
    ring = DISC.polyline(1e-3).contour.vertices
    disc = shapely.Polygon(np.column_stack((ring.real, ring.imag)))
    blank = shapely.Point(0.0, 0.0).buffer(54.0, quad_segs=200)
    for track in levels(moves, 0.0).values():
        points = dense(track, 25)
        swept = shapely.LineString(np.column_stack((points.real, points.imag))).buffer(TOOL.radius)
        left = blank.difference(swept)
        assert left.buffer(1e-2).contains(disc)
        # Chords of arcs of 10 mm at most leave cusps below 0.05 mm of the buffer's own 16 sides.
        extra = left.difference(disc.buffer(CUT.allowance + 0.08))
        assert extra.area < 1e-3


def test_few_arcs() -> None:
    moves = made(CUT)
    arcs = sum(isinstance(move, ArcFeed) for move in moves)
    length = sum(track.length for track in levels(moves, 0.0).values())
    assert length / arcs > 8.0  # mm


def test_a_plate_is_roughed_from_its_corners() -> None:
    corners = np.array([-56 - 60j, 56 - 60j, 56 + 60j, -56 + 60j])
    plate = ExactBoundary("stock", hole=False, exact=Contour.polygon(corners))
    cut = replace(CUT, stock=plate, depths=(-4.0,))
    moves = made(cut)
    require_sound(moves)
    (track,) = levels(moves, 0.0).values()
    places = np.linspace(0.05, track.length - 0.05, 40)
    there = [engagement(track, plate.exact, TOOL.radius, each) for each in places]
    assert max(there) <= LIMIT
    swept = distances(0.999 * plate.exact.vertices, track)
    assert np.max(swept) <= TOOL.radius


def test_without_a_limit_the_stepover_is_one() -> None:
    """Then the engagement is at most that on a straight wall at the stepover."""
    cut = replace(CUT, tool=TOOL, depths=(-4.0,))
    (track,) = levels(made(cut), 0.0).values()
    assert cut.stock is not None
    blank = cut.stock.arcs(TOLERANCE).contour
    places = np.linspace(0.05, track.length - 0.05, 60)
    there = [engagement(track, blank, TOOL.radius, each) for each in places]
    assert max(there) <= math.acos(1.0 - 2.0 / TOOL.radius)


def test_a_blank_without_room_is_refused() -> None:
    with pytest.raises(GeometryError, match="blank is too small: ") as caught:
        made(replace(CUT, stock=round_blank(48.0)))
    assert caught.value.key == "stock"
    with pytest.raises(GeometryError, match="needs the outline of the blank"):
        made(replace(CUT, stock=None))


def test_a_blank_as_large_as_the_part() -> None:
    """Where the blank has no allowance the cutter runs in air there, and nowhere into the part."""
    cut = replace(CUT, stock=round_blank(52.0), depths=(-4.0,))
    moves = made(cut)
    require_sound(moves)
    (track,) = levels(moves, 0.0).values()
    places = np.linspace(0.05, track.length - 0.05, 40)
    blank = Contour.circle(52.0)
    assert max(engagement(track, blank, TOOL.radius, each) for each in places) <= LIMIT


@settings(max_examples=examples(8, long=15), deadline=None)
@given(curve=curves(), diameter=st.floats(2.0, 12.0), step=st.floats(0.2, 0.6))
def test_any_disc(curve: WorkingCurve, diameter: float, step: float) -> None:
    """Never nearer to the disc than the allowance, sound, and swept up to the wall."""
    wall = CurveBoundary("outline", hole=False, path=whole(curve))
    tool = replace(TOOL, diameter=diameter, stepover=step * 0.5 * diameter)
    try:
        ring = wall.polyline(1e-3, "fast").contour.vertices
        size = float(np.max(np.abs(ring)))
        cut = replace(
            CUT, tool=tool, walls=(wall,), depths=(-2.0,), stock=round_blank(size + 1.0),
            stepover=step * 0.5 * diameter,
        )  # fmt: skip
        moves = made(cut)
    except GeometryError:
        return  # no disc, or none for such a cutter
    require_sound(moves, tool)
    (track,) = levels(moves, 0.0).values()
    apart = distances(ring, track)
    # The ring's vertices lie on the disc; chords of it lie inside, or outside by its tolerance.
    assert np.min(apart) >= tool.radius + cut.allowance - 2e-3
    assert np.max(apart) <= tool.radius + cut.allowance + 0.06
