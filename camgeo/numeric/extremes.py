"""Largest and smallest values over smooth pieces, and the stretches around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, Side, merged
from camgeo.numeric.many import ONE, Asked, Many, Quantity
from camgeo.numeric.roots import Function, roots_on_grid
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


def extremes_of(x: FloatArray, values: FloatArray) -> Extremes:
    """Smallest and largest of `values` (n,) at `x` (n,), in any order."""
    order = np.argsort(x, kind="stable")
    x, values = x[order], values[order]
    low, high = int(np.argmin(values)), int(np.argmax(values))
    return Extremes(
        Extreme(float(values[low]), float(x[low])), Extreme(float(values[high]), float(x[high]))
    )


SAMPLES: Final = 33
"""Grid points per piece on which turning points are sought at first, see `_finer`."""

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


def grid_of(edges: FloatArray) -> FloatArray:
    """(m, k) grid points, a row for each piece between two neighbours of `edges` (m + 1,)."""
    pieces = len(edges) - 1
    samples = int(np.clip(MOST_POINTS // max(pieces, 1), FEWEST_SAMPLES, SAMPLES))
    share = np.linspace(0.0, 1.0, samples)
    share[0], share[-1] = INSET, 1.0 - INSET
    grid: FloatArray = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * share
    return grid


def piecewise_extremes(function: Quantity, edges: FloatArray) -> Extremes:
    """Smallest and largest value of `function` from the first of `edges` to the last.

    Parameters
    ----------
    function : (n,), side -> (n,); smooth between neighbouring edges, where it may jump.
    edges : (m + 1,) ascending, m >= 1.

    At the edges both one-sided values count. Inside, turning points of a grid are refined until the
    value is exact except for rounding. Where the grid does not resolve the function, as its own
    differences show, and it may be beyond what is known there, the grid is made finer until it does
    or nothing that matters can be left. This rests on the differences, and is no proof. Where an
    edge has the extreme value except for rounding, the edge is the place: near a flat top
    many arguments have that value.
    """
    return _extremes(function, edges, BOTH)


def piecewise_lowest(function: Quantity, edges: FloatArray) -> Extreme:
    """The smallest value alone, see `piecewise_extremes`: no turning point of the largest one is
    refined.
    """
    return _extremes(function, edges, BOTTOMS).lowest


def piecewise_highest(function: Quantity, edges: FloatArray) -> Extreme:
    """The largest value alone, see `piecewise_lowest`."""
    return _extremes(function, edges, TOPS).highest


def ceiling(function: Quantity, edges: FloatArray) -> float:
    """A bound of the largest value, for much less: nothing is refined, and each point of the grid
    counts with the larger of the steps to its neighbours, eight times what a parabola may rise.
    """
    grid = grid_of(edges)
    values = function(grid.ravel(), "right").reshape(grid.shape)
    steps = np.pad(np.abs(np.diff(values, axis=1)), ((0, 0), (1, 1)))
    inside = values + np.maximum(steps[:, :-1], steps[:, 1:])
    ends = function(edges[:-1], "right"), function(edges[1:], "left")
    return float(max(np.max(each) for each in (inside, *ends)))


def _extremes(function: Quantity, edges: FloatArray, signs: tuple[float, ...]) -> Extremes:
    """Both values; only those selected by `signs` are refined."""
    return extremes_of_each(ONE, function, edges, signs)[0]


def extremes_of_each(
    many: Many[Asked], quantity: Asked, edges: FloatArray, signs: tuple[float, ...] = BOTH
) -> list[Extremes]:
    """`piecewise_extremes` of a quantity of each of `many`, which jumps at the same `edges`.

    Of those that `signs` do not select, no turning point is refined.
    """
    inside = grid_of(edges)
    x, ends = inside.ravel(), np.concatenate((edges[:-1], edges[1:]))
    flat = many.everywhere(quantity, x, "right")
    sign, low, high, which = tops(inside, flat.reshape(many.count, *inside.shape), signs)

    def on_grid(places: FloatArray, bracket: IntArray) -> FloatArray:
        return many.at(quantity, places, "right", which[bracket])

    turning = climbed(on_grid, sign, low, high, which)
    after = many.everywhere(quantity, edges[:-1], "right")
    before = many.everywhere(quantity, edges[1:], "left")
    at_ends = np.concatenate((after, before), axis=1)
    there = on_grid(turning, np.arange(len(which)))
    found = []
    for one in range(many.count):
        own = which == one
        places = np.concatenate((ends, x, turning[own]))
        values = np.concatenate((at_ends[one], flat[one], there[own]))
        known = extremes_of(places, values)
        rows = flat[one].reshape(inside.shape)
        finer = _finer(partial(_of_one, many, quantity, one), inside, rows, known, signs)
        if len(finer[0]):
            pairs = zip((places, values), finer, strict=True)
            known = extremes_of(*(np.concatenate(each) for each in pairs))
        found.append(_at_edges(known, ends, at_ends[one]))
    return found


def _of_one(many: Many[Asked], quantity: Asked, one: int, x: FloatArray) -> FloatArray:
    """(n,) the quantity of one of `many` at x (n,)."""
    return many.at(quantity, x, "right", np.full(len(x), one))


def _finer(
    function: Function,
    grid: FloatArray,
    values: FloatArray,
    known: Extremes,
    signs: tuple[float, ...],
) -> tuple[FloatArray, FloatArray]:
    """(k,), (k,) places and values of `function` on finer grids, where the rows of `grid` (m, n)
    with `values` (m, n) do not resolve it and it may be beyond what is `known`.
    """
    best = {sign: max(sign * known.lowest.value, sign * known.highest.value) for sign in signs}
    places, found = [np.empty(0)], [np.empty(0)]
    off = _unresolved(values)
    for _ in range(ROUNDS):
        if not np.any(off):
            break
        wanted = np.zeros(off.shape, dtype=np.bool_)
        for sign, height in best.items():
            ends = np.maximum(sign * values[:, :-1], sign * values[:, 1:])
            wanted |= ends + off > height + NEGLIGIBLE * abs(height)
        row, cell = np.nonzero(wanted & (off > 0.0))
        if not 0 < len(row) <= MOST_FINER:
            break
        low, high = grid[row, cell], grid[row, cell + 1]
        grid = low[:, np.newaxis] + (high - low)[:, np.newaxis] * PARTS
        values = function(grid.ravel()).reshape(grid.shape)
        off = _unresolved(values)
        smooth = ~np.all(off, axis=1)  # tops of what is unresolved all over are not worth climbing
        turning = np.empty(0)
        if np.any(smooth):
            climbing = tops(grid[smooth], values[np.newaxis, smooth], tuple(best))
            turning = climbed(lambda x, _: function(x), *climbing)
        places += [grid.ravel(), turning]
        found += [values.ravel(), function(turning)]
        for sign, height in best.items():
            best[sign] = max(height, *(float(np.max(sign * e, initial=height)) for e in found[-2:]))
    return np.concatenate(places), np.concatenate(found)


def _unresolved(values: FloatArray) -> FloatArray:
    """(m, n - 1) how far a curve may be beyond its `values` (m, n) between two of them; 0 where
    these resolve it.
    """
    fourth, second = (np.abs(np.diff(values, order, axis=1)) for order in (4, 2))
    bend = np.maximum(np.maximum(second[:, :-2], second[:, 1:-1]), second[:, 2:])
    off = np.pad(np.where(fourth > ROUGH * bend, fourth, 0.0), ((0, 0), (2, 2)), mode="edge")
    return np.asarray(np.maximum(off[:, :-1], off[:, 1:]))


def _at_edges(found: Extremes, edges: FloatArray, values: FloatArray) -> Extremes:
    """The same extremes, at an edge if it has such a value but for rounding."""
    rounding = ROUNDING * found.magnitude

    def placed(extreme: Extreme) -> Extreme:
        same = np.abs(values - extreme.value) <= rounding
        if not np.any(same):
            return extreme
        place = float(np.min(edges[same]))
        return Extreme(float(values[same & (edges == place)][0]), place)

    return Extremes(placed(found.lowest), placed(found.highest))


def tops(
    grid: FloatArray, values: FloatArray, signs: tuple[float, ...] = BOTH
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Sign, +1 of a top and -1 of a bottom, bracket, and the quantity of each turning point,
    (k,) each.

    Of the `values` (q, m, n) of q quantities along the rows of `grid` (m, n), those of the `signs`;
    those that cannot be the largest or the smallest of their quantity are omitted.
    """
    padded = np.concatenate((grid[:, :1], grid, grid[:, -1:]), axis=1)
    lows, highs = (np.broadcast_to(each, values.shape) for each in (padded[:, :-2], padded[:, 2:]))
    moving = np.ptp(values, axis=-1, keepdims=True) > 0.0
    found = []
    for sign in signs:
        heights = sign * values
        inner = np.pad(heights, ((0, 0), (0, 0), (1, 1)), constant_values=-np.inf)
        before, after = inner[..., :-2], inner[..., 2:]
        top = (heights >= before) & (heights >= after)
        top &= (heights > before) | (heights > after)
        # A parabola through three points rises above the middle one by at most an eighth of the
        # larger difference; what cannot reach the largest value even with that is omitted.
        ends = heights[..., :1], heights[..., -1:]
        falls = np.abs(np.diff(heights, axis=-1, prepend=ends[0], append=ends[1]))
        highest = np.max(heights, axis=(-2, -1), keepdims=True)
        top &= heights + np.maximum(falls[..., :-1], falls[..., 1:]) >= highest
        top &= moving
        of = np.nonzero(top)[0]
        found.append((np.full(len(of), sign), lows[top], highs[top], of))
    sign_of, low, high, which = (np.concatenate(each) for each in zip(*found, strict=True))
    return sign_of, low, high, which


