"""Inverse of an ascending function, at many values at once."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import Function

MOST_STEPS: Final = 80
"""Halving alone needs 60."""

CLOSE: Final = 2.0 * float(np.finfo(np.float64).eps)
"""Share of the range of x within which a step of Newton's method counts as rounding."""


def inverse(function: Function, slope: Function, edges: FloatArray, y: FloatArray) -> FloatArray:
    """(n,) x with function(x) = `y` (n,), to the last bits.

    Parameters
    ----------
    function : (k,) -> (k,), ascending over `edges`.
    slope : its derivative, above 0.
    edges : (m + 1,) ascending, with `y` between the values at the first and the last; at the value
        of an edge the edge itself is found.

    Newton's method, kept in its bracket by halving.
    """
    marks = function(edges)
    piece = np.clip(np.searchsorted(marks, y, "right") - 1, 0, len(edges) - 2)
    low, high = edges[piece], edges[piece + 1]
    width = float(edges[-1] - edges[0])
    x = low + (y - marks[piece]) / (marks[piece + 1] - marks[piece]) * (high - low)
    x = np.where(y >= marks[-1], edges[-1], x)
    for _ in range(MOST_STEPS):
        miss = function(x) - y
        low, high = np.where(miss < 0.0, x, low), np.where(miss > 0.0, x, high)
        step = x - miss / slope(x)
        step = np.where((step >= low) & (step <= high), step, 0.5 * (low + high))
        step = np.where(miss == 0.0, x, step)
        done = np.abs(step - x) <= CLOSE * width
        x = step
        if np.all(done):
            break
    return x
