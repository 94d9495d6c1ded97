"""The path of the cutter's centre under compensation: where parallels of moves meet, corners, arcs,
leads, and LinuxCNC's."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from functools import partial
from random import Random
from typing import Final

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.design.linting import WorkData
from camgeo.milling.machine import load
from camgeo_export.interpreter.moves import (
    CutterMove,
    Findings,
    Kind,
    Parallel,
    ProgramRun,
    centre_path,
    check_compensation,
    meeting,
)
from camgeo_export.interpreter.run import run
from tests.judges import rs274
from tests.judges.files import random_contour
from tests.judges.paths import difference
from tests.long_form import examples

# Parallels of moves: the point where two neighbours meet is a radius away from both ---------------


RADIUS = 1.0


def move(
    kind: Kind, start: complex, end: complex, centre: complex = 0j, sweep: float = 0.0
) -> CutterMove:
    return CutterMove(kind, start, end, 0.0, 0.0, centre, sweep, 0.0, 1.0, 1.0, "", 1, 1, 1)


def line(start: complex, heading: complex, length: float) -> CutterMove:
    return move("line", start, start + heading * length)


def arc(start: complex, heading: complex, radius: float, sweep: float) -> CutterMove:
    """An arc from a heading; `sweep` positive counter-clockwise."""
    centre = start + heading * radius * (1j if sweep > 0.0 else -1j)
    return move("arc", start, centre + (start - centre) * cmath.exp(1j * sweep), centre, sweep)


def off(each: CutterMove, point: complex) -> float:
    """Distance of a point from the whole line or circle of a move."""
    if each.kind == "arc":
        return abs(abs(point - each.centre) - abs(each.start - each.centre))
    way = each.end - each.start
    return abs(((point - each.start) / way).imag) * abs(way)


def test_a_square_corner() -> None:
    before, after = line(-10 + 0j, 1 + 0j, 10.0), line(0j, 1j, 10.0)
    left = Parallel(before, 1.0, RADIUS), Parallel(after, 1.0, RADIUS)
    assert (meeting(*left), left[0].share(-1 + 1j), left[1].share(-1 + 1j)) == pytest.approx(
        (-1 + 1j, 0.9, 0.1)
    )


@given(
    st.floats(0.1, 2.5),
    st.sampled_from([1.0, -1.0]),
    st.floats(2.5, 20.0),
    st.floats(0.3, 2.0),
    st.sampled_from(["line line", "line arc", "arc line", "arc arc"]),
    st.booleans(),
)
def test_the_cutter_touches_both(
    turn: float, side: float, radius: float, sweep: float, kinds: str, left: bool
) -> None:
    first, second = kinds.split()
    bend = sweep if left else -sweep
    heading = cmath.exp(1j * turn * side)
    after = line(0j, heading, 30.0) if second == "line" else arc(0j, heading, radius, bend)
    back = line(0j, -1 + 0j, 30.0) if first == "line" else arc(0j, -1 + 0j, radius, -bend)
    before = move(back.kind, back.end, back.start, back.centre, -back.sweep)
    pair = Parallel(before, side, RADIUS), Parallel(after, side, RADIUS)
    assert pair[1].heading(0j) / pair[0].heading(0j) == pytest.approx(heading)
    assume(all(each.move.kind == "line" or each.room > 0.0 for each in pair))
    point = meeting(*pair)
    assume(point is not None)
    assert point is not None
    assert (off(before, point), off(after, point)) == pytest.approx((RADIUS, RADIUS), abs=1e-9)
    for each in pair:
        share = each.share(point)
        place = each.move.start + (each.move.end - each.move.start) * share
        if each.move.kind == "arc":
            turned = cmath.exp(1j * each.move.sweep * share)
            place = each.move.centre + (each.move.start - each.move.centre) * turned
        assert abs(point - place) == pytest.approx(RADIUS, abs=1e-9)
        if share > 0.0:
            assert abs(each.offset_point(place) - point) == pytest.approx(0.0, abs=1e-6)


def test_an_arc_has_room_for_smaller_cutters_only() -> None:
    inner = Parallel(arc(0j, 1 + 0j, 5.0, math.pi), 1.0, 4.0)
    assert (inner.room, Parallel(inner.move, -1.0, 4.0).room) == pytest.approx((1.0, 9.0))
    assert Parallel(inner.move, 1.0, 6.0).room < 0.0


# Corners, arcs and leads of programs --------------------------------------------------------------


HEAD: Final = """G17 G21 G40 G49 G54 G80 G90 G94 G91.1
T1 M6
G43 H1
S1000 M3 F500
G0 Z5
G0 X-10 Y0
G1 Z-1
"""

PRINTED: Final = 1e-5
"""Coordinates have six decimals; what is computed of them is off by a little more [mm]."""

END: Final = "G0 Z5\nM5\nM2\n"

EDGE: Final = "G1 G41 D1 X0 Y0\nG1 X20 Y0\n{}G1 G40 X40 Y40\n"


def of(body: str, machine: str = "linuxcnc") -> ProgramRun:
    return run(HEAD + body + END, load(machine))


def ends(found: ProgramRun, radius: float) -> list[complex]:
    moves = centre_path(found.moves, lambda _: radius)
    return [move.end for move in moves if move.kind != "rapid" and move.start != move.end]


@pytest.mark.parametrize(
    ("way", "radius", "expected", "arcs"),
    [
        ("G1 X20 Y20\n", 2.0, [2j, 18 + 2j, 18 + 20j, 40 + 40j], []),
        (
            "G1 X20 Y-20\n",
            2.0,
            [2j, 20 + 2j, 22 + 0j, 22 - 20j, 40 + 40j],
            [(20 + 0j, -0.5 * math.pi)],
        ),
        (
            "G1 X20 Y20\n",
            -2.0,
            [-2j, 20 - 2j, 22 + 0j, 22 + 20j, 40 + 40j],
            [(20 + 0j, 0.5 * math.pi)],
        ),
    ],
    ids=["inner", "outer", "other side"],
)
def test_an_inner_corner_is_cut_where_the_parallels_meet_and_an_outer_one_is_rounded(
    way: str, radius: float, expected: list[complex], arcs: list[tuple[complex, float]]
) -> None:
    """A negative offset is one on the other side."""
    found = of(EDGE.format(way))
    assert ends(found, radius) == pytest.approx(expected)
    made = [
        (move.centre, move.sweep)
        for move in centre_path(found.moves, lambda _: radius)
        if move.kind == "arc"
    ]
    assert made == [pytest.approx(each) for each in arcs]


def test_arcs_keep_their_centre_and_change_their_radius() -> None:
    """Inside, outside, and with a corner between line and arc."""
    found = of(EDGE.format("G3 X30 Y10 I0 J10\nG2 X40 Y20 I10 J0\nG1 X50 Y20\n"))
    moves = [move for move in centre_path(found.moves, lambda _: 2.0) if move.kind == "arc"]
    inner, outer = moves
    assert [abs(inner.start - inner.centre), abs(inner.end - inner.centre)] == pytest.approx([8, 8])
    assert [abs(outer.start - outer.centre), abs(outer.end - outer.centre)] == pytest.approx(
        [12] * 2
    )
    assert inner.sweep == pytest.approx(0.5 * math.pi)
    assert outer.sweep == pytest.approx(-0.5 * math.pi)


def test_moves_along_z_stay_beside_the_path_and_without_an_offset_nothing_changes() -> None:
    found = of(EDGE.format("G1 Z-2\nG1 X20 Y20\n"))
    moves = centre_path(found.moves, lambda _: 2.0)
    (down,) = (move for move in moves if move.z_end == -2.0 != move.z_start)
    assert down.start == down.end
    unchanged = centre_path(found.moves, lambda _: 0.0)
    assert all(one is other for one, other in zip(unchanged, found.moves, strict=True))
    assert found.compensated is not None
    assert found.centred(lambda _: 2.0).compensated is None


@pytest.mark.parametrize(("radius", "rules"), [
    (2.0, []), (9.9, []), (-9.9, []), (10.1, ["compensation", "gouge"]), (-15.0, ["compensation"]),
])  # fmt: skip
def test_what_a_controller_refuses_depends_on_the_offset(radius: float, rules: list[str]) -> None:
    """The way on is 10 mm long, the arc has 10 mm, to the left."""
    moves = of(EDGE.format("G3 X30 Y10 I0 J10\nG1 X30 Y30\n")).moves
    findings = Findings(10)
    check_compensation(moves, lambda _: radius, findings)
    assert [finding.rule for finding in findings.reported][: len(rules) or 1] == rules


def test_arcs_whose_radii_are_rounded_have_no_corners() -> None:
    """Found by review: three decimals, on the inside of the arcs."""
    body = """G1 G42 D1 X50.000 Y-25.000
