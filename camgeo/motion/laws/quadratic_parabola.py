"""Quadratic parabola, VDI 2143-1 eqs. (24) to (29): smallest C_a, f'' jumps at 0, 1/2 and 1."""

from __future__ import annotations

import math

import numpy as np

from camgeo.motion.laws.law import Characteristic, HalfLaw, HalfRegion, Values
from camgeo.numeric.arrays import FloatArray


def _formula(z: FloatArray, _r: FloatArray) -> Values:
    return 2.0 * z * z, 4.0 * z, np.full_like(z, 4.0), np.zeros_like(z)


def _centre(r: FloatArray) -> FloatArray:
    return 2.0 * r * (1.0 - r)


QUADRATIC_PARABOLA = HalfLaw(
    name="quadratic-parabola",
    regions=(HalfRegion(0.0, 0.5, _formula, 0.0),),
    centre=_centre,
    characteristic=Characteristic(2.0, 4.0, 4.0, math.inf, 8.0, 8.0),
    middle_jumps=True,
    end_acceleration=4.0,
)
