"""Simulation of the cut: areas and volumes in closed form, and every flaw, made on purpose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.moves import ArcFeed, Feed, Move, Point, Rapid, Stop, feed_course
from camgeo.milling.polygons import NOTHING, parts, polygon
from camgeo.milling.simulation import (
    Chamfer,
    Flaw,
    Known,
    Setup,
    Simulation,
    ToolRun,
    UprightBody,
    interior_point,
    simulate,
    swept_area,
    swept_areas_below,
    unlifted,
)
from camgeo.milling.strategies import rings
from camgeo_export.verify.gcode import Depth, depths

RADIUS = 3.0
FEED = 100.0
DEPTH = -4.0


def rectangle(width: float, height: float) -> Contour:
    corner = complex(0.5 * width, 0.5 * height)
    return Contour.polygon(np.array([-corner, corner.conjugate(), corner, -corner.conjugate()]))


PLATE = Setup((rectangle(100.0, 60.0),), top=0.0, bottom=DEPTH)

FINE = 2e-3 * 400.0
"""[mm^2] Chords within 1e-3 mm along some 400 mm of edge, on either side."""


def over(x: float, y: float, z: float, *moves: Move) -> tuple[Move, ...]:
    """Down at a place outside of material or at feed, some moves, and up again."""
    last = moves[-1].end if moves else (x, y, z)
    return (
        Rapid((x, y, 5.0)),
        Feed((x, y, z), FEED),
        *moves,
        Rapid((last[0], last[1], 5.0)),
    )


def circle(radius: float, z: float, turns: int = 1) -> tuple[Move, ...]:
    return over(
        radius,
        0.0,
        z,
        *(
            ArcFeed((end, 0.0, z), (0.0, 0.0), True, FEED)
            for end in [-radius, radius] * turns
        ),
    )  # fmt: skip


def ran(setup: Setup, *programs: Sequence[Move | Stop]) -> Simulation:
    runs = [
        ToolRun(f"cut {number}", tuple(moves), RADIUS)
        for number, moves in enumerate(programs, start=1)
    ]
    return simulate(setup, runs)


def flaws_of(found: Simulation, name: str) -> list[Flaw]:
    return [flaw for flaw in found.flaws if flaw.name == name]


def names(found: Simulation) -> list[str]:
    return [flaw.name for flaw in found.flaws]


def test_a_slot_takes_its_area_away() -> None:
    """A rectangle of the cutter's width, and half a circle at its end."""
    found = ran(PLATE, over(-60.0, 0.0, -2.0, Feed((0.0, 0.0, -2.0), FEED)))
    gone = 50.0 * 2.0 * RADIUS + 0.5 * math.pi * RADIUS**2
    assert found.flaws == ()
    assert [slab.z0 for slab in found.stages[0].slabs] == [DEPTH, -2.0]
    assert found.stages[0].volume == pytest.approx(4.0 * 6000.0 - 2.0 * gone, abs=2.0 * FINE)


def test_a_ramp_takes_away_what_lies_above_it() -> None:
    """From 0 to -4 over 40 mm, with slabs of 1 mm: the tip is below each for so many mm."""
    ramp = over(-20.0, 0.0, 0.0, Feed((20.0, 0.0, DEPTH), FEED))
    cuts = [over(-40.0, -25.0, float(-z), Feed((-39.0, -25.0, float(-z)), FEED)) for z in (1, 2, 3)]
    found = ran(PLATE, *cuts, ramp)
    before, after = found.stages[-2], found.stages[-1]
    for slab, whole in zip(after.slabs, before.slabs, strict=True):
        length = 10.0 * (slab.z0 - DEPTH)  # on which the tip is below the slab
        gone = 2.0 * RADIUS * length + math.pi * RADIUS**2
        assert whole.material.area - slab.material.area == pytest.approx(gone, abs=FINE)


def test_a_core_comes_loose() -> None:
    """What a bore wider than two cutters leaves: a disc of the path's radius less the cutter's."""
    held = replace(PLATE, held=((rectangle(100.0, 60.0), rectangle(90.0, 50.0)),))
    found = ran(held, circle(8.0, -2.0), circle(8.0, DEPTH))
    (loose,) = flaws_of(found, "loose")
    assert loose.operation == "cut 2"
    assert loose.value == pytest.approx(4.0 * math.pi * 5.0**2, abs=4.0 * FINE)
    assert abs(complex(*loose.place[:2])) < 5.0
    assert "a core of 10 x 10 mm" in loose.sentence
    # A cutter half as large as the bore leaves none.
    assert names(ran(held, circle(2.9, DEPTH))) == []


