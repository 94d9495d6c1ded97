"""Discs milled from both sides: programs, answers, and what a scene must state."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
import pytest

from camgeo.app.answers.answer import text, to_json
from camgeo.app.answers.check import check
from camgeo.app.answers.lint import Lint, lint
from camgeo.app.answers.setup import SetupSheet, html, setup_sheet
from camgeo.design.milled import job
from camgeo.design.product import Product, find_disc, product_sides, side_programs
from camgeo.errors import SceneError, UnsafeError
from camgeo.milling.judged import Side, SimulatedSide, side_flaws, simulate_sides, toolpath_runs
from camgeo.milling.machine import load, names
from camgeo.milling.milling import TURNING_NOTE, mirrored
from camgeo.milling.moves import ArcFeed, Point, Stop
from camgeo.milling.polygons import Area as RegionOfPolygons
from camgeo.milling.simulation import Flaw, Slab
from camgeo.pictures.backplot import figure
from camgeo.pictures.model import Area
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER, budget
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import program_bench
from tests.answers.documents import validator
from tests.draws.jobs import read
from tests.interpreter.programs import failing
from tests.second_side.scenes import FACED, FROM_BELOW, HALVES, TOLERANCE, design, scene, second

# Programs -----------------------------------------------------------------------------------------


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
        assert run(text, profile, program_bench(piece, profile)).findings == ()
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
        assert find_disc([disc], name) is disc


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
    found = run(written(product), machine, program_bench(product, machine))
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
    first, _ = product_sides(design(scene(FACED)).disc)
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
    first, other = (
        written(each) for each in side_programs(disc) + side_programs(product_sides(disc)[1])
    )
    as_first = re.sub(r"\(second side.*\n(\(back\)\n)?", "", other)
    assert failures(disc, as_first) != []
    one_sided = design(scene(FACED.partition("[second_side]")[0])).disc
    (check,) = failing(one_sided, other.encode())
    assert check.note == "it mills a second side, which the scene does not have"
    assert failures(disc, first) == []


def test_a_first_side_that_leaves_too_much_does_not_verify() -> None:
    """What is left on the upper face is there when both sides are done."""
    disc = design(scene(FACED)).disc
    first, _ = product_sides(disc)
    text = written(first)
    head, mark, rest = text.partition("(operation rough bore)")
    wrong = head.replace("G1 Z0.0000", "G1 Z0.2000") + mark + rest
    assert wrong != text
    assert failures(disc, wrong) != []


def test_the_header_says_how_the_work_lies() -> None:
    first, other = product_sides(
        design(scene(FROM_BELOW, about="y", direction="conventional")).disc
    )
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
    _, other = product_sides(design(scene(FROM_BELOW + EDGE, "heidenhain", about="x")).disc)
    low, high = (line for line in written(other).splitlines() if "BLK FORM" in line)
    assert re.search(r"X\+0\S* Y\+0", low)
    assert re.search(r"X\+84\S* Y\+76", high)


# -- job -------------------------------------------------------------------------------------------
# Jobs of two sides simulated: the second starts from what the first has left.


OPERATIONS: Final = """[[second_side.operation]]
kind = "{kind}"
tool = {tool}
{more}
"""

TABBED: Final = """[stock]
length = 84
width = 76
bore = 18
[holding]
kind = "tabs"
through = 0.3
count = 3
width = 6
height = 2
[second_side]
turned_about = "y"
[second_side.holding]
kind = "clamps"
through = 0
[[second_side.holding.clamp]]
place = [-40, 30]
length = 6
width = 8
height = 8
[[second_side.operation]]
kind = "chamfer"
boundary = "outline"
tool = 5
size = 0.3
"""
"""A part that hangs in its plate by tabs, of which the other edge is broken."""


@cache
def done(text: str) -> tuple[SimulatedSide, ...]:
    first, _ = product_sides(design(text).disc)
    toolpath = first.milled.toolpath(TOLERANCE)
    cuts = tuple(each.cut for each in toolpath.operations)
    return job(first.milled, cuts, toolpath_runs(toolpath), TOLERANCE)


def volume(slabs: Sequence[Slab], areas: Iterable[RegionOfPolygons] | None = None) -> float:
    """Of the material of slabs, or of one area for each [mm^3]."""
    each = [slab.material for slab in slabs] if areas is None else areas
    return float(sum((s.z1 - s.z0) * area.area for s, area in zip(slabs, each, strict=True)))


def flaws(text: str) -> list[Flaw]:
    return [flaw for side in side_flaws(done(text)) for flaw in side]


@pytest.mark.parametrize("tables", [FACED, FROM_BELOW])
def test_the_part_is_left(tables: str) -> None:
    """Nothing of it is missing; what is left beside it is as thin as paths may be off, or waste."""
    text = scene(tables)
    assert flaws(text) == []
    first = done(text)[0].side
    last = done(text)[-1].simulation
    slabs = last.stages[-1].slabs
    missing = (area.difference(s.material) for s, area in zip(slabs, last.part, strict=True))
    around = 240.0  # of outline and bore, no more [mm]
    most = around * first.part.thickness * TOLERANCE
    assert volume(slabs, missing) < most
    if tables == FACED:  # no frame around it
        assert abs(last.stages[-1].volume - volume(slabs, last.part)) < most


def test_it_starts_from_what_the_first_has_left() -> None:
    """Turned over, slab by slab; nothing of it is lost."""
    first, second = done(scene(FACED))
    assert second.setup.leftover is not None
    low = first.side.lowest
    left = {
        (round(low - slab.z1, 9), round(low - slab.z0, 9)): slab.material.area
        for slab in first.simulation.stages[-1].slabs
    }
    before = {
        (round(s.z0, 9), round(s.z1, 9)): s.material.area for s in second.setup.leftover.slabs
    }
    assert before == pytest.approx(left)
    # As thick as the blank, less what was faced off.
    high = [slab for slab in second.setup.leftover.slabs if not slab.material.is_empty]
    assert (high[0].z0, high[-1].z1) == pytest.approx((-6.0, 2.5))


def test_edges_that_the_first_side_breaks_are_none_of_the_part() -> None:
    """Seen from below the part is narrower where its upper edge is broken, by up to 0.4 mm."""
    _, second = done(scene(FROM_BELOW))
    found = second.simulation
    slabs = found.stages[-1].slabs
    low, whole = (
        next(area for slab, area in zip(slabs, found.part, strict=True) if slab.z0 <= z < slab.z1)
        for z in (-5.99, -3.0)
    )
    assert whole.area - low.area == pytest.approx(0.4 * whole.exterior.length, rel=0.15)


def test_what_the_second_side_cuts_is_not_demanded_of_the_first() -> None:
    first, second = done(scene(FROM_BELOW))
    assert not first.setup.final
    assert second.setup.final
    assert first.simulation.flaws == ()


def test_waste_that_is_cut_off_is_taken_away() -> None:
    """The frame of a plate out of which the part is cut is not there on the second side."""
    tables = TABBED.replace(
        'kind = "tabs"\nthrough = 0.3\ncount = 3\nwidth = 6\nheight = 2',
        'kind = "fixture"\nthrough = 0.3',
    ).replace(
        'kind = "clamps"\nthrough = 0\n', 'kind = "fixture"\nthrough = 0\n'
    ).replace("""[[second_side.holding.clamp]]
