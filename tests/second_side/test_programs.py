"""Programs of a second side: written, read back, climbing on the machine, and damaged."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final

import numpy as np
import pytest

from camgeo.design.product import Product, disc_of, programs_of, sides_of
from camgeo.milling.holding import mirrored
from camgeo.milling.machine import load, names
from camgeo.milling.moves import ArcFeed
from camgeo_export.gcode.writer import WRITER, budget
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import bench_of
from tests.draws.jobs import read
from tests.interpreter.stated import failing
from tests.second_side.scenes import (
    FACED,
    FROM_BELOW,
    HALVES,
    TOLERANCE,
    design,
    scene,
    second,
)

PRINTED: Final = 2e-4
"""Steps of the last decimal [mm], of an end and of the zero."""

SEPARATE: Final = "grbl"
"""A controller for which each run of a tool is a program."""

EDGE: Final = """[[second_side.operation]]
kind = "chamfer"
boundary = "outline"
tool = 5
size = 0.3
"""

KNOWN: Final[dict[tuple[str, str], str]] = {}
"""Programs by the hash of their scene and their name."""


def written(product: Product) -> str:
    key = (product.scene_hash, product.name)
    if key not in KNOWN:
        KNOWN[key] = WRITER.write(product, TOLERANCE).data.decode()
    return KNOWN[key]


def failures(product: Product, text: str) -> list[str]:
    return [check.name for check in failing(product, text.encode())]


def compensated(about: str, mode: str = "wear", direction: str = "climb") -> Product:
    words = f'compensation = "{mode}"'
    return second(scene(FROM_BELOW, about=about, direction=direction, compensation=words))


def clean_and_verified(machine: str, tables: str, about: str) -> None:
    """Each program of both sides by itself, and both as what leaves the part."""
    profile = load(machine)
    disc = design(scene(tables, machine, about=about)).disc
    pieces = WRITER.pieces(disc)
    assert len({each.name for each in pieces}) == len(pieces) >= 2
    for piece in pieces:
        text = written(piece)
        assert run(text, profile, bench_of(piece, profile)).findings == ()
        assert WRITER.measure(piece, text.encode()) <= TOLERANCE
        assert failures(disc, text) == []


def test_programs_of_both_sides_are_clean_and_verify() -> None:
    clean_and_verified(SEPARATE, FROM_BELOW + EDGE, "x")


@pytest.mark.parametrize(("machine", "tables"), [("linuxcnc", FACED), ("haas", HALVES)])
def test_programs_of_other_jobs_are_clean_and_verify(machine: str, tables: str) -> None:
    clean_and_verified(machine, tables, "y")


# Dialects and tool changes of all controllers are those of the programs of one side, which
# `tests/end_to_end` writes, reads and verifies for each.
@pytest.mark.long
@pytest.mark.parametrize("machine", [name for name in names() if name != SEPARATE])
def test_programs_for_other_controllers_are_clean_and_verify(machine: str) -> None:
    clean_and_verified(machine, FROM_BELOW + EDGE, "x")


def test_programs_are_named_and_numbered_apart() -> None:
    """On a machine that cannot change tools each run of one is a program of its side."""
    pieces = WRITER.pieces(design(scene(FROM_BELOW + EDGE, "grbl")).disc)
    assert [each.name for each in pieces] == [
        "both",
        "both-second-side-1-t4",
        "both-second-side-2-t5",
    ]
    pieces = WRITER.pieces(design(scene(FROM_BELOW, "fanuc")).disc)
    assert [each.name for each in pieces] == ["both", "both-second-side"]
    numbers = [re.search(r"^O(\d+)", written(each), re.MULTILINE) for each in pieces]
    assert [found[1] for found in numbers if found] == ["0001", "0003"]


def test_a_file_belongs_to_its_disc_by_its_name() -> None:
    disc = design(scene(FACED)).disc
    for name in ("both", "both-second-side", "both-second-side-2-t5", "BOTH-SECOND-SIDE"):
        assert disc_of([disc], name) is disc


def arcs_of(product: Product, tolerance: float) -> list[ArcFeed]:
    """Those that are planned and printed as arcs: no flatter than chords may be."""
    operations = product.milled.toolpath(tolerance).operations
    moves = [move for each in operations for move in each.travel]
    return [move for move in moves if isinstance(move, ArcFeed)]


@pytest.mark.parametrize(("about", "mode"), [("x", "wear"), ("y", "computed")])
def test_a_program_read_back_is_the_planned_path(about: str, mode: str) -> None:
    """Its arcs are those that are planned, one by one, and printed they are in the mirror."""
    product = compensated(about, mode)
    machine, zero = load("linuxcnc"), product.milled.zero
    assert zero.turned == about
    found = run(written(product), machine, bench_of(product, machine))
    planned = arcs_of(product, budget(machine, "mm", TOLERANCE).fit)
    printed = [move for move in found.moves if move.kind == "arc"]
    inside = [move for move in found.in_the_part(zero).moves if move.kind == "arc"]
    assert len(planned) == len(printed) > 30
    for move, own, expected in zip(printed, inside, planned, strict=True):
        end = complex(*expected.end[:2])
        assert abs(own.end - end) <= PRINTED
        assert abs(own.z_end - expected.end[2]) <= PRINTED
        assert (own.sweep > 0.0) == expected.ccw
        # On the machine it is seen from the corner, in the mirror.
        assert abs(move.end - mirrored(end - zero.place, about)) <= PRINTED
        assert abs(move.z_end - (expected.end[2] - zero.z)) <= PRINTED
        assert (move.sweep > 0.0) != expected.ccw
        assert {move.compensation, own.compensation} in ({""}, {"left", "right"})


def turned_about_its_middle(text: str, operation: str) -> float:
    """Twice the area [mm^2] around which the printed ends of an operation turn, positive
    counter-clockwise; read word by word, by nothing of camgeo's.
    """
    (ran,) = (each for each in read(text) if each.name == operation)
    places = np.array([complex(*move[-1, :2]) for move in ran.moves])
    arms = places - np.mean(places)  # leads turn about themselves, little
    return float(np.sum((np.conj(arms[:-1]) * arms[1:]).imag))


@pytest.mark.parametrize(
    ("about", "direction", "sign", "word", "other"),
    [("x", "climb", -1.0, "G41", "G42"), ("y", "conventional", 1.0, "G42", "G41")],
)
def test_the_machine_climbs(about: str, direction: str, sign: float, word: str, other: str) -> None:
    """M3 turns the cutter clockwise: it climbs with the material on its right, which around an
    outline is clockwise, whichever side of the part lies up. G41 keeps it on the left of its path.
    """
    product = compensated(about, direction=direction)
    text = written(product)
    assert "M3" in text
    for name in ("rough outline", "outline"):
        assert sign * turned_about_its_middle(text, name) > 1000.0
    assert word in text
    assert other not in text
    assert failures(product, text) == []


def test_the_first_side_climbs_in_its_bore() -> None:
    """The oracle of the test above, on a side of which nobody doubts it."""
    first, _ = sides_of(design(scene(FACED)).disc)
    text = written(first)
    assert turned_about_its_middle(text, "outline") < -1000.0
    assert turned_about_its_middle(text, "bore") > 50.0


def swapped(text: str, one: str, other: str) -> str:
    return text.replace(one, "@").replace(other, one).replace("@", other)


def reflected(text: str) -> str:
    """With all Y of the other sign."""
    return re.sub(r"Y(-?)(\d)", lambda found: f"Y{'' if found[1] else '-'}{found[2]}", text)


DAMAGE: Final[dict[str, Callable[[str], str]]] = {
    "the sense of all arcs": lambda text: swapped(text, "G2 ", "G3 "),
    "compensation on the other side": lambda text: text.replace("G41", "G42"),
    "not turned over": reflected,
    "deeper": lambda text: text.replace("Z-0.3000", "Z-0.8000"),
    "a shallow end": lambda text: text.replace("Z-0.3000", "Z0.3000"),
    "a traverse in the work": lambda text: text.replace("G0 Z9.0000", "G0 Z2.0000"),
    "spindle backwards": lambda text: text.replace("M3", "M4"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_a_damaged_program_does_not_verify(name: str) -> None:
    """That the program verifies undamaged, `test_the_machine_climbs` has."""
    product = compensated("x")
    text = written(product)
    wrong = DAMAGE[name](text)
    assert wrong != text
    assert failures(product, wrong) != []


def test_a_program_of_the_other_side_does_not_verify() -> None:
    disc = design(scene(FACED)).disc
    first, other = (written(each) for each in programs_of(disc) + programs_of(sides_of(disc)[1]))
    as_first = re.sub(r"\(second side.*\n(\(back\)\n)?", "", other)
    assert failures(disc, as_first) != []
    one_sided = design(scene(FACED.partition("[second_side]")[0])).disc
    (check,) = failing(one_sided, other.encode())
    assert check.note == "it is for a second side, which the scene does not have"
    assert failures(disc, first) == []


def test_a_first_side_that_leaves_too_much_does_not_verify() -> None:
    """What is left on the upper face is there when both sides are done."""
    disc = design(scene(FACED)).disc
    first, _ = sides_of(disc)
    text = written(first)
    head, mark, rest = text.partition("(operation rough bore)")
    wrong = head.replace("G1 Z0.0000", "G1 Z0.2000") + mark + rest
    assert wrong != text
    assert failures(disc, wrong) != []


def test_the_header_says_how_the_work_lies() -> None:
    first, other = sides_of(design(scene(FROM_BELOW, about="y", direction="conventional")).disc)
    notes = " ".join(run(written(other), load("linuxcnc")).comments)
    how = "the work is turned over about Y: what was on the left is on the right"
    assert f"second side: {how}" in notes
    assert "X 0, Y 0 on the front left corner of the blank, Z 0 on what lies lowest" in notes
    assert "cam axis at X 45 Y 40, lower face of the finished part at Z 6" in notes
    assert "what the first side has left of it" in notes
    own = " ".join(run(written(first), load("linuxcnc")).comments)
    assert "first side: both-second-side follows it" in own
    assert WRITER.write(other, TOLERANCE).facts["side"] == f"second side: {how}"


def test_the_blank_for_graphics_is_as_the_work_lies() -> None:
    _, other = sides_of(design(scene(FROM_BELOW + EDGE, "heidenhain", about="x")).disc)
    low, high = (line for line in written(other).splitlines() if "BLK FORM" in line)
    assert re.search(r"X\+0\S* Y\+0", low)
    assert re.search(r"X\+84\S* Y\+76", high)
