"""A function over smooth pieces as Chebyshev series, all of one degree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray, frozen

DEGREE: Final = 16
"""Of the series on a piece. Half a period of a sine needs that much for 16 digits, a polynomial law
less; a piece that needs more is halved."""

MOST_HALVINGS: Final = 40
"""A piece is halved this often at most. What a halving closes in on is a kink that is no edge; its
piece is then 1e-12 of what it was."""

_ANGLES: Final = np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1)

NODES: Final = frozen(-np.cos(_ANGLES), np.float64)
"""(17,) zeros of T_17, ascending: inside the piece, where the function has one value only."""

TO_SERIES: Final = frozen(
    np.cos(np.outer(np.arange(DEGREE + 1), np.pi - _ANGLES))
    * np.where(np.arange(DEGREE + 1) == 0, 1.0, 2.0)[:, np.newaxis]
    / (DEGREE + 1),
    np.float64,
)
"""(17, 17) from the values at the nodes to the coefficients, by the discrete orthogonality of the
polynomials (Trefethen, Approximation Theory and Approximation Practice, chapter 3)."""

TAIL: Final = 3
"""Coefficients at the end whose sum stands for what is cut off."""


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """A function as Chebyshev series.

    Attributes
    ----------
    edges : (p + 1,) ascending; the pieces lie between neighbours.
    series : (17, p) coefficients of T_0 to T_16 on each piece.
    error : estimate of the integral of the magnitude of what the series leave out.
    largest : magnitude of the function at the nodes.
    """

    edges: FloatArray
    series: FloatArray
    error: float
    largest: float


def interpolated(
    function: Callable[[FloatArray], FloatArray], edges: FloatArray, tolerance: float
) -> Pieces:
    """`function` as series.

    Parameters
    ----------
    function : (n,) -> (n,), smooth between neighbouring edges; it is not asked at them.
    edges : (m + 1,) ascending, m >= 1.
    tolerance : a piece is halved until the integral of what its series leaves out is estimated
        below this share of the integral of the function's magnitude.
    """
    low, high = edges[:-1], edges[1:]
    starts, rows = [], []
    size, largest, error = 0.0, 0.0, 0.0
    for halving in range(MOST_HALVINGS + 1):
        half = 0.5 * (high - low)
        x = (0.5 * (high + low))[:, np.newaxis] + half[:, np.newaxis] * NODES
        values = function(x.ravel()).reshape(x.shape)
        magnitude = np.max(np.abs(values), axis=1)
        largest = max(largest, float(np.max(magnitude)))
        if halving == 0:
            size = float(np.sum(2.0 * half * magnitude))
        series = values @ TO_SERIES.T
        lost = 2.0 * half * np.sum(np.abs(series[:, -TAIL:]), axis=1)
        good = lost <= tolerance * size
        if halving == MOST_HALVINGS:
            good[:] = True
        starts.append(low[good])
        rows.append(series[good])
        error += float(np.sum(lost[good]))
        if np.all(good):
            break
        middle = 0.5 * (low + high)[~good]
        low = np.concatenate((low[~good], middle))
        high = np.concatenate((middle, high[~good]))
        order = np.argsort(low, kind="stable")
        low, high = low[order], high[order]
    ordered = np.concatenate(starts)
    order = np.argsort(ordered, kind="stable")
    return Pieces(
        np.append(ordered[order], edges[-1]), np.concatenate(rows)[order].T, error, largest
    )


def series_values(series: FloatArray, x: FloatArray) -> FloatArray:
    """Sum of series[k] T_k(x), Clenshaw's recurrence; `series` (m, ...) and `x` broadcast."""
    double = 2.0 * x
    last = series[-1] + 0.0 * x
    before = np.zeros_like(last)
    for row in series[-2:0:-1]:
        last, before = row + double * last - before, last
    found: FloatArray = series[0] + x * last - before
    return found
