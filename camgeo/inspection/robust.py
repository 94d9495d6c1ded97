"""Weights with which a fit passes over local errors of form.

Tukey's biweight: with e the deviation and s their scale, points count by (1 - u^2)^2 with
u = e / (4.685 s), and not at all where |u| >= 1. The scale is the median of |e| over that of the
normal distribution, so that up to half the points may be far off. With normally distributed errors
the result scatters as little as with 95 % of the points by least squares. Its covariance is that of
least squares with tau^2 in place of sigma^2 (P. J. Huber, Robust Statistics, 1981, section 7.6):

    tau^2 = [sum psi^2 / (n - p)] / [mean psi']^2,  psi = e (1 - u^2)^2.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray

TUNING: Final = 4.685

NORMAL: Final = 0.6744897501960817
"""Median of the magnitude of a standard normal variable."""


def weights(deviations: FloatArray, floor: float) -> FloatArray:
    """(n,) weights of `deviations` (n,) [mm], whose scale is at least `floor`."""
    inside = 1.0 - _reduced(deviations, floor) ** 2
    return np.where(inside > 0.0, inside * inside, 0.0)


def standard_error(deviations: FloatArray, freedom: int, floor: float) -> float:
    """tau [mm] of the fit that leaves these `deviations` (n,), with `freedom` n - p."""
    square = _reduced(deviations, floor) ** 2
    inside = np.maximum(1.0 - square, 0.0)
    psi = deviations * inside * inside
    slope = float(np.mean(inside * (1.0 - 5.0 * square)))
    return math.sqrt(float(np.sum(psi * psi)) / freedom) / slope if slope > 0.0 else math.inf


def _reduced(deviations: FloatArray, floor: float) -> FloatArray:
    """(n,) u."""
    scale = max(float(np.median(np.abs(deviations))) / NORMAL, floor)
    return deviations / (TUNING * scale)