def test_a_part_that_nothing_holds() -> None:
    part = UprightBody("disc", DEPTH, 0.0, (Contour.circle(15.0),))
    frame = ((rectangle(100.0, 60.0), rectangle(90.0, 50.0)),)
    setup = replace(PLATE, part=(part,), held=frame)
    found = ran(setup, circle(18.0, -2.0), circle(18.0, DEPTH))
    (loose,) = found.flaws
    assert (loose.name, loose.operation) == ("loose", "cut 2")
    assert "the part" in loose.sentence
    # Held from below it stays; then the frame must be held too.
    assert names(ran(replace(setup, held=(*frame, part.contours)), circle(18.0, DEPTH))) == []
    # A skin holds it, and is no rest.
    skin = replace(setup, part=(replace(part, z0=-3.5),), joined=-3.5)
    assert names(ran(skin, circle(18.0, -3.5))) == []


def test_a_rest_has_its_thickness() -> None:
    part = UprightBody("disc", DEPTH, 0.0, (Contour.circle(15.0),))
    found = ran(replace(PLATE, part=(part,)), circle(18.3, DEPTH))
    (rest,) = found.flaws
    assert rest.name == "rest"
    assert rest.value == pytest.approx(0.3, abs=5e-3)
    assert "30.6 mm along X" in rest.sentence


@given(st.floats(0.05, 2.0))
@settings(max_examples=10)
def test_a_gouge_has_its_depth(depth: float) -> None:
    part = UprightBody("disc", DEPTH, 0.0, (Contour.circle(15.0),))
    found = ran(replace(PLATE, part=(part,)), circle(18.0 - depth, DEPTH))
    (gouge,) = flaws_of(found, "gouge")
    assert gouge.value == pytest.approx(depth, abs=5e-3)
    assert gouge.limit == 0.02
    assert abs(complex(*gouge.place[:2])) == pytest.approx(15.0 - depth, abs=5e-3)


def test_a_ramp_gouges_where_it_is_low_enough() -> None:
    """Above a floor at -2 it may go down to there."""
    floor = UprightBody("floor", DEPTH, -2.0, (rectangle(100.0, 60.0),))
    setup = replace(PLATE, part=(floor,))
    down = over(-20.0, 0.0, 0.0, Feed((20.0, 0.0, -2.0), FEED))
    assert names(ran(setup, down)) == ["rest"]
    deeper = over(-20.0, 0.0, 0.0, Feed((20.0, 0.0, -2.5), FEED))
    (gouge,) = flaws_of(ran(setup, deeper), "gouge")
    # The floor is entered where the ramp is below -2, at 4/5 of its length.
    assert gouge.place[0] > 12.0 - RADIUS


def one(*moves: Move, **own: Any) -> ToolRun:
    return ToolRun("cut", moves, RADIUS, **own)


LOW = (Rapid((-60.0, 0.0, 5.0)), Rapid((-60.0, 0.0, -1.0)), Rapid((0.0, 0.0, -1.0)))

DOWN = over(0.0, 0.0, -1.0, Feed((10.0, 0.0, -1.0), FEED))

HELIX = over(
    2.0, 0.0, 0.0,
    *(ArcFeed((x, 0.0, z), (0.0, 0.0), True, FEED) for x, z in ((-2.0, -0.5), (2.0, -1.0))),
)  # fmt: skip

CLAMPED = {"obstacles": (UprightBody("clamp", 0.0, 10.0, (rectangle(10.0, 60.0),)),)}

HUB = replace(PLATE, top=10.0)

PAST = (
    *over(-60.0, 34.0, 0.0, Feed((60.0, 34.0, 0.0), FEED)),
    Rapid((60.0, 34.0, 12.0)), Rapid((-60.0, 26.0, 12.0)),
    *over(-60.0, 26.0, -1.0, Feed((60.0, 26.0, -1.0), FEED)),
)  # fmt: skip
"""Along a hub that stands up 10 mm."""

