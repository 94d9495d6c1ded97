"""The path of the cutter's centre under compensation: corners, arcs, leads, and LinuxCNC's."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from random import Random
from typing import Final

import pytest

from camgeo.design.linting import Bench
from camgeo.milling.machine import load
from camgeo_export.interpreter.moves import CutterMove, Findings, Run, centres, judge
from camgeo_export.interpreter.run import run
from tests.judges import rs274
from tests.judges.paths import difference
from tests.judges.programs import random_contour
from tests.long_form import examples

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


def of(body: str, machine: str = "linuxcnc") -> Run:
    return run(HEAD + body + END, load(machine))


def ends(found: Run, radius: float) -> list[complex]:
    moves = centres(found.moves, lambda _: radius)
    return [move.end for move in moves if move.kind != "rapid" and move.start != move.end]


def test_an_inner_corner_is_cut_where_the_parallels_meet() -> None:
    found = of(EDGE.format("G1 X20 Y20\n"))
    assert ends(found, 2.0) == pytest.approx([2j, 18 + 2j, 18 + 20j, 40 + 40j])


def test_an_outer_corner_is_rounded() -> None:
    found = of(EDGE.format("G1 X20 Y-20\n"))
    assert ends(found, 2.0) == pytest.approx([2j, 20 + 2j, 22 + 0j, 22 - 20j, 40 + 40j])
    (arc,) = (move for move in centres(found.moves, lambda _: 2.0) if move.kind == "arc")
    assert arc.centre == 20 + 0j
    assert arc.sweep == pytest.approx(-0.5 * math.pi)


def test_a_negative_offset_is_one_on_the_other_side() -> None:
    """The corner is an outer one for it."""
    found = of(EDGE.format("G1 X20 Y20\n"))
    assert ends(found, -2.0) == pytest.approx([-2j, 20 - 2j, 22 + 0j, 22 + 20j, 40 + 40j])


def test_arcs_keep_their_centre_and_change_their_radius() -> None:
    """Inside, outside, and with a corner between line and arc."""
    found = of(EDGE.format("G3 X30 Y10 I0 J10\nG2 X40 Y20 I10 J0\nG1 X50 Y20\n"))
    moves = [move for move in centres(found.moves, lambda _: 2.0) if move.kind == "arc"]
    inner, outer = moves
    assert [abs(inner.start - inner.centre), abs(inner.end - inner.centre)] == pytest.approx([8, 8])
    assert [abs(outer.start - outer.centre), abs(outer.end - outer.centre)] == pytest.approx(
        [12] * 2
    )
    assert inner.sweep == pytest.approx(0.5 * math.pi)
    assert outer.sweep == pytest.approx(-0.5 * math.pi)


def test_moves_along_z_stay_beside_the_path_and_without_an_offset_nothing_changes() -> None:
    found = of(EDGE.format("G1 Z-2\nG1 X20 Y20\n"))
    moves = centres(found.moves, lambda _: 2.0)
    (down,) = (move for move in moves if move.z_end == -2.0 != move.z_start)
    assert down.start == down.end
    unchanged = centres(found.moves, lambda _: 0.0)
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
    judge(moves, lambda _: radius, findings)
    assert [finding.rule for finding in findings.found][: len(rules) or 1] == rules


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
    judge(of(body).moves, lambda _: 0.216, findings)
    assert [finding.rule for finding in findings.found] == []


def test_a_linter_takes_a_negative_offset_as_one_on_the_other_side() -> None:
    arc = EDGE.format("G3 X30 Y10 I0 J10\nG1 X30 Y30\n")
    for radius, rules in ((12.0, ["compensation", "gouge"]), (-12.0, ["compensation"])):
        linted = run(HEAD + arc + END, load("linuxcnc"), Bench(radii=((1, radius),)))
        assert [each.rule for each in linted.findings if each.concerns == "form"] == rules


def test_what_programs_add_to_the_table_is_read() -> None:
    def oversize(machine: str, *changes: tuple[str, str]) -> float:
        text = SINUMERIK if machine == "sinumerik" else HEIDENHAIN
        for change in changes:
            text = text.replace(*change)
        found = run(text, load(machine))
        assert [finding.rule for finding in found.findings if finding.concerns == "words"] == []
        (size,) = {move.oversize for move in found.moves if move.compensation}
        return size

    assert oversize("sinumerik") == -3.0
    assert oversize("sinumerik", ("OFFN=-3.0", "OFFN=0")) == 0.0
    assert oversize("heidenhain") == -3.0
    assert oversize("heidenhain", (" DR-3.0", "")) == 0.0
    assert oversize("heidenhain", (" DR-3.0", " DL+1.0 DR+0.5")) == 0.5


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
