"""Integrals of a function over smooth pieces, with an estimate of their error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from camgeo.numeric.arrays import SHARE, FloatArray

NODES: Final = 16
"""Nodes of the Gauss-Legendre rule on a piece; the rule on both halves gives its error."""

SPARE: Final = 3
"""Additional nodes, for functions that grow towards the ellipse on which they are bounded."""

MOST_HALVINGS: Final = 40
"""A piece is halved at most this often: to 1e-12 of its length."""

MOST_PIECES: Final = 4000
"""Beyond this number of pieces, or four times the initial number, none is halved any further: then
the rounding of the function exceeds the tolerance, and halving does not help."""


@dataclass(frozen=True, slots=True)
class Integral:
    """An integral, an estimate of its absolute error, the integral of the magnitude, and the (m,)
    integrals between neighbouring edges.

    The estimate is the change in the last halving, of which the error is a small fraction; it is at
    least the rounding of the sum, see `camgeo.numeric.arrays`.
    """

    value: float
    error: float
    magnitude: float
    parts: FloatArray = field(default_factory=lambda: np.empty(0), compare=False)


def piecewise_integral(
    function: Callable[[FloatArray], FloatArray], edges: FloatArray, tolerance: float
) -> Integral:
    """The integral of `function` from the first of `edges` to the last.

    Parameters
    ----------
    function : (n,) -> (n,), smooth between neighbouring edges.
    edges : (m + 1,) ascending, m >= 1.
    tolerance : a piece is halved until that changes its integral by less than this fraction of the
        integral of the magnitude.
    """
    low, high = edges[:-1], edges[1:]
    owner = np.arange(len(low))
    integrals = np.zeros(len(low))
    parts, magnitude = _gauss(function, low, high)
    most = max(MOST_PIECES, 4 * len(low))
    error, settled, scale = 0.0, 0.0, 0.0
    width = float(edges[-1] - edges[0])
    for _ in range(MOST_HALVINGS):
        middle = 0.5 * (low + high)
        lows, highs = np.concatenate((low, middle)), np.concatenate((middle, high))
        halves, magnitudes = _gauss(function, lows, highs)
        count = len(low)
        finer = halves[:count] + halves[count:]
        # The halved piece is far more exact than the whole, so their difference is the error of the
        # whole, and an ample bound for that of the halves, which are used.
        change = np.abs(finer - parts)
        sizes = magnitudes[:count] + magnitudes[count:]
        scale = settled + float(np.sum(sizes))
        # Each piece may contribute a share of the tolerance in proportion to its width.
        converged = change <= tolerance * scale * (high - low) / width
        if count > most:
            converged[:] = True
        settled += float(np.sum(sizes[converged]))
        np.add.at(integrals, owner[converged], finer[converged])
        error += float(np.sum(change[converged]))
        remaining = np.concatenate((~converged, ~converged))
        low, high, parts = lows[remaining], highs[remaining], halves[remaining]
        # Halves of piece k are at k and at k + count; both belong to the interval of k.
        owner = np.concatenate((owner, owner))[remaining]
        magnitude = magnitudes[remaining]
        if not len(low):
            break
    else:
        # No halving is left: the rest counts with its whole magnitude as error.
        np.add.at(integrals, owner, parts)
        error += float(np.sum(magnitude))
    return Integral(float(np.sum(integrals)), error + SHARE * scale, scale, integrals)


def nodes_for_singularity(place: float) -> int:
    """Number of nodes with which Gauss-Legendre's rule over [-1, 1] is exact to rounding, for a
    function whose only singularities are at `place` < -1 and beyond.

    With n nodes the error is about rho^(-2 n), rho being the sum of the half axes of the largest
    ellipse with foci -1 and 1 within which the function is analytic (Trefethen, Approximation
    Theory and Approximation Practice, theorem 19.3).
    """
    rho = -place + math.sqrt((place - 1.0) * (place + 1.0))
    return SPARE + math.ceil(-0.5 * math.log(SHARE) / math.log(rho))


def gauss(
    low: FloatArray, high: FloatArray, nodes: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss-Legendre's rule over [low, high] (m,) each: (m, n) places of its `nodes` n, half the
    widths (m,), and the weights (n,) over [-1, 1].
    """
    places, weights = np.polynomial.legendre.leggauss(nodes)  # numpy loads it on first use
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    return middle[:, np.newaxis] + half[:, np.newaxis] * places, half, weights


def _gauss(
    function: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The integrals over [low, high] (m,) each, and those of the magnitude."""
    x, half, weights = gauss(low, high, NODES)
    values = function(x.ravel()).reshape(x.shape)
    return half * (values @ weights), half * (np.abs(values) @ weights)