TOLD: dict[str, tuple[Setup, list[ToolRun], str, Any, float]] = {
    "a traverse through material": (PLATE, [one(*LOW)], "rapid", pytest.approx(1.0), 0.0),
    "a traverse down into it": (
        PLATE, [one(Rapid((0.0, 0.0, 5.0)), Rapid((0.0, 0.0, -3.0)))], "rapid", pytest.approx(3.0),
        0.0,
    ),
    "a traverse in a slot": (
        PLATE, [one(*over(-60.0, 0.0, -2.0, Feed((0.0, 0.0, -2.0), FEED))), one(*LOW)], "", 0.0, 0.0
    ),
    "a plunge": (PLATE, [one(*DOWN)], "", 0.0, 0.0),
    "a plunge of a tool that must not": (
        PLATE, [one(*DOWN, plunges=False)], "plunge", pytest.approx(1.0), 0.0
    ),
    "a plunge beside the blank": (
        PLATE, [one(*over(-60.0, 0.0, -1.0, Feed((0.0, 0.0, -1.0), FEED)), plunges=False)],
        "", 0.0, 0.0,
    ),
    "down a helix": (PLATE, [one(*HELIX, plunges=False)], "", 0.0, 0.0),
    "an obstacle": (
        PLATE, [one(*over(-60.0, 0.0, -2.0, Feed((-7.0, 0.0, -2.0), FEED)), **CLAMPED)],
        "obstacle", pytest.approx(1.0, abs=0.01), 0.0,
    ),
    "above an obstacle": (
        PLATE, [one(Rapid((-60.0, 0.0, 12.0)), Rapid((60.0, 0.0, 12.0)), **CLAMPED)], "", 0.0, 0.0
    ),
    "a traverse below its top": (
        PLATE, [one(Rapid((-60.0, 0.0, 8.0)), Rapid((60.0, 0.0, 8.0)), **CLAMPED)],
        "obstacle", pytest.approx(RADIUS, abs=0.03), 0.0,
    ),
    "a tip that goes too deep": (
        replace(PLATE, lowest=-4.5), [one(*over(-60.0, 0.0, -5.0))], "depth", -5.0, -4.5
    ),
    "a tip as deep as it may": (
        replace(PLATE, lowest=-4.5), [one(*over(-60.0, 0.0, -4.5))], "", 0.0, 0.0
    ),
    "a shank in a hub": (HUB, [one(*PAST, shank=(5.0, 3.0))], "shank", pytest.approx(8.0), 0.0),
    "a slim shank": (HUB, [one(*PAST, shank=(2.9, 3.0))], "", 0.0, 0.0),
}  # fmt: skip
"""Setup and runs, and the only flaw: its name, empty for none, its value and its limit."""


@pytest.mark.parametrize("name", TOLD)
def test_what_a_cutter_runs_into(name: str) -> None:
    setup, runs, flaw, value, limit = TOLD[name]
    found = simulate(setup, runs).flaws
    told = [(each.name, each.value, each.limit) for each in found]
    assert told == ([(flaw, value, limit)] if flaw else [])
    if flaw == "obstacle":
        assert "clamp" in found[0].sentence
    if flaw == "plunge":
        assert found[0].place[:2] == pytest.approx((0.0, 0.0), abs=RADIUS)


def test_a_drill_clears_the_full_circle_above_its_point() -> None:
    """Below it a cone, in slabs each with its area half-way."""
    drilled = [ToolRun("hole", over(0.0, 0.0, -4.0), RADIUS, point=1.0)]
    (stage,) = simulate(PLATE, drilled).stages
    *point, high = stage.slabs
    assert [slab.z0 for slab in point] == pytest.approx([-4.0, -3.75, -3.5, -3.25])
    assert (high.z0, high.z1) == (-3.0, 0.0)
    for number, slab in enumerate(point):
        gone = math.pi * (RADIUS * (number + 0.5) / 4.0) ** 2
        assert slab.material.area == pytest.approx(6000.0 - gone, abs=0.05)
    assert high.material.area == pytest.approx(6000.0 - math.pi * RADIUS**2, abs=0.05)


