"""Interval arithmetic on arrays: bounds of a formula over ranges of its arguments.

Each result is widened by more than its rounding, so that it holds for exact numbers in the ranges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.numeric.arrays import FloatArray

WIDENED = 2.0**-50
"""Fraction of an end by which it is widened: a sum or product is rounded by less."""

BLUR = 2.0**-48
"""Widening of cosines and sines: more than the rounding of differences of angles."""

FARTHEST = 4.0
"""Reach of an angle [rad] beyond which nothing is known of its cosine and sine."""


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
        with np.errstate(invalid="ignore", over="ignore"):
            one, two = self.low * other.low, self.low * other.high
            three, four = self.high * other.low, self.high * other.high
        low = np.minimum(np.minimum(one, two), np.minimum(three, four))
        high = np.maximum(np.maximum(one, two), np.maximum(three, four))
        # An end times an infinite end of the other range may be 0 times infinity, a NaN, which
        # minimum and maximum pass on.
        unknown = np.isnan(low)
        if np.any(unknown):
            low, high = np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high)
        return _widened(low, high)

    def __truediv__(self, other: Interval) -> Interval:
        """Infinite where the divisor reaches 0."""
        return self * other.inverse

    @property
    def inverse(self) -> Interval:
        """One divided by the numbers of the ranges; infinite where these reach 0."""
        with np.errstate(divide="ignore"):
            low, high = 1.0 / self.high, 1.0 / self.low
        # A range that contains 0 has reciprocals up to infinity on both sides: nothing is known.
        through = (self.low <= 0.0) & (self.high >= 0.0)
        if np.any(through):
            low, high = np.where(through, -np.inf, low), np.where(through, np.inf, high)
        return _widened(low, high)

    def scaled(self, factor: float) -> Interval:
        """The ranges times a number."""
        one, other = factor * self.low, factor * self.high
        return _widened(np.minimum(one, other), np.maximum(one, other))

    def squared(self) -> Interval:
        """The ranges of the squares, which are not negative."""
        one, other = self.low * self.low, self.high * self.high
        least = np.where((self.low <= 0.0) & (self.high >= 0.0), 0.0, np.minimum(one, other))
        return _widened(least, np.maximum(one, other))

    def intersection(self, other: Interval) -> Interval:
        """The intersection of ranges that both enclose the same numbers."""
        return Interval(np.maximum(self.low, other.low), np.minimum(self.high, other.high))


@dataclass(frozen=True, slots=True, eq=False)
class Angles:
    """n ranges of angles, each by its middle and its reach to either side.

    Attributes
    ----------
    cosines, sines : (n,) of the middles.
    reach : (n,) [rad] to both sides, not negative; infinite where nothing is known.
    """

    cosines: FloatArray
    sines: FloatArray
    reach: FloatArray

    def reaching(self, reach: FloatArray) -> Angles:
        """Ranges with the same middles and another `reach` (n,) [rad]."""
        return Angles(self.cosines, self.sines, reach)

    def __sub__(self, other: Angles) -> Angles:
        return Angles(
            self.cosines * other.cosines + self.sines * other.sines,
            self.sines * other.cosines - self.cosines * other.sines,
            self.reach + other.reach,
        )

    @property
    def cosine(self) -> Interval:
        """The cosines: cos(m + d) = cos m - (1 - cos d) cos m - sin d sin m."""
        return _swept(self.cosines, self.sines, self.reach)

    @property
    def sine(self) -> Interval:
        """The sines: sin(m + d) = sin m - (1 - cos d) sin m + sin d cos m."""
        return _swept(self.sines, self.cosines, self.reach)

    @classmethod
    def from_middles(cls, middles: FloatArray, reach: FloatArray) -> Angles:
        """The ranges of angles within `reach` (n,) of `middles` (n,) [rad]."""
        # A large angle is rounded more than its cosine and sine, which `BLUR` covers.
        rounding = WIDENED * np.abs(middles)
        return cls(np.cos(middles), np.sin(middles), reach + rounding)


def _swept(value: FloatArray, slope: FloatArray, reach: FloatArray) -> Interval:
    """The range of a cosine or sine with `value` and, up to its sign, `slope` (n,) at middles."""
    far = np.minimum(reach, FARTHEST)
    # 1 - cos d <= d^2/2 and |sin d| <= |d|. The quadratic term moves the value towards 0 only, so
    # it lowers a positive value and raises a negative one.
    straight, curved = np.abs(slope) * far + BLUR, 0.5 * far * far
    low = value - straight - curved * np.maximum(value, 0.0)
    high = value + straight - curved * np.minimum(value, 0.0)
    return Interval(np.maximum(low, -1.0), np.minimum(high, 1.0))


def _widened(low: FloatArray, high: FloatArray) -> Interval:
    return Interval(low - WIDENED * np.abs(low), high + WIDENED * np.abs(high))
