"""Simple sine (Einfache Sinuslinie), VDI 2143-1 eqs. (30) to (32): f'' jumps at both ends."""

from __future__ import annotations

import math

import numpy as np

from camgeo.motion.laws.law import Characteristic, HalfLaw, HalfRegion, Values
from camgeo.numeric.arrays import FloatArray


def _formula(z: FloatArray, r: FloatArray) -> Values:
    half_sine = np.sin(0.5 * math.pi * z)
    sine = np.sin(math.pi * z)
    cosine = np.sin(math.pi * r)  # keeps its digits at its zero, z = 1/2
    return (
        half_sine * half_sine,
        0.5 * math.pi * sine,
        0.5 * math.pi**2 * cosine,
        -0.5 * math.pi**3 * sine,
    )


def _centre(r: FloatArray) -> FloatArray:
    return 0.5 * np.sin(math.pi * r)


SIMPLE_SINE = HalfLaw(
    name="simple-sine",
    regions=(HalfRegion(0.0, 0.5, _formula, 0.5 * math.pi**3),),
    centre=_centre,
    characteristic=Characteristic(
        velocity=math.pi / 2,
        acceleration=math.pi**2 / 2,
        deceleration=math.pi**2 / 2,
        jerk=math.inf,
        moment=math.pi**3 / 8,
        braking_moment=math.pi**3 / 8,
    ),
    end_acceleration=0.5 * math.pi**2,
)