@given(st.floats(0.1, 5.0), st.floats(0.0, 1.0), st.booleans())
def test_the_radius_at_a_height(radius: float, share: float, rounded: bool) -> None:
    """Grows up to the full one: a cone evenly, a corner along a quarter of a circle."""
    point = share * radius if rounded else share
    run = ToolRun("", (), radius, point=point, rounded=rounded)
    heights = np.linspace(0.0, 1.5 * point + 0.1, 40)
    found = run.cutter_radii(heights)
    assert np.all(np.diff(found) >= -1e-12)
    assert np.max(np.abs(found[heights >= point] - radius)) < 1e-12
    low = heights < point
    if rounded:
        off = np.hypot(found[low] - (radius - point), point - heights[low])
        assert off == pytest.approx(point)
    else:
        assert found[low] * point == pytest.approx(radius * heights[low])


CHAMFERED = replace(PLATE, part=(UprightBody("disc", DEPTH, 0.0, (Contour.circle(15.0),)),))


def cone(tip: float) -> ToolRun:
    """A point of 90 degrees: as wide at a height above its tip as that is."""
    return ToolRun(f"tip at {tip:g}", (), RADIUS, point=RADIUS)


def test_a_chamfer_is_no_gouge_and_a_missing_one_is_a_rest() -> None:
    around = over(
        -15.1, 0.0, -0.6,
        *(ArcFeed((x, 0.0, -0.6), (0.0, 0.0), True, FEED) for x in (15.1, -15.1)),
    )  # fmt: skip
    exact = feed_course(around[2:-1], (-15.1, 0.0, -0.6))
    setup = replace(
        CHAMFERED,
        blank=(Contour.circle(15.0),),
        chamfers=(Chamfer(cone(-0.6), exact, 0.0),),
    )
    sound = simulate(setup, [ToolRun("chamfer", around, RADIUS, point=RADIUS)])
    assert sound.flaws == ()
    # Z of the edge of the disc is that of the lower end of the chamfer, half-way in its slab.
    slab = sound.stages[-1].slabs[-1]
    width = 15.1 - 0.6 - slab.middle
    assert slab.material.area == pytest.approx(math.pi * width**2, abs=0.1)
    for lower in (0.1, 0.3):
        moves = tuple(
            replace(move, end=(*move.end[:2], move.end[2] - lower * (move.end[2] < 0.0)))
            for move in around
        )
        (gouge,) = simulate(setup, [ToolRun("low", moves, RADIUS, point=RADIUS)]).flaws
        assert gouge.name == "gouge"
        assert gouge.value == pytest.approx(lower, abs=0.01)
    (rest,) = simulate(setup, []).flaws or simulate(setup, [ToolRun("no", (), RADIUS)]).flaws
    assert rest.name == "rest"
    assert not rest.watched
    # Half-way in the highest slab.
    assert rest.value == pytest.approx(0.5 + slab.middle, abs=0.01)


@pytest.mark.parametrize(
    ("deeper", "left"), [(0.0, 1.0), (0.3, 1.0 - math.sqrt(0.3 * 1.7)), (1, 0)]
)
def test_rounded_corners_leave_a_fillet(deeper: float, left: float) -> None:
    """Of their radius on a floor; where the cut goes on below the part, what is above that."""
    setup = replace(PLATE, bottom=DEPTH - 1.0, part=CHAMFERED.part, joined=DEPTH)
    moves = circle(18.0, DEPTH - deeper, turns=2)
    found = simulate(setup, [ToolRun("finish", moves, RADIUS, point=1.0, rounded=True)])
    if not left:
        assert found.flaws == ()
        return
    (rest,) = found.flaws
    assert (rest.name, rest.watched) == ("rest", True)
    assert "where the corners of a cutter are rounded" in rest.sentence
    assert 0.4 * left < rest.value < left + 0.01


@settings(max_examples=10)
@given(st.lists(st.tuples(st.floats(-45.0, 45.0), st.floats(-25.0, 25.0)), min_size=2, max_size=6))
def test_a_second_run_takes_nothing_off(points: list[tuple[float, float]]) -> None:
    first, *others = points
    moves = over(*first, -2.0, *(Feed((x, y, -2.0), FEED) for x, y in others))
    found = ran(PLATE, moves, (moves[0], Stop("turn the clamp"), *moves[1:]))
    one, two = (stage.volume for stage in found.stages)
    assert one < 24_000.0
    assert two == pytest.approx(one, abs=1e-6)


