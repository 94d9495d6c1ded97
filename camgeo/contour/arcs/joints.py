"""The joints of arc splines, placed for equal deviations of all arcs; and their least squares.

Splines come in batches, one after the other in the same arrays: they are short, and the overhead of
calls exceeds the arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.contour.decided import in_steps
from camgeo.contour.joints import Bends
from camgeo.curve.pieces import Piece
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray

Scalar = TypeVar("Scalar", bound=np.generic)

ROUNDS = 10
"""Rounds of equalising the deviations predicted by the tables; they need no evaluation of the
curve."""

END = 0.325
"""Fraction of an arc by which the first and the last one are shorter than the others if the
difficulty is uniform, because point and tangent are given there: found with dkappa/ds constant, 3
to 20 arcs."""

ALONE = 1.0 / 3.0
"""Power of its deviation by which an arc is shortened: its deviation grows with the third power of
its length if the others keep theirs, as the tables assume."""

LEAST = 1e-3
"""Smallest deviation of an arc that counts, as a fraction of the largest of its spline."""


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Places of the joints and arcs of k splines in the arrays of a batch.

    Attributes
    ----------
    first, last : (k,) first and last joint of each spline.
    left : (n,) joint at which each arc begins; it ends at the next.
    spline : (n,) spline of each arc.
    """

    first: IntArray
    last: IntArray
    left: IntArray
    spline: IntArray

    @classmethod
    def of(cls, counts: IntArray) -> Layout:
        """Splines of `counts` (k,) arcs each."""
        last = np.cumsum(counts + 1) - 1
        left = np.delete(np.arange(last[-1] + 1), last)
        return cls(last - counts, last, left, np.repeat(np.arange(len(counts)), counts))

    @property
    def counts(self) -> IntArray:
        """(k,) arcs of each spline."""
        return self.last - self.first

    @property
    def first_arcs(self) -> IntArray:
        """(k,) first arc of each spline."""
        return self.first - np.arange(len(self.first))

    def of_joints(self, values: NDArray[Scalar]) -> NDArray[Scalar]:
        """(j,) for each joint the value (k,) of its spline."""
        return np.repeat(values, self.counts + 1)

    def largest(self, values: FloatArray) -> FloatArray:
        """(k,) for each spline the largest value (n,) of its arcs."""
        found: FloatArray = np.maximum.reduceat(values, self.first_arcs)
        return found

    def excess(self, deviations: FloatArray) -> FloatArray:
        """(n,) logarithms of the arcs' `deviations` (n,) over their geometric mean in a spline,
        in steps; 0 where a spline has no deviation at all, or not a number.
        """
        worst = self.largest(deviations)[self.spline]
        usable = np.isfinite(worst) & (worst > 0.0)
        found: FloatArray = np.log(np.where(usable, np.maximum(deviations, LEAST * worst), 1.0))
        mean: FloatArray = np.bincount(self.spline, weights=found) / self.counts
        return in_steps(found - mean[self.spline])


@dataclass(frozen=True, slots=True, eq=False)
class Difficulty:
    """The difficulty of following smooth pieces by arcs, tabulated along each of them.

    The third root of |dkappa/ds|, over the length, is the density of arcs. It is the same for all
    parallels, also where one has a cusp, so the tables are of the pitch curve. The place of a cam
    angle is 2 p at the start of piece p and 2 p + 1 at its end, and even between.

    Attributes
    ----------
    starts, spans : (p,) [rad] of the pieces.
    totals : (p,) [mm^(1/3)] integral of the density along each piece.
    places : (m,) ascending, of the tables.
    shares : (m,) 2 p and the share of the density before each place.
    turns, lengths : (m,) integrals of |dkappa| [1/mm] and of ds [mm] before each place.
    """

    starts: FloatArray
    spans: FloatArray
    totals: FloatArray
    places: FloatArray
    shares: FloatArray
    turns: FloatArray
    lengths: FloatArray

    @classmethod
    def of(cls, pieces: Sequence[Piece], bends: Sequence[Bends]) -> Difficulty:
        """Tables of `pieces`, none a rest, from how the curve bends along each."""
        starts = np.array([piece.start for piece in pieces])
        spans = np.array([piece.end - piece.start for piece in pieces])
        speed = np.stack([bend.speed for bend in bends])
        slope = np.abs(np.stack([bend.slope for bend in bends]))
        cells = speed.shape[1]

        def integral(values: FloatArray) -> FloatArray:
            parts = values * (spans / cells)[:, None]
            return np.cumsum(np.pad(parts, ((0, 0), (1, 0))), axis=1)

        grid = np.linspace(0.0, 1.0, cells + 1)
        density = integral(np.cbrt(slope * speed * speed))
        totals = density[:, -1].copy()
        density[totals == 0.0] = grid  # a straight line has no difficulty anywhere
        base = 2.0 * np.arange(len(pieces))[:, None]
        return cls(
            starts,
            spans,
            totals,
            (base + grid).ravel(),
            (base + density / density[:, -1:]).ravel(),
            integral(slope).ravel(),
            integral(speed).ravel(),
        )

    def joints(self, layout: Layout, pieces: IntArray) -> FloatArray:
        """(j,) places of joints with equal deviations of the arcs according to the tables.

        Spline i of `layout` lies along piece `pieces[i]`.
        """
        counts = layout.of_joints(layout.counts)
        index = np.arange(len(counts)) - layout.of_joints(layout.first)
        share = np.clip((index - END) / (counts - 2.0 * END), 0.0, 1.0)
        places: FloatArray = np.interp(
            2.0 * layout.of_joints(pieces) + share, self.shares, self.places
        )
        places[layout.first], places[layout.last] = 2.0 * pieces, 2.0 * pieces + 1.0
        stress = np.ones(len(layout.left))
        stress[layout.first_arcs] = (1.0 - END) ** -3.0
        stress[layout.first_arcs + layout.counts - 1] = (1.0 - END) ** -3.0
        left, right = layout.left, layout.left + 1
        for _ in range(ROUNDS):
            # An arc of length h deviates by a constant times h^2 and the integral of |dkappa|.
            turns = np.interp(places, self.places, self.turns)
            lengths = np.interp(places, self.places, self.lengths)
            deviations = (turns[right] - turns[left]) * (lengths[right] - lengths[left]) ** 2
            places = evened(layout, places, ALONE * layout.excess(stress * deviations))
        return places

    def angles(self, layout: Layout, pieces: IntArray, places: FloatArray) -> FloatArray:
        """(j,) cam angles [rad] of `places` (j,), see `joints`."""
        part = places - 2.0 * layout.of_joints(pieces)
        starts, spans = layout.of_joints(self.starts[pieces]), layout.of_joints(self.spans[pieces])
        angles: FloatArray = starts + spans * part
        return angles


