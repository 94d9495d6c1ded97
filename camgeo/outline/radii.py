"""Smallest and largest distance of a closed path from the cam axis, and whether it goes round it.

On a parallel W = Z + d n of the pitch curve the derivative of |W|^2 is 2 Re(conj(W) W'), and W' has
the direction t of the pitch curve, to which n is square: it vanishes where Re(conj(Z) t) does, for
every d. The distance |Z| of a roller's centre is a function of the follower's position alone, so
these are the turning points of the motion, and positions in which the follower is at a dead point.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.motion.extremes import turning_angles
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged, phase
from camgeo.numeric.extremes import Extreme, Extremes, extremes_of, piecewise_extremes
from camgeo.outline.moments import stretch_integrals
from camgeo.outline.path import Path, Pivot, Stretch
from camgeo.units import TURN

NEAR_A_TURN: Final = 1e-3
"""Tolerance of the angle by which a path goes round, which is a multiple of a turn."""


def radii(path: Path) -> Extremes:
    """Smallest and largest distance from the cam axis [mm], each with the first cam angle [rad] at
    which it is reached.

    They are exact but for rounding where they are at an end of a stretch, a corner, a border or a
    turning point of the motion; those of any other kind are found as by `piecewise_extremes`.
    """
    found = [_of_stretch(each) if isinstance(each, Stretch) else _of_pivot(each)
             for each in path.elements]  # fmt: skip
    both = [extreme for each in found for extreme in (each.lowest, each.highest)]
    places = np.array([each.place % TURN for each in both])
    return extremes_of(places, np.array([each.value for each in both]))


def encloses_axis(path: Path) -> bool:
    """Whether the path, which must not pass through the cam axis, goes round it."""
    turned = math.fsum(
        one.real
        for each in path.stretches
        for one, *_ in stretch_integrals(each, (_turning, _turning), NEAR_A_TURN)
    )
    turned += math.fsum(_turn_of_arc(each) for each in path.pivots if each.distance != 0.0)
    return round(turned / TURN) != 0


def _turning(point: ComplexArray, way: ComplexArray) -> FloatArray:
    found: FloatArray = (way / point).imag
    return found


def _turn_of_arc(pivot: Pivot) -> float:
    """By how much the arc turns about the cam axis [rad], exactly.

    With the axis outside its circle by less than half a turn; with the axis inside by its sweep and
    what the direction from the axis leads that from the centre, less than a quarter turn, at its
    ends.
    """
    ends = np.array([pivot.start, pivot.end])
    if abs(pivot.centre) > abs(pivot.distance):
        return float(np.angle(ends[1] * ends[0].conj()))
    ahead = np.angle(ends / (ends - pivot.centre))
    return pivot.sweep + float(ahead[1] - ahead[0])


def _of_stretch(stretch: Stretch) -> Extremes:
    turning = turning_angles(stretch.curve.pitch.motion)
    turning = np.concatenate((turning, turning + TURN))
    inside = turning[(turning > stretch.start) & (turning < stretch.end)]

    def distance(phi: FloatArray, side: Side) -> FloatArray:
        return np.abs(stretch.curve.point(phi, side))

    return piecewise_extremes(distance, merged(np.concatenate((stretch.marks, inside))))


def _of_pivot(pivot: Pivot) -> Extremes:
    """Of an arc the ends, and its points in front of its centre and behind it."""
    values = [abs(pivot.start), abs(pivot.end)]
    if pivot.distance != 0.0 and pivot.centre != 0.0:
        outward = pivot.centre / abs(pivot.centre)
        for normal in (outward, -outward):
            if 0.0 <= phase(normal / pivot.normal) / pivot.sweep <= 1.0:
                values.append(abs(pivot.centre + pivot.distance * normal))
    return Extremes(Extreme(min(values), pivot.after), Extreme(max(values), pivot.after))
