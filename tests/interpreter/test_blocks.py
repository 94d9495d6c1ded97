"""Blocks of programs: those that manuals give as examples, those that reports call misread, and
texts of any words.
"""

from __future__ import annotations

import cmath
import math
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import FileError
from camgeo.milling.machine import load, names
from camgeo.numeric.arrays import phase
from camgeo_export.interpreter.moves import RULES, CutterMove, ProgramRun
from camgeo_export.interpreter.run import run
from tests.interpreter.programs import GOOD
from tests.long_form import examples

# Examples of manuals ------------------------------------------------------------------------------


INCH = 25.4


@dataclass(frozen=True)
class Way:
    """A move as a manual describes it, in the units of the example.

    Attributes
    ----------
    end : (x, y), and z if the manual says so.
    centre : of an arc.
    turned : by it, in degrees, counter-clockwise positive; None if the manual does not say how far.
    ccw : its sense, if the manual says only that.
    """

    end: tuple[float, ...]
    centre: complex | None = None
    turned: float | None = None
    ccw: bool | None = None


@dataclass(frozen=True)
class Example:
    """A piece of a program, its source, and the last moves that it makes."""

    machine: str
    source: str
    head: str
    text: str
    ways: tuple[Way, ...]
    scale: float = 1.0
    near: float = 1e-3


LINUXCNC_PAGES = "LinuxCNC at 5c41560, docs/src/gcode/g-code.adoc, "
NIST = "NISTIR 6556, The NIST RS274NGC Interpreter, Version 3, section "
GRBL = "gnea/grbl at bfb67f0, doc/markdown/"
ISO = "SINUMERIK ISO Milling (PGM), 04.07, page "
ONE = "Siemens, Sinumerik ONE, NC programming, 12/2019, 6FC5398-2EP40-0BA0, page "

