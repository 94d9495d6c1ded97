"""Programs of our writer: nothing is found in them, and they verify.

Writer and interpreter share the profile and no code, so each is a check of the other.
"""

from __future__ import annotations

import cmath
import math
import re
from collections import Counter
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Final

import pytest

from camgeo.app.answers.answer import text as rendered
from camgeo.app.answers.setup import setup_sheet
from camgeo.design.design import Design
from camgeo.design.linting import WorkData
from camgeo.design.product import Product
from camgeo.design.verify import Check, ReadingOptions
from camgeo.errors import FileError, SceneError, ToleranceError
from camgeo.milling.machine import load, names
from camgeo.milling.milling import CORNERS, HEIGHTS, GcodeSpec
from camgeo.scene.scene import parse_scene
from camgeo.units import LengthUnit
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.moves import CutterMove, ProgramRun
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER, program_bench
from tests.export.stub_product import TOOL, StubProduct
from tests.interpreter.programs import (
    CAM,
    SCREWED,
    SKINNED,
    TABBED,
    TOLERANCE,
    failing,
    product_of,
    require_clean,
    written,
)
from tests.judges import rs274
from tests.judges.files import FIXTURES, JOBS, SIX, milled_scenes, products, workshop
from tests.judges.files import TOLERANCE as JUDGED_WITHIN
from tests.judges.paths import difference
from tests.long_form import LONG

# For every profile --------------------------------------------------------------------------------


OTHER = replace(TOOL, number=7, diameter=4.0)


@pytest.mark.parametrize("unit", ["mm", "inch"])
@pytest.mark.parametrize("machine", names())
def test_programs_for_every_profile_are_clean_and_verify(machine: str, unit: LengthUnit) -> None:
    spec = GcodeSpec(machine=machine, coolant="flood", spin_up=1.5)
    second = OTHER if load(machine).tool_change.change else None
    product = StubProduct(gcode=spec, second_tool=second, unit=unit)
    data = WRITER.write(product, TOLERANCE).data
    step = 25.4e-4
    found = run(data, load(machine), WorkData(clearance=spec.clearance_height - step))
    assert (found.findings, found.mm_per_unit) == ((), {"mm": 1.0, "inch": 25.4}[unit])
    assert {move.tool for move in found.moves if move.kind != "rapid"} == (
        {1, 7} if second else {1}
    )
    assert {move.coolant for move in found.moves if move.kind != "rapid"} == {"flood"}
    assert [event.seconds for event in found.events if event.kind == "dwell"] == [1.5, 1.5]
    origin = VERIFIER.origin(data)
    assert origin.version
    assert origin.tolerance is not None
    assert failing(product, data, origin.tolerance) == []
    assert WRITER.measure(product, data) <= origin.tolerance


@pytest.mark.parametrize("machine", names())
def test_only_coordinates_have_the_largest_of_coordinates(machine: str) -> None:
    """A router's spindle turns faster than Grbl's coordinates reach."""
    product = StubProduct(gcode=GcodeSpec(machine=machine), tool=replace(TOOL, spindle_speed=24e3))
    assert run(WRITER.write(product, TOLERANCE).data, load(machine)).findings == ()
    far = {"klartext": "0 BEGIN PGM A MM\n1 L X+{} R0 FMAX\n", "iso": "G21 G90 G0 X{}\n"}
    profile = load(machine)
    ran = run(far[profile.dialect].format(f"{2.0 * profile.numbers.largest:.1f}"), profile)
    assert "number" in {each.rule for each in ran.findings}


@pytest.mark.parametrize("machine", ["linuxcnc", "fanuc", "sinumerik", "heidenhain"])
def test_what_is_said_at_a_stop_is_for_the_operator(machine: str) -> None:
    """It is no part of what a program states of itself."""
    profile, product = load(machine), StubProduct(gcode=GcodeSpec(machine=machine))
    data = WRITER.write(product, TOLERANCE).data
    text = profile.text
    note = f"{text.comment_open}move the clamp{text.comment_close}"
    if text.letters == "upper":
        note = note.upper()
    lines = data.decode().splitlines()
    place = next(k for k, line in enumerate(lines) if "operation outline" in line.lower())
    off, on = profile.spindle.off[0], profile.spindle.clockwise[0].format(speed="3000")
    halted = [*lines[:place], off, note, *profile.program.stop, on, *lines[place:]]
    assert failing(product, "\n".join(halted).encode()) == []


