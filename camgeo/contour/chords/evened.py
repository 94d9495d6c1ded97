"""Straight pieces placed so that all of them have equal deviations, bend by bend.

One chord runs through each inflection, from eps off on one side to eps off on the other. It is the
longest of all; between two such chords lies a bend.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.contour.chords.two_sided import Chords, Stretched, lay
from camgeo.contour.hermite import monotone
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, grouped

THROUGH = (2.0 / 3.0) * 1.5**0.5
"""Fraction of a chord of a bend that the chord through an inflection covers on each side: on a
cubic y = c s^3/6 it reaches to h^3 = 24 eps/c, where the integral of sqrt(c s/(16 eps)) is (2/3)
sqrt(24/16)."""

CORNER = 0.5 - 0.5 * 0.5**0.5
"""Fraction of a chord that is lost where it ends on the curve itself: there its sagitta b obeys (4
b - eps)^2 = 16 b eps, and its length is sqrt(b/(2 eps)) of the others'."""


@dataclass(frozen=True, slots=True, eq=False)
class Bends:
    """Starts and ends of the bends between inflections, in chords, see `StretchTable.shares`.

    Attributes
    ----------
    low, high : (b,) ends of the bends; equal where two inflections leave no room between.
    extra : (b,) chords that a bend needs in addition because it ends at corners.
    beyond : (b,) chords of it that those through inflections replace.
    narrow : (b,) whether chords through inflections could reach farther into it.
    """

    low: FloatArray
    high: FloatArray
    extra: FloatArray
    beyond: FloatArray
    narrow: BoolArray

    def counts(self) -> IntArray:
        """(b,) the least number of chords of each bend."""
        length = self.high - self.low
        needed = np.ceil((length + self.extra) * (1.0 - 1e-9))
        return np.where(length > 0.0, np.maximum(needed, 1.0), 0.0).astype(np.intp)

    def least(self, counts: IntArray) -> float:
        """Fraction of the tolerance at which the bends need exactly `counts` (b,) chords."""
        some = self.high > self.low
        if not np.any(some):
            return 1.0
        spare = (counts - self.extra + self.beyond)[some]
        taken = (self.high - self.low + self.beyond)[some]
        return min(float(np.max(taken / spare)) ** 2, 1.0)


def bends_of(
    stretch: Stretched,
    shares: FloatArray,
    reaches: FloatArray,
    counts: IntArray | None = None,
) -> Bends:
    """The bends of a stretch if the chords through its inflections reach `reaches` (k,) `THROUGH`
    to both sides.

    Two of these chords may leave no room for a bend and meet in the middle, as where `counts` (b,)
    is 0; where it is not, its chords get at least half of the bend.
    """
    total = float(shares[-1])
    at = shares[list(stretch.table.inflections)]
    left, right = at - THROUGH * reaches, at + THROUGH * reaches
    if stretch.closed and not len(at):
        none = np.zeros(1)
        return Bends(none, np.array([total]), none, none, none > 0.0)
    if stretch.closed:
        low, high = right, np.append(left[1:], left[0] + total)
        first, last = at, np.append(at[1:], at[0] + total)
        extra = np.zeros(len(low))
    else:
        low, high = np.append(0.0, right), np.append(left, total)
        first, last = np.append(0.0, at), np.append(at, total)
        extra = np.zeros(len(low))
        extra[0] += CORNER
        extra[-1] += CORNER
    room = np.zeros(len(low)) if counts is None else np.where(counts > 0, 0.5 * (last - first), 0.0)
    narrow = high - low < room
    if counts is not None:
        narrow |= counts == 0
    start, end = 0.5 * (first + last - room), 0.5 * (first + last + room)
    if not stretch.closed:  # its ends are vertices
        start[0], end[0] = 0.0, room[0]
        start[-1], end[-1] = total - room[-1], total
    low, high = np.where(narrow, start, low), np.where(narrow, end, high)
    return Bends(low, high, extra, last - first - (high - low), narrow)


ROUNDS = 8
"""Most rounds of placing the vertices."""

EVEN = 1.001
"""Deviations are even enough if the largest is at most this multiple of the target."""

UNEVEN, SINGLE = 1.003, 24
"""Vertices of pieces that deviate by more than this multiple are placed one by one in the next
rounds, up to this many: near tips the least squares are not the least deviation."""

LEAST_COST = 0.05
"""A chord with almost no deviation, on a straight stretch, may become 20 times as long in one
round."""


@dataclass(frozen=True, slots=True, eq=False)
class Evened:
    """Pieces placed along a stretch.

    Attributes
    ----------
    chords : the pieces.
    bend : (c,) index of the bend of each piece; of a chord through an inflection that before it.
    through : (c,) whether a piece runs through an inflection.
    """

    chords: Chords
    bend: IntArray
    through: BoolArray


