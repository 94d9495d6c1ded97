"""How a deviation is distributed between its limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from camgeo.numeric.arrays import FloatArray

Shape = Literal["normal", "uniform", "triangular"]

SHAPES: Final[tuple[Shape, ...]] = ("normal", "uniform", "triangular")

SIGMAS: Final = 3.0
"""Standard deviations of a normal distribution from its mean to a limit, unless one is stated."""

WIDTHS: Final[dict[Shape, float]] = {
    "normal": SIGMAS,
    "uniform": math.sqrt(3.0),
    "triangular": math.sqrt(6.0),
}
"""Half the range between the limits, in standard deviations."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """A random deviation [mm or rad].

    Attributes
    ----------
    low, high : its limits; a normal distribution goes beyond them.
    shape : symmetric about the middle of the limits.
    stated : the standard deviation, if it is not what limits and shape say; else None.
    """

    low: float
    high: float
    shape: Shape = "normal"
    stated: float | None = None

    @property
    def mean(self) -> float:
        """Its expected value."""
        return 0.5 * (self.low + self.high)

    @property
    def sigma(self) -> float:
        """Its standard deviation."""
        if self.stated is not None:
            return self.stated
        return 0.5 * (self.high - self.low) / WIDTHS[self.shape]

    @property
    def variance(self) -> float:
        """Its variance."""
        return self.sigma**2

    def quantile(self, share: FloatArray) -> FloatArray:
        """(n,) values below which the shares (n,), within (0, 1), of all values lie."""
        unit = _NORMALISED[self.shape](share)
        return self.mean + self.sigma * unit


def _normal(share: FloatArray) -> FloatArray:
    from scipy.special import ndtri  # where nothing is drawn, nothing is loaded

    return np.asarray(ndtri(share))


def _uniform(share: FloatArray) -> FloatArray:
    return WIDTHS["uniform"] * (2.0 * share - 1.0)


def _triangular(share: FloatArray) -> FloatArray:
    low = share < 0.5
    tail = np.where(low, share, 1.0 - share)
    rest = WIDTHS["triangular"] * (1.0 - np.sqrt(2.0 * tail))
    return np.where(low, -rest, rest)


_NORMALISED: Final = {"normal": _normal, "uniform": _uniform, "triangular": _triangular}
"""Quantiles with the mean 0 and the standard deviation 1."""
