"""Where the joints of a fit go: equal shares of the difficulty along each smooth piece."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from camgeo.curve.pieces import Piece
from camgeo.numeric.arrays import FloatArray

SAMPLES = 513
"""Points at which a piece's difficulty is sampled; it only places joints, the proof decides."""

FLOOR = 0.02
"""Smallest density of joints, as a share of the piece's mean: no stretch goes without."""

Density = Callable[[FloatArray], FloatArray]


class Spread:
    """Joints of one smooth piece, for any number of them.

    The density of difficulty is that power of the local error whose integral, times a power of the
    tolerance, is the number of pieces needed.
    """

    def __init__(self, piece: Piece, density: Density) -> None:
        self._phi = np.linspace(piece.start, piece.end, SAMPLES)
        inside = 0.5 * (self._phi[:-1] + self._phi[1:])
        cells = density(inside) * np.diff(self._phi)
        self.total = float(np.sum(cells))
        floored = cells + FLOOR * self.total / len(cells)
        self._share = np.concatenate(([0.0], np.cumsum(floored)))
        if self._share[-1] > 0.0:
            self._share /= self._share[-1]
        else:  # a straight line has no difficulty anywhere
            self._share = np.linspace(0.0, 1.0, SAMPLES)

    def joints(self, count: int) -> FloatArray:
        """(count + 1,) cam angles [rad] of the ends of `count` parts, the piece's ends included."""
        joints = np.interp(np.linspace(0.0, 1.0, count + 1), self._share, self._phi)
        joints[0], joints[-1] = self._phi[0], self._phi[-1]
        return joints
