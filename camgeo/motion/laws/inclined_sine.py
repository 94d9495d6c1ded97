"""Inclined sine, cycloidal (Geneigte Sinuslinie), VDI 2143-1 eqs. (36) to (38)."""

from __future__ import annotations

import math

import numpy as np

from camgeo.motion.laws.law import Characteristic, HalfLaw, HalfRegion, Values
from camgeo.motion.laws.trigonometry import x_minus_sin
from camgeo.numeric.arrays import FloatArray


def _outer(z: FloatArray, _r: FloatArray) -> Values:
    """0 <= z <= 1/4, where x = 2 pi z <= pi/2."""
    x = 2.0 * math.pi * z
    half_sine, sine = np.sin(math.pi * z), np.sin(x)
    versine = 2.0 * half_sine * half_sine
    f = x_minus_sin(x) / (2.0 * math.pi)
    return f, versine, 2.0 * math.pi * sine, 4.0 * math.pi**2 * (1.0 - versine)


def _inner(z: FloatArray, r: FloatArray) -> Values:
    """1/4 <= z <= 1/2: from the middle, so that f'' keeps its digits at its zero there."""
    half_sine = np.sin(math.pi * z)
    sine = np.sin(2.0 * math.pi * r)
    versine = 2.0 * half_sine * half_sine
    f = z - sine / (2.0 * math.pi)
    return f, versine, 2.0 * math.pi * sine, 4.0 * math.pi**2 * (1.0 - versine)


def _centre(r: FloatArray) -> FloatArray:
    return r + np.sin(2.0 * math.pi * r) / (2.0 * math.pi)


_MOMENT = 1.5 * math.sqrt(3.0) * math.pi

INCLINED_SINE = HalfLaw(
    name="inclined-sine",
    regions=(
        HalfRegion(0.0, 0.25, _outer, 4.0 * math.pi**2),
        HalfRegion(0.25, 0.5, _inner, 4.0 * math.pi**2),
    ),
    centre=_centre,
    characteristic=Characteristic(
        velocity=2.0,
        acceleration=2.0 * math.pi,
        deceleration=2.0 * math.pi,
        jerk=4.0 * math.pi**2,
        moment=_MOMENT,
        braking_moment=_MOMENT,
    ),
)
