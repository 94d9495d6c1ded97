"""3-4-5 polynomial (Polynom 5. Grades), VDI 2143-1 eqs. (33) to (35)."""

from __future__ import annotations

import math

from camgeo.motion.laws.law import Characteristic, HalfLaw, HalfRegion, Values
from camgeo.numeric.arrays import FloatArray


def _formula(z: FloatArray, r: FloatArray) -> Values:
    rest = 1.0 - z
    product = z * rest
    return (
        z * z * z * (10.0 + z * (6.0 * z - 15.0)),
        30.0 * product * product,
        120.0 * product * r,
        60.0 - 360.0 * product,
    )


def _centre(r: FloatArray) -> FloatArray:
    square = r * r
    return r * (1.875 + square * (6.0 * square - 5.0))


_MOMENT = 6075.0 / (343.0 * math.sqrt(7.0))

POLYNOMIAL_345 = HalfLaw(
    name="polynomial-345",
    regions=(HalfRegion(0.0, 0.5, _formula, 60.0),),
    centre=_centre,
    characteristic=Characteristic(
        velocity=15.0 / 8.0,
        acceleration=10.0 / math.sqrt(3.0),
        deceleration=10.0 / math.sqrt(3.0),
        jerk=60.0,
        moment=_MOMENT,
        braking_moment=_MOMENT,
    ),
)
