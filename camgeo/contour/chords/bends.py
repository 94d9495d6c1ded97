"""Bends between inflections: where they begin and end, and how many chords each of them takes.

Through an inflection runs one chord, from eps off on one side to eps off on the other. It is the
longest of all; between two of them lies a bend.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.chords.two_sided import Stretched
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray

THROUGH = (2.0 / 3.0) * 1.5**0.5
"""Share of a chord of a bend that the chord through an inflection takes on each side: on a cubic
y = c s^3/6 it reaches to h^3 = 24 eps/c, where the integral of sqrt(c s/(16 eps)) is (2/3)
sqrt(24/16)."""

CORNER = 0.5 - 0.5 * 0.5**0.5
"""Share of a chord that is lost where it ends on the curve itself: there its sagitta b keeps
(4 b - eps)^2 = 16 b eps, and it is sqrt(b/(2 eps)) as long as others."""


@dataclass(frozen=True, slots=True, eq=False)
class Bends:
    """Where the bends between inflections begin and end, in chords, see `Course.shares`.

    Attributes
    ----------
    low, high : (b,) ends of the bends; equal where two inflections leave no room between.
    extra : (b,) what a bend takes beyond its length because it ends in corners.
    beyond : (b,) what chords through inflections take of it.
    narrow : (b,) whether chords through inflections could reach farther into it.
    """

    low: FloatArray
    high: FloatArray
    extra: FloatArray
    beyond: FloatArray
    narrow: BoolArray

    def counts(self) -> IntArray:
        """(b,) chords that each bend needs at least."""
        length = self.high - self.low
        needed = np.ceil((length + self.extra) * (1.0 - 1e-9))
        return np.where(length > 0.0, np.maximum(needed, 1.0), 0.0).astype(np.intp)

    def least(self, counts: IntArray) -> float:
        """Share of the tolerance at which `counts` (b,) chords are as many as the bends need."""
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

    Two of these chords may leave no room for a bend, and meet in the middle; so they do where
    `counts` (b,) want no chord, and where they want some, these have half of it at least.
    """
    total = float(shares[-1])
    at = shares[list(stretch.course.inflections)]
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
