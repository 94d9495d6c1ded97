"""Extremes of the curvature of the pitch curve; every offset has its own at the same places."""

from __future__ import annotations

from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve, curvature_slope
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray


def curvature_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the curvature kappa [1/mm] of the pitch curve; Z' must not vanish."""

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        return curvature_slope(curve.relative_jet(phi, side), curve.rotation)

    return extremes(curve, curve.curvature, slope)