EXAMPLES = (
    # LinuxCNC ----------------------------------------------------------------------------------
    Example("linuxcnc", LINUXCNC_PAGES + "G2 Example Line", "G21", "G0 X0 Y0\nG2 X1 Y1 I1 F10",
            (Way((0, 0)), Way((1, 1), 1 + 0j, -90.0))),
    Example("linuxcnc", LINUXCNC_PAGES + "G2-G3 Example Line", "G21",
            "G0 X0 Y0\nG2 X0 Y1 I1 J0.5 F25\nG3 X0 Y0 I1 J-0.5 F25",
            (Way((0, 0)), Way((0, 1), 1 + 0.5j, ccw=False), Way((0, 0), 1 + 0.5j, ccw=True))),
    Example("linuxcnc", LINUXCNC_PAGES + "G2 Example Helix, whose radii differ", "G21 F10",
            "G0 X0 Y0 Z0\nG17 G2 X10 Y16 I3 J4 Z-1",
            (Way((0, 0, 0)), Way((10, 16, -1), 3 + 4j, ccw=False))),
    Example("linuxcnc", LINUXCNC_PAGES + "P word Example", "G21",
            "G0 X0 Y0 Z0\nG2 X0 Y1 Z-1 I1 J0.5 P2 F25",
            (Way((0, 0, 0)),
             Way((0, 1, -1), 1 + 0.5j, -360.0 - 2 * math.degrees(math.atan(0.5))))),
    Example("linuxcnc", LINUXCNC_PAGES + "G1 Example", "G21 G0 X0 Y0 Z0",
            "G90\nG1 X1.2 Y-3 F10\nZ-2.3\nZ1 F25",
            (Way((1.2, -3, 0)), Way((1.2, -3, -2.3)), Way((1.2, -3, 1)))),
    # Grbl --------------------------------------------------------------------------------------
    Example("grbl", GRBL + "laser_mode.md, consecutive motion commands", "G21 G0 X0 Y0 Z0",
            "G1 X10 S100 F50\nG1 X0 S90\nG2 X0 I5 S80",
            (Way((10, 0)), Way((0, 0)), Way((0, 0), 5 + 0j, -360.0))),
    Example("grbl", GRBL + "jogging.md, the second of its examples, as a move", "G21 G90 G1 F50",
            "X10.0 Y-1.5\nG91 G20 X0.5", (Way((10, -1.5)), Way((22.7, -1.5)))),
    Example("grbl", NIST + "3.5.3.2", "G21 F10 G0 X7 Y7 Z9", "G17 G2 x 10 y 16 i 3 j 4 z 9",
            (Way((10, 16, 9), 10 + 11j, ccw=False),)),
    # Mach3 -------------------------------------------------------------------------------------
    Example("mach3", NIST + "3.5.3.2, circular", "G21 F10 G0 X7 Y7 Z9",
            "G17 G2 x 10 y 16 i 3 j 4 z 9", (Way((10, 16, 9), 10 + 11j, ccw=False),)),
    Example("mach3", NIST + "3.5.3.2, helical", "G21 F10 G0 X7 Y7 Z0",
            "G17 G2 x 10 y 16 i 3 j 4 z 9", (Way((10, 16, 9), 10 + 11j, ccw=False),)),
    Example("mach3", NIST + "3.5.3.1", "G21 F10 G0 X0 Y0 Z0", "G17 G2 x 10 y 15 r 20 z 5",
            (Way((10, 15, 5), None, ccw=False),)),
    # Fanuc -------------------------------------------------------------------------------------
    Example("fanuc", ISO + "2-26, linear interpolation", "G21 G90 G0 X0. Y0. Z0.",
            "G01 X40. Y40. Z40. F100", (Way((40, 40, 40)),)),
    Example("fanuc", ISO + "2-29, absolute", "G21 G90 G0 X55. Y20.",
            "G17 G90 G03 X15. Y40. I-30. J-10. F150", (Way((15, 40), 25 + 10j, 90.0),)),
    Example("fanuc", ISO + "2-29, incremental", "G21 G90 G0 X55. Y20.",
            "G17 G91 G03 X-40. Y20. I-30. J-10. F150", (Way((15, 40), 25 + 10j, 90.0),)),
    Example("fanuc", "SINUMERIK 802D Milling, ISO dialect M, 09.01, page 5-30, with decimal points",
            "G21 G17", "N5 G0 G90 X35. Y60.\nN10 G3 X50. Y45. I0 J-15. F500",
            (Way((35, 60)), Way((50, 45), 35 + 45j, 270.0))),
    Example("fanuc", "Fanuc 15i/150i-MA, B-63324EN, page 71: R takes precedence over I and J;"
            " the arc is that of page 2-29", "G21 G90 G0 X55. Y20. F150",
            "G03 X15. Y40. I-10. J3. R31.623", (Way((15, 40), 25 + 10j, 90.0),)),
    # Haas --------------------------------------------------------------------------------------
    Example("haas", "Advanced Haas Mill Programming Techniques, training manual, page 26",
            "G20",
            "T2 M06\nG00 G90 G54 X0. Y1.25 S5000 M03\nG43 H02 Z1. M08\nG01 Z-0.3 F50.\n"
            "G01 G41 D02 X-0.5 F50.\nG03 X0. Y0.75 R0.5 F50.\nG01 X1.94\nG02 X2. Y0.69 R0.06\n"
            "G01 Y-0.69\nG02 X1.94 Y-0.75 R0.06\nG01 X-1.94\nG02 X-2. Y-0.69 R0.06\nG01 Y0.69\n"
            "G02 X-1.94 Y0.75 R0.06\nG01 X0.\nG03 X0.5 Y1.25 R0.5\nG01 G40 X0.",
            (Way((0, 1.25, -0.3)), Way((-0.5, 1.25)), Way((0, 0.75), 0 + 1.25j, 90.0),
             Way((1.94, 0.75)), Way((2, 0.69), 1.94 + 0.69j, -90.0), Way((2, -0.69)),
             Way((1.94, -0.75), 1.94 - 0.69j, -90.0), Way((-1.94, -0.75)),
             Way((-2, -0.69), -1.94 - 0.69j, -90.0), Way((-2, 0.69)),
             Way((-1.94, 0.75), -1.94 + 0.69j, -90.0), Way((0, 0.75)),
             Way((0.5, 1.25), 0 + 1.25j, 90.0), Way((0, 1.25))), INCH),
    Example("haas", "Advanced Haas Mill Programming Techniques, training manual, page 24, before"
            " the cycle", "G20",
            "T1 M06\nG90 G54 G00 X1.0 Y1.0\nS1500 M03\nG43 Z0.1 H1 M08\nG1 Z0 F30.",
            (Way((1, 1)), Way((1, 1, 0.1)), Way((1, 1, 0))), INCH),
    Example("haas", "Haas operator's manual 96-8000, June 1999, page 248: contour of a pocket",
            "G17 G20 G90 G94 F20.\nG00 X-.2923 Y.3658",
            "G01 X-.469 Y1.2497\nG03 X-.5501 Y1.2967 R.0625\nG01 X-1.0804 Y1.12\n"
            "G03 X-1.12 Y1.0804 R.0625\nG01 X-1.2967 Y.5501\nG03 X-1.2497 Y.469 R.0625\n"
            "G01 X-.3658 Y.2923\nG03 X-.2923 Y.3658 R.0625",
            (Way((-0.469, 1.2497)), Way((-0.5501, 1.2967), ccw=True), Way((-1.0804, 1.12)),
             Way((-1.12, 1.0804), ccw=True), Way((-1.2967, 0.5501)),
             Way((-1.2497, 0.469), ccw=True), Way((-0.3658, 0.2923)),
             Way((-0.2923, 0.3658), ccw=True)), INCH),
    # Sinumerik ---------------------------------------------------------------------------------
    Example("sinumerik", ONE + "188", "G90 G710",
            "N10 G17 S400 M3\nN20 G0 X40 Y-6 Z2\nN30 G1 Z-3 F40\nN40 X12 Y-20\nN50 G0 Z100 M30",
            (Way((40, -6, 2)), Way((40, -6, -3)), Way((12, -20, -3)), Way((12, -20, 100)))),
    Example("sinumerik", ONE + "192 by radius, with the start, centre and angle of page 194",
            "G17 G90 G710", "N10 G0 X67.5 Y80.211\nN20 G3 X17.203 Y38.029 CR=34.913 F500",
            (Way((67.5, 80.211)), Way((17.203, 38.029), 50 + 50j, 140.134)), near=2e-3),
    Example("sinumerik", ONE + "194 by centre", "G17 G90 G710",
            "N10 G0 X67.5 Y80.211\nN20 G3 X17.203 Y38.029 I-17.5 J-30.211 F500",
            (Way((67.5, 80.211)), Way((17.203, 38.029), 50 + 50j, 140.134)), near=2e-3),
    Example("sinumerik", ONE + "194, its centre stated as AC", "G17 G90 G710",
            "N10 G0 X67.5 Y80.211\nN20 G3 X17.203 Y38.029 I=AC(50) J=AC(50) F500",
            (Way((67.5, 80.211)), Way((17.203, 38.029), 50 + 50j, 140.134)), near=2e-3),
    Example("sinumerik", "Siemens, Sinumerik 802D sl, operation and programming, nibbling, 06/2006,"
            " page 8-154", "G17 G71 G0 F100", "N5 G90 X30 Y40\nN10 G2 X50 Y40 I10 J-7",
            (Way((30, 40)), Way((50, 40), 40 + 33j, ccw=False))),
    # Heidenhain --------------------------------------------------------------------------------
    Example("heidenhain", "TNC 410 user's manual, page 79, full circle", "BEGIN PGM A MM",
            "5 CC X+25 Y+25\n6 L X+45 Y+25 RR F200 M3\n7 C X+45 Y+25 DR+",
            (Way((45, 25)), Way((45, 25), 25 + 25j, 360.0))),
    *(
        Example("heidenhain", f"iTNC 530 (340 49x-05) user's manual, page 207, arc {number}",
                "BEGIN PGM A MM",
                f"10 L X+40 Y+40 RL F200 M3\n11 CR X+70 Y+40 R{radius} DR{sense}",
                (Way((40, 40)),
                 Way((70, 40), 55 + 40j + up * 1j * math.sqrt(20.0**2 - 15.0**2), turned)))
        for number, radius, sense, up, turned in (
            (1, "+20", "-", -1, -2 * math.degrees(math.asin(0.75))),
            (2, "+20", "+", 1, 2 * math.degrees(math.asin(0.75))),
            (3, "-20", "-", 1, -360 + 2 * math.degrees(math.asin(0.75))),
            (4, "-20", "+", -1, 360 - 2 * math.degrees(math.asin(0.75))),
        )
    ),
    Example("heidenhain", "TNC 426/430 user's manual, page 153 (iTNC 530, page 249): LP and CTP",
            "BEGIN PGM A MM",
            "12 CC X+40 Y+35\n13 L X+0 Y+35 RL F250 M3\n14 LP PR+25 PA+120\n15 CTP PR+30 PA+30\n"
            "16 L Y+0",
            (Way((0, 35)), Way((40 - 12.5, 35 + 25 * math.sqrt(0.75))),
             Way((40 + 30 * math.sqrt(0.75), 50)), Way((40 + 30 * math.sqrt(0.75), 0)))),
)  # fmt: skip