# Of the fixture scenes ----------------------------------------------------------------------------


TOLERANCES: Final = (JUDGED_WITHIN, None, 1e-4, 1e-5) if LONG else (JUDGED_WITHIN,)
"""[mm]; None is that of the scene."""

VERIFIED: Final = "linuxcnc"
"""Profile whose program is verified; `tests/end_to_end` verifies those that scenes state."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return workshop(tmp_path_factory.mktemp("workshop"))


def written_within(product: Product, asked: float) -> tuple[bytes, float]:
    """A program and its tolerance [mm]: the one asked for, or what the machine's decimals allow."""
    try:
        return WRITER.write(product, asked).data, asked
    except ToleranceError as error:
        if "decimals" not in error.reason:
            raise
        reached = error.reached
    assert reached > asked
    return WRITER.write(product, reached).data, reached


def lifted(program: ProgramRun) -> set[str]:
    """Operations that do not make all their cuts one after the other."""
    parts = groupby(program.moves, lambda move: (move.operation, move.kind == "rapid"))
    counts = Counter(name for (name, rapid), _ in parts if not rapid)
    return {name for name, count in counts.items() if count > 1}


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize(
    ("scene", "machine"),
    [
        (scene, machine)
        for k, machine in enumerate(sorted(names()))
        for scene in (milled_scenes() if LONG else [SIX[k % len(SIX)]])
    ],
)
def test_programs_of_fixture_scenes_are_clean_and_verify(
    scene: str, machine: str, tolerance: float | None, folder: Path
) -> None:
    profile = load(machine)
    for product in products(folder, scene, machine):
        data, kept = written_within(product, tolerance or product.scene.output.tolerance)
        found = run(data, profile, program_bench(product, profile))
        assert found.findings == ()
        assert lifted(found) <= {cut.name for cut in product.milled.cuts if cut.strategy == "drill"}
        if not (LONG or machine == VERIFIED):  # to measure the path takes half a second
            continue
        assert failing(product, data, kept) == []


def test_the_long_form_has_every_fixture_scene() -> None:
    """All of them state tools, and so have a program."""
    paths = [*FIXTURES.glob("*.toml"), *JOBS.glob("*.toml")]
    assert sorted(milled_scenes()) == sorted(path.stem for path in paths)


# Of scenes that state blank, holding and tools ----------------------------------------------------


MACHINES: Final = ("linuxcnc", "haas", "heidenhain")

CHAMFERING: Final = ("linuxcnc", "fanuc", "heidenhain")

HELD: Final = {"screws": SCREWED, "tabs": TABBED, "onion-skin": SKINNED}


def held_by(held: str, machine: str) -> str:
    return f'{CAM}machine = "{machine}"\n{HELD[held]}'


@pytest.mark.parametrize(
    ("held", "machine"),
    [
        (held, machine)
        for k, held in enumerate(HELD)
        for machine in (MACHINES if LONG else MACHINES[k : k + 1])
    ],
)
def test_programs_of_held_blanks_are_clean_and_verify(held: str, machine: str) -> None:
    text = held_by(held, machine)
    product = product_of(text)
    found = require_clean(product, written(text))
    assert {move.coolant for move in found.moves if move.kind != "rapid"} == {"flood"}
    bench = program_bench(product, load(machine))
    assert bench.stock_top == (1.0 if held == "screws" else 0.0)


def test_from_a_halt_the_cutter_comes_back_above_its_first_point() -> None:
    """The operator may have moved it: no cut goes down before X and Y are said again."""
    text = written(held_by("screws", "linuxcnc")).decode()
    (halt,) = re.finditer(r"^M0$", text, re.MULTILINE)
    after = [line for line in text[halt.end() :].splitlines() if line.startswith("G0")]
    assert re.fullmatch(r"G0 Z15\.0+", after[0])
    assert re.fullmatch(r"G0 X\S+ Y\S+", after[1])
    assert re.fullmatch(r"G0 Z3\.0+", after[2])


