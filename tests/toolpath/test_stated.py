"""Operations that a scene states: each makes its cut, or says why its tool cannot."""

from __future__ import annotations

import math
from typing import Any

import pytest

from camgeo.cam.contact import Contact
from camgeo.errors import GeometryError
from camgeo.toolpath.cut import AreaCut, ContourCut, Cut, PointCut
from camgeo.toolpath.milling import OperationSpec
from camgeo.toolpath.stock import Stock
from camgeo.toolpath.tool import Tool
from tests.toolpath.milled import BORE, FIXTURE, ROLLER, THICKNESS, named, sequence, tool

INNER, GROOVE = Contact.INNER, Contact.GROOVE

MILL = tool(12.0)
DRILL = tool(20.0, 2, kind="drill", tip_angle=2.0, stepdown=5.0)
POINTED = tool(10.0, 3, kind="chamfer-mill", tip_angle=0.5 * math.pi)
SLOTTER = tool(2.0 * ROLLER, 4)

TOOLS = (MILL, DRILL, POINTED, SLOTTER)

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


def test_the_chamfer_is_as_wide_as_stated() -> None:
    """The cutter's cone meets the upper face at the size from the wall, and the wall below it."""
    size = 0.5
    cut = cuts(spec("chamfer", "outline", 3, size=size))["chamfer outline"]
    assert isinstance(cut, ContourCut)
    reach = -cut.bottom * math.tan(0.5 * 0.5 * math.pi)  # radius of the cone at the upper face
    beside = reach - size  # from the wall to the cutter's centre
    assert cut.room == pytest.approx(beside)
    assert beside > 0.0


@pytest.mark.parametrize(
    ("operation", "contact", "message", "key"),
    [
        (spec("finish", "outlin"), INNER, 'no such wall; it has "outline", "bore"', "boundary"),
        (spec("drill"), INNER, 'needs a tool of kind "drill", not "end-mill"', "tool"),
        (spec("rough", "outline", 2), INNER, 'needs a tool of kind "end-mill"', "tool"),
        (spec("slot"), GROOVE, "not as wide as the groove, 16 mm", "tool"),
        (spec("chamfer", "outline", 3, size=4.9), INNER, "does not cover 4.9 mm", "tool"),
    ],
)
def test_what_a_tool_cannot_do(
    operation: OperationSpec, contact: Contact, message: str, key: str
) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        cuts(operation, contact=contact)
    assert caught.value.key == f"operation[1].{key}"


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
