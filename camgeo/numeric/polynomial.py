"""Polynomials by their coefficients in ascending powers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction

import numpy as np

from camgeo.numeric.arrays import FloatArray

NEARLY_REAL = 1e-6
"""Imaginary part up to which a root counts as real: a double root splits by 1e-8."""

VANISHING = 1e-40
"""A coefficient below this fraction of the largest one is far below the rounding of the others
wherever roots are sought, and quotients with it overflow."""

ROUNDING = 1e-12
"""More than the rounding of a polynomial of the degrees used here near its maximum."""


def horner(coefficients: Sequence[float] | FloatArray, x: FloatArray) -> FloatArray:
    """The polynomial at `x` (n,).

    With (k, n) coefficients each x has its own polynomial; with (k, m, 1) the values (m, n) are
    those of m polynomials.
    """
    if len(coefficients) == 1:
        return np.full_like(x, coefficients[0])
    value = coefficients[-1] * x
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
    return value


def derivative(coefficients: Sequence[float]) -> list[float]:
    """Coefficients of the derivative."""
    return [power * c for power, c in enumerate(coefficients)][1:] or [0.0]


def product(first: Sequence[float], second: Sequence[float]) -> list[float]:
    """Coefficients of the product."""
    return [float(c) for c in np.convolve(first, second)]


def roots_inside(coefficients: Sequence[float], low: float, high: float) -> FloatArray:
    """Real roots in [low, high], ascending, to the last bits where they are simple."""
    descending = np.array(coefficients[::-1], dtype=np.float64)
    descending[np.abs(descending) < VANISHING * np.max(np.abs(descending))] = 0.0
    roots = np.roots(descending)
    scale = np.maximum(1.0, np.abs(roots))
    real: FloatArray = np.sort(roots.real[np.abs(roots.imag) < NEARLY_REAL * scale])
    least, most = 2.0 * low - high, 2.0 * high - low
    real = real[(real > least) & (real < most)]  # the last digits do not bring others inside
    slope = derivative(coefficients)
    for _ in range(2):  # Newton's method
        rise = horner(slope, real)
        value = horner(coefficients, real)
        with np.errstate(over="ignore"):  # at a candidate that is not a root, or not a simple one
            step = np.divide(value, rise, out=np.zeros_like(real), where=rise != 0.0)
        real = np.clip(real - step, least, most)
    return real[(real >= low) & (real <= high)]


def largest_magnitude(coefficients: Sequence[float], low: float, high: float) -> float:
    """Largest absolute value over [low, high], exact except for rounding upwards."""
    turns = roots_inside(derivative(coefficients), low, high)
    places = np.concatenate((turns, [low, high]))
    return float(np.max(np.abs(horner(coefficients, places)))) * (1.0 + ROUNDING)


def bernstein(powers: Sequence[Decimal] | Sequence[Fraction]) -> tuple[float, ...]:
    """(n + 1,) c_i, each rounded once, of the sum of c_i z^i w^(n - i) with w = 1 - z.

    From exact coefficients in ascending powers of z. The terms cancel less than those of any other
    form over [0, 1]; where all c_i have one sign, not at all.
    """
    exact = [Fraction(c) for c in powers]
    n = len(exact) - 1
    # Sums of integers over one denominator: adding fractions takes most of the time of a law.
    below = math.lcm(*(c.denominator for c in exact))
    above = [c.numerator * (below // c.denominator) for c in exact]
    return tuple(
        sum(math.comb(n - k, i - k) * above[k] for k in range(i + 1)) / below for i in range(n + 1)
    )


def scaled_horner(
    coefficients: Sequence[float] | FloatArray, small: FloatArray, large: FloatArray
) -> FloatArray:
    """The sum of c_i small^i large^(n - i) = large^n times a polynomial in small/large."""
    value = horner(coefficients, small / large)
    for _ in range(len(coefficients) - 1):
        value *= large
    return value