@pytest.mark.parametrize("machine", ["linuxcnc", "haas", "sinumerik"])
def test_the_operator_comes_before_anything_is_switched_on(machine: str) -> None:
    text = written(held_by("screws", machine)).decode()
    _, _, operation = text.lower().partition("operation rough outline")
    before, halt, after = operation.partition("m0\n")
    assert halt
    assert "set the screw" in before
    assert "m5" in before
    assert not re.search(r"\bm(3|7|8)\b", before)
    assert re.search(r"\bm3\b.*\bm8\b", after, re.DOTALL)


POINTED: Final = """[[tool]]
number = 5
kind = "chamfer-mill"
diameter = 8
tip_angle = 90
spindle_speed = 6000
feed = 800
plunge_feed = 150
[holding]
kind = "fixture"
through = 0.5
"""

EDGED: Final = {
    "plate": (CAM, ("bore", "outline"), 0.5),
    "groove": (
        CAM.replace("roller_radius = 8", 'roller_radius = 8\ncontact = "groove"').replace(
            "thickness = 6", "thickness = 10\nrim = 110\ngroove_depth = 5"
        ),
        ("bore", "outer flank", "inner flank"),
        0.3,
    ),
}
"""Scenes, the walls whose edges are chamfered, and the size of the chamfers."""


def chamfered(name: str) -> str:
    """Each wall roughed and finished, and its edge chamfered."""
    text, walls, size = EDGED[name]
    operations = [
        f'kind = "{kind}"\ntool = 4\nboundary = "{wall}"\nallowance = {left}'
        for kind, left in (("rough", 0.2), ("finish", 0))
        for wall in walls
    ]
    operations += [
        f'kind = "chamfer"\ntool = 5\nsize = {size}\nboundary = "{wall}"' for wall in walls
    ]
    tables = "".join(f"[[operation]]\n{each}\n" for each in operations)
    return text.replace("[output]", f"{POINTED}{tables}[output]", 1)


@pytest.mark.parametrize(
    ("strategy", "machine"),
    [("trochoidal", "linuxcnc"), ("trochoidal", "heidenhain"), ("spiral", "fanuc")],
)
def test_strategies_of_roughing_are_clean_and_verify(strategy: str, machine: str) -> None:
    own = f'strategy = "{strategy}"\nstepdown = 7\nfeed = 1500'
    rough = f'kind = "rough"\ntool = 4\nboundary = "outline"\nallowance = 0.2\n{own}'
    finish = 'kind = "finish"\ntool = 4\nboundary = "outline"'
    bored = SKINNED.replace("width = 70", "width = 70\nbore = 18")
    tables = f"{bored}[[operation]]\n{rough}\n[[operation]]\n{finish}\n[output]"
    text = f'{CAM.replace("[output]", tables, 1)}machine = "{machine}"\n'
    data = written(text)
    require_clean(product_of(text), data)


@pytest.mark.parametrize(
    ("name", "machine"),
    [
        (name, machine)
        for k, name in enumerate(EDGED)
        for machine in (CHAMFERING if LONG else CHAMFERING[k % 3 : k % 3 + 1])
    ],
)
def test_chamfers_are_clean_and_verify(name: str, machine: str) -> None:
    text = f'{chamfered(name)}machine = "{machine}"\n'
    product, data = product_of(text), written(text)
    require_clean(product, data)
    checks = VERIFIER.checks(product, data, ReadingOptions("a.nc"), TOLERANCE)
    measured = " ".join(check.of for check in checks if check.name == "deviation")
    assert [wall for wall in EDGED[name][1] if f"chamfer {wall}" not in measured] == []


OPERATIONS: Final = """[[operation]]
kind = "rough"
boundary = "outline"
tool = 4
allowance = 0.3
[[operation]]
kind = "finish"
boundary = "outline"
tool = 4
"""

WRONG: Final = (
    (f'machine = "grbl"\ncompensation = "wear"\n{TABBED}',
     'output.gcode.compensation = "wear": must be one of "computed" for Grbl'),
    (f'compensation = "worn"\n{TABBED}',
     'compensation = "worn": must be one of "computed", "wear", "control"'),
    (TABBED + OPERATIONS.replace("allowance = 0.3", 'compensation = "wear"'),
     'operation[1].compensation = "wear": belongs to kind "finish"'),
    (f'{TABBED}{OPERATIONS}compensation = "worn"\n', "operation[2].compensation"),
    (f'machine = "grbl"\n{TABBED}{OPERATIONS}compensation = "control"\n',
     'operation[2].compensation = "control": must be one of "computed" for Grbl'),
    (f'zero = "left"\n{TABBED}',
     'output.gcode.zero = "left": must be one of "axis", "front-left"'),
    (f'zero_height = "top"\n{TABBED}',
     'output.gcode.zero_height = "top": must be one of "part-top"'),
)  # fmt: skip
"""What stands in a scene, and its fault."""


