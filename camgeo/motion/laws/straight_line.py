"""Straight line (Gerade), VDI 2143-1 eqs. (21) to (23): constant velocity, a shock at both ends."""

from __future__ import annotations

import math

import numpy as np

from camgeo.motion.laws.law import Characteristic, HalfLaw, HalfRegion, Values
from camgeo.numeric.arrays import FloatArray


def _formula(z: FloatArray, _r: FloatArray) -> Values:
    zero = np.zeros_like(z)
    return z, np.ones_like(z), zero, zero


def _centre(r: FloatArray) -> FloatArray:
    return r


STRAIGHT_LINE = HalfLaw(
    name="straight-line",
    regions=(HalfRegion(0.0, 0.5, _formula, 0.0),),
    centre=_centre,
    characteristic=Characteristic(1.0, math.inf, math.inf, math.inf, math.inf, math.inf),
    end_velocity=1.0,
)
