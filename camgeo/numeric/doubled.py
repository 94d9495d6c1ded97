"""The rounding error of a number, computed in doubles."""

from __future__ import annotations

from typing import Final

SPLITTER: Final = 2.0**27 + 1.0


def hypot_rest(vector: complex, size: float) -> float:
    """|vector| - `size` to about twenty more digits, for a `size` that is |vector| up to rounding.

    From |vector|^2 - size^2 with the squares as exact sums of two doubles (Veltkamp, Dekker 1971).
    """
    squares = [_square(each) for each in (vector.real, vector.imag, size)]
    (x, x_low), (y, y_low), (h, h_low) = squares
    larger, smaller = max(x, y), min(x, y)
    # x + y as an exact sum of two doubles; it is the square of the size but for rounding.
    total = larger + smaller
    lost = smaller - (total - larger)
    if not size:
        return 0.0
    return ((total - h) + (lost + (x_low + y_low - h_low))) / (2.0 * size)


def _square(number: float) -> tuple[float, float]:
    """number^2 as the exact sum of two doubles."""
    spread = SPLITTER * number
    high = spread - (spread - number)
    low = number - high
    product = number * number
    return product, ((high * high - product) + 2.0 * high * low) + low * low
