"""Roots of slopes isolated in cells, for which no number of samples is fixed.

In a cell a slope is known at seven places, by the polynomial through them. How far the slope may be
off that is estimated by the last difference, and in a cell that was halved by how far the slope was
off the polynomial of the whole. A cell is decided where the polynomial, with that to spare, has no
root or is monotone, as its Bernstein coefficients show; else it is halved, until the value whose
slope it is cannot change in it by what could matter. So what is missed between the places changes
no value by more than `NEGLIGIBLE` of its size. That rests on the estimate, which holds for what is
analytic in a cell, and is not a proof. The borders of the formula must be ends of cells.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.numeric.roots import roots_in_rows

OfRows = Callable[[FloatArray, IntArray], FloatArray]
"""(n,), (n,) -> (n,) values at n arguments, given the numbers of their rows."""

DEGREE: Final = 6
"""Of the polynomial."""

PLACES: Final = DEGREE + 1
"""Places in a cell: as many as it has coefficients."""

SPARE: Final = 0.125
"""Of the last difference of the slopes in a cell, the error of the polynomial: four times the last
of its Chebyshev coefficients."""

SHARES: Final = np.linspace(0.0, 1.0, PLACES)

WIDEST: Final = math.pi / 32.0
"""Longest cell to begin with [rad]."""

INSIDE: Final = 1e-8
"""How far inside a piece its ends are taken, as a fraction of its length: far beyond the rounding
of a cam angle, and an extreme in between differs from the end value by this fraction squared."""

NEGLIGIBLE: Final = 1e-10
"""Change of a value, as a fraction of it, that may stay in an undecided cell."""

HALVINGS: Final = 24
"""Most rounds of halving."""

NOISY: Final = 4
"""Round from which a slope whose differences no longer shrink is taken for rounding."""

MOST: Final = 200_000
"""Most cells halved at once; a table of thousands of noisy rows needs some thousand."""


def _judging() -> FloatArray:
    """(7, 14) from values at `SHARES` to the Bernstein coefficients of the polynomial through them,
    the differences of these, and the last difference of the values.
    """
    share = SHARES[:, np.newaxis]
    columns = [
        math.comb(DEGREE, k) * share**k * (1.0 - share) ** (DEGREE - k) for k in range(PLACES)
    ]
    hull = np.linalg.inv(np.concatenate(columns, axis=1))
    last = np.diff(np.eye(PLACES), DEGREE, axis=0)
    return np.asarray(np.concatenate((hull, np.diff(hull, axis=0), last)).T)


def _between() -> FloatArray:
    """(7, 6) from values at `SHARES` to those of the polynomial in the middle between them."""
    middle = 0.5 * (SHARES[:-1] + SHARES[1:])
    powers = np.arange(PLACES)
    through = np.linalg.inv(SHARES[:, np.newaxis] ** powers)
    return np.asarray((middle[:, np.newaxis] ** powers @ through).T)


JUDGING: Final = _judging()
BETWEEN: Final = _between()


def cells_between(edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ends (n,), (n,) [rad] of the cells between neighbours of `edges` (m,), ascending, none longer
    than `WIDEST`.
    """
    counts = np.maximum(np.ceil(np.diff(edges) / WIDEST), 1.0).astype(np.intp)
    number = np.arange(int(np.sum(counts))) - np.repeat(np.cumsum(counts) - counts, counts)
    width = np.repeat(np.diff(edges) / counts, counts)
    low: FloatArray = np.repeat(edges[:-1], counts) + number * width
    return low, np.append(low[1:], edges[-1:])


def places_in(
    low: FloatArray, high: FloatArray, starts: FloatArray, ends: FloatArray
) -> FloatArray:
    """(n, 7) the places in the cells [low, high] (n,), off both ends of the pieces [start, end]
    (n,) in which they lie by `INSIDE`, because slopes may jump there.
    """
    inside = INSIDE * (ends - starts)
    low, high = np.maximum(low, starts + inside), np.minimum(high, ends - inside)
    places: FloatArray = low[:, np.newaxis] + (high - low)[:, np.newaxis] * SHARES
    places[:, -1] = high
    return places


