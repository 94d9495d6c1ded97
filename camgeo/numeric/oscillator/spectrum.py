"""Shock spectrum: residual vibration after a move, over the ratio t_move / T_n.

The train is one mass at rest before the move, T_n = 2 pi / w its natural period; the residual is
the amplitude of the free vibration when the move ends, as a fraction of the stroke: |u(1)| / (w
sqrt(1 - D^2)). With the largest deflection during the move, |Im u(t)| / (w sqrt(1 - D^2)) at its
highest, it gives the maximax response (Neklutin's use of the spectrum for cams, see Rothbart, Cam
Design Handbook, section 13.2; Norton, Cam Design and Manufacturing Handbook, chapter on residual
vibrations).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.oscillator.mode import (
    NODES,
    Pieces,
    followed,
    interpolated,
    most_cells,
    series_values,
    solve,
)
from camgeo.numeric.oscillator.steady import FINEST, SOFT

BLOCK: Final = 16_384
"""Cells evaluated at a time, over all ratios, so that a block takes some tens of megabytes."""

QUIET: Final = 0.01
"""Share of the stroke below which a residual vibration counts as small."""

SAMPLES: Final = 64
"""Times a natural period at which the deflection during a move is evaluated."""


@dataclass(frozen=True, slots=True, eq=False)
class Shock:
    """A move by 1 in the time from 0 to 1, from rest to rest.

    Attributes
    ----------
    lift : the displacement from its start.
    end : its final value: 1, or less if it returns.
    pieces : minus its acceleration.
    kicks : (p + 1,) minus the jumps of its velocity at the edges of the pieces.
    """

    lift: Pieces
    end: float
    pieces: Pieces
    kicks: FloatArray

    def residual(self, ratios: FloatArray, damping: float = 0.0) -> FloatArray:
        """(n,) the residual at the ratios (n,), all above 0, with a damping ratio in [0, 1)."""
        ratios = np.asarray(ratios, dtype=np.float64)
        root = math.sqrt((1.0 - damping) * (1.0 + damping))
        frequency = 2.0 * math.pi * ratios
        rates = np.asarray(frequency * complex(-damping, root), dtype=np.complex128)
        gain = np.empty(len(rates), dtype=np.complex128)
        pieces = max(self.lift.series.shape[1], self.pieces.series.shape[1])
        blocks = np.cumsum(most_cells(pieces, rates)) // BLOCK
        ends = np.append(np.flatnonzero(np.diff(blocks)) + 1, len(rates))
        for first, end in pairwise((0, *ends.tolist())):
            block = rates[first:end]
            soft = np.abs(block) < SOFT
            part = gain[first:end]
            part[~soft] = self._gain(block[~soft])
            part[soft] = self._soft_gain(block[soft])
        remains: FloatArray = np.abs(gain) / (frequency * root)
        return remains

    def largest(self, ratios: FloatArray, damping: float = 0.0) -> FloatArray:
        """(n,) the largest deflection at the ratios (n,), as a fraction of the stroke, sampled.

        The residual, or the largest deflection during the move at `SAMPLES` times a natural period:
        the largest of a harmonic deflection is missed by at most 1 - cos(pi/SAMPLES), 0.1 %.
        """
        root = math.sqrt((1.0 - damping) * (1.0 + damping))
        count = self.pieces.series.shape[1]
        every = np.arange(count)
        found = self.residual(ratios, damping)
        for number, ratio in enumerate(np.asarray(ratios, dtype=np.float64).tolist()):
            frequency = 2.0 * math.pi * ratio
            rate = np.full(count, frequency * complex(-damping, root))
            mode = followed(solve(self.pieces, every, rate), self.kicks[:-1], 1.0, 0j)
            times = np.linspace(0.0, 1.0, SAMPLES * math.ceil(max(ratio, 1.0)) + 1)
            deflection = np.abs(mode.values(times, "right").imag) / (frequency * root)
            found[number] = max(found[number], float(np.max(deflection)))
        return found

    def bound(self, ratio: float, damping: float = 0.0) -> float:
        """An upper bound of the residuals from `ratio` on.

        Integrated by parts once, the integral of exp(lambda (1 - t)) a is at most the variation of
        a, its jumps at the ends included, by |lambda|.
        """
        frequency = 2.0 * math.pi * ratio
        root = math.sqrt((1.0 - damping) * (1.0 + damping))
        x = np.linspace(-1.0, 1.0, 4 * len(NODES))[:, np.newaxis]
        values = np.pad(series_values(self.pieces.series, x).T.ravel(), 1)
        variation = float(np.sum(np.abs(np.diff(values))))
        return (variation / frequency + float(np.sum(np.abs(self.kicks)))) / (frequency * root)

    def _gain(self, rates: ComplexArray) -> ComplexArray:
        """(k,) u at the end."""
        gain = _gains(self.pieces, rates)
        for time, kick in zip(self.pieces.edges.tolist(), self.kicks.tolist(), strict=True):
            if kick != 0.0:
                gain += kick * np.exp(rates * (1.0 - time))
        return gain

    def _soft_gain(self, rates: ComplexArray) -> ComplexArray:
        """(k,) the same from the lift, see `camgeo.numeric.oscillator.steady.SOFT`."""
        return -rates * (rates * _gains(self.lift, rates) + self.end)


def shock(
    lift: Callable[[FloatArray], FloatArray],
    acceleration: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    jumps: FloatArray,
    end: float = 1.0,
    rounding: float = 0.0,
) -> Shock:
    """The move with that `lift`, which is smooth between `edges` (m + 1,) from 0 to 1.

    `acceleration` is its second derivative, `jumps` (m + 1,) are those of its first one at the
    edges, `end` is the lift at the end, `rounding` the error with which they take their argument.
    """
    pieces = interpolated(lambda z: -acceleration(z), edges, FINEST, rounding)
    kicks = np.zeros(len(pieces.edges))
    kicks[np.searchsorted(pieces.edges, edges)] = -jumps
    return Shock(interpolated(lift, edges, FINEST, rounding), end, pieces, kicks)


def _gains(pieces: Pieces, rates: ComplexArray) -> ComplexArray:
    """(k,) value at the end of all pieces of a mode that begins with 0, for each of `rates`."""
    count = pieces.series.shape[1]
    cells = solve(pieces, np.tile(np.arange(count), len(rates)), np.repeat(rates, count))
    owner = cells.problem // count
    rest = np.maximum(1.0 - cells.start - 2.0 * cells.half, 0.0)
    parts = np.exp(cells.rate * rest) * cells.gain
    real = np.bincount(owner, parts.real, len(rates))
    return np.asarray(real + 1j * np.bincount(owner, parts.imag, len(rates)))
