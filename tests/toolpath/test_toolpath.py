"""Cutter paths: at the tool's radius from the flank, tangential leads, passes, refusals."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Effort
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from camgeo.milling import plan
from camgeo.milling.cut import ContourCut, Cut, PointCut
from camgeo.milling.holding import Holding
from camgeo.milling.machine import load
from camgeo.milling.milling import MillingSpec, Stock
from camgeo.milling.moves import ArcFeed, Feed, Heights, Move, Operation, Rapid, Stop, Toolpath
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.planned import sequence_of
from camgeo.milling.strategies import STRATEGIES
from camgeo.milling.tool import Tool
from camgeo.part.assembly import build_part
from camgeo.part.part import Part
from camgeo.part.spec import Keyway, PartSpec
from tests.contour.cams import dense, dwell, move
from tests.measuring import DensePath, Outline

TOLERANCE = 0.001

SAGITTA = 5e-6
"""Sagitta of the chords of the dense curves [mm]: h = 5e-3 mm, kappa < 1/mm."""

LIMITS = load("linuxcnc").arcs

ROLLER = 8.0

HEIGHTS = Heights.of(7.0)

THROUGH = 0.5
"""How far cuts go below the part [mm]."""

HOLDING = Holding(kind="fixture", through=THROUGH)

DRILLED = 22.0
"""Diameter of the hole in the blank [mm]; a round of 2 mm in the bore of 25 mm reaches it."""

PITCH = PitchCurve(
    MotionPlan((dwell(50), move(100, 20.0), dwell(70), move(140, 0.0))),
    TranslatingRoller(40.0, ROLLER, 6.0),
    1,
)

FLANKS = {"inner": WorkingCurve(PITCH, -ROLLER), "outer": WorkingCurve(PITCH, ROLLER)}

PART = PartSpec(thickness=10.0, bore=25.0, keyway=Keyway(8.0, 3.3), rim=150.0, groove_depth=6.0)


def _toolpath(
    contact: Contact, tool: float, part: PartSpec = PART, pitch: PitchCurve = PITCH, **run: Any
) -> Toolpath:
    inner, outer = (whole(WorkingCurve(pitch, distance)) for distance in (-ROLLER, ROLLER))
    cuts = _cuts(build_part(contact, inner, outer, part, 0.01), tool, **run)
    return plan_toolpath(cuts, HEIGHTS, LIMITS, TOLERANCE)


def _cuts(part: Part, tool: float, **run: Any) -> tuple[Cut, ...]:
    """The planned cuts with one tool; the blank is drilled, so that no core is left in the bore."""
    milling = MillingSpec(tools=(_tool(tool, **run),), stock=Stock(bore=DRILLED), holding=HOLDING)
    return sequence_of(part, milling, HEIGHTS).cuts


def _tool(diameter: float, **run: Any) -> Tool:
    given = {"spindle_speed": 3000.0, "feed": 300.0, "plunge_feed": 100.0, "stepdown": 50.0, **run}
    return Tool(number=1, diameter=diameter, **given)


def _operations(toolpath: Toolpath) -> dict[str, Operation]:
    return {operation.cut.name: operation for operation in toolpath.operations}


def _outline(moves: tuple[Move, ...]) -> Outline:
    """The cuts in the plane of the first pass."""
    cuts: list[tuple[complex, complex, float, complex]] = []
    at = complex(*moves[0].end[:2])
    for before, after in pairwise(moves):
        end = complex(*after.end[:2])
        if isinstance(after, Rapid) and cuts:
            break
        if not isinstance(after, Rapid) and before.end[2] == after.end[2]:
            sweep, centre = 0.0, 0j
            if isinstance(after, ArcFeed):
                centre = complex(*after.centre)
                turned = float(np.angle((end - centre) / (at - centre)))
                sweep = turned % (2.0 * math.pi) if after.ccw else -((-turned) % (2.0 * math.pi))
            cuts.append((at, end, sweep, centre))
        at = end
    starts, ends, sweeps, centres = zip(*cuts, strict=True)
    return Outline(np.array(starts), np.array(ends), np.array(sweeps), np.array(centres))


def _without_leads(path: Outline) -> Outline:
    return Outline(path.starts[1:-1], path.ends[1:-1], path.sweeps[1:-1], path.centres[1:-1])


@pytest.mark.parametrize("tool", [2.0, 6.0, 11.0])
@pytest.mark.parametrize("contact", ["inner", "outer"])
def test_path_is_the_tool_radius_from_the_flank(contact: Contact, tool: float) -> None:
    operation = _operations(_toolpath(contact, tool))["outline"]
    path = _outline(operation.travel)
    loop = _without_leads(path)
    assert abs(loop.starts[0] - loop.ends[-1]) == 0.0
    flank = dense(FLANKS[contact])
    distances = DensePath(flank).distances(loop.dense(5_000))
    assert np.max(np.abs(distances - tool / 2.0)) <= TOLERANCE + SAGITTA
    # ... and back: nowhere on the flank is the path further away than that.
    back = loop.distances(flank[::20])
    assert np.max(np.abs(back - tool / 2.0)) <= TOLERANCE + SAGITTA
    # Climbing, clockwise spindle: the material on the right of the cutter's way.
    assert (loop.area < 0.0) == (contact == "inner")


@pytest.mark.parametrize("tool", [2.0, 6.0, 11.0])
@pytest.mark.parametrize("contact", ["inner", "outer"])
def test_leads(contact: Contact, tool: float) -> None:
    operation = _operations(_toolpath(contact, tool))["outline"]
    path = _outline(operation.travel)
    whole = DensePath(dense(FLANKS[contact])).distances(path.dense(5_000))
    assert np.min(whole) >= tool / 2.0 - TOLERANCE - SAGITTA
    for lead, neighbour, place in ((0, 1, path.ends[0]), (-1, -2, path.starts[-1])):
        ways = []
        for piece in (lead, neighbour):
            along = path.ends[piece] - path.starts[piece]
            if path.sweeps[piece] != 0.0:
                along = 1j * np.sign(path.sweeps[piece]) * (place - path.centres[piece])
            ways.append(along / abs(along))
        # Rounding of a point, 1e-14 mm, over the smaller radius, 0.1 mm at least.
        assert abs(np.angle(ways[0] / ways[1])) < 1e-11
    # No more than a quarter turn; less in a slot that is only wider by an allowance.
    for sweep in (path.sweeps[0], path.sweeps[-1]):
        assert 0.25 < abs(sweep) <= math.pi / 2.0 * (1.0 + 1e-12)


@pytest.mark.parametrize("tool", [8.0, 10.0, 15.9])
def test_groove_in_two_rounds(tool: float) -> None:
    operations = _operations(_toolpath(Contact.GROOVE, tool))
    assert list(operations)[-4:] == [
        "rough outer flank", "rough inner flank", "outer flank", "inner flank"
    ]  # fmt: skip
    flanks = {name: DensePath(dense(curve)) for name, curve in FLANKS.items()}
    cleared = []
    for side in ("inner", "outer"):
        path = _outline(operations[f"{side} flank"].travel)
        points = path.dense(4_000)
        for other in ("inner", "outer"):  # leads too stay off both flanks
            assert np.min(flanks[other].distances(points)) >= tool / 2.0 - TOLERANCE - SAGITTA
        loop = _without_leads(path)
        distances = flanks[side].distances(loop.dense(4_000))
        assert np.max(np.abs(distances - tool / 2.0)) <= TOLERANCE + SAGITTA
        assert (loop.area < 0.0) == (side == "inner")
        cleared.append(loop)
    # No wall is left between the two rounds: half way along the pitch curve the nearer is in reach.
    middle = PITCH.point(np.linspace(0.0, 2.0 * math.pi, 1000))
    reach = np.minimum(cleared[0].distances(middle), cleared[1].distances(middle))
    assert np.max(reach) <= tool / 2.0 + TOLERANCE


def test_groove_with_a_tool_like_the_roller() -> None:
    operation = _operations(_toolpath(Contact.GROOVE, 2.0 * ROLLER, stepdown=2.0))["groove"]
    path = _outline(operation.travel)
    pitch = DensePath(dense(WorkingCurve(PITCH, 0.0)))
    assert np.max(pitch.distances(path.dense(4_000))) <= TOLERANCE + SAGITTA
    assert abs(path.starts[0] - path.ends[-1]) == 0.0
    # It plunges on the path itself from pass to pass and goes up once, at the end.
    assert sum(isinstance(move, Rapid) for move in operation.travel) == 2


def test_groove_with_side_clearance() -> None:
    """The groove counts, 16 mm wide, and not the roller in it, 15.7 mm."""
    played = replace(PITCH, follower=TranslatingRoller(40.0, ROLLER - 0.15, 6.0))
    assert "groove" in _operations(_toolpath(Contact.GROOVE, 2.0 * ROLLER, pitch=played))
    assert "groove" not in _operations(_toolpath(Contact.GROOVE, 15.7, pitch=played))
    with pytest.raises(GeometryError, match=r"larger than the groove.* from 8 to 16 mm"):
        _toolpath(Contact.GROOVE, 16.001, pitch=played)


@pytest.mark.parametrize("tool", [7.9, 2.0, 16.1])
def test_groove_refuses_other_tools(tool: float) -> None:
    with pytest.raises(GeometryError, match="from 8 to 16 mm") as caught:
        _toolpath(Contact.GROOVE, tool)
    assert caught.value.key == "tool"


def test_tool_that_no_bore_takes() -> None:
    _toolpath(Contact.INNER, 24.0)
    for tool in (25.0, 30.0):
        with pytest.raises(GeometryError, match="smaller than the bore, 25 mm") as caught:
            _toolpath(Contact.INNER, tool)
        assert caught.value.key == "tool.diameter"


def test_tool_larger_than_a_concave_radius() -> None:
    """Refused just where the smallest concave radius of the flank is."""
    plain = PartSpec(thickness=10.0)
    plan = MotionPlan((dwell(180), move(60, 30.0), dwell(40), move(80, 0.0)))
    pitch = PitchCurve(plan, TranslatingRoller(40.0, ROLLER), 1)
    # 1 + d kappa of the cutter's path, an offset of the pitch curve, vanishes at d = -1/kappa.
    kappa = np.min(pitch.curvature(np.linspace(0.0, 2.0 * math.pi, 200_001)))
    assert kappa < 0.0
    largest = 2.0 * (-1.0 / kappa + ROLLER)
    _toolpath(Contact.INNER, 0.99 * largest, plain, pitch)
    with pytest.raises(
        GeometryError, match="too large for the outline: its smallest concave"
    ) as caught:
        _toolpath(Contact.INNER, 1.01 * largest, plain, pitch)
    assert caught.value.key == "tool.diameter"


def test_milling_needs_a_thickness() -> None:
    with pytest.raises(GeometryError, match="thickness") as caught:
        _toolpath(Contact.INNER, 6.0, PartSpec(bore=25.0))
    assert caught.value.key == "part.thickness"


@pytest.mark.parametrize(
    ("stepdown", "count"), [(20.0, 1), (10.5, 1), (10.49, 2), (5.25, 2), (3.0, 4), (0.105, 100)]
)
def test_depth_passes(stepdown: float, count: int) -> None:
    """Rough cuts go down in equal passes, finishes along them at full depth."""
    for operation in _toolpath(Contact.INNER, 6.0, stepdown=stepdown).operations:
        depths = operation.cut.depths
        assert depths[-1] == -10.0 - THROUGH
        if operation.cut.allowance == 0.0:
            assert len(depths) == 1
            continue
        steps = -np.diff((0.0, *depths))
        assert steps == pytest.approx(np.full(count, 10.5 / count))
        assert np.max(steps) <= stepdown * (1.0 + 1e-9)


@pytest.mark.parametrize(("contact", "tool"), [("inner", 6.0), ("outer", 6.0), ("groove", 10.0),
                                               ("groove", 16.0)])  # fmt: skip
def test_heights_and_feeds(contact: Contact, tool: float) -> None:
    toolpath = _toolpath(contact, tool, stepdown=2.5, feed=250, plunge_feed=40)
    assert toolpath.safe_height == 7.0
    for operation in toolpath.operations:
        first = operation.travel[0]
        assert isinstance(first, Rapid)
        assert first.end[2] == 7.0
        assert isinstance(operation.travel[-1], Rapid)
        depths = set()
        for before, after in pairwise(operation.travel):
            if isinstance(after, Rapid):
                # Straight up, or over the part at the safe height.
                assert after.end[2] == 7.0
                assert after.end[:2] == before.end[:2] or before.end[2] == 7.0
                continue
            assert isinstance(after, Feed | ArcFeed)
            drop = before.end[2] - after.end[2]
            assert drop >= 0.0
            assert after.feed <= 250
            if drop and after.end[:2] == before.end[:2]:
                assert after.feed == 40
            elif drop:
                way = abs(complex(*after.end[:2]) - complex(*before.end[:2]))
                assert after.feed * drop <= 40 * math.hypot(0.5 * math.pi * way, drop)
            else:
                depths.add(after.end[2])
        # A round at the bottom; between depths it descends along the path.
        assert depths == {operation.cut.bottom}
    depth = 6.0 if contact == "groove" else 10.0 + THROUGH
    assert toolpath.operations[-1].cut.depths[-1] == -depth


@pytest.mark.parametrize("contact", ["inner", "outer", "groove"])
def test_no_arc_exceeds_half_a_turn(contact: Contact) -> None:
    for operation in _toolpath(contact, 10.0).operations:
        path = _outline(operation.travel)
        assert np.max(np.abs(path.sweeps)) <= math.pi * (1.0 + 1e-12)
        arcs = path.sweeps != 0.0
        mismatch = np.abs(path.starts - path.centres) - np.abs(path.ends - path.centres)
        assert np.max(np.abs(mismatch[arcs])) < 1e-9


def test_bore_is_cut_first_and_inside() -> None:
    rough, operation = _toolpath(Contact.INNER, 6.0).operations[:2]
    assert (rough.cut.name, operation.cut.name) == ("rough bore", "bore")
    points = _outline(operation.travel).dense(1_000)
    # Radius 12.5 less the tool's 3; the keyway is left to a broach.
    assert np.max(np.abs(points)) == pytest.approx(9.5, rel=1e-12)
    assert _outline(operation.travel).area > 0.0


@pytest.mark.parametrize(
    ("contact", "tool", "expected"),
    [
        ("inner", 6.0, ["bore", "outline"]),
        ("outer", 6.0, ["outline"]),
        ("groove", 2.0 * ROLLER, ["bore", "groove"]),
        ("groove", 10.0, ["bore", "outer flank", "inner flank"]),
    ],
)
def test_cuts_know_what_is_on_either_side(
    contact: Contact, tool: float, expected: list[str]
) -> None:
    """Their boundaries are the part's, on the side that they say, and as deep as their walls."""
    inner, outer = (whole(WorkingCurve(PITCH, distance)) for distance in (-ROLLER, ROLLER))
    part = build_part(contact, inner, outer, PART, 0.01)
    cuts = _cuts(part, tool, stepdown=4.0)
    assert [cut.name for cut in cuts if not cut.name.startswith("rough ")] == expected
    walls = {wall.boundary.name: wall for wall in part.walls}
    toolpath = plan_toolpath(cuts, HEIGHTS, LIMITS, TOLERANCE)
    for cut, operation in zip(cuts, toolpath.operations, strict=True):
        assert operation.cut is cut
        assert isinstance(cut, ContourCut)
        assert bool(cut.left) == (cut.name == "groove")
        path = _outline(operation.travel)
        loop = _without_leads(path) if cut.room else path
        along = loop.starts[0] - loop.ends[-2]
        for name, side in ((cut.right, -1j), (cut.left, 1j)):
            if name:
                wall = walls[name]
                assert cut.bottom == wall.z0 - THROUGH * (wall.z0 == -10.0)
                ring = walls[name].boundary.polyline(0.01, "fast").contour.vertices
                nearest = ring[np.argmin(np.abs(ring - loop.starts[0]))]
                assert ((nearest - loop.starts[0]) * np.conj(along * side)).real > 0.0


