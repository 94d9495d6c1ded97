"""Parallels of moves: the point where two neighbours meet is a radius away from both."""

from __future__ import annotations

import cmath
import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo_export.interpreter.moves import CutterMove, Kind, Parallel, meeting

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
    assert meeting(*left) == pytest.approx(-1 + 1j)
    assert left[0].share(-1 + 1j) == pytest.approx(0.9)
    assert left[1].share(-1 + 1j) == pytest.approx(0.1)


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
    assert off(before, point) == pytest.approx(RADIUS, abs=1e-9)
    assert off(after, point) == pytest.approx(RADIUS, abs=1e-9)
    for each in pair:
        share = each.share(point)
        place = each.move.start + (each.move.end - each.move.start) * share
        if each.move.kind == "arc":
            turned = cmath.exp(1j * each.move.sweep * share)
            place = each.move.centre + (each.move.start - each.move.centre) * turned
        assert abs(point - place) == pytest.approx(RADIUS, abs=1e-9)
        if share > 0.0:
            assert abs(each.beside(place) - point) == pytest.approx(0.0, abs=1e-6)


def test_an_arc_has_room_for_smaller_cutters_only() -> None:
    inner = Parallel(arc(0j, 1 + 0j, 5.0, math.pi), 1.0, 4.0)
    assert inner.room == pytest.approx(1.0)
    assert Parallel(inner.move, -1.0, 4.0).room == pytest.approx(9.0)
    assert Parallel(inner.move, 1.0, 6.0).room < 0.0
