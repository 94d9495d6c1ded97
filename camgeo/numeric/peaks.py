"""Extremes of a function over smooth pieces, without its derivative."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, Literal

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extremes, extremes_of

Side = Literal["right", "left"]

SAMPLES: Final = 33
"""Grid points per piece on which turning points are looked for. A smooth piece of a cam's motion
has a few."""

FEWEST_SAMPLES: Final = 5
MOST_POINTS: Final = 1_000_000
"""Of the whole grid: a curve with very many pieces has short ones, and gets fewer points each."""

INSET: Final = 1e-7
"""Share of a piece by which its grid keeps off its ends, where the values have two sides."""

GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)

GOLDEN_STEPS: Final = 40
"""They shorten a bracket to 4e-9 of its length; the value is then the extreme but for rounding."""


def grid_of(edges: FloatArray) -> FloatArray:
    """(m, k) grid points, a row for each piece between two neighbours of `edges` (m + 1,)."""
    pieces = len(edges) - 1
    samples = int(np.clip(MOST_POINTS // max(pieces, 1), FEWEST_SAMPLES, SAMPLES))
    share = np.linspace(0.0, 1.0, samples)
    share[0], share[-1] = INSET, 1.0 - INSET
    grid: FloatArray = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * share
    return grid


def piecewise_extremes(
    function: Callable[[FloatArray, Side], FloatArray], edges: FloatArray
) -> Extremes:
    """Smallest and largest value of `function` from the first of `edges` to the last.

    Parameters
    ----------
    function : (n,), side -> (n,); smooth between neighbouring edges, where it may jump.
    edges : (m + 1,) ascending, m >= 1.

    At the edges both one-sided values count. Inside, turning points of a grid are followed by
    golden section, to the value but for rounding; two of them that lie within a thirty-second of a
    piece can be missed.
    """
    inside = grid_of(edges)
    flat = function(inside.ravel(), "right")
    turning = peaks(lambda x: function(x, "right"), inside, flat.reshape(inside.shape))
    return extremes_of(
        np.concatenate((edges[:-1], edges[1:], inside.ravel(), turning)),
        np.concatenate(
            (
                function(edges[:-1], "right"),
                function(edges[1:], "left"),
                flat,
                function(turning, "right"),
            )
        ),
    )


def peaks(
    function: Callable[[FloatArray], FloatArray], grid: FloatArray, values: FloatArray
) -> FloatArray:
    """Places of the extremes that the turning points of `values` along the rows of `grid` show."""
    padded = np.concatenate((grid[:, :1], grid, grid[:, -1:]), axis=1)
    found = []
    for sign in (1.0, -1.0):
        heights = sign * values
        inner = np.pad(heights, ((0, 0), (1, 1)), constant_values=-np.inf)
        top = (heights >= inner[:, :-2]) & (heights >= inner[:, 2:])
        top &= (heights > inner[:, :-2]) | (heights > inner[:, 2:])
        # A parabola through three points rises above the middle one by an eighth of the larger
        # difference at most; what cannot get to the largest value even with all of it is left.
        falls = np.abs(np.diff(heights, axis=1, prepend=heights[:, :1], append=heights[:, -1:]))
        top &= heights + np.maximum(falls[:, :-1], falls[:, 1:]) >= np.max(heights)
        found.append(_golden(function, sign, padded[:, :-2][top], padded[:, 2:][top]))
    return np.concatenate(found)


def _golden(
    function: Callable[[FloatArray], FloatArray], sign: float, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Golden section search of the largest sign * function in each bracket [low, high]."""
    if not len(low):
        return low
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    f_left, f_right = sign * function(left), sign * function(right)
    for _ in range(GOLDEN_STEPS):
        to_left = f_left >= f_right
        low, high = np.where(to_left, low, left), np.where(to_left, right, high)
        new = np.where(to_left, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
        f_new = sign * function(new)
        left, right = np.where(to_left, new, right), np.where(to_left, left, new)
        f_left, f_right = np.where(to_left, f_new, f_right), np.where(to_left, f_left, f_new)
    return np.where(f_left >= f_right, left, right)
