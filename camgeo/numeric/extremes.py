"""Extremes and roots of functions over smooth pieces, many at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from camgeo.numeric.arrays import (
    ONE,
    AnyQuantity,
    BoolArray,
    FloatArray,
    IntArray,
    Many,
    Quantity,
    Side,
    merged,
)
from camgeo.units import TURN


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest or smallest value and the argument at which it is taken first.

    Where the quantity jumps, the value may be a one-sided limit.
    """

    value: float
    place: float


@dataclass(frozen=True, slots=True)
class Extremes:
    """Smallest and largest value of a quantity, signed."""

    lowest: Extreme
    highest: Extreme

    @property
    def magnitude(self) -> float:
        """The largest absolute value."""
        return max(abs(self.lowest.value), abs(self.highest.value))


def sampled_extremes(x: FloatArray, values: FloatArray) -> Extremes:
    """Smallest and largest of `values` (n,) at `x` (n,), in any order."""
    order = np.argsort(x, kind="stable")
    x, values = x[order], values[order]
    low, high = int(np.argmin(values)), int(np.argmax(values))
    return Extremes(
        Extreme(float(values[low]), float(x[low])), Extreme(float(values[high]), float(x[high]))
    )


SAMPLES: Final = 33
"""Points per piece of the first grid on which turning points are searched, see `_finer`."""

FEWEST_SAMPLES: Final = 5
MOST_POINTS: Final = 1_000_000
"""Most points of the whole grid: a curve with very many pieces has short ones, and each gets fewer
points."""

INSET: Final = 1e-7
"""Fraction of a piece by which its grid stays off its ends, where values have two sides."""

ROUNDING: Final = 8.0 * 2.0**-52
"""Values that differ by less than this fraction of the largest magnitude differ by rounding."""

SECTIONS: Final = 64
STEPS: Final = 6
"""Sections of a bracket; the two around the highest cut are the next bracket. Six rounds reach 1e-9
of its length; the value is then the extreme but for rounding. Golden section needs an eighth of the
values, but one by one, and the cost of a call does not depend on so few."""

ROUGH: Final = 0.5
"""Fourth differences above this fraction of the second ones show that a grid does not resolve a
curve: a wave has less than nine of its points."""

PARTS: Final = np.linspace(0.0, 1.0, 9)
"""Places in a cell of a grid that does not resolve the curve."""

ROUNDS: Final = 12
"""Most rounds of finer grids, to a cell of 2e-11 of a piece; and a cell that cannot exceed what is
known by `NEGLIGIBLE` of its size is left as it is."""

NEGLIGIBLE: Final = 1e-10
MOST_FINER: Final = 512
"""Most cells that are made finer at once: if more are unresolved, they hold rounding alone."""

TOPS: Final = (1.0,)
BOTTOMS: Final = (-1.0,)
BOTH: Final = (*TOPS, *BOTTOMS)
"""Signs that make turning points largest values."""


