"""Programs that tests of the interpreter run: good ones, those of scenes that state their milling,
and all that running small ones says.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any, Final

from camgeo.design.design import Design
from camgeo.design.linting import WorkData
from camgeo.design.product import Product
from camgeo.design.verify import Check, ReadingOptions
from camgeo.errors import FileError
from camgeo.milling.machine import load
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.moves import Event, ProgramRun
from camgeo_export.interpreter.run import LINTER, run
from camgeo_export.verify.gcode import VERIFIER, program_bench

# Good programs ------------------------------------------------------------------------------------


ISO: Final = """\
G17 G21 G40 G49 G54 G80 G90 G94
G91.1
G61
T1 M6
G43 H1
S3000 M3
M8
G4 P2
G0 Z5.0
G0 X-20.0 Y0.0
G1 Z-3.0 F100
G1 X-10.0 F300
G1 Y5.0
G2 X-5.0 Y10.0 I5.0 J0.0
G1 X5.0
G2 X10.0 Y5.0 I0.0 J-5.0
G1 Y-5.0
G2 X5.0 Y-10.0 I-5.0 J0.0
G1 X-5.0
G2 X-10.0 Y-5.0 I0.0 J5.0
G1 Y0.0
G1 X-20.0
G0 Z5.0
M9
M5
M2
"""

FRAMED: Final = (
    ISO.replace("G91.1\nG61\n", "")
    .replace("G43 H1\n", "")
    .replace("G4 P2", "G4 P2000")
    .replace("G0 Z5.0\nG0 X-20.0 Y0.0\n", "G0 X-20.0 Y0.0\nG0 G43 Z5.0 H1\n")
    .replace("G0 Z5.0\nM9\nM5\nM2\n", "G0 Z5.0\nM9\nM5\n@\nM30\n%\n")
)

GOOD: Final = {
    "linuxcnc": ISO,
    "mach3": ISO.replace("M2\n", "M30\n"),
    "grbl": ISO.replace("T1 M6\nG43 H1\n", ""),
    "fanuc": "%\nO1001\nG91 G28 Z0.\nG90\n" + FRAMED.replace("@", "G91 G28 Z0.\nG90"),
    "haas": "%\nO01001\nG0 G53 Z0.\n"
    + FRAMED.replace("@", "G0 G53 Z0.").replace("F100", "F100.").replace("F300", "F300."),
    "sinumerik": (
        ISO.replace("G17 G21 G40 G49 G54 G80 G90 G94", "G17 G710 G40 G90 G94\nG54")
        .replace("G91.1\nG61\nT1 M6\nG43 H1\n", "SUPA G0 Z0 D0\nT1\nM6\nD1\nCYCLE832(0.005,1,1)\n")
        .replace("G4 P2", "G4 F2")
        .replace("G0 Z5.0\nG0 X-20.0 Y0.0\n", "G0 X-20.0 Y0.0\nG0 Z5.0\n")
        .replace("M2\n", "CYCLE832()\nM30\n")
    ),
    "heidenhain": """\
