"""Sums that are 0 up to rounding.

The sum of n terms is off by at most the roundings of each term and those of the additions, each a
half unit in the last place of the magnitudes: |error| <= (k + m) u sum |terms|, u = 2^-53, with k
roundings in a term and m additions that a term passes through (Higham, "Accuracy and Stability of
Numerical Algorithms", 2nd ed., sections 3.1 and 4.2). A force or torque at a cam angle takes some
tens of operations after the motion law, which has as many; a rule of 16 nodes adds 16 times, and
numpy adds n partial sums in pairs of pairs, log2 n <= 20 times for a million of them. So k + m <=
128, which is `SHARE` of the sum of magnitudes.
"""

from __future__ import annotations

from typing import Final

SHARE: Final = 128.0 * 2.0**-53
"""A sum below this share of the sum of its terms' magnitudes is rounding."""


def resolved(value: float, size: float) -> float:
    """`value`; 0 if it is rounding of terms whose magnitudes sum up to `size`."""
    return 0.0 if abs(value) <= SHARE * size else value
