"""Clearing of areas: holes, outsides, faces, grooves and slots by loops; what is left and what is
not touched, engagement, air; and no contact of cutter and wall faster than the tool's feed."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.contour import Contour, distances
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.milling.clear import HELIX
from camgeo.milling.cut import AreaCut, ContourCut, Cut, PointCut
from camgeo.milling.moves import ArcFeed, Feed, Rapid
from camgeo.milling.strategies import NARROWEST, largest_advance, loop_engagement
from camgeo.milling.track import Track, chain_tracks
from camgeo.milling.walk import centre_feed
from camgeo.numeric.arrays import FloatArray
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from tests.contour.cams import curves, dwell, flank, move, translating
from tests.long_form import examples
from tests.measuring import polygon
from tests.part.parts import refused
from tests.toolpath.cutting import engagements, levels, steps_of, swept
from tests.toolpath.strategies.sound import (
    DISC,
    HEIGHTS,
    LIMIT,
    TOLERANCE,
    TOOL,
    cleared,
    descents,
    made,
    require_allowance,
    require_sound,
    round_blank,
    round_hole,
    steepest,
)
from tests.toolpath.strategies.test_around import FINISH, SLOT

RING = CurveBoundary(
    "outline",
    hole=True,
    path=whole(
        replace(translating(dwell(60), move(120, 15.0), dwell(40), move(140, 0.0)), distance=8.0)
    ),
)

BORED = cleared("bore", round_hole(20.0), name="rough bore", top=0.5, allowance=0.1)


@pytest.mark.parametrize(
    "wall", [round_hole(r) for r in (5.6, 8.0, 9.7, 10.2, 12.0, 25.0)] + [RING]
)
def test_a_hole_is_cleared(wall: Boundary) -> None:
    """No core, whatever the width; never nearer to the wall than the allowance."""
    cut = replace(BORED, walls=(wall,))
    moves = made(cut)
    require_sound(moves, rapids=3)
    last = levels(moves, cut.top)[cut.bottom]
    require_allowance(last, cut, 0.05)
    hole = polygon(wall.polyline(1e-3).contour.vertices)
    left = hole.buffer(-cut.allowance - 0.08).difference(swept(last, TOOL.radius))
    assert left.area < 1e-3


def test_the_way_down_is_a_helix() -> None:
    """No steeper than the tool may run, of a radius that leaves nothing in the middle."""
    moves = made(BORED)
    slopes = [drop / way for way, drop in descents(moves) if way > 0.0]
    assert steepest(moves) == pytest.approx(min(slopes), rel=0.5)
    straight = [drop for way, drop in descents(moves) if way == 0.0]
    assert straight == pytest.approx([HEIGHTS.retract - BORED.top])
    helix = [step for step in steps_of(moves) if step.way and step.low < step.high]
    assert {round(abs(step.end), 6) for step in helix} == {HELIX * TOOL.radius}
    assert all(step.sweep > 0.0 for step in helix)


def test_engagement_in_a_hole() -> None:
    track = levels(made(BORED), BORED.top)[BORED.bottom]
    # What the helix has opened before it is there already.
    turned = 2.0 * math.pi * HELIX * TOOL.radius
    there = engagements(track, Contour.circle(60.0), TOOL.radius, 60, turned + 0.05, 6.0)
    assert np.max(there) <= LIMIT


def test_a_hole_that_is_there_saves_the_helix() -> None:
    cut = replace(BORED, cleared=(round_hole(9.0),))
    moves = made(cut)
    require_sound(moves)
    assert all(way == 0.0 for way, _ in descents(moves))
    assert levels(moves, cut.top)[cut.bottom].length < levels(made(BORED), 0.5)[cut.bottom].length
    assert min(abs(complex(*each.end[:2])) for each in moves) >= 3.5


def test_a_hole_too_small_for_the_cutter_is_ignored() -> None:
    assert made(replace(BORED, cleared=(round_hole(5.2),))) == made(BORED)


def test_feed_is_that_at_the_wall() -> None:
    rounds = [step for step in steps_of(made(BORED)) if step.sweep and step.low == BORED.bottom]
    slowest = centre_feed(TOOL.feed, HELIX * TOOL.radius, TOOL.radius, inside=True)
    assert min(each.feed for each in rounds) >= 0.5 * slowest
    for each in rounds:
        if each.sweep > 0.0:
            at_wall = each.feed * (each.radius + TOOL.radius) / each.radius
            assert at_wall == pytest.approx(TOOL.feed)


def test_a_cutter_too_large_is_refused() -> None:
    with pytest.raises(GeometryError):
        made(replace(BORED, walls=(round_hole(5.0),)))


ROUGHED = cleared("rough", DISC, stock=round_blank(54.0))


CORNERS = np.array([-56 - 60j, 56 - 60j, 56 + 60j, -56 + 60j])

OBLONG = ExactBoundary("stock", hole=False, exact=Contour.polygon(CORNERS))


@pytest.mark.parametrize("changes", [{"depths": (-4.0, -8.0)}, {"climb": False}])
def test_engagement_outside(changes: dict[str, Any]) -> None:
    """What comes before the first contact at a depth, and the way out again, is air."""
    for there in engaged_outside({"depths": (-4.0,), **changes}, LIMIT):
        assert np.mean(there < 1e-3) <= 0.15
        assert np.quantile(there, 0.9) > math.radians(35.0)


@pytest.mark.parametrize(
    ("changes", "limit"),
    [
        ({"stock": OBLONG}, LIMIT),
        # Where the blank has no allowance the cutter runs in air there.
        ({"stock": round_blank(52.0)}, LIMIT),
        # Without a limit it is that on a straight wall at the stepover.
        ({"tool": TOOL}, math.acos(1.0 - 2.0 / TOOL.radius)),
    ],
    ids=["a plate", "a blank as large as the part", "no limit"],
)
def test_engagement_in_other_blanks(changes: dict[str, Any], limit: float) -> None:
    assert engaged_outside({"depths": (-4.0,), **changes}, limit)


def engaged_outside(changes: dict[str, Any], limit: float) -> list[FloatArray]:
    """At each depth (n,) [rad], at most `limit`; a plate is cut up to its corners."""
    cut = replace(ROUGHED, **changes)
    moves = made(cut)
    require_sound(moves)
    found = levels(moves, 0.0)
    assert tuple(found) == cut.depths
    assert cut.stock is not None
    blank = cut.stock.arcs(TOLERANCE).contour
    if cut.stock is OBLONG:
        for track in found.values():
            assert np.max(distances(0.999 * OBLONG.exact.vertices, track)) <= TOOL.radius
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
    moves = made(ROUGHED)
    require_sound(moves, rapids=3)
    # Straight down beside the blank: from the retract height, and from depth to depth.
    assert [way for way, _ in descents(moves)] == [0.0, 0.0]
    places = [complex(*move.end[:2]) for move in moves if move.end[2] in ROUGHED.depths]
    assert abs(places[0]) >= 54.0 + TOOL.radius
    tracks = levels(moves, 0.0).values()
    disc = polygon(DISC.polyline(1e-3).contour.vertices)
    blank = shapely.Point(0.0, 0.0).buffer(54.0, quad_segs=200)
    for track in tracks:
        require_allowance(track, ROUGHED, 0.05)
        left = blank.difference(swept(track, TOOL.radius))
        assert left.buffer(1e-2).contains(disc)
        # Chords of arcs of 10 mm at most leave cusps below 0.05 mm of the buffer's own 16 sides.
        assert left.difference(disc.buffer(ROUGHED.allowance + 0.08)).area < 1e-3
    arcs = sum(isinstance(move, ArcFeed) for move in moves)
    assert sum(track.length for track in tracks) / arcs > 8.0  # mm


def test_a_blank_without_room_is_refused() -> None:
    with refused("stock", "blank is too small: "):
        made(replace(ROUGHED, stock=round_blank(48.0)))
    with pytest.raises(GeometryError, match="needs the outline of the blank"):
        made(replace(ROUGHED, stock=None))


@settings(max_examples=examples(8, long=15), deadline=None)
@given(curve=curves(), diameter=st.floats(2.0, 12.0), step=st.floats(0.2, 0.6))
def test_roughing_of_any_disc(curve: WorkingCurve, diameter: float, step: float) -> None:
    """Never nearer to the disc than the allowance, sound, and swept up to the wall."""
    wall = CurveBoundary("outline", hole=False, path=whole(curve))
    tool = replace(TOOL, diameter=diameter, stepover=step * 0.5 * diameter)
    try:
        size = float(np.max(np.abs(wall.polyline(1e-3, "fast").contour.vertices)))
        cut = replace(
            ROUGHED, tool=tool, walls=(wall,), depths=(-2.0,), stock=round_blank(size + 1.0),
            stepover=step * 0.5 * diameter,
        )  # fmt: skip
        moves = made(cut)
    except GeometryError:
        return  # no disc, or none for such a cutter
    require_sound(moves, tool)
    (track,) = levels(moves, 0.0).values()
    require_allowance(track, cut, 0.06)


PLATE = ExactBoundary(
    "stock", hole=False, exact=Contour.polygon(np.array([-30 - 20j, 50 - 20j, 50 + 30j, -30 + 30j]))
)

FACE = AreaCut(
    name="face", strategy="face", tool=replace(TOOL, stepover=6.0), top=2.0, depths=(1.0, 0.0),
    walls=(), stock=PLATE, stepover=6.0,
)  # fmt: skip

INNER = translating(dwell(60), move(120, 15.0), dwell(40), move(140, 0.0))

FLANKS = (
    CurveBoundary("inner flank", hole=False, path=whole(INNER)),
    CurveBoundary("outer flank", hole=True, path=whole(replace(INNER, distance=8.0))),
)
"""Of a groove 16 mm wide."""

GROOVE = cleared("rough", *FLANKS, name="rough groove", tool=TOOL, depths=(-3.0, -6.0))


@pytest.mark.parametrize("blank", [PLATE, round_blank(45.0)])
def test_a_face_is_cut_all_over(blank: Boundary) -> None:
    cut = replace(FACE, stock=blank)
    moves = made(cut)
    require_sound(moves, rapids=3)
    found = levels(moves, cut.top)
    assert tuple(found) == cut.depths
    contour = blank.arcs(TOLERANCE).contour
    whole_face = polygon(contour.points(1e-3))
    for track in found.values():
        assert whole_face.difference(swept(track, TOOL.radius)).area < 1e-6
        most = np.max(engagements(track, contour, TOOL.radius, 40))
        assert most <= math.acos(1.0 - 6.0 / TOOL.radius) + 1e-6


@pytest.mark.parametrize("diameter", [8.0, 10.0, 15.0])
def test_a_groove_is_cleared_to_the_allowance(diameter: float) -> None:
    """Both depths are ways without a break."""
    cut = replace(GROOVE, tool=replace(TOOL, diameter=diameter, stepover=2.0))
    moves = made(cut)
    require_sound(moves, rapids=3)
    found = levels(moves, cut.top)
    assert set(found) == set(cut.depths)
    for track in found.values():
        require_allowance(track, cut, 0.1)


@pytest.mark.parametrize(
    ("changes", "message", "key"),
    [
        ({"walls": FLANKS[:1]}, "outline of the blank", "stock"),
        ({"tool": replace(TOOL, diameter=15.8)}, "narrower than the groove of 16 mm", "tool"),
        ({"stepover": 1e-6}, "more than 500 rounds would be", "tool.stepover"),  # as spirals
        ({"walls": (*FLANKS, round_hole(5.0))}, "at most one wall", "part"),
    ],
)
def test_what_cannot_be_cleared(changes: dict[str, Any], message: str, key: str) -> None:
    with refused(key, message):
        made(replace(GROOVE, **changes))


def test_moves_end_where_no_program_can_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of one cut alone, before the others are made."""
    count = len(made(GROOVE))
    monkeypatch.setattr("camgeo.milling.walk.PROGRAM_LINES", count // 2)
    with pytest.raises(FileError, match="the limit for a program that is read"):
        made(GROOVE)


def test_holes_are_drilled_in_pecks() -> None:
    cut = PointCut(
        name="holes", strategy="drill", tool=TOOL, top=0.0, depths=(-3.0, -6.0, -9.0),
        points=(10 + 0j, -10 + 5j),
    )  # fmt: skip
    moves = made(cut)
    require_sound(moves, replace(TOOL, plunge_feed=TOOL.feed))
    for place in cut.points:
        there = [move for move in moves if complex(*move.end[:2]) == place]
        down = [move.end[2] for move in there if isinstance(move, Feed)]
        assert tuple(down) == cut.depths
        up = [move.end[2] for move in there if isinstance(move, Rapid)]
        assert up.count(HEIGHTS.retract) == 4  # above the hole, and after each peck
    assert all(move.feed == TOOL.plunge_feed for move in moves if isinstance(move, Feed))


FULL = Contour.circle(300.0)
"""A blank without an edge near the slot."""

LOOPS = cleared("trochoid", DISC, slot=16.0)


@pytest.mark.parametrize(("wall", "climb"), [(DISC, True), (RING, False)])
def test_engagement_keeps_its_limit(wall: Boundary, climb: bool) -> None:
    """By what the cutter has swept, independent of the spacing."""
    moves = made(replace(LOOPS, walls=(wall,), climb=climb))
    require_sound(moves)
    # Behind the first round of the helix.
    found = engagements(levels(moves, 0.0)[-8.0], FULL, TOOL.radius, 15, 6.0 * math.pi + 0.1)
    assert 0.5 * LIMIT < np.max(found) <= LIMIT


def test_one_entry_by_a_helix_and_no_retract() -> None:
    moves = made(LOOPS)
    require_sound(moves, rapids=3)
    assert sum(drop for _, drop in descents(moves)[1:]) == pytest.approx(8.0)
    assert steepest(moves) > 0.0


def test_the_slot_is_swept_up_to_the_allowance() -> None:
    """No core, no cusps along the wall, and no wider than it says."""
    (track,) = levels(made(replace(LOOPS, depths=(-4.0,))), 0.0).values()
    require_allowance(track, LOOPS, 0.05)
    for off in np.linspace(LOOPS.allowance + 0.1, LOOPS.allowance + LOOPS.slot - 0.6, 9):
        beside = DISC.offset(float(off)).arcs(0.01, "fast").contour.points(0.05)
        assert np.max(distances(beside, track)) <= TOOL.radius
    wall = Track.around(DISC.arcs(1e-3, "fast").contour)
    widest = np.max(distances(track.vertices, wall))
    assert widest <= LOOPS.allowance + LOOPS.slot - TOOL.radius + 1e-3


def test_the_contact_runs_at_the_feed_and_the_way_back_faster() -> None:
    inner = {
        round(step.feed * (step.radius + TOOL.radius) / step.radius, 6)
        for step in steps_of(made(LOOPS))
        if step.sweep > 0.0 and step.low == LOOPS.bottom and step.radius < 3.0
    }
    assert min(inner) == pytest.approx(TOOL.feed)
    assert all(each == pytest.approx(TOOL.feed) or each > 2.0 * TOOL.feed for each in inner)


@given(size=st.floats(0.6, 4.5), limit=st.floats(0.3, 1.5), turn=st.floats(0.05, 0.95))
@settings(max_examples=25, deadline=None)
def test_the_bound_holds_on_a_straight_wall(size: float, limit: float, turn: float) -> None:
    """Two loops, the second ahead by what the bound allows, at any place of it."""
    apart = largest_advance(size, 5.0, limit)
    assert loop_engagement(size, 5.0, apart) == pytest.approx(limit, abs=2e-4)
    first = Track.arc(0j, 1j * size, 2.0 * math.pi)
    second = Track.arc(complex(apart), apart + 1j * size, 2.0 * math.pi)
    way = chain_tracks((first, Track.line(0j, complex(apart)), second))
    at = first.length + apart + turn * second.length
    (found,) = engagements(way, FULL, 5.0, 1, at)
    assert found <= limit + 1e-6


@settings(max_examples=examples(1, long=8), deadline=None)
@given(curve=curves(), diameter=st.floats(7.0, 14.0), share=st.floats(0.15, 0.5))
def test_loops_around_any_disc(curve: WorkingCurve, diameter: float, share: float) -> None:
    wall = CurveBoundary("outline", hole=False, path=whole(curve))
    tool = replace(TOOL, diameter=diameter, engagement=math.radians(70.0))
    slot = diameter * (1.0 + share)
    cut = cleared("trochoid", wall, tool=tool, slot=slot, depths=(-2.0,), stepover=0.3 * diameter)
    try:
        moves = made(cut)
    except GeometryError:
        assume(False)  # no disc, or none for such a cutter
    require_sound(moves, tool)
    (track,) = levels(moves, 0.0).values()
    require_allowance(track, cut, 0.06)
    first = math.pi * (slot - diameter) + 0.1
    assert np.max(engagements(track, FULL, tool.radius, 5, first)) <= math.radians(70.0)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"slot": TOOL.diameter * (1.0 + 0.5 * NARROWEST)}, "tool"),
        ({"tool": replace(TOOL, engagement=0.01)}, "tool.engagement"),
        ({"tool": replace(TOOL, diameter=40.0)}, "tool"),
    ],
)
def test_what_leaves_no_room_is_refused(changes: dict[str, Any], key: str) -> None:
    with refused(key):
        made(replace(LOOPS, **changes))


