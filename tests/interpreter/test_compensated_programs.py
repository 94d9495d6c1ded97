"""Programs whose finishes run under the control's compensation: written, read, run by LinuxCNC."""

from __future__ import annotations

import re
from typing import Final

import pytest

from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading
from camgeo.errors import FileError
from camgeo.milling.machine import load, names
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.moves import CutterMove, Run
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER, bench_of
from tests.interpreter.stated import (
    CAM,
    TABBED,
    TOLERANCE,
    failing,
    product_of,
    require_clean,
    written,
)
from tests.interpreter.test_stated_milling import OPERATIONS
from tests.judges import rs274
from tests.judges.paths import difference
from tests.long_form import LONG

HAVE: Final = tuple(name for name in names() if load(name).compensation is not None)

CHUCKED: Final = """[stock]
shape = "round"
diameter = 53
bore = 18
[holding]
kind = "fixture"
through = 0.3
"""

HELD: Final = {"wear": TABBED, "control": CHUCKED}

NOMINAL: Final = {"linuxcnc": "G41 D4", "heidenhain": "DR-0.19685", "sinumerik": "OFFN=-0.19685"}
"""What a finish of a tool of 10 mm states in inches."""

FINISHES: Final = {"wear": ("bore", "outline"), "control": ("outline",)}


def scene(mode: str, machine: str = "linuxcnc") -> str:
    return f'{CAM}machine = "{machine}"\ncompensation = "{mode}"\n{HELD[mode]}'


def product(mode: str, machine: str = "linuxcnc") -> Product:
    return product_of(scene(mode, machine))


def program(mode: str, machine: str = "linuxcnc") -> str:
    return written(scene(mode, machine)).decode()


def checks(mode: str, machine: str, text: str) -> list[Check]:
    reading = Reading("a.nc")
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


def compensated(found: Run) -> list[CutterMove]:
    return [move for move in found.moves if move.compensation]


@pytest.mark.parametrize(
    ("machine", "mode"),
    [
        (machine, mode)
        for k, machine in enumerate(HAVE)
        for mode in (HELD if LONG else [[*HELD][k % len(HELD)]])
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
    bench = bench_of(disc, profile)
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
    found = run(text, load("linuxcnc")).centred(lambda _: off)
    assert difference(found, legs) < 1e-9


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


def test_the_words_are_those_of_each_machine() -> None:
    own = {
        "fanuc": ("wear", "G1 G41 D4 X", "G1 G40 X"),
        "haas": ("wear", "G1 G41 D4 X", "G1 G40 X"),
        "heidenhain": ("wear", "TOOL CALL 4 Z S3000 DR-5.0000", " RL "),
        "linuxcnc": ("control", "G1 G41 D4 X", "G1 G40 X"),
        "mach3": ("wear", "G1 G41 D4 X", "G1 G40 X"),
        "sinumerik": ("wear", "G1 G41 OFFN=-5.0000 X", "G1 G40 OFFN=0 X"),
    }
    assert tuple(sorted(own)) == HAVE
    for machine, (mode, *words) in own.items():
        for word in words:
            assert program(mode, machine).count(word) >= len(FINISHES[mode]), (machine, word)
    assert "OFFN=-" not in program("control", "sinumerik")
    assert "DR-5" not in program("control", "heidenhain").replace("DR- ", "")


def test_the_operator_is_told_what_the_offset_holds() -> None:
    def told(mode: str, machine: str) -> str:
        notes = " ".join(note for note in run(program(mode, machine), load(machine)).comments)
        return " ".join(re.findall(r"(?i)(compensation (?:wear|control):.*?either way)", notes))

    assert "D4 holds twice the wear alone, 0 for a new cutter" in told("wear", "linuxcnc")
    assert "D4 HOLDS THE WEAR ALONE" in told("wear", "fanuc").upper()
    assert "tool 4 holds the radius that is measured, 5 mm nominally" in told("wear", "sinumerik")
    assert "offset 4 holds the diameter that is measured, 10 mm" in told("control", "linuxcnc")


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


def test_an_operation_says_its_own() -> None:
    for own, default, said in (("wear", "", ["wear"]), ("computed", "wear", ["computed"])):
        keys = f'compensation = "{default}"\n' if default else ""
        cuts = product_of(f'{CAM}{keys}{CHUCKED}{OPERATIONS}compensation = "{own}"\n')
        assert [cut.compensation for cut in cuts.milled.contour_cuts] == said