def ends(example: Example) -> list[CutterMove]:
    text = f"{example.head}\n{example.text}\n"
    return list(run(text, load(example.machine)).moves)[-len(example.ways) :]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda each: f"{each.machine}: {each.source}")
def test_the_path_is_what_the_manual_says(example: Example) -> None:
    for way, move in zip(example.ways, ends(example), strict=True):
        at = (move.end.real, move.end.imag, move.z_end)
        for found, said in zip(at, way.end, strict=False):
            assert found == pytest.approx(said * example.scale, abs=1e-3)
        if way.centre is not None:
            assert move.kind == "arc"
            assert abs(move.centre - way.centre * example.scale) <= example.near
        if way.turned is not None:
            assert math.degrees(move.sweep) == pytest.approx(way.turned, abs=0.01)
        if way.ccw is not None:
            assert (move.sweep > 0.0) == way.ccw


def test_the_tangential_arc_leaves_without_a_kink() -> None:
    """The manual's note to CTP: its pole is not its centre."""
    (example,) = (each for each in EXAMPLES if "CTP" in each.source)
    line, arc = ends(example)[1:3]
    arm = (arc.start - arc.centre) * (1j if arc.sweep > 0.0 else -1j)
    assert phase(arm / (line.end - line.start)) == pytest.approx(0.0, abs=1e-9)
    assert abs(arc.centre - (40 + 35j)) > 1.0


