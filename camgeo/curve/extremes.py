"""Exact extremes of a quantity over the turn: bracketed roots of its slope in each smooth piece.

Among them those of the curvature of a pitch curve, which decide the size of the roller. The slope
is examined in cells between the borders of the motion's formula, which are the knots of a table,
and no number of samples is fixed, see `camgeo.numeric.isolation`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.curve.pieces import HasBorders, smooth_pieces
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.displayed import Brief
from camgeo.motion.kept import kept_with_owner
from camgeo.numeric.arrays import FloatArray, IntArray, frozen, merged
from camgeo.numeric.isolation import cells_between, isolated_roots, places_in
from camgeo.numeric.many import ONE, Asked, Many, Quantity
from camgeo.units import TURN


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


def extremes(curve: HasBorders, value: Quantity, slopes: Quantity) -> Extremes:
    """All local extremes of `value` over one turn.

    Parameters
    ----------
    curve : gives the smooth pieces, and the borders inside them.
    value : the quantity, (n,) at n cam angles, from the side asked for.
    slopes : what vanishes inside the pieces at the candidates, besides the ends of the pieces seen
        from inside: (n,), or (k, n) for several such quantities.
    """
    return extremes_of_each(curve, ONE, value, slopes)[0]


def extremes_of_each(
    breaks: HasBorders, many: Many[Asked], value: Asked, slopes: Asked
) -> list[Extremes]:
    """The `extremes` of each of `many`, which all have the same `breaks`."""
    turn = kept_turn(breaks) if isinstance(breaks, PitchCurve) else turn_of(breaks)
    starts, ends = turn.starts, turn.ends
    middle, which = np.empty(0), np.empty(0, dtype=np.intp)
    if len(turn.places):
        middle, which = _turning(many, value, slopes, turn.places)
    at_starts = many.everywhere(value, starts, "right")
    at_ends = many.everywhere(value, ends, "left")
    between = many.at(value, middle, "right", which)
    # At a break the end of one piece comes before the start of the next.
    owner = np.searchsorted(starts, middle, side="right") - 1
    each = np.arange(len(starts))
    found = []
    for one in range(many.count):
        own = which == one
        phi = np.concatenate((starts, middle[own], ends))
        values = np.concatenate((at_starts[one], between[own], at_ends[one]))
        rank = np.repeat([0, 1, 2], [len(starts), int(np.count_nonzero(own)), len(ends)])
        order = np.lexsort((phi, rank, np.concatenate((each, owner[own], each))))
        found.append(Extremes(frozen(phi[order], np.float64), frozen(values[order], np.float64)))
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """The smooth pieces of a turn, and the cells in which a slope is examined.

    Attributes
    ----------
    starts, ends : (m,) of the pieces [rad], ascending; the last end may exceed 2 pi.
    places : (n, k) in the cells of the pieces that are no dwells, see `places_in`.
    """

    starts: FloatArray
    ends: FloatArray
    places: FloatArray


def turn_of(curve: HasBorders) -> Turn:
    """The pieces and the cells of a curve: none of the cells reaches across a border."""
    pieces = smooth_pieces(curve)
    starts = np.array([piece.start for piece in pieces])
    ends = np.array([piece.end for piece in pieces])
    moving = np.array([not piece.dwell for piece in pieces])
    borders = np.concatenate((curve.borders, curve.borders + TURN))
    inner = borders[(borders > starts[0]) & (borders < ends[-1])]
    low, high = cells_between(merged(np.concatenate((starts, inner, ends[-1:]))))
    owner = np.searchsorted(starts, 0.5 * (low + high)) - 1
    low, high, owner = (each[moving[owner]] for each in (low, high, owner))
    return Turn(starts, ends, places_in(low, high, starts[owner], ends[owner]))


@kept_with_owner
def kept_turn(curve: PitchCurve) -> Turn:
    """`turn_of` a curve of which several quantities are examined."""
    return turn_of(curve)


def _turning(
    many: Many[Asked], value: Asked, slopes: Asked, places: FloatArray
) -> tuple[FloatArray, IntArray]:
    """Where one of the `slopes` of one of `many` vanishes, ascending, and of which."""
    known = many.everywhere(slopes, places.ravel(), "right")
    known = known.reshape(-1, many.count, *places.shape)

    def of_row(phi: FloatArray, row: IntArray) -> FloatArray:
        kind, one = np.divmod(row, many.count)
        found = many.at(slopes, phi, "right", one)
        return found if found.ndim == 1 else found[kind, np.arange(len(phi))]

    def value_of(phi: FloatArray, row: IntArray) -> FloatArray:
        return many.at(value, phi, "right", row % many.count)

    roots, row = isolated_roots(of_row, value_of, places, known.reshape(-1, *places.shape))
    order = np.argsort(roots, kind="stable")
    return roots[order], row[order] % many.count


@kept_with_owner
def curvature_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the curvature kappa [1/mm] of the pitch curve; Z' must not vanish."""
    return extremes(curve, curve.curvature, curve.curvature_slope)


def radius_of_curvature(kappa: FloatArray) -> FloatArray:
    """(n,) [mm] signed radius of the curvature `kappa` [1/mm]; infinite exactly at an inflection.

    Prefer the curvature, which has no poles.
    """
    radius: FloatArray = np.full_like(kappa, np.inf)
    return np.divide(1.0, kappa, out=radius, where=kappa != 0.0)
