"""Interval arithmetic on arrays: what a formula can give over ranges of what it is made of.

Each result is widened by more than its rounding, so that it holds for exact numbers in the ranges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.units import TURN

WIDENED = 2.0**-50
"""Fraction of an end by which it is widened: sum, product, sine and cosine are rounded by less."""


@dataclass(frozen=True, slots=True, eq=False)
class Interval:
    """n ranges [low, high], closed; infinite where nothing is known."""

    low: FloatArray
    high: FloatArray

    @property
    def magnitude(self) -> FloatArray:
        """(n,) largest absolute value."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    @property
    def mignitude(self) -> FloatArray:
        """(n,) smallest absolute value."""
        return np.maximum(np.maximum(self.low, -self.high), 0.0)

    def __add__(self, other: Interval) -> Interval:
        return _widened(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Interval) -> Interval:
        return _widened(self.low - other.high, self.high - other.low)

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def __mul__(self, other: Interval) -> Interval:
        ends = (self.low, self.high), (other.low, other.high)
        with np.errstate(invalid="ignore", over="ignore"):
            products = np.stack([one * two for one in ends[0] for two in ends[1]])
        # 0 times infinity: nothing is known.
        low, high = np.min(products, axis=0), np.max(products, axis=0)
        unknown = np.isnan(low)
        return _widened(np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high))

    def __truediv__(self, other: Interval) -> Interval:
        """Infinite where the divisor reaches 0."""
        with np.errstate(divide="ignore"):
            through = (other.low <= 0.0) & (other.high >= 0.0)
            low = np.where(through, -np.inf, 1.0 / other.high)
            high = np.where(through, np.inf, 1.0 / other.low)
        return self * _widened(low, high)

    def scaled(self, factor: float) -> Interval:
        """The ranges times a number."""
        one, other = factor * self.low, factor * self.high
        return _widened(np.minimum(one, other), np.maximum(one, other))

    def squared(self) -> Interval:
        """The ranges of the squares, which are not negative."""
        one, other = self.low * self.low, self.high * self.high
        least = np.where((self.low <= 0.0) & (self.high >= 0.0), 0.0, np.minimum(one, other))
        return _widened(least, np.maximum(one, other))

    def within(self, other: Interval) -> Interval:
        """What both ranges have in common, where both hold."""
        return Interval(np.maximum(self.low, other.low), np.minimum(self.high, other.high))


def about(middle: FloatArray, reach: FloatArray) -> Interval:
    """The ranges [middle - reach, middle + reach]."""
    return _widened(middle - reach, middle + reach)


def cosine(angles: Interval) -> Interval:
    """The cosines of ranges of angles [rad]."""
    known = np.isfinite(angles.low) & np.isfinite(angles.high)
    low, high = np.where(known, angles.low, 0.0), np.where(known, angles.high, TURN)
    # The rounding of an angle is not small beside a cosine near 0.
    blur = WIDENED * (1.0 + np.maximum(np.abs(low), np.abs(high)))
    low, high = low - blur, high + blur
    ends = np.cos(low), np.cos(high)
    least = np.where(_passes(low, high, math.pi), -1.0, np.minimum(*ends))
    most = np.where(_passes(low, high, 0.0), 1.0, np.maximum(*ends))
    return Interval(np.maximum(least - WIDENED, -1.0), np.minimum(most + WIDENED, 1.0))


def sine(angles: Interval) -> Interval:
    """The sines of ranges of angles [rad]."""
    quarter = 0.5 * math.pi
    return cosine(Interval(angles.low - quarter, angles.high - quarter))


def _passes(low: FloatArray, high: FloatArray, angle: float) -> BoolArray:
    passed: BoolArray = np.floor((high - angle) / TURN) >= np.ceil((low - angle) / TURN)
    return passed


def _widened(low: FloatArray, high: FloatArray) -> Interval:
    return Interval(low - WIDENED * np.abs(low), high + WIDENED * np.abs(high))
