"""Extremes of the curvature of the pitch curve; every offset has its own at the same places."""

from __future__ import annotations

from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve


def curvature_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the curvature kappa [1/mm] of the pitch curve; Z' must not vanish."""
    return extremes(curve, curve.curvature, curve.curvature_slope)
