"""Blocks that manuals of the controllers give as examples, and the path that they say results.

They were retyped as facts from the pages named; what such a piece lacks for a program, a position
to begin with or a feed, stands before it. So the interpreter does not only understand our writer.

What is missing: of Fanuc's own chapter on arcs no page with an example could be had, so its
examples are those of Siemens' manuals of the ISO dialect, which follows Fanuc; of Mach3's manual no
page at all, so for it, as for Grbl beside its own pages, there are the examples of the language
that it implements (NISTIR 6556, "The NIST RS274NGC Interpreter, Version 3").
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import pytest

from camgeo.milling.machine import load
from camgeo.numeric.arrays import phase
from camgeo_export.interpreter.moves import CutterMove
from camgeo_export.interpreter.run import run

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


LINUXCNC = "LinuxCNC at 5c41560, docs/src/gcode/g-code.adoc, "
NIST = "NISTIR 6556, The NIST RS274NGC Interpreter, Version 3, section "
GRBL = "gnea/grbl at bfb67f0, doc/markdown/"
ISO = "SINUMERIK ISO Milling (PGM), 04.07, page "
ONE = "Siemens, Sinumerik ONE, NC programming, 12/2019, 6FC5398-2EP40-0BA0, page "

EXAMPLES = (
    # LinuxCNC ----------------------------------------------------------------------------------
    Example("linuxcnc", LINUXCNC + "G2 Example Line", "G21", "G0 X0 Y0\nG2 X1 Y1 I1 F10",
            (Way((0, 0)), Way((1, 1), 1 + 0j, -90.0))),
    Example("linuxcnc", LINUXCNC + "G2-G3 Example Line", "G21",
            "G0 X0 Y0\nG2 X0 Y1 I1 J0.5 F25\nG3 X0 Y0 I1 J-0.5 F25",
            (Way((0, 0)), Way((0, 1), 1 + 0.5j, ccw=False), Way((0, 0), 1 + 0.5j, ccw=True))),
    Example("linuxcnc", LINUXCNC + "G2 Example Helix, whose radii differ", "G21 F10",
            "G0 X0 Y0 Z0\nG17 G2 X10 Y16 I3 J4 Z-1",
            (Way((0, 0, 0)), Way((10, 16, -1), 3 + 4j, ccw=False))),
    Example("linuxcnc", LINUXCNC + "P word Example", "G21",
            "G0 X0 Y0 Z0\nG2 X0 Y1 Z-1 I1 J0.5 P2 F25",
            (Way((0, 0, 0)),
             Way((0, 1, -1), 1 + 0.5j, -360.0 - 2 * math.degrees(math.atan(0.5))))),
    Example("linuxcnc", LINUXCNC + "G1 Example", "G21 G0 X0 Y0 Z0",
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
