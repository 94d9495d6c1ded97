"""Programs as they are written, simulated: sound ones, and ones changed on purpose."""

from __future__ import annotations

import re

import pytest

from camgeo.design.verify import Check
from camgeo.milling.machine import load
from camgeo.milling.milling import GcodeSpec
from camgeo.milling.moves import ArcFeed, Feed
from camgeo.milling.simulation import Run
from camgeo.units import LengthUnit
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import simulation_checks, traced
from tests.export.stub_product import SECOND_TOOL, StubProduct
from tests.export.verified import TOLERANCE


def text_of(product: StubProduct) -> str:
    return WRITER.write(product, TOLERANCE).data.decode()


def checks(product: StubProduct, text: str) -> list[Check]:
    program = run(text, load(product.gcode.machine))
    return simulation_checks(product, program, TOLERANCE)


PRODUCT = StubProduct(second_tool=SECOND_TOOL)

PROGRAM = text_of(PRODUCT)


def runs_in(text: str) -> list[Run]:
    program = run(text, load("linuxcnc"))
    return [each.run for each in traced(PRODUCT, program, PRODUCT.milled.cuts)]


@pytest.mark.parametrize("machine", ["linuxcnc", "haas", "grbl", "heidenhain"])
@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_a_sound_program(machine: str, unit: LengthUnit) -> None:
    """Also where Z is printed in thousandths of an inch, and goes to the machine's reference."""
    product = StubProduct(gcode=GcodeSpec(machine=machine), unit=unit)
    (check,) = checks(product, text_of(product))
    assert (check.value, check.ok) == ("2 operations", True)


def test_moves_are_those_of_the_program() -> None:
    bore, outline = runs_in(PROGRAM)
    assert (bore.name, bore.radius) == ("bore", 3.0)
    assert (outline.name, outline.radius) == ("outline", 4.0)
    planned = PRODUCT.toolpath(TOLERANCE).operations[0].moves
    kinds = [type(move) for move in bore.moves]
    assert kinds.count(ArcFeed) == sum(isinstance(move, ArcFeed) for move in planned)
    assert kinds.count(Feed) == sum(isinstance(move, Feed) for move in planned)
    assert bore.start == (4.2, -2.8, 5.0)  # where the first traverse that says all of it ends


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        # The outline is cut with the smaller tool, on the path of the larger one.
        ("T2 M6", "T1 M6", "outline: material is left on the part, up to 1.01 mm thick"),
        # 1 mm along X through the whole of the outline.
        ("(operation outline)", "(operation outline)\nG52 X1", "outline: the cutter goes"),
        ("G1 Z-8.0000 F80", "G0 Z-8.0000", "outline: a traverse goes 4 mm deep into material"),
        ("G1 Z-8.0000 F80", "G1 Z-7.0000 F80", "material is left on the part, up to"),
    ],
)
def test_a_program_that_is_changed(old: str, new: str, sentence: str) -> None:
    text = PROGRAM
    if new.endswith("G52 X1"):
        head, tail = text.split(old)
        new = old
        tail = re.sub(r"X(-?[\d.]+)", lambda found: f"X{float(found[1]) + 1.0:.4f}", tail)
        text = f"{head}{old}{tail}"
    assert old in text
    found = checks(PRODUCT, text.replace(old, new))
    assert [check for check in found if check.ok is not False] == []
    assert any(sentence in check.note for check in found), [check.note for check in found]


FOREIGN = """G17 G21 G40 G49 G54 G80 G90 G94 G91.1
T{tool} M6
G43 H{tool}
S3000 M3
G0 Z5
G0 X0 Y-5
G1 Z-8 F100
G0 Z5
G0 X35 Y-5
G1 Z-8
G2 X35 Y-5 I-35 J0
G0 Z5
G28
G0 Z5
G0 X7 Y0
G1 Z-8
G3 X7 Y0 I-7 J0
G0 Z5
M5
M2
"""


def test_a_program_of_someone_else() -> None:
    """Whole circles, no comments, and after a traverse home a place that nobody has stated."""
    (sound,) = checks(PRODUCT, FOREIGN.format(tool=1))
    assert sound.ok
    assert sound.value == "1 operation"  # in two parts
    (drilled,) = checks(PRODUCT, FOREIGN.format(tool=1).replace("X0 Y-5", "X0 Y-12"))
    assert "tool 1: the cutter goes 5 mm into the part" in drilled.note
    runs = runs_in(FOREIGN.format(tool=1))
    assert [each.name for each in runs] == ["tool 1", "tool 1"]
    assert sum(isinstance(move, ArcFeed) for each in runs for move in each.moves) == 4


def test_a_tool_that_the_scene_does_not_have() -> None:
    (check,) = checks(PRODUCT, FOREIGN.format(tool=7))
    assert check.ok is False
    assert check.note == "line 7: tool 7 is none of the scene's"


def test_a_path_that_the_control_computes() -> None:
    text = FOREIGN.format(tool=1).replace("G1 Z-8\nG2", "G41 D1\nG1 Z-8\nG2")
    (check,) = checks(PRODUCT, text)
    assert check.ok is None
    assert "control" in check.note
