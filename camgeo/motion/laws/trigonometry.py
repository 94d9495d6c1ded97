"""Differences of trigonometric functions without cancellation."""

from __future__ import annotations

from camgeo.numeric.arrays import FloatArray

# x - sin x = x^3/6 (1 - x^2/20 (1 - x^2/42 (...))): divisors (2k)(2k + 1) for k = 2, 3, ...
# Nine of them leave less than 1e-17 of the value up to x = pi/2.
DIVISORS = (20.0, 42.0, 72.0, 110.0, 156.0, 210.0, 272.0, 342.0, 420.0)


def x_minus_sin(x: FloatArray) -> FloatArray:
    """Return x - sin x for 0 <= x <= pi/2, to a few ulp of the result."""
    square = x * x
    series = 1.0 - square / DIVISORS[-1]
    for divisor in DIVISORS[-2::-1]:
        series = 1.0 - square * series / divisor
    return x * square / 6.0 * series
