"""G-code: the program run again follows the path, and keeps the rules of every controller; programs
of whole jobs.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo.app.answers.answer import text
from camgeo.app.answers.setup import setup_sheet
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import Product, find_disc
from camgeo.errors import FileError, GeometryError, SceneError, ToleranceError
from camgeo.milling import machine as machines
from camgeo.milling.machine import Machine, load, names
from camgeo.milling.milling import GcodeSpec, Heights
from camgeo.milling.moves import ArcFeed, Feed, Operation, Rapid, Stop, Toolpath
from camgeo.scene.scene import parse_scene
from camgeo.units import LengthUnit
from camgeo_export.gcode.writer import (
    WRITER,
    Budget,
    Grid,
    Iso,
    Program,
    Setup,
    Speller,
    budget,
    number_lines,
    write_program,
)
from camgeo_export.interpreter.moves import ProgramRun
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER
from tests.export.stub_product import SECOND_TOOL, TOOL, StubProduct
from tests.export.verified import TOLERANCE, faults, read_back
from tests.interpreter.programs import weighted
from tests.kept import compare_documents
from tests.toolpath import programs
from tests.toolpath.test_features import ROUND_BLANK, STATED
from tests.toolpath.test_features import SCENE as FEATURED

LINUXCNC = machines.load("linuxcnc")

LINUXCNC_FILE = Path(machines.__file__).parent / "machines" / "linuxcnc.toml"

NAMES = machines.names()

TOLERANCES = [0.05, 0.01, 1e-3, 1e-6]


def program_of(product: StubProduct, tolerance: float) -> tuple[str, ProgramRun]:
    text = WRITER.write(product, tolerance).data.decode()
    return text, run(text, LINUXCNC)


def test_decimals_follow_the_tolerance() -> None:
    decimals = [budget(LINUXCNC, "mm", tolerance).decimals for tolerance in TOLERANCES]
    assert decimals == [4, 4, 4, 7]
    assert budget(LINUXCNC, "inch", 0.05).decimals == 5
    with pytest.raises(ToleranceError, match="too coarse"):
        budget(LINUXCNC, "mm", 1e-10)


def test_path_blending_is_part_of_the_budget() -> None:
    _, coarse = program_of(StubProduct(), 0.01)
    assert coarse.blending == pytest.approx(0.003)
    assert coarse.naive_cam == 0.0
    _, fine = program_of(StubProduct(), 0.001)
    assert fine.blending == 0.0


def test_blending_counts_in_the_measure() -> None:
    product = StubProduct()
    data = WRITER.write(product, 0.01).data
    more = data.replace(b"G64 P0.0030", b"G64 P0.0130")
    assert WRITER.measure(product, more) == pytest.approx(WRITER.measure(product, data) + 0.01)
    naive = data.replace(b" Q0\n", b"\n")
    assert WRITER.measure(product, naive) == pytest.approx(WRITER.measure(product, data) + 0.003)
    assert WRITER.measure(product, data.replace(b" P0.0030 Q0\n", b"\n")) == math.inf


def test_loops_leave_out_the_leads() -> None:
    _, program = program_of(StubProduct(), 1e-4)
    loops = program.loops()
    assert [(loop.operation, loop.z) for loop in loops] == [
        ("bore", -4.0), ("bore", -8.0), ("outline", -4.0), ("outline", -8.0),
    ]  # fmt: skip
    assert (loops[0].contour.area, loops[2].contour.area) == pytest.approx(
        (math.pi * 7.0**2, -math.pi * 35.0**2), rel=1e-4
    )


HEAD = "G21 G17 G40 G49 G54 G80 G90 G94 G91.1\nG43 H1\nG61\nS1 M3\nF100\n"


def test_leads_from_and_to_the_same_point_are_no_part_of_the_loop() -> None:
    body = "G0 X0 Y0\nG0 Z-1\nG1 X5\nG3 X-5 I-5 J0\nG3 X5 I5 J0\nG1 X0\nM5\nM2"
    loops = run(HEAD + body, LINUXCNC).loops()
    assert [loop.contour.area for loop in loops] == [pytest.approx(math.pi * 25.0)]


def speller(tolerance: float = 0.001, decimals: int = 4) -> Speller:
    shares = Budget(tolerance, decimals, 3.0 * 10.0**-decimals, 0.05 * tolerance, 0.0, tolerance)
    return Speller(Grid(decimals, 1.0), shares, LINUXCNC, Iso())


def test_an_arc_with_coincident_printed_ends_is_dropped() -> None:
    words = speller(tolerance=1e-9)
    words.retract(5.0)
    words.move(Rapid((10.0, 0.0, 5.0)))
    words.move(Feed((10.0, 0.0, -1.0), 100.0))
    words.take()
    end = 10.0 * complex(math.cos(3e-6), math.sin(3e-6))
    words.move(ArcFeed((end.real, end.imag, -1.0), (0.0, 0.0), True, 100.0))
    assert words.take() == []
    words.move(ArcFeed((0.0, 10.0, -1.0), (0.0, 0.0), True, 100.0))
    assert words.take() == ["G3 X0.0000 Y10.0000 I-10.0000 J0.0000"]


def test_nearly_straight_arcs_become_lines() -> None:
    words = speller()
    words.reached(-1.0)
    words.move(Rapid((10.0, 0.0, -1.0)))
    words.move(ArcFeed((9.99995, 0.03162, -1.0), (0.0, 0.0), True, 100.0))
    assert words.take()[1:] == ["G1 X10.0000 Y0.0316 F100"]


@pytest.mark.parametrize("radius", [5000.0, 0.005])
def test_arcs_beyond_the_machine_become_chords_within_the_budget(radius: float) -> None:
    words = speller()
    words.reached(-1.0)
    words.move(Rapid((radius, 0.0, -1.0)))
    turn = 0.01 if radius > 1.0 else math.pi
    end = radius * complex(math.cos(turn), math.sin(turn))
    words.move(ArcFeed((end.real, end.imag, -1.0), (0.0, 0.0), True, 100.0))
    assert words.arcs == 0
    sagitta = radius * (1.0 - math.cos(turn / words.lines / 2.0))
    assert sagitta <= words.budget.chord
    one_less = max(1, words.lines - 1)
    assert radius * (1.0 - math.cos(turn / one_less / 2.0)) > words.budget.chord
    assert f"X{end.real:.4f} Y{end.imag:.4f}" in words.take()[-1]


@given(
    st.floats(0.5, 900.0),
    st.floats(-math.pi, math.pi),
    st.floats(1e-3, math.pi),
    st.complex_numbers(max_magnitude=500.0),
    st.booleans(),
    st.sampled_from([(4, 1.0), (5, 25.4), (6, 1.0)]),
)
def test_printed_arcs_meet_their_ends(
    radius: float,
    begin: float,
    turn: float,
    hub: complex,
    ccw: bool,
    grid: tuple[int, float],
) -> None:
    step = 10.0 ** -grid[0] * grid[1]
    shares = Budget(1.0, grid[0], 3.0 * step, 1e-6, 0.0, 1.0)
    words = Speller(Grid(*grid), shares, LINUXCNC, Iso())
    start = hub + radius * complex(math.cos(begin), math.sin(begin))
    final = begin + (turn if ccw else -turn)
    end = hub + radius * complex(math.cos(final), math.sin(final))
    words.retract(-1.0)
    words.move(Rapid((start.real, start.imag, -1.0)))
    words.move(ArcFeed((end.real, end.imag, -1.0), (hub.real, hub.imag), ccw, 100.0))
    head = HEAD if grid[1] == 1.0 else HEAD.replace("G21", "G20")
    program = run(head + "\n".join(words.take()) + "\nM5\nM2", LINUXCNC)
    for move in program.moves[2:]:
        assert abs(move.end - end) <= 0.71 * step
        if move.kind != "arc":
            assert radius * (1.0 - math.cos(turn / 2.0)) <= 1.01e-6
            continue
        assert move.mismatch <= 1.42 * step * (1.0 + 1e-6)
        middle = move.centre + (move.start - move.centre) * complex(
            math.cos(move.sweep / 2.0), math.sin(move.sweep / 2.0)
        )
        assert abs(abs(middle - hub) - radius) <= shares.rounding


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("G0 Z5.0000\nG0 X4.2", "G0 Z1.0000\nG0 X4.2", "below the safe height"),
        ("G1 Z-4.0000 F100", "G0 Z-4.0000", "into the material"),
        ("S3000 M3", "S3000", "spindle off"),
        (" F100", "", "without feed"),
        ("G21", "G20", "not in mm"),
        ("M2\n", "", "has no end"),
        ("(operation outline)", "(operation rim)", "does not have"),
        ("T1 M6", "T2 M6", "the length of tool 1 is activated with tool 2"),
        ("T1 M6\nG43 H1", "T2 M6\nG43 H2", "'bore' is cut with tool 2, not 1"),
        ("T1 M6", "M6", "a tool change without the tool number"),
        ("G1 Z-8.0000 F100", "G1 Z-7.0000 F100", "no closed path of 'bore' at Z -8"),
        ("G17 ", "", "cut without G17"),
        ("G91.1", "G90.1", "the radii of the arc differ"),
        ("M5\nM2", "M19\nM5\nM2", "M19, an angle of the spindle, is not supported"),
        ("M5\nM2", "M12\nM5\nM2", "LinuxCNC has no M12"),
        ("M5\nM2", "M5\nM2\nG0 X1", "after the end"),
        ("G43 H1", "G43 H#1", "parameters, expressions"),
        ("(tolerance 0.001 mm)", "", "state its tolerance"),
    ],
)
def test_a_broken_program_is_refused(old: str, new: str, message: str) -> None:
    text, _ = program_of(StubProduct(), 0.001)
    assert old in text
    with pytest.raises(FileError, match=message):
        WRITER.measure(StubProduct(), text.replace(old, new).encode())


def profile(tmp_path: Path, **changes: str) -> StubProduct:
    """A product for LinuxCNC with other lines in its profile, by the key they begin with."""
    text = LINUXCNC_FILE.read_text()
    for key, line in changes.items():
        text, count = re.subn(rf"^(# )?{key} = .*$", line, text, flags=re.MULTILINE)
        assert count == 1
    file = tmp_path / "mill.toml"
    file.write_text(text)
    return StubProduct(gcode=GcodeSpec(machine=str(file)))


def test_a_machine_may_be_a_file(tmp_path: Path) -> None:
    decimals = "decimals = { mm = 6, inch = 6 }"
    product = profile(tmp_path, end='end = ["M30"]', decimals=decimals)
    written = WRITER.write(product, 0.01)
    assert written.data.endswith(b"M5\nM30\n")
    assert b"X4.200000" in written.data
    assert WRITER.measure(product, written.data) <= 0.01


@pytest.mark.parametrize("degrees", [120, 90, 10])
def test_arcs_are_divided_as_the_machine_wants(tmp_path: Path, degrees: int) -> None:
    product = profile(tmp_path, largest_sweep=f"largest_sweep = {degrees}")
    written = WRITER.write(product, 0.001)
    program = run(written.data.decode(), LINUXCNC)
    sweeps = [abs(math.degrees(move.sweep)) for move in program.moves if move.kind == "arc"]
    # A printed end point moves by 0.71 steps, on arcs of 0.7 mm radius at least.
    assert max(sweeps) <= degrees + math.degrees(1.42e-4 / 0.7)
    _, whole = program_of(StubProduct(), 0.001)
    turned = sum(abs(move.sweep) for move in whole.moves)
    assert math.radians(sum(sweeps)) == pytest.approx(turned, abs=1e-3 * len(sweeps))
    assert 0.0005 < WRITER.measure(product, written.data) <= 0.001


def test_a_machine_that_says_nothing_divides_at_half_a_turn(tmp_path: Path) -> None:
    stated = profile(tmp_path, largest_sweep="largest_sweep = 180")
    blocks = [line for line in WRITER.write(stated, 0.001).data.splitlines() if line[:1] != b"("]
    silent = WRITER.write(StubProduct(), 0.001).data.splitlines()
    assert blocks == [line for line in silent if line[:1] != b"("]


def test_the_controllers_own_arcs_count(tmp_path: Path) -> None:
    product = profile(tmp_path, interpolation="interpolation = 0.002")
    written = WRITER.write(product, 0.01)
    assert 0.005 < WRITER.measure(product, written.data) <= 0.01
    assert written.facts["controller_arcs_mm"] == 0.002
    assert b"(arcs run within 0.002 mm)" in written.data
    # The same program on a machine whose arcs are exact.
    exact = replace(product, gcode=GcodeSpec())
    assert WRITER.measure(exact, written.data) == pytest.approx(
        WRITER.measure(product, written.data) - 0.002
    )
    # Where they would take more than half of the tolerance, it gets lines.
    fine = WRITER.write(product, 0.002)
    assert (fine.facts["arcs"], "controller_arcs_mm" in fine.facts) == (0, False)
    assert 0.001 < WRITER.measure(product, fine.data) <= 0.002


def test_the_machining_time_is_reported(tmp_path: Path) -> None:
    facts = WRITER.write(StubProduct(), 0.001).facts
    # Two passes round the bore of 7 mm and the outline of 35 mm at 5 mm/s; plunges from Z 5 to -4
    # and to -8 at 5/3 mm/s; quarter circles of 2.8 and 3.5 mm into each pass and out of it. Inside,
    # the contact, 3 mm farther out, runs at that feed.
    rounds = 2.0 * 2.0 * math.pi * (7.0 + 3.0 + 35.0) / 5.0
    plunges = 2.0 * (9.0 + 13.0) / (5.0 / 3.0)
    leads = 2.0 * 2.0 * 0.5 * math.pi * (2.8 + 3.5 + 2.0 * 3.0) / 5.0
    least = rounds + plunges + leads
    # Eight traverses of 13 mm at most and 43 mm once, with 30 mm/s and 0.06 s to get there.
    assert least < float(facts["machining_time_s"]) < least + (8 * 13 + 43) / 30.0 + 9 * 0.06
    each = [float(text.split()[-2]) for text in str(facts["machining_times"]).split(", ")]
    assert sum(each) == pytest.approx(float(facts["machining_time_s"]), abs=0.05 * (len(each) + 1))
    lazy = profile(tmp_path, acceleration="acceleration = 1.0")
    assert float(WRITER.write(lazy, 0.001).facts["machining_time_s"]) > 1.1 * least


def test_a_profile_without_dynamics_states_no_time(tmp_path: Path) -> None:
    file = tmp_path / "mill.toml"
    file.write_text(LINUXCNC_FILE.read_text().partition("[dynamics]")[0])
    product = StubProduct(gcode=GcodeSpec(machine=str(file)))
    assert "machining_time_s" not in WRITER.write(product, 0.001).facts


@pytest.mark.parametrize(
    ("key", "line", "message"),
    [
        (
            "largest_sweep",
            "largest_sweep = 181",
            "arcs.largest_sweep = 181.0: must be a number from",
        ),
        ("largest_sweep", "largest_sweep = 0", "from 1 to 180"),
        ("largest_sweep", "largest_sweep = nan", "must be a number from 1 to 180"),
        (
            "acceleration",
            "acceleration = 0",
            "dynamics.acceleration = 0.0: must be a number, above 0",
        ),
        ("rapid_feed", "rapid_feed = 0", "must be a number, above 0"),
        ("line_length", "line_length = 2", "must be a whole number from 3 to 252"),
        ("end", 'end = ["M{two}"]', "end = 'M{two}': must hold no braces but {name}, {unit}"),
        ("rapid_feed", "", "dynamics.rapid_feed: is missing: Of each axis in traverses"),
        ("interpolation", "interpolation = -1", "must be a number, at least 0"),
        ("line_length", "line_length = 20", "line_length is too short for the block G17"),
    ],
)
def test_numbers_that_no_machine_has(tmp_path: Path, key: str, line: str, message: str) -> None:
    product = profile(tmp_path, **{key: line})
    with pytest.raises(SceneError, match=re.escape(message)):
        WRITER.write(product, 0.01)


def test_unknown_machines_name_the_known() -> None:
    with pytest.raises(SceneError, match=r"allowed: fanuc.*did you mean linuxcnc"):
        machines.load("linuxnc")
    with pytest.raises(SceneError, match="cannot be read"):
        machines.load("nowhere.toml")


def test_all_faults_of_a_profile_are_reported_at_once() -> None:
    text = (LINUXCNC_FILE.read_text() + "[spidle]\n").replace('name = "Linux', 'nam = "Linux')
    changes = {
        "safe_start = [": "safe_start = [1, ",
        'mm = "G21"': "mm = 21",
        "mm = 4,": "mm = 4.5,",
        "radius_tolerance = 0.002": "radius_tolerance = -1",
        'off = ["G61"]': "",
        'kind = "source code"\nabout = ["words"]': 'kind = "source"\nabout = ["words"]',
    }
    for before, after in changes.items():
        assert text.count(before) == 1
        text = text.replace(before, after)
    with pytest.raises(SceneError) as caught:
        machines.parse(text, "x.toml")
    faults = {fault.key: str(fault) for fault in caught.value.faults}
    assert set(faults) == {
        "nam", "name", "spidle", "program.safe_start[1]", "unit.mm", "numbers.decimals.mm",
        "arcs.radius_tolerance", "smoothing.off", "evidence[1].kind",
    }  # fmt: skip
    assert "did you mean name?" in faults["nam"]
    with pytest.raises(SceneError, match="not TOML"):
        machines.parse("= 3", "x.toml")


# The blocks of machine profiles around the moves, for every controller ----------------------------


OTHER = replace(TOOL, number=7, diameter=4.0)


def spec(name: str) -> GcodeSpec:
    return GcodeSpec(machine=name, coolant="flood", spin_up=1.5)


def lines_of(name: str, **options: Any) -> list[str]:
    """Of a program, of two tools if the machine changes them, without the numbers of blocks."""
    machine = machines.load(name)
    second = OTHER if machine.tool_change.change else None
    product = StubProduct(gcode=replace(spec(name), **options), second_tool=second)
    lines = WRITER.write(product, TOLERANCE).data.decode("ascii").splitlines()
    numbers = machine.text.line_numbers is not None
    return [re.sub(r"^N?\d+ (?=\S)", "", line) if numbers else line for line in lines]


def positions(lines: list[str], pattern: str) -> list[int]:
    return [index for index, line in enumerate(lines) if re.search(pattern, line)]


@pytest.mark.parametrize("unit", ["mm", "inch"])
@pytest.mark.parametrize("name", NAMES)
def test_lines_and_comments_are_as_the_controller_reads_them(name: str, unit: LengthUnit) -> None:
    machine = machines.load(name)
    product = StubProduct(name="a(b) ü!?~%; " + "x" * 90, gcode=spec(name), unit=unit)
    data = WRITER.write(product, TOLERANCE).data
    assert data.isascii()
    assert not re.search(rb"-0\.?0*(?![\d.])", re.sub(rb"[(;].*", b"", data))
    for line in data.decode().splitlines():
        assert len(line) <= machine.text.line_length <= machine.text.longest_line
        inner = line.partition(machine.text.comment_open)[2].removesuffix(
            machine.text.comment_close
        )
        assert not set(inner) & {*"()", *machine.text.forbidden}
        if machine.text.letters == "upper":
            assert line == line.upper()


def test_numbers_of_blocks() -> None:
    haas = machines.load("haas")
    text = replace(haas.text, line_numbers=5)
    lines = number_lines(["%", "O0001 (X)", "(Y)", "G21", "M30", "%"], replace(haas, text=text))
    assert lines == ["%", "O0001 (X)", "(Y)", "N5 G21", "N10 M30", "%"]


def test_a_block_of_several_lines_has_one_number() -> None:
    other = replace(spec("heidenhain"), work_offset="2")
    lines = WRITER.write(StubProduct(gcode=other), 0.01).data.decode().splitlines()
    place = next(k for k, line in enumerate(lines) if "CYCL DEF 247" in line)
    number = int(lines[place].split()[0])
    assert lines[place : place + 3] == [
        f"{number} CYCL DEF 247 DATUM SETTING ~", "  Q339=+2 ;DATUM NUMBER",
        f"{number + 1} CYCL DEF 32.0 TOLERANCE",
    ]  # fmt: skip


def test_a_program_for_a_machine_without_a_tool_change_has_one_tool() -> None:
    assert not [line for line in lines_of("grbl") if re.search(r"^[^(]*(M6|M0|T\d)", line)]


def printed(path: Toolpath, machine: Machine, coolant: str = "off") -> Program:
    setup = Setup("x", "mm", "G54", coolant, 0.0)
    return write_program(path, machine, budget(machine, "mm", 0.01), setup, ())


def test_a_stop_lifts_the_tool_and_comes_back_from_above() -> None:
    cut = StubProduct().cuts[0]
    moves = (
        Rapid((1.0, 2.0, 5.0)), Feed((1.0, 2.0, -1.0), 100.0), Rapid((1.0, 2.0, 5.0)),
        Stop("move the clamp (left)"), Rapid((1.0, 2.0, 5.0)), Feed((1.0, 2.0, -1.0), 100.0),
        Rapid((1.0, 2.0, 5.0)),
    )  # fmt: skip
    path = Toolpath(Heights(5.0, 5.0), (Operation(cut, moves),))
    found = {}
    for name in ("linuxcnc", "haas", "sinumerik"):
        lines = printed(path, machines.load(name), coolant="flood").lines
        first = lines.index("M9")
        found[name] = lines[first : first + 12]
    assert found["linuxcnc"][:10] == [
        "M9", "M5", "(move the clamp [left])", "M0", "G43 H1", "G0 Z5.0000", "S3000 M3", "M8",
        "G0 X1.0000 Y2.0000", "G1 Z-1.0000 F100",
    ]  # fmt: skip
    assert found["haas"][:10] == [
        "M9", "G0 G53 Z0.", "M5", "(MOVE THE CLAMP [LEFT])", "M0", "S3000 M3",
        "G0 X1.000 Y2.000", "G0 G43 Z5.000 H1", "M8", "G1 Z-1.000 F100.",
    ]  # fmt: skip
    assert found["sinumerik"][:10] == [
        "M9", "SUPA G0 Z0 D0", "M5", "; move the clamp [left]", "M0", "D1", "S3000 M3",
        "G0 X1.0000 Y2.0000", "G0 Z5.0000", "M8",
    ]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_an_operation_that_ends_low_is_left_with_the_length_of_its_tool(name: str) -> None:
    """G49 in the frame of the next one would make another height of the same Z."""
    machine = machines.load(name)
    first, second = StubProduct(gcode=spec(name), second_tool=OTHER).cuts[:2]
    moves = (Rapid((1.0, 2.0, 5.0)), Feed((1.0, 2.0, -1.0), 100.0), Rapid((1.0, 2.0, 1.0)))
    path = Toolpath(Heights(5.0, 5.0), (Operation(first, moves), Operation(second, moves)))
    lines = printed(path, machine).lines
    low = positions(lines, r"Z[-+]?1\.0+( R0 FMAX)?$")
    assert len(low) == 2
    if any("{z}" in block for block in machine.retract.blocks):
        assert [lines[place + 1] for place in low] == ["G0 Z5.0000"] * 2
        assert lines[-2:] == ["M5", lines[-1]]
        assert lines.index("G0 Z5.0000", low[0]) < positions(lines, "G49")[-1]
    safe = machine.retract.blocks[0].partition("{")[0]
    assert all(any(line.startswith(safe) for line in lines[place + 1 :]) for place in low)


def test_a_tool_has_its_own_coolant() -> None:
    wet, dry = replace(TOOL, coolant="mist"), replace(OTHER, coolant="off")
    product = StubProduct(gcode=spec("linuxcnc"), tool=wet, second_tool=dry)
    lines = WRITER.write(product, TOLERANCE).data.decode().splitlines()
    assert lines.index("M7") < lines.index("M9") < positions(lines, r"T7")[0]
    assert [line for line in lines if re.fullmatch("M[789]", line)] == ["M7", "M9"]


GRBL = GcodeSpec(machine="grbl")


@pytest.mark.parametrize(
    ("product", "faults", "message"),
    [
        (
            StubProduct(gcode=GRBL, second_tool=OTHER),
            {"output.gcode.machine": "'Grbl'"},
            "tools 1 and 7 are needed: write a program for",
        ),
        (
            StubProduct(gcode=GRBL, tool=replace(TOOL, coolant="mist")),
            {"tool.coolant": "'mist'"},
            "tool.coolant = 'mist'",
        ),
        (
            StubProduct(gcode=replace(GRBL, coolant="through")),
            {"output.gcode.coolant": "'through'"},
            '"off", "flood"',
        ),
        (
            StubProduct(gcode=GcodeSpec("sinumerik", work_offset="G59", coolant="through")),
            {"output.gcode.coolant": "'through'", "output.gcode.work_offset": "'G59'"},
            "G59",
        ),
        (
            StubProduct(gcode=GRBL, scale=1000.0),
            {"output.gcode.machine": "'Grbl'"},
            "numbers.largest is too small for the coordinate 3",
        ),
    ],
)
def test_what_a_machine_does_not_have_is_refused(
    product: StubProduct, faults: dict[str, str], message: str
) -> None:
    with pytest.raises(SceneError, match=re.escape(message)) as caught:
        WRITER.write(product, 50.0 * TOLERANCE)
    assert {each.key: each.value for each in caught.value.faults} == faults


def test_work_offset_and_program_number() -> None:
    other = replace(spec("fanuc"), work_offset="G57", program_number=42)
    text = WRITER.write(StubProduct(gcode=other), 0.01).data.decode()
    assert text.startswith("%\nO0042(ECCENTRIC)\n")
    text_of_return = WRITER.write(StubProduct(gcode=other, position=1), 0.01).data.decode()
    assert text_of_return.startswith("%\nO0043(")
    assert "\nG57\n" in text
    assert "G54" not in text
    other = GcodeSpec(work_offset="G59.3")
    text = WRITER.write(StubProduct(gcode=other), 0.01).data.decode()
    assert "G17 G21 G40 G49 G59.3 G80 G90 G94" in text


@pytest.mark.parametrize("name", NAMES)
def test_a_tool_is_named_as_its_user_names_it(name: str) -> None:
    tool = replace(TOOL, name="Carbide, 4 flutes")
    product = StubProduct(gcode=spec(name), tool=tool)
    data = WRITER.write(product, TOLERANCE).data
    assert f"diameter {tool.diameter:g} mm, carbide, 4 flutes" in data.decode("ascii").lower()
    assert VERIFIER.origin(data).tolerance == TOLERANCE


def test_a_controller_of_three_decimals_says_what_it_can_reach() -> None:
    fanuc = machines.load("fanuc")
    with pytest.raises(ToleranceError, match="3 decimals in a program are too coarse") as caught:
        budget(fanuc, "mm", 0.001)
    assert budget(fanuc, "mm", caught.value.reached).fit > 0.0
    with pytest.raises(ToleranceError):
        budget(fanuc, "mm", 0.99 * caught.value.reached)


@pytest.mark.parametrize("machine", machines.names())
@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_from_what_a_controller_can_reach_every_tolerance_has_a_budget(
    machine: str, unit: LengthUnit
) -> None:
    """Also where smoothing takes all that the fit can spare, up to a rounding."""
    profile = machines.load(machine)
    for steps in range(1, 201):
        tolerance = least = 2.5e-4 * steps
        try:
            shares = budget(profile, unit, tolerance)
        except ToleranceError as error:
            least = error.reached
            shares = budget(profile, unit, float(f"{least:g}"))  # as the message names it
        assert least == tolerance or least > tolerance * (1.0 + 1e-9)
        spent = shares.fit + shares.rounding + shares.chord + shares.blending
        assert spent <= least * (1.0 + 1e-12)
        assert shares.fit >= 0.0999 * tolerance


def test_smoothing_takes_no_more_than_coarse_numbers_leave() -> None:
    """Of four decimals of an inch 10 um are just within reach, on the exact path."""
    haas, fanuc = machines.load("haas"), machines.load("fanuc")
    assert budget(haas, "inch", 0.01) == budget(fanuc, "inch", 0.01)
    shares = budget(haas, "inch", 0.02)
    assert haas.smoothing is not None
    assert haas.smoothing.smallest <= shares.blending <= haas.smoothing.share * 0.02
    assert shares.fit >= 0.1 * 0.02


@pytest.mark.parametrize("name", NAMES)
def test_a_helix_keeps_its_pitch(name: str) -> None:
    """As an arc with Z where the controller has one, else as lines on the helix."""
    machine = machines.load(name)
    cut = StubProduct().cuts[0]
    turns = (ArcFeed((-3.0, 0.0, -0.5), (0.0, 0.0), True, 200.0),
             ArcFeed((3.0, 0.0, -1.0), (0.0, 0.0), True, 200.0))  # fmt: skip
    moves = (Rapid((3.0, 0.0, 5.0)), Feed((3.0, 0.0, 0.0), 100.0), *turns, Rapid((3.0, 0.0, 5.0)))
    made = printed(Toolpath(Heights(5.0, 5.0), (Operation(cut, moves),)), machine)
    assert (made.speller.arcs == 2) == machine.arcs.helical
    if machine.arcs.helical:
        assert any(re.match(r"G3 X-3.0+ Y0.0+ Z-0.50+ I-3.0+ J0.0+", line) for line in made.lines)
        return
    points = [
        complex(*map(float, found)) for line in made.lines
        if line.startswith("L") for found in re.findall(r"X(\S+) Y(\S+) Z", line)
    ]  # fmt: skip
    rows = [re.findall(r"^L X.* Z(\S+) R0", line) for line in made.lines]
    heights = [float(found) for each in rows for found in each]
    assert heights[-1] == -1.0
    assert len(points) > 20
    assert all(abs(abs(point) - 3.0) < 1e-4 for point in points)
    assert heights == sorted(heights, reverse=True)


def test_centres_may_be_absolute() -> None:
    mach = machines.load("mach3")
    absolute = replace(mach, arcs=replace(mach.arcs, centre="absolute"))
    cut = StubProduct().cuts[0]
    arc = ArcFeed((10.0, 12.0, -1.0), (10.0, 11.0), True, 200.0)
    down = Feed((10.0, 10.0, -1.0), 100.0)
    moves = (Rapid((10.0, 10.0, 5.0)), down, arc, Rapid((10.0, 12.0, 5.0)))
    lines = printed(Toolpath(Heights(5.0, 5.0), (Operation(cut, moves),)), absolute).lines
    assert "G3 X10.0000 Y12.0000 I10.0000 J11.0000 F200" in lines


# Programs of whole jobs: their words, one for each tool, where tools are changed, what is cut -----


FLOODED: Final = replace(SECOND_TOOL, name="two flutes", coolant="flood")

CUT: Final = re.compile(
    r"(?:N?\d+ )?(?:G[123]|L|C|CC)(?: ?(?:[XYZIJF][-+]?[\d.]+|DR[-+]|R0|G[123]))+"
)
"""A block of a cut and nothing else."""

JOBS: Final = (
    "stated, all kinds", "stated, conventional", "planned, a hub, holes and a mark",
    "stated, a spiral from a plate", "planned, from a plate with tabs", "engraved", "inches",
    "clamps that move",
)  # fmt: skip
"""Scenes of `tests.toolpath.programs`."""


def stubs() -> Iterator[tuple[str, Product]]:
    """Two tools, two walls, for each controller in both units."""
    for machine in names():
        for unit in ("mm", "inch"):
            spec = GcodeSpec(machine=machine)
            tool = FLOODED if load(machine).tool_change.change else None
            yield f"{machine}, {unit}", StubProduct(second_tool=tool, gcode=spec, unit=unit)
    spec = GcodeSpec(machine="haas", work_offset="G56", coolant="off", tool_change_height=50.0)
    yield "haas, other options", StubProduct(second_tool=FLOODED, gcode=spec)
    spec = replace(spec, machine="linuxcnc", clearance_height=30.0, retract_height=6.0)
    yield "linuxcnc, other options", StubProduct(second_tool=FLOODED, gcode=spec)


STUBS: Final = dict(stubs())


def summed(text: str) -> list[str | float]:
    """The lines; of each run of blocks that only cut, the number of blocks and a sum of theirs."""
    found: list[str | float] = []
    run: list[float] = []
    for line in [*text.splitlines(), ""]:
        if line and CUT.fullmatch(line):
            run.append(weighted(float(each) for each in re.findall(r"[-+]?\d+\.?\d*", line)))
            continue
        if run:
            found += [f"{len(run)} cuts", sum(run)]
            run = []
        found.append(line)
    return found


def said(disc: Product) -> Any:
    """All programs of a product: text, facts, deviation."""
    found = []
    for piece in WRITER.pieces(disc):
        whole = WRITER.write(piece, TOLERANCE)
        text = whole.data.decode("ascii")
        for stated, word in ((piece.version, "VERSION"), (piece.scene_hash, "HASH")):
            text = re.sub(re.escape(stated), word, text, flags=re.IGNORECASE)
        facts = {key: str(value) for key, value in whole.facts.items()}
        found.append([summed(text), facts, WRITER.measure(piece, whole.data)])
    return found


@pytest.mark.parametrize("name", [*STUBS, *JOBS])
def test_the_words_of_a_program_are_as_kept(name: str) -> None:
    """Its lines, the sums of its cuts, what is told of it, and how exact it is."""
    scene = programs.SCENES.get(name, programs.CLAMPS)
    disc = STUBS[name] if name in STUBS else Design(parse_scene(scene)).disc
    found = said(disc)
    compare_documents(f"export/programs/{name}", {name: found})
    assert all(0.0 <= deviation <= TOLERANCE for _, _, deviation in found)
    assert len(found) == len(list(WRITER.pieces(disc)))


# Parts with a hub, a timing mark and holes --------------------------------------------------------


@pytest.mark.parametrize("text", [FEATURED, FEATURED + ROUND_BLANK.replace("top = 1", "") + STATED])
def test_programs_are_measured_and_verified(text: str) -> None:
    read_back(WRITER, camgeo.loads(text).disc, least=0.0)


def test_a_mark_that_is_missing_in_a_program_is_found() -> None:
    product = camgeo.loads(FEATURED).disc
    data = WRITER.write(product, TOLERANCE).data.decode()
    start = data.index("(operation engrave mark)")
    end = data.index("(operation drill", start)
    cut = "\n".join(line for line in data[start:end].split("\n") if " Z-6.5" not in line)
    assert cut != data[start:end]
    assert faults(VERIFIER, product, (data[:start] + cut + data[end:]).encode())


# A controller that cannot change tools: one program for each run of a tool ------------------------


SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

SECOND_TABLE = """
[[tool]]
number = 2
diameter = 12
spindle_speed = 2500
feed = 250
plunge_feed = 80
stepdown = 2
"""

OPERATIONS = "".join(
    f"""
