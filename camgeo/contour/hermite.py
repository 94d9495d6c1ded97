"""Cubics between places where a function and its slope are known: their overshoot, and a monotone
table of them.
"""

from __future__ import annotations

import numpy as np

from camgeo.numeric.arrays import FloatArray


def highest(
    start: FloatArray, end: FloatArray, slope: FloatArray, end_slope: FloatArray
) -> FloatArray:
    """Largest magnitude inside [0, 1] of Hermite cubics with these values and slopes at 0 and 1.

    All arrays have one shape, and so has the result; 0 where a cubic has no extreme inside.
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


def monotone(x: FloatArray, y: FloatArray, at: FloatArray) -> FloatArray:
    """(m,) values at `at` (m,) of the table `y` (n,) over `x` (n,), both strictly ascending.

    Piecewise cubic, its slopes at the points the harmonic means of those on both sides (F. N.
    Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984): it ascends as the table does. Beyond
    the ends the first and last cubic continue.
    """
    width = np.diff(x)
    slope = np.diff(y) / width
    slopes = np.empty(len(x))
    before, after = 2.0 * width[1:] + width[:-1], width[1:] + 2.0 * width[:-1]
    slopes[1:-1] = (before + after) / (before / slope[:-1] + after / slope[1:])
    slopes[0], slopes[-1] = slope[0], slope[-1]
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(width) - 1)
    s = (at - x[k]) / width[k]
    m0, m1, d = slopes[k], slopes[k + 1], slope[k]
    rise: FloatArray = s * (m0 + s * ((3.0 * d - 2.0 * m0 - m1) + s * (m0 + m1 - 2.0 * d)))
    return y[k] + width[k] * rise