@pytest.mark.parametrize(("tables", "fault"), WRONG)
def test_wrong_values_are_refused_with_their_key(tables: str, fault: str) -> None:
    with pytest.raises(SceneError) as caught:
        parse_scene(f"{CAM}{tables}")
    assert [str(each) for each in caught.value.faults if fault in str(each)], str(caught.value)


# From a zero on the axis or a corner of the blank, on a face of part or blank ---------------------


PLATE: Final = """[stock]
length = 80
width = 70
centre = [3, -2]
top = 1
bottom = 2
[holding]
kind = "clamps"
through = 0.3
[[holding.clamp]]
place = [38, 25]
length = 8
width = 12
height = 8
since = "rough bore"
[[holding.clamp]]
place = [0, 0]
length = 24
width = 24
height = 9
since = "rough outline"
"""

COARSE: Final = CAM.replace("stepover = 3", "stepover = 8")

PLACES: Final = {
    "axis": 0j,
    "front-left": -37 - 37j,
    "front-right": 43 - 37j,
    "back-left": -37 + 33j,
    "back-right": 43 + 33j,
}

LEVELS: Final = {"part-top": 0.0, "part-bottom": -6.0, "blank-top": 1.0, "blank-bottom": -8.0}

COMBINED: Final = [
    ("front-left", "blank-top"),
    ("back-right", "part-bottom"),
    ("axis", "blank-bottom"),
]


def scene_from(machine: str = "linuxcnc", zero: str = "axis", height: str = "part-top") -> str:
    return f'{COARSE}machine = "{machine}"\nzero = "{zero}"\nzero_height = "{height}"\n{PLATE}'


def read(text: str, machine: str) -> ProgramRun:
    return run(written(text), load(machine), program_bench(product_of(text), load(machine)))


def test_all_corners_and_faces_are_where_they_say() -> None:
    assert set(PLACES) == {"axis", *CORNERS}
    assert set(LEVELS) == set(HEIGHTS)
    for name, place in PLACES.items():
        for height, z in LEVELS.items():
            zero = product_of(scene_from(zero=name, height=height)).milled.zero
            assert (zero.place, zero.z) == (place, z)
            assert zero.to_program(place) == 0j


@pytest.mark.parametrize(
    ("machine", "zero", "height"),
    [
        (name, *COMBINED[k % len(COMBINED)])
        for k, name in enumerate(names() if LONG else ("linuxcnc", "heidenhain", "sinumerik"))
    ],
)
def test_programs_from_any_zero_are_clean_and_verify(machine: str, zero: str, height: str) -> None:
    text = scene_from(machine, zero, height)
    require_clean(product_of(text), written(text))


@pytest.mark.parametrize("machine", ["linuxcnc", "heidenhain"])
def test_the_path_is_that_of_the_axis_moved(machine: str) -> None:
    """To rounding: both are printed with four decimals."""
    own = read(scene_from(machine), machine)
    moved = read(scene_from(machine, "front-left", "blank-top"), machine)
    place, z = PLACES["front-left"], LEVELS["blank-top"]
    pairs = list(zip(own.moves, moved.moves, strict=True))
    assert len(pairs) > 50
    for one, other in pairs:
        assert one.kind == other.kind
        for a, b in ((one.end, other.end), (one.start, other.start)):
            assert cmath.isnan(a) or abs(a - place - b) < 2e-4
        assert one.z_end == other.z_end == math.inf or abs(one.z_end - z - other.z_end) < 2e-4
        if one.kind == "arc":
            assert abs(one.centre - place - other.centre) < 4e-4


def test_a_program_for_another_zero_does_not_verify() -> None:
    own = product_of(scene_from(zero="front-left"))
    for other in (
        scene_from(zero="front-right"),
        scene_from(zero="front-left", height="blank-top"),
    ):
        assert failing(own, written(other))


