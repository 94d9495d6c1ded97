"""Small scenes with milling programs of each kind, and all that camgeo says of these programs."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from camgeo.design.design import Design
from camgeo.design.milled import MilledDisc, job
from camgeo.milling.compensation import offset_limits, programmed
from camgeo.milling.cut import AreaCut, ContourCut, Cut, LetterCut, LineCut, PointCut
from camgeo.milling.judged import PART_FINENESS, Side, simulation_setup, toolpath_runs
from camgeo.milling.machine import load
from camgeo.milling.machining_time import machine_times
from camgeo.milling.moves import ArcFeed, Move, Rapid, Stop, Toolpath, arc_sweep, described
from camgeo.pictures.backplot import KINDS, plot_operations
from camgeo.scene.scene import parse_scene
from camgeo_export.verify.gcode import depths
from tests.second_side import scenes as second_side

ROOT: Final = Path(__file__).resolve().parents[2]

TOLERANCE: Final = 0.02
"""Of all these programs [mm]."""

CAM: Final = """camgeo = 1
name = "cam"
[cam]
rotation = "cw"
[follower]
kind = "translating-roller"
base_radius = 25
roller_radius = 8
offset = 3
contact = "{contact}"
[[motion]]
law = "polynomial-345"
span = 150
to = 8
[[motion]]
dwell = 30
[[motion]]
law = "modified-sine"
span = 180
to = 0
[part]
thickness = 6
{part}
[output]
formats = ["gcode"]
[output.gcode]
machine = "{machine}"
clearance_height = 15
retract_height = 4
{gcode}
"""

MILL: Final = """[[tool]]
number = {number}
diameter = {diameter}
flute_length = 14
spindle_speed = 3000
feed = 500
plunge_feed = 150
{own}
"""

PASSES: Final = "stepdown = 2.5\nstepover = 3\nramp_angle = 4"

CHAMFER: Final = """[[tool]]
number = 5
kind = "chamfer-mill"
diameter = 6
tip_angle = 90
spindle_speed = 4000
feed = 300
plunge_feed = 100
"""

DRILL: Final = """[[tool]]
number = 6
kind = "drill"
diameter = {diameter}
tip_angle = 118
flute_length = 30
spindle_speed = 1200
feed = 110
stepdown = 3
"""

FIXTURE: Final = '[holding]\nkind = "fixture"\nthrough = 0.3\n'

ROUND: Final = '[stock]\nshape = "round"\ndiameter = 74\ntop = 0.5\ncentre = [1, -0.5]\n'

PLATE: Final = "[stock]\nlength = 90\nwidth = 84\ncentre = [2, -3]\n"


def scene(
    *tables: str,
    contact: str = "inner",
    part: str = "bore = 16",
    machine: str = "linuxcnc",
    gcode: str = "",
) -> str:
    head = CAM.format(contact=contact, part=part, machine=machine, gcode=gcode)
    return "\n".join((head, *tables))


def mill(number: int, diameter: float, own: str = PASSES) -> str:
    return MILL.format(number=number, diameter=diameter, own=own)


def operation(kind: str, boundary: str = "", tool: int = 1, **own: object) -> str:
    lines = [f'kind = "{kind}"', f"tool = {tool}"]
    lines += [f'boundary = "{boundary}"'] if boundary else []
    lines += [f"{key} = {json.dumps(value)}" for key, value in own.items()]
    return "\n".join(("[[operation]]", *lines))


GROOVE: Final = "bore = 20\nrim = 100\ngroove_depth = 4"

SCENES: Final = {
    "planned, from a round blank": scene(
        mill(1, 10), ROUND, FIXTURE, gcode='zero_height = "blank-top"'
    ),
    "planned, from a plate with tabs": scene(
        mill(1, 8), PLATE,
        '[holding]\nkind = "tabs"\nthrough = 0.2\ncount = 3\nwidth = 5\nheight = 1.5\n',
        machine="grbl", gcode='zero = "front-left"\nzero_height = "blank-bottom"',
    ),
    "planned, on a skin": scene(
        mill(1, 6, "stepdown = 2\nstepover = 2\nplunges = true"),
        '[holding]\nkind = "onion-skin"\nthickness = 0.4\n', machine="mach3",
    ),
    "planned, a ring": scene(
        mill(1, 10), FIXTURE, contact="outer", part="rim = 96", machine="haas"
    ),
    "planned, a groove in two rounds": scene(
        mill(1, 12), FIXTURE, contact="groove", part=GROOVE, machine="sinumerik"
    ),
    "planned, a groove in one round": scene(
        mill(1, 16), FIXTURE, contact="groove", part=GROOVE, machine="fanuc"
    ),
    "planned, a bore that is drilled": scene(
        DRILL.format(diameter=16), mill(1, 10), ROUND, FIXTURE
    ),
    "planned, a hub, holes and a mark": scene(
        mill(1, 8, "stepdown = 5.5\nstepover = 3\nramp_angle = 3"), mill(3, 2, "stepdown = 0.5"),
        DRILL.format(diameter=4).replace("= 6\n", "= 4\n"),
        ROUND.replace("top = 0.5\n", "bottom = 1\n"), FIXTURE,
        part="bore = 10\nhub = { diameter = 18, height = 4 }\n"
        "bolt_circle = { count = 3, circle = 30, hole = 4, angle = 30 }\n"
        "mark = { radius = 12, width = 2, length = 4, depth = 0.5, angle = 210 }",
        gcode="tool_change_height = 40",
    ),
    "stated, all kinds": scene(
        mill(1, 10), mill(2, 6), CHAMFER, DRILL.format(diameter=14), ROUND, FIXTURE,
        operation("face", stepover=6), operation("drill", tool=6),
        operation("rough", "outline", allowance=0.3, name="first", note="slowly"),
        operation("bore", tool=2, allowance=0.2, stepdown=4),
        operation("finish", "bore", 2, springs=1, compensation="wear", stop="turn the clamp"),
        operation("finish", "outline", 1, feed=350, spindle_speed=3500, coolant="flood"),
        operation("chamfer", "outline", 5, size=0.5, springs=1),
        gcode="tool_change_height = 60",
    ),
    "stated, conventional": scene(
        mill(1, 10), ROUND.replace("top = 0.5\n", ""), FIXTURE,
        operation("bore", allowance=0.2, direction="conventional"),
        operation("finish", "bore", direction="conventional"),
        operation("rough", "outline", allowance=0.4, direction="conventional"),
        operation("finish", "outline", direction="conventional", compensation="control"),
        machine="haas",
    ),
    "stated, loops": scene(
        mill(1, 10, f"{PASSES}\nengagement = 60"), FIXTURE,
        operation("rough", "outline", allowance=0.3, strategy="trochoidal", stepdown=6.3),
        operation("finish", "outline"), part="",
    ),
    "stated, loops in a groove": scene(
        mill(1, 10, "stepdown = 4\nstepover = 3"), FIXTURE,
        operation("rough", "outer flank", allowance=0.2, strategy="trochoidal"),
        operation("finish", "outer flank"), operation("finish", "inner flank"),
        contact="groove", part="bore = 16\nrim = 100\ngroove_depth = 3",
    ),
    "stated, a spiral from a plate": scene(
        mill(1, 12, "stepdown = 6.3\nstepover = 5\ncorner_radius = 1"), mill(2, 8), PLATE, FIXTURE,
        operation("rough", "outline", allowance=0.2, strategy="spiral"),
        operation("finish", "outline", 2), part="", machine="heidenhain",
    ),
    "stated, ramps and less depth": scene(
        mill(1, 10), PLATE, FIXTURE,
        operation("rough", "outline", allowance=0.25, strategy="ramp", depth=4.5),
        operation("finish", "outline", depth=4.5), part="",
    ),
    "engraved": scene(
        mill(1, 1, "stepdown = 0.2"),
        mill(2, 0.5, "stepdown = 0.1\nstepover = 0.2\nplunges = true"),
        PLATE, FIXTURE, operation("engrave"), operation("engrave", "engraving 1", 2),
        part='bore = 8\nmark = { radius = 12, width = 1, length = 4, depth = 0.3, angle = 180 }\n'
        '[[part.engraving]]\ntext = "7"\nheight = 5\ndepth = 0.2\nradius = 12',
    ),
    "inches": scene(
        mill(1, 0.375, "stepdown = 0.1\nstepover = 0.1"), FIXTURE.replace("0.3", "0.01"),
        part="bore = 0.625", gcode="",
    )
    .replace("[cam]\n", '[units]\nlength = "inch"\n[cam]\n')
    .replace("base_radius = 25\nroller_radius = 8", "base_radius = 1\nroller_radius = 0.25")
    .replace("offset = 3", "offset = 0.1")
    .replace("to = 8", "to = 0.25").replace("thickness = 6", "thickness = 0.2")
    .replace("height = 15", "height = 0.5").replace("height = 4", "height = 0.1")
    .replace("flute_length = 14", "flute_length = 0.5").replace("feed = 500", "feed = 20")
    .replace("plunge_feed = 150", "plunge_feed = 6"),
}  # fmt: skip
"""Scenes by names that say what is special."""

CLAMPS: Final = (ROOT / "fixtures" / "milling" / "moved_clamps.toml").read_text("utf-8")


SIDES: Final = {
    "a second side, faced free": (second_side.FACED, {"about": "x"}),
    "a second side, cut from below": (
        second_side.FROM_BELOW,
        {"about": "y", "direction": "conventional", "compensation": 'compensation = "wear"'},
    ),
    "a second side, the other half": (second_side.HALVES, {"about": "x"}),
    "a second side, planned for what is left": (
        second_side.HALVES.partition("[[second_side.operation]]")[0].replace("bore = 18\n", "")
        + operation("bore", tool=4, allowance=0.3)
        + "\n"
        + operation("finish", "bore", 4)
        + "\n",
        {"about": "x"},
    ),
}
"""Scenes that are cut from both sides, of which the second is told of."""

ENGAGED: Final = ("planned, on a skin", "stated, a spiral from a plate")
"""Those of which the engagement is told; of the others it takes a second each."""

NAMES: Final = (*SCENES, "clamps that move", *SIDES)


@cache
def milled(name: str) -> MilledDisc:
    """The disc of a scene, or its second side."""
    if name in SIDES:
        tables, words = SIDES[name]
        found = Design(parse_scene(second_side.scene(tables, **words))).disc.milled.second
        assert found is not None
        return found
    return Design(parse_scene(SCENES.get(name, CLAMPS))).disc.milled


@cache
def toolpath(name: str) -> Toolpath:
    """Its program."""
    return milled(name).toolpath(TOLERANCE)


def document(name: str) -> dict[str, Any]:
    """All that is said of a program, in plain values."""
    disc, plan = milled(name), toolpath(name)
    assert disc.spec is not None
    stock, part, zero = disc.spec.stock, disc.part, disc.zero
    machine = load(disc.gcode.machine)
    runs = toolpath_runs(plan)
    cuts = tuple(operation.cut for operation in plan.operations)
    setup = simulation_setup(Side(part, disc.spec, cuts, runs), PART_FINENESS)
    if name in SIDES:  # it starts from what the first side leaves
        setup = job(disc, cuts, runs, TOLERANCE)[-1].setup
    limits = offset_limits(plan.operations)
    deepest: dict[int, list[float]] = {}
    for each in depths(setup, runs):
        before = deepest.get(each.run, [0.0, 0.0])
        deepest[each.run] = [max(before[0], each.ahead), max(before[1], each.engagement)]
    areas = any(isinstance(cut, AreaCut) for cut in cuts)
    plots = () if areas else plot_operations(plan, setup.blank, setup.top, 0.05)
    return {
        "zero": [zero.sentence, *spread(zero.place), zero.z],
        "blank": [described(stock, part, zero), zero.box(stock, part)],
        "told": disc.notes,
        "findings": [asdict(each) for each in disc.findings(plan, TOLERANCE)],
        "engaged": [
            {**asdict(each), "place": spread(each.place)}
            for each in (disc.engaged(plan) if name in ENGAGED else ())
        ],
        "times": [asdict(each) for each in machine_times(machine, plan, TOLERANCE) or ()],
        "operations": [
            {
                "cut": cut_of(operation.cut),
                "moves": moves_of(operation.moves),
                "programmed": moves_of(programmed(operation))
                if operation.name in limits else {},
                "most": limits[operation.name].most if operation.name in limits else None,
                "deepest": deepest.get(number),
            }
            for number, operation in enumerate(plan.operations)
        ],
        "plotted": [[plot.length(kind) for kind in KINDS] for plot in plots],
    }  # fmt: skip


def spread(place: complex) -> list[float]:
    return [place.real, place.imag]


def cut_of(cut: Cut) -> dict[str, Any]:
    """What is planned, its boundaries by their names and lengths."""
    found: dict[str, Any] = {"kind": type(cut).__name__, "tool": cut.tool.number}
    for key in ("name", "strategy", "top", "depths", "allowance", "climb", "stop", "note"):
        found[key] = getattr(cut, key)
    found["run"] = [cut.tool.feed, cut.tool.plunge_feed, cut.tool.spindle_speed, cut.tool.coolant]
    found["obstacles"] = [each.name for each in cut.obstacles]
    found["produced"] = cut.produced
    if isinstance(cut, ContourCut):
        for key in ("right", "left", "room", "rest", "cleared", "springs", "slack", "compensation"):
            found[key] = getattr(cut, key)
        found["contact"] = cut.contact_radius
        found["tabs"] = None if cut.tabs is None else asdict(cut.tabs)
        found["length"] = cut.centre.arcs(1e-3, "fast").contour.length
    elif isinstance(cut, AreaCut):
        found |= {"stepover": cut.stepover, "slot": cut.slot, "stock": cut.stock is not None}
        found["cleared"] = [each.name for each in cut.cleared]
    elif isinstance(cut, PointCut):
        found |= {"points": [spread(each) for each in cut.points], "sinking": cut.sinking}
    elif isinstance(cut, LineCut):
        found["ends"] = [*spread(cut.start), *spread(cut.end)]
    elif isinstance(cut, LetterCut):
        found["stepover"] = cut.stepover
    return found


def moves_of(moves: tuple[Move | Stop, ...]) -> dict[str, list[float]]:
    """Lengths of the moves of each kind, and their moments: with x, y, z and the feed."""
    found: dict[str, list[float]] = {}
    travel = [each for each in moves if not isinstance(each, Stop)]
    for before, move in pairwise(travel):
        at, end = complex(*before.end[:2]), complex(*move.end[:2])
        middle, way = 0.5 * (at + end), abs(end - at)
        name = "rapid" if isinstance(move, Rapid) else "line"
        if isinstance(move, ArcFeed):
            centre = complex(*move.centre)
            sweep = arc_sweep(at - centre, end - centre, ccw=move.ccw)
            way = abs(at - centre) * abs(sweep)
            middle, name = centre + (at - centre) * np.exp(0.5j * sweep), "arc"
        length = float(np.hypot(way, move.end[2] - before.end[2]))
        z, feed = 0.5 * (before.end[2] + move.end[2]), getattr(move, "feed", 0.0)
        switch = getattr(move, "switch", "")
        name += f", {switch}" if switch else ""
        row = np.array([1.0, middle.real, middle.imag, z, feed]) * length
        found[name] = (np.array(found.get(name, np.zeros(5))) + row).tolist()
    found["ends"] = [*travel[0].end, *travel[-1].end]
    return found
