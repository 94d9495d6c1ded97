"""Smallest and largest lift of a motion, exactly."""

from __future__ import annotations

import numpy as np

from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

SAMPLES = 33
"""Grid points per piece between borders, on which sign changes are sought. A law has at most a few
turning points per formula."""


def pieces(motion: Motion) -> list[tuple[float, float]]:
    """The stretches [start, end] of the turn [rad] between neighbouring borders."""
    starts = [float(border) for border in motion.borders]
    if not starts or starts[0] > 0.0:
        starts.insert(0, 0.0)
    return list(zip(starts, [*starts[1:], TURN], strict=True))


def lift_range(motion: Motion) -> tuple[float, float]:
    """Smallest and largest lift [mm or rad] over a turn."""
    places = (motion.borders, np.zeros(1), turning_angles(motion))
    lift = motion.jet(np.concatenate(places))[0]
    return float(np.min(lift)), float(np.max(lift))


def turning_angles(motion: Motion) -> FloatArray:
    """(k,) cam angles [rad] inside the pieces at which the velocity changes its sign."""
    starts, ends = np.array(pieces(motion)).T
    grid = np.linspace(starts, ends, SAMPLES, axis=1)[:, 1:-1]
    moving = np.any(motion.jet(grid.ravel())[1].reshape(grid.shape), axis=1)
    return roots_on_grid(lambda phi: np.asarray(motion.jet(phi)[1]), grid[moving])