def test_program_sheet_and_certificate_say_where_it_is() -> None:
    text = scene_from(zero="front-left", height="blank-top")
    disc = product_of(text)
    sentence = "X 0, Y 0 on the front left corner of the blank, Z 0 on the upper face of the blank"
    notes = " ".join(run(written(text), load("linuxcnc")).comments)
    assert f"unit mm, {sentence}" in notes
    assert "cam axis at X 37 Y 37, upper face of the finished disc at Z -1" in notes
    assert "operation bore depths -7.3000" in notes
    assert WRITER.write(disc, TOLERANCE).facts["zero"] == sentence
    sheet = setup_sheet(Design(disc.scene), TOLERANCE)
    assert sheet.zero == sentence
    assert sheet.steps[-1].lowest == pytest.approx(-7.3)
    shown = rendered(sheet)
    assert "its upper face at Z 0, its middle at X 40, Y 35" in shown
    assert "clamp at 75, 62 mm, top at Z 7" in shown


def test_the_blank_is_named_and_drawn_by_the_control() -> None:
    """In the program's coordinates; a blank whose outline is not known has no box."""
    lines = written(scene_from("heidenhain", "front-left", "blank-top")).decode().splitlines()
    assert lines[1:3] == [
        "1 BLK FORM 0.1 Z X+0.0000 Y+0.0000 Z-9.0000",
        "2 BLK FORM 0.2 X+80.0000 Y+70.0000 Z+0.0000",
    ]
    for machine in names() if LONG else ("linuxcnc", "heidenhain", "grbl", "fanuc"):
        notes = " ".join(run(written(scene_from(machine)), load(machine)).comments).lower()
        said = "plate, 80 x 70 mm, 9 mm high, its upper face at z 1"
        assert f"blank: {said}" in notes.replace("_", ":")
    text = f'{CAM}machine = "heidenhain"\n[holding]\nkind = "fixture"\nthrough = 0.3\n'
    unknown = written(text).decode()
    assert "BLK FORM" not in unknown
    assert "blank: plate of unstated size, 6 mm high" in unknown


def test_on_the_axis_and_the_finished_face_nothing_is_said_that_was_not() -> None:
    notes = run(written(scene_from()), load("linuxcnc")).comments
    assert "unit mm, Z 0 on the upper face, origin on the cam axis" in notes
    assert not any("cam axis at" in note for note in notes)


def test_a_corner_needs_a_blank_that_has_it() -> None:
    """Of a round one `tests.toolpath.test_wrongs` says so."""
    held = '[holding]\nkind = "fixture"\nthrough = 0.3\n'
    (fault,) = parse_scene(f'{CAM}zero = "front-left"\n{held}').lacking([WRITER.format])
    needed = '[stock] length and width of a plate, for output.gcode.zero = "front-left"'
    assert needed in fault.message


def test_a_program_is_run_in_the_blank_of_the_scene_from_its_zero() -> None:
    machine = load("linuxcnc")
    own, other = (
        scene_from(zero=zero, height="blank-top") for zero in ("front-left", "front-right")
    )
    assert VERIFIER.worked(product_of(own), written(own), machine) == ()
    assert VERIFIER.worked(product_of(other), written(own), machine)


# Whose finishes run under the control's compensation: written, read, run by LinuxCNC --------------


HAVE: Final = tuple(name for name in names() if load(name).compensation is not None)

CHUCKED: Final = """[stock]
shape = "round"
diameter = 53
bore = 18
[holding]
kind = "fixture"
through = 0.3
"""

COMPENSATED: Final = {"wear": TABBED, "control": CHUCKED}

NOMINAL: Final = {"linuxcnc": "G41 D4", "heidenhain": "DR-0.19685", "sinumerik": "OFFN=-0.19685"}
"""What a finish of a tool of 10 mm states in inches."""

FINISHES: Final = {"wear": ("bore", "outline"), "control": ("outline",)}


def scene(mode: str, machine: str = "linuxcnc") -> str:
    return f'{CAM}machine = "{machine}"\ncompensation = "{mode}"\n{COMPENSATED[mode]}'


def product(mode: str, machine: str = "linuxcnc") -> Product:
    return product_of(scene(mode, machine))


def program(mode: str, machine: str = "linuxcnc") -> str:
    return written(scene(mode, machine)).decode()


