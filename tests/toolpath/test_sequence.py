"""Sequences of cuts: what is planned, in which order, with which tool, and what is left out; what
operations that a scene states make. `test_refused.py` has what is refused.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, Final

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import Contour, distances
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from camgeo.milling.bench import largest_diameter, tightest
from camgeo.milling.cut import AreaCut, ContourCut, Cut, PointCut, roughing_slack
from camgeo.milling.judged import unmade_names
from camgeo.milling.milling import OperationSpec, Stock
from camgeo.milling.moves import ArcFeed
from camgeo.milling.strategies import cut_moves
from camgeo.milling.track import Track
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.spec import Counterbore, DShaft, Holes, Hub, Keyway, Mark, PartSpec
from tests.contour.cams import dwell, move
from tests.toolpath.milled import (
    BORE,
    ENGRAVER,
    FIXTURE,
    HEIGHTS,
    HOOKED,
    HUB_TOOLS,
    HUBBED,
    MILL,
    POINTED,
    ROLLER,
    SLOTTER,
    SPEC,
    THICKNESS,
    TOOLS,
    named,
    operation,
    part,
    sequence,
    tool,
)

INNER, OUTER, GROOVE = Contact.INNER, Contact.OUTER, Contact.GROOVE


@dataclass(frozen=True)
class Plan:
    """What is given, the cuts that are planned, the holes, marks and bores that nothing makes, and
    findings by their names, with words of them.
    """

    contact: Contact
    given: dict[str, Any]
    cuts: str
    left: tuple[str, ...] = ()
    told: dict[str, str] = field(default_factory=dict)


def line_of(cut: Cut) -> str:
    return f"{cut.name}: tool {cut.tool.number}, {cut.strategy}, {cut.top:g} to {cut.bottom:.6g}"


BORED: Final = """rough bore: tool 1, slot, 0 to -10.5
    bore: tool 1, profile, 0 to -10.5
    """

OUTLINE: Final = """rough outline: tool 1, slot, 0 to -10.5
    outline: tool 1, profile, 0 to -10.5"""

HUB: Final = """rough hub: tool 1, moat, 0 to -6
    hub: tool 1, profile, 0 to -6
    rough bore: tool 1, slot, 0 to -16.5
    bore: tool 1, profile, 0 to -16.5
    """

MARK: Final = "engrave mark: tool 3, engrave, -6 to -6.5\n"

DRILLED: Final = """drill bolt hole 1, bolt hole 2, bolt hole 3: tool 2, drill, -6 to -17.7842
    """

LOW_OUTLINE: Final = """rough outline: tool 1, slot, -6 to -16.5
    outline: tool 1, profile, -6 to -16.5"""

FLANKS: Final = """rough outer flank: tool 1, slot, 0 to -6
    rough inner flank: tool 1, slot, 0 to -6
    outer flank: tool 1, profile, 0 to -6
    inner flank: tool 1, profile, 0 to -6"""

ROUND: Final = {"stock": Stock(shape="round", diameter=150.0)}

HOLES: Final = ("bolt hole 1", "bolt hole 2", "bolt hole 3")

SUNK: Final = replace(
    HUBBED, mark=None, bolt_circle=Holes(3, 52.0, 4.0, counterbore=Counterbore(6.0, 2.0))
)

DOTTED: Final = replace(SPEC, mark=Mark(26.0, 2.0, 0.5))

GROOVED: Final = PartSpec(
    thickness=10.0, bore=25.0, rim=150.0, groove_depth=6.0, hub=Hub(40.0, 5.0)
)


def on_round(cuts: str) -> str:
    """All around is cleared, not along a slot or within a moat."""
    cuts = cuts.replace("rough outline: tool 1, slot", "rough outline: tool 1, rough")
    return cuts.replace("moat", "rough")


PLANS: Final = {
    # The blank stays whole as long as possible.
    "a disc": Plan(INNER, {}, BORED + OUTLINE),
    "a ring": Plan(OUTER, {}, OUTLINE, (), {"rim-left-out": "that of the blank"}),
    "a groove": Plan(GROOVE, {}, BORED + FLANKS, (), {"rim-left-out": "that of the blank"}),
    "a round blank": Plan(
        INNER, {"stock": Stock(shape="round", diameter=160.0, top=1.5)},
        "face: tool 1, face, 1.5 to 0\n" + BORED + on_round(OUTLINE),
    ),
    "a bore that is there": Plan(
        INNER, {"stock": Stock(bore=BORE), "spec": replace(SPEC, keyway=Keyway(8.0, 3.3))}, OUTLINE,
        (), {"bore-left-out": "25 mm; it is not milled; the keyway is left to be broached"},
    ),
    # The full diameter goes through, the point of 118 degrees beyond.
    "a drill of the bore": Plan(
        INNER,
        {"tools": (tool(12.0), tool(BORE, 2, kind="drill", tip_angle=2.0, flute_length=60.0,
                                    stepdown=5.0))},
        "bore: tool 2, drill, 0 to -18.5262\n" + OUTLINE,
    ),
    # The first tool that fits: a smaller one where the first does not go in, or is too short.
    "a wide tool": Plan(
        INNER, {"tools": (tool(30.0), tool(12.0, 2))}, BORED.replace("tool 1", "tool 2") + OUTLINE
    ),
    "a short tool": Plan(
        INNER, {"tools": (tool(12.0, flute_length=10.0), tool(10.0, 2, flute_length=10.5))},
        (BORED.replace("slot", "bore") + OUTLINE).replace("tool 1", "tool 2"),
    ),
    "a groove in one round": Plan(
        GROOVE, {"tools": (tool(2.0 * ROLLER),), "stock": Stock(bore=BORE)},
        "groove: tool 1, slot, 0 to -6", (), {"bore-left-out": "the blank has it"},
    ),
    "a rim of the blank": Plan(OUTER, ROUND, OUTLINE, (), {"rim-left-out": "that of the blank"}),
    "a rim out of a plate": Plan(
        OUTER, {"stock": Stock(length=170.0, width=170.0)},
        OUTLINE.replace("outline", "rim") + "\n" + OUTLINE,
    ),
    # What stands on the disc is laid free first, and what lies lower begins at the face.
    "a hub": Plan(
        INNER, {"tools": HUB_TOOLS, "spec": HUBBED}, HUB + MARK + DRILLED + LOW_OUTLINE
    ),
    "a hub, from a round blank": Plan(
        INNER, {"tools": HUB_TOOLS, "spec": HUBBED, **ROUND},
        on_round(HUB + MARK + DRILLED + LOW_OUTLINE),
    ),
    "a hub, with one tool": Plan(
        INNER, {"tools": HUB_TOOLS[:1], "spec": HUBBED}, HUB + LOW_OUTLINE, (*HOLES, "mark"),
        {"mark-left-out": "mark: left out, no flat end mill of 2 mm fits it",
         "holes-left-out": "bolt hole 3: left out, no drill of 4 mm reaches through"},
    ),
    "a hub on a groove": Plan(
        GROOVE, {"tools": HUB_TOOLS[:1], "spec": GROOVED},
        HUB.replace("-6", "-5").replace("-16.5", "-15.5")
        + FLANKS.replace("-6", "-11").replace(" 0 to", " -5 to"),
    ),
    # Where no tool makes counterbores, a drill does not begin on their floors all the same.
    "counterbores": Plan(
        INNER, {"tools": (*HUB_TOOLS, tool(6.0, 4, plunges=True)), "spec": SUNK, **ROUND},
        on_round(HUB + "\n".join(f"engrave counterbore {number}: tool 4, drill, -6 to -8"
                                 for number in (1, 2, 3)) + "\n" + DRILLED + LOW_OUTLINE),
    ),
    "counterbores that no tool makes": Plan(
        INNER, {"tools": HUB_TOOLS, "spec": SUNK, **ROUND}, on_round(HUB + DRILLED + LOW_OUTLINE),
        ("counterbore 1", "counterbore 2", "counterbore 3"),
        {"counterbore 1-left-out": "no flat end mill of 6 mm"},
    ),
    "a dot": Plan(
        INNER, {"tools": (HUB_TOOLS[0], replace(ENGRAVER, plunges=True)), "spec": DOTTED},
        BORED + "engrave mark: tool 3, drill, 0 to -0.5\n" + OUTLINE,
    ),
    "a dot that no tool plunges": Plan(
        INNER, {"tools": (HUB_TOOLS[0], ENGRAVER), "spec": DOTTED}, BORED + OUTLINE, ("mark",),
        {"mark-left-out": "no flat end mill"},
    ),
    "a bore that is not round": Plan(
        INNER, {"tools": HUB_TOOLS[:1], "spec": replace(SPEC, d_shaft=DShaft(22.0))}, OUTLINE,
        ("bore",), {"bore-left-out": "not round"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PLANS)
def test_what_is_cut_and_what_is_left_out(name: str) -> None:
    plan = PLANS[name]
    given = {"spec": SPEC, **plan.given}
    found = sequence(plan.contact, *given.pop("tools", ()), **given)
    assert [line_of(cut) for cut in found.cuts] == [each.strip() for each in plan.cuts.splitlines()]
    assert unmade_names(part(plan.contact, given["spec"]), found.cuts) == plan.left
    said = {each.name: each.sentence for each in found.findings}
    assert {key for key, words in plan.told.items() if words not in said[key]} == set()
    for cut in found.cuts:
        rough = cut.name.startswith("rough ")
        assert (cut.allowance > 0.0) == rough
        assert cut.climb
        if isinstance(cut, ContourCut) and cut.name != "groove":
            assert (cut.springs, cut.cleared) == ((0, False) if rough else (1, True))
        for above, below in pairwise((cut.top, *cut.depths)) if rough else ():
            assert above - below <= (cut.tool.stepdown or 0.0) * (1.0 + 1e-12)


def test_cuts_of_holes_and_edges_of_the_blank() -> None:
    """Their places, and what they produce."""
    plan = PLANS["a dot"]
    dot = named(sequence(INNER, *plan.given["tools"], spec=DOTTED))["engrave mark"]
    assert isinstance(dot, PointCut)
    assert (dot.points, dot.depths, dot.produced) == ((26.0 + 0j,), (-0.5,), ("mark",))
    assert dot.sinking == ENGRAVER.plunge_feed
    one = OperationSpec(kind="drill", tool=2, boundary="bolt hole 2")
    (cut,) = sequence(INNER, *HUB_TOOLS, spec=HUBBED, operations=(one,)).cuts
    assert (cut.name, cut.produced, cut.top) == ("drill bolt hole 2", ("bolt hole 2",), 0.0)
    keyed = named(sequence(INNER, spec=replace(SPEC, keyway=Keyway(8.0, 3.3))))["bore"]
    assert keyed.note == "the keyway is left to be broached"


@pytest.mark.parametrize("stated", [True, False])
def test_a_hook_is_cut_out_of_a_round_blank_by_a_slot(stated: bool) -> None:
    """No spiral leads there; leads stay in the slot, and the operator is told."""
    stock, mill = Stock(shape="round", diameter=290.0), tool(4.0)
    operations = (
        OperationSpec(kind="rough", tool=1, boundary="outline", allowance=0.2),
        OperationSpec(kind="finish", tool=1, boundary="outline"),
    )
    found = named(
        sequence(INNER, mill, stock=stock, pitch=HOOKED, operations=operations if stated else ())
    )
    rough, finish = found["rough outline"], found["outline"]
    assert isinstance(rough, ContourCut)
    assert rough.strategy == "slot"
    assert "no spiral clears its hollows" in rough.note
    assert isinstance(finish, ContourCut)
    assert finish.room == pytest.approx(rough.allowance + rough.slack)
    assert finish.rest == rough.allowance
    assert rough.slack > 0.0
    wide = replace(stock, diameter=200.0)
    spiral = sequence(INNER, mill, stock=wide, operations=operations if stated else ())
    assert isinstance(named(spiral)["rough outline"], AreaCut)


@pytest.mark.parametrize("diameter", [6.0, 8.0, 11.9])
def test_no_core_is_left_in_a_bore(diameter: float) -> None:
    """A round inside it leaves one if the bore is wider than two cutters and what is there."""
    core = BORE - 2.0 * diameter
    found = named(sequence(INNER, tool(diameter)))
    rough = found["rough bore"]
    assert isinstance(rough, AreaCut) == (core > 2.0 * rough.allowance)
    drilled = named(sequence(INNER, tool(diameter), stock=Stock(bore=core + 0.1)))["rough bore"]
    assert isinstance(drilled, ContourCut)


# -- fitting ---------------------------------------------------------------------------------------
# The smallest concave radius of a wall, and the largest cutter that fits.


HOLLOW = PitchCurve(
    MotionPlan((dwell(180), move(60, 30.0), dwell(40), move(80, 0.0))),
    TranslatingRoller(40.0, ROLLER),
    1,
)


@pytest.mark.parametrize("hole", [False, True])
def test_of_a_flank_it_is_where_the_sampled_radius_is_smallest(hole: bool) -> None:
    sign = 1.0 if hole else -1.0
    flank = CurveBoundary("flank", hole=hole, path=whole(WorkingCurve(HOLLOW, sign * ROLLER)))
    place = tightest(flank)
    assert place is not None
    phi = np.linspace(0.0, 2.0 * math.pi, 100_001)
    # The flank's own radius of curvature, positive where it is hollow seen from the cutter.
    kappa = WorkingCurve(HOLLOW, sign * ROLLER).curvature(phi) * sign
    assert 1.0 / np.max(kappa) == pytest.approx(place.radius, rel=1e-6)
    assert place.radius <= 1.0 / np.max(kappa) * (1.0 + 1e-12)
    assert place.cam_angle == pytest.approx(phi[np.argmax(kappa)], abs=1e-4)


def test_the_path_of_a_cutter_is_regular_up_to_it() -> None:
    flank = CurveBoundary("outline", hole=False, path=whole(WorkingCurve(HOLLOW, -ROLLER)))
    place = tightest(flank)
    assert place is not None
    flank.offset(0.999 * place.radius).arcs(0.01, "fast")
    with pytest.raises((GeometryError, UndercutError)):
        flank.offset(1.001 * place.radius).arcs(0.01, "fast")
    proposed = largest_diameter(place)
    assert 0.0 <= 2.0 * place.radius - proposed < 0.01 * (1.0 + 1e-9)


def test_of_circles() -> None:
    circle = Contour.circle(12.5)
    bore = tightest(ExactBoundary("bore", hole=True, exact=circle))
    assert bore is not None
    assert bore.radius == 12.5
    assert tightest(ExactBoundary("rim", hole=False, exact=circle)) is None


def test_a_cutter_that_is_too_large_is_refused_with_the_largest_that_fits() -> None:
    """On the hub of a cam that rises steeply the hollow of the outline is the limit."""
    with pytest.raises(GeometryError, match="the largest that fits has ") as caught:
        sequence(Contact.OUTER, tool(140.0))
    largest = float(caught.value.message.rpartition("has ")[2].split()[0])
    sequence(Contact.OUTER, tool(largest))


INNER, GROOVE = Contact.INNER, Contact.GROOVE

BLANK = Stock(shape="round", diameter=170.0, top=1.0)

BOTTOM = -THICKNESS - FIXTURE.through


def cuts(
    *operations: OperationSpec, contact: Contact = INNER, stock: Stock = BLANK
) -> dict[str, Cut]:
    return named(sequence(contact, *TOOLS, stock=stock, operations=operations))


def test_a_wall_that_nothing_has_roughed_is_finished_in_passes() -> None:
    finish = cuts(operation("finish", "outline"), stock=Stock())["outline"]
    assert isinstance(finish, ContourCut)
    assert (finish.strategy, finish.cleared, len(finish.depths)) == ("slot", False, 4)
    roughed = cuts(operation("rough", "outline"), operation("finish", "outline"), stock=Stock())[
        "outline"
    ]
    assert len(roughed.depths) == 1


@pytest.mark.parametrize(
    ("boundary", "contact"),
    [
        ("outline", INNER), ("bore", INNER), ("bore", GROOVE), ("rim", GROOVE),
        ("inner flank", GROOVE), ("outer flank", GROOVE),
    ],
)  # fmt: skip
def test_the_chamfer_is_as_wide_as_stated(boundary: str, contact: Contact) -> None:
    """The cone meets the upper face at the size from the wall, and the wall as far below it; its
    feed is held there.
    """
    size, own = 0.5, POINTED.feed
    cut = cuts(operation("chamfer", boundary, 3, size=size), contact=contact, stock=Stock())[
        f"chamfer {boundary}"
    ]
    assert isinstance(cut, ContourCut)
    reach = -cut.bottom * math.tan(0.5 * 0.5 * math.pi)  # radius of the cone at the upper face
    beside = reach - size  # from the wall to the cutter's centre
    assert beside > 0.0
    assert cut.contact == pytest.approx(reach)
    (wall,) = (each for each in part(contact).boundaries if each.name == boundary)
    path = cut.centre.arcs(1e-4, "fast").contour
    ring = wall.arcs(1e-4, "fast").contour
    apart = distances(path.vertices, Track.around(ring))
    assert apart == pytest.approx(np.full(len(path), beside), abs=2.1e-4)
    moves = cut_moves(cut, HEIGHTS, 0.001, "fast")
    arcs = [
        (abs(complex(*each.end[:2]) - complex(*each.centre)), each.feed)
        for each in moves
        if isinstance(each, ArcFeed)
    ]
    assert min(feed for _, feed in arcs) >= own * min(r / (r + reach) for r, _ in arcs) * 0.999
    assert cut.note == "0.5 mm wide on the face"


def test_the_edge_of_a_bore_with_a_keyway_is_round() -> None:
    keyed = replace(SPEC, keyway=Keyway(8.0, 3.3))
    made = operation("chamfer", "bore", 3, size=0.5)
    (cut,) = sequence(GROOVE, *TOOLS, operations=(made,), spec=keyed).cuts
    assert isinstance(cut, ContourCut)
    assert cut.centre.arcs(0.01).contour.radii == pytest.approx(0.5 * BORE - 0.05)


@pytest.mark.parametrize(
    ("finish", "cleared", "room"),
    [(MILL.number, True, 0.3), (7, True, 2.3), (SLOTTER.number, False, 0.0)],
)
def test_leads_stay_in_the_slot_that_roughing_has_made(
    finish: int, cleared: bool, room: float
) -> None:
    """It begins at its own allowance and is as wide as its cutter; a wider one enters along it."""
    small = tool(10.0, 7)
    made = sequence(
        INNER, *TOOLS, small,
        operations=(
            operation("rough", "outline", allowance=0.3), operation("finish", "outline", finish)
        ),
    )  # fmt: skip
    cut = named(made)["outline"]
    assert isinstance(cut, ContourCut)
    assert cut.cleared == cleared
    slack = roughing_slack(0.3) if cleared else 0.0  # by which the slot runs farther off
    assert cut.room == pytest.approx(room + slack)
    assert cut.rest == (0.3 if cleared else 0.0)


def test_the_strategy_of_a_slot_may_be_stated() -> None:
    ramp = cuts(operation("face"), operation("rough", "outline", strategy="ramp"))["rough outline"]
    assert isinstance(ramp, ContourCut)  # though the blank is round
    assert ramp.strategy == "slot"


def test_loops_clear_a_groove_at_once_where_they_are_small_enough() -> None:
    def loops(diameter: float) -> AreaCut:
        rough = operation("rough", "outer flank", allowance=0.2, strategy="trochoidal")
        (cut,) = sequence(GROOVE, tool(diameter), stock=Stock(), operations=(rough,)).cuts
        assert isinstance(cut, AreaCut)
        return cut

    assert [wall.name for wall in loops(10.0).walls] == ["outer flank", "inner flank"]
    assert loops(10.0).slot == pytest.approx(2.0 * (ROLLER - 0.2))
    assert [wall.name for wall in loops(6.0).walls] == ["outer flank"]


@pytest.mark.parametrize("stock", [Stock(), BLANK])
def test_both_flanks_of_a_groove_are_roughed_and_finished_with_leads(stock: Stock) -> None:
    """Whatever the blank: the inner flank bounds an island, around which nothing is cleared."""
    walls = ("outer flank", "inner flank")
    found = cuts(
        *(operation("rough", wall, allowance=0.2) for wall in walls),
        *(operation("finish", wall) for wall in walls),
        contact=GROOVE, stock=stock,
    )  # fmt: skip
    for wall in walls:
        rough, finish = found[f"rough {wall}"], found[wall]
        assert isinstance(rough, ContourCut)
        assert isinstance(finish, ContourCut)
        assert finish.cleared
        assert finish.room == pytest.approx(0.5 * (ROLLER - MILL.radius))
