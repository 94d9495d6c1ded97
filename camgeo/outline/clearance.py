"""Whether a point of a flank is clear of the roller all through the turn."""

from __future__ import annotations

import numpy as np

from camgeo.curve.extremes import extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.turn_cells import halves, turn_cells
from camgeo.motion.extremes import lift_range
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

HALVINGS = 50
"""Rounds of halving at most."""

CLOSE = 1e-9
"""A point nearer than the roller's radius by this share of it is covered; one nearer to the radius
than this is touched."""


def is_clear(pitch: PitchCurve, point: complex, radius: float, own: tuple[float, float]) -> bool:
    """True if no roller of `radius` [mm] on the pitch curve covers `point`.

    Surely: what a cell of cam angle cannot exclude is halved.

    Parameters
    ----------
    own : cam angles [rad], start in [0, 2 pi) and end above it, that are not looked at: the point
        is touched there, and its neighbours are known to be regular.
    """
    start, end = own
    low, high = turn_cells(pitch, start, end)
    outside = (0.5 * (low + high) - start) % TURN > end - start
    low, high = low[outside], high[outside]
    for _ in range(HALVINGS):
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        distance = np.abs(pitch.point(middle) - point)
        if len(distance) and float(np.min(distance)) < (1.0 - CLOSE) * radius:
            return False
        reach = half * pitch.speed_bounds(low, high)[0]
        near = distance - reach < (1.0 - CLOSE) * radius
        if not np.any(near):
            return True
        low, high = halves(low, high, near)
    return True  # touched, to rounding


def nearest_to_axis(pitch: PitchCurve) -> tuple[float, float]:
    """Smallest distance of the roller centre from the cam axis [mm] and its cam angle [rad]."""

    def square(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        return np.asarray(relative.along[0] ** 2 + relative.across[0] ** 2)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        (a0, a1), (b0, b1) = relative.along[:2], relative.across[:2]
        return np.asarray(a0 * a1 + b0 * b1)

    smallest, phi = extremes(pitch, square, slope).smallest()
    return float(np.sqrt(smallest)), phi


def surely_clear_of_axis(pitch: PitchCurve, radius: float) -> bool:
    """True if bounds over cells show that the roller centre stays farther than `radius` [mm].

    False says nothing; `nearest_to_axis` does then.
    """
    low, high = turn_cells(pitch)
    jet, bounds = pitch.jet_and_bounds(low, high)
    return bool(np.all(np.abs(jet[0]) - 0.5 * (high - low) * bounds[0] > radius))


def stays_on_one_side(pitch: PitchCurve) -> bool:
    """True if the roller centre never passes the foot of the guide, or the line of centres.

    There the transmission angle is 0, and the same distance from the cam axis comes again.
    """
    middle, bounds = pitch.motion.jet_and_bounds(*turn_cells(pitch))
    reach = np.array([np.min(middle[0] - bounds[0]), np.max(middle[0] + bounds[0])])
    if pitch.follower.on_one_side(reach):
        return True
    return pitch.follower.on_one_side(np.array(lift_range(pitch.motion)))
