"""G-code: the program run again follows the path, and keeps the rules of controllers."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.design.verify import Origin, Reading
from camgeo.errors import FileError, SceneError, ToleranceError
from camgeo.milling import machine as machines
from camgeo.milling.milling import GcodeSpec
from camgeo.milling.moves import ArcFeed, Feed, Rapid
from camgeo.units import LengthUnit
from camgeo_export.gcode.comments import Budget, Grid, budget
from camgeo_export.gcode.writer import WRITER, Iso, Speller
from camgeo_export.interpreter.run import Run, run
from camgeo_export.verify.gcode import VERIFIER
from tests.export.stub_product import TOOL, StubProduct

LINUXCNC = machines.load("linuxcnc")

LINUXCNC_FILE = Path(machines.__file__).parent / "machines" / "linuxcnc.toml"

TOLERANCES = [0.05, 0.01, 1e-3, 1e-6]


def program_of(product: StubProduct, tolerance: float) -> tuple[str, Run]:
    text = WRITER.write(product, tolerance).data.decode()
    return text, run(text, LINUXCNC)


@pytest.mark.parametrize("unit", ["mm", "inch"])
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_the_budget_holds(unit: LengthUnit, tolerance: float) -> None:
    product = StubProduct(unit=unit)
    written = WRITER.write(product, tolerance)
    assert 0.5 * tolerance < WRITER.measure(product, written.data) <= tolerance
    shares = budget(LINUXCNC, unit, tolerance)
    assert shares.fit + shares.rounding + shares.chord + shares.blending < tolerance


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


def test_frame_of_the_program() -> None:
    text, _ = program_of(StubProduct(), 0.001)
    blocks = [line for line in text.splitlines() if not line.startswith("(")]
    assert blocks[:9] == [
        "G17 G21 G40 G49 G54 G80 G90 G94",
        "G91.1",
        "G61",
        "T1 M6",
        "G43 H1",
        "G0 Z5.0000",
        "S3000 M3",
        "G0 X4.2000 Y-2.8000",
        "G1 Z-4.0000 F100",
    ]
    assert f"(scene {StubProduct().scene_hash})" in text
    assert "(tolerance 0.001 mm)" in text
    assert "(operation outline)" in text


def test_each_operation_can_be_restarted_alone() -> None:
    """It states the modal state, its tool and length, the spindle and the height."""
    first = TOOL
    tools = {
        "same": first,
        "speed": replace(first, spindle_speed=5000.0),
        "other": replace(first, number=7, diameter=4.0),
    }
    state = ["G17 G21 G40 G49 G54 G80 G90 G94", "G91.1", "G61", "M5"]
    for name, tool in tools.items():
        product = StubProduct(second_tool=tool)
        text, program = program_of(product, 0.001)
        lines = text[text.index("(operation outline)") :].splitlines()[2:]
        assert lines[: len(state)] == state, name
        assert lines[len(state) : len(state) + 4] == [
            f"T{tool.number} M6", f"G43 H{tool.number}", "G0 Z5.0000",
            f"S{tool.spindle_speed:.0f} M3",
        ]  # fmt: skip
        across, down = lines[len(state) + 4 : len(state) + 6]
        assert across.startswith("G0 X")
        assert re.fullmatch(r"G1 Z-4\.0000 F100", down)
        assert WRITER.measure(product, text.encode()) <= 0.001
        assert {loop.tool for loop in program.loops()} == {1, tool.number}
    assert "(tool 7: end mill, diameter 4 mm)" in text
    with pytest.raises(FileError, match="'outline' is cut with tool 7, not 1"):
        WRITER.measure(StubProduct(), text.encode())


def test_feed_is_written_first_and_when_it_changes() -> None:
    text, _ = program_of(StubProduct(), 0.001)
    cuts = [line for line in text.splitlines() if re.match("G[123] ", line)]
    feeds = [re.findall("F([0-9.]+)", line) for line in cuts]
    assert feeds[0] == ["100"]
    assert feeds[1] == ["144.83"]  # on an arc of 2.8 mm, with the wall 3 mm around it
    # Once for all of the outline, which the cutter runs around the outside of.
    around = [len(each) for line, each in zip(cuts, feeds, strict=True) if line.startswith("G2")]
    assert around == [1] + 11 * [0] + [1] + 11 * [0]
    stated = [feed for each in feeds for feed in each]
    assert all(feed != before for before, feed in pairwise(stated))


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
    return Speller(Grid(decimals, 1.0), shares, LINUXCNC.arcs, Iso(), LINUXCNC.numbers)


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
    words = Speller(Grid(*grid), shares, LINUXCNC.arcs, Iso(), LINUXCNC.numbers)
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
    product = StubProduct()
    text = WRITER.write(product, 0.001).data.decode()
    assert old in text
    with pytest.raises(FileError, match=message):
        WRITER.measure(product, text.replace(old, new).encode())


def test_a_moved_point_and_a_wrong_radius_are_found() -> None:
    product = StubProduct()
    text = WRITER.write(product, 0.001).data.decode()
    point = re.search(r"G2 X(\S+) Y(\S+) I(\S+) J(\S+)\n", text)
    assert point is not None
    moved = text.replace(f"X{point[1]} Y{point[2]} ", f"X{float(point[1]) + 0.5:.5f} Y{point[2]} ")
    with pytest.raises(FileError, match="radii of the arc differ"):
        WRITER.measure(product, moved.encode())
    larger = replace(product, scale=1.001)
    assert WRITER.measure(larger, text.encode()) > 0.03


def test_a_machine_may_be_a_file(tmp_path: Path) -> None:
    source = Path(machines.__file__).parent / "machines" / "linuxcnc.toml"
    text = source.read_text().replace('end = ["M2"]', 'end = ["M30"]')
    profile = tmp_path / "mill.toml"
    profile.write_text(text.replace("mm = 4", "mm = 6"))
    product = StubProduct(gcode=GcodeSpec(machine=str(profile)))
    written = WRITER.write(product, 0.01)
    assert written.data.endswith(b"M5\nM30\n")
    assert b"X4.200000" in written.data
    assert WRITER.measure(product, written.data) <= 0.01


def profile(tmp_path: Path, **changes: str) -> StubProduct:
    """A product for LinuxCNC with other lines in its profile, by the key they begin with."""
    text = (Path(machines.__file__).parent / "machines" / "linuxcnc.toml").read_text()
    for key, line in changes.items():
        text, count = re.subn(rf"^(# )?{key} = .*$", line, text, flags=re.MULTILINE)
        assert count == 1
    file = tmp_path / "mill.toml"
    file.write_text(text)
    return StubProduct(gcode=GcodeSpec(machine=str(file)))


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
    source = Path(machines.__file__).parent / "machines" / "linuxcnc.toml"
    text = source.read_text()
    file = tmp_path / "mill.toml"
    file.write_text(text[: text.index("[dynamics]")])
    spec = GcodeSpec(machine=str(file))
    assert machines.load(spec.machine).dynamics is None
    assert "machining_time_s" not in WRITER.write(StubProduct(gcode=spec), 0.001).facts
    known = machines.load("linuxcnc").dynamics
    assert known is not None
    assert known.acceleration == 508.0


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


def test_names_are_made_safe_for_comments() -> None:
    text = WRITER.write(StubProduct(name="a(b)ü" + "x" * 90), 0.01).data.decode()
    assert text.startswith("(part a[b]uex")
    assert max(map(len, text.splitlines())) <= 78


def test_comments_up_to_the_end_of_a_line(tmp_path: Path) -> None:
    """Some controllers want comments like this; what they state is read all the same."""
    text = files("camgeo.milling").joinpath("machines", "linuxcnc.toml").read_text("utf-8")
    profile = tmp_path / "semicolon.toml"
    profile.write_text(
        text.replace('open = "("', 'open = "; "').replace('close = ")"', 'close = ""')
    )
    product = StubProduct(gcode=GcodeSpec(machine=str(profile)))
    data = WRITER.write(product, 0.01).data
    assert b"(" not in data
    assert WRITER.measure(product, data) <= 0.01
    assert VERIFIER.origin(data) == Origin(product.version, product.scene_hash, 0.01)
    checks = VERIFIER.checks(product, data, Reading("a.ngc"), 0.01)
    assert all(check.ok is not False for check in checks)
