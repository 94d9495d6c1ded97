"""Planned programs simulated: sound ones, and ones for another blank or another holding."""

from __future__ import annotations

import math
import random
import re
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import pytest
import shapely

import camgeo
from camgeo.app.answers.check import check
from camgeo.cam.cam import Contact
from camgeo.check.finding import Finding
from camgeo.design.milled import MilledDisc
from camgeo.milling.judged import Side, simulation_setup, toolpath_runs
from camgeo.milling.machine import load
from camgeo.milling.milling import Clamp, Holding, MillingSpec, OperationSpec, Stock, Tabs
from camgeo.milling.moves import Stop, Toolpath
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.simulation import Setup, Simulation, simulate
from camgeo.part.part import Part
from tests.draws.jobs import Job, Told, drawn, misses, polygons, read, swept
from tests.toolpath.milled import FIXTURE, HEIGHTS, part, sequence, tool
from tests.toolpath.test_simulation import flaws_of

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

TOLERANCE = 0.001


def program(name: str) -> tuple[Toolpath, Part, MillingSpec]:
    design = camgeo.load(SCENES / f"{name}.toml")
    assert design.scene.milling is not None
    return design.disc.milled.toolpath(0.01), design.disc.drawn.part, design.scene.milling


def judged(name: str, stock: Stock | None = None, holding: Holding | None = None) -> Simulation:
    """With what the scene states unless another blank or holding is given."""
    toolpath, made, spec = program(name)
    return simulate(
        started(toolpath, made, stock or spec.stock, holding or spec.holding),
        toolpath_runs(toolpath),
    )


def started(toolpath: Toolpath, part: Part, stock: Stock, holding: Holding | None) -> Setup:
    cuts = tuple(operation.cut for operation in toolpath.operations)
    spec = MillingSpec(tools=(), stock=stock, holding=holding)
    return simulation_setup(Side(part, spec, cuts, toolpath_runs(toolpath)), TOLERANCE)


def test_a_sound_program() -> None:
    found = judged("setzhub")
    (loose,) = found.flaws  # the frame, which the fixture must hold
    assert (loose.name, loose.watched, loose.unit, loose.value) == ("loose", True, "pieces", 1.0)
    # In the lowest slab the part stands within its slot.
    (low, *_), target = found.stages[-1].slabs, found.part[0]
    assert low.material.intersection(target).area == pytest.approx(target.area, rel=2e-4)


def test_both_parts_of_a_blank_come_loose_on_which_no_clamp_is_ever_set() -> None:
    """The program was planned for a fixture, and sets none."""
    clamp = Clamp(place=80.0 + 80.0j, length=20.0, width=20.0, height=10.0)
    plate = Stock(length=200.0, width=200.0)
    held = Holding(kind="clamps", through=2.0, clamps=(clamp,))
    frame, part = flaws_of(judged("setzhub", plate, held), "loose")
    assert "waste of 200 x 200 mm" in frame.sentence
    assert "the part of" in part.sentence


def test_the_depth_that_the_holding_allows() -> None:
    (deep, *_) = judged("setzhub", holding=Holding(kind="fixture")).flaws
    assert deep.name == "depth"
    assert deep.limit == -12.0


def test_what_is_joined_below_is_no_rest() -> None:
    toolpath, part, _ = program("setzhub")
    low = part.layers[0].z0
    tabs = Holding(kind="tabs", through=1.0, tabs=Tabs(4, 6.0, 2.0))
    setup = started(toolpath, part, Stock(), tabs)
    assert setup.joined == pytest.approx(low + 2.0)
    skin = Holding(kind="onion-skin", skin=0.3)
    assert started(toolpath, part, Stock(), skin).joined == pytest.approx(low + 0.3)
    fixture = Holding(kind="fixture", through=1.0)
    thick = started(toolpath, part, Stock(top=1.0, bottom=3.0), fixture)
    assert (thick.top, thick.bottom, thick.joined) == (1.0, low - 3.0, low)
    # What is to be faced off is left.
    (rest,) = flaws_of(simulate(thick, toolpath_runs(toolpath)), "rest")
    assert rest.place[2] == 0.0