0 BEGIN PGM SQUARE MM
1 BLK FORM 0.1 Z X-12 Y-12 Z-5
2 BLK FORM 0.2 X+12 Y+12 Z+0
3 CYCL DEF 247 DATUM SETTING Q339=+1
4 L Z+0 R0 FMAX M91
5 TOOL CALL 1 Z S3000
6 CYCL DEF 32.0 TOLERANCE
7 CYCL DEF 32.1 T0.005
8 M3
9 M8
10 CYCL DEF 9.0 DWELL TIME
11 CYCL DEF 9.1 DWELL 2
12 L X-20.0 Y+0.0 R0 FMAX
13 L Z+5.0 R0 FMAX
14 L Z-3.0 R0 F100
15 L X-10.0 R0 F300
16 L Y+5.0 R0
17 CC X-5.0 Y+5.0
18 C X-5.0 Y+10.0 DR- R0
19 L X+5.0 R0
20 CC X+5.0 Y+5.0
21 C X+10.0 Y+5.0 DR- R0
22 L Y-5.0 R0
23 CC X+5.0 Y-5.0
24 C X+5.0 Y-10.0 DR- R0
25 L X-5.0 R0
26 CC X-5.0 Y-5.0
27 C X-10.0 Y-5.0 DR- R0
28 L Y+0.0 R0
29 L X-20.0 R0
30 L Z+5.0 R0 FMAX
31 M9
32 M5
33 L Z+0 R0 FMAX M91
34 M30
35 END PGM SQUARE MM
""",
}


# Scenes that state blank, holding and tools, and what must hold for programs of ours --------------


TOLERANCE: Final = 0.02

CAM: Final = """camgeo = 1
name = "stated"
[cam]
rotation = "cw"
[follower]
kind = "translating-roller"
base_radius = 25
roller_radius = 8
[[motion]]
law = "polynomial-345"
span = 180
to = 8
[[motion]]
law = "polynomial-345"
span = 180
to = 0
[part]
thickness = 6
bore = 18
[[tool]]
number = 4
diameter = 10
flute_length = 12
spindle_speed = 3000
feed = 500
plunge_feed = 150
stepdown = 3
stepover = 3
ramp_angle = 3
coolant = "flood"
[output]
formats = ["gcode"]
[output.gcode]
clearance_height = 15
retract_height = 3
"""

SCREWED: Final = """[stock]
shape = "round"
diameter = 70
top = 1
bottom = 0
[holding]
kind = "screws"
through = 0.5
[[holding.screw]]
place = [0, 0]
head_diameter = 24
height = 8
since = "rough outline"
"""

TABBED: Final = """[holding]
kind = "tabs"
through = 0.3
count = 3
width = 5
height = 1.5
"""

SKINNED: Final = """[stock]
length = 80
width = 70
[holding]
kind = "onion-skin"
thickness = 0.2
"""


@cache
def product_of(text: str) -> Product:
    """The first disc of a scene."""
    return Design(parse_scene(text)).discs[0]


@cache
def written(text: str) -> bytes:
    """Its program."""
    return WRITER.write(product_of(text), TOLERANCE).data


def failing(product: Product, data: bytes, tolerance: float = TOLERANCE) -> list[Check]:
    """The checks that fail on a program, as of one of ours."""
    checks = VERIFIER.checks(product, data, ReadingOptions("a.nc"), tolerance)
    return [check for check in checks if check.ok is False]


def require_clean(product: Product, data: bytes) -> ProgramRun:
    """That nothing is found in a program, and it measures and verifies."""
    profile = load(product.milled.gcode.machine)
    found = run(data, profile, program_bench(product, profile))
    assert found.findings == ()
    assert WRITER.measure(product, data) <= TOLERANCE
    assert failing(product, data) == []
    return found


# Small programs with one block changed, and all that running them says ----------------------------


BENCH: Final = WorkData(clearance=4.0, radii=((1, 1.5), (2, 6.0)))

MARK: Final = "G1 X5.0\n"
"""Before this block of a cut, or the same in conversational words, others are put in."""

CONVERSATIONAL_MARK: Final = "19 L X+5.0 R0\n"

PUT_IN: Final = (
    "G2 X5.0 Y10.0 R5.0", "G2 X5.0 Y10.0 R-6.0", "G3 X5.0 Y10.0 R5.0", "G2 X5.0 Y10.0 R4.9",
    "G2 I2.0 J1.0", "G3 X-5.0 Y10.0 I3.0 J0.0", "G2 X1.0 Y10.0 I3.0 J0.0 Z-2.5",
    "G2 X1.0 Y10.0 I2.9 J0.0", "G2 X1.0 Y10.0 I3.0 J-0.02", "G2 X1.0 Y10.0 I3.0 K1.0",
    "G91\nG1 X1.0\nG2 X2.0 Y0.0 I1.0 J0.0\nG90", "G90.1\nG2 X1.0 Y10.0 I-2.0 J10.0\nG91.1",
    "G18\nG2 X1.0 Z-2.0 I3.0 K0.5\nG17", "G20\nG1 X0.1\nG21", "G93\nG1 X1.0 F10\nG94",
    "G95\nG1 X1.0 F0.1\nG94", "G53 G0 Z0.0", "G28", "G91 G28 Z0.\nG90", "G30 X0.0", "G4 P1.5",
    "G4 P0.001", "G4 P100", "G4 X2.0", "G54", "G55\nG1 X1.0", "G59.1", "G61.1", "G64",
    "G64 P0.01", "G64 P0.01 Q0.02", "G187 P3 E0.01", "CYCLE832(0.01,1,1)", "G41 D1\nG1 X0.0",
    "G42 D2\nG1 X0.0\nG40", "G41\nG1 X0.0", "G43 H2", "G49", "G43.1 Z1.0", "T2", "T2 M6", "M3",
    "M4", "S500", "S0", "M5", "M7", "M8\nM9", "M0", "M1", "M30", "M19", "M98 P1000",
    "G81 X0.0 Y0.0 Z-4.0 R1.0", "G92 X0.0", "G52 X1.0", "G10 L2 P1 X0.0", "G68 R10.0",
    "G0 X1.0 Y1.0 Z1.0", "G0 X9.0", "G1 X9.0 F0", "G1 X9.0 F99999", "G1 X9.0 A3.0",
    "G1 X9.0 X8.0", "G1 X9.0 Y", "G1 X1e3", "G1 X--1", "G1 X123456789", "X9.5", "Y9.0 Z-3.5",
    "N20 G1 X9.0", "G01 X+09.00", "g1 x9.0", "G 1 X 9 . 0", "/ G1 X9.0", "(text) G1 X9.0 ; more",
    "(text", "#1 = 2", "O100", "%", "G1.5 X1.0", "G1 X9.12345", "G1 Z-9.0", "G1 Z20.0",
)  # fmt: skip
"""Blocks of all kinds, right ones and wrong ones, for controllers with G words."""

CONVERSATIONAL: Final = (
    "L X+4 Y+9 R0 F200", "L IX+1 IY-1", "L X+4 FMAX", "L Z-9 F100", "L X+4 R+5", "L X+4 RL",
    "L X+4 RR F100", "LP PR+3 PA+10", "CC X+0 Y+0\nLP PR+12 PA+90", "CC X+0 Y+10\nC X+5 Y+10 DR-",
    "CC X+0 Y+10\nC X+5 Y+10 DR+", "CC X+0 Y+10\nCP IPA+180 DR+", "CC IX+2 IY+0\nC X+0 Y+10 DR+",
    "CC X+0 Y+10\nCP PA+45 DR- Z-2", "CR X+4 Y+9 R+5 DR-", "CR X+4 Y+9 R-5 DR+",
    "CR X+4 Y+9 R+1 DR-", "CT X+4 Y+9", "CTP PR+2 PA+3", "C X+4 Y+9 DR-", "C X+4 Y+9", "STOP",
    "STOP M5", "M0", "M3", "M4", "M5", "M8", "M9", "M30", "M91", "TOOL CALL 2 Z S500",
    "TOOL CALL 2 Z S500 DR+0.1", "TOOL CALL Z", "TOOL CALL 2 X", "TOOL DEF 3",
    "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 200",
    "CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.02", "CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1",
    "CYCL DEF 247 DATUM SETTING Q339=+2", "CYCL DEF 7.0 DATUM", "CALL LBL 1", "LBL 1", "Q1 = 3",
    "FN 0: Q1 = +3", "L X+4 F AUTO", "L X+4 F0", "L X+4 M3 M8", "L X4.5", "L X+4 X+5", "L X+",
    "L U+3", "APPR LT X+4", "L X+4 ; text", "* - text", "BLK FORM 0.1 Z X+0 Y+0 Z-1",
    "BEGIN PGM A INCH", "END PGM A MM", "L X+1.12345", "L X+123456789",
)  # fmt: skip
"""The same for the conversational format."""


COMPENSATED: Final = tuple(
    f"G1 {side} D{offset} X-4.0\nG1 X-3.0\n{way}\nG40\nG1 X4.0"
    for side in ("G41", "G42") for offset in (1, 2)
    for way in (
        "G1 X-1.0 Y14.0\nG1 X3.0 Y10.0", "G1 X-3.0 Y10.5\nG1 X3.0 Y10.5", "G1 X0.0\nG1 X-2.0",
        "G2 X1.0 Y10.0 I2.0 J0.0\nG1 X3.0", "G3 X1.0 Y10.0 I2.0 J0.0\nG1 X3.0",
        "G2 X1.0 Y14.0 I0.0 J4.0\nG3 X3.0 Y12.0 I2.0 J0.0\nG1 Y10.0", "G0 X0.0", "G1 Z-3.5",
        "G1 X-2.9\nG1 X-2.9 Y10.05\nG1 X3.0", "T2 M6", "G1 X3.0 Y8.0\nG1 X-3.0 Y7.0",
    )
)  # fmt: skip
"""Paths beside which a small cutter runs, or one that is too large."""

MORE: Final = (
    "G2 X1.0 Y10.0 I3.0 J0.0 P1.5", "G2 X1.0 Y10.0 I3.0 J0.0 P2", "G2 X1.0 Y10.0 I3.0 J0.0 P0",
    "G1 X=IC(1.0)", "G1 X=AC(9.0) Y=IC(-1.0)", "G2 X1.0 Y10.0 I=AC(-2.0) J=AC(10.0)",
    "G2 X1.0 Y10.0 CR=3.5", "G2 X1.0 Y10.0 CR=-3.5", "G2 X-5.0 Y10.0 I3.0 J0.0 TURN=1",
    "G91\nG53 G0 X0.0\nG90", "G91\nG28 X1.0\nG90", "G91\nG1 X1.0 Y-0.5 F200\nG90",
    "(operation a)\nG1 X9.0", "; operation b\nG1 X9.0", "M0 (turn it)", "(turn it)\nM0",
    "G1 X9.0 M5", "G1 X9.0 M8 M9", "G4 F2", "G4 P2", "G4 U1.0", "S2000 M4\nG1 X9.0",
    "G0 Z4.5\nG0 X0.0\nG1 Z-3.0", "G0 Z3.5\nG0 X0.0\nG1 Z-3.0",
    "G0 Z5.0\nT2 M6\nG43 H2\nS900 M3\nG1 Z-3.0 F50", "G0 Z5.0 X1.0", "SUPA G0 Z0", "D0", "D2",
    "OFFN=0.1",
)  # fmt: skip
"""Further blocks, of single controllers and of several lines."""

SAID: Final = (
    "CC X+0 Z+0", "CC X+0 PR+3", "CC", "CC PR+2 PA+30\nC X+0 Y+10 DR+", "L X+4 R0 F200 M5",
    "L M91", "L X-4 RL\nL X-3\nL X-1 Y+14\nL X+3 Y+10\nL X+4 R0",
    "L X-4 RR\nL X-3\nL X-1 Y+14\nL X+3 Y+10\nL X+4 R0",
    "L X-4 RL\nL X-3\nCR X+1 Y+10 R+2 DR-\nL X+4 R0",
    "L X-4 RR\nL X-3\nCR X+1 Y+10 R+2 DR-\nL X+4 R0",
    "L Z+5 FMAX\nTOOL CALL 2 Z S500 DR+0.2\nL Z-3 F100", "M3 M8", "L IZ+1", "L X+4 F200 F300",
)  # fmt: skip
"""Further conversational blocks."""

BLOCKS: Final = {
    **dict.fromkeys(("linuxcnc", "sinumerik"), (*PUT_IN, *MORE)),
    "heidenhain": (*CONVERSATIONAL, *SAID),
    "haas": COMPENSATED,
    "fanuc": MORE,
}
"""What is put in; the other controllers read their words like one of these."""


def changed_programs(machine: str) -> Iterator[tuple[str, str]]:
    """Each block left out, each twice, and others put in."""
    good = GOOD[machine]
    yield "", good
    lines = good.splitlines(keepends=True)
    for k, line in enumerate(lines):
        yield f"without {k}", "".join([*lines[:k], *lines[k + 1 :]])
        if k % 3 == 1:
            yield f"twice {k}", "".join([*lines[:k], line, *lines[k:]])
    mark = CONVERSATIONAL_MARK if machine == "heidenhain" else MARK
    assert mark in good
    if machine not in BLOCKS:
        return
    for block in BLOCKS[machine]:
        yield block, good.replace(mark, f"{block}\n{mark}", 1)


TOLD: Final = ("linuxcnc", "heidenhain")
"""Machines of which findings are kept with their words, which are the same for all."""


def weighted(values: Iterable[float]) -> float:
    """A sum that is another one if any of the values is."""
    finite = (value if math.isfinite(value) else 1e4 for value in values)
    return math.fsum(value * math.sqrt(k + 2.0) for k, value in enumerate(finite))


def said(machine: str, text: str) -> Any:
    """Findings by line, a sum over the moves of each kind, and what else happens."""
    try:
        found = run(text, load(machine), BENCH)
        linted = LINTER.lint(text.encode(), load(machine), BENCH)
    except FileError as error:
        return str(error)
    rows: dict[str, float] = {}
    for move in found.moves:
        place = (move.course.length, move.end.real, move.end.imag, move.z_end, move.mismatch)
        run_with = (move.feed, move.speed, move.tool, move.offset, move.radius_offset)
        side = f"{move.kind}, {move.coolant}, {move.compensation or 'none'}, {move.work_offset}"
        rows[side] = rows.get(side, 0.0) + weighted((1.0, *place, *run_with))
    return {
        "findings": [
            [each.line, each.rule, each.concerns, each.value,
             *((each.what, each.allowed) if machine in TOLD else ())]
            for each in found.findings
        ],
        "lint": [linted.moves, linted.complete, len("".join(linted.texts.values()))],
        "moves": rows,
        "events": " ".join(map(_event, found.events)),
        "modes": [repr(found.mm_per_unit), repr(found.step), repr(found.blending),
                  repr(found.naive_cam), found.complete],
    }  # fmt: skip


def _event(event: Event) -> str:
    return f"{event.kind} {event.line} {event.word} {event.tool} {event.seconds:g}"


def document(machine: str) -> dict[str, Any]:
    """Of the good program all, of each other one what is other."""
    found: dict[str, Any] = {}
    good: Any = {}
    for name, text in changed_programs(machine):
        own = said(machine, text)
        if not name:
            good = own
        elif isinstance(own, dict):
            own = {key: value for key, value in own.items() if value != good[key]}
        found[name] = own
    return found
