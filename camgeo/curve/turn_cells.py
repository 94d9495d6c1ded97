"""One turn in cells of cam angle, none across a border, over which bounds are taken."""

from __future__ import annotations

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray, ascending
from camgeo.units import TURN

WIDEST = np.pi / 32.0
"""Longest cell [rad]."""

MOST = 1_000_000
"""Most cells halved at once; a curve needs some hundred, plus one per segment of its motion."""


def turn_cells(pitch: PitchCurve, *marks: float) -> tuple[FloatArray, FloatArray]:
    """Ends (n,), (n,) [rad] of cells that fill [0, 2 pi], none across a border or a mark."""
    grid = np.linspace(0.0, TURN, int(np.ceil(TURN / WIDEST)) + 1)
    ends = ascending(np.concatenate((grid, pitch.borders, np.mod(marks, TURN))))
    return ends[:-1], ends[1:]


def halves(low: FloatArray, high: FloatArray, which: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Ends (2 k,), (2 k,) of the halves of the cells [low, high] (n,) [rad] selected by `which`.

    GeometryError if those are more than `MOST`.
    """
    low, high = low[which], high[which]
    if len(low) > MOST:
        raise GeometryError("the pitch curve is too steep to be analysed: it has no outline")
    middle = 0.5 * (low + high)
    return np.concatenate((low, middle)), np.concatenate((middle, high))


def slowest(pitch: PitchCurve) -> float:
    """A lower bound of |Z'| [mm/rad] over the turn; negative where the cells are too wide to tell.

    |Z'| changes over half a cell of width 2 h by at most h |Z''| + h^2/2 max |Z'''|.
    """
    low, high = turn_cells(pitch)
    half = 0.5 * (high - low)
    jet, (_, _, third) = pitch.jet_and_bounds(low, high)
    return float(np.min(np.abs(jet[1]) - half * (np.abs(jet[2]) + 0.5 * half * third)))
