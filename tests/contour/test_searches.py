"""Searches of pieces: arc splines for a given number of arcs, turns of the tangents of biarcs, and
the ladder of numbers of chords."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import ToleranceError
from camgeo.geometry.contour import fewest_chords as ladder_module
from camgeo.geometry.contour.arcs import (
    OUTERMOST,
    Strands,
    arc_splines,
    tangent_turns,
)
from camgeo.geometry.contour.fewest_chords import (
    Evened,
    Ladder,
    Stretched,
    StretchTable,
    stretch_table,
)
from camgeo.geometry.contour.legs import bends_of
from camgeo.geometry.pieces import smooth_pieces
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from tests.contour.cams import FLANKS, TURN, dwell, flank, translating


def _strands(name: tuple[str, int]) -> Strands:
    curve = flank(*name)
    pieces = [piece for piece in smooth_pieces(curve) if not piece.dwell]
    return Strands.of(curve, pieces, bends_of(curve, pieces))


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_a_spline_depends_on_its_piece_and_number_alone(name: tuple[str, int]) -> None:
    strands = _strands(name)
    pieces: IntArray = np.arange(len(strands.difficulty.totals))
    together = arc_splines(strands, np.repeat(pieces, 2), np.tile([9, 14], len(pieces)))
    for number, count in ((0, 9), (1, 14)):
        for piece in pieces:
            (alone,) = arc_splines(strands, np.array([piece]), np.array([count]))
            other = together[2 * piece + number]
            # Sums over the batch round differently, some 1e-15; rounds that swing multiply it.
            assert alone.deviation == pytest.approx(other.deviation, rel=1e-9)
            assert alone.angles == pytest.approx(other.angles, abs=1e-9)


def test_a_circle_that_is_no_dwell_is_one_arc() -> None:
    """A rest taken for a move: constant curvature."""
    curve = translating(dwell(100), dwell(260))
    (piece,) = smooth_pieces(curve)
    short = type(piece)(0.0, 2.0)
    strands = Strands.of(curve, [short], bends_of(curve, [short]))
    (spline,) = arc_splines(strands, np.array([0]), np.array([1]))
    assert spline.deviation <= 1e-13
    chain = spline.chain()
    assert abs(chain.centres[0]) <= 1e-13 * 32.0 * 4.0
    assert abs(chain.sweeps[0]) == pytest.approx(2.0, rel=1e-14)


PLACES = np.arange(1, 6) / 6


def _turned(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """C1 quadratics over [0, 1] with a knot in the middle that are 0 at both ends, and have the
    slope 1 at the start, or at the end, and 0 at the other.
    """
    rows = []
    for slopes in ((1.0, 0.0), (0.0, 1.0)):
        # Bends b, c of the halves: s0 + (b + c)/2 = s1 and s0 + 3 b/8 + c/8 = 0.
        b, c = np.linalg.solve([[0.5, 0.5], [0.375, 0.125]], [slopes[1] - slopes[0], -slopes[0]])
        late = np.maximum(places - 0.5, 0.0)
        rows.append(slopes[0] * places + 0.5 * b * places**2 + 0.5 * (c - b) * late**2)
    return rows[0], rows[1]


@given(
    st.lists(st.lists(st.floats(0.1, 10.0), min_size=1, max_size=6), min_size=1, max_size=4),
    st.integers(0, 2**32 - 1),
)
def test_the_sum_of_squares_is_least(chains: list[list[float]], seed: int) -> None:
    lengths = np.concatenate(chains)
    apart = np.random.default_rng(seed).normal(size=(len(lengths), len(PLACES)))
    last = np.cumsum([len(chain) for chain in chains]) - 1
    turns = tangent_turns(apart, lengths, last)
    first, second = _turned(PLACES)
    start = 0
    for chain in chains:
        # Each chain by itself, by another way of solving.
        stop = start + len(chain)
        rows = np.zeros((len(chain), len(PLACES), len(chain) + 1))
        for k, length in enumerate(chain):
            rows[k, :, k], rows[k, :, k + 1] = length * first, length * second
        weight = np.ones(len(chain))
        weight[[0, -1]] = math.sqrt(OUTERMOST)
        matrix = (weight[:, None, None] * rows).reshape(-1, len(chain) + 1)[:, 1:-1]
        right = -(weight[:, None] * apart[start:stop]).ravel()
        joints = np.zeros(len(chain) + 1)
        if len(chain) > 1:
            joints[1:-1] = np.linalg.lstsq(matrix, right, rcond=None)[0]
        # Bands of cosines up to 0.6: a condition of ten, times that of the lengths squared.
        scale = max(1.0, float(np.max(np.abs(joints))))
        assert turns[0, start:stop] == pytest.approx(joints[:-1], abs=1e-9 * scale)
        assert turns[1, start:stop] == pytest.approx(joints[1:], abs=1e-9 * scale)
        start = stop


SHARE = 1.01
MANY = 100_000


def stretched(curve: WorkingCurve) -> Stretched:
    """A whole curve without corners."""

    def place(phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return curve.point(phi), curve.tangent(phi)

    return Stretched(
        stretch_table(curve, 0.0, TURN), place, curve.point, curve.pitch.rotation, closed=True
    )


def straight(length: float) -> Stretched:
    """A straight line from 10 mm on, aslant; t is the share of its `length` [mm]."""
    along = (2.0 + 1.0j) / abs(2.0 + 1.0j)
    grid, none = np.linspace(0.0, 1.0, 101), np.zeros(100)
    table = StretchTable(grid, none, none, np.full(100, 0.01 * length), (), np.zeros(1))

    def points(t: FloatArray) -> ComplexArray:
        return np.asarray(10.0 + length * along * t, dtype=np.complex128)

    def place(t: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return points(t), np.full(len(t), along)

    return Stretched(table, place, points, 1, closed=False)


@pytest.mark.parametrize("most", [0.1, 1e-2])
def test_a_layout_does_not_depend_on_the_tolerance(most: float) -> None:
    """A flank without inflections: as many pieces are the same pieces, whatever was asked."""
    ladder = Ladder.of(stretched(flank("vorschub", -1)))
    laid: dict[int, ComplexArray] = {}
    for tolerance in np.geomspace(most, 0.9 * most, 12):
        chords, found = ladder.fewest(float(tolerance), SHARE, MANY)
        assert found <= tolerance
        same = laid.setdefault(len(chords.worst), chords.vertices)
        assert np.array_equal(same, chords.vertices)
    assert 1 < len(laid) < 12


def test_layouts_that_do_not_help_are_few(monkeypatch: pytest.MonkeyPatch) -> None:
    laid: list[int] = []
    plain = ladder_module.evened

    def off(*arguments: Any) -> Evened:
        found = plain(*arguments)
        laid.append(len(found.chords.worst))
        return replace(found, chords=replace(found.chords, worst=10.0 * found.chords.worst))

    monkeypatch.setattr(ladder_module, "evened", off)
    monkeypatch.setattr(ladder_module, "LAID", 1_000)
    with pytest.raises(ToleranceError):
        Ladder.of(stretched(flank("vorschub", -1))).fewest(1e-3, SHARE, MANY)
    assert 1 < len(laid) < ladder_module.LAYOUTS
    assert sum(laid[:-1]) <= 1_000


@pytest.mark.parametrize("length", [1e-3, 5.0, 1e4])
def test_a_straight_stretch_is_one_piece(length: float) -> None:
    stretch = straight(length)
    chords, found = Ladder.of(stretch).fewest(1e-3, SHARE, MANY)
    assert len(chords.worst) == 1
    assert np.array_equal(chords.vertices, stretch.points(np.array([0.0, 1.0])))
    assert found <= 1e-14 * (10.0 + length)


def test_too_many_are_refused() -> None:
    ladder = Ladder.of(stretched(flank("setzhub", -1)))
    with pytest.raises(ToleranceError, match="more than 100 straight pieces"):
        ladder.fewest(1e-3, SHARE, 100)
