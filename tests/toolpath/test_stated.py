"""Operations that a scene states: each makes its cut, or says why its tool cannot."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import distances
from camgeo.milling.cut import AreaCut, ContourCut, Cut, PointCut, slack_of
from camgeo.milling.holding import Holding, Tabs
from camgeo.milling.milling import OperationSpec, Stock
from camgeo.milling.moves import ArcFeed
from camgeo.milling.strategies import STRATEGIES
from camgeo.milling.tool import Tool
from camgeo.milling.track import Track
from camgeo.part.spec import Keyway
from tests.toolpath.milled import (
    BORE,
    FIXTURE,
    HEIGHTS,
    HOOKED,
    ROLLER,
    SPEC,
    THICKNESS,
    named,
    part,
    sequence,
    tool,
)

INNER, GROOVE = Contact.INNER, Contact.GROOVE

MILL = tool(12.0)
DRILL = tool(20.0, 2, kind="drill", tip_angle=2.0, stepdown=5.0)
POINTED = tool(10.0, 3, kind="chamfer-mill", tip_angle=0.5 * math.pi)
SLOTTER = tool(2.0 * ROLLER, 4)
SHARP = tool(4.0, 5, kind="chamfer-mill", tip_angle=0.52)
BLUNT = tool(40.0, 6, kind="chamfer-mill", tip_angle=2.9)

TOOLS = (MILL, DRILL, POINTED, SLOTTER, SHARP, BLUNT)

ROUND = Stock(shape="round", diameter=170.0, top=1.0)

BOTTOM = -THICKNESS - FIXTURE.through


def spec(kind: str, boundary: str = "", number: int = 1, **own: Any) -> OperationSpec:
    return OperationSpec(kind=kind, tool=number, boundary=boundary, **own)


def cuts(
    *operations: OperationSpec, contact: Contact = INNER, stock: Stock = ROUND
) -> dict[str, Cut]:
    return named(sequence(contact, *TOOLS, stock=stock, operations=operations))


def test_each_kind_makes_its_cut() -> None:
    found = cuts(
        spec("face"), spec("drill", number=2), spec("bore", allowance=0.2), spec("finish", "bore"),
        spec("rough", "outline", allowance=0.3), spec("finish", "outline", springs=2),
        spec("chamfer", "outline", 3, size=0.5),
    )  # fmt: skip
    assert list(found) == [
        "face", "drill bore", "rough bore", "bore", "rough outline", "outline", "chamfer outline",
    ]  # fmt: skip
    kinds = [AreaCut, PointCut, AreaCut, ContourCut, AreaCut, ContourCut, ContourCut]
    assert [type(cut) for cut in found.values()] == kinds
    assert found["face"].top == 1.0
    assert {cut.top for name, cut in found.items() if name != "face"} == {0.0}
    assert (found["rough bore"].allowance, found["rough outline"].allowance) == (0.2, 0.3)
    finish = found["outline"]
    assert isinstance(finish, ContourCut)
    assert (finish.depths, finish.springs, finish.cleared) == ((BOTTOM,), 2, True)


def test_a_wall_that_nothing_has_roughed_is_finished_in_passes() -> None:
    finish = cuts(spec("finish", "outline"), stock=Stock())["outline"]
    assert isinstance(finish, ContourCut)
    assert (finish.strategy, finish.cleared, len(finish.depths)) == ("slot", False, 4)
    roughed = cuts(spec("rough", "outline"), spec("finish", "outline"), stock=Stock())["outline"]
    assert len(roughed.depths) == 1


def test_an_operation_overrides_its_tool() -> None:
    own: dict[str, Any] = {
        "feed": 200.0,
        "spindle_speed": 2000.0,
        "stepdown": 1.5,
        "coolant": "mist",
    }
    cut = cuts(spec("rough", "outline", **own), stock=Stock())["rough outline"]
    assert len(cut.depths) == 7
    run = cut.tool
    assert (run.feed, run.spindle_speed, run.coolant) == (200.0, 2000.0, "mist")
    assert run.plunge_feed == MILL.plunge_feed
    other = spec("rough", "outline", name="first", climb=False, stop="turn", note="slowly")
    cut = cuts(other, stock=Stock())["first"]
    assert (cut.climb, cut.stop, cut.note) == (False, "turn", "slowly")


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
    cut = cuts(spec("chamfer", boundary, 3, size=size), contact=contact, stock=Stock())[
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
    moves = STRATEGIES[cut.strategy](cut, HEIGHTS, 0.001, "fast")
    arcs = [
        (abs(complex(*each.end[:2]) - complex(*each.centre)), each.feed)
        for each in moves
        if isinstance(each, ArcFeed)
    ]
    assert min(feed for _, feed in arcs) >= own * min(r / (r + reach) for r, _ in arcs) * 0.999
    assert cut.note == "0.5 mm wide on the face"


def test_the_edge_of_a_bore_with_a_keyway_is_round() -> None:
    keyed = replace(SPEC, keyway=Keyway(8.0, 3.3))
    operation = spec("chamfer", "bore", 3, size=0.5)
    (cut,) = sequence(GROOVE, *TOOLS, operations=(operation,), spec=keyed).cuts
    assert isinstance(cut, ContourCut)
    assert cut.centre.arcs(0.01).contour.radii == pytest.approx(0.5 * BORE - 0.05)


@pytest.mark.parametrize(
    ("operation", "contact", "message", "key"),
    [
        (spec("finish", "outlin"), INNER, 'no such wall; it has "outline", "bore"', "boundary"),
        (spec("drill"), INNER, 'needs a tool of kind "drill", not "end-mill"', "tool"),
        (spec("rough", "outline", 2), INNER, 'needs a tool of kind "end-mill"', "tool"),
        (spec("slot"), GROOVE, "not as wide as the groove, 16 mm", "tool"),
        (spec("chamfer", "outline", 3, size=4.9), INNER, "does not cover 4.9 mm", "tool"),
        (
            spec("rough", "outer flank", allowance=4.0),
            GROOVE,
            r"less than 4 mm with tool 1: more would cut into the flank across the groove",
            "allowance",
        ),
        (
            spec("bore", allowance=7.0),
            INNER,
            r"less than 6\.5 mm with tool 1: its smallest concave radius is 12\.5 mm",
            "allowance",
        ),
        (
            spec("chamfer", "outer flank", 5, size=1.5),
            GROOVE,
            r"point, 6.203 mm deep, reaches the floor at Z -6",
            "tool",
        ),
        (spec("chamfer", "inner flank", 6, size=14.0), GROOVE, "comes to the outer flank", "size"),
    ],
)
def test_what_a_tool_cannot_do(
    operation: OperationSpec, contact: Contact, message: str, key: str
) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        cuts(operation, contact=contact, stock=Stock() if "chamfer" in operation.kind else ROUND)
    assert caught.value.key == f"operation[1].{key}"


def test_a_chamfer_waits_for_the_upper_face() -> None:
    with pytest.raises(GeometryError, match="to be faced before") as caught:
        cuts(spec("chamfer", "bore", 3, size=0.5))
    assert caught.value.key == "operation[1].kind"
    assert cuts(spec("face"), spec("chamfer", "bore", 3, size=0.5))


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
        operations=(spec("rough", "outline", allowance=0.3), spec("finish", "outline", finish)),
    )  # fmt: skip
    cut = named(made)["outline"]
    assert isinstance(cut, ContourCut)
    assert cut.cleared == cleared
    slack = slack_of(0.3) if cleared else 0.0  # by which the slot runs farther off
    assert cut.room == pytest.approx(room + slack)
    assert cut.rest == (0.3 if cleared else 0.0)


def test_the_strategy_of_a_slot_may_be_stated() -> None:
    """Loops need room beside the cutter; leads stay beside the allowance that they leave."""
    found = cuts(
        spec("rough", "outline", allowance=0.3, strategy="trochoidal", stepdown=20.0),
        spec("finish", "outline"), stock=Stock(),
    )  # fmt: skip
    loops, finish = found["rough outline"], found["outline"]
    assert isinstance(loops, AreaCut)
    assert loops.strategy == "trochoid"
    assert loops.slot == pytest.approx(1.5 * MILL.diameter)
    assert len(loops.depths) == 1
    assert isinstance(finish, ContourCut)
    assert finish.cleared
    assert 0.3 < finish.room < 0.3 + loops.slot - MILL.diameter
    ramp = cuts(spec("face"), spec("rough", "outline", strategy="ramp"))["rough outline"]
    assert isinstance(ramp, ContourCut)  # though the blank is round
    assert ramp.strategy == "slot"


def test_a_known_plate_may_be_cleared_by_a_spiral() -> None:
    operations = (spec("rough", "outline", strategy="spiral"), spec("finish", "outline"))
    found = cuts(*operations, stock=Stock(length=160.0, width=150.0))
    rough, finish = found["rough outline"], found["outline"]
    assert isinstance(rough, AreaCut)
    assert rough.stock is not None
    assert isinstance(finish, ContourCut)
    assert finish.room == MILL.radius
    with pytest.raises(GeometryError, match="whose outline is stated") as caught:
        cuts(*operations, stock=Stock())
    assert caught.value.key == "operation[1].strategy"
    round_blank = Stock(shape="round", diameter=290.0)
    with pytest.raises(GeometryError, match="rays from the cam axis") as caught:
        sequence(INNER, tool(4.0), stock=round_blank, pitch=HOOKED, operations=operations[:1])
    assert caught.value.key == "operation[1].strategy"


def test_loops_clear_a_groove_at_once_where_they_are_small_enough() -> None:
    def loops(diameter: float) -> AreaCut:
        operation = spec("rough", "outer flank", allowance=0.2, strategy="trochoidal")
        (cut,) = sequence(GROOVE, tool(diameter), stock=Stock(), operations=(operation,)).cuts
        assert isinstance(cut, AreaCut)
        return cut

    assert [wall.name for wall in loops(10.0).walls] == ["outer flank", "inner flank"]
    assert loops(10.0).slot == pytest.approx(2.0 * (ROLLER - 0.2))
    assert [wall.name for wall in loops(6.0).walls] == ["outer flank"]


def test_loops_leave_no_tabs() -> None:
    tabbed = Holding(kind="tabs", through=0.3, tabs=Tabs(3, 5.0, 1.5))
    operation = spec("rough", "outline", strategy="trochoidal")
    with pytest.raises(GeometryError, match="leaves no tabs") as caught:
        sequence(INNER, MILL, holding=tabbed, operations=(operation,))
    assert caught.value.key == "operation[1].strategy"


def test_there_is_nothing_to_face_without_a_higher_blank() -> None:
    with pytest.raises(GeometryError, match="nothing to face"):
        cuts(spec("face"), stock=Stock())
    slot = cuts(spec("slot", number=4), contact=GROOVE, stock=Stock(bore=BORE))["groove"]
    assert isinstance(slot, ContourCut)
    assert slot.tool == SLOTTER
    with pytest.raises(GeometryError, match="its own name") as caught:
        cuts(spec("rough", "outline"), spec("rough", "outline"), stock=Stock())
    assert caught.value.key == "operation[2].name"


def test_tools_keep_what_an_operation_does_not_override() -> None:
    assert spec("face").run(MILL) == MILL
    assert isinstance(spec("face", feed=1.0).run(MILL), Tool)


@pytest.mark.parametrize("stock", [Stock(), ROUND])
def test_both_flanks_of_a_groove_are_roughed_and_finished_with_leads(stock: Stock) -> None:
    """Whatever the blank: the inner flank bounds an island, around which nothing is cleared."""
    walls = ("outer flank", "inner flank")
    found = cuts(
        *(spec("rough", wall, allowance=0.2) for wall in walls),
        *(spec("finish", wall) for wall in walls),
        contact=GROOVE, stock=stock,
    )  # fmt: skip
    for wall in walls:
        rough, finish = found[f"rough {wall}"], found[wall]
        assert isinstance(rough, ContourCut)
        assert isinstance(finish, ContourCut)
        assert finish.cleared
        assert finish.room == pytest.approx(0.5 * (ROLLER - MILL.radius))
