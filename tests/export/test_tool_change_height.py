"""Where tools are changed: at the machine's reference, or at a height that the scene states."""

from __future__ import annotations

from dataclasses import replace

import pytest

import camgeo
from camgeo.errors import GeometryError
from camgeo.milling.machine import load, names
from camgeo.milling.milling import GcodeSpec
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.run import Run, run
from tests.export.stub_product import StubProduct
from tests.export.test_programs_for_each_tool import scene
from tests.export.test_verify_simulated import SECOND

AWAY = 60.0

HEIGHTS = [name for name in names() if load(name).retract.is_a_height]


def written(machine: str, away: float | None) -> str:
    gcode = GcodeSpec(machine=machine, tool_change_height=away)
    # Grbl changes no tools: then one tool does all.
    second = SECOND if load(machine).tool_change.change else None
    product = StubProduct(second_tool=second) if second else StubProduct()
    return WRITER.write(replace(product, gcode=gcode), 0.01).data.decode()


def ran(machine: str, away: float | None) -> Run:
    return run(written(machine, away), load(machine))


def test_some_machines_retract_to_a_height_and_some_do_not() -> None:
    assert {"linuxcnc", "mach3", "grbl"} <= set(HEIGHTS) < set(names())


@pytest.mark.parametrize("machine", HEIGHTS)
@pytest.mark.parametrize("away", [None, AWAY])
def test_tools_are_changed_and_programs_end_there(machine: str, away: float | None) -> None:
    """Reached along Z alone, with the length of the old tool in force."""
    found = ran(machine, away)
    assert found.findings == ()
    changes = [each for each in found.events if each.kind == "tool change"][1:]
    assert bool(changes) == (machine != "grbl")
    assert all(each.z == (away or 5.0) for each in changes)
    assert found.moves[-1].z_end == (away or 5.0)
    up = [move for move in found.moves if move.z_end == AWAY]
    assert all(move.start == move.end and move.kind == "rapid" for move in up)


@pytest.mark.parametrize("machine", [name for name in names() if name not in HEIGHTS])
def test_others_go_to_their_reference_all_the_same(machine: str) -> None:
    assert written(machine, AWAY) == written(machine, None)


def test_it_is_not_below_the_clearance_height() -> None:
    with pytest.raises(GeometryError, match="tool_change_height") as caught:
        GcodeSpec(clearance_height=20.0, tool_change_height=10.0)
    assert caught.value.key == "output.gcode.tool_change_height"


@pytest.mark.parametrize(
    ("machine", "stated", "told"),
    [("linuxcnc", False, True), ("linuxcnc", True, False), ("haas", False, False),
     ("grbl", False, False)],
)  # fmt: skip
def test_a_change_close_above_the_part_is_told(machine: str, stated: bool, told: bool) -> None:
    own = scene(machine)
    if stated:
        own = own.replace(f'"{machine}"', f'"{machine}"\ntool_change_height = 60')
    milled = camgeo.loads(own).disc.milled
    found = milled.findings(milled.toolpath(0.01), 0.01)
    low = [each for each in found if each.name == "tool-change-height"]
    assert [each.severity for each in low] == (["warning"] if told else [])