def places_between(edges: FloatArray) -> FloatArray:
    """(n, 7) the places in the cells of the pieces between neighbours of `edges` (m,)."""
    low, high = cells_between(edges)
    piece = np.searchsorted(edges, 0.5 * (low + high)) - 1
    return places_in(low, high, edges[piece], edges[piece + 1])


def isolated_roots(
    slopes: OfRows, values: OfRows, places: FloatArray, known: FloatArray
) -> tuple[FloatArray, IntArray]:
    """(k,), (k,) the roots of slopes inside cells, cell by cell, and the numbers of their rows.

    Parameters
    ----------
    slopes : of r quantities, one for each row; each smooth inside the cells.
    values : what is extreme where the slope of a row vanishes.
    places : (n, 7) of the cells, see `places_in`.
    known : (r, n, 7) the slopes there.

    A slope that is 0 at all places of a cell has no root in it.
    """
    rows = len(known)
    row = np.repeat(np.arange(rows), len(places))
    x, slope = np.tile(places, (rows, 1)), known.reshape(-1, PLACES)
    off, last = np.zeros(len(x)), np.full(len(x), np.inf)
    ready = []
    for number in range(HALVINGS + 1):
        judged = slope @ JUDGING
        before, last = last, np.abs(judged[:, -1])
        error = np.maximum(SPARE * last, off)
        done = _decided(judged, error)
        if number >= NOISY:
            done |= last > 0.25 * before
        left = np.flatnonzero(~done)
        if len(left):
            at = values(x[left].ravel(), np.repeat(row[left], PLACES)).reshape(-1, PLACES)
            done[left] = _negligible(judged[left, :PLACES], error[left], at)
            left = np.flatnonzero(~done)
        if not len(left) or number == HALVINGS or len(left) > MOST:
            ready.append((x, slope, row))
            break
        ready.append((x[done], slope[done], row[done]))
        x, slope, row, last = x[left], slope[left], row[left], last[left]
        middle = 0.5 * (x[:, :-1] + x[:, 1:])
        there = slopes(middle.ravel(), np.repeat(row, DEGREE)).reshape(middle.shape)
        miss = np.abs(there - slope @ BETWEEN).reshape(-1, DEGREE // 2)
        off = np.max(miss, axis=1) / 32.0  # an error is 128 times less in a half
        x, slope = _halved(x, middle), _halved(slope, there)
        row, last = np.repeat(row, 2), np.repeat(last, 2)
    x, slope, row = (np.concatenate(each) for each in zip(*ready, strict=True))
    roots, cell = roots_in_rows(lambda at, cell: slopes(at, row[cell]), x, slope)
    return roots, row[cell]


def _halved(ends: FloatArray, middle: FloatArray) -> FloatArray:
    """(2 n, 7) rows of the halves of cells, from `ends` (n, 7) and the `middle` (n, 6) ones."""
    both = np.empty((len(ends), 2 * PLACES - 1))
    both[:, ::2], both[:, 1::2] = ends, middle
    return np.concatenate((both[:, :PLACES], both[:, PLACES - 1 :]), axis=1).reshape(-1, PLACES)


def _decided(judged: FloatArray, error: FloatArray) -> BoolArray:
    """(n,) whether the slopes of cells have at most one root: they keep their sign, or ascend, or
    descend, with the `error` (n,) to spare; or they are 0.
    """
    kinds = [0, PLACES]
    least = np.minimum.reduceat(judged[:, :-1], kinds, axis=1)
    most = np.maximum.reduceat(judged[:, :-1], kinds, axis=1)
    spare = error[:, np.newaxis]
    found: BoolArray = np.any((least > spare) | (most < -spare), axis=1)
    found |= (least[:, 0] == 0.0) & (most[:, 0] == 0.0)
    return found


def _negligible(hull: FloatArray, error: FloatArray, values: FloatArray) -> BoolArray:
    """(n,) whether roots that are missed change `values` (n, 7) by less than what matters.

    Between two of them the slope has the wrong sign, and is at most as large as the error and as
    what of its hull has that sign.
    """
    wrong = np.minimum(np.max(hull, axis=1), np.max(-hull, axis=1))
    share = 4.0 * (error + np.maximum(wrong, 0.0)) / np.max(np.abs(hull), axis=1)
    change = np.ptp(values, axis=1) * np.minimum(share, 1.0)
    found: BoolArray = change <= NEGLIGIBLE * np.max(np.abs(values), axis=1)
    return found
