"""Check of the smallest transmission angle."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.check.finding import Finding, held
from camgeo.curve.extremes import Extremes, Quantity, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.wording import at_cam_angles


def transmission_angle_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the transmission angle [rad]; Z' must not vanish."""
    return extremes(curve, curve.transmission_angle, SLOPES[curve.follower.touching](curve))


def _of_roller(curve: PitchCurve) -> Quantity:
    """What vanishes where the angle of a roller can be extreme."""

    def slopes(phi: FloatArray, side: Side) -> FloatArray:
        """Rows: slope of the angle; what vanishes where it is 0, and where it is 90 degrees."""
        motion = curve.motion.jet(phi, side)
        tangent = curve.follower.tangent_jet(motion, curve.rotation)
        turning = tangent.u[0] * tangent.w[1] - tangent.w[0] * tangent.u[1]
        relative = curve.follower.relative_jet(motion, curve.rotation, 1)
        return np.stack((turning, relative.u, relative.v))

    return slopes


def _of_face(curve: PitchCurve) -> Quantity:
    """The same for a flat face, where the angle depends on the position of the contact alone."""
    from camgeo.outline.convex import touch  # few cams have a flat face

    return lambda phi, side: touch(curve, phi, side).contact


SLOPES: Final = {"roller": _of_roller, "face": _of_face}


def check_transmission_angle(curve: PitchCurve, limit: float) -> Finding:
    """Compare the smallest transmission angle with `limit` [rad]."""
    smallest, phi = transmission_angle_extremes(curve).smallest()
    value, bound = math.degrees(smallest), math.degrees(limit)
    place = at_cam_angles(phi, form=".4f")
    statement = f"smallest transmission angle {value:.4f} deg {place}"
    return held("transmission-angle", statement, value, bound, "deg", phi, least=True)
