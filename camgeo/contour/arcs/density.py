"""How densely biarcs have to stand along a smooth piece, for any tolerance or number of them.

A biarc with turned tangents, see `camgeo.contour.arcs.tangent_turns`, over a span h of arc length
is off the curve by

    C h^3 (|kappa'| + c |kappa''| h),   C = 0.1001^3,

primes for d/ds: the first part is that of the best arcs. A fit that knows the first part only comes
out too far off wherever the slope of curvature changes its sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.contour.spread import Bends
from camgeo.curve.pieces import Piece
from camgeo.numeric.arrays import FloatArray

ARC_CONSTANT = 0.2002
"""Arcs needed, asymptotically: 0.2002 eps^(-1/3) times the integral of |dkappa/ds|^(1/3) ds."""

QUARTIC = 0.6
"""c: a lone span about a zero of kappa' with tangents turned at will leaves (sqrt(2) - 1)^2 / 384
of kappa'' h^4, c = 0.45; spans beside it, which have other wishes, make it some more."""

OUTER = (0.515, 0.891, 0.927)
"""Lengths of the outermost spans of a piece, where all others are 1 and kappa' is even, with which
they leave what the others leave. The fourth leaves 1.24 times as much."""

ENDS = 0.6
"""Spans that the ends of a piece cost, at least; by the lengths above it is 1.3."""

FLOOR = 0.005
"""Smallest density of spans, as a share of the piece's mean: no stretch goes without."""

STEPS = 3
"""Steps of the fixed point for the density; each divides what is missing by four or more."""

LEAST_REGULARITY = 1e-3
"""1 + d kappa counts as this where it is less, beside a cusp: the density there is integrable, but
not by samples."""

POWER = 0.25
"""Power of what a span was found to leave by which others stand there: less than a third, as part
of it comes from the tangents of its neighbours."""

LEAST_FOUND = 0.01
"""Share of the largest distance that counts at least."""

WIDEST = 2.0
"""Cam angle [rad] of the widest span: a whole turn without a break, of a stroke that is next to
nothing, has no chord from its beginning to its end."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What spans between some joints were found to leave.

    Attributes
    ----------
    places : (m,) [rad] middles of the spans.
    needs : (m,) by what the density there falls short, up to a factor that is the same for all.
    """

    places: FloatArray
    needs: FloatArray

    @classmethod
    def of(cls, joints: FloatArray, distances: FloatArray) -> Self:
        """From the `distances` (m,) [mm] beside the spans between `joints` (m + 1,)."""
        largest = float(np.max(distances))
        shares = distances / largest if largest > 0.0 else np.ones(len(distances))
        return cls(0.5 * (joints[:-1] + joints[1:]), np.maximum(shares, LEAST_FOUND) ** POWER)


class ArcDensity:
    """Spans of biarcs along one smooth piece.

    Over the cam angle the density of spans delta obeys delta^4 = (a^3 delta + b) C / error, where
    a^3 = |kappa'| pace^3, the same for all parallels, and b = c |kappa''| pace^4.
    """

    def __init__(self, piece: Piece, bends: Bends) -> None:
        self._piece, self._bends = piece, bends
        self._finer: ArcDensity | None = None
        self._borders = np.linspace(piece.start, piece.end, len(bends.speed) + 1)
        self._width = (piece.end - piece.start) / len(bends.speed)
        regular = np.maximum(bends.regularity, LEAST_REGULARITY)
        slope = bends.slope / (bends.speed * regular**3)
        change = np.abs(np.gradient(slope, self._width))
        self._cubic = np.abs(bends.slope) * bends.speed * bends.speed
        self._quartic = QUARTIC * change * (bends.speed * regular) ** 3
        self._total = self._width * float(np.sum(np.cbrt(self._cubic)))

    def count(self, aim: float) -> float:
        """Spans that are needed at least to come within `aim` [mm], a real number, nearly."""
        inner = self._width * float(np.sum(self._density(aim / (0.5 * ARC_CONSTANT) ** 3)))
        known = inner * 1.03 + min(max(0.25 * (inner - 1.0), 0.0), ENDS)
        return max(known, (self._piece.end - self._piece.start) / WIDEST)

    def joints(self, count: int, found: Found | None = None) -> FloatArray:
        """(count + 1,) cam angles [rad] of the ends of `count` parts, both outer ones included.

        `found`: what about as many spans were found to leave.
        """
        if count > len(self._bends.speed) // 2:
            if self._finer is None:
                self._finer = ArcDensity(self._piece, self._bends.refined())
            return self._finer.joints(count, found)
        error = (self._total / count) ** 3
        density = self._density(error)
        # That were too many spans: the error with which there are about as many as asked.
        error *= (self._width * float(np.sum(density)) / count) ** 3
        density = self._density(error)
        if found is not None:
            middles = self._borders[:-1] + 0.5 * self._width
            density *= np.interp(middles, found.places, found.needs)
        density += FLOOR * float(np.mean(density))
        if not density[0] > 0.0:  # a straight line has no difficulty anywhere
            density = np.ones(len(density))
        reached = np.concatenate(([0.0], np.cumsum(density)))
        joints: FloatArray = np.interp(_parts(count) * reached[-1], reached, self._borders)
        joints[0], joints[-1] = self._piece.start, self._piece.end
        return joints

    def _density(self, error: float) -> FloatArray:
        if error <= 0.0:
            return np.cbrt(self._cubic)
        cubic, quartic = self._cubic / error, self._quartic / error
        density: FloatArray = np.maximum(np.cbrt(cubic), np.sqrt(np.sqrt(quartic)))
        for _ in range(STEPS):
            density = np.sqrt(np.sqrt(cubic * density + quartic))
        return density


def _parts(count: int) -> FloatArray:
    """(count + 1,) from 0 to 1, the outermost parts shorter."""
    sizes = np.ones(count)
    for number, size in enumerate(OUTER[: (count + 1) // 2]):
        sizes[[number, -1 - number]] = size
    reached = np.concatenate(([0.0], np.cumsum(sizes)))
    parts: FloatArray = reached / reached[-1]
    return parts