def evened(stretch: Stretched, tolerance: float, counts: IntArray, most_turn: float) -> Evened:
    """Pieces that deviate by `tolerance` [mm] if they can: `counts` (b,) of them in the bends.

    Vertices are placed by equal shares of the table first, then of the deviations found. The chords
    through inflections are shortened where they deviate more, and pieces that still do are placed
    vertex by vertex.
    """
    shares = stretch.table.shares(tolerance, most_turn)
    total = float(shares[-1])
    reaches = np.ones(len(stretch.table.inflections))
    at = costs = shares
    best, least = None, math.inf
    single = np.zeros(0, dtype=np.bool_)
    for number in range(ROUNDS):
        bends = bends_of(stretch, shares, reaches, counts)
        places, bend, through = _places(stretch, bends, counts, at, costs)
        full = stretch.table.sagittas(tolerance, most_turn, shares, places % total)
        held, offsets, loose = _offsets(stretch, bends, bend, through, full)
        single = single if len(single) else np.zeros(len(places), dtype=np.bool_)
        loose |= single & ~held
        chords = lay(stretch, stretch.angles(shares, places), held, offsets, loose)
        size = len(chords.worst)
        through = through[:size]
        turned = float(np.max(chords.turns)) / most_turn
        score = max(float(np.max(chords.worst)) / tolerance, turned)
        gain = least / score
        if gain > 1.0:
            best, least = Evened(chords, bend[:size], through), score
        excess = np.maximum(chords.worst[through] / tolerance, 1.0)
        settled = number > 2 and gain < EVEN and np.max(excess, initial=0.0) <= EVEN
        if score <= EVEN or settled:
            break
        single = _with_ends(single, np.flatnonzero(chords.worst > UNEVEN * tolerance))
        size_of = 0.5 * (chords.span + chords.worst)
        cost = np.maximum(np.sqrt(size_of / tolerance), chords.turns / most_turn)
        at, costs = _found(places, np.maximum(cost, LEAST_COST), total, stretch.closed)
        reaches = reaches / np.cbrt(np.roll(excess, 1) if stretch.closed else excess)
    assert best is not None
    return best


def _places(
    stretch: Stretched, bends: Bends, counts: IntArray, at: FloatArray, costs: FloatArray
) -> tuple[FloatArray, IntArray, BoolArray]:
    """Places (m,) of the vertices, the bend of each, and whether it is the last before an
    inflection; `costs` over the places `at` define equal parts.
    """
    round_and_round = stretch.closed and not len(stretch.table.inflections)
    sizes = counts if round_and_round else counts + 1
    bend, number = grouped(sizes)
    low, high = monotone(at, costs, bends.low), monotone(at, costs, bends.high)
    part = number / np.maximum(counts, 1)[bend]
    places = monotone(costs, at, low[bend] + (high - low)[bend] * part)
    places = np.where(number == 0, bends.low[bend], places)
    places = np.where((number == counts[bend]) & (number > 0), bends.high[bend], places)
    through = number == counts[bend]
    if not stretch.closed:
        through[-1] = False
    return places, bend, through


def _offsets(
    stretch: Stretched, bends: Bends, bend: IntArray, through: BoolArray, full: FloatArray
) -> tuple[BoolArray, FloatArray, BoolArray]:
    """The vertices that are held, their offsets [mm] from the curve, and those that are loose.

    The ends of a stretch lie on the curve, and the vertices next to them as far off as others, by
    the `full` (m,) of bends. So do the ends of a chord through an inflection of full length; those
    of a shorter one are loose.
    """
    sides = stretch.table.sides
    if stretch.closed and len(sides) > 1:
        sides = sides[1:]
    ends = through | np.roll(through, 1)
    loose = ends & bends.narrow[bend]
    held = ends & ~loose
    if not stretch.closed:
        held[[1, -2]] = True
    offsets = np.where(held, full * sides[bend], 0.0)
    held &= offsets != 0.0
    if not stretch.closed:
        held[[0, -1]] = True
        offsets[[0, -1]] = 0.0
    return held, offsets, loose & ~held


def _with_ends(single: BoolArray, pieces: IntArray) -> BoolArray:
    """`single` (m,) with the vertices at both ends of `pieces`, if these are not too many."""
    more = single.copy()
    more[pieces] = True
    more[(pieces + 1) % len(single)] = True
    return more if np.count_nonzero(more) <= SINGLE else single


def _found(
    places: FloatArray, cost: FloatArray, total: float, closed: bool
) -> tuple[FloatArray, FloatArray]:
    """Places and the sum of the costs up to them; of a closed stretch a chord more at both ends."""
    if closed:
        places = np.concatenate((places[-1:] - total, places, places[:2] + total))
        cost = np.concatenate((cost[-1:], cost, cost[:1]))
    return places, np.concatenate(([0.0], np.cumsum(cost)))
