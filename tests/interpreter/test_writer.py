"""Programs of our writer for every profile: nothing is found in them, and they verify.

Writer and interpreter share the profile and no code, so each is a check of the other.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from camgeo.design.linting import Bench
from camgeo.milling.machine import load, names
from camgeo.milling.milling import GcodeSpec
from camgeo.units import LengthUnit
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER
from tests.export.stub_product import TOOL, StubProduct
from tests.interpreter.stated import TOLERANCE, failing

OTHER = replace(TOOL, number=7, diameter=4.0)


@pytest.mark.parametrize("unit", ["mm", "inch"])
@pytest.mark.parametrize("machine", names())
def test_programs_are_clean_and_verify(machine: str, unit: LengthUnit) -> None:
    spec = GcodeSpec(machine=machine, coolant="flood", spin_up=1.5)
    second = OTHER if load(machine).tool_change.change else None
    product = StubProduct(gcode=spec, second_tool=second, unit=unit)
    data = WRITER.write(product, TOLERANCE).data
    step = 25.4e-4
    found = run(data, load(machine), Bench(clearance=spec.clearance_height - step))
    assert found.findings == ()
    assert found.mm_per_unit == {"mm": 1.0, "inch": 25.4}[unit]
    assert {move.tool for move in found.moves if move.kind != "rapid"} == (
        {1, 7} if second else {1}
    )
    assert {move.coolant for move in found.moves if move.kind != "rapid"} == {"flood"}
    assert [event.seconds for event in found.events if event.kind == "dwell"] == [1.5, 1.5]
    origin = VERIFIER.origin(data)
    assert origin.version
    assert origin.tolerance is not None
    assert failing(product, data, origin.tolerance) == []
    assert WRITER.measure(product, data) <= origin.tolerance


@pytest.mark.parametrize("machine", names())
def test_only_coordinates_have_the_largest_of_coordinates(machine: str) -> None:
    """A router's spindle turns faster than Grbl's coordinates reach."""
    product = StubProduct(gcode=GcodeSpec(machine=machine), tool=replace(TOOL, spindle_speed=24e3))
    found = run(WRITER.write(product, TOLERANCE).data, load(machine))
    assert found.findings == ()
    far = {"klartext": "0 BEGIN PGM A MM\n1 L X+{} R0 FMAX\n", "iso": "G21 G90 G0 X{}\n"}
    profile = load(machine)
    ran = run(far[profile.dialect].format(f"{2.0 * profile.numbers.largest:.1f}"), profile)
    assert "number" in {each.rule for each in ran.findings}


@pytest.mark.parametrize("machine", ["linuxcnc", "fanuc", "sinumerik", "heidenhain"])
def test_what_is_said_at_a_stop_is_for_the_operator(machine: str) -> None:
    """It is no part of what a program states of itself."""
    profile, product = load(machine), StubProduct(gcode=GcodeSpec(machine=machine))
    data = WRITER.write(product, TOLERANCE).data
    text = profile.text
    note = f"{text.comment_open}move the clamp{text.comment_close}"
    if text.letters == "upper":
        note = note.upper()
    lines = data.decode().splitlines()
    place = next(k for k, line in enumerate(lines) if "operation outline" in line.lower())
    off, on = profile.spindle.off[0], profile.spindle.clockwise[0].format(speed="3000")
    halted = [*lines[:place], off, note, *profile.program.stop, on, *lines[place:]]
    assert failing(product, "\n".join(halted).encode()) == []
