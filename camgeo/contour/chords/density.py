"""How densely chords have to stand along a smooth piece, for any tolerance or number of them.

A chord over a span h of arc length is off the curve by (|kappa| + c |kappa'| h) h^2 / 8. The second
part matters where the curve has an inflection: from there on a span of kappa' s is off by more than
its mean curvature tells.
"""

from __future__ import annotations

import numpy as np

from camgeo.contour.spread import Bends, evenly_shared
from camgeo.curve.pieces import Piece
from camgeo.numeric.arrays import FloatArray

SLOPE = 0.06
"""c: so much makes the span from an inflection on as long as it may be, 1/(9 sqrt(3)) of
kappa' h^3 off."""

MOST_TURN = 0.4
"""A chord's curve turns by at most this angle [rad], however small its sagitta: the proof wants the
two to run the same way."""

HALF_ROUND = 2.0
"""A piece of a larger span [rad] has four chords at least: none goes more than a quarter round."""

STEPS = 12
"""Steps of the search for the error that a number of chords leaves."""

CLOSE = 1.01
"""So near has the number of chords for an error to come to the one asked."""

FLOOR = 0.005
"""Smallest density of chords, as a share of the piece's mean: no stretch goes without."""


class ChordDensity:
    """Chords along one smooth piece.

    Over the cam angle the density of chords is delta with delta^2 = (a + b / delta) / (8 error),
    a = |kappa| pace^2 and b = c |kappa'| pace^3, finite at a cusp too.
    """

    def __init__(self, piece: Piece, bends: Bends) -> None:
        self._piece, self._bends = piece, bends
        self._finer: ChordDensity | None = None
        self._width = (piece.end - piece.start) / len(bends.speed)
        regular = np.maximum(bends.regularity, 0.0)
        self._bend = np.abs(bends.curvature) * bends.speed * bends.speed * regular
        # kappa' = dkappa/dphi / (|Z'| regular^3), and pace = |Z'| regular.
        self._slope = SLOPE * np.abs(bends.slope) * bends.speed * bends.speed
        self._turn = np.abs(bends.curvature) * bends.speed / MOST_TURN
        self._total = self._width * float(np.sum(np.sqrt(0.125 * self._bend)))

    def count(self, aim: float) -> float:
        """Chords that are expected to come within `aim` [mm], a real number."""
        found = self._width * float(np.sum(self._density(aim)))
        least = 4.0 if self._piece.end - self._piece.start > HALF_ROUND else 1.0
        return max(least, found)

    def joints(self, count: int) -> FloatArray:
        """(count + 1,) cam angles [rad] of the ends of `count` parts, both outer ones included."""
        if count > len(self._bends.speed) // 2:
            if self._finer is None:
                self._finer = ChordDensity(self._piece, self._bends.refined())
            return self._finer.joints(count)
        # Up to the error with which there are about as many chords as asked.
        error = (self._total / count) ** 2
        for _ in range(STEPS):
            density = self._density(error)
            excess = self._width * float(np.sum(density)) / count
            if excess <= CLOSE:
                break
            error *= excess * excess
        return evenly_shared(self._piece, density, FLOOR, count)

    def _density(self, error: float) -> FloatArray:
        if error <= 0.0:
            return np.maximum(np.sqrt(self._bend), self._turn)
        bend, slope = self._bend / (8.0 * error), self._slope / (8.0 * error)
        density = np.maximum(np.sqrt(bend), np.cbrt(slope))
        floor = np.finfo(float).tiny
        for _ in range(2):
            density = np.sqrt(bend + slope / np.maximum(density, floor))
        return np.maximum(density, self._turn)