def test_the_corners_of_the_pocket_are_round() -> None:
    """Its arcs join its lines without a kink, as far as four decimals of a corner of R.0625 go."""
    (example,) = (each for each in EXAMPLES if "pocket" in each.source)
    moves = ends(example)
    for before, arc, after in zip(moves[::2], moves[1::2], [*moves[2::2], moves[0]], strict=True):
        sense = 1j if arc.sweep > 0.0 else -1j
        for line, at in ((before, arc.start), (after, arc.end)):
            turned = phase((at - arc.centre) * sense / (line.end - line.start))
            assert abs(turned) <= 4.0 * 0.5e-4 / 0.0625


@pytest.mark.parametrize(
    ("machine", "unit", "word", "value", "found"),
    [
        # Fanuc B-63682EN/01, page 54, and SINUMERIK ISO Milling 04.07, page 1-13: X1000 is 1 mm.
        ("fanuc", "G21", "X1000", 1.0, True),
        ("fanuc", "G21", "X1000.0", 1000.0, False),
        # Haas, "Help with the decimal points", F12; SINUMERIK ISO Milling 04.07, page 1-13, F.
        ("haas", "G20", "F12", 0.0012 * INCH, True),
        ("haas", "G20", "F12.", 12 * INCH, False),
        ("haas", "G21", "F12", 0.012, True),
        ("fanuc", "G20", "F12", 0.12 * INCH, True),
        ("fanuc", "G21", "F12", 12.0, False),
        ("mach3", "G21", "F12", 12.0, False),
        # Haas 96-8000, June 1999, page 164; SINUMERIK ISO Milling 04.07, page 3-67, of P.
        ("haas", "G21", "P2000", 2.0, False),
        ("haas", "G21", "P2.", 2.0, False),
        ("haas", "G21", "P1.5", 1.5, False),
        ("fanuc", "G21", "P2000", 2.0, False),
        ("fanuc", "G21", "P2.", 0.002, True),
    ],
)
def test_a_number_with_and_without_a_point(
    machine: str, unit: str, word: str, value: float, found: bool
) -> None:
    """Coordinates, feeds and dwells [s]."""
    block = {"X": f"G1 {word} F100.", "F": f"G1 X1. {word}", "P": f"G4 {word}"}[word[0]]
    ran = run(f"G17 {unit} G90 G94 G0 X0. Y0. Z0.\n{block}\n", load(machine))
    dwells = [each.seconds for each in ran.events if each.kind == "dwell"]
    read = {"X": ran.moves[-1].end.real, "F": ran.moves[-1].feed, "P": sum(dwells)}[word[0]]
    assert read == pytest.approx(value, rel=1e-12)
    rules = {"number", "dwell"} if dwells else {"decimal-point"}
    assert found == bool(rules & {each.rule for each in ran.findings})


def test_every_controller_has_examples() -> None:
    assert min(Counter(each.machine for each in EXAMPLES).values()) >= 3


def test_a_block_means_the_same_each_time_it_is_there() -> None:
    """A dwell is at the line of each, and not a moment shorter."""
    lines = ["G21 G90 G94", *["G4 P2"] * 3, "M2"]
    ran = run("\n".join(lines), load("linuxcnc"))
    dwells = [(each.line, each.seconds) for each in ran.events if each.kind == "dwell"]
    assert dwells == [(2, 2.0), (3, 2.0), (4, 2.0)]


# Programs of public reports -----------------------------------------------------------------------


FOLDER: Final = Path(__file__).parents[2] / "fixtures" / "found" / "programs"

MACHINES: Final = {".ngc": "linuxcnc", ".nc": "grbl", ".h": "heidenhain", ".mpf": "sinumerik"}

RIGHT: Final = {
    "arc_two_turns.ngc": (),
    "long_comment.nc": (),
    "helix.h": (),
    "msg.mpf": (),
    "g94_again.ngc": ((10, "no-feed"),),
    "g94_in_cut.ngc": ((90, "no-feed"),),
    "F20.ngc": ((8, "order"), (10, "order"), (10, "feed")),
    "g0g28.ngc": ((8, "conflict"),),
    "G91G0G28.nc": ((7, "conflict"),),
    "X0Y0_modal.ngc": ((9, "no-motion"),),
    "G80G0.nc": ((7, "conflict"),),
    "g4x.ngc": ((8, "missing-word"),),
    "G4X.nc": ((7, "missing-word"),),
    "N_after.ngc": ((8, "line-number"),),
    "bom.ngc": ((1, "characters"),),
    "line254.ngc": ((7, "line-length"),),
    "arcfull_no_axis.nc": ((8, "no-arc"),),
    "helixZ.nc": ((8, "no-arc"),),
    "g43_under_comp.ngc": ((10, "compensation"),),
}
"""Findings, but that the unit changes, by the line that the control names."""


