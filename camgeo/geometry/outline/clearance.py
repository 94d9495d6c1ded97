"""How near the roller centre comes to the cam axis, and whether it passes it by on one side."""

from __future__ import annotations

import numpy as np

from camgeo.geometry.pieces import extremes, turn_cells, turn_enclosed
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import FloatArray, Side


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

    False is inconclusive; `nearest_to_axis` decides then.
    """
    low, high = turn_cells(pitch)
    jet, bounds = turn_enclosed(pitch)
    return bool(np.all(np.abs(jet[0]) - 0.5 * (high - low) * bounds[0] > radius))


def stays_on_one_side(pitch: PitchCurve) -> bool:
    """True if the roller centre never passes the foot of the guide, or the line of centres.

    There the transmission angle is 0, and a distance from the cam axis occurs twice.
    """
    middle, bounds = pitch.motion.jet_and_bounds(*turn_cells(pitch))
    reach = np.array([np.min(middle[0] - bounds[0]), np.max(middle[0] + bounds[0])])
    if pitch.follower.on_one_side(reach):
        return True
    return pitch.follower.on_one_side(np.array(lift_range(pitch.motion)))
