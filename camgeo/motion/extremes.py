"""Smallest and largest lift of a motion, exactly."""

from __future__ import annotations

import numpy as np

from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN

SAMPLES = 33
"""Grid points per piece between borders, on which sign changes are looked for. A law has at most
a few turning points per formula."""


def pieces(motion: Motion) -> list[tuple[float, float]]:
    """The stretches [start, end] of the turn [rad] between neighbouring borders."""
    starts = [float(border) for border in motion.borders]
    if not starts or starts[0] > 0.0:
        starts.insert(0, 0.0)
    return list(zip(starts, [*starts[1:], TURN], strict=True))


def lift_range(motion: Motion) -> tuple[float, float]:
    """Smallest and largest lift [mm or rad] over a turn."""
    starts, ends = np.array(pieces(motion)).T
    grid = np.linspace(starts, ends, SAMPLES, axis=1)[:, 1:-1]
    moving = np.any(motion.jet(grid.ravel())[1].reshape(grid.shape), axis=1)
    turning = roots_on_grid(lambda phi: _velocity(motion, phi), grid[moving])
    places = (motion.borders, np.zeros(1), turning)
    lift = motion.jet(np.concatenate(places))[0]
    return float(np.min(lift)), float(np.max(lift))


def _velocity(motion: Motion, phi: FloatArray) -> FloatArray:
    velocity: FloatArray = motion.jet(phi)[1]
    return velocity
