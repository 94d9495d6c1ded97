"""Largest size of a function between places where it and its slope are known."""

from __future__ import annotations

import numpy as np

from camgeo.numeric.arrays import FloatArray


def highest(
    start: FloatArray, end: FloatArray, slope: FloatArray, end_slope: FloatArray
) -> FloatArray:
    """Largest size inside [0, 1] of Hermite's cubics with these values and slopes at 0 and 1.

    All arrays are of one shape, and so is what is returned; 0 where a cubic has no extreme inside.
    """
    growth = end - start
    square = 3.0 * growth - 2.0 * slope - end_slope
    cube = slope + end_slope - 2.0 * growth
    # Extremes: slope + 2 square t + 3 cube t^2 = 0, in the form in which nothing cancels.
    radicand = square * square - 3.0 * cube * slope
    half = -(square + np.copysign(np.sqrt(np.maximum(radicand, 0.0)), square))
    found: FloatArray = np.zeros_like(growth)
    with np.errstate(divide="ignore", invalid="ignore"):
        for t in (slope / half, half / (3.0 * cube)):
            value = np.abs(start + t * (slope + t * (square + t * cube)))
            inside = (t > 0.0) & (t < 1.0) & (radicand > 0.0)
            found = np.where(inside, np.maximum(found, value), found)
    return found