def test_all_of_them_are_here() -> None:
    assert {path.name for path in FOLDER.iterdir()} == RIGHT.keys()


@pytest.mark.parametrize("name", RIGHT)
def test_what_is_said_is_what_the_control_does(name: str) -> None:
    path = FOLDER / name
    found = run(path.read_bytes(), load(MACHINES[path.suffix])).findings
    said = {(each.line, each.rule) for each in found if each.rule != "unit-change"}
    assert said == set(RIGHT[name])


def feeds(name: str) -> list[float]:
    path = FOLDER / name
    moves = run(path.read_bytes(), load(MACHINES[path.suffix])).moves
    return [move.feed for move in moves if move.kind == "line"]


def test_f_counts_in_the_unit_before_where_the_control_reads_it_first() -> None:
    assert feeds("F20.ngc") == pytest.approx([10.0, 6350.0])
    text = (FOLDER / "F20.ngc").read_text().replace("T1 M6\nG43 H1\n", "")
    moves = run(text, load("grbl")).moves
    assert [move.feed for move in moves if move.kind == "line"] == pytest.approx([254.0, 250.0])


def test_a_corner_is_rounded_by_a_tangent_arc() -> None:
    """The radius about the centre, and right angles at both ends, of the corner at (10, 0)."""
    moves = run((FOLDER / "msg.mpf").read_bytes(), load("sinumerik")).moves
    before, arc, after = [move for move in moves if move.z_end == -1.0][1:4]
    ends = [before.end, arc.end, after.end, arc.centre]
    assert ends == pytest.approx([8 + 0j, 10 + 2j, 10 + 10j, 8 + 2j])
    assert arc.sweep == pytest.approx(math.pi / 2)
    text = (FOLDER / "msg.mpf").read_text().replace("RND=2", "RND=20")
    (told,) = run(text, load("sinumerik")).findings
    assert (told.line, told.rule) == (11, "unsupported")


def with_block(machine: str, block: str, mark: str = "G1 Y-5.0\n") -> ProgramRun:
    """The good program of a machine with a block before `mark`, in its middle."""
    good = GOOD[machine]
    assert mark in good
    return run(good.replace(mark, f"{block}\n{mark}", 1), load(machine))


