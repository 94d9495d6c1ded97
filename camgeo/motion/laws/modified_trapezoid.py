"""Modified acceleration trapezoid, VDI 2143-1 eqs. (39) to (56).

Regions II and III are anchored at their own left border: every term is positive there.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.motion.laws.law import Characteristic, HalfLaw, HalfRegion, Values
from camgeo.motion.laws.trigonometry import x_minus_sin
from camgeo.numeric.arrays import FloatArray

K = math.pi + 2.0
AMPLITUDE = 8.0 * math.pi / K  # C_a
JERK = 32.0 * math.pi**2 / K  # C_j


def _rise(z: FloatArray, _r: FloatArray) -> Values:
    """0 <= z <= 1/8: quarter sine of acceleration."""
    x = 4.0 * math.pi * z
    half_sine = np.sin(0.5 * x)
    f = x_minus_sin(x) / (2.0 * math.pi * K)
    return f, 4.0 / K * half_sine * half_sine, AMPLITUDE * np.sin(x), JERK * np.cos(x)


def _plateau(z: FloatArray, _r: FloatArray) -> Values:
    """1/8 <= z <= 3/8: constant acceleration."""
    u = z - 0.125
    f = (4.0 * math.pi * u * u + 2.0 * u + (0.25 - 0.5 / math.pi)) / K
    return f, (8.0 * math.pi * u + 2.0) / K, np.full_like(z, AMPLITUDE), np.zeros_like(z)


def _fall(z: FloatArray, r: FloatArray) -> Values:
    """3/8 <= z <= 1/2: quarter sine back to zero acceleration."""
    u = z - 0.375
    half_sine, sine = np.sin(2.0 * math.pi * u), np.sin(4.0 * math.pi * u)
    cosine = np.sin(4.0 * math.pi * r)  # of 4 pi u, exact at its zero
    constant = 0.75 + 0.25 * math.pi - 0.5 / math.pi
    f = (constant + 2.0 * (math.pi + 1.0) * u + half_sine * half_sine / math.pi) / K
    return f, 2.0 / K * (math.pi + 1.0 + sine), AMPLITUDE * cosine, -JERK * sine


def _centre(r: FloatArray) -> FloatArray:
    near = (2.0 * (math.pi + 1.0) * r + np.sin(4.0 * math.pi * r) / (2.0 * math.pi)) / K
    z = 0.5 - r
    far = 0.5 - np.where(z < 0.125, _rise(z, r)[0], _plateau(z, r)[0])
    return np.where(r <= 0.125, near, far)


# Largest f' f'' lies in the third region, where cos q = c.
_C = (math.pi + 1.0 - math.sqrt((math.pi + 1.0) ** 2 + 8.0)) / 4.0
_MOMENT = 16.0 * math.pi / K**2 * (math.pi + 1.0 - _C) * math.sqrt(1.0 - _C * _C)

MODIFIED_TRAPEZOID = HalfLaw(
    name="modified-trapezoid",
    regions=(
        HalfRegion(0.0, 0.125, _rise, JERK),
        HalfRegion(0.125, 0.375, _plateau, 0.0),
        HalfRegion(0.375, 0.5, _fall, JERK),
    ),
    centre=_centre,
    characteristic=Characteristic(
        velocity=2.0,
        acceleration=AMPLITUDE,
        deceleration=AMPLITUDE,
        jerk=JERK,
        moment=_MOMENT,
        braking_moment=_MOMENT,
    ),
    borders=(0.125, 0.375),
)
