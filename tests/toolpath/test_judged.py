"""Planned programs simulated: sound ones, and ones for another blank or another holding."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

import camgeo
from camgeo.cam.cam import Contact
from camgeo.milling.holding import Clamp, Holding, Tabs
from camgeo.milling.judged import Side, runs_of, setup_of
from camgeo.milling.machine import load
from camgeo.milling.milling import MillingSpec, OperationSpec, Stock
from camgeo.milling.moves import Stop, Toolpath
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.simulation import Simulation, simulate
from camgeo.milling.stages import Setup
from camgeo.part.part import Part
from tests.toolpath.milled import FIXTURE, HEIGHTS, part, sequence, tool

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
        started(toolpath, made, stock or spec.stock, holding or spec.holding), runs_of(toolpath)
    )


def started(toolpath: Toolpath, part: Part, stock: Stock, holding: Holding | None) -> Setup:
    cuts = tuple(operation.cut for operation in toolpath.operations)
    spec = MillingSpec(tools=(), stock=stock, holding=holding)
    return setup_of(Side(part, spec, cuts, runs_of(toolpath)), TOLERANCE)


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
    frame, part = judged("setzhub", plate, held).of("loose")
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
    (rest,) = simulate(thick, runs_of(toolpath)).of("rest")
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
    (run,) = runs_of(toolpath)
    assert simulate(setup, [run]).flaws == ()
    deeper = tuple(
        replace(move, end=(*move.end[:2], move.end[2] - 0.15))
        for move in run.moves
        if not isinstance(move, Stop)
    )
    (gouge,) = simulate(setup, [replace(run, moves=deeper)]).of("gouge")
    assert gouge.value == pytest.approx(0.15, abs=0.02)
    # One that is not cut at all is left where it would be widest.
    higher = replace(run, moves=run.moves[:1])
    (rest,) = simulate(setup, [higher]).flaws
    assert (rest.name, rest.watched) == ("rest", False)
    assert 0.3 < rest.value < 0.4 + 0.02
