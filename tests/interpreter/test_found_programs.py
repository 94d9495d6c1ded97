"""Programs of public reports in fixtures/found/programs: what `camgeo lint` said of them was wrong.

What is right was said by LinuxCNC's interpreter (rs274, Debian linuxcnc-uspace 2.9.0~pre1) and by
Grbl's parser (gnea/grbl at bfb67f0, compiled); `tests.draws.programs` asks them about more. The
rest of the cases are of the same kinds, in blocks put into a program that is right.
"""

from __future__ import annotations

import cmath
import math
from pathlib import Path
from typing import Final

import pytest

from camgeo.errors import FileError
from camgeo.milling.machine import load
from camgeo_export.interpreter.moves import Run
from camgeo_export.interpreter.run import run
from tests.interpreter.programs import GOOD

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


def with_block(machine: str, block: str, mark: str = "G1 Y-5.0\n") -> Run:
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


def test_a_byte_order_mark_is_told_where_it_is_read() -> None:
    for machine, told in (("grbl", False), ("linuxcnc", True), ("fanuc", True)):
        data = b"\xef\xbb\xbf" + GOOD[machine].encode()
        found = {each.rule for each in run(data, load(machine)).findings}
        assert found == ({"characters"} if told else set())


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


def test_a_rounding_is_of_the_next_move_alone() -> None:
    text = (FOLDER / "msg.mpf").read_text()
    for between in ("N85 G0 Z10\n", "N86 SUPA G0 Z0\n", "N87 G18 G2 X12 Z-1 CR=1\n"):
        found = run(text.replace("N90 G1 Y10\n", f"{between}N90 G17 G1 Y10\n"), load("sinumerik"))
        assert not any(move.kind == "arc" for move in found.moves)
