"""Engagement: closed forms, and any course against a count of points on the cutter's circle; traces
of programs by what they meet.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.geometry.contour.contour import Contour, Pieces, distances
from camgeo.milling.cut import AreaCut, ContourCut, Cut, PointCut
from camgeo.milling.machine import load
from camgeo.milling.milling import Heights
from camgeo.milling.moves import ArcFeed, Feed, Move, Operation, Point, Rapid, Toolpath, feed_course
from camgeo.milling.plan import (
    Cutting,
    crossings,
    entries,
    inside,
    operation_engagements,
    plan_toolpath,
)
from camgeo.numeric.arrays import ComplexArray, taken
from camgeo.part.boundaries import ExactBoundary
from camgeo.pictures.backplot import plot_operations
from tests.toolpath.milled import HEIGHTS, tool
from tests.toolpath.plane.tracks import any_track

RADIUS = 3.0
DEPTH = -1.0
FEED = 100.0

ROUNDING = 1e-12

BLANK = Contour.polygon(np.array([0.0, 100.0, 100.0 + 50.0j, 50.0j]))


def place(point: complex, z: float = DEPTH) -> Point:
    return (point.real, point.imag, z)


def line(*points: complex) -> tuple[Point, list[Move]]:
    return place(points[0]), [Feed(place(point), FEED) for point in points[1:]]


def cutting(start: Point, moves: list[Move], *blank: Contour) -> Cutting:
    return Cutting(feed_course(moves, start), RADIUS, blank or (BLANK,))


def at(found: Cutting, piece: int, share: float) -> tuple[complex, complex]:
    """Place and direction at a share of a piece."""
    here = taken(found.course, [piece])
    point = here.points_by_share(np.array([share]))
    return complex(point[0]), complex(here.tangents(point)[0])


def round_of(radius: float, turns: int = 1) -> tuple[Point, list[Move]]:
    """Full circles around the origin, counter-clockwise."""
    ends = [-radius, radius] * turns
    return place(radius), [ArcFeed(place(end), (0.0, 0.0), True, FEED) for end in ends]


def test_a_slot_is_half_a_turn() -> None:
    found = cutting(*line(-10.0 + 25.0j, 50.0 + 25.0j))
    assert found.angle(0, 0.9) == pytest.approx(math.pi, rel=ROUNDING)
    engagement = found.engagement(1.0)
    assert engagement.peak == pytest.approx(math.pi, rel=ROUNDING)
    # It is in air until its edge touches the blank, at x = -3.
    assert engagement.air_share == pytest.approx(7.0 / 60.0, abs=1e-7)
    assert engagement.quantile(0.05) == 0.0
    assert engagement.quantile(1.0) == pytest.approx(math.pi, rel=ROUNDING)


@pytest.mark.parametrize("x", [-2.9, -2.0, -0.5])
def test_a_cutter_that_enters_a_straight_wall(x: float) -> None:
    """The wall is a chord at the distance -x ahead of the centre."""
    found = cutting(*line(-10.0 + 25.0j, 50.0 + 25.0j))
    assert found.angle(0, (x + 10.0) / 60.0) == pytest.approx(
        2.0 * math.acos(-x / RADIUS), rel=1e-9
    )


@given(st.floats(0.01, 5.9), st.booleans(), st.floats(-math.pi, math.pi))
def test_a_wall_of_any_depth_on_either_side(depth: float, right: bool, turn: float) -> None:
    """cos = 1 - a/R; also where the whole is turned."""
    height = depth - RADIUS if right else 50.0 - depth + RADIUS
    way = cmath.exp(1j * turn)
    points = [complex(-10.0, height), complex(90.0, height)]
    start, moves = line(*(point * way for point in (points if right else points[::-1])))
    found = cutting(start, moves, Contour.polygon(BLANK.vertices * way))
    expected = math.acos(1.0 - depth / RADIUS)
    assert found.angle(0, 0.5) == pytest.approx(expected, abs=1e-9)


@given(st.floats(0.05, 5.5))
def test_the_second_pass_meets_what_the_first_one_left(over: float) -> None:
    start, moves = line(-10.0 + 20.0j, 90.0 + 20.0j)
    moves += [Rapid((90.0, 20.0, 5.0)), Rapid((-10.0, 20.0 + over, 5.0))]
    moves += line(-10.0 + (20.0 + over) * 1j, -10.0 + (20.0 + over) * 1j, 90 + (20 + over) * 1j)[1]
    found = cutting(start, moves)
    assert found.angle(2, 0.5) == pytest.approx(math.acos(1.0 - over / RADIUS), rel=1e-9)
    # Higher passes do not clear what is below them.
    high: list[Move] = [Feed((*move.end[:2], -0.5), FEED) for move in moves[:1]]
    assert cutting((*start[:2], -0.5), high + moves[1:]).angle(2, 0.5) == pytest.approx(math.pi)


def test_the_same_way_again_is_air() -> None:
    start, moves = round_of(20.0, turns=2)
    found = cutting(start, moves, Contour.circle(21.0)).engagement(2.0)
    first, second = found.pieces < 2, found.pieces >= 2
    assert np.sum(found.air[second]) == pytest.approx(np.sum(found.lengths[second]))
    assert np.all(found.air[first] < 0.05 * found.lengths[first])


@given(st.floats(0.05, 5.9), st.floats(20.0, 60.0), st.booleans())
def test_around_a_round_blank(depth: float, blank: float, outside: bool) -> None:
    """The triangle of both centres and the crossing has the sides R, rho and that of the blank."""
    # Outside of a disc, or inside of a hole.
    rho = blank - depth + RADIUS if outside else blank + depth - RADIUS
    contours = [Contour.circle(blank)]
    if not outside:
        contours.append(Contour.circle(200.0))
    found = cutting(*round_of(rho), *contours)
    cosine = (RADIUS**2 + rho**2 - blank**2) / (2.0 * RADIUS * rho)
    angle = math.acos(max(-1.0, min(1.0, cosine)))
    assert found.angle(0, 0.7) == pytest.approx(angle if outside else math.pi - angle, abs=1e-7)


def test_a_small_circle_in_full_material() -> None:
    """Its own way lies within the cutter: what is ahead on the inner side is gone already.

    The cutter passed over all points within R of the arc behind it; of the leading half, on the
    inner side, these begin at the angle of the earliest place of the course.
    """
    start, moves = round_of(1.0)
    found = cutting(start, moves, Contour.circle(50.0))
    count = np.linspace(0.0, math.pi, 2001)
    point, way = at(found, 0, 0.5)
    circle = point - 1j * way * RADIUS * np.exp(1j * count)
    before = np.exp(1j * np.linspace(0.0, 0.5 * math.pi, 501))
    free = np.min(np.abs(circle[:, None] - before), axis=1) >= RADIUS * (1.0 - 1e-9)
    assert found.angle(0, 0.5) == pytest.approx(math.pi * np.mean(free), abs=5e-3)
    assert found.angle(0, 0.5) < 0.9 * math.pi


places = st.builds(complex, st.floats(-15.0, 15.0), st.floats(-15.0, 15.0))


@st.composite
def walks(draw: st.DrawFn) -> tuple[Point, list[Move]]:
    """Lines and arcs between places around the origin."""
    at = draw(places)
    start = place(at)
    moves: list[Move] = []
    for _ in range(draw(st.integers(1, 6))):
        end = draw(places)
        assume(abs(end - at) > 0.1)
        if draw(st.booleans()):
            middle = 0.5 * (at + end) + draw(st.floats(-2.0, 2.0)) * 1j * (end - at)
            ccw = ((end - middle) / (at - middle)).imag >= 0.0
            moves.append(ArcFeed(place(end), (middle.real, middle.imag), ccw, FEED))
        else:
            moves.append(Feed(place(end), FEED))
        at = end
    return start, moves


def along(found: Cutting, piece: int, share: float, count: int) -> ComplexArray:
    return taken(found.course, [piece] * count).points_by_share(np.linspace(0.0, share, count))


@settings(max_examples=15)
@given(walks(), st.floats(0.05, 1.0))
def test_any_course_against_a_count_of_points(walk: tuple[Point, list[Move]], share: float) -> None:
    """The earlier course as places 0.05 mm apart; each passes over a little less than it should."""
    found = cutting(*walk, Contour.circle(12.0), Contour.circle(4.0, 5.0 + 1.0j))
    last = len(found.course) - 1
    lengths = found.course.lengths
    counts = [int(length / 0.05) + 2 for length in lengths]
    before = [along(found, piece, 1.0, counts[piece]) for piece in range(last)]
    before.append(along(found, last, share, counts[last]))
    point, way = at(found, last, share)
    circle = point + RADIUS * way * np.exp(1j * np.linspace(-0.5 * np.pi, 0.5 * np.pi, 2000))
    free = np.min(np.abs(circle[:, None] - np.concatenate(before)), axis=1)
    within = (np.abs(circle) < 12.0) & (np.abs(circle - 5.0 - 1.0j) > 4.0)
    loose = math.pi * float(np.mean(within & (free > RADIUS * (1.0 - 1e-9))))
    tight = math.pi * float(np.mean(within & (free > RADIUS + 0.01)))
    assert tight - 0.01 <= found.angle(last, share) <= loose + 0.01


def test_what_another_cutter_cleared_is_air() -> None:
    start, moves = line(10.0 + 25.0j, 90.0 + 25.0j)
    wide = feed_course(moves, start)
    found = Cutting(wide, RADIUS, (BLANK,), cleared=((wide, 5.0),))
    assert found.engagement(5.0).air_share == pytest.approx(1.0)
    assert Cutting(wide, RADIUS, (BLANK,), top=-2.0).engagement(5.0).peak == 0.0


def test_only_the_moves_that_are_asked_for() -> None:
    start, moves = line(10.0 + 25.0j, 50.0 + 25.0j, 50.0 + 30.0j)
    assert cutting(start, moves).engagement(1.0, only=[1]).pieces.tolist() == [1]


def test_nothing_to_cut() -> None:
    found = cutting((0.0, 0.0, DEPTH), []).engagement(1.0)
    assert (found.peak, found.air_share, found.quantile(0.5)) == (0.0, 0.0, 0.0)


# -- engaged ---------------------------------------------------------------------------------------
# The engagement of roughing operations: entries left out, holes that were drilled before.


TOLERANCE = 0.01

LIMIT = math.radians(55.0)

ROUND_BLANK = Contour.circle(20.0)

CUTTER = tool(10.0, engagement=LIMIT)

DRILL = tool(20.0, 2, kind="drill", tip_angle=math.radians(118.0))


def circle(name: str, radius: float, *, hole: bool) -> ExactBoundary:
    return ExactBoundary(name, hole=hole, exact=Contour.circle(radius))


BORED = AreaCut(
    name="bore", strategy="bore", tool=CUTTER, top=0.0, depths=(-3.0,), stepover=2.0,
    walls=(circle("bore", 11.0, hole=True),),
)  # fmt: skip

ROUGHED = AreaCut(
    name="rough", strategy="rough", tool=CUTTER, top=0.0, depths=(-3.0,), stepover=2.0,
    walls=(circle("outline", 14.0, hole=False),), stock=circle("stock", 20.0, hole=False),
)  # fmt: skip

DRILLED = PointCut(
    name="drill", strategy="drill", tool=DRILL, top=0.0, points=(0j,),
    depths=(-3.0 - DRILL.tip_length,),
)  # fmt: skip


def program(*cuts: Cut) -> Toolpath:
    return plan_toolpath(cuts, HEIGHTS, load("linuxcnc").arcs, TOLERANCE, "fast")


def half_turns(radius: float, *heights: float) -> tuple[Move, ...]:
    """Half a turn about (0, 0) to each height, from (radius, 0)."""
    return tuple(
        ArcFeed(((-1.0) ** (k + 1) * radius, 0.0, z), (0.0, 0.0), True, 100.0)
        for k, z in enumerate(heights)
    )


def test_a_helix_is_an_entry_with_the_round_on_its_floor() -> None:
    """What follows on another circle is not, nor a second round on that one."""
    start: Point = (5.0, 0.0, 0.0)
    helix = half_turns(5.0, -0.5, -1.0, -1.0, -1.0)
    level = half_turns(5.0, -1.0, -1.0)
    wider = ArcFeed((-6.0, 0.0, -1.0), (-0.5, 0.0), True, 100.0)
    course = feed_course((*helix, *level, wider), start)
    assert entries(course).tolist() == [True] * 4 + [False] * 3
    course = feed_course((*helix[:3], wider), start)
    assert entries(course).tolist() == [True] * 3 + [False]
    ramp = feed_course((Feed((0.0, 0.0, -1.0), 1.0), Feed((5.0, 0.0, -1.0), 1.0)), start)
    assert entries(ramp).tolist() == [True, False]


@pytest.fixture(scope="module")
def roughing() -> Toolpath:
    return program(BORED, ROUGHED)


def test_roughing_from_round_stock(roughing: Toolpath) -> None:
    bore, outline = operation_engagements(roughing, (ROUND_BLANK,), 0.0)
    assert (bore.operation, outline.operation) == ("bore", "rough")
    for each in (bore, outline):
        assert each.limit == LIMIT
        assert 0.5 * LIMIT < each.usual <= each.largest <= LIMIT
        assert each.air <= 0.15
    assert abs(bore.place) < 6.0 + TOLERANCE
    assert abs(outline.place) < 25.0
    assert outline.length > 2.0 * math.tau * 19.0


def test_the_limit_is_the_one_stated(roughing: Toolpath) -> None:
    """And not what the path keeps; without one it is that of a straight wall."""
    cuts = [replace(ROUGHED, tool=replace(CUTTER, engagement=each)) for each in (0.3, None)]
    moves = roughing.operations[1].moves[:30]
    for cut, limit in zip(cuts, (0.3, math.acos(1.0 - 2.0 / 5.0)), strict=True):
        (found,) = operation_engagements(
            replace(roughing, operations=(Operation(cut, moves),)), (ROUND_BLANK,), 0.0
        )
        assert found.limit == pytest.approx(limit)
        assert (found.largest > found.limit) == (limit == 0.3)


def test_what_is_drilled_before_is_air() -> None:
    """A drill clears its hole above its point, though it comes down from above."""
    (alone,) = operation_engagements(program(BORED), (ROUND_BLANK,), 0.0)
    (after,) = operation_engagements(program(DRILLED, BORED), (ROUND_BLANK,), 0.0)
    assert alone.air < 0.1
    assert after.air > 0.2
    # With its point alone at that depth it has not.
    low = replace(DRILLED, depths=(-3.0,))
    assert operation_engagements(program(low, BORED), (ROUND_BLANK,), 0.0) == (alone,)


def test_without_operations_that_clear_an_area() -> None:
    assert operation_engagements(Toolpath(HEIGHTS, ()), (ROUND_BLANK,), 0.0) == ()


# -- crossings -------------------------------------------------------------------------------------
# What closed contours enclose, and where circles meet lines and arcs.


RECTANGLE = Contour.polygon(np.array([-50.0 - 25.0j, 50.0 - 25.0j, 50.0 + 25.0j, -50.0 + 25.0j]))


@given(places, st.floats(1.0, 10.0))
@example(0j, 1.0)
def test_inside_of_contours(point: complex, radius: float) -> None:
    boundary = Pieces.around([Contour.circle(radius), RECTANGLE])
    if abs(abs(point) - radius) < 1e-9:
        return
    # Both together are the rectangle without the circle.
    assert inside(boundary, np.array([point]))[0] == (abs(point) > radius)


@pytest.mark.parametrize("distance", [0.0, 1.5])
@pytest.mark.parametrize("seed", range(10))
def test_a_circle_passes_a_distance_at_its_crossings_only(seed: int, distance: float) -> None:
    """Between neighbouring angles all points are nearer, or all are farther off."""
    rng = np.random.default_rng(seed)
    pieces = any_track(rng).pieces
    place, radius = complex(*rng.uniform(-5.0, 5.0, 2)), float(rng.uniform(1.0, 6.0))
    ends = np.sort(np.mod(crossings(pieces, place, radius, distance), 2.0 * np.pi))
    ends = np.concatenate(([0.0], ends, [2.0 * np.pi]))
    wide = np.flatnonzero(np.diff(ends) > 1e-6)
    shares = np.array([0.01, 0.3, 0.7, 0.99])
    angles = ends[wide, None] + np.diff(ends)[wide, None] * shares
    off = distances((place + radius * np.exp(1j * angles)).ravel(), pieces)
    farther = (off > distance).reshape(angles.shape)
    assert np.all(farther == farther[:, :1])


# -- traces ----------------------------------------------------------------------------------------
# Of a program: what is cut, in air, an entry or a traverse.


SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"


def test_kinds_of_a_program() -> None:
    """In from beside the blank, along it, down a ramp, and back through what is cut."""
    moves = (
        Rapid((-20.0, 25.0, 5.0)),
        Feed((-20.0, 25.0, -1.0), 100.0),
        Feed((-10.0, 25.0, -1.0), 300.0),
        Feed((20.0, 25.0, -1.0), 300.0),
        Feed((30.0, 25.0, -2.0), 100.0),
        ArcFeed((40.0, 25.0, -2.0), (35.0, 25.0), True, 300.0),
        Rapid((40.0, 25.0, 5.0)),
        Rapid((0.0, 0.0, 5.0)),
    )
    path = ExactBoundary("path", hole=False, exact=Contour.circle(10.0))
    cuts = [
        ContourCut(name=name, strategy="profile", tool=CUTTER, top=0.0, depths=(-2.0,), centre=path)
        for name in ("first", "second")
    ]
    toolpath = Toolpath(Heights(5.0, 5.0), tuple(Operation(cut, moves) for cut in cuts))
    first, second = plot_operations(toolpath, (BLANK,), 0.0, 0.01)
    kinds = [trace.kind for trace in first.traces]
    assert kinds == ["entry", "air", "cut", "entry", "cut", "rapid"]
    assert first.length("air") == pytest.approx(10.0)
    assert first.length("entry") == pytest.approx(10.0)
    assert first.length("rapid") == pytest.approx(abs(40.0 + 25.0j))
    arc = first.traces[4].points
    assert abs(arc[0] - 30.0 - 25.0j) < 1e-12
    assert np.allclose(np.abs(arc - 35.0 - 25.0j), 5.0)
    # What the first operation cut is air for the second.
    assert [trace.kind for trace in second.traces] == ["entry", "air", "entry", "air", "rapid"]


def test_traces_have_the_length_of_the_course() -> None:
    design = camgeo.load(SCENES / "setzhub.toml")
    toolpath = design.disc.milled.toolpath(0.01)
    for each in plot_operations(toolpath, (BLANK,), 0.0, 1e-4):
        course = feed_course(each.operation.moves)
        fed = sum(each.length(kind) for kind in ("cut", "air", "entry"))
        assert fed == pytest.approx(float(np.sum(course.lengths)), rel=1e-4)