[[operation]]
kind = "{kind}"
boundary = "{boundary}"
tool = {tool}
allowance = {allowance}
"""
    for kind, boundary, tool, allowance in (
        ("rough", "bore", 1, 0.3),
        ("finish", "bore", 1, 0.0),
        ("rough", "outline", 2, 0.4),
        ("finish", "outline", 1, 0.0),
    )
)

FILES = ["setzhub-1-t1.nc", "setzhub-2-t2.nc", "setzhub-3-t1.nc"]


def with_two_tools(machine: str = "grbl") -> str:
    whole = (SCENES / "setzhub.toml").read_text().replace("linuxcnc", machine)
    head, tail = whole.split("[holding]")
    return f"{head}{SECOND_TABLE}{OPERATIONS}[holding]{tail}"


@pytest.fixture(scope="module")
def design() -> Design:
    return camgeo.loads(with_two_tools())


@pytest.fixture(scope="module")
def folder(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("programs")
    (made / "scene.toml").write_text(with_two_tools())
    design.write(made, ["gcode"], tolerance=0.01)
    return made


def test_each_run_of_a_tool_has_its_program(design: Design, folder: Path) -> None:
    certificate = json.loads((folder / "certificate.json").read_text())
    assert [each["file"] for each in certificate["files"]] == FILES
    wanted = [["rough bore", "bore"], ["rough outline"], ["outline"]]
    for name, operations, tool in zip(FILES, wanted, (1, 2, 1), strict=True):
        lines = (folder / name).read_text().splitlines()
        named = [line[11:-1] for line in lines if line.startswith("(operation ")]
        assert named == operations
        spindle = next(line for line in lines if line.startswith("(tool "))
        assert spindle.startswith(f"(tool {tool}:")
        assert not any(line.startswith("T") or "M6" in line for line in lines)
    assert sum(each["operations"] for each in certificate["files"]) == len(design.disc.milled.cuts)


def test_all_of_them_verify_and_lint(folder: Path) -> None:
    words = ["--scene", str(folder / "scene.toml")]
    assert main(["verify", *(str(folder / name) for name in FILES), *words]) == 0
    assert main(["lint", *(str(folder / name) for name in FILES), "--machine", "grbl"]) == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("program 2 of 3", "program 3 of 3"),
        ("program 2 of 3", "program 9 of 3"),
        ("G1 Z0.0000", "G1 Z-1.0000"),
    ],
)
def test_one_that_is_changed_fails(folder: Path, tmp_path: Path, old: str, new: str) -> None:
    program = (folder / FILES[1]).read_text()
    assert old in program
    (tmp_path / FILES[1]).write_text(program.replace(old, new, 1))
    words = ["--scene", str(folder / "scene.toml")]
    assert main(["verify", str(tmp_path / FILES[1]), *words]) == 1


def test_the_setup_sheet_says_what_is_in_which_file(design: Design) -> None:
    told = text(setup_sheet(design, 0.01))
    assert "setzhub-2-t2.nc: rough outline, with tool 2 in the spindle" in told


def test_a_machine_that_changes_tools_has_one_program() -> None:
    product = camgeo.loads(with_two_tools("linuxcnc")).disc
    assert WRITER.pieces(product) == (product,)


def test_the_whole_is_never_written_into_one_file(design: Design) -> None:
    with pytest.raises(SceneError, match="cannot change tools"):
        WRITER.write(design.disc, 0.01)


@pytest.mark.parametrize("end", ["", "-1-t1", "-12-t3"])
def test_names_of_programs_tell_the_disc(end: str) -> None:
    discs = camgeo.load(SCENES / "conjugate_lever.toml").discs
    assert find_disc(discs, f"conjugate_lever{end}") is discs[0]
    assert find_disc(discs, f"conjugate_lever-return{end}") is discs[1]


# Where tools are changed: at the machine's reference, or at a height that is stated ---------------


AWAY = 60.0

HEIGHTS = [name for name in names() if load(name).retract.is_a_height]


def written_for(machine: str, away: float | None) -> str:
    gcode = GcodeSpec(machine=machine, tool_change_height=away)
    # Grbl changes no tools: then one tool does all.
    second = SECOND_TOOL if load(machine).tool_change.change else None
    return WRITER.write(StubProduct(second_tool=second, gcode=gcode), TOLERANCE).data.decode()


def test_some_machines_retract_to_a_height_and_some_do_not() -> None:
    assert {"linuxcnc", "mach3", "grbl"} <= set(HEIGHTS) < set(names())


@pytest.mark.parametrize("machine", HEIGHTS)
@pytest.mark.parametrize("away", [None, AWAY])
def test_tools_are_changed_and_programs_end_there(machine: str, away: float | None) -> None:
    """Reached along Z alone, with the length of the old tool in force."""
    found = run(written_for(machine, away), load(machine))
    assert found.findings == ()
    changes = [each for each in found.events if each.kind == "tool change"][1:]
    assert bool(changes) == (machine != "grbl")
    assert all(each.z == (away or 5.0) for each in changes)
    assert found.moves[-1].z_end == (away or 5.0)
    up = [move for move in found.moves if move.z_end == AWAY]
    assert all(move.start == move.end and move.kind == "rapid" for move in up)


@pytest.mark.parametrize("machine", [name for name in names() if name not in HEIGHTS])
def test_others_go_to_their_reference_all_the_same(machine: str) -> None:
    assert written_for(machine, AWAY) == written_for(machine, None)


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
    own = with_two_tools(machine)
    if stated:
        own = own.replace(f'"{machine}"', f'"{machine}"\ntool_change_height = 60')
    milled = camgeo.loads(own).disc.milled
    found = milled.findings(milled.toolpath(0.01), 0.01)
    low = [each for each in found if each.name == "tool-change-height"]
    assert [each.severity for each in low] == (["warning"] if told else [])
