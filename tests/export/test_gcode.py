"""G-code: the program run again follows the path, and keeps the rules of every controller."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import FileError, SceneError, ToleranceError
from camgeo.milling import machine as machines
from camgeo.milling.machine import Machine
from camgeo.milling.milling import GcodeSpec, Heights
from camgeo.milling.moves import ArcFeed, Feed, Operation, Rapid, Stop, Toolpath
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
    numbered,
    written,
)
from camgeo_export.interpreter.moves import Run
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER
from tests.export.stub_product import TOOL, StubProduct

LINUXCNC = machines.load("linuxcnc")

LINUXCNC_FILE = Path(machines.__file__).parent / "machines" / "linuxcnc.toml"

NAMES = machines.names()

TOLERANCES = [0.05, 0.01, 1e-3, 1e-6]


def program_of(product: StubProduct, tolerance: float) -> tuple[str, Run]:
    text = WRITER.write(product, tolerance).data.decode()
    return text, run(text, LINUXCNC)


@pytest.mark.parametrize("unit", ["mm", "inch"])
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_rules_of_controllers(unit: LengthUnit, tolerance: float) -> None:
    text, program = program_of(StubProduct(unit=unit), tolerance)
    lines = text.splitlines()
    assert max(map(len, lines)) <= 78
    assert not re.search(r"^N|G41|G42|%|[a-z]|-0\.0+\b", re.sub(r"\(.*?\)", "", text), re.M)
    assert text.isascii()
    assert lines[-2:] == ["M5", "M2"]
    for move in program.moves:
        if move.kind == "arc":
            assert abs(move.sweep) <= math.pi + 1e-3
            assert move.mismatch <= 3.0 * program.step
    assert program.findings == ()


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
    assert loops[0].contour.area == pytest.approx(math.pi * 7.0**2, rel=1e-4)
    assert loops[2].contour.area == pytest.approx(-math.pi * 35.0**2, rel=1e-4)


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
        ("M2\n", "", "does not end"),
        ("(operation outline)", "(operation rim)", "does not have"),
        ("T1 M6", "T2 M6", "the length of tool 1 is put into force with tool 2"),
        ("T1 M6\nG43 H1", "T2 M6\nG43 H2", "'bore' is cut with tool 2, not 1"),
        ("T1 M6", "M6", "a change of the tool without its number"),
        ("G1 Z-8.0000 F100", "G1 Z-7.0000 F100", "no closed path of 'bore' at Z -8"),
        ("G17 ", "", "cut without G17"),
        ("G91.1", "G90.1", "the radii of the arc differ"),
        ("M5\nM2", "M19\nM5\nM2", "M19, an angle of the spindle, is outside what is read"),
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


def test_a_moved_point_is_found() -> None:
    text, _ = program_of(StubProduct(), 0.001)
    point = re.search(r"G2 X(\S+) Y(\S+) I(\S+) J(\S+)\n", text)
    assert point is not None
    moved = text.replace(f"X{point[1]} Y{point[2]} ", f"X{float(point[1]) + 0.5:.5f} Y{point[2]} ")
    with pytest.raises(FileError, match="radii of the arc differ"):
        WRITER.measure(StubProduct(), moved.encode())
    other, _ = program_of(StubProduct(second_tool=replace(TOOL, number=7)), 0.001)
    with pytest.raises(FileError, match="'outline' is cut with tool 7, not 1"):
        WRITER.measure(StubProduct(), other.encode())


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
    ],
)
def test_numbers_that_no_machine_has(tmp_path: Path, key: str, line: str, message: str) -> None:
    product = profile(tmp_path, **{key: line})
    with pytest.raises(SceneError, match=re.escape(message)):
        WRITER.write(product, 0.01)


def test_a_line_too_short_for_a_block_is_reported(tmp_path: Path) -> None:
    product = profile(tmp_path, line_length="line_length = 20")
    with pytest.raises(SceneError, match="line_length is too short for the block G17"):
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


TOLERANCE = 0.01

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


@pytest.mark.parametrize("name", NAMES)
def test_lines_and_comments_are_as_the_controller_reads_them(name: str) -> None:
    machine = machines.load(name)
    product = StubProduct(name="a(b) ü!?~%; " + "x" * 90, gcode=spec(name))
    data = WRITER.write(product, TOLERANCE).data
    assert data.isascii()
    for line in data.decode().splitlines():
        assert len(line) <= machine.text.line_length <= machine.text.longest_line
        inner = line.partition(machine.text.comment_open)[2].removesuffix(
            machine.text.comment_close
        )
        assert not set(inner) & {*"()", *machine.text.forbidden}
        if machine.text.letters == "upper":
            assert line == line.upper()


@pytest.mark.parametrize("name", NAMES)
def test_each_operation_states_all_that_it_needs(name: str) -> None:
    """From its comment to its first cut: state, tool, length, spindle, dwell, height, coolant."""
    machine, lines = machines.load(name), lines_of(name)
    second = positions(lines, r"(?i)operation outline")[0]
    cut = next(k for k in range(second, len(lines)) if re.match(r"G1 |L .*F\d", lines[k]))
    head = lines[second:cut]

    def stated(blocks: tuple[str, ...]) -> int:
        plain = (re.escape(block.replace(" {nominal}", "")) for block in blocks)
        patterns = (re.sub(r"\\\{\w+\\\}", ".+", block) for block in plain)
        found = [positions(head, f"^{pattern}$") for pattern in patterns]
        assert all(found), (blocks, head)
        return found[0][0]

    for block in machine.program.safe_start:
        if block != "{work_offset}" or next(iter(machine.work_offsets.values())):
            stated((block,))
    start = stated(machine.spindle.clockwise)
    assert start < stated(machine.dwell.blocks)
    assert machine.coolant.flood is not None
    assert start < stated(machine.coolant.flood)
    off = stated(machine.coolant.off)
    assert off < start
    if change := machine.tool_change.change:
        assert off < stated(machine.spindle.off) < stated(change) < start
        if machine.tool_change.length_offset:
            assert stated(change) < stated(machine.tool_change.length_offset)
        if not any("{z}" in block for block in machine.retract.blocks):
            assert stated(machine.retract.blocks) < stated(change)
    across = positions(head, r"X.*Y")[0]
    down = positions(head, r"Z[-+]?5\.0")[-1]
    assert (across < down) == (machine.tool_change.approach == "xy-first")
    assert re.search(r"F\d", lines[cut])


def test_dwells_are_in_the_unit_of_the_controller() -> None:
    found = {name: next(each for each in lines_of(name) if re.match(r"G4 |CYCL DEF 9.1", each))
             for name in NAMES}  # fmt: skip
    assert found == {
        "fanuc": "G4 P1500", "grbl": "G4 P1.5", "haas": "G4 P1500", "linuxcnc": "G4 P1.5",
        "heidenhain": "CYCL DEF 9.1 DWELL 1.5", "mach3": found["mach3"], "sinumerik": "G4 F1.5",
    }  # fmt: skip


def test_numbers_of_blocks() -> None:
    haas = machines.load("haas")
    text = replace(haas.text, line_numbers=5)
    lines = numbered(["%", "O0001 (X)", "(Y)", "G21", "M30", "%"], replace(haas, text=text))
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
    with pytest.raises(SceneError, match="tools 1 and 7 are needed: write one for each") as caught:
        WRITER.write(StubProduct(gcode=spec("grbl"), second_tool=OTHER), TOLERANCE)
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("output.gcode.machine", "'Grbl'")


def printed(path: Toolpath, machine: Machine, coolant: str = "off") -> Program:
    setup = Setup("x", "mm", "G54", coolant, 0.0)
    return written(path, machine, budget(machine, "mm", 0.01), setup, ())


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
    second = positions(lines, r"T7")[0]
    assert positions(lines[:second], r"^M[789]$")
    assert [line for line in lines if re.fullmatch("M[789]", line)] == ["M7", "M9"]
    with pytest.raises(SceneError) as caught:
        WRITER.write(replace(product, gcode=GcodeSpec(machine="grbl")), TOLERANCE)
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("tool.coolant", "'mist'")


def test_what_a_machine_does_not_have_is_refused() -> None:
    with pytest.raises(SceneError) as caught:
        WRITER.write(StubProduct(gcode=GcodeSpec(machine="grbl", coolant="through")), 0.01)
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("output.gcode.coolant", "'through'")
    assert '"off", "flood"' in fault.message
    both = GcodeSpec(machine="sinumerik", work_offset="G59", coolant="through")
    with pytest.raises(SceneError) as caught:
        WRITER.write(StubProduct(gcode=both), 0.01)
    assert [each.key for each in caught.value.faults] == [
        "output.gcode.coolant", "output.gcode.work_offset",
    ]  # fmt: skip


def test_a_coordinate_that_the_controller_does_not_read() -> None:
    product = StubProduct(gcode=GcodeSpec(machine="grbl"), scale=1000.0)
    with pytest.raises(SceneError, match=r"numbers\.largest is too small for the coordinate 3"):
        WRITER.write(product, 0.5)


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
