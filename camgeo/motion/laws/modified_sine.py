"""Modified sine (Modifizierte Sinuslinie, Neklutin), VDI 2143-1 eqs. (57) to (65).

Region II is anchored at its own left border: the printed (60) loses four bits there.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.motion.laws.law import Characteristic, HalfLaw, HalfRegion, Values
from camgeo.motion.laws.trigonometry import x_minus_sin
from camgeo.numeric.arrays import FloatArray

K = math.pi / (4.0 + math.pi)
AMPLITUDE = 4.0 * math.pi * K  # C_a
JERK = 4.0 * math.pi * AMPLITUDE  # C_j


def _quick(z: FloatArray, _r: FloatArray) -> Values:
    """0 <= z <= 1/8: quarter of the quick sine."""
    x = 4.0 * math.pi * z
    half_sine = np.sin(0.5 * x)
    f = K * x_minus_sin(x) / (4.0 * math.pi)
    return f, 2.0 * K * half_sine * half_sine, AMPLITUDE * np.sin(x), JERK * np.cos(x)


def _slow(z: FloatArray, r: FloatArray) -> Values:
    """1/8 <= z <= 1/2: quarter of the slow sine, three times as long."""
    u = z - 0.125
    y = 4.0 * math.pi / 3.0 * u
    half_sine, sine = np.sin(0.5 * y), np.sin(y)
    cosine = np.sin(4.0 * math.pi / 3.0 * r)  # of y, exact at its zero
    constant = 0.125 - 0.25 / math.pi
    f = K * (constant + u + 4.5 / math.pi * half_sine * half_sine)
    return f, K * (1.0 + 3.0 * sine), AMPLITUDE * cosine, -JERK / 3.0 * sine


def _centre(r: FloatArray) -> FloatArray:
    near = (math.pi * r + 2.25 * np.sin(4.0 * math.pi / 3.0 * r)) / (math.pi + 4.0)
    return np.where(r <= 0.375, near, 0.5 - _quick(0.5 - r, r)[0])


# Largest f' f'' lies in the second region.
_S = (math.sqrt(73.0) - 1.0) / 12.0
_MOMENT = K * AMPLITUDE * (1.0 + 3.0 * _S) * math.sqrt(1.0 - _S * _S)

MODIFIED_SINE = HalfLaw(
    name="modified-sine",
    regions=(HalfRegion(0.0, 0.125, _quick, JERK), HalfRegion(0.125, 0.5, _slow, JERK / 3.0)),
    centre=_centre,
    characteristic=Characteristic(
        velocity=4.0 * K,
        acceleration=AMPLITUDE,
        deceleration=AMPLITUDE,
        jerk=JERK,
        moment=_MOMENT,
        braking_moment=_MOMENT,
    ),
    borders=(0.125,),
)
