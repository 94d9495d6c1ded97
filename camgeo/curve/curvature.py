"""Curvature of the pitch curve: its radius, and its extremes, which every offset shares."""

from __future__ import annotations

import numpy as np

from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.numeric.arrays import FloatArray


def curvature_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the curvature kappa [1/mm] of the pitch curve; Z' must not vanish."""
    return extremes(curve, curve.curvature, curve.curvature_slope)


def radius_of_curvature(kappa: FloatArray) -> FloatArray:
    """(n,) [mm] signed radius of the curvature `kappa` [1/mm]; infinite exactly at an inflection.

    Prefer the curvature, which has no poles.
    """
    radius: FloatArray = np.full_like(kappa, np.inf)
    return np.divide(1.0, kappa, out=radius, where=kappa != 0.0)
