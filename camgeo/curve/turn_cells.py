"""One turn in cells of cam angle, none across a border: where bounds are taken."""

from __future__ import annotations

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.units import TURN

WIDEST = np.pi / 32.0
"""Longest cell [rad]."""


def turn_cells(pitch: PitchCurve, *marks: float) -> tuple[FloatArray, FloatArray]:
    """Ends (n,), (n,) [rad] of cells that fill [0, 2 pi], none across a border or a mark."""
    grid = np.linspace(0.0, TURN, int(np.ceil(TURN / WIDEST)) + 1)
    ends = ascending(np.concatenate((grid, pitch.borders, np.mod(marks, TURN))))
    return ends[:-1], ends[1:]


def slowest(pitch: PitchCurve) -> float:
    """A lower bound of |Z'| [mm/rad] over the turn; negative where the cells are too wide for one.

    |Z'| changes over half a cell of width 2 h by at most h |Z''| + h^2/2 max |Z'''|.
    """
    low, high = turn_cells(pitch)
    half = 0.5 * (high - low)
    jet, (_, _, third) = pitch.jet_and_bounds(low, high)
    return float(np.min(np.abs(jet[1]) - half * (np.abs(jet[2]) + 0.5 * half * third)))
