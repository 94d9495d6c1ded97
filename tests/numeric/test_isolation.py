"""Isolated roots against polynomials and waves whose roots are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.numeric.extremes import (
    INSIDE,
    NEGLIGIBLE_CHANGE,
    WIDEST,
    OfRows,
    cells_between,
    isolated_roots,
    places_between,
)
from tests.strategies import attack

EPS = float(np.finfo(np.float64).eps)


def roots_of(slopes: OfRows, values: OfRows, edges: FloatArray, rows: int = 1) -> FloatArray:
    """The roots of all rows, ascending."""
    places = places_between(edges)
    known = np.stack([slopes(places.ravel(), np.full(places.size, row)) for row in range(rows)])
    known = known.reshape(rows, *places.shape)
    roots, _ = isolated_roots(slopes, values, places, known)
    return np.sort(roots)


def test_cells_end_at_every_edge_and_are_not_wide() -> None:
    edges = np.array([0.0, 1e-7, 1.0, 1.0 + 0.5 * WIDEST, 6.0])
    low, high = cells_between(edges)
    assert low[0] == edges[0]
    assert high[-1] == edges[-1]
    assert np.array_equal(low[1:], high[:-1])
    assert set(edges) <= {*low, edges[-1]}
    assert np.max(high - low) <= WIDEST * (1.0 + 4.0 * EPS)


def test_places_stay_off_the_edges() -> None:
    edges = np.array([0.0, 0.05, 3.0])
    places = places_between(edges)
    assert places[0, 0] == INSIDE * 0.05
    assert places[-1, -1] == 3.0 - INSIDE * 2.95
    assert np.all(np.diff(places, axis=1) > 0.0)


@attack
@given(
    middle=st.floats(0.01, 0.09),
    apart=st.floats(1e-3, 0.03),
    tilt=st.floats(-3.0, 3.0),
    size=st.floats(1e-6, 1e6),
)
def test_two_near_roots_in_one_cell_are_both_found(
    middle: float, apart: float, tilt: float, size: float
) -> None:
    """Nearer to each other than the places, on a slope that is no polynomial."""
    first, second = middle - 0.5 * apart, middle + 0.5 * apart
    assume(first > 1e-3)
    assume(second < 0.097)

    def slope(x: FloatArray, _: IntArray) -> FloatArray:
        return size * (x - first) * (x - second) * np.exp(tilt * x)

    def value(x: FloatArray, _: IntArray) -> FloatArray:
        return size * (x**3 / 3.0 - middle * x**2)  # of the same order as its integral

    found = roots_of(slope, value, np.array([0.0, WIDEST]))
    assert found == pytest.approx([first, second], rel=1e-13)


@pytest.mark.parametrize("waves", [3.0, 170.0, 500.0])
def test_all_roots_of_a_fast_wave(waves: float) -> None:
    """Of the fastest one a cell has eight waves, and seven places."""
    found = roots_of(
        lambda x, _: np.cos(waves * x), lambda x, _: np.sin(waves * x), np.array([0.0, 2.0])
    )
    count = math.floor(2.0 * waves / math.pi + 0.5)
    expected = (np.arange(count) + 0.5) * math.pi / waves
    assert found == pytest.approx(expected, rel=1e-12)


@attack
@given(place=st.floats(0.3, 0.7), depth=st.floats(-12.0, -2.0))
def test_what_is_missed_changes_no_value_by_what_matters(place: float, depth: float) -> None:
    """A slope that dips below 0 by 10^depth, however little: or the dip is negligible."""
    dip, end = 10.0**depth, 1.0

    def slope(x: FloatArray, _: IntArray) -> FloatArray:
        return np.asarray((x - place) ** 2 - dip)

    def value(x: FloatArray, _: IntArray) -> FloatArray:
        return np.asarray((x - place) ** 3 / 3.0 - dip * (x - place) + end)

    found = roots_of(slope, value, np.array([0.0, 1.0]))
    falls = 4.0 / 3.0 * dip**1.5  # between both roots
    if len(found) == 2:
        half = math.sqrt(dip)
        assert found == pytest.approx([place - half, place + half], abs=4.0 * EPS / half)
    else:
        assert not len(found)
        assert falls <= NEGLIGIBLE_CHANGE * end


def test_rounding_ends_the_halving() -> None:
    """Slopes that are all rounding: cells are halved a few times, not down to points."""
    asked: list[int] = []
    noise = np.random.default_rng(1)

    def slope(x: FloatArray, _: IntArray) -> FloatArray:
        asked.append(len(x))
        return np.asarray(1e-3 * noise.standard_normal(len(x)))

    def value(x: FloatArray, _: IntArray) -> FloatArray:
        return np.asarray(1.0 + 1e-9 * noise.standard_normal(len(x)))

    places = places_between(np.array([0.0, 6.0]))
    roots_of(slope, value, np.array([0.0, 6.0]))
    assert max(asked) < 50 * places.size


def test_rows_are_what_they_are_alone_and_zeros_have_no_root() -> None:
    phases = np.array([0.1, 0.7, 0.0])

    def slope(x: FloatArray, row: IntArray) -> FloatArray:
        return np.asarray(np.where(row == 2, 0.0, np.cos(9.0 * x + phases[row])))

    def value(x: FloatArray, row: IntArray) -> FloatArray:
        return np.asarray(np.sin(9.0 * x + phases[row]))

    edges = np.array([0.0, 1.0, 4.0])
    places = places_between(edges)
    known = np.stack(
        [slope(places.ravel(), np.full(places.size, k)).reshape(places.shape) for k in range(3)]
    )
    roots, rows = isolated_roots(slope, value, places, known)
    assert not np.any(rows == 2)
    for one in range(2):

        def own(function: OfRows, row: int = one) -> OfRows:
            return lambda x, _: function(x, np.full(len(x), row))

        alone, _ = isolated_roots(own(slope), own(value), places, known[one : one + 1])
        assert np.array_equal(np.sort(roots[rows == one]), np.sort(alone))