def test_an_empty_program_leaves_the_blank() -> None:
    assert simulate(PLATE, [ToolRun("nothing", (), RADIUS)]).stages[0].volume == pytest.approx(
        24_000.0
    )
    start: Point = (0.0, 0.0, 5.0)
    assert (
        simulate(PLATE, [ToolRun("up", (Rapid((0.0, 0.0, 9.0)),), RADIUS, start=start)]).flaws == ()
    )


# -- sweep -----------------------------------------------------------------------------------------
# Areas that a cutter sweeps, against closed forms, within what their chords allow.


LINE: list[Move] = [Feed((20.0, 0.0, 0.0), FEED)]
ARC: list[Move] = [
    ArcFeed((-30.0, 0.0, 0.0), (0.0, 0.0), True, FEED),
    ArcFeed((30.0, 0.0, 0.0), (0.0, 0.0), True, FEED),
]


@pytest.mark.parametrize("fineness", [1e-2, 1e-3, 1e-4])
def test_a_line_and_a_ring(fineness: float) -> None:
    """The area is off by less than twice the fineness along the edge."""
    line = swept_area(feed_course(LINE, (0.0, 0.0, 0.0)), RADIUS, fineness)
    assert line.area == pytest.approx(120.0 + math.pi * 9.0, abs=2.0 * fineness * 2.0 * math.pi * 3)
    ring = swept_area(feed_course(ARC, (30.0, 0.0, 0.0)), RADIUS, fineness)
    edge = 2.0 * math.pi * (33.0 + 27.0)
    assert ring.area == pytest.approx(math.pi * (33.0**2 - 27.0**2), abs=2.0 * fineness * edge)
    outer, inner = rings(ring)
    for points, radius in ((outer, 33.0), (inner, 27.0)):
        assert np.max(np.abs(np.abs(points) - radius)) < 2.0 * fineness


def test_separate_pieces_are_joined_where_they_overlap() -> None:
    moves = [*LINE, Rapid((0.0, 5.0, 0.0)), Feed((20.0, 5.0, 0.0), FEED)]
    assert len(parts(swept_area(feed_course(moves, (0.0, 0.0, 0.0)), RADIUS, 1e-3))) == 1
    apart = swept_area(feed_course(moves, (0.0, 0.0, 0.0)), 2.0, 1e-3)
    assert len(parts(apart)) == 2
    assert abs(interior_point(apart).imag) < 8.0


def test_nothing_is_swept_by_nothing() -> None:
    assert swept_area(feed_course([]), RADIUS, 1e-3).is_empty
    assert parts(NOTHING) == []


def test_contours_within_contours_are_holes() -> None:
    found = polygon([Contour.circle(10.0), Contour.circle(4.0), Contour.circle(1.0)], 1e-4)
    assert found.area == pytest.approx(math.pi * (100.0 - 16.0 + 1.0), rel=1e-4)


@pytest.mark.parametrize("rounds", [2, 5])
def test_further_rounds_sweep_nothing_more(rounds: int) -> None:
    once = swept_area(feed_course(ARC, (30.0, 0.0, 0.0)), RADIUS, 1e-3)
    again = swept_area(feed_course(ARC * rounds, (30.0, 0.0, 0.0)), RADIUS, 1e-3)
    assert again.equals(once)
    assert len(again.exterior.coords) == len(once.exterior.coords)


def test_what_is_new_at_each_height_is_added() -> None:
    """Rounds at several depths, down a ramp each: as if each height were swept afresh."""
    fineness, step = 1e-3, 2.0
    moves: list[Move] = []
    for depth in (step, 2.0 * step):
        moves += [
            ArcFeed((-30.0, 0.0, -depth), (0.0, 0.0), True, FEED),
            ArcFeed((30.0, 0.0, -depth), (0.0, 0.0), True, FEED),
            ArcFeed((-30.0, 0.0, -depth), (0.0, 0.0), True, FEED),
        ]
        moves.append(Feed((30.0, 0.0, -depth), FEED))
    course = feed_course(moves, (30.0, 0.0, 0.0))
    heights = [-5.0, -4.0, -3.1, -2.0, -1.3, 0.0, 1.0]
    found = swept_areas_below(course, heights, RADIUS, fineness, {})
    for z, area in zip(heights, found, strict=True):
        afresh = swept_area(course.below(z), RADIUS, fineness)
        assert area.symmetric_difference(afresh).area < 4.0 * fineness * 4.0 * math.pi * 33.0
    assert found[0].is_empty
    assert found[-1] is found[-2]  # nothing is new there


