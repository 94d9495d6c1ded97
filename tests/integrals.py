"""Derivatives checked by integrals: what a formula gives over a stretch against its ends.

Gauss's rule of 24 points is exact to rounding for smooth functions on stretches over which they
turn by less than a radian or two, so nothing but rounding is left, unlike with differences.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)

Scalar = TypeVar("Scalar", np.float64, np.complex128)


def cells(borders: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """The turn from the first border on in cells, `count` between neighbouring borders."""
    first = float(borders[0]) if len(borders) else 0.0
    edges = np.append(borders if len(borders) else [0.0], first + TURN)
    shares = np.linspace(0.0, 1.0, count + 1)
    grid = edges[:-1, np.newaxis] + shares * np.diff(edges)[:, np.newaxis]
    grid[:, -1] = edges[1:]  # exactly the border, whose left side counts
    return grid[:, :-1].ravel(), grid[:, 1:].ravel()


def integrals(
    function: Callable[[FloatArray], NDArray[Scalar]], low: FloatArray, high: FloatArray
) -> NDArray[Scalar]:
    """(..., n) integrals over the cells [low, high] (n,) of a function (m,) -> (..., m)."""
    half = 0.5 * (high - low)
    points = (0.5 * (low + high))[:, np.newaxis] + half[:, np.newaxis] * NODES
    values = function(points.ravel())
    values = values.reshape(*values.shape[:-1], *points.shape)
    total: NDArray[Scalar] = (values @ WEIGHTS) * half
    return total