def checks(mode: str, machine: str, text: str) -> list[Check]:
    reading = ReadingOptions("a.nc")
    return list(VERIFIER.checks(product(mode, machine), text.encode(), reading, TOLERANCE))


LENGTHS: Final = re.compile(
    r"^(base_radius|roller_radius|to|thickness|bore|diameter|flute_length|feed|plunge_feed|stepdown"
    r"|stepover|clearance_height|retract_height|through|width|height) = ([\d.]+)$",
    re.MULTILINE,
)


@pytest.mark.parametrize("machine", NOMINAL if LONG else ["sinumerik"])
def test_programs_in_inches(machine: str) -> None:
    text = LENGTHS.sub(
        lambda found: f"{found[1]} = {float(found[2]) / 25.4:.7f}", scene("wear", machine)
    )
    text += '[units]\nlength = "inch"\n'
    require_clean(product_of(text), written(text))
    assert NOMINAL[machine] in written(text).decode()


def bad(mode: str, machine: str, text: str) -> list[str]:
    return [check.name for check in failing(product(mode, machine), text.encode())]


def compensated(found: ProgramRun) -> list[CutterMove]:
    return [move for move in found.moves if move.compensation]


@pytest.mark.parametrize(
    ("machine", "mode"),
    [
        (machine, mode)
        for k, machine in enumerate(HAVE)
        for mode in (COMPENSATED if LONG else [[*COMPENSATED][k % len(COMPENSATED)]])
    ],
)
def test_programs_are_clean_verify_and_measure(machine: str, mode: str) -> None:
    text = program(mode, machine)
    found = require_clean(product(mode, machine), text.encode())
    told = [check.of for check in checks(mode, machine, text) if check.name == "compensation"]
    assert tuple(told) == FINISHES[mode] == tuple({m.operation: 0 for m in compensated(found)})


@pytest.mark.parametrize("machine", HAVE if LONG else ("linuxcnc", "heidenhain"))
def test_without_wear_the_path_is_the_computed_one(machine: str) -> None:
    """What is programmed for wear is the centre's path; only the leads differ."""
    disc, profile = product("wear", machine), load(machine)
    plain = Design(disc.scene.with_values({"output.gcode.compensation": "computed"})).discs[0]
    bench = program_bench(disc, profile)
    own = run(WRITER.write(plain, TOLERANCE).data.decode(), profile, bench)
    worn = run(program("wear", machine), profile, bench)
    for name in FINISHES["wear"]:
        first, second = (
            [loop.contour for loop in each.loops() if loop.operation == name]
            for each in (own, worn)
        )
        assert len(first) == len(second) > 0
        for one, other in zip(first, second, strict=True):
            assert {*one.vertices.tolist()} == {*other.vertices.tolist()}


@pytest.mark.parametrize("off", [0.1, -0.1, 0.3])
def test_with_wear_the_path_is_the_exact_parallel(off: float) -> None:
    found = run(program("wear"), load("linuxcnc")).centred(lambda _: off)
    for cut in product("wear").milled.contour_cuts:
        loops = [loop for loop in found.loops(1e-3) if loop.operation == cut.name]
        if cut.name not in FINISHES["wear"]:
            continue
        parallel = cut.centre.offset(off)
        assert loops
        for loop in loops:
            assert parallel.deviation(loop.contour.counter_clockwise()) <= TOLERANCE


@pytest.mark.parametrize(
    ("mode", "off"),
    [("wear", 0.0), ("wear", 0.1), ("wear", -0.1), ("control", 5.0), ("control", 5.2)],
)
def test_linuxcnc_runs_the_same_path(mode: str, off: float) -> None:
    """With the diameter of the offset stated in place of its number."""
    if reason := rs274.absent():
        pytest.skip(reason)
    text = program(mode).replace("G41 D4", f"G41.1 D{2.0 * off:g}")
    legs, said = rs274.run(text)
    assert said == ""
    assert difference(run(text, load("linuxcnc")).centred(lambda _: off), legs) < 1e-9


def test_linuxcnc_runs_what_the_program_allows() -> None:
    """With the largest offset of each operation, either way, it refuses nothing."""
    if reason := rs274.absent():
        pytest.skip(reason)
    text = program("wear")
    limits = re.findall(r"wear at most ([\d.]+) mm", text.replace(")\n(", " "))
    assert len(limits) == len(FINISHES["wear"])
    for sign in (2.0, -2.0):
        worn = text
        for limit in limits:
            worn = worn.replace("G41 D4", f"G41.1 D{sign * float(limit):g}", 1)
        assert rs274.run(worn)[1] == ""