PUT_IN: Final = (
    # what LinuxCNC's interpreter says of each, in brackets
    ("linuxcnc", "G4 F1", "missing-word"),  # Dwell time missing with g4
    ("linuxcnc", "%", "unknown-word"),  # Bad character '%' used
    ("linuxcnc", ":1000", "unreadable"),  # Bad character ':' used
    ("linuxcnc", "O1000", ""),
    ("linuxcnc", "G80 G1 X10.0", ""),
    ("linuxcnc", "G0 G1 X10.0", "conflict"),  # Two g codes used from same modal group
    ("linuxcnc", "G4 P1 G53 G0 Z9", "conflict"),
    ("linuxcnc", "M101", ""),  # of the machine's own
    ("linuxcnc", "M201", "unknown-word"),
    ("linuxcnc", "G1 X10.0 (" + "x" * 240 + ")", ""),
    ("linuxcnc", "G1 X10.0 (" + "x" * 242 + ")", "line-length"),  # Command too long
    ("linuxcnc", "G1 X10.0 (" + "x" * 240 + ")\r", ""),  # its end counts, too
    ("linuxcnc", "G1 X10.0 (" + "x" * 241 + ")\r", "line-length"),
    ("linuxcnc", "N10000001 G1 X10.0", ""),
    ("linuxcnc", "G2 I-3.0\nI-3.0", ""),
    ("linuxcnc", "G2 X10.02 Y5.0 I-3.0", ""),  # radii may differ by 0.0283 mm
    ("linuxcnc", "G2 X10.04 Y5.0 I-3.0", "arc-radius"),
    ("linuxcnc", "G2 X10.04 Y5.0 I-50.0", ""),  # or by 0.1 %
    ("linuxcnc", "G2 X9.0 Y5.0 R0.499\nG1 X10.0", ""),  # R may be too short by 0.00127 mm
    ("linuxcnc", "G2 X9.0 Y5.0 R0.498", "arc-radius"),
    ("linuxcnc", "G2 X10.0 Y5.0 I0.001", "no-arc"),  # Zero-radius arc
    ("linuxcnc", "G0 Z5.0\nG53 G1 Z9.0", ""),
    ("linuxcnc", "G53 G2 X9.0 I-3.0", "conflict"),  # Must use g0 or g1 with g53
    ("linuxcnc", "G91 G53 G0 X9.0", "conflict"),  # Cannot use g53 in incremental distance mode
    ("linuxcnc", "G53", "missing-word"),
    ("linuxcnc", "G41 D1 G1 X9.0\nG18", "compensation"),
    ("linuxcnc", "G41 D1 G1 X9.0\nG17\nG40 G1 X10.0", ""),
    ("linuxcnc", "G41 D1 G1 X9.0\nG81 X1 Y1 Z-4 R2", "compensation"),
    ("linuxcnc", "G81 X9.0 Z-5.0", "missing-word"),
    ("linuxcnc", "G81 X9.0 Z-5.0 R-6.0", "conflict"),
    ("linuxcnc", "G81 X9.0 Z-5.0 R1.0 L0", "number"),
    ("linuxcnc", "G81 X9.0 Z-5.0 R1.0 Q1.0", "unused-word"),
    ("linuxcnc", "G1 X9.0\rY5.0\nG1 X10.0", "line-end"),
    ("linuxcnc", "G1 X9.0\rG1 X10.0", "repeated-word"),
    ("linuxcnc", "G2 X10.0 Y5.0 R3.0 I1.0", "no-arc"),  # Mixed radius-ijk format for arc
    ("linuxcnc", "G2 I-3.0 J0.0", ""),
    ("linuxcnc", "G2 I-3.0 J0.0 P1.5", "number"),  # P value not an integer
    ("linuxcnc", "G41 D1 G1 X9.0\nG54", "compensation"),
    ("linuxcnc", "G 1 X 1 0 . 0", ""),
    ("grbl", "G1 X10.0 (open", ""),
    ("grbl", "G2 I-3.0 J0.0", "no-arc"),  # error 26
    ("grbl", "G2 X7.0 Y2.0 I-3.0 J0.0 R3.0", "no-arc"),  # error 36
    ("grbl", "N5 G1 X10.0", ""),
    ("grbl", "G1 X9.0\rG1 X10.0", ""),
    ("grbl", "G1 X10.0\nG53", ""),
    ("grbl", "G80 G28 Z2", "no-motion"),  # error 31
    ("linuxcnc", "G80 G28 Z2", ""),
    ("grbl", "G91\nG53 G1 Z9.0\nG90", ""),
    ("grbl", "G2 X10.006 Y5.0 I-3.0", "arc-radius"),
    ("grbl", "G2 X10.004 Y5.0 I-3.0", ""),
    ("grbl", "G1 N5 X10.0", ""),
    ("grbl", ":1000", "unreadable"),
    ("fanuc", "G1 N5 X10.0", ""),
    ("fanuc", ":1000", ""),
    ("fanuc", "G4 X1.0", ""),
    ("fanuc", "G81 X9.0 Y5.0 Z-4.0 R-2.0 K2\nG80\nG1 X10.0 Z-3.0", ""),
    ("fanuc", "G81 X9.0 Y5.0 Z-4.0 R-2.0 L2", "unused-word"),
    ("fanuc", "G1 X9.0\rG1 X10.0", "line-end"),
    ("fanuc", "G2 I-3.0 J0.0", ""),
    # Fanuc 16/18/160/180-C, machining centre, cncmanuals.com page 293: G02 and G03 cannot begin it.
    ("fanuc", "G41 D1 G3 X9.0 Y6.0 I-1.0 J0.0", "compensation"),
    ("fanuc", "G41 D1 G1 X9.0\nG40 G1 X10.0", ""),
    # SINUMERIK ISO Milling 04.07, page 2-30, and B-63324EN, page 71: a spiral would result.
    ("fanuc", "G1 X100.0 Y0.0\nG3 X-50.0 I-100.0", "arc-radius"),
    ("sinumerik", "TRANS", ""),
    ("sinumerik", "TRANS X10 Y5", "unsupported"),
    ("sinumerik", "STOPRE\nFFWON\nSOFT\nCFTCP\nG450\nG601", ""),
    ("sinumerik", "FOOBAR", "unknown-word"),
    ("sinumerik", "G1 X10.0 FRC=200", ""),
    ("sinumerik", "G1 X10.0 CHR=2", "unsupported"),
    ("sinumerik", "G1 X10.0 FOO=2", "unknown-word"),
)


WARNINGS: Final = {"rapid-in-stock", "rapid-height", "unknown-position", "frame", "arc-form"}
"""Rules that those of PUT_IN break that no control refuses."""


@pytest.mark.parametrize(("machine", "block", "rule"), PUT_IN)
def test_a_block_put_in(machine: str, block: str, rule: str) -> None:
    found = {each.rule for each in with_block(machine, block).findings}
    assert rule in found if rule else found <= WARNINGS


def test_what_takes_the_coordinates_of_its_block_moves_nothing() -> None:
    assert len(with_block("grbl", "G49 X3.0").moves) == len(with_block("grbl", "").moves)


@pytest.mark.parametrize(
    ("machine", "told"), [("grbl", []), ("linuxcnc", ["characters"]), ("fanuc", ["characters"])]
)
def test_a_byte_order_mark_is_told_where_it_is_read(machine: str, told: list[str]) -> None:
    found = run(b"\xef\xbb\xbf" + GOOD[machine].encode(), load(machine)).findings
    assert {each.rule for each in found} == set(told)


