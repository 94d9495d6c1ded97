"""Quantiles of Student's t distribution, for confidence intervals."""

from __future__ import annotations

from statistics import NormalDist
from typing import Final

FEWEST: Final = 8
"""Degrees of freedom from which on the expansion is off by less than 2e-5 of the value, up to a
probability of 0.975."""

TERMS: Final = (
    ((1, 1), 4),
    ((5, 16, 3), 96),
    ((3, 19, 17, -15), 384),
    ((79, 776, 1482, -1920, -945), 92160),
)
"""Coefficients of the odd powers of z, the highest first, and their divisor."""


def quantile(probability: float, freedom: int) -> float:
    """The value that a variable with `freedom` degrees of freedom, at least `FEWEST`, does not
    exceed with that `probability`.

    The expansion in 1/freedom about the normal quantile z (Abramowitz and Stegun 26.7.5).
    """
    z = NormalDist().inv_cdf(probability)
    found = z
    for order, (coefficients, divisor) in enumerate(TERMS, start=1):
        value = 0.0
        for each in coefficients:
            value = value * z * z + each
        found += z * value / divisor / freedom**order
    return found
