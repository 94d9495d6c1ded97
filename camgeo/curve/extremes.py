"""Exact extremes of a quantity over the turn: bracketed roots of its slope in each smooth piece.

Among them those of the curvature of a pitch curve, which decide the size of the roller.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgeo.curve.pieces import HasBreaks, smooth_pieces
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.displayed import Brief
from camgeo.numeric.arrays import FloatArray, Side, frozen
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

SAMPLES = 257
"""Grid points per smooth piece on which sign changes of a slope are sought."""

INSIDE = 1e-8
"""How far inside a piece its ends are taken, as a fraction of its length: far beyond the rounding
of a cam angle, and an extreme in between differs from the end value by this fraction squared."""

Quantity = Callable[[FloatArray, Side], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Extremes(Brief):
    """Values at all places where a quantity can be extreme.

    Attributes
    ----------
    phi : (k,) cam angles [rad], ascending over one turn from the first break on, which appears
        again as the last; a break appears twice in a row, for its two sides.
    values : (k,) of the quantity there.
    """

    phi: FloatArray
    values: FloatArray

    def smallest(self) -> tuple[float, float]:
        """Smallest value and its cam angle [rad], the first of equals."""
        index = int(np.argmin(self.values))
        return float(self.values[index]), float(self.phi[index]) % TURN

    def largest(self) -> tuple[float, float]:
        """Largest value and its cam angle [rad], the first of equals."""
        index = int(np.argmax(self.values))
        return float(self.values[index]), float(self.phi[index]) % TURN


def extremes(curve: HasBreaks, value: Quantity, slopes: Quantity) -> Extremes:
    """All local extremes of `value` over one turn.

    Parameters
    ----------
    curve : gives the smooth pieces.
    value : the quantity, (n,) at n cam angles, from the side asked for.
    slopes : what vanishes inside the pieces at the candidates, besides the ends of the pieces seen
        from inside: (n,), or (k, n) for several such quantities.
    """
    pieces = smooth_pieces(curve)
    starts = np.array([piece.start for piece in pieces])
    ends = np.array([piece.end for piece in pieces])
    moving = np.array([not piece.dwell for piece in pieces])
    found = [np.empty(0)]
    if np.any(moving):
        grid = np.linspace(starts[moving], ends[moving], SAMPLES, axis=1)
        inside = INSIDE * (ends - starts)[moving]
        grid[:, 0] += inside  # from inside, where a slope may jump
        grid[:, -1] -= inside
        found.append(roots_on_grid(lambda phi: slopes(phi, "right"), grid))
    middle = np.sort(np.concatenate(found))
    phi = np.concatenate((starts, middle, ends))
    values = [value(starts, "right"), value(middle, "right"), value(ends, "left")]
    # At a break the end of one piece comes before the start of the next.
    owner = np.searchsorted(starts, middle, side="right") - 1
    each = np.arange(len(pieces))
    rank = np.repeat([0, 1, 2], [len(starts), len(middle), len(ends)])
    order = np.lexsort((phi, rank, np.concatenate((each, owner, each))))
    return Extremes(
        frozen(phi[order], np.float64), frozen(np.concatenate(values)[order], np.float64)
    )


def curvature_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the curvature kappa [1/mm] of the pitch curve; Z' must not vanish."""
    return extremes(curve, curve.curvature, curve.curvature_slope)


def radius_of_curvature(kappa: FloatArray) -> FloatArray:
    """(n,) [mm] signed radius of the curvature `kappa` [1/mm]; infinite exactly at an inflection.

    Prefer the curvature, which has no poles.
    """
    radius: FloatArray = np.full_like(kappa, np.inf)
    return np.divide(1.0, kappa, out=radius, where=kappa != 0.0)
