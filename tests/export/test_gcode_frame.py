"""The blocks of machine profiles around the moves, for every controller."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from camgeo.errors import SceneError, ToleranceError
from camgeo.milling import machine as machines
from camgeo.milling.machine import Machine
from camgeo.milling.milling import GcodeSpec
from camgeo.milling.moves import ArcFeed, Feed, Heights, Operation, Rapid, Stop, Toolpath
from camgeo.milling.tool import Tool
from camgeo.units import LengthUnit
from camgeo_export.gcode.comments import budget
from camgeo_export.gcode.writer import WRITER, Setup, numbered, written
from camgeo_export.verify.gcode import VERIFIER
from tests.export.stub_product import TOOL, StubProduct

NAMES = machines.names()

TOLERANCE = 0.01

OTHER = replace(TOOL, number=7, diameter=4.0)


def spec(name: str) -> GcodeSpec:
    return GcodeSpec(machine=name, coolant="flood", spin_up=1.5)


def second_tool(name: str) -> Tool | None:
    """Another tool, if programs for the machine may have two."""
    return OTHER if machines.load(name).tool_change.change else None


def program(name: str, tolerance: float = TOLERANCE) -> list[str]:
    """The blocks of a program, of two tools if the machine changes them, without their numbers."""
    product = StubProduct(gcode=spec(name), second_tool=second_tool(name))
    lines = WRITER.write(product, tolerance).data.decode("ascii").splitlines()
    numbers = machines.load(name).text.line_numbers is not None
    return [re.sub(r"^N?\d+ (?=\S)", "", line) if numbers else line for line in lines]


def is_comment(line: str, machine: Machine) -> bool:
    return line.startswith(machine.text.comment_open.strip())


def blocks_of(name: str) -> list[str]:
    machine = machines.load(name)
    return [line for line in program(name) if not is_comment(line, machine)]


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
def test_every_coordinate_has_a_decimal_point_and_a_rapid_moves_z_alone(name: str) -> None:
    machine = machines.load(name)
    known = {*machine.retract.blocks, *machine.program.safe_start, *machine.program.start}
    for line in blocks_of(name):
        if line in known or re.match(r"CYCL|TOOL|O\d", line):
            continue
        for letter, value in re.findall(r"([XYZIJ])([-+]?[\d.]+)", line):
            assert "." in value, (letter, line)
        if re.match(r"G0 |L .*FMAX", line):
            assert not re.search(r"[XY]\S+ Z|Z\S+ [XY]", line), line
    if machine.numbers.point == "required":
        feeds = [value for line in blocks_of(name) for value in re.findall(r"F([\d.]+)", line)]
        assert feeds
        assert all("." in value for value in feeds)


@pytest.mark.parametrize("name", NAMES)
def test_each_operation_states_all_that_it_needs(name: str) -> None:
    """From its comment to its first cut: state, tool, length, spindle, dwell, height, coolant."""
    machine, lines = machines.load(name), program(name)
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


@pytest.mark.parametrize("name", NAMES)
def test_a_program_begins_and_ends_as_the_machine_wants(name: str) -> None:
    machine, lines = machines.load(name), blocks_of(name)
    for block, line in zip(machine.program.start, lines, strict=False):
        assert line.startswith(block.partition("{")[0])
    ends = [block.partition("{")[0] for block in machine.program.end]
    for block, line in zip(ends, lines[-len(ends) :], strict=True):
        assert line.startswith(block)
    off = positions(lines, r"M5$")[-1]
    assert positions(lines, r"M9$")[-1] < off
    assert off > max(positions(lines, r"^G[123] |^C "))


def test_dwells_are_in_the_unit_of_the_controller() -> None:
    found = {name: next(each for each in blocks_of(name) if re.match(r"G4 |CYCL DEF 9.1", each))
             for name in NAMES}  # fmt: skip
    assert found == {
        "fanuc": "G4 P1500", "grbl": "G4 P1.5", "haas": "G4 P1500", "linuxcnc": "G4 P1.5",
        "heidenhain": "CYCL DEF 9.1 DWELL 1.5", "mach3": found["mach3"], "sinumerik": "G4 F1.5",
    }  # fmt: skip


def test_numbers_of_blocks() -> None:
    data = WRITER.write(StubProduct(gcode=spec("heidenhain")), TOLERANCE).data.decode()
    assert [line.split()[0] for line in data.splitlines()] == [
        str(index) for index in range(len(data.splitlines()))
    ]
    data = WRITER.write(StubProduct(gcode=spec("sinumerik")), TOLERANCE).data.decode()
    numbers = [int(found) for found in re.findall(r"^N(\d+) ", data, re.MULTILINE)]
    assert numbers == list(range(10, 10 * len(numbers) + 10, 10))
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
    assert not [line for line in blocks_of("grbl") if re.search(r"M6|M0|T\d", line)]
    with pytest.raises(SceneError, match="tools 1 and 7 are needed: write one for each") as caught:
        WRITER.write(StubProduct(gcode=spec("grbl"), second_tool=OTHER), TOLERANCE)
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("output.gcode.machine", "'Grbl'")


def test_a_stop_lifts_the_tool_and_comes_back_from_above() -> None:
    cut = StubProduct().cuts[0]
    moves = (
        Rapid((1.0, 2.0, 5.0)), Feed((1.0, 2.0, -1.0), 100.0), Rapid((1.0, 2.0, 5.0)),
        Stop("move the clamp (left)"), Rapid((1.0, 2.0, 5.0)), Feed((1.0, 2.0, -1.0), 100.0),
        Rapid((1.0, 2.0, 5.0)),
    )  # fmt: skip
    path = Toolpath(Heights.of(5.0), (Operation(cut, moves),))
    found = {}
    for name in ("linuxcnc", "haas", "sinumerik"):
        machine = machines.load(name)
        setup = Setup("x", "mm", "G54", "flood", 0.0)
        lines = written(path, machine, budget(machine, "mm", 0.01), setup, ()).lines
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
    path = Toolpath(Heights.of(5.0), (Operation(first, moves), Operation(second, moves)))
    setup = Setup("x", "mm", "G54", "off", 0.0)
    lines = written(path, machine, budget(machine, "mm", 0.01), setup, ()).lines
    low = positions(lines, r"Z[-+]?1\.0+( R0 FMAX)?$")
    assert len(low) == 2
    if any("{z}" in block for block in machine.retract.blocks):
        assert [lines[place + 1] for place in low] == ["G0 Z5.0000"] * 2
        assert lines[-2:] == ["M5", lines[-1]]
        assert lines.index("G0 Z5.0000", low[0]) < positions(lines, "G49")[-1]
    safe = machine.retract.blocks[0].partition("{")[0]
    assert all(any(line.startswith(safe) for line in lines[place + 1 :]) for place in low)


def test_the_spindle_starts_away_from_the_work() -> None:
    """The cutter may stand on it, where Z was set."""
    for name in ("linuxcnc", "grbl", "mach3"):
        lines = blocks_of(name)
        on, up = positions(lines, r"M3$")[0], positions(lines, r"^G0 Z5\.0")[0]
        assert up < on, name


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


def test_a_feed_in_inches_has_the_unit_of_the_controller() -> None:
    """Of Heidenhain F counts in tenths of an inch per minute, with three decimals."""
    feed = 25.4 * 12.34567
    tool = replace(TOOL, feed=feed)
    found = {}
    for name in ("haas", "linuxcnc", "heidenhain"):
        product = StubProduct(gcode=GcodeSpec(machine=name), unit="inch", second_tool=tool)
        text = WRITER.write(product, 0.05).data.decode()
        found[name] = {each for each in re.findall(r"F([\d.]+)", text) if each.startswith("12")}
    assert found == {"haas": {"12.35"}, "linuxcnc": {"12.35"}, "heidenhain": {"123.457"}}


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
    setup = Setup("x", "mm", "", "off", 0.0)
    shares = budget(machine, "mm", 0.01)
    made = written(Toolpath(Heights.of(5.0), (Operation(cut, moves),)), machine, shares, setup, ())
    assert (made.speller.arcs == 2) == machine.arcs.helical
    if machine.arcs.helical:
        assert any(re.match(r"G3 X-3.0+ Y0.0+ Z-0.50+ I-3.0+ J0.0+", line) for line in made.lines)
        return
    points = [
        complex(*map(float, found)) for line in made.lines
        if line.startswith("L") for found in re.findall(r"X(\S+) Y(\S+) Z", line)
    ]  # fmt: skip
    printed = [re.findall(r"^L X.* Z(\S+) R0", line) for line in made.lines]
    heights = [float(found) for each in printed for found in each]
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
    setup = Setup("x", "mm", "G54", "off", 0.0)
    path = Toolpath(Heights.of(5.0), (Operation(cut, moves),))
    lines = written(path, absolute, budget(absolute, "mm", 0.01), setup, ()).lines
    assert "G3 X10.0000 Y12.0000 I10.0000 J11.0000 F200" in lines