@pytest.mark.parametrize("boundary", ["outline", "bore"])
def test_a_chamfer_is_part_of_the_part(boundary: str) -> None:
    """On its own: too deep a one is a gouge as deep as the cone is wider there."""
    pointed = tool(8.0, kind="chamfer-mill", tip_angle=0.5 * math.pi)
    chamfer = OperationSpec(kind="chamfer", boundary=boundary, tool=1, size=0.4)
    cuts = sequence(Contact.INNER, pointed, operations=(chamfer,)).cuts
    toolpath = plan_toolpath(cuts, HEIGHTS, load("linuxcnc").arcs, 0.01, "fast")
    milled, blank = part(Contact.INNER), Stock(bore=2.0 * 12.5)
    setup = started(toolpath, milled, blank, FIXTURE)
    (run,) = toolpath_runs(toolpath)
    assert simulate(setup, [run]).flaws == ()
    deeper = tuple(
        replace(move, end=(*move.end[:2], move.end[2] - 0.15))
        for move in run.moves
        if not isinstance(move, Stop)
    )
    (gouge,) = flaws_of(simulate(setup, [replace(run, moves=deeper)]), "gouge")
    assert gouge.value == pytest.approx(0.15, abs=0.02)
    # One that is not cut at all is left where it would be widest.
    higher = replace(run, moves=run.moves[:1])
    (rest,) = simulate(setup, [higher]).flaws
    assert (rest.name, rest.watched) == ("rest", False)
    assert 0.3 < rest.value < 0.4 + 0.02


# -- verdict ---------------------------------------------------------------------------------------
# The verdict on programs: what must not be run, and what is to be watched.


ROUGH = '\n[[operation]]\nkind = "rough"\nboundary = "outline"\ntool = 1\nallowance = 0.4\n'
FINISH = '\n[[operation]]\nkind = "finish"\nboundary = "outline"\ntool = 1\n'
STEPS = "stepdown = 3\nstepover = 4\nramp_angle = 10"

BORE = """
[[operation]]
kind = "rough"
boundary = "bore"
tool = 1
[[operation]]
kind = "finish"
boundary = "bore"
tool = 1
"""


def findings(text: str) -> tuple[Finding, ...]:
    design = camgeo.loads(text)
    milled = design.disc.milled
    return milled.findings(milled.toolpath(0.01), 0.01)


def setzhub(operations: str) -> str:
    """Held below a frame, which comes loose, and is to be watched."""
    return (SCENES / "setzhub.toml").read_text() + operations


def test_a_rest_that_operations_mean_to_leave_is_to_be_watched() -> None:
    left, keyway, loose, rest = findings(setzhub(BORE + ROUGH))
    assert [keyway.name, left.name, loose.name] == ["keyway", "unlike-the-part", "loose-core"]
    assert left.sentence == "outline: rough outline; 0.4 mm are left on it"
    assert {keyway.severity, left.severity, loose.severity} == {"warning"}
    assert (rest.name, rest.severity) == ("rest", "warning")
    assert rest.value is not None
    assert rest.value > 0.39


def test_operations_that_finish_all_walls_leave_nothing() -> None:
    names = [each.name for each in findings(setzhub(BORE + ROUGH + FINISH))]
    assert names == ["keyway", "loose-core"]


def test_a_planned_program_must_leave_no_rest() -> None:
    """The blank is higher than the sequence, made without it, takes down."""
    design = camgeo.loads(setzhub(""))
    milled, spec = design.disc.milled, design.scene.milling
    toolpath = milled.toolpath(0.01)
    assert spec is not None
    thick = camgeo.loads(setzhub("").replace("[holding]", "[stock]\ntop = 1\n[holding]"))
    (rest,) = (each for each in thick.disc.milled.flaws(toolpath, 0.01) if each.name == "rest")
    assert not rest.watched


def test_tabs_hold_the_part_in_a_round_blank() -> None:
    """A spiral would clear away the frame that they hold on to."""
    tabs = 'kind = "tabs"\ncount = 4\nwidth = 5\nheight = 1.5\n'
    text = setzhub("").replace('kind = "fixture"\n', tabs).replace("stepdown = 3", STEPS)
    blank = '[stock]\nshape = "round"\ndiameter = 140\n[holding]'
    found = findings(text.replace("[holding]", blank))
    assert not any(each.severity == "broken" for each in found), found


