"""Verification of programs: feeds of single moves, heights of cuts, and what is simulated."""

from __future__ import annotations

import cmath
import math
import re
from functools import cache
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import camgeo
from camgeo.design.product import Product
from camgeo.design.verify import Check
from camgeo.milling.cut import Cut
from camgeo.milling.machine import load, names
from camgeo.milling.milling import GcodeSpec
from camgeo.milling.moves import ArcFeed, Feed
from camgeo.units import LengthUnit
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER, at_no_height
from camgeo_export.verify.simulated import runs_in, simulation_checks
from tests.export.stub_product import SECOND_TOOL, StubProduct
from tests.export.verified import TOLERANCE, faults
from tests.long_form import examples
from tests.toolpath import programs
from tests.toolpath.milled import tool

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"


@cache
def made(name: str, machine: str = "linuxcnc") -> tuple[Product, str]:
    text = (SCENES / f"{name}.toml").read_text().replace("linuxcnc", machine)
    disc = camgeo.loads(text).disc
    return disc, WRITER.write(disc, TOLERANCE).data.decode()


def wrong(disc: Product, text: str) -> list[Check]:
    return faults(VERIFIER, disc, text.encode())


@pytest.mark.parametrize("machine", names())
def test_all_feeds_of_a_program_are_right(machine: str) -> None:
    assert wrong(*made("setzhub", machine)) == []