def climbed(
    function: Callable[[FloatArray, IntArray], FloatArray],
    sign: FloatArray,
    low: FloatArray,
    high: FloatArray,
    which: IntArray,
) -> FloatArray:
    """Place of the largest sign * function in each bracket [low, high] (k,), which has one maximum.

    The function is asked for places, and for the bracket of each. A bracket that cannot reach the
    largest value of its quantity `which` (k,) is left where it is, like one omitted by `tops`.
    """
    if not len(low):
        return low
    share = np.arange(1.0, SECTIONS) / SECTIONS
    best, group = low.copy(), 2 * which + (sign > 0.0)
    left = np.arange(len(low))
    for _ in range(STEPS):
        grid = low[:, np.newaxis] + (high - low)[:, np.newaxis] * share
        values = function(grid.ravel(), np.repeat(left, SECTIONS - 1))
        heights = sign[left, np.newaxis] * values.reshape(grid.shape)
        each, top = np.arange(len(left)), np.argmax(heights, axis=1)
        best[left], peaks = grid[each, top], heights[each, top]
        width = (high - low) / SECTIONS
        low, high = best[left] - width, best[left] + width
        highest = np.full(2 * int(np.max(which)) + 2, -np.inf)
        np.maximum.at(highest, group[left], peaks)
        rise = np.max(np.abs(np.diff(heights, axis=1)), axis=1)
        up = peaks + rise >= highest[group[left]]
        left, low, high = left[up], low[up], high[up]
    return best


