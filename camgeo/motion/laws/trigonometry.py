"""Differences of trigonometric functions without cancellation."""

from __future__ import annotations

import math

from camgeo.numeric.arrays import FloatArray

# x - sin x = x^3/6 (1 - 6 x^2/5! + 6 x^4/7! - ...). Ten terms leave less than 1e-17 of the value
# up to x = pi/2.
COEFFICIENTS = tuple((-1) ** k * 6.0 / math.factorial(2 * k + 3) for k in range(10))


def x_minus_sin(x: FloatArray) -> FloatArray:
    """Return x - sin x for 0 <= x <= pi/2, to a few ulp of the result."""
    square = x * x
    series = COEFFICIENTS[-1] * square
    for coefficient in COEFFICIENTS[-2:0:-1]:
        series += coefficient
        series *= square
    series += 1.0
    square *= x
    square /= 6.0
    square *= series
    return square
