"""Bounds of a motion held against its values, for the tests of every linkage."""

from __future__ import annotations

import numpy as np

from camgeo.motion.motion import Motion
from camgeo.units import TURN
from tests.integrals import cells


def assert_bounds_hold(motion: Motion, count: int, rounding: float, least: float) -> None:
    """That `jet_and_bounds` bounds what samples find, in `count` cells between two borders.

    `rounding` is a share of the largest value of each order, or of `least` where that is more.
    """
    low, high = cells(motion.borders, count)
    bounds = motion.jet_and_bounds(low, high)[1]
    middle = motion.jet(0.5 * (low + high))[0]
    sizes = np.max(np.abs(motion.jet(np.linspace(0.0, TURN, 241))), axis=1)[:, np.newaxis]
    for share in np.linspace(0.0, 1.0, 25):
        phi = np.clip(low + share * (high - low), low, high)
        values = motion.jet(phi, "left" if share == 1.0 else "right")
        values[0] -= middle
        assert np.all(np.abs(values) <= bounds + rounding * np.maximum(sizes, least))
