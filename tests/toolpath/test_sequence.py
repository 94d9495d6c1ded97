"""The planned sequence: what is cut, in which order, with which tool, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from camgeo.cam.cam import Contact
from camgeo.milling.cut import AreaCut, ContourCut, PointCut
from camgeo.milling.milling import OperationSpec, Stock
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.spec import Keyway
from tests.toolpath.milled import (
    BORE,
    FIXTURE,
    HOOKED,
    RIM,
    ROLLER,
    SPEC,
    THICKNESS,
    named,
    sequence,
    tool,
)

INNER, OUTER, GROOVE = Contact.INNER, Contact.OUTER, Contact.GROOVE

BOTTOM = -THICKNESS - FIXTURE.through


@pytest.mark.parametrize(
    ("contact", "expected"),
    [
        (INNER, ["rough bore", "bore", "rough outline", "outline"]),
        (OUTER, ["rough outline", "outline"]),
        (
            GROOVE,
            [
                "rough bore", "bore", "rough outer flank", "rough inner flank", "outer flank",
                "inner flank",
            ],
        ),
    ],
)  # fmt: skip
def test_the_blank_stays_whole_as_long_as_possible(contact: Contact, expected: list[str]) -> None:
    found = named(sequence(contact))
    assert list(found) == expected
    for name, cut in found.items():
        rough = name.startswith("rough ")
        assert (cut.allowance > 0.0) == rough
        assert (len(cut.depths) > 1) == rough
        assert cut.bottom == (-6.0 if "flank" in name else BOTTOM)
        assert isinstance(cut, ContourCut)
        assert cut.springs == (0 if rough else 1)
        assert cut.cleared == (not rough)
        assert cut.climb
        for above, below in pairwise((cut.top, *cut.depths)):
            assert rough is False or above - below <= 3.0 * (1.0 + 1e-12)


def test_a_round_blank_is_cleared_and_faced() -> None:
    stock = Stock(shape="round", diameter=160.0, top=1.5)
    found = named(sequence(INNER, stock=stock))
    assert list(found) == ["face", "rough bore", "bore", "rough outline", "outline"]
    face, rough, finish = found["face"], found["rough outline"], found["outline"]
    assert isinstance(face, AreaCut)
    assert (face.top, face.bottom, face.walls) == (1.5, 0.0, ())
    assert isinstance(rough, AreaCut)
    assert isinstance(rough.stock, ExactBoundary)
    assert rough.stock.round_radius == 80.0
    assert [wall.name for wall in rough.walls] == ["outline"]
    assert isinstance(finish, ContourCut)
    assert finish.room == 6.0


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


def test_a_bore_that_is_there_is_left_alone() -> None:
    spec = replace(SPEC, keyway=Keyway(8.0, 3.3))
    found = sequence(INNER, stock=Stock(bore=BORE), spec=spec)
    assert list(named(found)) == ["rough outline", "outline"]
    (told,) = (each for each in found.findings if each.name == "bore-left-out")
    assert "25 mm; it is not milled; the keyway is left to be broached" in told.sentence
    milled = named(sequence(INNER, spec=spec))
    assert milled["bore"].note == "the keyway is left to be broached"


def test_a_drill_of_the_bore_drills_it() -> None:
    drill = tool(BORE, 2, kind="drill", tip_angle=2.0, flute_length=60.0, stepdown=5.0)
    found = named(sequence(INNER, tool(12.0), drill))
    bore = found["bore"]
    assert isinstance(bore, PointCut)
    assert bore.points == (0j,)
    # The full diameter goes through, the point beyond.
    assert bore.bottom == BOTTOM - drill.tip_length
    assert [cut.tool.number for cut in found.values()] == [2, 1, 1]


def test_the_first_tool_that_fits_is_used() -> None:
    """One for the wide outline, a smaller one where the first does not go in."""
    found = named(sequence(INNER, tool(30.0), tool(12.0, 2), stock=Stock()))
    assert {name: cut.tool.number for name, cut in found.items()} == {
        "rough bore": 2, "bore": 2, "rough outline": 1, "outline": 1,
    }  # fmt: skip
    short = tool(12.0, flute_length=10.0)
    found = named(sequence(INNER, short, tool(10.0, 2, flute_length=10.5)))
    assert {cut.tool.number for cut in found.values()} == {2}


def test_grooves() -> None:
    wide = named(sequence(GROOVE, tool(2.0 * ROLLER), stock=Stock(bore=BORE)))
    slot = wide["groove"]
    assert isinstance(slot, ContourCut)
    assert (slot.right, slot.left) == ("outer flank", "inner flank")


def test_the_rim_is_that_of_the_blank_or_cut_out_of_it() -> None:
    for stock in (Stock(), Stock(shape="round", diameter=RIM)):
        found = sequence(OUTER, stock=stock)
        assert "rough rim" not in named(found)
        assert any(each.name == "rim-left-out" for each in found.findings)
    square = named(sequence(OUTER, stock=Stock(length=170.0, width=170.0)))
    assert list(square) == ["rough rim", "rim", "rough outline", "outline"]
    assert isinstance(square["rough rim"], ContourCut)
