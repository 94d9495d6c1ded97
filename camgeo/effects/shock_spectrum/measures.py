"""The figures that are taken from a shock spectrum."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, grid_of, piecewise_extremes
from camgeo.numeric.oscillator.spectrum import Shock
from camgeo.numeric.roots import bracketed_roots

QUIET: Final = 0.01
"""Share of the stroke below which a residual vibration counts as small."""

SMALLEST_RATIO: Final = 1e-12
"""Stands for 0, where what remains is what the move has gone."""

FIRST_SPAN: Final = 10.0
"""Ratios searched at first, in one go; further ones only while something there may count."""


LONGEST: Final = 1000.0
"""Ratio up to which it is looked for where the residual gets small for good; a jump of the velocity
as large as the mean one leaves 1 % at a ratio of 32."""


def measured(move: Shock, damping: float, end: float) -> tuple[Extreme, float | None]:
    """Two figures of the spectrum of `move` up to the ratio `end`.

    The largest residual from ratio 1 on, or over all of them if `end` is no higher, with its ratio;
    and the ratio from which on it stays below `QUIET` for good: None if there is none up to `end`,
    0 if it always does.
    Only as much of the spectrum is looked at as its bound leaves open.
    """
    low = 1.0 if end > 1.0 else 0.0

    def residual(ratios: FloatArray) -> FloatArray:
        return move.residual(ratios, damping)

    def sided(ratios: FloatArray, _: Side) -> FloatArray:
        return residual(np.maximum(ratios, SMALLEST_RATIO))

    high = min(end, FIRST_SPAN)
    worst = piecewise_extremes(sided, _unit_edges(low, high)).highest
    while high < end and move.bound(high, damping) > worst.value:
        low, high = high, min(end, 2.0 * high)
        further = piecewise_extremes(sided, _unit_edges(low, high)).highest
        worst = max(worst, further, key=lambda each: each.value)
    # Beyond this ratio the bound says it; `end` itself may be a zero with more behind it.
    reach = FIRST_SPAN
    while move.bound(reach, damping) > QUIET:
        if reach > max(end, LONGEST):
            return worst, None
        reach *= 2.0
    grid = np.append(grid_of(_unit_edges(SMALLEST_RATIO, reach)).ravel(), reach)
    loud = np.flatnonzero(residual(grid) > QUIET)
    if not len(loud):
        return worst, 0.0
    last = int(loud[-1])
    if grid[last] >= end:
        return worst, None
    root = bracketed_roots(
        lambda ratios: residual(ratios) - QUIET, grid[last : last + 1], grid[last + 1 : last + 2]
    )
    return worst, float(root[0]) if root[0] <= end else None


def _unit_edges(low: float, high: float) -> FloatArray:
    """Edges one ratio apart at most: the residual turns no faster than cos(2 pi ratio)."""
    return np.linspace(low, high, max(2, math.ceil(high - low) + 1))