def test_every_single_feed_is_held() -> None:
    """A tenth less or more in any one block; the next one states its own again."""
    disc, text = made("swallow_tail")
    lines = text.splitlines()
    feeds: list[tuple[int, float]] = []
    at = 0.0
    for number, line in enumerate(lines):
        at = float(word[1]) if (word := re.search(r" F([\d.]+)$", line)) else at
        if re.match(r"G[123] ", line):
            feeds.append((number, at))
    moves = [number for number, _ in feeds]
    held = 0
    for number, feed in feeds[:: examples(2, long=1) * (len(feeds) // 24)]:
        for share in (0.9, 1.1):
            changed = lines.copy()
            following = next((k for k in moves if k > number), None)
            changed[number] = re.sub(r" F[\d.]+$", "", lines[number]) + f" F{share * feed:.2f}"
            if following is not None:
                own = re.search(r" F[\d.]+$", lines[following])
                changed[following] += "" if own else f" F{feed:g}"
            found = wrong(disc, "\n".join(changed) + "\n")
            assert [check.name for check in found] in (["feed"], ["plunge feed"]), lines[number]
            assert found[0].note == f"line {number + 1}"
            held += 1
    assert held >= 20


@pytest.mark.parametrize("name", ["setzhub", "groove"])
def test_the_side_of_the_wall_decides(name: str) -> None:
    """Inner arcs at the feed of outer ones cut too fast, outer ones at that of inner too slowly."""
    disc, text = made(name)
    flat = re.sub(r"( F)[\d.]+", lambda found: f"{found[1]}300", text)
    (first, *_) = (check for check in wrong(disc, flat) if check.name == "feed")
    assert float(str(first.value)) > float(str(first.expected))


@pytest.mark.parametrize("climb", [True, False])
def test_only_the_way_back_of_a_loop_runs_at_the_feed(climb: bool) -> None:
    """Of each loop the first part cuts, slowed, as the wall lies around it, and the second leads
    back through the air: any feed from the slowed one up to the tool's is right there, none above.
    """
    loops = programs.operation(
        "rough", "outline", allowance=0.3, strategy="trochoidal", stepdown=6.3,
        direction="climb" if climb else "conventional",
    )  # fmt: skip
    words = f"{programs.PASSES}\nengagement = 80"
    text = programs.scene(programs.mill(1, 12, words), programs.FIXTURE, loops, part="")
    disc = camgeo.loads(text).disc
    program = WRITER.write(disc, TOLERANCE).data.decode()
    assert wrong(disc, program) == []
    lines, feed, arcs = program.split("\n"), 0.0, []
    for number, line in enumerate(lines):
        found = re.search(r"F([\d.]+)", line)
        feed = float(found[1]) if found else feed
        centre = re.search(r"I(\S+) J(\S+)", line)
        if line.startswith(("G2", "G3")) and centre and "Z" not in line:
            radius = math.hypot(float(centre[1]), float(centre[2]))
            arcs.append((number, radius, feed))
    inner = [each for each in arcs if each[1] < 3.5]  # loops, whose radius is half the cutter's
    (way,) = {lines[number][:2] for number, _, _ in inner}
    assert way == ("G3" if climb else "G2")
    back = [number for number, _, own in inner if own == 500.0]
    ahead = [number for number, _, own in inner if own < 250.0]
    assert len(back) + len(ahead) == len(inner)
    assert len(back) > 20
    assert len(ahead) > len(back)

    def with_feed(number: int, own: float) -> list[tuple[str, str]]:
        """The checks that fail where one block has its own feed and all after it their old ones."""
        before = next(each for place, _, each in inner if place == number)
        changed = lines.copy()
        changed[number] = re.sub(r" F[\d.]+", "", lines[number]) + f" F{own:g}"
        after = next(k for k in range(number + 1, len(lines)) if lines[k].startswith("G"))
        if "F" not in lines[after]:
            changed[after] += f" F{before:g}"
        return [(each.name, each.note) for each in wrong(disc, "\n".join(changed))]

    slow = min(own for _, _, own in inner)
    for number in (back[3], back[len(back) // 2]):
        assert with_feed(number, 0.5 * (slow + 500.0)) == []
        assert with_feed(number, 501.0) == [("feed", f"line {number + 1}")]
        assert with_feed(number, 0.9 * slow) == [("feed", f"line {number + 1}")]
    for number in (ahead[3], ahead[len(ahead) // 2 + 1]):
        for own in (1.02 * slow, 500.0, 0.98 * slow):
            assert with_feed(number, own) == [("feed", f"line {number + 1}")]


# Heights: level at their depths, and on ramps that are printed in steps ---------------------------


RADIUS = 30.0


def arcs_at(turns: list[float], z: list[float]) -> list[CutterMove]:
    """Around a circle, from turn to turn and from height to height."""
    return [
        CutterMove(
            "arc",
            RADIUS * cmath.exp(2j * math.pi * turns[k]),
            RADIUS * cmath.exp(2j * math.pi * turns[k + 1]),
            z[k],
            z[k + 1],
            0j,
            2.0 * math.pi * (turns[k + 1] - turns[k]),
            *(0.0, 100.0, 1000.0, "rough", 1, 1, k + 1),
        )
        for k in range(len(turns) - 1)
    ]


def ramps(depths: list[float], joints: list[float], step: float) -> list[CutterMove]:
    """Down a turn to each depth, evenly, and once around the last; heights printed in steps."""
    turns = [0.0]
    for lap in range(len(depths) + 1):
        turns += [lap + each for each in (*joints, 1.0)]
    deep = [0.0, *depths, depths[-1]]
    z = []
    for turn in turns:
        lap = min(int(turn), len(depths))
        exact = deep[lap] + (turn - lap) * (deep[min(lap + 1, len(depths))] - deep[lap])
        z.append(round(exact / step) * step)
    return arcs_at(turns, z)


def cut_of(depths: list[float]) -> Cut:
    return Cut(name="rough", strategy="slot", tool=tool(8.0), top=0.0, depths=tuple(depths))


@given(
    joints=st.lists(st.floats(1e-3, 0.999), max_size=12, unique=True).map(sorted),
    passes=st.integers(1, 5),
    steps=st.floats(2.1, 40.0),
)
def test_a_ramp_is_none_of_the_depths_and_no_fault(
    joints: list[float], passes: int, steps: float
) -> None:
    """However many of its pieces are printed level."""
    step = 1e-3
    depths = [-step * steps * (k + 1) for k in range(passes)]
    assert at_no_height(cut_of(depths), ramps(depths, joints, step), step) is None


@given(share=st.floats(0.2, 0.8), steps=st.floats(20.0, 4000.0))
def test_a_level_turn_at_no_depth_is_found(share: float, steps: float) -> None:
    step = 1e-3
    depth = -step * steps
    wrong = round(share * steps) * -step
    assume(min(wrong - depth, -wrong) > 4.0 * step)
    moves = arcs_at([0.0, 0.5, 1.0, 1.5, 2.0, 3.0], [0.0, 0.5 * wrong, wrong, wrong, wrong, depth])
    moves += arcs_at([3.0, 4.0], [depth, depth])
    found = at_no_height(cut_of([depth]), moves, step)
    assert found is not None
    assert found.z_end == wrong
    assert at_no_height(cut_of([wrong, depth]), moves, step) is None


# Programs as they are written, simulated: sound ones, and ones changed on purpose -----------------


def text_of(product: StubProduct) -> str:
    return WRITER.write(product, TOLERANCE).data.decode()


def checks(product: StubProduct, text: str) -> list[Check]:
    program = run(text, load(product.gcode.machine))
    return simulation_checks(product, program, TOLERANCE)


PRODUCT = StubProduct(second_tool=SECOND_TOOL)

PROGRAM = text_of(PRODUCT)


@pytest.mark.parametrize("machine", ["linuxcnc", "haas", "grbl", "heidenhain"])
@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_a_sound_program(machine: str, unit: LengthUnit) -> None:
    """Also where Z is printed in thousandths of an inch, and goes to the machine's reference."""
    product = StubProduct(gcode=GcodeSpec(machine=machine), unit=unit)
    (check,) = checks(product, text_of(product))
    assert (check.value, check.ok) == ("2 operations", True)


def test_moves_are_those_of_the_program() -> None:
    bore, outline = runs_in(PRODUCT, run(PROGRAM, load("linuxcnc")))
    assert (bore.name, bore.radius) == ("bore", 3.0)
    assert (outline.name, outline.radius) == ("outline", 4.0)
    planned = PRODUCT.toolpath(TOLERANCE).operations[0].moves
    kinds = [type(move) for move in bore.moves]
    assert kinds.count(ArcFeed) == sum(isinstance(move, ArcFeed) for move in planned)
    assert kinds.count(Feed) == sum(isinstance(move, Feed) for move in planned)
    assert bore.start == (4.2, -2.8, 5.0)  # where the first traverse that says all of it ends


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        # The outline is cut with the smaller tool, on the path of the larger one.
        ("T2 M6", "T1 M6", "outline: material is left on the part, up to 1.01 mm thick"),
        # 1 mm along X through the whole of the outline.
        ("(operation outline)", "(operation outline)\nG52 X1", "outline: the cutter goes"),
        ("G1 Z-8.0000 F80", "G0 Z-8.0000", "outline: a traverse goes 4 mm deep into material"),
        ("G1 Z-8.0000 F80", "G1 Z-7.0000 F80", "material is left on the part, up to"),
    ],
)
def test_a_program_that_is_changed(old: str, new: str, sentence: str) -> None:
    text = PROGRAM
    if new.endswith("G52 X1"):
        head, tail = text.split(old)
        new = old
        tail = re.sub(r"X(-?[\d.]+)", lambda found: f"X{float(found[1]) + 1.0:.4f}", tail)
        text = f"{head}{old}{tail}"
    assert old in text
    found = checks(PRODUCT, text.replace(old, new))
    assert [check for check in found if check.ok is not False] == []
    assert any(sentence in check.note for check in found), [check.note for check in found]


FOREIGN = """G17 G21 G40 G49 G54 G80 G90 G94 G91.1
T{tool} M6
G43 H{tool}
S3000 M3
G0 Z5
G0 X0 Y-5
G1 Z-8 F100
G0 Z5
G0 X35 Y-5
G1 Z-8
G2 X35 Y-5 I-35 J0
G0 Z5
G28
G0 Z5
G0 X7 Y0
G1 Z-8
G3 X7 Y0 I-7 J0
G0 Z5
M5
M2
"""


def test_a_program_of_someone_else() -> None:
    """Whole circles, no comments, and after a traverse home a place that nobody has stated."""
    (sound,) = checks(PRODUCT, FOREIGN.format(tool=1))
    assert sound.ok
    assert sound.value == "1 operation"  # in two parts
    (drilled,) = checks(PRODUCT, FOREIGN.format(tool=1).replace("X0 Y-5", "X0 Y-12"))
    assert "tool 1: the cutter goes 5 mm into the part" in drilled.note
    runs = runs_in(PRODUCT, run(FOREIGN.format(tool=1), load("linuxcnc")))
    assert [each.name for each in runs] == ["tool 1", "tool 1"]
    assert sum(isinstance(move, ArcFeed) for each in runs for move in each.moves) == 4


def test_a_tool_that_the_scene_does_not_have() -> None:
    (check,) = checks(PRODUCT, FOREIGN.format(tool=7))
    assert check.ok is False
    assert check.note == "line 7: tool 7 is none of the scene's"


def test_a_path_that_the_control_computes() -> None:
    text = FOREIGN.format(tool=1).replace("G1 Z-8\nG2", "G41 D1\nG1 Z-8\nG2")
    (check,) = checks(PRODUCT, text)
    assert check.ok is None
    assert "control" in check.note
