"""The engagement of roughing operations: entries left out, holes that were drilled before."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.course import course_of
from camgeo.milling.cut import AreaCut, Cut, PointCut
from camgeo.milling.machine import load
from camgeo.milling.moves import ArcFeed, Feed, Move, Operation, Point, Toolpath
from camgeo.milling.plan import engaged, entries, plan_toolpath
from camgeo.part.boundaries import ExactBoundary
from tests.toolpath.milled import HEIGHTS, tool

TOLERANCE = 0.01

LIMIT = math.radians(55.0)

BLANK = Contour.circle(20.0)

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
    course = course_of((*helix, *level, wider), start)
    assert entries(course).tolist() == [True] * 4 + [False] * 3
    course = course_of((*helix[:3], wider), start)
    assert entries(course).tolist() == [True] * 3 + [False]
    ramp = course_of((Feed((0.0, 0.0, -1.0), 1.0), Feed((5.0, 0.0, -1.0), 1.0)), start)
    assert entries(ramp).tolist() == [True, False]


@pytest.fixture(scope="module")
def roughing() -> Toolpath:
    return program(BORED, ROUGHED)


def test_roughing_from_round_stock(roughing: Toolpath) -> None:
    bore, outline = engaged(roughing, (BLANK,), 0.0)
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
        (found,) = engaged(replace(roughing, operations=(Operation(cut, moves),)), (BLANK,), 0.0)
        assert found.limit == pytest.approx(limit)
        assert (found.largest > found.limit) == (limit == 0.3)


def test_what_is_drilled_before_is_air() -> None:
    """A drill clears its hole above its point, though it comes down from above."""
    (alone,) = engaged(program(BORED), (BLANK,), 0.0)
    (after,) = engaged(program(DRILLED, BORED), (BLANK,), 0.0)
    assert alone.air < 0.1
    assert after.air > 0.2
    # With its point alone at that depth it has not.
    low = replace(DRILLED, depths=(-3.0,))
    assert engaged(program(low, BORED), (BLANK,), 0.0) == (alone,)


def test_without_operations_that_clear_an_area() -> None:
    assert engaged(Toolpath(HEIGHTS, ()), (BLANK,), 0.0) == ()