@pytest.mark.parametrize(
    ("machine", "old", "new"),
    [
        ("linuxcnc", "G2 X-5.0 Y10.0", "G3 X-5.0 Y10.0"),
        ("linuxcnc", "G2 X10.0 Y5.0 I0.0 J-5.0", "G2 X5.0 Y10.0 I0.0 J-5.0\nG2 X10.0 Y5.0 J-5.0"),
        ("sinumerik", "I0.0 J-5.0", "CR=-5.0"),
        ("heidenhain", "X-5.0 Y+10.0 DR-", "X-5.0 Y+10.0 DR+"),
    ],
)
def test_arcs_of_more_than_half_a_turn_are_arcs(machine: str, old: str, new: str) -> None:
    text = GOOD[machine].replace(old, new, 1)
    found = run(text, load(machine))
    assert found.findings == ()
    assert any(abs(move.sweep) > 1.4 * math.pi for move in found.moves)


@pytest.mark.parametrize("block", ["G1 X#1", "G68 R10.0", "G5 X1.0 Y2.0", "G1 A3.0"])
def test_behind_a_block_that_cannot_be_read_nobody_knows_where_the_tool_is(block: str) -> None:
    found = with_block("linuxcnc", block)
    lost = next(each for each in found.findings if each.rule == "unknown-position")
    assert found.findings[0].line == lost.line - 1
    move = next(move for move in found.moves if move.line == lost.line)
    assert cmath.isnan(move.start)
    assert math.isnan(move.z_start)


@pytest.mark.parametrize(
    ("machine", "block", "known"),
    [
        ("linuxcnc", "#1 = 2", True),
        ("sinumerik", "R1=5", True),
        ("heidenhain", "APPR LT X+4 Y+9 LEN5 R0", False),
        ("heidenhain", "CALL LBL 1", False),
        ("heidenhain", "L X+4 U+3", False),
        ("heidenhain", "LBL 1", True),
        ("heidenhain", "FN 0: Q1 = +3", True),
    ],
)
def test_parameters_and_labels_move_nothing(machine: str, block: str, known: bool) -> None:
    mark = "19 L X+5.0 R0\n" if machine == "heidenhain" else "G1 X5.0\n"
    found = with_block(machine, block, mark)
    assert ("unknown-position" in {each.rule for each in found.findings}) is not known
    assert "unsupported" in {each.rule for each in found.findings} or "U+3" in block


@pytest.mark.parametrize(("plane", "axes", "arms"), [("G18", "ZX", "KI"), ("G19", "YZ", "JK")])
@pytest.mark.parametrize("word", ["G2", "G3"])
def test_arcs_in_other_planes_are_run(plane: str, axes: str, arms: str, word: str) -> None:
    """A quarter about (2, 0) of the plane from its zero; G3 turns the first axis to the second."""
    sign = 1.0 if word == "G3" else -1.0
    text = (
        f"G21 G90 {plane} F100\nG0 X0 Y0 Z0\n"
        f"{word} {axes[0]}2 {axes[1]}{-2 * sign:g} {arms[0]}2 {arms[1]}0\nM2\n"
    )
    moves = [move for move in run(text, load("linuxcnc")).moves if move.line == 3]
    ends = [dict(zip("XYZ", (m.end.real, m.end.imag, m.z_end), strict=True)) for m in moves]
    places = [complex(end[axes[0]], end[axes[1]]) for end in ends]
    assert places[-1] == pytest.approx(2 - 2j * sign)
    assert max(abs(abs(place - 2) - 2) for place in places) < 1e-9
    length = sum(abs(b - a) for a, b in zip([0j, *places], places, strict=False))
    assert length == pytest.approx(math.pi, rel=1e-3)


def test_holes_are_the_moves_that_a_cycle_makes() -> None:
    """LinuxCNC, docs/src/gcode/g-code.adoc, G81 Example 2: G91 G81 G98 X4 Y5 Z-0.6 R1.8 L3."""
    text = "G21 F100 G98\nG0 X1 Y2 Z3\nG91 G81 G98 X4 Y5 Z-0.6 R1.8 L3\nM2\n"
    moves = [move for move in run(text, load("linuxcnc")).moves if move.line == 3]
    wanted: list[tuple[str, complex, float]] = [("rapid", 1 + 2j, 4.8)]
    for k in (1, 2, 3):
        place = complex(1 + 4 * k, 2 + 5 * k)
        wanted += [("rapid", place, 4.8), ("line", place, 4.2), ("rapid", place, 4.8)]
    assert [(m.kind, m.end, round(m.z_end, 9)) for m in moves] == wanted