WORDS: Final = {
    "fanuc": ("wear", "G1 G41 D4 X", "G1 G40 X"),
    "haas": ("wear", "G1 G41 D4 X", "G1 G40 X"),
    "heidenhain": ("wear", "TOOL CALL 4 Z S3000 DR-5.0000", " RL "),
    "linuxcnc": ("control", "G1 G41 D4 X", "G1 G40 X"),
    "mach3": ("wear", "G1 G41 D4 X", "G1 G40 X"),
    "sinumerik": ("wear", "G1 G41 OFFN=-5.0000 X", "G1 G40 OFFN=0 X"),
}


@pytest.mark.parametrize("machine", HAVE)
def test_the_words_are_those_of_each_machine(machine: str) -> None:
    mode, *words = WORDS[machine]
    counts = [program(mode, machine).count(word) for word in words]
    assert min(counts) >= len(FINISHES[mode])


def test_a_path_that_the_control_computes_has_no_nominal_radius() -> None:
    assert "OFFN=-" not in program("control", "sinumerik")
    assert "DR-5" not in program("control", "heidenhain").replace("DR- ", "")


@pytest.mark.parametrize(
    ("mode", "machine", "said"),
    [
        ("wear", "linuxcnc", "D4 holds twice the wear alone, 0 for a new cutter"),
        ("wear", "fanuc", "D4 HOLDS THE WEAR ALONE"),
        ("wear", "sinumerik", "tool 4 holds the radius that is measured, 5 mm nominally"),
        ("control", "linuxcnc", "offset 4 holds the diameter that is measured, 10 mm"),
    ],
)
def test_the_operator_is_told_what_the_offset_holds(mode: str, machine: str, said: str) -> None:
    notes = " ".join(run(program(mode, machine), load(machine)).comments)
    assert said in " ".join(re.findall(r"(?i)(compensation (?:wear|control):.*?either way)", notes))


@pytest.mark.parametrize(
    ("machine", "change"),
    [
        ("linuxcnc", ("G41 D4 ", "")),  # never on
        ("linuxcnc", ("G41", "G42")),  # the other side
        ("linuxcnc", ("G41 D4", "G41 D5")),  # another offset
        ("linuxcnc", ("G1 G40", "G1")),  # never off
        ("heidenhain", (" DR-5.0000", "")),  # the whole radius on top of the computed path
        ("sinumerik", ("OFFN=-5.0000", "OFFN=-4.0000")),
        ("linuxcnc", ("most 0.", "most 2.")),  # more than there is room for
    ],
)
def test_a_program_compensated_in_another_way_does_not_verify(
    machine: str, change: tuple[str, str]
) -> None:
    text = program("wear", machine)
    assert change[0] in text
    changed = text.replace(*change)
    assert set(bad("wear", machine, changed)) & {"compensation", "arcs", "frame"}
    with pytest.raises(FileError):
        WRITER.measure(product("wear", machine), changed.encode())


def test_what_is_told_of_the_wear_holds_and_not_much_more() -> None:
    """The control accepts it either way, and none three times as large."""
    (bore, outline) = re.findall(r"wear at most ([\d.]+) mm", program("wear").replace(")\n(", " "))
    for name, most in (("bore", bore), ("outline", outline)):
        own = [check for check in checks("wear", "linuxcnc", program("wear")) if check.of == name]
        assert any(f"{float(most):g} mm" in check.note for check in own)
    said = f"wear at most {outline} mm"
    assert said in program("wear")
    thrice = program("wear").replace(said, f"wear at most {3.0 * float(outline):.3f} mm")
    assert bad("wear", "linuxcnc", thrice)[0] == "compensation"


@pytest.mark.parametrize(("own", "keys"), [("wear", ""), ("computed", 'compensation = "wear"\n')])
def test_an_operation_says_its_own(own: str, keys: str) -> None:
    cuts = product_of(f'{CAM}{keys}{CHUCKED}{OPERATIONS}compensation = "{own}"\n')
    assert [cut.compensation for cut in cuts.milled.contour_cuts] == [own]