def test_what_is_swept_again_is_the_same_object() -> None:
    """Ramps that end elsewhere in each pass, as read from a program, leave the areas as they are:
    what is asked of slabs is asked once.
    """
    around = [0.0, 0.4, 0.9, 2.0, 2.7, 3.5, 4.4, 5.2]
    moves: list[Move] = []
    for depth in range(1, 30):
        for lap in (around, [each + 0.01 * depth for each in around]):
            moves += [
                ArcFeed(
                    (30.0 * math.cos(end), 30.0 * math.sin(end), -depth), (0.0, 0.0), True, FEED
                )
                for end in [*lap[1:], lap[0]]
            ]
    course = feed_course(moves, (30.0, 0.0, 0.0))
    heights = [-29.0 + 0.5 * k for k in range(58)]
    known: Known = {}
    found = swept_areas_below(course, heights, RADIUS, 1e-3, known)
    assert len({id(each) for each in found}) == 1
    again = swept_areas_below(course, heights[:1], RADIUS, 1e-3, known)
    assert again[0] is known[next(iter(known))][0]


# -- course ----------------------------------------------------------------------------------------
# The course of a cutter: its pieces, and the parts of them below a height.


def test_traverses_and_halts_are_left_out() -> None:
    moves: list[Move | Stop] = [
        Rapid((0.0, 0.0, 5.0)),
        Feed((0.0, 0.0, -1.0), FEED),
        Stop("turn it"),
        Feed((4.0, 3.0, -1.0), FEED),
        Rapid((9.0, 9.0, -1.0)),
        ArcFeed((9.0, 5.0, -2.0), (9.0, 7.0), True, FEED),
    ]
    course = feed_course(moves)
    assert course.moves.tolist() == [1, 3, 5]
    assert course.lengths == pytest.approx([0.0, 5.0, 2.0 * math.pi])
    assert course.starts[2] == 9.0 + 9.0j
    assert course.from_z.tolist() == [5.0, -1.0, -1.0]
    assert course.lowest.tolist() == [-1.0, -1.0, -2.0]


@given(st.floats(-3.0, 1.0), st.booleans(), st.booleans())
def test_below_a_height_is_the_share_that_lies_there(z: float, down: bool, arc: bool) -> None:
    """A ramp between 0 and -2, on a line or an arc of the same length."""
    first, last = (0.0, -2.0) if down else (-2.0, 0.0)
    half = math.pi * 5.0
    ramp: Move = (
        ArcFeed((10.0, 0.0, last), (5.0, 0.0), True, FEED)
        if arc
        else Feed((half, 0.0, last), FEED)
    )  # fmt: skip
    course = feed_course([ramp], (0.0, 0.0, first))
    found = course.below(z)
    share = min(1.0, max(0.0, 0.5 * (z + 2.0)))
    assert math.fsum(found.lengths) == pytest.approx(share * half, abs=1e-9)
    if len(found):
        assert np.max(found.highest) <= z
        kept = found.ends[0] if down else found.starts[0]
        assert kept == (course.ends[0] if down else course.starts[0])
        # What was cut off ends on the same ramp.
        other = complex((found.starts if down else found.ends)[0])
        place = course.points_by_share(np.array([1.0 - share if down else share]))
        assert abs(other - place[0]) < 1e-9


@given(st.lists(st.floats(0.1, 3.0), min_size=1, max_size=9), st.floats(0.0, 2.0))
def test_pecks_are_one_plunge(steps: list[float], back: float) -> None:
    """However often the drill is lifted, and stops above the depth that it has reached."""
    place = (3.0, 4.0)
    depths = np.cumsum(steps).tolist()
    moves: list[Move] = [Rapid((*place, 5.0))]
    for k, depth in enumerate(depths):
        if k:
            moves += [Rapid((*place, 5.0)), Rapid((*place, back - depths[k - 1]))]
        moves.append(Feed((*place, -depth), FEED))
    moves += [Rapid((*place, 5.0)), Rapid((9.0, 9.0, 5.0))]
    whole = [moves[0], Feed((*place, -depths[-1]), FEED), *moves[-2:]]
    assert unlifted(moves) == whole