@pytest.mark.parametrize("end", ["G18\nG2 Z5 K-3", "G18\nG3 Z5 K-3", "G19\nG3 Y-5 J3"])
@pytest.mark.parametrize("control", ["grbl", "linuxcnc"])
def test_an_arc_whose_ends_lie_on_one_side_of_its_centre_is_refused(control: str, end: str) -> None:
    """At other radii: it turns by nothing, or by a whole turn."""
    found = run(f"G21 G90 F100\nG0 X0 Y0 Z0\n{end}\nM2\n", load(control))
    assert "arc-radius" in {each.rule for each in found.findings}
    assert abs(complex(abs(found.moves[-1].end), found.moves[-1].z_end)) == 5.0


def test_a_program_makes_no_more_moves_than_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither by many turns nor by a large radius."""
    monkeypatch.setattr("camgeo_export.interpreter.motion.PROGRAM_MOVES", 5_000)
    head = "G21 G90 G18 F100\nG0 X0 Y0 Z0\n"
    arcs = head + "G2 Z0 X0 K1 P1000\n"
    with pytest.raises(FileError, match="more than 5,000 moves"):
        run(arcs, load("linuxcnc"))
    moves = run(head + "G2 Z0 X0 K900000000\nM2\n", load("linuxcnc")).moves
    assert 1000 < len(moves) < 5000


@pytest.mark.parametrize(
    "between", ["N85 G0 Z10\n", "N86 SUPA G0 Z0\n", "N87 G18 G2 X12 Z-1 CR=1\n"]
)
def test_a_rounding_is_of_the_next_move_alone(between: str) -> None:
    text = (FOLDER / "msg.mpf").read_text()
    found = run(text.replace("N90 G1 Y10\n", f"{between}N90 G17 G1 Y10\n"), load("sinumerik"))
    assert not any(move.kind == "arc" for move in found.moves)


# Any text -----------------------------------------------------------------------------------------


WORDS = (
    *("G0", "G1", "G2", "G3", "G4", "G10", "G17", "G18", "G20", "G21", "G28", "G40", "G41", "G42"),
    *("G41.1", "G43", "G43.1", "G49", "G53", "G54", "G61", "G64", "G80", "G81", "G90", "G90.1"),
    *("G91", "G91.1", "G93", "G94", "G95", "G99.9", "M0", "M2", "M3", "M5", "M6", "M8", "M30"),
    *("X1", "Y-2.5", "Z3.", "X0", "Y0", "Z0", "I1", "J-1", "K1", "R5", "R-1", "R0", "P2", "Q0"),
    *("F100", "F0", "S1000", "T1", "T99999", "H1", "D1", "D.5", "N10", "O1", "E1", "L2", "A9"),
    *("(", ")", "(a)", ";", "%", "/", "#1", "[1+1]", "X=AC(5)", "I=IC(2)", "CR=7", "TURN=2"),
    *("CYCLE832(0.01,1,1)", "CYCLE832()", "SUPA", "MSG(1)", "T=\"A\"", "L", "LP", "CC", "C", "CP"),
    *("CR", "CT", "CTP", "X+1", "IX-3", "PR+5", "PA+30", "IPA-400", "DR+", "DR-", "R+5", "RL"),
    *("RR", "R0", "FMAX", "M91", "BEGIN PGM A MM", "END PGM A MM", "TOOL CALL 1 Z S9", "STOP"),
    *("CYCL DEF 32.1 T0.1", "CYCL DEF 9.1 DWELL 1", "CYCL DEF 247 Q339=+1", "RND R2", "1e9", "--1"),
    *("X1.7976931348623157e308", "Y999999999", "\x00", "\xe4", "X" + "9" * 70, ""),
)  # fmt: skip


def check(found: ProgramRun, text: str) -> None:
    lines = len(re.split(r"\r\n|\r|\n", text))
    for each in found.findings:
        assert 0 <= each.line <= lines
        assert each.concerns == RULES[each.rule]
        assert str(each).isprintable() or each.rule in ("unreadable", "unsupported")
    found.loops()


@pytest.mark.parametrize("machine", names())
@given(st.lists(st.lists(st.sampled_from(WORDS), max_size=6), max_size=25))
def test_words_in_any_order(machine: str, blocks: list[list[str]]) -> None:
    text = "\n".join(" ".join(block) for block in blocks)
    check(run(text, load(machine)), text)


@pytest.mark.parametrize("machine", names())
@pytest.mark.parametrize("seed", range(examples(4, long=400)))
def test_good_programs_that_are_damaged(machine: str, seed: int) -> None:
    rng = Random(seed)
    text = GOOD[machine]
    for _ in range(rng.choice((1, 3, 10))):
        at = rng.randrange(len(text) + 1)
        to = min(at + rng.choice((0, 1, 5, 40)), len(text))
        text = text[:at] + rng.choice(("", " ", rng.choice(WORDS), text[at:to] * 2)) + text[to:]
    check(run(text, load(machine)), text)