G1 X45.789 Y-32.880
G2 X43.275 Y-37.225 I-34.776 J17.222
G2 X39.629 Y-41.872 I-32.265 J21.561
G2 X33.832 Y-47.074 I-29.356 J26.883
G1 X33.601 Y-47.243
G2 X29.000 Y-50.229 I-30.903 J42.579
G1 G40 X10 Y-60
"""
    findings = Findings(10)
    check_compensation(of(body).moves, lambda _: 0.216, findings)
    assert [finding.rule for finding in findings.reported] == []


@pytest.mark.parametrize(
    ("radius", "rules"), [(12.0, ["compensation", "gouge"]), (-12.0, ["compensation"])]
)
def test_a_linter_takes_a_negative_offset_as_one_on_the_other_side(
    radius: float, rules: list[str]
) -> None:
    arc = EDGE.format("G3 X30 Y10 I0 J10\nG1 X30 Y30\n")
    linted = run(HEAD + arc + END, load("linuxcnc"), WorkData(radii=((1, radius),)))
    assert [each.rule for each in linted.findings if each.concerns == "form"] == rules


@pytest.mark.parametrize(
    ("machine", "old", "new", "oversize"),
    [
        ("sinumerik", "OFFN=-3.0", "OFFN=-3.0", -3.0),
        ("sinumerik", "OFFN=-3.0", "OFFN=0", 0.0),
        ("heidenhain", " DR-3.0", " DR-3.0", -3.0),
        ("heidenhain", " DR-3.0", "", 0.0),
        ("heidenhain", " DR-3.0", " DL+1.0 DR+0.5", 0.5),
    ],
)
def test_what_programs_add_to_the_table_is_read(
    machine: str, old: str, new: str, oversize: float
) -> None:
    text = SINUMERIK if machine == "sinumerik" else HEIDENHAIN
    found = run(text.replace(old, new), load(machine))
    assert [finding.rule for finding in found.findings if finding.concerns == "words"] == []
    assert {move.oversize for move in found.moves if move.compensation} == {oversize}


SINUMERIK: Final = """G17 G710 G40 G90 G94
G54
SUPA G0 Z0 D0
T1
M6
D1
S1000 M3
G0 X-10.0 Y0.0
G0 Z5.0
G1 Z-1.0 F100
G1 G41 OFFN=-3.0 X0.0 Y0.0 F200
G1 X20.0 Y0.0
G1 G40 OFFN=0 X40.0 Y40.0
G0 Z5.0
M5
M30
"""

HEIDENHAIN: Final = """0 BEGIN PGM A MM
1 TOOL CALL 1 Z S1000 DR-3.0
2 M3
3 L X-10.0 Y+0.0 R0 FMAX
4 L Z+5.0 R0 FMAX
5 L Z-1.0 R0 F100
6 L X+0.0 Y+0.0 RL F200
7 L X+20.0 Y+0.0 RL
8 L X+40.0 Y+40.0 R0
9 L Z+5.0 R0 FMAX
10 M5
11 M30
12 END PGM A MM
"""


def _always(size: float, _: CutterMove) -> float:
    return size


def _without_dots(moves: tuple[CutterMove, ...]) -> tuple[CutterMove, ...]:
    """Without arcs around corners that LinuxCNC takes for none."""
    return tuple(
        move for move in moves
        if move.kind != "arc" or abs(move.sweep) * abs(move.start - move.centre) > 1e-3
    )  # fmt: skip


@pytest.mark.skipif(bool(rs274.absent()), reason=rs274.absent())
def test_random_contours_run_as_in_linuxcnc() -> None:
    """Where neither refuses anything."""
    rng, judged = Random(7), 0
    for _ in range(examples(30, long=60)):
        text = random_contour(rng)
        found = run(text, load("linuxcnc"))
        if found.findings:
            continue
        legs, said = rs274.run(text)
        if said:
            continue
        size = next(float(word[1:]) for word in text.split() if word.startswith("D")) / 2.0
        central = found.centred(partial(_always, size))
        assert difference(replace(central, moves=_without_dots(central.moves)), legs) < PRINTED, (
            text
        )
        judged += 1
    assert judged > examples(5, long=10)
