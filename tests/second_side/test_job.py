"""Jobs of two sides simulated: the second starts from what the first has left."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache
from typing import Final

import pytest

from camgeo.design.milled import job
from camgeo.design.product import sides_of
from camgeo.errors import SceneError, UnsafeError
from camgeo.milling.judged import Side, runs_of
from camgeo.milling.moves import Point, Stop
from camgeo.milling.simulation import Done, settled, simulated
from camgeo.milling.stages import Area, Flaw, Slab
from tests.second_side.scenes import FACED, FROM_BELOW, HALVES, TOLERANCE, design, scene

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
def done(text: str) -> tuple[Done, ...]:
    first, _ = sides_of(design(text).disc)
    toolpath = first.milled.toolpath(TOLERANCE)
    cuts = tuple(each.cut for each in toolpath.operations)
    return job(first.milled, cuts, runs_of(toolpath), TOLERANCE)


def volume(slabs: Sequence[Slab], areas: Iterable[Area] | None = None) -> float:
    """Of the material of slabs, or of one area for each [mm^3]."""
    each = [slab.material for slab in slabs] if areas is None else areas
    return float(sum((s.z1 - s.z0) * area.area for s, area in zip(slabs, each, strict=True)))


def flaws(text: str) -> list[Flaw]:
    return [flaw for side in settled(done(text)) for flaw in side]


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
    assert second.setup.before is not None
    low = first.side.lowest
    left = {
        (round(low - slab.z1, 9), round(low - slab.z0, 9)): slab.material.area
        for slab in first.simulation.stages[-1].slabs
    }
    before = {(round(s.z0, 9), round(s.z1, 9)): s.material.area for s in second.setup.before.slabs}
    assert before == pytest.approx(left)
    # As thick as the blank, less what was faced off.
    high = [slab for slab in second.setup.before.slabs if not slab.material.is_empty]
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
    assert second.setup.before is not None
    carried = volume(second.setup.before.slabs)
    part = volume(second.simulation.stages[0].slabs, second.simulation.part)
    assert carried < 0.8 * after
    assert carried == pytest.approx(part, rel=0.01)
    # Held by its frame, tabs between, all of it is there.
    first, second = done(scene(TABBED))
    assert second.setup.before is not None
    carried = volume(second.setup.before.slabs)
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
    found = simulated([wrong, second.side], allowed=0.04, level=1e-6, of=2)
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
    second = sides_of(design(text).disc)[1].milled
    with pytest.raises(UnsafeError, match="material is left on the part"):
        second.safe(second.toolpath(TOLERANCE), TOLERANCE)


def test_a_cutter_that_is_too_deep_gouges_the_part() -> None:
    """As the work lies: the place is seen in the mirror."""
    first, second = done(scene(FROM_BELOW))
    wrong = run_otherwise(second.side, -1, lambda x, y, z: (0.9 * x, 0.9 * y, z))  # nearer
    found = simulated([first.side, wrong], allowed=0.04, level=1e-6, of=2)
    (gouge,) = (flaw for flaw in found[-1].simulation.flaws if flaw.name == "gouge")
    seen = next(flaw for flaw in settled(found)[-1] if flaw.name == "gouge")
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
        "the lower face is not there yet: it is to be faced before",
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
    second = sides_of(design(text).disc)[1].milled
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
    second = sides_of(design(scene(tables)).disc)[1].milled
    assert [cut.name for cut in second.cuts] == ["rough outline", "outline"]
    whole = tables.replace("depth = 3.5\n", "")
    with pytest.raises(SceneError, match="nothing is to be milled"):
        _ = sides_of(design(scene(whole)).disc)[1].milled.cuts


def test_walls_that_the_first_side_leaves_are_planned() -> None:
    tables = FROM_BELOW.partition("[[second_side.operation]]")[0]
    assert [cut.name for cut in sides_of(design(scene(tables)).disc)[1].milled.cuts] == [
        "rough outline",
        "outline",
    ]
    assert flaws(scene(tables)) == []
