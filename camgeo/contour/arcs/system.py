"""Least squares for joints of arc splines: banded equations with one condition for each arc."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.arcs.joints import Layout
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray

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
        from scipy.linalg import solve_banded  # only where files are made

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
