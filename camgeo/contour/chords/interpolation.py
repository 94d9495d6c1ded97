"""Monotone interpolation of a table, smooth where the table is."""

from __future__ import annotations

import numpy as np

from camgeo.numeric.arrays import FloatArray


def monotone(x: FloatArray, y: FloatArray, at: FloatArray) -> FloatArray:
    """(m,) values at `at` (m,) of the table `y` (n,) over `x` (n,), both strictly ascending.

    Piecewise cubic, its slopes at the points the harmonic means of those on both sides (F. N.
    Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984): it ascends as the table does. Beyond
    the ends the first and last cubic count on.
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