def dips(function: Function, grid: FloatArray) -> FloatArray:
    """Places where `function` has the opposite sign of the three points of `grid` around it.

    A parabola through three points falls below the middle one by at most 1/8 of the larger
    difference; where twice that could change the sign, the minimum is computed.
    """
    values = function(grid.ravel()).reshape(grid.shape)
    size = np.abs(values)
    before, here, after = size[:, :-2], size[:, 1:-1], size[:, 2:]
    signs = np.sign(values)
    near = (signs[:, :-2] == signs[:, 1:-1]) & (signs[:, 2:] == signs[:, 1:-1])
    near &= (here <= before) & (here <= after) & (here > 0.0)
    near &= 4.0 * here <= np.maximum(before, after) - here
    found = []
    for row, column in np.argwhere(near):
        sign = signs[row, column + 1]

        def upright(phi: FloatArray, _side: Side, sign: float = sign) -> FloatArray:
            return sign * function(phi)

        lowest = piecewise_lowest(upright, grid[row, [column, column + 2]])
        if lowest.value < 0.0:
            found.append(lowest.place)
    return np.array(found)


def stretch_below(
    function: Callable[[FloatArray], FloatArray], edges: FloatArray, place: float
) -> tuple[float, float] | None:
    """Start and end [rad] of the stretch around `place` in which `function` is negative.

    Parameters
    ----------
    function : (n,) -> (n,), smooth between neighbouring edges.
    edges : (k,) angles from 0 to 2 pi, both included, ascending.
    place : where it is lowest [rad].

    Returns
    -------
    As for `stretch_around`; None if it is negative nowhere, or at `place` alone. A root nearer to
    an edge than `INSET` of a piece counts as at the edge.
    """
    cuts = merged(np.concatenate((edges, [place])))
    cuts = merged(np.concatenate((cuts, roots_on_grid(function, grid_of(cuts)))))
    return stretch_around(cuts, function(0.5 * (cuts[:-1] + cuts[1:])) < 0.0, place)


def stretch_around(cuts: FloatArray, inside: BoolArray, place: float) -> tuple[float, float] | None:
    """Start and end [rad] of the stretch around `place` that is entirely inside.

    Parameters
    ----------
    cuts : (n + 1,) angles from 0 to 2 pi, both included, ascending; `place` is one of them.
    inside : (n,) which of the pieces between two cuts belong to it.

    Returns
    -------
    (0, 2 pi) for a whole turn; else the end lies in [0, 2 pi), below the start if the stretch
    passes the end of the turn. None if neither piece next to `place` is inside.
    """
    if np.all(inside):
        return 0.0, TURN
    pieces = len(inside)
    after = int(np.searchsorted(cuts, place)) % pieces
    if not (inside[after] or inside[after - 1]):
        return None
    first = last = after if inside[after] else (after - 1) % pieces
    while inside[first - 1]:
        first -= 1
    while inside[(last + 1) % pieces]:
        last += 1
    return float(cuts[first % pieces]), float(cuts[last % pieces + 1]) % TURN
