"""The zero of a program: on the axis or a corner of the blank, on a face of part or blank."""

from __future__ import annotations

import cmath
import math
from typing import Final

import pytest

from camgeo.app.answers.answer import text as rendered
from camgeo.app.answers.setup import setup_sheet
from camgeo.design.design import Design
from camgeo.milling.machine import load, names
from camgeo.milling.milling import CORNERS, HEIGHTS
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.moves import Run
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER, bench_of
from tests.interpreter.stated import (
    CAM,
    TOLERANCE,
    failing,
    product_of,
    require_clean,
    written,
)
from tests.long_form import LONG

PLATE: Final = """[stock]
length = 80
width = 70
centre = [3, -2]
top = 1
bottom = 2
[holding]
kind = "clamps"
through = 0.3
[[holding.clamp]]
place = [38, 25]
length = 8
width = 12
height = 8
since = "rough bore"
[[holding.clamp]]
place = [0, 0]
length = 24
width = 24
height = 9
since = "rough outline"
"""

COARSE: Final = CAM.replace("stepover = 3", "stepover = 8")

PLACES: Final = {
    "axis": 0j,
    "front-left": -37 - 37j,
    "front-right": 43 - 37j,
    "back-left": -37 + 33j,
    "back-right": 43 + 33j,
}

LEVELS: Final = {"part-top": 0.0, "part-bottom": -6.0, "blank-top": 1.0, "blank-bottom": -8.0}

COMBINED: Final = [
    ("front-left", "blank-top"),
    ("back-right", "part-bottom"),
    ("axis", "blank-bottom"),
]


def scene(machine: str = "linuxcnc", zero: str = "axis", height: str = "part-top") -> str:
    return f'{COARSE}machine = "{machine}"\nzero = "{zero}"\nzero_height = "{height}"\n{PLATE}'


def read(text: str, machine: str) -> Run:
    return run(written(text), load(machine), bench_of(product_of(text), load(machine)))


def test_all_corners_and_faces_are_where_they_say() -> None:
    assert set(PLACES) == {"axis", *CORNERS}
    assert set(LEVELS) == set(HEIGHTS)
    for name, place in PLACES.items():
        for height, z in LEVELS.items():
            zero = product_of(scene(zero=name, height=height)).milled.zero
            assert (zero.place, zero.z) == (place, z)
            assert zero.of(place) == 0j


@pytest.mark.parametrize(
    ("machine", "zero", "height"),
    [
        (name, *COMBINED[k % len(COMBINED)])
        for k, name in enumerate(names() if LONG else ("linuxcnc", "heidenhain", "sinumerik"))
    ],
)
def test_programs_are_clean_and_verify(machine: str, zero: str, height: str) -> None:
    text = scene(machine, zero, height)
    require_clean(product_of(text), written(text))


@pytest.mark.parametrize("machine", ["linuxcnc", "heidenhain"])
def test_the_path_is_that_of_the_axis_moved(machine: str) -> None:
    """To rounding: both are printed with four decimals."""
    own = read(scene(machine), machine)
    moved = read(scene(machine, "front-left", "blank-top"), machine)
    place, z = PLACES["front-left"], LEVELS["blank-top"]
    pairs = list(zip(own.moves, moved.moves, strict=True))
    assert len(pairs) > 50
    for one, other in pairs:
        assert one.kind == other.kind
        for a, b in ((one.end, other.end), (one.start, other.start)):
            assert cmath.isnan(a) or abs(a - place - b) < 2e-4
        assert one.z_end == other.z_end == math.inf or abs(one.z_end - z - other.z_end) < 2e-4
        if one.kind == "arc":
            assert abs(one.centre - place - other.centre) < 4e-4


def test_a_program_for_another_zero_does_not_verify() -> None:
    own = product_of(scene(zero="front-left"))
    for other in (scene(zero="front-right"), scene(zero="front-left", height="blank-top")):
        assert failing(own, written(other))


def test_program_sheet_and_certificate_say_where_it_is() -> None:
    text = scene(zero="front-left", height="blank-top")
    disc = product_of(text)
    sentence = "X 0, Y 0 on the front left corner of the blank, Z 0 on the upper face of the blank"
    notes = " ".join(run(written(text), load("linuxcnc")).comments)
    assert f"unit mm, {sentence}" in notes
    assert "cam axis at X 37 Y 37, upper face of the finished disc at Z -1" in notes
    assert "operation bore depths -7.3000" in notes
    assert WRITER.write(disc, TOLERANCE).facts["zero"] == sentence
    sheet = setup_sheet(Design(disc.scene), TOLERANCE)
    assert sheet.zero == sentence
    assert sheet.steps[-1].lowest == pytest.approx(-7.3)
    shown = rendered(sheet)
    assert "its upper face at Z 0, its middle at X 40, Y 35" in shown
    assert "clamp at 75, 62 mm, top at Z 7" in shown


def test_the_blank_is_named_and_drawn_by_the_control() -> None:
    """In the program's coordinates; a blank whose outline is not known has no box."""
    lines = written(scene("heidenhain", "front-left", "blank-top")).decode().splitlines()
    assert lines[1:3] == [
        "1 BLK FORM 0.1 Z X+0.0000 Y+0.0000 Z-9.0000",
        "2 BLK FORM 0.2 X+80.0000 Y+70.0000 Z+0.0000",
    ]
    for machine in names() if LONG else ("linuxcnc", "heidenhain", "grbl", "fanuc"):
        notes = " ".join(run(written(scene(machine)), load(machine)).comments).lower()
        said = "plate, 80 x 70 mm, 9 mm high, its upper face at z 1"
        assert f"blank: {said}" in notes.replace("_", ":")
    text = f'{CAM}machine = "heidenhain"\n[holding]\nkind = "fixture"\nthrough = 0.3\n'
    unknown = written(text).decode()
    assert "BLK FORM" not in unknown
    assert "blank: plate of unstated size, 6 mm high" in unknown


def test_on_the_axis_and_the_finished_face_nothing_is_said_that_was_not() -> None:
    notes = run(written(scene()), load("linuxcnc")).comments
    assert "unit mm, Z 0 on the upper face, origin on the cam axis" in notes
    assert not any("cam axis at" in note for note in notes)


def test_a_corner_needs_a_blank_that_has_it() -> None:
    """Of a round one `tests.toolpath.wrongs` says so."""
    held = '[holding]\nkind = "fixture"\nthrough = 0.3\n'
    (fault,) = parse_scene(f'{CAM}zero = "front-left"\n{held}').lacking([WRITER.format])
    needed = '[stock] length and width of a plate, for output.gcode.zero = "front-left"'
    assert needed in fault.message


def test_a_program_is_run_in_the_blank_of_the_scene_from_its_zero() -> None:
    machine = load("linuxcnc")
    own, other = (scene(zero=zero, height="blank-top") for zero in ("front-left", "front-right"))
    assert VERIFIER.worked(product_of(own), written(own), machine) == ()
    assert VERIFIER.worked(product_of(other), written(own), machine)
