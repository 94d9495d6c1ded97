"""Programs that are foolish for a blank, a part and tools: each is found out, with line and reason.

Each is a good program, as it is written for one scene, run with the tools and the blank of another.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.lint import lint
from camgeo.app.cli.main import main
from camgeo.design.linting import LineFinding
from camgeo.milling.machine import load
from camgeo_export.gcode.writer import WRITER
from camgeo_export.verify.gcode import VERIFIER
from tests.answers.documents import RING, UNHELD, document

SETZHUB = (RING.parent / "setzhub.toml").read_text()

TOOL = "flute_length = 22"

CLAMPED = SETZHUB.replace('kind = "fixture"', 'kind = "clamps"').replace(
    "through = 0.5",
    "through = 0.5\nclamp = [{ place = [0, 25], length = 8, width = 8, height = 4 }]",
)


@dataclass(frozen=True)
class Foolish:
    """A program for one scene, run with another.

    `changes` are made in the program; `line` is what the line that is found begins with, and empty
    where the whole program is meant.
    """

    name: str
    written_for: str
    run_with: str
    rule: str
    said: str
    line: str = "G"
    changes: tuple[tuple[str, str], ...] = ()


FACED = "[stock]\ntop = 2\nlength = 150\nwidth = 150\n[holding]"
BORED = SETZHUB.replace("keyway = { width = 5, depth = 2.3 }", "").replace(
    "[holding]", "[stock]\nbore = 16\n[holding]"
)
STEEP = "stepdown = 13\nramp_angle = 30"
SHORT = "flute_length = 9"

FOOLISH = (
    Foolish("full depth in one slot", SETZHUB.replace("stepdown = 3", STEEP), SETZHUB,
            "slot-depth", "a slot deeper than the tool's stepdown"),
    Foolish("a loose core", RING.read_text(), UNHELD, "loose-piece", "nothing holds it"),
    Foolish("cutter too large", SETZHUB, SETZHUB.replace("diameter = 10", "diameter = 15"),
            "gouged-part", "the cutter goes"),
    Foolish("cutter larger than a hollow", BORED.replace("diameter = 10", "diameter = 53"),
            BORED.replace("diameter = 10", "diameter = 54"), "gouged-part",
            "its smallest concave radius is 26.85"),
    Foolish("edges too short", SETZHUB, SETZHUB.replace(TOOL, SHORT), "flute-length",
            ", 12.5 mm; allowed: 9 mm"),
    Foolish("holder in the part", SETZHUB, SETZHUB.replace(TOOL, f"{SHORT}\nstick_out = 10"),
            "holder", "deeper than the tool sticks out"),
    Foolish("shank in the wall", SETZHUB, SETZHUB.replace(TOOL, f"{SHORT}\nshank_diameter = 14"),
            "shank", "the shank is 3.5 mm deep in material"),
    Foolish("shank in a clamp", SETZHUB,
            CLAMPED.replace(TOOL, "flute_length = 13\nshank_diameter = 60"),
            "collision", "the shank goes"),
    Foolish("cutter in a clamp", SETZHUB, CLAMPED.replace("[0, 25]", "[-26, 42]"), "collision",
            "into the clamp at -26, 42 mm"),
    Foolish("another tool", SETZHUB, SETZHUB.replace("number = 1", "number = 3"), "unknown-tool",
            "tool 1 is none of the scene's"),
    Foolish("a plunge into the blank", SETZHUB, SETZHUB, "plunge", "which the tool must not",
            changes=((r"G1 Z0\.0000", "G1 Z-12.5000"),)),
    Foolish("a traverse through the blank", SETZHUB, SETZHUB, "rapid-in-material",
            "a traverse goes", changes=((r"G1 Z0\.0000 F100", "G0 Z-12.5000"),)),
    Foolish("below the part", SETZHUB, SETZHUB.replace("through = 0.5", "through = 0.2"),
            "too-low", "the tip goes 0.3 mm below Z -12.2"),
    Foolish("a blank that is higher", SETZHUB, SETZHUB.replace("[holding]", FACED), "rest",
            "material is left on the part", line=""),
)  # fmt: skip


@cache
def program(scene: str) -> str:
    product = camgeo.loads(scene).disc
    return WRITER.write(product, 0.01).data.decode()


def worked(scene: str, code: str) -> tuple[LineFinding, ...]:
    return VERIFIER.worked(camgeo.loads(scene).disc, code.encode(), load("linuxcnc"))


@pytest.mark.parametrize("foolish", FOOLISH, ids=lambda each: each.name)
def test_each_is_found(foolish: Foolish) -> None:
    code = program(foolish.written_for)
    for old, new in foolish.changes:
        assert re.search(old, code)
        code = re.sub(old, new, code)
    found = worked(foolish.run_with, code)
    own = [each for each in found if each.rule == foolish.rule]
    assert own, found
    assert any(foolish.said in str(each) for each in own), own
    lines = ["", *code.splitlines()]
    assert all(bool(each.line) == bool(foolish.line) for each in own), own
    assert all(lines[each.line].startswith(foolish.line) for each in own), own
    assert all(each.concerns == "work" for each in own)


@pytest.mark.parametrize("scene", [SETZHUB, RING.read_text()], ids=["setzhub", "ring"])
def test_nothing_is_found_in_a_good_program(scene: str) -> None:
    assert worked(scene, program(scene)) == ()


def test_slots_are_as_deep_as_they_are_programmed() -> None:
    """Passes of at most 3 mm: with a stepdown that is a little less, each is told."""
    code = program(SETZHUB)
    for stepdown, wrong in ((2.4, True), (2.6, False)):
        found = worked(SETZHUB.replace("stepdown = 3", f"stepdown = {stepdown}"), code)
        assert any(each.rule == "slot-depth" for each in found) == wrong, found


def test_the_command_line_names_the_scene(tmp_path: Path) -> None:
    path, scene = tmp_path / "a.ngc", tmp_path / "scene.toml"
    path.write_text(program(SETZHUB))
    scene.write_text(SETZHUB.replace(TOOL, "flute_length = 9"))
    words = ["lint", str(path), "--machine", "linuxcnc"]
    assert main([*words, "--stock-top", "0"]) == 0
    assert main([*words, "--scene", str(scene)]) == 1
    found = lint([path], "linuxcnc", design=camgeo.load(scene))
    assert "flute-length: " in text(found)
    (first, *_) = document(found)["programs"][0]["findings"]
    assert (first["rule"], first["concerns"]) == ("flute-length", "work")
    bare = tmp_path / "bare.toml"
    bare.write_text((RING.parent.parent / "effects" / "conjugate_lever.toml").read_text())
    assert main([*words, "--scene", str(bare)]) == 2