def test_finishes_with_tabs_begin_in_the_slot() -> None:
    """Where its path begins, between two arcs, neither of which says where the slot runs."""
    tabs = 'kind = "tabs"\ncount = 4\nwidth = 5\nheight = 1.5\n'
    text = setzhub(ROUGH.replace("0.4", "1.4") + FINISH)
    text = text.replace('kind = "fixture"\n', tabs).replace("stepdown = 3", STEPS)
    found = findings(text)
    assert not any(each.severity == "broken" for each in found), found


# -- jobs ------------------------------------------------------------------------------------------
# What is told of jobs, against independent sweeps of their programs.


FRAME = (Path(__file__).parents[2] / "fixtures" / "found" / "loose_frame.toml").read_text("utf-8")

PLATE = "length = 150\nwidth = 150"

STEEL = 7.85e-6
"""Density [kg/mm^3]."""


def job(number: int) -> Job:
    """One of those that a fixed seed draws."""
    source = random.Random(39)
    return [drawn(source) for _ in range(number + 1)][number]


@pytest.mark.parametrize("number", [5, 9, 31])
def test_a_sweep_of_the_program_finds_the_same(number: int) -> None:
    """A gouge with a rest; pieces and a rest; waste on a fixture."""
    found = misses(job(number))
    assert found is not None
    ours, different = found
    assert different == []
    assert ours != Told()


@pytest.mark.parametrize(
    ("blank", "outline"),
    [
        (PLATE, shapely.box(-75.0, -75.0, 75.0, 75.0)),
        ('shape = "round"\ndiameter = 170', shapely.Point(0.0, 0.0).buffer(85.0, 256)),
        ('shape = "round"\ndiameter = 130', shapely.Point(0.0, 0.0).buffer(65.0, 256)),
    ],
)
def test_waste_that_nothing_holds_comes_loose(
    blank: str, outline: shapely.Polygon, tmp_path: Path
) -> None:
    """A frame, a ring, a crescent: what the slot leaves of the blank beside the part."""
    text = FRAME.replace(PLATE, blank)
    with patch.object(MilledDisc, "safe", lambda *_: ()):  # it must not be run
        camgeo.loads(text).write(tmp_path, ["gcode"])
    (rough, *_) = read((tmp_path / "steel120.ngc").read_text())
    left = outline - swept(rough.moves, -11.99, 6.0)
    middle = shapely.Point(20.0, 0.0)  # of the part, beside its bore
    (waste,) = (each for each in polygons(left) if not each.contains(middle))
    found = check(camgeo.loads(text))
    assert found.machining is not None
    (loose,) = (each for each in found.machining.findings if each.name == "loose")
    assert (loose.severity, found.exit_code) == ("broken", 1)
    assert loose.value == pytest.approx(12.0 * waste.area, rel=1e-3)
    mass = re.search(r"mm\^3, ([\d.]+) kg", loose.sentence)
    assert mass is not None
    assert float(mass[1]) == pytest.approx(STEEL * 12.0 * waste.area, rel=6e-3)  # three digits
    assert "nothing holds it at X " in loose.sentence


@pytest.mark.parametrize(
    ("stated", "operation"),
    [("", ""), ('until = "outline"\n', "outline"), ('since = "outline"\n', "rough outline")],
)
def test_a_screw_holds_while_it_is_there(stated: str, operation: str) -> None:
    """On a corner of the frame; where it comes too late, or goes too early, that comes loose."""
    screw = f"[[holding.screw]]\nplace = [68, 68]\nhead_diameter = 10\nheight = 8\n{stated}"
    found = check(camgeo.loads(FRAME.replace("[[tool]]", f"{screw}[[tool]]", 1))).machining
    assert found is not None
    told = [each.sentence for each in found.findings if each.name == "loose"]
    assert [each.partition(":")[0] for each in told] == [operation] * bool(operation)