def test_lifts_after_which_it_is_not_the_same_stay() -> None:
    """A cut in the plane, or a traverse deeper than the hole."""
    down, up = Feed((0.0, 0.0, -2.0), FEED), Rapid((0.0, 0.0, 5.0))
    for again in (
        [Rapid((0.0, 0.0, -1.0)), Feed((4.0, 0.0, -1.0), FEED)],
        [Rapid((0.0, 0.0, -2.5)), Feed((0.0, 0.0, -3.0), FEED)],
        [Feed((0.0, 0.0, -1.5), FEED)],
    ):
        moves: list[Move] = [up, down, up, *again]
        assert unlifted(moves) == moves


# -- reach -----------------------------------------------------------------------------------------
# Material at a cutter: slots, passes, walls beside it, air, in closed form.


def run(*moves: Move, start: Point = (-60.0, 0.0, 5.0), radius: float = RADIUS) -> ToolRun:
    return ToolRun("cut", moves, radius, start=start)


def along(y: float, z: float) -> tuple[Move, ...]:
    """Through the plate along X, from outside to outside."""
    return Rapid((-60.0, y, 5.0)), Feed((-60.0, y, z), FEED), Feed((60.0, y, z), FEED)


def found(*runs: ToolRun, setup: Setup = PLATE) -> list[Depth]:
    return list(depths(setup, runs))


def worst(*runs: ToolRun) -> tuple[float, float]:
    each = found(*runs)
    return max(d.ahead for d in each), max(d.engagement for d in each)


def test_a_slot_and_its_passes() -> None:
    assert worst(run(*along(0.0, -3.0))) == (3.0, 3.0)
    assert worst(run(*along(0.0, -1.0), *along(0.0, -2.5))) == (1.5, 2.5)
    assert worst(run(*along(0.0, -1.0)), run(*along(0.0, -2.5))) == (1.5, 2.5)


def test_along_a_wall_that_is_roughed_nothing_stands_ahead() -> None:
    """The second cut takes 0.3 mm off the side of the first, at full depth."""
    rough, finish = run(*along(0.0, -4.0)), run(*along(0.3, -4.0))
    second = [each for each in found(rough, finish) if each.run == 1]
    assert max(each.ahead for each in second) == 0.0
    assert max(each.engagement for each in second) == 4.0


def test_air_is_no_material() -> None:
    assert worst(run(*along(40.0, -4.0))) == (0.0, 0.0)  # beside the plate
    assert worst(run(*along(0.0, 1.0))) == (0.0, 0.0)  # above it
    assert found(run(Feed((0.0, 0.0, -1.0), FEED), start=(0.0, 0.0, 5.0))) == []  # straight down


def test_a_ramp_digs_as_deep_as_it_has_come() -> None:
    down = Feed((20.0, 0.0, -2.0), FEED)
    (middle, end) = found(run(down, start=(-20.0, 0.0, 0.0)))
    assert middle.ahead == pytest.approx(1.0)
    assert end.ahead == pytest.approx(2.0)
    assert end.place == (20.0, 0.0, -2.0)


@pytest.mark.parametrize("ccw", [True, False])
def test_rounds_of_a_slot(ccw: bool) -> None:
    """What the cutter has just cut lies behind it, also on an arc."""

    def round_at(z: float) -> tuple[Move, ...]:
        return tuple(ArcFeed((x, 0.0, z), (0.0, 0.0), ccw, FEED) for x in (-10.0, 10.0))

    down = Feed((10.0, 0.0, -1.5), FEED), Feed((10.0, 0.0, -4.0), FEED)
    both = found(run(down[0], *round_at(-1.5), down[1], *round_at(-4.0), start=(10.0, 0.0, 5.0)))
    # The end of a round looks into its own beginning.
    assert [each.ahead for each in both[:3]] == pytest.approx([1.5] * 3)
    assert max(each.ahead for each in both[4:]) == pytest.approx(2.5)
    assert [each.move for each in both] == [1, 1, 2, 2, 4, 4, 5, 5]
