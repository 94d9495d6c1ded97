"""Check of the smallest transmission angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from camgeo.check.finding import Finding, held
from camgeo.curve.extremes import Extremes, extremes_of_each
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.together import curves_together
from camgeo.motion.kept import kept_with_each
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.many import Quantity
from camgeo.wording import at_cam_angles


@kept_with_each
def transmission_angle_extremes(curves: Sequence[PitchCurve]) -> list[Extremes]:
    """All local extremes of the transmission angle [rad]; Z' must not vanish.

    Of curves with the same motion and sense, and followers that are `alike`.
    """
    first, many = curves[0], curves_together(curves)
    return extremes_of_each(
        first, many, lambda curve: curve.transmission_angle, SLOPES[first.follower.touching]
    )


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
