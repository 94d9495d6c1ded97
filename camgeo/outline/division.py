"""The first division of an envelope into cells, and what is proved of runs of neighbouring cells.

Two points of a run coincide only if the integral of a exp(i theta) between them vanishes (a the
pace, theta the direction of the tangent). If theta stays within less than pi,

- it does not vanish where a keeps its sign: all of it has a part in the middle direction;
- nor where a changes sign once, at theta_c, and theta goes on growing or falling: then
  a sin(theta - theta_c) keeps its sign;
- nor where a changes sign once and theta stays within a right angle: the way between two points of
  a branch is never square to a tangent of it then, so that the distance of a point of the branch
  from the roller centre Z has no extreme but at its own cam angle. It is smallest there, |d|, where
  a > 0, and largest where a < 0: the roller at the cusp touches neither branch again, one lies
  outside of it and the other inside;
- where a changes sign twice, + - +, and theta grows or falls steadily, there is at most one such
  pair: of two, the one inside the other would need two sums of directions from cones that lie
  apart to be equal, and two side by side a sum in one half plane to vanish.

So a crossing within a short run takes two cusps, and these make one crossing at most: the swallow
tail. All other crossings are between cells that lie apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgeo.motion.kept import kept_with_owner
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, ascending, grouped, joined
from camgeo.outline.cells import Cells, enclose, halved, unresolved
from camgeo.outline.envelope import Envelope
from camgeo.units import TURN

WIDEST = math.pi / 16.0
"""Longest initial cell [rad of the path parameter]."""

STEEPEST = 0.3
"""Largest angle between tangents in a cell and in its middle [rad], so that boxes are slim."""

NARROWEST = 4.0 * np.spacing(TURN)
"""Shortest cell [rad of the path parameter] that doubles resolve: reached in 50 halvings."""

STRAIGHT = 0.98 * math.pi
"""Angle [rad] within which the tangents of a short run stay: below pi, with room for rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class Division:
    """An envelope in n cells that follow each other, none across a border or a cusp.

    Attributes
    ----------
    envelope : what is divided.
    cells : in order.
    negative : (n,) True where the pace is negative: undercut.
    turned : (2 n + 1,) sum of the largest turns of the tangent up to each cell, over two turns.
    flips : (2 n + 1,) sign changes of the pace from cell to cell up to each cell, likewise.
    changes : (2 n + 1,) changes of the sense in which the tangent turns, likewise.
    unsure : (2 n + 1,) number of cells up to each that do not provably turn one way.
    """

    envelope: Envelope
    cells: Cells
    negative: BoolArray
    turned: FloatArray
    flips: IntArray
    changes: IntArray
    unsure: IntArray

    def is_plain(self, first: IntArray, last: IntArray) -> BoolArray:
        """(k,) True where the run of cells `first` to `last` (k,) provably does not cross itself.

        `last` may be up to n cells beyond the end of the first turn, and is not below `first`.
        """
        short = self.turned[last + 1] - self.turned[first] < STRAIGHT
        flips = self.flips[last] - self.flips[first]
        one_way = self.changes[last] - self.changes[first] == 0
        one_way &= self.unsure[last + 1] == self.unsure[first]
        square = self.turned[last + 1] - self.turned[first] < 0.5 * STRAIGHT
        plain: BoolArray = short & ((flips == 0) | ((flips == 1) & (one_way | square)))
        return plain


def divide(envelope: Envelope, cusps: FloatArray) -> Division:
    """Divide `envelope` at its borders, at `cusps` (k,) and as finely as slim boxes require.

    Parameters
    ----------
    cusps : path parameters where the pace passes zero or jumps to the other sign.

    Raises
    ------
    GeometryError
        If a cell as short as doubles resolve still bends, or too many cells do: a curvature beyond
        double precision, as at a dead centre.
    """
    cells = first_cells(envelope, cusps) if len(cusps) else undivided(envelope)
    while True:
        wide, sharp = cells.high - cells.low > NARROWEST, cells.turn > STEEPEST
        if np.any(sharp & ~wide):
            raise unresolved(envelope, cells.low[sharp & ~wide])
        coarse = sharp | (_touches(cells, cusps) & (cells.bend == 0.0))
        coarse &= wide
        if not np.any(coarse):
            break
        fine = halved(envelope, cells.some(coarse))
        cells = joined([cells.some(~coarse), fine])
        cells = cells.some(np.argsort(cells.low, kind="stable"))
    cells = replace(cells, origin=np.arange(len(cells)))
    negative = cells.pace < 0.0
    return Division(
        envelope,
        cells,
        negative,
        _sums(2.0 * cells.turn),
        _counts(negative != np.roll(negative, -1)),
        _counts(cells.bend != np.roll(cells.bend, -1)),
        _counts(cells.bend == 0.0),
    )


def first_cells(envelope: Envelope, cusps: FloatArray) -> Cells:
    """Cells of at most `WIDEST`, none across a border of `envelope` or one of `cusps` (k,)."""
    marks = ascending(np.concatenate((envelope.borders, cusps, [envelope.total])))
    spans = np.diff(marks)
    parts = np.maximum(1, np.ceil(spans / WIDEST)).astype(np.intp)
    index, step = grouped(parts)
    low = marks[index] + spans[index] * step / parts[index]
    high = np.append(low[1:], envelope.total)
    return enclose(envelope, low, high, np.arange(len(low)))


@kept_with_owner
def undivided(envelope: Envelope) -> Cells:
    """The first cells of an `envelope` without cusps."""
    return first_cells(envelope, np.empty(0))


def _touches(cells: Cells, cusps: FloatArray) -> BoolArray:
    if not len(cusps):
        return np.zeros(len(cells), dtype=np.bool_)
    # The last cell ends where the first one begins.
    high = np.append(cells.low[1:], cells.low[0])
    touched: BoolArray = np.isin(cells.low, cusps) | np.isin(high, cusps)
    return touched


def _sums(values: FloatArray) -> FloatArray:
    """Sums before each cell and after the last, over two turns."""
    return np.concatenate(([0.0], np.cumsum(np.concatenate((values, values)))))


def _counts(values: BoolArray) -> IntArray:
    """Number of True before each cell and after the last, over two turns."""
    counted = np.cumsum(np.concatenate((values, values)), dtype=np.intp)
    return np.concatenate((np.zeros(1, dtype=np.intp), counted))