CUTS: tuple[Cut, ...] = (
    FINISH,
    SLOT,
    replace(SLOT, centre=round_hole(9.0).offset(TOOL.radius), right="bore"),
    ROUGHED,
    BORED,
    replace(BORED, walls=(round_hole(7.0),)),
    replace(BORED, walls=(RING,)),
    FACE,
    GROOVE,
)


def slowest(cut: Cut) -> float:
    """Feed of the slowest level arc [mm/min], none of whose contacts is faster than the tool's.

    The wall is on the right of a cutter that climbs: its contact is farther from the middle of an
    arc to the left than the centre is, and nearer to that of one to the right.
    """
    moves = made(cut)
    require_sound(moves, cut.tool)
    found = cut.tool.feed
    for step in steps_of(moves):
        if not step.sweep or step.low < step.high:
            continue
        arm, outside = step.radius, (step.sweep > 0.0) == cut.climb
        at_contact = abs(arm + cut.contact_radius) if outside else abs(arm - cut.contact_radius)
        if outside or arm > cut.contact_radius:
            assert step.feed * at_contact / arm <= cut.tool.feed * (1.0 + 1e-9)
        found = min(found, step.feed)
    return found


@pytest.mark.parametrize(
    ("cut", "climb"),
    [
        pytest.param(cut, climb, id=f"{cut.strategy}-{cut.name}-{climb}")
        for cut in CUTS
        for climb in (True, False)
    ],
)
def test_the_contact_is_no_faster_than_the_feed(cut: Cut, climb: bool) -> None:
    cut = replace(cut, climb=climb)
    assert slowest(cut) <= cut.tool.feed
    if isinstance(cut, AreaCut) and cut.walls and cut.walls[0].hole:
        assert slowest(cut) < 0.95 * cut.tool.feed


@settings(max_examples=examples(5, long=10), deadline=None)
@given(radius=st.floats(5.8, 30.0), diameter=st.floats(4.0, 11.0), finish=st.booleans())
def test_bores(radius: float, diameter: float, finish: bool) -> None:
    """Of any size: the last round at its wall runs at the stated feed there."""
    tool, wall = replace(TOOL, diameter=diameter, stepover=0.3 * diameter), round_hole(radius)
    cut: Cut = cleared("bore", wall, tool=tool, depths=(-2.0,), allowance=0.05, stepover=0.9)
    arm = radius - 0.5 * diameter
    if finish:
        cut = ContourCut(
            name="bore", strategy="profile", tool=tool, top=0.0, depths=(-2.0,),
            centre=wall.offset(tool.radius), right="bore", room=0.5 * arm, cleared=True,
        )  # fmt: skip
    assert slowest(cut) <= tool.feed * arm / (arm + tool.radius) * (1.0 + 1e-9)
