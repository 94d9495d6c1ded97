"""What drives the modes of a train, from the motion of its base."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.oscillator.mode import gain_over, solve
from camgeo.numeric.oscillator.pieces import Pieces, interpolated
from camgeo.numeric.oscillator.train import EPS, Train
from camgeo.numeric.peaks import Side

FINEST: Final = 1e-14
"""Share of the forcing that its series may leave out at least: rounding of the forcing itself."""

SOFT: Final = 1.0
"""|lambda| T below which the lift is the forcing, not the acceleration. The deflection of a train
that is soft against the turn is nearly -y, and summing up the acceleration twice over the turn
would magnify its rounding by 1 / |lambda T|^2."""

ROUNDINGS: Final = 8.0
"""Roundings that the estimates count for each step."""


@dataclass(frozen=True, slots=True)
class Base:
    """What moves the train.

    Attributes
    ----------
    jet : t (n,), side -> (3 or more, n) y, y', y'' over time; y repeats itself with the period.
    edges : (m + 1,) times from 0 to the period between which y is smooth; y is continuous at them,
        y' and y'' may jump.
    """

    jet: Callable[[FloatArray, Side], FloatArray]
    edges: FloatArray

    @property
    def period(self) -> float:
        return float(self.edges[-1])

    def jumps(self) -> FloatArray:
        """(m,) jump of y' at each edge but the last, which is the first one of the next turn."""
        after = self.jet(self.edges[:-1], "right")[1]
        before = np.roll(self.jet(self.edges[1:], "left")[1], 1)
        return np.asarray(after - before)


@dataclass(frozen=True, slots=True, eq=False)
class Forcing:
    """What drives the modes: -y'' with the jumps of -y', or y itself.

    Attributes
    ----------
    pieces : it as series.
    jumps : (p,) by which u jumps at the start of each piece.
    soft : whether it is y.
    """

    pieces: Pieces
    jumps: FloatArray
    soft: bool

    def gain(self, rate: complex, period: float) -> complex:
        """What a mode that begins with 0, before the first jump, is at the end of the turn."""
        count = self.pieces.series.shape[1]
        cells = solve(self.pieces, np.arange(count), np.full(count, rate))
        return gain_over(cells, self.jumps, period)

    def noise(self, period: float, frequency: float = 0.0) -> float:
        """Estimate of the error of the integral of forcing and exp(i `frequency` t)."""
        size = self.pieces.largest * period + float(np.sum(np.abs(self.jumps)))
        return self.pieces.error + ROUNDINGS * EPS * (1.0 + frequency * period) * size


def forcing_of(train: Train, base: Base, tolerance: float) -> Forcing:
    """What of `base` drives the modes of `train`."""
    soft = float(np.min(np.abs(train.rates))) * base.period < SOFT
    order, sign = (0, 1.0) if soft else (2, -1.0)
    pieces = interpolated(
        lambda t: sign * base.jet(t, "right")[order], base.edges, max(tolerance, FINEST)
    )
    jumps = np.zeros(pieces.series.shape[1])
    if not soft:
        jumps[np.searchsorted(pieces.edges, base.edges[:-1])] = -base.jumps()
    return Forcing(pieces, jumps, soft)