@pytest.mark.parametrize("largest", [120.0, 90.0, 10.0])
def test_arcs_are_divided_as_the_machine_wants(largest: float) -> None:
    limits = replace(LIMITS, largest_sweep=largest)
    inner, outer = (whole(WorkingCurve(PITCH, distance)) for distance in (-ROLLER, ROLLER))
    part = build_part(Contact.INNER, inner, outer, PART, 0.01)
    cuts = _cuts(part, 6.0)
    found = [plan_toolpath(cuts, HEIGHTS, each, TOLERANCE).operations for each in (LIMITS, limits)]
    for whole_arcs, parts in zip(*found, strict=True):
        one, other = _outline(whole_arcs.moves), _outline(parts.moves)
        assert np.max(np.abs(other.sweeps)) <= math.radians(largest) * (1.0 + 1e-9)
        assert np.sum(np.abs(other.sweeps)) == pytest.approx(np.sum(np.abs(one.sweeps)), rel=1e-12)


def test_a_new_strategy_is_a_function_and_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """The plan asks the registry alone; nothing else has to know of it."""

    def drill(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:
        above, down = (0.0, 0.0, heights.clearance), (0.0, 0.0, cut.bottom)
        return [Rapid(above), Feed(down, cut.tool.plunge_feed), Rapid(above)]

    monkeypatch.setattr(plan, "STRATEGIES", {**STRATEGIES, "drill": drill})
    tool = _tool(6.0)
    cut = PointCut(name="hole", strategy="drill", tool=tool, top=0.0, depths=(-8.0,), points=(0j,))
    (operation,) = plan_toolpath((cut,), HEIGHTS, LIMITS, TOLERANCE).operations
    assert operation.travel[1] == Feed((0.0, 0.0, -8.0), 100.0)


def test_a_divided_helix_keeps_its_pitch_and_halts_stay() -> None:
    helix = ArcFeed((-3.0, 0.0, -1.0), (0.0, 0.0), True, 100.0)
    halt = Stop("turn it over")
    parts = list(plan.divided((Rapid((3.0, 0.0, 1.0)), halt, helix), math.pi / 4.0))
    assert parts[:2] == [Rapid((3.0, 0.0, 1.0)), halt]
    assert len(parts) == 2 + 4
    for count, part in enumerate(parts[2:], start=1):
        assert isinstance(part, ArcFeed)
        end = 3.0 * np.exp(0.25j * math.pi * count)
        assert part.end == pytest.approx((end.real, end.imag, 1.0 - 0.5 * count), abs=1e-14)
        assert (part.centre, part.ccw, part.feed) == (helix.centre, True, 100.0)