def sample_grid(edges: FloatArray) -> FloatArray:
    """(m, k) grid points, a row for each piece between two neighbours of `edges` (m + 1,)."""
    pieces = len(edges) - 1
    samples = int(np.clip(MOST_POINTS // max(pieces, 1), FEWEST_SAMPLES, SAMPLES))
    share = np.linspace(0.0, 1.0, samples)
    # The ends of a piece belong to two pieces; a little inside, each point has one value only.
    share[0], share[-1] = INSET, 1.0 - INSET
    return np.asarray(edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * share)


def piecewise_extremes(function: Quantity, edges: FloatArray) -> Extremes:
    """Smallest and largest value of `function` from the first of `edges` to the last.

    Parameters
    ----------
    function : (n,), side -> (n,); smooth between neighbouring edges, where it may jump.
    edges : (m + 1,) ascending, m >= 1.

    At the edges both one-sided values count. Between them, turning points of a grid are refined
    until the value is exact except for rounding. Where the fourth differences show that the grid
    does not resolve the function, and where it may exceed the extremes found so far, the grid is
    refined until it resolves the function or nothing relevant can be missed. This rests on the
    differences and is not a proof. If the value at an edge is extreme except for rounding, the edge
    is the place: near a flat top many arguments have that value.
    """
    return piecewise_extremes_of_many(ONE, function, edges)[0]


def piecewise_lowest(function: Quantity, edges: FloatArray) -> Extreme:
    """The smallest value alone, see `piecewise_extremes`; turning points that could only be the
    largest value are not refined.
    """
    return piecewise_extremes_of_many(ONE, function, edges, BOTTOMS)[0].lowest


def piecewise_highest(function: Quantity, edges: FloatArray) -> Extreme:
    """The largest value alone, see `piecewise_lowest`."""
    return piecewise_extremes_of_many(ONE, function, edges, TOPS)[0].highest


def piecewise_extremes_of_many(
    many: Many[AnyQuantity],
    quantity: AnyQuantity,
    edges: FloatArray,
    signs: tuple[float, ...] = BOTH,
) -> list[Extremes]:
    """`piecewise_extremes` of a quantity of each of `many` objects, with the same `edges` for all.

    Turning points are refined only for the kinds of extremes that `signs` select.
    """
    inside = sample_grid(edges)
    x, ends = inside.ravel(), np.concatenate((edges[:-1], edges[1:]))
    flat = many.everywhere(quantity, x, "right")
    sign, low, high, which = tops(inside, flat.reshape(many.count, *inside.shape), signs)

    def on_grid(places: FloatArray, bracket: IntArray) -> FloatArray:
        return many.paired_values(quantity, places, "right", which[bracket])

    turning = climbed(on_grid, sign, low, high, which)
    right_values = many.everywhere(quantity, edges[:-1], "right")
    left_values = many.everywhere(quantity, edges[1:], "left")
    end_values = np.concatenate((right_values, left_values), axis=1)
    turning_values = on_grid(turning, np.arange(len(which)))
    extremes = []
    for index in range(many.count):
        selected = which == index
        places = np.concatenate((ends, x, turning[selected]))
        values = np.concatenate((end_values[index], flat[index], turning_values[selected]))
        known = sampled_extremes(places, values)
        rows = flat[index].reshape(inside.shape)
        finer = _finer(partial(_object_values, many, quantity, index), inside, rows, known, signs)
        if len(finer[0]):
            pairs = zip((places, values), finer, strict=True)
            known = sampled_extremes(*(np.concatenate(pair) for pair in pairs))
        extremes.append(_snap_to_edges(known, ends, end_values[index]))
    return extremes


def _object_values(
    many: Many[AnyQuantity], quantity: AnyQuantity, index: int, x: FloatArray
) -> FloatArray:
    """(n,) the quantity of the object with that `index` among `many`, at x (n,)."""
    return many.paired_values(quantity, x, "right", np.full(len(x), index))


def _finer(
    function: Function,
    grid: FloatArray,
    values: FloatArray,
    known: Extremes,
    signs: tuple[float, ...],
) -> tuple[FloatArray, FloatArray]:
    """(k,), (k,) places and values of `function` on finer grids.

    The grids are refined where the rows of `grid` (m, n) with `values` (m, n) do not resolve the
    function and where it may exceed the extremes that are `known`.
    """
    best = {sign: max(sign * known.lowest.value, sign * known.highest.value) for sign in signs}
    places, refined = [np.empty(0)], [np.empty(0)]
    excess = _unresolved(values)
    for _ in range(ROUNDS):
        if not np.any(excess):
            break
        wanted = np.zeros(excess.shape, dtype=np.bool_)
        for sign, height in best.items():
            ends = np.maximum(sign * values[:, :-1], sign * values[:, 1:])
            # Only a cell in which the curve may exceed the best value so far needs a finer grid.
            wanted |= ends + excess > height + NEGLIGIBLE * abs(height)
        row, cell = np.nonzero(wanted & (excess > 0.0))
        if not 0 < len(row) <= MOST_FINER:
            break
        low, high = grid[row, cell], grid[row, cell + 1]
        grid = low[:, np.newaxis] + (high - low)[:, np.newaxis] * PARTS
        values = function(grid.ravel()).reshape(grid.shape)
        excess = _unresolved(values)
        smooth = ~np.all(excess, axis=1)  # a row unresolved throughout yields no brackets
        turning = np.empty(0)
        if np.any(smooth):
            climbing = tops(grid[smooth], values[np.newaxis, smooth], tuple(best))
            turning = climbed(lambda x, _: function(x), *climbing)
        places += [grid.ravel(), turning]
        refined += [values.ravel(), function(turning)]
        for sign, height in best.items():
            # Each round raises the bar for the next one.
            best[sign] = max(
                height, *(float(np.max(sign * e, initial=height)) for e in refined[-2:])
            )
    return np.concatenate(places), np.concatenate(refined)


def _unresolved(values: FloatArray) -> FloatArray:
    """(m, n - 1) how far a curve may exceed both of two neighbouring `values` (m, n) between them;
    0 where the values resolve the curve.
    """
    fourth, second = (np.abs(np.diff(values, order, axis=1)) for order in (4, 2))
    # A fourth difference spans five values, hence three second differences; the largest counts.
    bend = np.maximum(np.maximum(second[:, :-2], second[:, 1:-1]), second[:, 2:])
    # It is centred on the third of its five values: two more on each side give one for each value.
    excess = np.pad(np.where(fourth > ROUGH * bend, fourth, 0.0), ((0, 0), (2, 2)), mode="edge")
    return np.asarray(np.maximum(excess[:, :-1], excess[:, 1:]))


def _snap_to_edges(extremes: Extremes, edges: FloatArray, values: FloatArray) -> Extremes:
    """The same `extremes`, moved to an edge if the value there equals them but for rounding."""
    rounding = ROUNDING * extremes.magnitude

    def placed(extreme: Extreme) -> Extreme:
        same = np.abs(values - extreme.value) <= rounding
        if not np.any(same):
            return extreme
        place = float(np.min(edges[same]))
        return Extreme(float(values[same & (edges == place)][0]), place)

    return Extremes(placed(extremes.lowest), placed(extremes.highest))


def tops(
    grid: FloatArray, values: FloatArray, signs: tuple[float, ...] = BOTH
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """The turning points of q quantities with `values` (q, m, n) along the rows of `grid` (m, n).

    Of the kinds selected by `signs`; those that cannot be the largest or the smallest value of
    their quantity are omitted.

    Returns
    -------
    (k,) each: the sign, +1 for a top and -1 for a bottom, the low and the high end of the bracket,
    and the number of the quantity.
    """
    padded = np.concatenate((grid[:, :1], grid, grid[:, -1:]), axis=1)
    lows, highs = (
        np.broadcast_to(neighbours, values.shape) for neighbours in (padded[:, :-2], padded[:, 2:])
    )
    # A constant row has tops at its ends, as the padding beyond them is lower.
    moving = np.ptp(values, axis=-1, keepdims=True) > 0.0
    brackets = []
    for sign in signs:
        heights = sign * values
        inner = np.pad(heights, ((0, 0), (0, 0), (1, 1)), constant_values=-np.inf)
        left, right = inner[..., :-2], inner[..., 2:]
        top = (heights >= left) & (heights >= right)
        # Of a plateau only the ends count, not every point on it.
        top &= (heights > left) | (heights > right)
        # A parabola through three points rises above the middle one by at most an eighth of the
        # larger difference; what cannot reach the largest value even with that is omitted.
        ends = heights[..., :1], heights[..., -1:]
        falls = np.abs(np.diff(heights, axis=-1, prepend=ends[0], append=ends[1]))
        highest = np.max(heights, axis=(-2, -1), keepdims=True)
        top &= heights + np.maximum(falls[..., :-1], falls[..., 1:]) >= highest
        top &= moving
        owner = np.nonzero(top)[0]
        brackets.append((np.full(len(owner), sign), lows[top], highs[top], owner))
    top_sign, low, high, which = (np.concatenate(column) for column in zip(*brackets, strict=True))
    return top_sign, low, high, which


def climbed(
    function: Callable[[FloatArray, IntArray], FloatArray],
    sign: FloatArray,
    low: FloatArray,
    high: FloatArray,
    which: IntArray,
) -> FloatArray:
    """Place of the largest sign * function in each bracket [low, high] (k,), which has one maximum.

    The function takes places and the number of the bracket of each. A bracket that cannot reach the
    largest value of its quantity `which` (k,) is not refined any further, like one omitted by
    `tops`.
    """
    if not len(low):
        return low
    share = np.arange(1.0, SECTIONS) / SECTIONS
    # Tops and bottoms of a quantity do not compete with each other, so each is a group of its own.
    best, group = low.copy(), 2 * which + (sign > 0.0)
    left = np.arange(len(low))
    for _ in range(STEPS):
        grid = low[:, np.newaxis] + (high - low)[:, np.newaxis] * share
        values = function(grid.ravel(), np.repeat(left, SECTIONS - 1))
        heights = sign[left, np.newaxis] * values.reshape(grid.shape)
        row, top = np.arange(len(left)), np.argmax(heights, axis=1)
        best[left], peaks = grid[row, top], heights[row, top]
        width = (high - low) / SECTIONS
        low, high = best[left] - width, best[left] + width
        highest = np.full(2 * int(np.max(which)) + 2, -np.inf)
        np.maximum.at(highest, group[left], peaks)
        # Between two cuts the curve cannot rise above the peak by more than it changes over a
        # section.
        rise = np.max(np.abs(np.diff(heights, axis=1)), axis=1)
        promising = peaks + rise >= highest[group[left]]
        left, low, high = left[promising], low[promising], high[promising]
    return best


def dips(function: Function, grid: FloatArray) -> FloatArray:
    """Places between points of `grid` where `function` has the sign opposite to that of the three
    points around them, which a search for sign changes on the grid would miss.

    A parabola through three points falls below the middle one by at most 1/8 of the larger
    difference; where twice that could change the sign, the minimum is computed.
    """
    values = function(grid.ravel()).reshape(grid.shape)
    size = np.abs(values)
    left, middle, right = size[:, :-2], size[:, 1:-1], size[:, 2:]
    signs = np.sign(values)
    near = (signs[:, :-2] == signs[:, 1:-1]) & (signs[:, 2:] == signs[:, 1:-1])
    near &= (middle <= left) & (middle <= right) & (middle > 0.0)
    near &= 4.0 * middle <= np.maximum(left, right) - middle
    dip_places = []
    for row, column in np.argwhere(near):
        sign = signs[row, column + 1]

        # The default binds the sign of this turn of the loop.
        def upright(phi: FloatArray, _side: Side, sign: float = sign) -> FloatArray:
            return sign * function(phi)

        lowest = piecewise_lowest(upright, grid[row, [column, column + 2]])
        if lowest.value < 0.0:
            dip_places.append(lowest.place)
    return np.array(dip_places)


def stretch_below(
    function: Callable[[FloatArray], FloatArray], edges: FloatArray, place: float
) -> tuple[float, float] | None:
    """Start and end [rad] of the stretch around `place` in which `function` is negative.

    Parameters
    ----------
    function : (n,) -> (n,), smooth between neighbouring edges.
    edges : (k,) angles from 0 to 2 pi, both included, ascending.
    place : angle at which the function is lowest [rad].

    Returns
    -------
    As for `stretch_around`; None if the function is negative nowhere, or at `place` alone. A root
    closer to an edge than the fraction `INSET` of the piece counts as at the edge.
    """
    cuts = with_roots(function, merged(np.concatenate((edges, [place]))))
    return stretch_around(cuts, function(0.5 * (cuts[:-1] + cuts[1:])) < 0.0, place)


def stretch_around(cuts: FloatArray, inside: BoolArray, place: float) -> tuple[float, float] | None:
    """Start and end [rad] of the stretch around `place` all of whose pieces are inside.

    Parameters
    ----------
    cuts : (n + 1,) angles from 0 to 2 pi, both included, ascending; `place` is one of them.
    inside : (n,) whether the piece after each cut, up to the next one, is inside.

    Returns
    -------
    (0, 2 pi) for a whole turn; else the end lies in [0, 2 pi), below the start if the stretch
    passes the end of the turn. None if neither piece next to `place` is inside.
    """
    if np.all(inside):
        return 0.0, TURN
    pieces = len(inside)
    following = int(np.searchsorted(cuts, place)) % pieces
    if not (inside[following] or inside[following - 1]):
        return None
    # A negative index counts from the end of the turn, so the walk backwards needs no remainder.
    first = last = following if inside[following] else (following - 1) % pieces
    while inside[first - 1]:
        first -= 1
    while inside[(last + 1) % pieces]:
        last += 1
    return float(cuts[first % pieces]), float(cuts[last % pieces + 1]) % TURN


# -- isolation ------------------------------------------------------------------------------------
# Roots of slopes isolated in cells, for which no number of samples is fixed.
#
# In a cell a slope is evaluated at seven places and represented by the polynomial through them. The
# error of the polynomial is estimated by the last difference and, in a cell that was halved, by the
# distance of the slope from the polynomial of the whole cell. A cell is decided if the polynomial,
# with a margin of this error, has no root, or is monotone, or has no more roots than its values
# have sign changes, as its Bernstein coefficients show. Otherwise the cell is halved, until the
# value whose slope it is cannot change in it by a relevant amount. So roots that are missed change
# no value by more than `NEGLIGIBLE_CHANGE` of its size. This rests on the estimate, which holds for
# functions that are analytic in a cell, and is not a proof. The borders of the formula must be ends
# of cells.


OfRows = Callable[[FloatArray, IntArray], FloatArray]
"""(n,), (n,) -> (n,) values at n arguments, given the numbers of their rows."""

DEGREE: Final = 6
"""Degree of the polynomial that represents a slope in a cell."""

PLACES: Final = DEGREE + 1
"""Places in a cell: as many as the polynomial has coefficients."""

SPARE: Final = 0.125
"""Error of the polynomial as a fraction of the last difference of the slopes in a cell: four times
the last Chebyshev coefficient."""

SHARES: Final = np.linspace(0.0, 1.0, PLACES)

WIDEST: Final = math.pi / 32.0
"""Length of the longest initial cell [rad]."""

INSIDE: Final = 1e-8
"""Distance of the outermost places from the ends of a piece, as a fraction of its length: far more
than the rounding of a cam angle, while an extreme in between differs from the end value by the
square of this fraction only."""

NEGLIGIBLE_CHANGE: Final = 1e-10
"""Change of a value, as a fraction of it, that may stay in an undecided cell."""

HALVINGS: Final = 24
"""Most rounds of halving."""

NOISY, SHRINKING = 5, 0.125
"""Round from which a slope counts as rounding if its last difference does not shrink to this
fraction; that of a resolved slope shrinks to 1/64 with every halving, as it is of sixth order."""

RESOLVED: Final = 0.02
"""Largest error, as a fraction of the slope, with which sign changes are counted."""

MOST: Final = 200_000
"""Most cells halved at once; a table of thousands of noisy rows needs some thousand."""


def _bernstein_matrix() -> FloatArray:
    """(7, 14) matrix that turns the values at `SHARES`, as a row, into the 7 Bernstein coefficients
    of the polynomial through them, their 6 differences, and the last difference of the values.
    """
    share = SHARES[:, np.newaxis]
    columns = [
        math.comb(DEGREE, k) * share**k * (1.0 - share) ** (DEGREE - k) for k in range(PLACES)
    ]
    # The columns are the Bernstein polynomials at `SHARES`; the inverse gives the coefficients from
    # the values.
    hull = np.linalg.inv(np.concatenate(columns, axis=1))
    last = np.diff(np.eye(PLACES), DEGREE, axis=0)
    return np.asarray(np.concatenate((hull, np.diff(hull, axis=0), last)).T)


def _midpoint_matrix() -> FloatArray:
    """(7, 6) matrix that turns the values at `SHARES`, as a row, into those of the polynomial
    through them midway between neighbouring places.
    """
    middle = 0.5 * (SHARES[:-1] + SHARES[1:])
    powers = np.arange(PLACES)
    through = np.linalg.inv(SHARES[:, np.newaxis] ** powers)
    return np.asarray((middle[:, np.newaxis] ** powers @ through).T)


BERNSTEIN_MATRIX: Final = _bernstein_matrix()
MIDPOINT_MATRIX: Final = _midpoint_matrix()


def isolation_cells(edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ends (n,), (n,) [rad] of the cells between neighbours of `edges` (m,), ascending, none longer
    than `WIDEST`.
    """
    counts = np.maximum(np.ceil(np.diff(edges) / WIDEST), 1.0).astype(np.intp)
    number = np.arange(int(np.sum(counts))) - np.repeat(np.cumsum(counts) - counts, counts)
    width = np.repeat(np.diff(edges) / counts, counts)
    low: FloatArray = np.repeat(edges[:-1], counts) + number * width
    return low, np.append(low[1:], edges[-1:])


def cell_places(
    low: FloatArray, high: FloatArray, starts: FloatArray, ends: FloatArray
) -> FloatArray:
    """(n, 7) the places in the cells [low, high] (n,).

    They stay clear of both ends of the pieces [start, end] (n,) that contain the cells, by the
    fraction `INSIDE`, because slopes may jump there.
    """
    inside = INSIDE * (ends - starts)
    low, high = np.maximum(low, starts + inside), np.minimum(high, ends - inside)
    places: FloatArray = low[:, np.newaxis] + (high - low)[:, np.newaxis] * SHARES
    # low + (high - low) may be rounded beyond the end of the cell.
    places[:, -1] = high
    return places


def isolation_places(edges: FloatArray) -> FloatArray:
    """(n, 7) the places in all `isolation_cells` between neighbours of `edges` (m,)."""
    low, high = isolation_cells(edges)
    piece = np.searchsorted(edges, 0.5 * (low + high)) - 1
    return cell_places(low, high, edges[piece], edges[piece + 1])


def isolated_roots(
    slopes: OfRows, values: OfRows, places: FloatArray, known: FloatArray
) -> tuple[FloatArray, IntArray]:
    """(k,), (k,) the roots of slopes inside cells, cell by cell, and the numbers of their rows.

    Parameters
    ----------
    slopes : slopes of r quantities, one for each row; each smooth inside the cells.
    values : the quantities themselves, which are extreme where the slope of their row vanishes.
    places : (n, 7) places in the cells, see `cell_places`.
    known : (r, n, 7) the slopes at these places.

    A slope that is 0 at all places of a cell has no root in it.
    """
    rows = len(known)
    # All cells of all quantities are one list; `row` says whose each of them is.
    row = np.repeat(np.arange(rows), len(places))
    x, slope = np.tile(places, (rows, 1)), known.reshape(-1, PLACES)
    estimate, last = np.zeros(len(x)), np.full(len(x), np.inf)
    ready = []
    for number in range(HALVINGS + 1):
        coefficients = slope @ BERNSTEIN_MATRIX
        previous, last = last, np.abs(coefficients[:, -1])
        error = np.maximum(SPARE * last, estimate)
        # The cheap criteria come first: each of them is applied only to the cells that those before
        # it have left.
        decided = _decided(coefficients, error)
        if number >= NOISY:
            decided |= last > SHRINKING * previous
        undecided = np.flatnonzero(~decided)
        decided[undecided] = _counted(
            coefficients[undecided, :PLACES], error[undecided], slope[undecided]
        )
        undecided = undecided[~decided[undecided]]
        if len(undecided):
            cell_values = values(x[undecided].ravel(), np.repeat(row[undecided], PLACES)).reshape(
                -1, PLACES
            )
            decided[undecided] = _negligible(
                coefficients[undecided, :PLACES], error[undecided], cell_values
            )
            undecided = np.flatnonzero(~decided)
        if not len(undecided) or number == HALVINGS or len(undecided) > MOST:
            ready.append((x, slope, row))
            break
        ready.append((x[decided], slope[decided], row[decided]))
        x, slope, row, last = x[undecided], slope[undecided], row[undecided], last[undecided]
        middle = 0.5 * (x[:, :-1] + x[:, 1:])
        middle_slopes = slopes(middle.ravel(), np.repeat(row, DEGREE)).reshape(middle.shape)
        # The six new values, three in each half, show how far the polynomial of the whole cell was
        # off.
        miss = np.abs(middle_slopes - slope @ MIDPOINT_MATRIX).reshape(-1, DEGREE // 2)
        estimate = np.max(miss, axis=1) / 32.0  # an error is 128 times less in a half
        x, slope = _halved(x, middle), _halved(slope, middle_slopes)
        row, last = np.repeat(row, 2), np.repeat(last, 2)
    x, slope, row = (np.concatenate(parts) for parts in zip(*ready, strict=True))
    roots, cell = roots_in_rows(lambda arguments, cell: slopes(arguments, row[cell]), x, slope)
    return roots, row[cell]


def _halved(ends: FloatArray, middle: FloatArray) -> FloatArray:
    """(2 n, 7) rows for the halves of n cells, first and second half of each in turn.

    `ends` (n, 7) are the entries at the places of the whole cells, `middle` (n, 6) those midway
    between them.
    """
    both = np.empty((len(ends), 2 * PLACES - 1))
    both[:, ::2], both[:, 1::2] = ends, middle
    # The middle entry of the thirteen belongs to both halves.
    return np.concatenate((both[:, :PLACES], both[:, PLACES - 1 :]), axis=1).reshape(-1, PLACES)


def _decided(coefficients: FloatArray, error: FloatArray) -> BoolArray:
    """(n,) whether the slope in each cell has at most one root: it keeps its sign, or ascends, or
    descends, with a margin of `error` (n,); or it is 0 throughout.

    `coefficients` (n, 14) are those that `_bernstein_matrix` gives.
    """
    # Extremes of two groups of columns: the coefficients bound the slope, their differences its
    # derivative.
    kinds = [0, PLACES]
    least = np.minimum.reduceat(coefficients[:, :-1], kinds, axis=1)
    most = np.maximum.reduceat(coefficients[:, :-1], kinds, axis=1)
    spare = error[:, np.newaxis]
    decided: BoolArray = np.any((least > spare) | (most < -spare), axis=1)
    decided |= (least[:, 0] == 0.0) & (most[:, 0] == 0.0)
    return decided


def _counted(hull: FloatArray, error: FloatArray, slopes: FloatArray) -> BoolArray:
    """(n,) whether the `slopes` (n, 7) have as many sign changes as their Bernstein coefficients
    `hull` (n, 7).

    A polynomial has at most as many roots as its coefficients have sign changes, so then the values
    show them all. Counts only where every coefficient exceeds the `error` (n,) and this is small.
    """
    sure = np.min(np.abs(hull), axis=1) > error
    sure &= error < RESOLVED * np.max(np.abs(slopes), axis=1)
    most, seen = (
        np.count_nonzero(np.diff(np.sign(numbers), axis=1), axis=1) for numbers in (hull, slopes)
    )
    return np.asarray(sure & (most == seen))


def _negligible(hull: FloatArray, error: FloatArray, values: FloatArray) -> BoolArray:
    """(n,) whether roots that are missed change the `values` (n, 7) by a negligible amount.

    Between two missed roots the slope has the opposite sign; its magnitude there is at most the
    error plus the largest coefficient of `hull` with that sign.
    """
    wrong = np.minimum(np.max(hull, axis=1), np.max(-hull, axis=1))
    share = 4.0 * (error + np.maximum(wrong, 0.0)) / np.max(np.abs(hull), axis=1)
    change = np.ptp(values, axis=1) * np.minimum(share, 1.0)
    return np.asarray(change <= NEGLIGIBLE_CHANGE * np.max(np.abs(values), axis=1))


# -- roots ----------------------------------------------------------------------------------------
# Bracketed roots and inverses of functions, many at once.
#
# scipy's solvers take one bracket at a time and their import takes longer than the rest of a check;
# this gives the same guarantee (the root never leaves its bracket) over arrays.


Function = Callable[[FloatArray], FloatArray]

MAX_STEPS = 200
"""Most steps; bisection alone needs 1,074 for any two doubles and 60 for two of similar size."""


def bracketed_roots(
    function: Function,
    low: FloatArray,
    high: FloatArray,
    rows: IntArray | None = None,
    ends: FloatArray | None = None,
) -> FloatArray:
    """`indexed_roots` of a `function` (k,) -> (k,) that is the same for all brackets.

    For a function that gives (m, k) values, of m quantities at once, `rows` (n,) says which of the
    quantities has its root in each bracket.
    """

    def values(x: FloatArray, which: IntArray) -> FloatArray:
        all_values = function(x)
        return all_values if rows is None else all_values[rows[which], np.arange(len(x))]

    return indexed_roots(values, low, high, ends)


def indexed_roots(
    function: Callable[[FloatArray, IntArray], FloatArray],
    low: FloatArray,
    high: FloatArray,
    ends: FloatArray | None = None,
) -> FloatArray:
    """Return one root in each bracket.

    Parameters
    ----------
    function : (k,), (k,) -> (k,), the values at k arguments, given the numbers of their brackets;
        any subset of the brackets may be requested.
    low, high : (n,), ends of the brackets; the values there have opposite signs or are zero.
    ends : (2, n) these values, if they are known.

    Returns
    -------
    (n,) the roots, to the last bits of the argument.

    Chandrupatla's method: inverse quadratic interpolation where it is safe, bisection elsewhere
    (T. R. Chandrupatla, Adv. Eng. Software 28 (1997) 145-149).
    """
    if not len(low):
        return np.array(low, dtype=np.float64)
    # For each bracket, as rows x and f(x): a is the newest place, b the one on the other side of
    # the root, c the place that was a or b before.
    every = np.arange(len(low))
    f_low, f_high = (function(low, every), function(high, every)) if ends is None else ends
    a, b = np.stack((high, f_high)), np.stack((low, f_low))
    c = a.copy()
    # The first step is a bisection; interpolation needs three places.
    step = np.full_like(a[0], 0.5)
    root: FloatArray = np.where(np.abs(a[1]) < np.abs(b[1]), a[0], b[0])
    # A bracket with a root at an end is already solved.
    active = np.flatnonzero((a[1] != 0.0) & (b[1] != 0.0))
    for _ in range(MAX_STEPS):
        if not len(active):
            break
        previous, across = a[:, active], b[:, active]
        x = previous[0] + step[active] * (across[0] - previous[0])
        new = np.stack((x, function(x, active)))
        same = np.sign(new[1]) == np.sign(previous[1])
        last = np.where(same, previous, across)
        across = np.where(same, across, previous)
        a[:, active], b[:, active], c[:, active] = new, across, last
        nearer = np.abs(new[1]) < np.abs(across[1])
        root[active] = np.where(nearer, new[0], across[0])
        width, floor = np.abs(across[0] - new[0]), np.spacing(np.abs(root[active]))
        # A bracket two spacings wide cannot be narrowed by another step that lies inside it.
        active = active[(new[1] != 0.0) & (width > 2.0 * floor)]
        step[active] = _next_step(a[:, active], b[:, active], c[:, active])
    return root


def _next_step(newest: FloatArray, across: FloatArray, last: FloatArray) -> FloatArray:
    """Fraction of the way from the `newest` place to that `across` the root for the next step."""
    (a, fa), (b, fb), (c, fc) = newest, across, last
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        xi = (a - b) / (c - b)
        phi = (fa - fb) / (fc - fb)
        # Chandrupatla: only there is the inverse quadratic through the three places monotone in the
        # bracket.
        quadratic = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        # A step below the spacing of a would not move the place at all.
        smallest = np.spacing(np.abs(a)) / np.abs(b - a)
    t = np.where(quadratic & np.isfinite(t), t, 0.5)
    smallest = np.minimum(smallest, 0.5)
    return np.asarray(np.clip(t, smallest, 1.0 - smallest))


def sign_changes(grid: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the ends (k,), (k,) of the grid cells over which `values` changes sign.

    `values` (..., m) at `grid` (..., m), see `_changing`.
    """
    change = _changing(values)
    return grid[..., :-1][change], grid[..., 1:][change]


def _changing(values: FloatArray) -> BoolArray:
    """(..., m - 1) the grid cells over which `values` (..., m) changes sign.

    Each row has a grid of its own; the cells come row by row. A grid point that is a root itself
    makes one cell, to its right (to its left for the last of a row).
    """
    sign = np.sign(values)
    change: BoolArray = sign[..., :-1] * sign[..., 1:] < 0.0
    change |= (sign[..., :-1] == 0.0) & (sign[..., 1:] != 0.0)
    # A root at the last point has no cell to its right.
    change[..., -1] |= (sign[..., -1] == 0.0) & (sign[..., -2] != 0.0)
    return change


def roots_on_grid(function: Function, grid: FloatArray) -> FloatArray:
    """Roots of `function` indicated by a sign change along a row of `grid` (..., m), row by row.

    One call of the function evaluates all rows. For a function that gives k quantities at once,
    (k, n), the roots of all of them are returned, one quantity after the other.
    """
    flat_values = function(grid.ravel())
    values = flat_values.reshape(flat_values.shape[:-1] + grid.shape)
    # The rows of all quantities are numbered one after the other, `row_count` for each quantity.
    row_count = math.prod(grid.shape[:-1])

    def in_row(x: FloatArray, row: IntArray) -> FloatArray:
        row_values = function(x)
        return (
            row_values if row_values.ndim == 1 else row_values[row // row_count, np.arange(len(x))]
        )

    return roots_in_rows(in_row, grid, values)[0]


def with_roots(function: Function, edges: FloatArray) -> FloatArray:
    """(k,) `edges` and the roots of `function` between them, see `roots_on_grid`."""
    return merged(np.concatenate((edges, roots_on_grid(function, sample_grid(edges)))))


def roots_in_rows(
    function: Callable[[FloatArray, IntArray], FloatArray], grid: FloatArray, values: FloatArray
) -> tuple[FloatArray, IntArray]:
    """(k,), (k,) roots indicated by a sign change along a row of `values` (..., m), and the numbers
    of their rows, counted over all rows.

    Parameters
    ----------
    function : (n,), (n,) -> (n,), the values at n arguments, given the numbers of their rows.
    grid : (m,), or (..., m) for the last of the rows, the arguments of `values`.
    """
    change = _changing(values)
    sides = (slice(None, -1), slice(1, None))
    low, high = (np.broadcast_to(grid[..., side], change.shape)[change] for side in sides)
    ends = np.stack([values[..., side][change] for side in sides])
    row = np.flatnonzero(change) // change.shape[-1]
    return indexed_roots(lambda x, which: function(x, row[which]), low, high, ends), row


MOST_STEPS: Final = 80
"""Most steps; halving alone needs 60."""

CLOSE: Final = 2.0 * float(np.finfo(np.float64).eps)
"""Fraction of the range of x below which a step of Newton's method counts as rounding."""


def inverse(function: Function, slope: Function, edges: FloatArray, y: FloatArray) -> FloatArray:
    """(n,) x with function(x) = `y` (n,), to the last bits.

    Parameters
    ----------
    function : (k,) -> (k,), ascending over `edges`.
    slope : its derivative, above 0.
    edges : (m + 1,) ascending, with `y` between the values at the first and the last; at the value
        of an edge the result is the edge itself.

    Newton's method, kept in its bracket by halving.
    """
    marks = function(edges)
    piece = np.clip(np.searchsorted(marks, y, "right") - 1, 0, len(edges) - 2)
    low, high = edges[piece], edges[piece + 1]
    width = float(edges[-1] - edges[0])
    # Linear interpolation between the edges is the first approximation.
    x = low + (y - marks[piece]) / (marks[piece + 1] - marks[piece]) * (high - low)
    x = np.where(y >= marks[-1], edges[-1], x)
    for _ in range(MOST_STEPS):
        miss = function(x) - y
        low, high = np.where(miss < 0.0, x, low), np.where(miss > 0.0, x, high)
        step = x - miss / slope(x)
        # A step of Newton that leaves the bracket is replaced by a halving.
        step = np.where((step >= low) & (step <= high), step, 0.5 * (low + high))
        step = np.where(miss == 0.0, x, step)
        converged = np.abs(step - x) <= CLOSE * width
        x = step
        if np.all(converged):
            break
    return x


# -- polynomial -----------------------------------------------------------------------------------
# Polynomials by their coefficients in ascending powers.


NEARLY_REAL = 1e-6
"""Imaginary part up to which a root counts as real: a double root splits by 1e-8."""

VANISHING = 1e-40
"""A coefficient below this fraction of the largest one is far below the rounding of the others
wherever roots are searched, and quotients with it overflow."""

ROUNDING_OF_ROOTS = 1e-12
"""More than the rounding of a polynomial of the degrees used here near its maximum."""


def horner(coefficients: Sequence[float] | FloatArray, x: FloatArray) -> FloatArray:
    """The polynomial at `x` (n,).

    With (k, n) coefficients each x has its own polynomial; with (k, m, 1) the values (m, n) are
    those of m polynomials.
    """
    if len(coefficients) == 1:
        return np.full_like(x, coefficients[0])
    value = coefficients[-1] * x
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
    return value


def derivative(coefficients: Sequence[float]) -> list[float]:
    """Coefficients of the derivative."""
    return [power * c for power, c in enumerate(coefficients)][1:] or [0.0]


def product(first: Sequence[float], second: Sequence[float]) -> list[float]:
    """Coefficients of the product."""
    return [float(c) for c in np.convolve(first, second)]


def roots_inside(coefficients: Sequence[float], low: float, high: float) -> FloatArray:
    """Real roots in [low, high], ascending, to the last bits where they are simple."""
    descending = np.array(coefficients[::-1], dtype=np.float64)
    # `numpy.roots` divides by the leading coefficient.
    descending[np.abs(descending) < VANISHING * np.max(np.abs(descending))] = 0.0
    roots = np.roots(descending)
    # Far from 0 the imaginary part of a real root is rounded in proportion to its magnitude.
    scale = np.maximum(1.0, np.abs(roots))
    real: FloatArray = np.sort(roots.real[np.abs(roots.imag) < NEARLY_REAL * scale])
    least, most = 2.0 * low - high, 2.0 * high - low
    real = real[
        (real > least) & (real < most)
    ]  # a wider range, as refinement moves a root by its last digits
    slope = derivative(coefficients)
    for _ in range(2):  # Newton's method
        rise = horner(slope, real)
        value = horner(coefficients, real)
        with np.errstate(over="ignore"):  # at a candidate that is not a root, or not a simple one
            step = np.divide(value, rise, out=np.zeros_like(real), where=rise != 0.0)
        real = np.clip(real - step, least, most)
    return real[(real >= low) & (real <= high)]


def largest_magnitude(coefficients: Sequence[float], low: float, high: float) -> float:
    """Largest absolute value over [low, high], exact except for rounding upwards."""
    turns = roots_inside(derivative(coefficients), low, high)
    places = np.concatenate((turns, [low, high]))
    return float(np.max(np.abs(horner(coefficients, places)))) * (1.0 + ROUNDING_OF_ROOTS)
