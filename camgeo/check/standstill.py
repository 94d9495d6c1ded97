"""Check that the roller centre never stands still in the turning cam."""

from __future__ import annotations

import math

import numpy as np

from camgeo.check.finding import Finding
from camgeo.curve.extremes import extremes
from camgeo.curve.pieces import slowest
from camgeo.curve.pitch_curve import STANDSTILL, PitchCurve
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.wording import at_cam_angles

SMALLEST = math.sqrt(STANDSTILL)
"""Smallest |Z'| as a fraction of the base radius per rad; below it the curvature has no digits."""


def check_standstill(curve: PitchCurve) -> tuple[Finding, ...]:
    """A finding that there is no disc where |Z'| vanishes; nothing where it does not."""
    limit = SMALLEST * curve.follower.base_radius
    if slowest(curve) > limit:
        return ()

    def square(phi: FloatArray, side: Side) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=1)
        return np.asarray(relative.u**2 + relative.v**2)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=2)
        (_, a1, a2), (_, b1, b2) = relative.along, relative.across
        return np.asarray(a1 * a2 + b1 * b2)

    smallest, phi = extremes(curve, square, slope).smallest()
    speed = math.sqrt(smallest)
    if speed > limit:
        return ()
    statement = (
        f"the roller centre stands still in the turning cam {at_cam_angles(phi, form='.6f')}"
        " (Z' = 0): the pitch curve has a cusp and no normal; the rocker lies on the line of"
        " centres and l_3 (1 - sigma psi') = l_1"
    )
    return (Finding("standstill", "no-disc", statement, speed, limit, "mm/rad", phi),)
