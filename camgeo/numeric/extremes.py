"""Largest and smallest values of a quantity, with where they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest or smallest value and the argument at which it is taken first.

    A value may be the limit from one side only, where the quantity jumps.
    """

    value: float
    place: float


@dataclass(frozen=True, slots=True)
class Extremes:
    """Smallest and largest value of a quantity, signed."""

    lowest: Extreme
    highest: Extreme

    @property
    def magnitude(self) -> float:
        """The largest absolute value."""
        return max(abs(self.lowest.value), abs(self.highest.value))


def extremes_of(x: FloatArray, values: FloatArray) -> Extremes:
    """Smallest and largest of `values` (n,), which are taken at `x` (n,) in any order."""
    order = np.argsort(x, kind="stable")
    x, values = x[order], values[order]
    low, high = int(np.argmin(values)), int(np.argmax(values))
    return Extremes(
        Extreme(float(values[low]), float(x[low])), Extreme(float(values[high]), float(x[high]))
    )
