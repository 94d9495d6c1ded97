"""Exact extremes of a quantity over the turn: bracketed roots of its slope in each smooth piece.

Among them those of the curvature of a pitch curve, which decide the size of the roller.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.curve.pieces import HasBreaks, smooth_pieces
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.displayed import Brief
from camgeo.numeric.arrays import FloatArray, IntArray, frozen
from camgeo.numeric.many import ONE, Asked, Many, Quantity
from camgeo.numeric.roots import roots_in_rows
from camgeo.units import TURN

SAMPLES = 257
"""Grid points per smooth piece on which sign changes of a slope are sought."""

INSIDE = 1e-8
"""How far inside a piece its ends are taken, as a fraction of its length: far beyond the rounding
of a cam angle, and an extreme in between differs from the end value by this fraction squared."""


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
    return extremes_of_each(curve, ONE, value, slopes)[0]


def extremes_of_each(
    breaks: HasBreaks, many: Many[Asked], value: Asked, slopes: Asked
) -> list[Extremes]:
    """The `extremes` of each of `many`, which all have the same `breaks`."""
    pieces = smooth_pieces(breaks)
    starts = np.array([piece.start for piece in pieces])
    ends = np.array([piece.end for piece in pieces])
    moving = np.array([not piece.dwell for piece in pieces])
    middle, which = np.empty(0), np.empty(0, dtype=np.intp)
    if np.any(moving):
        grid = np.linspace(starts[moving], ends[moving], SAMPLES, axis=1)
        inside = INSIDE * (ends - starts)[moving]
        grid[:, 0] += inside  # from inside, where a slope may jump
        grid[:, -1] -= inside
        middle, which = _turning(many, slopes, grid)
    at_starts = many.everywhere(value, starts, "right")
    at_ends = many.everywhere(value, ends, "left")
    between = many.at(value, middle, "right", which)
    # At a break the end of one piece comes before the start of the next.
    owner = np.searchsorted(starts, middle, side="right") - 1
    each = np.arange(len(pieces))
    found = []
    for one in range(many.count):
        own = which == one
        phi = np.concatenate((starts, middle[own], ends))
        values = np.concatenate((at_starts[one], between[own], at_ends[one]))
        rank = np.repeat([0, 1, 2], [len(starts), int(np.count_nonzero(own)), len(ends)])
        order = np.lexsort((phi, rank, np.concatenate((each, owner[own], each))))
        found.append(Extremes(frozen(phi[order], np.float64), frozen(values[order], np.float64)))
    return found


def _turning(many: Many[Asked], slopes: Asked, grid: FloatArray) -> tuple[FloatArray, IntArray]:
    """Where one of the `slopes` of one of `many` vanishes, ascending, and of which."""
    values = many.everywhere(slopes, grid.ravel(), "right")
    kinds = values.reshape(-1, many.count, *grid.shape)

    def of_row(phi: FloatArray, row: IntArray) -> FloatArray:
        kind, one, _ = np.unravel_index(row, kinds.shape[:-1])
        found = many.at(slopes, phi, "right", one)
        return found if found.ndim == 1 else found[kind, np.arange(len(phi))]

    roots, row = roots_in_rows(of_row, grid, kinds)
    _, which, _ = np.unravel_index(row, kinds.shape[:-1])
    order = np.argsort(roots, kind="stable")
    return roots[order], which[order]


def curvature_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the curvature kappa [1/mm] of the pitch curve; Z' must not vanish."""
    return extremes(curve, curve.curvature, curve.curvature_slope)


def radius_of_curvature(kappa: FloatArray) -> FloatArray:
    """(n,) [mm] signed radius of the curvature `kappa` [1/mm]; infinite exactly at an inflection.

    Prefer the curvature, which has no poles.
    """
    radius: FloatArray = np.full_like(kappa, np.inf)
    return np.divide(1.0, kappa, out=radius, where=kappa != 0.0)
