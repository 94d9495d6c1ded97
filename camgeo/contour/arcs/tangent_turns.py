"""By what the tangents of biarcs at their joints are turned off the curve's own.

The best G1 arcs, two of equal length h a span, pass through the curve at the joints and in the
middles, but not along its tangent: e = kappa' h^3 B_3(t) / 6 over each arc, B_3 Bernoulli's
polynomial, has the slope kappa' h^2 / 12 there. So biarcs whose tangents are turned by that follow
a curve as well as any arcs, 3.08 times as closely as biarcs with its own tangents. As kappa' varies
and as pieces end with given tangents the angles come from a least sum of squares, which has the
same limit.
"""

from __future__ import annotations

import numpy as np

from camgeo.numeric.arrays import FloatArray, IntArray

OUTERMOST = 0.5
"""Weight of a piece's outermost spans, whose outer tangent is given. With less, the turns beside
them are those of a piece that goes on, and they have to be short; with more, the others suffer."""


def tangent_turns(apart: FloatArray, lengths: FloatArray, last: IntArray) -> FloatArray:
    """(2, S) [rad] by which the tangents at the start and at the end of each span turn.

    Where spans join both have the same; at both ends of a chain it is 0.

    Parameters
    ----------
    apart : (S, p) [mm] how far the curve lies to the right of the biarcs with its own tangents, at
        p places that divide each span evenly.
    lengths : (S,) [mm] of the spans' chords.
    last : (k,) number of the last span of each chain.
    """
    turns = np.zeros((2, len(lengths)))
    if len(lengths) == len(last):
        return turns
    closes = np.zeros(len(lengths), dtype=np.bool_)
    closes[last] = True
    weight = np.where(closes | np.roll(closes, 1), OUTERMOST, 1.0)
    # By what a turn by 1 at the start, or at the end, of a span of length 1 moves the biarc.
    places = np.arange(1, apart.shape[1] + 1) / (apart.shape[1] + 1)
    ahead = np.where(places < 0.5, places - 1.5 * places * places, 0.5 * (1.0 - places) ** 2)
    behind = -ahead[::-1]
    pull = weight * lengths
    before, after = pull * (apart @ behind), pull * (apart @ ahead)
    square = pull * lengths
    joined = ~closes[:-1]
    both = joined[:-1] & joined[1:]
    own = float(ahead @ ahead) * (square[:-1] + square[1:])
    cross = np.where(both, float(ahead @ behind) * square[1:-1], 0.0)
    found = _tridiagonal(cross, own, np.where(joined, -(before[:-1] + after[1:]), 0.0))
    turns[1, :-1] = found
    turns[0, 1:] = found
    return turns


def _tridiagonal(beside: FloatArray, middle: FloatArray, right: FloatArray) -> FloatArray:
    """Solution (n,) with the bands `middle` (n,) and on both sides of it `beside` (n - 1,)."""
    from scipy.linalg import solveh_banded  # only where a contour is made

    if len(middle) == 1:  # which scipy does not take
        return right / middle
    bands = np.zeros((2, len(middle)))
    bands[0, 1:], bands[1] = beside, middle
    found: FloatArray = solveh_banded(bands, right, overwrite_ab=True, check_finite=False)
    return found
