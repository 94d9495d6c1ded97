"""Scenes whose milling is refused, programs that must not be run, and what is said of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any, Final

import pytest

from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo.milling.moves import ArcFeed, Feed, Move, Operation, Rapid, Stop, Toolpath
from camgeo.scene.scene import parse_scene
from tests.kept import compare_documents
from tests.thinned import WHOLE, share
from tests.toolpath.programs import (
    CHAMFER,
    CLAMPS,
    DRILL,
    FIXTURE,
    GROOVE,
    PASSES,
    PLATE,
    ROUND,
    SCENES,
    TOLERANCE,
    mill,
    milled,
    operation,
    scene,
    toolpath,
)

FIRST: Final = SCENES["planned, from a round blank"]

TABS: Final = SCENES["planned, from a plate with tabs"]

ALL: Final = SCENES["stated, all kinds"]

SKIN: Final = SCENES["planned, on a skin"]

HUB: Final = SCENES["planned, a hub, holes and a mark"]

LETTERS: Final = SCENES["engraved"]


def stated(*operations: str, tools: str = "", contact: str = "inner", part: str = "bore = 16",
           stock: str = PLATE, gcode: str = "", holding: str = FIXTURE) -> str:  # fmt: skip
    """A scene with some operations."""
    tools = tools or mill(1, 10) + mill(2, 6) + CHAMFER + DRILL.format(diameter=14)
    return scene(tools, stock, holding, *operations, contact=contact, part=part, gcode=gcode)


def flanks(*operations: str, tools: str) -> str:
    return stated(*operations, tools=tools, contact="groove", part=GROOVE, stock="")


EDITS: Final[dict[str, tuple[str, str, str]]] = {
    "no holding": (FIRST, FIXTURE, ""),
    "a blank that is too small": (FIRST, "diameter = 74", "diameter = 54"),
    "a blank that is too small on one side": (FIRST, "centre = [1, -0.5]", "centre = [9, 0]"),
    "a blank with a larger bore": (FIRST, "top = 0.5", "top = 0.5\nbore = 17"),
    "a blank with the bore": (FIRST, "top = 0.5", "top = 0.5\nbore = 16"),
    "a blank with a bore that may be": (FIRST, "top = 0.5", "top = 0.5\nbore = 12"),
    "a blank above the traverses": (FIRST, "top = 0.5", "top = 4"),
    "a blank almost up to the traverses": (FIRST, "top = 0.5", "top = 3.99"),
    "an unknown blank that is higher": (FIRST, 'shape = "round"\ndiameter = 74\n', ""),
    "a tool without a stepdown": (FIRST, "stepdown = 2.5\n", ""),
    "a tool without a stepover": (FIRST, "stepover = 3\n", ""),
    "a stepover beyond the cutter": (FIRST, "stepover = 3\n", "stepover = 10.1\n"),
    "a stepover of the cutter": (FIRST, "stepover = 3\n", "stepover = 10\n"),
    "a tool that is too short": (FIRST, "flute_length = 14", "flute_length = 6.2"),
    "a tool that is long enough": (FIRST, "flute_length = 14", "flute_length = 6.81"),
    "a tool that is too large": (FIRST, "diameter = 10", "diameter = 16.5"),
    "a stepdown of a thousandth": (FIRST, "stepdown = 2.5", "stepdown = 0.005"),
    "a ramp that is too flat": (TABS, "ramp_angle = 4", "ramp_angle = 1"),
    "tabs that are as high as the part": (TABS, "height = 1.5", "height = 6"),
    "too many tabs": (TABS, "count = 3", "count = 9"),
    "a corner that a round blank does not have": (
        FIRST, 'zero_height = "blank-top"', 'zero = "front-left"'
    ),
    "a skin that is as thick as the part": (SKIN, "thickness = 0.4", "thickness = 6"),
    "a clamp in the way": (CLAMPS, "place = [-62, 0]", "place = [-56, 0]"),
    "a clamp that goes too late": (CLAMPS, 'until = "rough outline"\n', ""),
    "a clamp of no operation": (CLAMPS, 'until = "rough outline"', 'until = "outlines"'),
    "a clamp as high as the traverses": (CLAMPS, "height = 10", "height = 20"),
    "a strap that comes too late": (CLAMPS, 'since = "rough outline"', 'since = "outline"'),
    "no drill for the holes": (HUB, "diameter = 4\ntip", "diameter = 4.5\ntip"),
    "a drill that is too short": (HUB, "flute_length = 30", "flute_length = 6"),
    "no cutter for the mark": (HUB, "diameter = 2\n", "diameter = 2.5\n"),
    "a cutter that is too wide for letters": (LETTERS, "diameter = 0.5\n", "diameter = 2\n"),
    "a cutter for letters that does not plunge": (LETTERS, "plunges = true", "plunges = false"),
    "two tools of one number": (ALL, "number = 2\ndiameter = 6", "number = 1\ndiameter = 6"),
    "an unknown tool": (ALL, "tool = 6", "tool = 9"),
    "operations of one name": (ALL, 'name = "first"', 'name = "face"'),
    "too much compensation": (ALL, 'compensation = "wear"', 'compensation = "control"'),
    "a chamfer that is too large": (ALL, "size = 0.5", "size = 2.8"),
    "an end mill that drills": (ALL, 'kind = "drill"\ntool = 6', 'kind = "drill"\ntool = 1'),
    "a drill that is larger": (ALL, "diameter = 14", "diameter = 16.5"),
    "an allowance that is too large": (ALL, "allowance = 0.2", "allowance = 5"),
    "a part beyond all machines": (FIRST, "diameter = 10", "diameter = 200001"),
}  # fmt: skip
"""A good scene, some words of it, and what stands instead."""

STATED: Final = {
    "nothing to face": stated(operation("face")),
    "no outline of the blank to face": stated(operation("face"), stock="[stock]\ntop = 1\n"),
    "no such wall": stated(operation("finish", "rim")),
    "no hole": stated(operation("drill", "outline", 6)),
    "no mark": stated(operation("engrave", "bore")),
    "no groove of that width": flanks(operation("slot"), tools=mill(1, 12)),
    "a slot of that width": flanks(operation("slot"), tools=mill(1, 16)),
    "a groove that is narrower than its rounds": flanks(tools=mill(1, 7)),
    "a cutter that is larger than the groove": flanks(tools=mill(1, 16.1)),
    "a cutter across a flank": flanks(
        operation("rough", "outer flank", allowance=4), tools=mill(1, 12)
    ),
    "loops without room": stated(
        operation("rough", "outline", strategy="trochoidal"),
        tools=mill(1, 10, f"{PASSES}\nengagement = 0.5"),
    ),
    "loops and tabs": stated(
        operation("rough", "outline", strategy="trochoidal"),
        holding='[holding]\nkind = "tabs"\nthrough = 0.2\ncount = 3\nwidth = 5\nheight = 1.5\n',
    ),
    "a spiral without a blank": stated(
        operation("rough", "outline", strategy="spiral"), stock=""
    ),
    "a spiral in a flank": flanks(
        operation("rough", "outer flank", strategy="spiral"), tools=mill(1, 12)
    ),
    "compensation without leads": stated(operation("finish", "outline", compensation="wear")),
    "compensation of all without leads": stated(
        operation("finish", "outline"), gcode='compensation = "wear"'
    ),
    "one tool with both compensations": stated(
        operation("rough", "outline", allowance=0.6), operation("bore", allowance=0.6),
        operation("finish", "bore", 2, compensation="wear"),
        operation("finish", "outline", 2, compensation="control"), stock=ROUND,
    ),
    "a chamfer before the face": stated(operation("chamfer", "bore", 5, size=0.5), stock=ROUND),
    "a chamfer into the next wall": stated(
        operation("chamfer", "bore", 5, size=2.5), part="bore = 44"
    ),
    "a rough wall that nothing follows": stated(operation("rough", "outline", allowance=0.3)),
    "less depth than the wall": stated(operation("finish", "outline", depth=3)),
    "a boss with a ramp": stated(
        operation("rough", "hub", strategy="ramp"),
        part="bore = 10\nhub = { diameter = 18, height = 4 }",
    ),
    "a finish that is wider than its slot": stated(
        operation("rough", "outline", 2, allowance=0.3), operation("finish", "outline", 1)
    ),
    "a finish that leaves more than is there": stated(
        operation("rough", "outline", allowance=0.3),
        operation("finish", "outline", 2, allowance=0.31),
    ),
    "a larger cutter in the bore than it roughs": stated(
        operation("bore", tool=2, allowance=0.2), operation("finish", "bore", 1)
    ),
}  # fmt: skip
"""Scenes with operations that are refused, or told of."""

REFUSED: Final = (*EDITS, *STATED)


def refusal(name: str) -> Any:
    """What is said of a scene: why it is refused, or what is told and found."""
    if name in EDITS:
        good, old, new = EDITS[name]
        assert old in good, name
        text = good.replace(old, new)
    else:
        text = STATED[name]
    try:
        disc = Design(parse_scene(text)).disc.milled
        plan = disc.toolpath(TOLERANCE)
        cuts = [[each.name, each.bottom, *getattr(each, "produced", ())] for each in disc.cuts]
        return [cuts, [asdict(each) for each in disc.findings(plan, TOLERANCE)]]
    except CamgeoError as error:
        return str(error)


def moved(move: Move, by: tuple[float, float, float]) -> Move:
    """The same move elsewhere."""
    x, y, z = move.end
    end = (x + by[0], y + by[1], z + by[2])
    if isinstance(move, ArcFeed):
        return replace(move, end=end, centre=(move.centre[0] + by[0], move.centre[1] + by[1]))
    return replace(move, end=end)


def with_moves(plan: Toolpath, number: int, moves: Iterator[Move | Stop]) -> Toolpath:
    operations = list(plan.operations)
    operations[number] = Operation(operations[number].cut, tuple(moves))
    return replace(plan, operations=tuple(operations))


def shifted(plan: Toolpath, number: int, by: tuple[float, float, float]) -> Toolpath:
    """The feed moves of an operation moved, and its traverses over them."""
    flat = (by[0], by[1], 0.0)
    return with_moves(
        plan, number,
        (each if isinstance(each, Stop) else moved(each, flat if isinstance(each, Rapid) else by)
         for each in plan.operations[number].moves),
    )  # fmt: skip


def hurried(plan: Toolpath, number: int) -> Toolpath:
    """Its straight ways down as traverses."""
    at = (0.0, 0.0, 1e3)
    found: list[Move | Stop] = []
    for each in plan.operations[number].moves:
        if isinstance(each, Feed) and each.end[:2] == at[:2] and each.end[2] < at[2]:
            found.append(Rapid(each.end))
        else:
            found.append(each)
        at = at if isinstance(each, Stop) else each.end
    return with_moves(plan, number, iter(found))


def without(plan: Toolpath, number: int) -> Toolpath:
    return replace(plan, operations=(*plan.operations[:number], *plan.operations[number + 1 :]))


RUN: Final = (
    "planned, from a plate with tabs", "planned, on a skin", "planned, a groove in one round",
    "stated, all kinds", "stated, a spiral from a plate",
    "clamps that move", "a second side, faced free", "a second side, cut from below",
    "a second side, the other half",
)  # fmt: skip
"""Programs that are run otherwise than they are planned."""

WAYS: Final = ("aside", "far aside", "lower", "higher", "hurried", "left out")


def flawed(name: str, way: str) -> Any:
    """The flaws of a program of which the last operation, or the one before, is run otherwise."""
    plan = toolpath(name)
    last = len(plan.operations) - 1
    made = {
        "aside": lambda: shifted(plan, last, (0.05, 0.0, 0.0)),
        "far aside": lambda: shifted(plan, max(last - 1, 0), (-14.0, 6.0, 0.0)),
        "lower": lambda: shifted(plan, last, (0.0, 0.0, -0.75)),
        "higher": lambda: shifted(plan, max(last - 1, 0), (0.0, 0.0, 0.5)),
        "hurried": lambda: hurried(plan, max(last - 1, 0)),
        "left out": lambda: without(plan, last),
    }[way]()
    return [asdict(each) for each in milled(name).flaws(made, TOLERANCE)]


DEEPER = ("a second side, the other half",)
"""Programs that may run lower: the first side has cut there already."""


def test_what_is_said_of_scenes_is_as_kept() -> None:
    """The key that is at fault, its value, what is allowed; or what is told of the program."""
    said = {name: refusal(name) for name in share(REFUSED, 3)}
    compare_documents("toolpath/refused", said, whole=WHOLE)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", RUN)
def test_a_program_that_is_run_otherwise_is_as_kept(name: str, way: str) -> None:
    """What the cutter runs into, what is left, where and how much; the good program has none."""
    found = flawed(name, way)
    compare_documents(f"toolpath/run otherwise/{name}, {way}", {way: found})
    wrong = [each for each in found if not each["watched"]]
    last = toolpath(name).operations[-1]
    if way in ("lower", "far aside") and name not in DEEPER:
        assert wrong
    for each in wrong:
        if each["name"] == "depth":
            assert each["value"] < each["limit"]
        if way == "aside" and each["operation"] == last.name and each["name"] == "gouge":
            assert each["value"] == pytest.approx(0.05, abs=0.02)


def test_a_face_that_is_milled_too_deep_is_told() -> None:
    """By half of the part's thickness, all over."""
    name = "planned, from a round blank"
    deep = shifted(toolpath(name), 0, (0.0, 0.0, -3.0))
    assert "gouge" in [each.name for each in milled(name).flaws(deep, TOLERANCE)]


def test_a_bore_that_is_not_cut_is_told_with_its_size() -> None:
    found = refusal("a slot of that width")[1]
    (rest,) = [each for each in found if each["name"] == "rest"]
    assert rest["value"] == pytest.approx(10.0, abs=0.1)
