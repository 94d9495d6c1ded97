"""Sequences of cuts that are refused: the key that is at fault, and what is allowed.

`tests.toolpath.test_wrongs` has scenes of which some are refused, and whole sentences.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.geometry.contour.contour import POINTS, Contour
from camgeo.milling.bench import MOST_PASSES, passes
from camgeo.milling.cut import ContourCut
from camgeo.milling.machine import load
from camgeo.milling.milling import Clamp, Heights, Holding, Stock, Tabs, Tool
from camgeo.milling.moves import ArcFeed, Feed, Operation, Rapid, Toolpath
from camgeo.milling.planned import LARGEST
from camgeo.milling.simulation import FINENESS
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.spec import Hub, PartSpec
from tests.part.parts import refused
from tests.toolpath.milled import (
    BORE,
    HOOKED,
    HUB_TOOLS,
    HUBBED,
    RIM,
    SPEC,
    THICKNESS,
    TOOLS,
    Operations,
    named,
    operation,
    sequence,
    tool,
)

INNER, OUTER, GROOVE = Contact.INNER, Contact.OUTER, Contact.GROOVE

WASHER: Final = Clamp(
    place=0j, length=30.0, width=30.0, height=8.0, round=True, since="rough outline"
)

PLATE: Final[dict[str, Any]] = {"length": 170.0, "width": 170.0}

ROUND: Final = Stock(shape="round", diameter=170.0, top=1.0)

DRILLED: Final = {"stock": Stock(bore=BORE)}


def clamped(kind: str, *clamps: Clamp) -> dict[str, Any]:
    return {"holding": Holding(kind=kind, through=0.5, clamps=clamps)}


def clamp(place: complex, length: float, width: float, **own: Any) -> Clamp:
    return Clamp(place=place, length=length, width=width, height=8.0, **own)


PLANNED: Final[list[tuple[Contact, dict[str, Any], str, str]]] = [
    # tools
    *((GROOVE, {"tools": (tool(each),), **DRILLED}, "from 8 to 16 mm", "tool")
      for each in (2.0, 7.9, 16.1)),
    *((INNER, {"tools": (tool(each),)}, "smaller than the bore, 25 mm", "tool.diameter")
      for each in (25.0, 30.0)),
    (INNER, {"tools": (tool(12.0, flute_length=10.0),)},
     "tool 1: its cutting edges, 10 mm, are shorter than", "tool.flute_length"),
    (INNER, {"tools": (tool(12.0, stepdown=None),)}, "tool 1 states no stepdown", "tool.stepdown"),
    (INNER, {"tools": (tool(6.0, stepover=None),)}, "needed to clear an area", "tool.stepover"),
    (INNER, {"tools": (tool(2.1 * LARGEST),)}, "must be at most 200000 mm", "tool.diameter"),
    # blank
    (INNER, {"stock": Stock(top=1.0)}, "outline of a blank that is to be faced", "stock.length"),
    (INNER, {"stock": Stock(**PLATE, bore=BORE + 1e-3)}, "at most the bore of the part, 25 mm",
     "stock.bore"),
    # A part out of a plate is no smaller than one from the round, whatever is cut around it.
    *((INNER, {"stock": stock}, "the blank is too small", "stock") for stock in (
        Stock(shape="round", diameter=130.0, centre=20.0), Stock(length=200.0, width=90.0),
        Stock(length=130.0, width=200.0, centre=20.0 + 3.0j))),
    (GROOVE, {"stock": Stock(length=2.0 * LARGEST, width=170.0, bore=BORE)},
     r"the blank reaches 1e\+05 mm .* for up to 100000", "stock"),
    (INNER, {"stock": Stock(shape="round", diameter=160.0, top=5.0), "heights": Heights(20.0, 4.0)},
     "above the blank, 5 mm", "output.gcode.retract_height"),
    # part
    (INNER, {"spec": PartSpec(bore=25.0)}, "thickness", "part.thickness"),
    *((INNER, {"spec": replace(HUBBED, hub=Hub(40.0, 6.0, side))}, "milled from there",
       "part.hub.side") for side in ("lower", "both")),
    # holding
    *((contact, {"holding": None}, "cuts through, and nothing holds what it cuts free", "holding")
      for contact in (INNER, OUTER, GROOVE)),
    (INNER, clamped("screws", replace(WASHER, since="")),
     r"rough bore .*runs into the screw at 0, 0 mm", "holding"),
    (INNER, clamped("clamps", clamp(100.0 + 0j, 20.0, 20.0)),
     "free while no clamp or screw stands on it", "holding"),
    (INNER, clamped("clamps", clamp(50.0j, 20.0, 60.0)),
     "rough outline with tool 1 runs into the clamp", "holding"),
    (INNER, {**clamped("screws", WASHER), "heights": Heights(8.0, 8.0)},
     "above the screw at 0, 0 mm, 8 mm high", "output.gcode.clearance_height"),
    (INNER, clamped("clamps", clamp(0j, 30.0, 30.0, until="outlin")),
     'no such operation; there are "rough bore"', "holding.clamp.until"),
    (INNER, {"holding": Holding(kind="onion-skin", skin=THICKNESS)},
     "must be less than the thickness", "holding.thickness"),
    (INNER, {"holding": Holding(kind="tabs", through=0.5, tabs=Tabs(4, 6.0, THICKNESS))},
     "must be less than the thickness", "holding.height"),
]  # fmt: skip
"""Contact, what is given beside it, what is said, and the key; of planned sequences."""

TWICE: Final[Operations] = (operation("rough", "outline"), operation("rough", "outline"))

SPIRAL: Final = operation("rough", "outline", strategy="spiral")

HOOK: Final = {"stock": Stock(shape="round", diameter=290.0), "pitch": HOOKED,
               "tools": (tool(4.0),)}  # fmt: skip

HUB: Final = {"spec": HUBBED, "tools": HUB_TOOLS}

BLANK: Final = {"stock": ROUND}

TABBED: Final = Holding(kind="tabs", through=0.3, tabs=Tabs(3, 5.0, 1.5))

STATED: Final[list[tuple[Contact, Operations, dict[str, Any], str, str]]] = [
    # walls
    (INNER, (operation("finish", "outlin"),), BLANK, 'no such wall; it has "outline", "bore"',
     "boundary"),
    (INNER, (operation("engrave", tool=3, boundary="hub"),), HUB, "is neither a mark", "boundary"),
    (INNER, (operation("drill", "mark", 2),), HUB, "is not a through hole", "boundary"),
    (INNER, (operation("drill", "hole", 2),), HUB, "no such wall", "boundary"),
    # tools
    (INNER, (operation("drill"),), BLANK, 'needs a tool of kind "drill", not "end-mill"', "tool"),
    (INNER, (operation("rough", "outline", 2),), BLANK, 'needs a tool of kind "end-mill"', "tool"),
    (INNER, (operation("engrave"),), HUB, "not as wide as the mark", "tool"),
    (GROOVE, (operation("slot"),), BLANK, "not as wide as the groove, 16 mm", "tool"),
    # allowances
    (GROOVE, (operation("rough", "outer flank", allowance=4.0),), BLANK,
     "less than 4 mm with tool 1: more would cut into the flank across the groove", "allowance"),
    (INNER, (operation("bore", allowance=7.0),), BLANK,
     r"less than 6\.5 mm with tool 1: its smallest concave radius is 12\.5 mm", "allowance"),
    # chamfers
    (INNER, (operation("chamfer", "outline", 3, size=4.9),), {}, "a chamfer of 4.9 mm", "tool"),
    (GROOVE, (operation("chamfer", "outer flank", 5, size=1.5),), {},
     "point, 6.203 mm deep, reaches the floor at Z -6", "tool"),
    (GROOVE, (operation("chamfer", "inner flank", 6, size=14.0),), {},
     "would reach the outer flank", "size"),
    (INNER, (operation("chamfer", "bore", 3, size=0.5),), BLANK, "must face it before", "kind"),
    # strategies
    (INNER, (operation("rough", "hub", strategy="ramp"),), HUB, "does not suit a boss",
     "strategy"),
    (INNER, (SPIRAL,), {}, "whose outline is stated", "strategy"),
    (INNER, (SPIRAL,), HOOK, "rays from the cam axis", "strategy"),
    (INNER, (operation("rough", "outline", strategy="trochoidal"),), {"holding": TABBED},
     "cannot leave tabs", "strategy"),
    # others
    (INNER, (operation("face"),), {}, "nothing to face", "kind"),
    (INNER, TWICE, {}, "its own name", "name"),
]  # fmt: skip
"""Contact, operations, what is given beside them, what is said, and the key of the last one."""


@pytest.mark.parametrize(("contact", "given", "message", "key"), PLANNED)
def test_a_planned_sequence_is_refused(
    contact: Contact, given: dict[str, Any], message: str, key: str
) -> None:
    tools = given.get("tools", ())
    own = {name: each for name, each in given.items() if name != "tools"}
    with refused(key, message):
        sequence(contact, *tools, **{"spec": SPEC, **own})


@pytest.mark.parametrize(("contact", "operations", "given", "message", "key"), STATED)
def test_an_operation_is_refused(
    contact: Contact, operations: Operations, given: dict[str, Any], message: str, key: str
) -> None:
    tools = given.get("tools", TOOLS)
    own = {name: each for name, each in given.items() if name != "tools"}
    with refused(f"operation[{len(operations)}].{key}", message):
        sequence(contact, *tools, **own, operations=operations)


# -- guard -----------------------------------------------------------------------------------------
# Holding: what cuts something free is held, clamps come and go, and nothing runs into them.


ASIDE = Clamp(place=100.0 + 0j, length=20.0, width=20.0, height=8.0)

ON_IT = Clamp(place=20.0j, length=8.0, width=8.0, height=8.0, since="rough outline")


def test_a_skin_is_left_below_the_part_and_told() -> None:
    found = sequence(INNER, holding=Holding(kind="onion-skin", skin=0.3))
    assert {cut.bottom for cut in found.cuts} == {0.3 - THICKNESS}
    assert [each.severity for each in found.findings if each.name == "onion-skin"] == ["warning"]


def test_tabs_stand_on_what_is_cut_free_and_are_told_on_a_flank() -> None:
    holding = Holding(kind="tabs", through=0.5, tabs=Tabs(4, 6.0, 2.0))
    found = sequence(INNER, holding=holding)
    tabs = {cut.name: cut.tabs is not None for cut in found.cuts if isinstance(cut, ContourCut)}
    assert tabs == {"rough bore": False, "bore": False, "rough outline": True, "outline": True}
    (told,) = (each for each in found.findings if each.name == "tabs-on-a-flank")
    assert told.severity == "warning"
    assert "4 tabs of 6 mm, up to 2 mm" in told.sentence
    stock = Stock(length=170.0, width=170.0, bore=25.0)
    rim = sequence(GROOVE, tool(12.0), stock=stock, holding=holding)
    assert not any(each.name == "tabs-on-a-flank" for each in rim.findings)
    cut = named(rim)["rim"]
    assert isinstance(cut, ContourCut)
    # The cut ends below the part; tabs are stated from its lower face.
    assert cut.tabs == Tabs(4, 6.0, 2.5)


def test_a_screw_is_set_when_the_bore_is_there() -> None:
    holding = Holding(kind="screws", through=0.5, clamps=(WASHER,))
    found = named(sequence(INNER, holding=holding))
    assert [len(cut.obstacles) for cut in found.values()] == [0, 0, 1, 1]
    assert found["rough outline"].stop == "set the screw at 0, 0 mm"
    assert found["outline"].stop == ""


@pytest.mark.parametrize(
    ("contact", "given"),
    [
        (GROOVE, {"stock": Stock(bore=BORE), "holding": None}),  # cut into the blank
        (GROOVE, {"stock": Stock(shape="round", diameter=RIM, bore=BORE), "holding": None}),
        (INNER, {"stock": Stock(length=170.0, width=170.0, bore=BORE)}),
        (INNER, {"holding": Holding(kind="clamps", through=0.5, clamps=(ASIDE, ON_IT))}),
    ],
)
def test_what_may_just_be(contact: Contact, given: dict[str, Any]) -> None:
    """`test_refused.py` has what may not."""
    assert sequence(contact, **given).cuts


def test_chords_of_the_largest_work_can_be_simulated() -> None:
    assert math.pi / math.acos(1.0 - FINENESS / LARGEST) < 25_000 < POINTS


def test_a_core_that_a_fixture_must_hold_is_told() -> None:
    (told,) = (each for each in sequence(OUTER).findings if each.name == "loose-core")
    assert told.severity == "warning"


# -- doors -----------------------------------------------------------------------------------------
# Refusals of the classes of a program, beyond those that tests/mechanism/test_values.py covers.


TOOL = Tool(number=1, diameter=6.0, spindle_speed=3000.0, feed=300.0, plunge_feed=100.0)

HOLE = ExactBoundary("bore", hole=True, exact=Contour.circle(5.0))

CUT = ContourCut(
    name="bore",
    strategy="profile",
    tool=TOOL,
    top=0.0,
    depths=(-2.0, -4.0),
    centre=HOLE,
    right="bore",
    room=1.0,
)

HOME = Rapid((0.0, 0.0, 5.0))


@pytest.mark.parametrize(
    "change",
    [
        {"depths": ()},
        {"depths": (-4.0, -2.0)},
        {"depths": (-2.0, math.nan)},
        {"top": -3.0},
        {"allowance": -0.1},
        {"compensation": "left"},
    ],
)
def test_cuts(change: dict[str, Any]) -> None:
    with refused("toolpath"):
        replace(CUT, **change)


def once() -> Operation:
    return Operation(CUT, (HOME,))


REFUSED: list[tuple[Callable[[], object], str, str]] = [
    (lambda: Feed((0.0, 0.0), 1.0), "must be 3 coordinates", "toolpath"),  # type: ignore[arg-type]  # wrong on purpose
    (lambda: ArcFeed((0.0, 0.0, 0.0), 0j, True, 1.0), "must be 2 coordinates", "toolpath"),  # type: ignore[arg-type]  # wrong on purpose
    (lambda: ArcFeed((0.0, 0.0, 0.0), (0.0, 0.0), 1, 1.0), "true or false", "toolpath"),  # type: ignore[arg-type]  # wrong on purpose
    (lambda: Operation(CUT, ()), "must begin with a traverse", "toolpath"),
    (
        lambda: Operation(CUT, (Feed((0.0, 0.0, -1.0), 100.0), HOME)),
        "must begin with a traverse",
        "toolpath",
    ),
    (lambda: Toolpath(Heights(5.0, 5.0), (once(), once())), "its own name", "toolpath"),
    (lambda: Heights(math.nan, 2.0), "above 0", "output.gcode.clearance_height"),
    (lambda: Heights(5.0, 6.0), "to 5", "output.gcode.retract_height"),
    (lambda: passes(0.0, -10.0, 1e-9), r"must be at least 0\.01 mm", "tool.stepdown"),
    (
        lambda: replace(load("linuxcnc").program, end=("M{two}",)),
        "no braces but",
        "program.end",
    ),
]


@pytest.mark.parametrize(("make", "message", "key"), REFUSED)
def test_what_is_wrong_is_refused_with_its_key(
    make: Callable[[], object], message: str, key: str
) -> None:
    with refused(key, message):
        make()


@given(st.floats(0.01, 60.0), st.floats(0.1, 80.0))
def test_passes_are_equal_and_no_more_than_needed(depth: float, stepdown: float) -> None:
    found = passes(1.0, 1.0 - depth, stepdown)
    assert found[-1] == 1.0 - depth
    assert -np.diff((1.0, *found)) == pytest.approx(depth / len(found))
    assert depth / len(found) <= stepdown * (1.0 + 1e-9)
    assert len(found) == 1 or depth / (len(found) - 1) > stepdown


def test_no_more_passes_than_sense() -> None:
    assert len(passes(0.0, -10.0, 10.0 / MOST_PASSES)) == MOST_PASSES
