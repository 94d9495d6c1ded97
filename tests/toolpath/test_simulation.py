"""Simulation of the cut: areas and volumes in closed form, and every flaw, made on purpose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.course import course_of
from camgeo.milling.moves import ArcFeed, Feed, Move, Point, Rapid, Stop
from camgeo.milling.simulation import Simulation, simulate
from camgeo.milling.stages import Body, Chamfer, Flaw, Run, Setup

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


def ran(setup: Setup, *programs: Sequence[Move | Stop], plunges: bool = True) -> Simulation:
    runs = [
        Run(f"cut {number}", tuple(moves), RADIUS, plunges=plunges)
        for number, moves in enumerate(programs, start=1)
    ]
    return simulate(setup, runs)


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
    (loose,) = found.of("loose")
    assert loose.operation == "cut 2"
    assert loose.value == pytest.approx(4.0 * math.pi * 5.0**2, abs=4.0 * FINE)
    assert abs(complex(*loose.place[:2])) < 5.0
    assert "a core of 10 x 10 mm" in loose.sentence
    # A cutter half as large as the bore leaves none.
    assert names(ran(held, circle(2.9, DEPTH))) == []


def test_a_part_that_nothing_holds() -> None:
    part = Body("disc", DEPTH, 0.0, (Contour.circle(15.0),))
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
    part = Body("disc", DEPTH, 0.0, (Contour.circle(15.0),))
    found = ran(replace(PLATE, part=(part,)), circle(18.3, DEPTH))
    (rest,) = found.flaws
    assert rest.name == "rest"
    assert rest.value == pytest.approx(0.3, abs=5e-3)
    assert "30.6 mm along X" in rest.sentence


@given(st.floats(0.05, 2.0))
@settings(max_examples=10)
def test_a_gouge_has_its_depth(depth: float) -> None:
    part = Body("disc", DEPTH, 0.0, (Contour.circle(15.0),))
    found = ran(replace(PLATE, part=(part,)), circle(18.0 - depth, DEPTH))
    (gouge,) = found.of("gouge")
    assert gouge.value == pytest.approx(depth, abs=5e-3)
    assert gouge.limit == 0.02
    assert abs(complex(*gouge.place[:2])) == pytest.approx(15.0 - depth, abs=5e-3)


def test_a_ramp_gouges_where_it_is_low_enough() -> None:
    """Above a floor at -2 it may go down to there."""
    floor = Body("floor", DEPTH, -2.0, (rectangle(100.0, 60.0),))
    setup = replace(PLATE, part=(floor,))
    down = over(-20.0, 0.0, 0.0, Feed((20.0, 0.0, -2.0), FEED))
    assert names(ran(setup, down)) == ["rest"]
    deeper = over(-20.0, 0.0, 0.0, Feed((20.0, 0.0, -2.5), FEED))
    (gouge,) = ran(setup, deeper).of("gouge")
    # The floor is entered where the ramp is below -2, at 4/5 of its length.
    assert gouge.place[0] > 12.0 - RADIUS


def test_a_traverse_through_material() -> None:
    low: list[Move] = [Rapid((-60.0, 0.0, 5.0)), Rapid((-60.0, 0.0, -1.0)), Rapid((0.0, 0.0, -1.0))]
    (rapid,) = ran(PLATE, low).flaws
    assert rapid.name == "rapid"
    assert rapid.value == pytest.approx(1.0)
    assert rapid.limit == 0.0
    into: list[Move] = [Rapid((0.0, 0.0, 5.0)), Rapid((0.0, 0.0, -3.0))]
    (down,) = ran(PLATE, into).flaws
    assert down.name == "rapid"
    assert down.value == pytest.approx(3.0)
    # In a slot that is cut already it is none.
    slot = over(-60.0, 0.0, -2.0, Feed((0.0, 0.0, -2.0), FEED))
    assert names(ran(PLATE, slot, low)) == []


def test_a_plunge_of_a_tool_that_must_not() -> None:
    program = over(0.0, 0.0, -1.0, Feed((10.0, 0.0, -1.0), FEED))
    assert names(ran(PLATE, program)) == []
    (plunge,) = ran(PLATE, program, plunges=False).flaws
    assert plunge.name == "plunge"
    assert plunge.value == pytest.approx(1.0)
    assert plunge.place[:2] == pytest.approx((0.0, 0.0), abs=RADIUS)
    # Beside the blank, and down a helix, it may.
    beside = over(-60.0, 0.0, -1.0, Feed((0.0, 0.0, -1.0), FEED))
    helix = over(
        2.0, 0.0, 0.0, *(ArcFeed((x, 0.0, z), (0.0, 0.0), True, FEED)
                         for x, z in ((-2.0, -0.5), (2.0, -1.0))),
    )  # fmt: skip
    assert names(ran(PLATE, beside, helix, plunges=False)) == []


def test_obstacles_below_their_tops() -> None:
    clamp = Body("clamp", 0.0, 10.0, (rectangle(10.0, 60.0),))

    def flaws(moves: Sequence[Move]) -> tuple[Flaw, ...]:
        return simulate(PLATE, [Run("slot", tuple(moves), RADIUS, obstacles=(clamp,))]).flaws

    (touched,) = flaws(over(-60.0, 0.0, -2.0, Feed((-7.0, 0.0, -2.0), FEED)))
    assert touched.name == "obstacle"
    assert touched.value == pytest.approx(1.0, abs=0.01)
    assert "clamp" in touched.sentence
    assert flaws([Rapid((-60.0, 0.0, 12.0)), Rapid((60.0, 0.0, 12.0))]) == ()
    (low,) = flaws([Rapid((-60.0, 0.0, 8.0)), Rapid((60.0, 0.0, 8.0))])
    assert low.name == "obstacle"


def test_a_tip_that_goes_too_deep() -> None:
    setup = replace(PLATE, lowest=-4.5)
    (deep,) = ran(setup, over(-60.0, 0.0, -5.0)).flaws
    assert (deep.name, deep.value, deep.limit) == ("depth", -5.0, -4.5)
    assert names(ran(setup, over(-60.0, 0.0, -4.5))) == []


def test_a_shank_in_a_hub() -> None:
    """A shank of 5 mm above edges of 3 mm, along a hub that stands up 10 mm."""
    hub = replace(PLATE, top=10.0)
    past = over(-60.0, 26.0, -1.0, Feed((60.0, 26.0, -1.0), FEED))
    cleared = over(-60.0, 34.0, 0.0, Feed((60.0, 34.0, 0.0), FEED))
    lift = Rapid((60.0, 34.0, 12.0)), Rapid((-60.0, 26.0, 12.0))
    runs = [Run("past", (*cleared, *lift, *past), RADIUS, shank=(5.0, 3.0))]
    (rubs,) = simulate(hub, runs).flaws
    assert rubs.name == "shank"
    assert rubs.value == pytest.approx(8.0)
    slim = [replace(runs[0], shank=(2.9, 3.0))]
    assert simulate(hub, slim).flaws == ()


def test_a_drill_clears_the_full_circle_above_its_point() -> None:
    """Below it a cone, in slabs each with its area half-way."""
    drilled = [Run("hole", over(0.0, 0.0, -4.0), RADIUS, point=1.0)]
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
    run = Run("", (), radius, point=point, rounded=rounded)
    heights = np.linspace(0.0, 1.5 * point + 0.1, 40)
    found = run.radius_at(heights)
    assert np.all(np.diff(found) >= -1e-12)
    assert np.max(np.abs(found[heights >= point] - radius)) < 1e-12
    low = heights < point
    if rounded:
        off = np.hypot(found[low] - (radius - point), point - heights[low])
        assert off == pytest.approx(point)
    else:
        assert found[low] * point == pytest.approx(radius * heights[low])


CHAMFERED = replace(PLATE, part=(Body("disc", DEPTH, 0.0, (Contour.circle(15.0),)),))


def cone(tip: float) -> Run:
    """A point of 90 degrees: as wide at a height above its tip as that is."""
    return Run(f"tip at {tip:g}", (), RADIUS, point=RADIUS)


def test_a_chamfer_is_no_gouge_and_a_missing_one_is_a_rest() -> None:
    around = over(
        -15.1, 0.0, -0.6,
        *(ArcFeed((x, 0.0, -0.6), (0.0, 0.0), True, FEED) for x in (15.1, -15.1)),
    )  # fmt: skip
    exact = course_of(around[2:-1], (-15.1, 0.0, -0.6))
    setup = replace(
        CHAMFERED,
        blank=(Contour.circle(15.0),),
        chamfers=(Chamfer(cone(-0.6), exact, 0.0),),
    )
    sound = simulate(setup, [Run("chamfer", around, RADIUS, point=RADIUS)])
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
        (gouge,) = simulate(setup, [Run("low", moves, RADIUS, point=RADIUS)]).flaws
        assert gouge.name == "gouge"
        assert gouge.value == pytest.approx(lower, abs=0.01)
    (rest,) = simulate(setup, []).flaws or simulate(setup, [Run("no", (), RADIUS)]).flaws
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
    found = simulate(setup, [Run("finish", moves, RADIUS, point=1.0, rounded=True)])
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
    found = simulate(PLATE, [Run("nothing", (), RADIUS)])
    assert found.stages[0].volume == pytest.approx(24_000.0)
    start: Point = (0.0, 0.0, 5.0)
    assert simulate(PLATE, [Run("up", (Rapid((0.0, 0.0, 9.0)),), RADIUS, start=start)]).flaws == ()
