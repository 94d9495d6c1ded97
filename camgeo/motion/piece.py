"""A piece of a motion plan: a stretch of the turn with one formula, and how it is evaluated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.motion.laws.law import Formula, Values
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import FloatArray

if TYPE_CHECKING:  # only a motion by data needs splines
    from camgeo.motion.spline import Spline


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of the turn with one formula; a dwell has none.

    s = origin + lift * (near value), with the near value f counted from the segment's start or
    g = 1 - f counted from its end.
    """

    start: float
    end: float
    origin: float
    lift: float = 0.0
    formula: Formula | None = None
    segment_start: float = 0.0
    segment_end: float = 0.0
    jerk_bound: float = 0.0
    from_end: bool = False
    spline: Spline | None = None

    @property
    def rests(self) -> bool:
        """Whether nothing moves."""
        return self.formula is None

    @property
    def length(self) -> float:
        """Cam angle of the whole segment [rad]."""
        return self.segment_end - self.segment_start

    def jet(self, phi: FloatArray, out: Jet) -> None:
        """Write lift and derivatives at `phi` (n,) [rad] inside the piece into `out` (4, n)."""
        if self.formula is None:
            out[0] = self.origin
            out[1:] = 0.0
            return
        span = self.length
        rate = 1.0 / span
        near, f1, f2, f3 = self.formula(
            (phi - self.segment_start) * rate, (self.segment_end - phi) * rate
        )
        np.multiply(near, -self.lift if self.from_end else self.lift, out=out[0])
        out[0] += self.origin
        np.multiply(f1, self.lift / span, out=out[1])
        np.multiply(f2, self.lift / span**2, out=out[2])
        np.multiply(f3, self.lift / span**3, out=out[3])

    @property
    def knots(self) -> FloatArray:
        """Cam angles [rad] inside the piece at which the polynomial of a spline changes."""
        if self.spline is None:
            return np.empty(0)
        inner = self.spline.knots[1:-1]
        angles: FloatArray = self.segment_start + inner * self.length
        return angles

    def spline_bounds(self, low: FloatArray, high: FloatArray) -> Jet:
        """(4, n) what `MotionPlan.jet_and_bounds` gives, for cells of a piece that has a spline."""
        assert self.spline is not None  # called for those only
        shares = [np.clip((a - self.segment_start) / self.length, 0.0, 1.0) for a in (low, high)]
        bounds = self.spline.cell_bounds(*shares)
        return bounds / self.length ** np.arange(4.0)[:, np.newaxis]

    @property
    def jerk_limit(self) -> float:
        """Bound of |s'''| over the piece."""
        if self.formula is None:
            return 0.0
        return abs(self.lift) / self.length**3 * self.jerk_bound


def spline_piece(spline: Spline, position: float, start: float, end: float) -> Piece:
    """The piece of a motion by data: `spline` over z in [0, 1], from `position`."""

    def formula(z: FloatArray, _w: FloatArray) -> Values:
        s, s1, s2, s3 = spline.values(np.clip(z, 0.0, 1.0))
        return s, s1, s2, s3

    return Piece(
        start, end, position, 1.0, formula, start, end,
        jerk_bound=float(np.max(spline.bounds(3))), spline=spline,
    )  # fmt: skip