def evened(layout: Layout, places: FloatArray, shrink: FloatArray) -> FloatArray:
    """Places (j,) of joints, moved from `places` so that each arc's share of its spline shrinks by
    the factor exp(shrink), shrink (n,), as against the others.
    """
    share = np.exp(shrink)
    share *= (layout.counts / np.bincount(layout.spline, weights=share))[layout.spline]
    # The shares of a spline add up to its arcs, so joint i of the batch belongs at i.
    before = np.zeros(len(places))
    before[layout.left + 1] = share
    before = np.cumsum(before) + layout.of_joints(np.arange(len(layout.first)))
    found = np.interp(np.arange(len(places), dtype=np.float64), before, places)
    found[layout.first], found[layout.last] = places[layout.first], places[layout.last]
    return found


BAND = 4
"""Distance of the farthest two unknowns that meet in an equation."""


@dataclass(frozen=True, slots=True, eq=False)
class ArcSystem:
    """The equations of a batch of splines.

    Joint j has the unknowns 3 j and 3 j + 1; 3 j + 2 is Lagrange's multiplier of the arc that
    begins there.

    Attributes
    ----------
    layout : of the batch.
    cells : places of all coefficients in the banded matrix, row by row.
    """

    layout: Layout
    cells: IntArray

    @classmethod
    def of(cls, layout: Layout) -> ArcSystem:
        """The form of the equations; numbers come with `solved`."""
        size = 3 * (int(layout.last[-1]) + 1)
        own = 3 * layout.left[:, None] + np.array([0, 1, 3, 4])
        bond = np.broadcast_to(3 * layout.left[:, None] + 2, own.shape)
        blocks = (len(own), 4, 4)
        rows = np.broadcast_to(own[:, :, None], blocks)
        columns = np.broadcast_to(own[:, None, :], blocks)
        diagonal = np.arange(size)

        def cell(row: IntArray, column: IntArray) -> IntArray:
            return ((BAND + row - column) * size + column).ravel()

        cells = (cell(rows, columns), cell(own, bond), cell(bond, own), cell(diagonal, diagonal))
        return cls(layout, np.concatenate(cells))

    def solved(
        self,
        square: FloatArray,
        pull: FloatArray,
        bond: FloatArray,
        gap: FloatArray,
        free: BoolArray,
    ) -> FloatArray:
        """Unknowns (j, 2) x that make the sum over the arcs of x' A x / 2 - b' x stationary, with
        c' x = d for each arc; x are the four unknowns of an arc's two joints.

        Parameters
        ----------
        square, pull, bond, gap : (n, 4, 4) A, (n, 4) b, (n, 4) c and (n,) d of each arc.
        free : (j,) False for joints whose unknowns are zero.
        """
        from scipy.linalg import solve_banded  # only for making files

        left, right = self.layout.left, self.layout.left + 1
        mask = np.stack((free[left], free[left], free[right], free[right]), axis=1)
        square = np.where(mask[:, :, None] & mask[:, None, :], square, 0.0)
        pull, bond = np.where(mask, pull, 0.0), np.where(mask, bond, 0.0)
        held = np.ones((len(free), 3))
        held[:, 0] = held[:, 1] = ~free
        bound = free[left] | free[right]
        held[left, 2] = ~bound
        values = (square.ravel(), bond.ravel(), bond.ravel(), held.ravel())
        matrix = np.bincount(
            self.cells, weights=np.concatenate(values), minlength=(2 * BAND + 1) * held.size
        )
        sides = np.zeros_like(held)
        sides[left, :2] += pull[:, :2]
        sides[right, :2] += pull[:, 2:]
        sides[left, 2] = np.where(bound, gap, 0.0)
        unknowns = solve_banded(
            (BAND, BAND),
            matrix.reshape(2 * BAND + 1, held.size),
            sides.ravel(),
            overwrite_ab=True,
            overwrite_b=True,
            check_finite=False,
        )
        found: FloatArray = unknowns.reshape(-1, 3)[:, :2]
        return found
