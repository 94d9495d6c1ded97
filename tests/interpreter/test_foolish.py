"""Foolish and damaged programs: each is found out, with the line and the reason.

Each is one of the good programs with one change, or a good program as it is written for one scene,
run with the tools and the blank of another.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.lint import lint
from camgeo.app.cli.main import main
from camgeo.design.linting import LineFinding, WorkData
from camgeo.milling.machine import MEANINGS, load
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.controller import COMMON, MODAL_GROUPS
from camgeo_export.interpreter.moves import RULES, ProgramRun
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER
from tests.answers.documents import RING, UNHELD, document
from tests.interpreter.programs import GOOD
from tests.interpreter.programs import document as results_of
from tests.kept import compare_documents

CLEARANCE = 5.0


def linted(text: str, machine: str, radii: tuple[tuple[int, float], ...] = ()) -> ProgramRun:
    return run(text, load(machine), WorkData(clearance=CLEARANCE, radii=radii))


@dataclass(frozen=True)
class Change:
    """A change of a good program.

    `line` is what the line that is found says after it; empty for the whole program.
    """

    name: str
    machine: str
    old: str
    new: str
    rule: str
    line: str
    said: str = ""


LINUXCNC = (
    # dangers
    Change("feed turned rapid", "linuxcnc", "G1 Y-5.0", "G0 Y-5.0", "rapid-in-stock", "G0 Y-5.0"),
    Change("plunge at rapid", "linuxcnc", "G1 Z-3.0 F100", "G0 Z-3.0", "rapid-plunge", "G0 Z-3.0"),
    Change("across and down", "linuxcnc", "G0 X-20.0 Y0.0", "G0 X-20.0 Y0.0 Z1.0",
           "rapid-diagonal", "G0 X-20.0 Y0.0 Z1.0"),
    Change("across and down from above", "haas", "G0 X-20.0 Y0.0\n", "G0 X-20.0 Y0.0 Z1.0\n",
           "rapid-diagonal", "G0 X-20.0 Y0.0 Z1.0", "from above to Z 1 mm"),
    Change("across in the stock", "linuxcnc", "G1 X-20.0\nG0 Z5.0", "G0 X-20.0\nG0 Z5.0",
           "rapid-in-stock", "G0 X-20.0", "at Z -3 mm, below the top of the stock"),
    Change("across too low", "linuxcnc", "G0 Z5.0\nG0 X-20.0", "G0 Z2.0\nG0 X-20.0", "rapid-height",
           "G0 X-20.0 Y0.0"),
    Change("across before Z", "linuxcnc", "G0 Z5.0\nG0 X-20.0 Y0.0\n", "G0 X-20.0 Y0.0\nG0 Z5.0\n",
           "rapid-height", "G0 X-20.0 Y0.0", "unknown height"),
    Change("no feed", "linuxcnc", "G1 Z-3.0 F100", "G1 Z-3.0", "no-feed", "G1 Z-3.0"),
    Change("spindle never on", "linuxcnc", "S3000 M3", "S3000", "no-spindle", "G1 Z-3.0 F100"),
    Change("spindle without speed", "linuxcnc", "S3000 M3", "M3", "no-spindle", "M3"),
    Change("spindle off while cutting", "linuxcnc", "G1 Y-5.0", "M5\nG1 Y-5.0", "no-spindle",
           "G1 Y-5.0"),
    Change("spindle stopped in the cut", "linuxcnc", "G1 Y-5.0", "M5\nG1 Y-5.0", "low-stop", "M5"),
    Change("spindle the wrong way", "linuxcnc", "M3", "M4", "spindle-sense", "S3000 M4"),
    Change("coolant off while cutting", "linuxcnc", "G1 Y-5.0", "M9\nG1 Y-5.0", "coolant",
           "G1 Y-5.0"),
    Change("no tool", "linuxcnc", "T1 M6\n", "", "no-tool", "G1 Z-3.0 F100"),
    Change("no tool length", "linuxcnc", "G43 H1\n", "", "tool-length", "G0 Z5.0",
           "a traverse along Z before"),
    Change("no length of the second tool", "linuxcnc", "G0 Z5.0\nM9", "G0 Z5.0\nT2 M6\nS900 M3\n"
           "G1 X-19.0 F200\nG0 Z5.0\nM9", "tool-length", "G1 X-19.0 F200", "a cut without"),
    Change("length put out of force", "linuxcnc", "G1 Y-5.0", "G49\nG1 Y-5.0", "tool-length",
           "G1 Y-5.0"),
    Change("length of another tool", "linuxcnc", "G43 H1", "G43 H2", "tool-length", "G43 H2"),
    Change("tool change in the cut", "linuxcnc", "G1 Y-5.0", "T2 M6\nG43 H2\nS3000 M3\nG1 Y-5.0",
           "low-stop", "T2 M6"),
    Change("stop in the cut", "linuxcnc", "G1 Y-5.0", "M0\nG1 Y-5.0", "low-stop", "M0"),
    Change("feed of a traverse", "linuxcnc", "F300", "F30000", "feed", "G1 X-10.0 F30000"),
    # the path
    Change("no unit", "linuxcnc", "G21 ", "", "unit", "G0 Z5.0"),
    Change("two units", "linuxcnc", "G1 Y-5.0", "G20\nG1 Y-5.0", "unit-change", "G20"),
    Change("centre absolute", "linuxcnc", "I0.0 J-5.0", "I5.0 J5.0", "arc-radius",
           "G2 X10.0 Y5.0 I5.0 J5.0", "radii of the arc differ"),
    Change("nearly a full circle", "linuxcnc", "G2 X10.0 Y5.0", "G2 X4.9999 Y10.0", "full-circle",
           "G2 X4.9999 Y10.0 I0.0 J-5.0"),
    Change("half a turn by its radius", "linuxcnc", "G1 Y-5.0", "G2 Y-5.0 R5.0", "arc-form",
           "G2 Y-5.0 R5.0", "ill defined"),
    Change("centre and radius", "linuxcnc", "I0.0 J-5.0", "I0.0 J-5.0 R5.0", "no-arc",
           "G2 X10.0 Y5.0 I0.0 J-5.0 R5.0"),
    Change("arc without centre", "linuxcnc", " I0.0 J-5.0", "", "no-arc", "G2 X10.0 Y5.0"),
    Change("compensation in the middle of a cut", "linuxcnc", "G1 X-10.0 F300",
           "G1 G41 D1 X-17.5 F300\nG1 X-10.0", "compensation", "G1 G41 D1 X-17.5 F300",
           "not longer than the cutter's radius"),
    Change("arc after compensation", "linuxcnc", "G1 X-10.0 F300\nG1 Y5.0",
           "G1 G41 D1 X-10.0 F300\nG1 Y5.0\nG40", "compensation", "G2 X-5.0 Y10.0 I5.0 J0.0",
           "an arc right after"),
    Change("inner arc too small", "linuxcnc", "G1 X-10.0 F300", "G1 G42 D2 X-10.0 F300", "gouge",
           "G2 X-5.0 Y10.0 I5.0 J0.0", "not larger than that of the cutter"),
    # frame
    Change("no plane", "linuxcnc", "G17 ", "", "frame", "G1 Z-3.0 F100", "cut without G17"),
    Change("no distance mode", "linuxcnc", "G90 ", "", "frame", "G1 Z-3.0 F100", "without G90"),
    Change("no end", "linuxcnc", "M2\n", "", "no-end", "", "has no end"),
    Change("block after the end", "linuxcnc", "M2\n", "M2\nG0 X1\n", "after-end", "G0 X1"),
    Change("spindle on at the end", "linuxcnc", "M5\n", "", "left-on", "M2", "spindle"),
    # words
    Change("incremental left on", "linuxcnc", "G1 X-5.0\n", "G91\nG1 X-5.0\n", "arc-radius",
           "G2 X-10.0 Y-5.0 I0.0 J5.0"),
    Change("two motions", "linuxcnc", "G1 Y-5.0", "G0 G1 Y-5.0", "conflict", "G0 G1 Y-5.0"),
    Change("a word twice", "linuxcnc", "G1 Y-5.0", "G1 Y-5.0 Y5.0", "repeated-word",
           "G1 Y-5.0 Y5.0"),
    Change("letter O for zero", "linuxcnc", "G1 Y-5.0", "G1 YO", "unreadable", "G1 YO"),
    Change("comment in a comment", "linuxcnc", "M8", "M8 (flood (cold))", "comment",
           "M8 (flood (cold))"),
    Change("comment without end", "linuxcnc", "M8", "M8 (flood", "comment", "M8 (flood"),
    Change("parameter", "linuxcnc", "G1 Y-5.0", "G1 Y#1", "unsupported", "G1 Y#1"),
    Change("M5 in a cut", "linuxcnc", "G1 Y-5.0", "G1 Y-5.0 M5", "order", "G1 Y-5.0 M5"),
    Change("a word that nothing takes", "linuxcnc", "G1 Y-5.0", "G1 Y-5.0 R5.0", "unused-word",
           "G1 Y-5.0 R5.0"),
    Change("dwell in milliseconds", "linuxcnc", "G4 P2", "G4 P2000", "dwell", "G4 P2000", "2000 s"),
    Change("dwell without its time", "linuxcnc", "G4 P2", "G4", "missing-word", "G4"),
    Change("carriage return alone", "linuxcnc", "M8\n", "M8\rG1 X9.0\n", "line-end", "M8"),
    Change("line too long", "linuxcnc", "M8", "M8 (" + "x" * 260 + ")", "line-length",
           "M8 (" + "x" * 260 + ")"),
    Change("not ASCII", "linuxcnc", "M8", "M8 (k\xfchl)", "characters", "M8 (k\xfchl)"),
)  # fmt: skip

OTHERS = (
    Change("X10 is 10 um", "fanuc", "G1 X-10.0 F300", "G1 X-10 F300", "decimal-point",
           "G1 X-10 F300", "counts in 0.001 mm or 0.0001 inch; allowed: X-10.0"),
    Change("dwell in seconds", "fanuc", "G4 P2000", "G4 P2", "dwell", "G4 P2", "0.002 s"),
    Change("home by way of the part", "fanuc", "G0 Z5.0\nM9\nM5\nG91 G28 Z0.\nG90",
           "M9\nM5\nG90 G28 Z-5.0", "rapid-plunge", "G90 G28 Z-5.0"),
    Change("G91.1", "fanuc", "G17 G21", "G91.1 G17 G21", "unknown-word",
           "G91.1 G17 G21 G40 G49 G54 G80 G90 G94", "Fanuc has no G91.1"),
    Change("% too early", "fanuc", "M30\n%\n", "%\nM30\n", "no-end", "%"),
    Change("four decimals", "fanuc", "G1 Y-5.0", "G1 Y-5.0001", "decimals", "G1 Y-5.0001"),
    Change("X10 is 10 um", "haas", "I5.0 J0.0", "I5 J0.0", "decimal-point",
           "G2 X-5.0 Y10.0 I5 J0.0"),
    Change("F300 is 0.3 mm/min", "haas", "F300.", "F300", "decimal-point", "G1 X-10.0 F300",
           "0.3 a minute"),
    Change("F30 is 0.3 inch/min", "fanuc", "G17 G21", "G17 G20", "decimal-point",
           "G1 X-10.0 F300", "3 a minute"),
    Change("tool change", "grbl", "S3000 M3", "T1 M6\nS3000 M3", "unknown-word", "T1 M6",
           "Grbl has no M6"),
    Change("compensation", "grbl", "G1 X-10.0 F300", "G41 D1 G1 X-10.0 F300", "unknown-word",
           "G41 D1 G1 X-10.0 F300", "Grbl has no G41"),
    Change("percent", "grbl", "G17 G21", "%\nG17 G21", "unknown-word", "%"),
    Change("blending", "grbl", "G61", "G64 P0.01", "unknown-word", "G64 P0.01"),
    Change("long line", "grbl", "M8", "M8 S" + "0" * 80 + "1", "line-length",
           "M8 S" + "0" * 80 + "1"),
    Change("big number of a block", "grbl", "M8", "N10000001 M8", "line-number", "N10000001 M8"),
    Change("comment in brackets", "sinumerik", "M8", "M8 (flood)", "unknown-word", "M8 (flood)"),
    Change("zero shifted", "sinumerik", "G1 Y-5.0", "G58 X1\nG1 Y-5.0", "unsupported", "G58 X1"),
    Change("CYCLE832 of two", "sinumerik", "(0.005,1,1)", "(0.005,1)", "missing-word",
           "CYCLE832(0.005,1)"),
    Change("dwell of a feed", "sinumerik", "G4 F2", "G4 F200", "dwell", "G4 F200"),
    Change("no D", "sinumerik", "D1\n", "", "tool-length", "G0 Z5.0"),
    Change("no sense", "heidenhain", "X-5.0 Y+10.0 DR-", "X-5.0 Y+10.0", "arc-form",
           "18 C X-5.0 Y+10.0 R0", "without a direction"),
    Change("centre left out", "heidenhain", "20 CC X+5.0 Y+5.0\n", "", "arc-radius",
           "21 C X+10.0 Y+5.0 DR- R0"),
    Change("F AUTO of nothing", "heidenhain", "L Z-3.0 R0 F100", "L Z-3.0 R0 F AUTO",
           "missing-word", "14 L Z-3.0 R0 F AUTO", "without a feed F in TOOL CALL"),
    Change("FMAX down", "heidenhain", "L Z-3.0 R0 F100", "L Z-3.0 R0 FMAX", "rapid-plunge",
           "14 L Z-3.0 R0 FMAX"),
    Change("no tool", "heidenhain", "5 TOOL CALL 1 Z S3000\n", "", "no-tool", "14 L Z-3.0 R0 F100"),
    Change("no BEGIN PGM", "heidenhain", "0 BEGIN PGM SQUARE MM\n", "", "frame",
           "1 BLK FORM 0.1 Z X-12 Y-12 Z-5"),
    Change("a rounding", "heidenhain", "19 L X+5.0 R0\n", "19 L X+5.0 R0\nRND R2\n", "unsupported",
           "RND R2"),
    Change("G1 in klartext", "heidenhain", "22 L Y-5.0 R0", "22 G1 Y-5.0", "unreadable",
           "22 G1 Y-5.0"),
)  # fmt: skip


@pytest.mark.parametrize("machine", GOOD)
def test_the_good_ones_are_clean(machine: str) -> None:
    found = linted(GOOD[machine], machine)
    assert (found.findings, len([move for move in found.moves if move.kind == "arc"])) == ((), 4)
    (loop,) = found.loops()
    assert loop.contour.area == pytest.approx(-(20.0**2 - (4.0 - math.pi) * 5.0**2))


@pytest.mark.parametrize(
    "change", LINUXCNC + OTHERS, ids=lambda each: f"{each.machine}: {each.name}"
)
def test_each_is_found(change: Change) -> None:
    good = GOOD[change.machine]
    assert good.count(change.old) >= 1
    text = good.replace(change.old, change.new, 1)
    lines = text.splitlines()
    found = linted(text, change.machine, radii=((1, 3.0), (2, 6.0)))
    own = [each for each in found.findings if each.rule == change.rule]
    assert own, found.findings
    wanted = [k + 1 for k, line in enumerate(lines) if line == change.line] if change.line else [0]
    assert {each.line for each in own} & set(wanted), own
    assert any(change.said in str(each) for each in own)


@pytest.mark.parametrize(
    ("machine", "old", "new"),
    [
        # the length may be named before the tool is changed, and be put out of force for a retract
        ("linuxcnc", "T1 M6\nG43 H1\n", "G43 H1\nT1 M6\n"),
        ("fanuc", "M9\nM5\n", "M9\nG0 G49 Z200.\nM5\n"),
        # the number of a tool alone stops no spindle
        ("grbl", "S3000 M3", "S3000 M3\nT1"),
        # D1 holds for the next tool, too
        ("sinumerik", "SUPA G0 Z0 D0\nT1\nM6\nD1\n", "T2\nM6\nD1\nSUPA G0 Z0\nT1\nM6\n"),
    ],
)
def test_lengths_of_tools_that_are_right(machine: str, old: str, new: str) -> None:
    assert old in GOOD[machine]
    assert linted(GOOD[machine].replace(old, new), machine).findings == ()


def test_f_auto_is_the_feed_of_the_tool_call() -> None:
    text = GOOD["heidenhain"].replace("Z S3000", "Z S3000 F80").replace("R0 F300", "R0 F AUTO")
    found = linted(text, "heidenhain")
    assert found.findings == ()
    assert [move.feed for move in found.moves if move.kind != "rapid"][:2] == [100.0, 80.0]


def test_a_profile_says_how_far_an_arc_may_turn() -> None:
    machine = load("linuxcnc")
    strict = replace(machine, arcs=replace(machine.arcs, largest_sweep=80.0))
    found = run(GOOD["linuxcnc"], strict, WorkData(clearance=CLEARANCE)).findings
    assert ({each.rule for each in found}, len(found)) == ({"arc-sweep"}, 4)


def test_holes_of_a_cycle_are_no_traverses() -> None:
    """The cycle is found where it begins; coordinates alone run it again, until G80."""
    holes = (
        "G0 Z5.0\nG83 Q1.0 X1.0 Y1.0 Z-8.0 R1.0 F100.0\nX2.0\nY3.0\nG80\nX9.0\n"
        "G0 X9.0 Z5.0\nM9\nM5\nG91"
    )
    found = linted(GOOD["fanuc"].replace("G0 Z5.0\nM9\nM5\nG91", holes), "fanuc")
    assert [each.rule for each in found.findings] == ["unsupported", "no-motion"]


def test_further_work_offsets_of_a_sinumerik() -> None:
    found = linted(GOOD["sinumerik"].replace("G54", "G505"), "sinumerik")
    assert found.findings == ()
    assert {move.work_offset for move in found.moves if move.kind != "rapid"} == {"G505"}


@pytest.mark.parametrize("machine", GOOD)
@pytest.mark.parametrize("other", GOOD)
def test_a_program_in_the_other_dialect_is_found_once(machine: str, other: str) -> None:
    found = linted(GOOD[other], machine)
    if load(machine).dialect != load(other).dialect:
        (finding,) = found.findings
        assert finding.rule == "unreadable"
        assert "format, not" in finding.what or "not in conversational" in finding.what
        assert not found.complete
    else:
        assert not any("conversational" in each.what for each in found.findings)


@pytest.mark.parametrize("machine", ["linuxcnc", "mach3", "fanuc", "haas"])
def test_percent_may_stand_around_a_program(machine: str) -> None:
    text = GOOD[machine].strip("%\n")
    assert linted(f"%\n{text}\n%\n", machine).findings == ()


# Foolish for a blank, a part and tools ------------------------------------------------------------


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
            "tool 1 is not a tool of the scene"),
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
    return WRITER.write(camgeo.loads(scene).disc, 0.01).data.decode()


def worked(scene: str, code: str) -> tuple[LineFinding, ...]:
    return VERIFIER.worked(camgeo.loads(scene).disc, code.encode(), load("linuxcnc"))


@pytest.mark.parametrize("foolish", FOOLISH, ids=lambda each: each.name)
def test_each_is_found_with_its_scene(foolish: Foolish) -> None:
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


@pytest.mark.parametrize(("stepdown", "wrong"), [(2.4, True), (2.6, False)])
def test_slots_are_as_deep_as_they_are_programmed(stepdown: float, wrong: bool) -> None:
    """Passes of at most 3 mm: with a stepdown that is a little less, each is told."""
    scene = SETZHUB.replace("stepdown = 3", f"stepdown = {stepdown}")
    found = worked(scene, program(SETZHUB))
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


# Rules of the interpreter: named, described, and each found by some test --------------------------


ROOT = Path(__file__).parents[2]

PAGE = ROOT / "docs" / "lint.md"


def test_the_page_describes_every_rule_with_its_concern() -> None:
    said: dict[str, str] = {}
    for line in PAGE.read_text("utf-8").splitlines():
        if found := re.match(r"\| ((?:`[a-z-]+`(?:, )?)+) \| (\w+) \|", line):
            said |= dict.fromkeys(re.findall(r"`([a-z-]+)`", found[1]), found[2])
    assert said == dict(RULES)


def test_every_rule_is_used() -> None:
    folder = ROOT / "export" / "camgeo_export" / "interpreter"
    code = "".join(path.read_text("utf-8") for path in folder.glob("*.py") if path.stem != "rules")
    assert [rule for rule in RULES if f'"{rule}"' not in code] == []


def test_most_rules_are_broken_by_a_foolish_program() -> None:
    broken = {change.rule for change in LINUXCNC + OTHERS}
    assert RULES.keys() - broken <= {
        *("arc-sweep", "helix", "no-motion", "nothing", "number", "plane", "unknown-position"),
    }


def test_meanings_are_in_groups() -> None:
    assert set(COMMON.values()) <= MODAL_GROUPS.keys()
    assert (
        set(MEANINGS) - {"not read"} == MODAL_GROUPS.keys()
    )  # profiles name what the interpreter knows


# What running small programs says: findings, moves, events, by line and controller ----------------


@pytest.mark.parametrize("machine", GOOD)
def test_all_that_is_said_of_a_program_is_as_kept(machine: str) -> None:
    """Each block left out, some twice, and others put in, right and wrong ones."""
    found = results_of(machine)
    compare_documents(f"interpreter/{machine}", found)
    assert found[""]["findings"] == []
    told = [each for each in found.values() if isinstance(each, str) or each.get("findings")]
    assert len(told) > 0.4 * len(found)