place = [-40, 30]
length = 6
width = 8
height = 8
""", "")  # fmt: skip
    first, second = done(scene(tables))
    after = first.simulation.stages[-1].volume
    assert second.setup.leftover is not None
    carried = volume(second.setup.leftover.slabs)
    part = volume(second.simulation.stages[0].slabs, second.simulation.part)
    assert carried < 0.8 * after
    assert carried == pytest.approx(part, rel=0.01)
    # Held by its frame, tabs between, all of it is there.
    first, second = done(scene(TABBED))
    assert second.setup.leftover is not None
    carried = volume(second.setup.leftover.slabs)
    assert carried == pytest.approx(first.simulation.stages[-1].volume)


def run_otherwise(side: Side, number: int, to: Callable[[float, float, float], Point]) -> Side:
    """With the moves of one run to other places."""
    runs = list(side.runs)
    moves = (each if isinstance(each, Stop) else replace(each, end=to(*each.end))
             for each in runs[number].moves)  # fmt: skip
    runs[number] = replace(runs[number], moves=tuple(moves))
    return Side(side.part, side.milling, side.cuts, tuple(runs))


def test_what_the_first_side_leaves_on_the_part_is_there_in_the_end() -> None:
    """A face that is cut 0.3 mm too high."""
    first, second = done(scene(FACED))
    wrong = run_otherwise(first.side, 0, lambda x, y, z: (x, y, z + 0.3))
    found = simulate_sides([wrong, second.side], allowed=0.04, level=1e-6, side_count=2)
    assert "rest" not in {flaw.name for flaw in found[0].simulation.flaws}
    assert "rest" in {flaw.name for flaw in found[1].simulation.flaws}


def test_tabs_of_the_first_side_may_stay() -> None:
    assert flaws(scene(TABBED)) == []


def test_nothing_may_be_left_below_the_part() -> None:
    """A slice that is not faced from the other side, though its edge is broken there."""
    tables = FACED + OPERATIONS.format(kind="drill", tool=6, more="")
    drill = '[[tool]]\nnumber = 6\nkind = "drill"\ndiameter = 5\ntip_angle = 118\n'
    drill += "spindle_speed = 1000\nfeed = 100\n[output]\n"
    text = scene(tables).replace("[output]\n", drill)
    (rest,) = (flaw for flaw in flaws(text) if flaw.name == "rest")
    assert not rest.watched
    second = product_sides(design(text).disc)[1].milled
    with pytest.raises(UnsafeError, match="material is left on the part"):
        second.safe(second.toolpath(TOLERANCE), TOLERANCE)


def test_a_cutter_that_is_too_deep_gouges_the_part() -> None:
    """As the work lies: the place is seen in the mirror."""
    first, second = done(scene(FROM_BELOW))
    wrong = run_otherwise(second.side, -1, lambda x, y, z: (0.9 * x, 0.9 * y, z))  # nearer
    found = simulate_sides([first.side, wrong], allowed=0.04, level=1e-6, side_count=2)
    (gouge,) = (flaw for flaw in found[-1].simulation.flaws if flaw.name == "gouge")
    seen = next(flaw for flaw in side_flaws(found)[-1] if flaw.name == "gouge")
    assert seen.place == (gouge.place[0], -gouge.place[1], gouge.place[2])
    assert f"X {seen.place[0]:.4g}, Y {seen.place[1]:.4g}" in seen.sentence


KEY: Final = "second_side.operation[1].boundary"

GROOVED: Final = FACED.replace("diameter = 70", "diameter = 90")
"""The blank of a groove, which the part has where this is milled."""

REFUSED: Final = [
    (
        FACED + OPERATIONS.format(kind="slot", tool=4, more=""),
        'second_side.operation[1].boundary = "inner flank": the part has no such wall',
    ),
    (
        FROM_BELOW + OPERATIONS.format(kind="face", tool=4, more=""),
        'second_side.operation[3].kind = "face": there is nothing to face: the blank ends at the',
    ),
    (
        FACED + OPERATIONS.format(kind="chamfer", tool=5, more='boundary = "outline"\nsize = 0.3'),
        "the lower face is not there yet: an operation must face it before",
    ),
    (
        GROOVED + OPERATIONS.format(kind="finish", tool=4, more='boundary = "outer flank"'),
        f'{KEY} = "outer flank": it is not open on the lower face: the part lies over it',
    ),
    (
        FACED.replace("retract_height = 4\n", "retract_height = 2\n"),
        "second_side.retract_height = 2: must be above the blank, 2.5 mm",
    ),
    (
        FROM_BELOW.replace("place = [2, 1]", "place = [30, 1]"),
        "second_side.holding: rough outline with tool 4 runs into the screw at 30, 1 mm",
    ),
    (
        FROM_BELOW.replace(
            'kind = "fixture"\nthrough = 0.3\n[[operation]]\nkind = "chamfer"\nboundary = "outline"'
            "\ntool = 5\nsize = 0.4\n",
            'kind = "fixture"\nthrough = 0.3\n[[operation]]\nkind = "finish"\n'
            'boundary = "outline"\ntool = 4\n',
        ),
        'second_side.zero = "front-left": there is no corner: the first side cuts the part out',
    ),
    (
        FROM_BELOW.partition("zero =")[0]
        .replace('kind = "chamfer"\nboundary = "outline"\ntool = 5\nsize = 0.4', 'kind = "finish"\n'
        'boundary = "outline"\ntool = 4')
        + '[second_side.holding]\nkind = "fixture"\nthrough = 0\n',
        "second_side: nothing is to be milled: the blank is not lower than the part",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("tables", "expected"), REFUSED)
def test_what_cannot_be_done_from_below_is_refused(tables: str, expected: str) -> None:
    text = scene(tables)
    if tables.startswith(GROOVED):
        text = text.replace("offset = 3\n", 'offset = 3\ncontact = "groove"\n')
        text = text.replace("bore = 18\n", "bore = 18\nrim = 90\ngroove_depth = 3\n", 1)
    second = product_sides(design(text).disc)[1].milled
    with pytest.raises(SceneError) as caught:
        _ = second.zero, second.toolpath(TOLERANCE)
    assert expected in str(caught.value)


def test_short_edges_cut_a_thick_part_from_both_sides() -> None:
    """Edges of 4 mm, a part of 6 mm; neither side alone finishes its outline."""
    text = scene(HALVES).replace("flute_length = 12", "flute_length = 4")
    assert flaws(text) == []
    first, second = done(text)
    assert [min(cut.depths) for cut in first.side.cuts] == [-3.5, -3.5]
    assert [min(cut.depths) for cut in second.side.cuts] == [-3.0, -3.0]


def test_halves_that_do_not_meet_leave_a_web() -> None:
    text = scene(HALVES.replace("depth = 3\n", "depth = 2\n"))
    (rest,) = flaws(text)
    assert (rest.name, rest.watched) == ("rest", True)
    assert rest.place[2] == pytest.approx(-2.5)
    assert "0.5 mm high" in rest.text


def test_a_wall_of_which_the_first_side_cuts_half_is_planned_from_below() -> None:
    tables = HALVES.partition("[[second_side.operation]]")[0]
    second = product_sides(design(scene(tables)).disc)[1].milled
    assert [cut.name for cut in second.cuts] == ["rough outline", "outline"]
    whole = tables.replace("depth = 3.5\n", "")
    with pytest.raises(SceneError, match="nothing is to be milled"):
        _ = product_sides(design(scene(whole)).disc)[1].milled.cuts


def test_walls_that_the_first_side_leaves_are_planned() -> None:
    tables = FROM_BELOW.partition("[[second_side.operation]]")[0]
    assert [cut.name for cut in product_sides(design(scene(tables)).disc)[1].milled.cuts] == [
        "rough outline",
        "outline",
    ]
    assert flaws(scene(tables)) == []


# Answers ------------------------------------------------------------------------------------------


SIDE: Final = FROM_BELOW[FROM_BELOW.index("[second_side]") :]


@cache
def sheet_of(tables: str) -> SetupSheet:
    return setup_sheet(design(scene(tables)), TOLERANCE)


def test_the_sheet_has_a_part_for_each_side() -> None:
    sheet = sheet_of(FROM_BELOW)
    assert sheet.side == "first side"
    assert sheet.second is not None
    assert (sheet.second.side, sheet.exit_code) == (f"second side, the work {TURNING_NOTE['x']}", 0)
    shown = text(sheet)
    assert shown.count("Simulated: ") == 2
    first, other = shown.split("second side, the work turned over about X", 1)
    assert "blank     plate, 84 x 76 mm, 6 mm high" in first
    assert "Z 0 on what lies lowest" in other
    assert "screws: screw at 41, 37 mm, top at Z 14" in other
    page = html(sheet, "<svg></svg>")
    assert (page.count("<h1>"), page.count("<h2>Backplot</h2>")) == (2, 1)


def test_its_json_is_as_its_schema_says() -> None:
    document = to_json(sheet_of(FROM_BELOW))
    validator("camgeo.app.answers.setup").validate(document)
    assert document["second_side"]["side"].startswith("second side")
    assert [each["name"] for each in document["second_side"]["operations"]] == [
        "rough outline",
        "outline",
    ]
    alone = to_json(sheet_of(FROM_BELOW.partition("[second_side]")[0]))
    assert not {"side", "second_side"} & set(alone)


def test_the_check_judges_and_times_both() -> None:
    found = check(design(scene(FROM_BELOW)))
    assert found.machining is not None
    assert list(found.machining.programs) == ["both", "both-second-side"]
    assert found.exit_code == 0
    seconds = [each.seconds for each in found.machining.programs.values()]
    assert found.machining.seconds == pytest.approx(sum(each or 0.0 for each in seconds))
    assert "milling of both-second-side: simulated, nothing found" in text(found)
    validator("camgeo.app.answers.check").validate(to_json(found))


def test_the_backplot_shows_the_work_as_it_lies() -> None:
    disc = design(scene(FROM_BELOW, about="y")).disc
    first, *others = figure(disc).panels
    assert [first.title, *(each.title for each in others)] == [
        "chamfer outline",
        "second side: rough outline",
        "second side: outline",
    ]
    # The blank reaches from -39 to 45 on the first side, from -45 to 39 on the second.
    reach = []
    for panel in (first, others[0]):
        blank = panel.marks[0]
        assert isinstance(blank, Area)
        x = blank.rings[0][:, 0]
        reach.append((float(np.min(x)), float(np.max(x))))
    assert reach == [pytest.approx((-39.0, 45.0)), pytest.approx((-45.0, 39.0))]


def linted(
    tmp_path: Path,
    name: str,
    program: str,
    *,
    second_side: bool = False,
    tables: str = FROM_BELOW,
) -> Lint:
    path = tmp_path / f"{name}.ngc"
    path.write_text(program)
    known = design(scene(tables))
    return lint([path], "linuxcnc", design=known, second_side=second_side)


def test_lint_knows_the_side_by_what_a_program_says(tmp_path: Path) -> None:
    product = second(scene(FROM_BELOW))
    program = WRITER.write(product, TOLERANCE).data.decode()
    work = [
        each.finding.rule
        for each in linted(tmp_path, "any", program).programs[0].findings
        if each.finding.concerns == "work"
    ]
    assert work == []


def test_lint_is_told_the_side_of_a_program_that_does_not_say_it(tmp_path: Path) -> None:
    """From below it cuts the cam, from above its mirror image."""
    zero = 'zero = "front-left"\nzero_height = "blank-bottom"\n'
    tables = FROM_BELOW.replace(zero, "")
    program = WRITER.write(second(scene(tables)), TOLERANCE).data.decode()
    silent = "\n".join(line for line in program.splitlines() if not line.startswith("("))
    for told in (True, False):
        answer = linted(tmp_path, "silent", silent, second_side=told, tables=tables)
        rules = {each.finding.rule for each in answer.programs[0].findings}
        assert rules == (set() if told else {"gouged-part", "rest"})


def test_lint_finds_what_goes_wrong_on_the_second_side(tmp_path: Path) -> None:
    """Its place is as the work lies, and its line that of the program."""
    product = second(scene(FROM_BELOW))
    program = WRITER.write(product, TOLERANCE).data.decode()
    wrong = program.replace("Z-0.3000", "Z-2.5000")
    found = linted(tmp_path, "both-second-side", wrong).programs[0].findings
    assert {each.finding.rule for each in found} >= {"too-low"}
    line = next(each.line for each in found if each.finding.rule == "too-low")
    assert line is not None
    assert "Z-2.5000" in wrong.splitlines()[line - 1]


def test_a_side_that_there_is_not_cannot_be_linted(tmp_path: Path) -> None:
    path = tmp_path / "a.ngc"
    path.write_text("M2\n")
    one_sided = design(scene(FACED.partition("[second_side]")[0]))
    with pytest.raises(SceneError, match="second_side: is not stated"):
        lint([path], "linuxcnc", design=one_sided, second_side=True)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('turned_about = "{about}"\n', "", "second_side.turned_about: is missing"),
        ('"{about}"', '"z"', 'second_side.turned_about = "z": must be one of "x", "y"'),
        (SIDE[SIDE.index("[second_side.holding]") :], "", "second_side.holding: is missing"),
        (
            'kind = "rough"\nboundary = "outline"\ntool = 4',
            'kind = "rough"\nboundary = "outline"\ntool = 9',
            "second_side.operation[1].tool = 9: there is no such tool; there are 4, 5",
        ),
        (
            'zero_height = "blank-bottom"', 'work_offset = "G60"',
            'second_side.work_offset = "G60": must be one of "G54"',
        ),
        (
            'zero_height = "blank-bottom"', "clearance_height = 2",
            "second_side.retract_height",
        ),
        (
            'tool = 5\nsize = 0.4', 'tool = 5\nsize = 0.4\ndepth = 2',
            'operation[1].depth = 2: belongs to kinds "rough", "finish", "bore"',
        ),
        ("head_diameter = 24", "head_diameter = -1", "second_side.holding.screw[1].head_diameter"),
    ],
)  # fmt: skip
def test_a_wrong_second_side_is_refused_with_its_key(old: str, new: str, expected: str) -> None:
    wrong = FROM_BELOW.replace(old, new, 1)
    assert wrong != FROM_BELOW
    with pytest.raises(SceneError) as caught:
        _ = product_sides(design(scene(wrong)).disc)[1].milled.zero
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('kind = "screws"', 'kind = "tabs"', "needs second_side.holding.count: tabs need it"),
        ('kind = "screws"', 'kind = "clamps"', 'needs second_side.holding.clamp: kind "clamps"'),
        (
            'kind = "rough"\nboundary = "outline"', 'kind = "rough"',
            "needs second_side.operation[1].boundary: which wall",
        ),
        (
            "length = 84\nwidth = 76\n", "",
            'needs [stock] length and width of a plate, for second_side.zero = "front-left"',
        ),
    ],
)  # fmt: skip
def test_what_a_second_side_lacks_is_found(old: str, new: str, expected: str) -> None:
    lacking = design(scene(FROM_BELOW.replace(old, new, 1)))
    found = [each.sentence for each in check(lacking).formats]
    assert any(expected in each for each in found), found


def test_lengths_are_in_the_unit_of_the_scene() -> None:
    inches = scene(FROM_BELOW).replace("camgeo = 1", 'camgeo = 1\nunits.length = "inch"')
    inches = inches.replace("[second_side]", "[second_side]\nretract_height = 2", 1)
    milling = parse_scene(inches).milling
    assert milling is not None
    assert milling.second is not None
    assert milling.second.retract_height == 2 * 25.4
    screw, _ = milling.second.holding.clamps
    assert screw.length == 24 * 25.4
    assert milling.second_operations[0].allowance == 0.4 * 25.4
