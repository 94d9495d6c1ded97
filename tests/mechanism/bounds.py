"""Bounds of a motion compared with its values, for the tests of every linkage."""

from __future__ import annotations

import numpy as np

from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.motion import Motion
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
        values = motion.jet(phi, "left" if share == 1.0 else "right").copy()
        values[0] -= middle
        assert np.all(np.abs(values) <= bounds + rounding * np.maximum(sizes, least))


def assert_bounds_are_close(linkage: Linkage, dead: float, side: int, most: float) -> None:
    """Assert that bounds next to a dead centre exceed the values by at most the factor `most`.

    The width of a cell is a fiftieth of its distance from the position `dead`, on the given `side`
    of it. Values change with that distance, so bounds are compared with the largest one nearby.
    """
    for distance in (1e-1, 1e-2, 1e-3, 1e-4):
        places = dead + side * distance * np.linspace(0.5, 1.5, 41)
        jet = np.zeros((4, len(places)))
        jet[0], jet[1] = places, 1.0
        largest = np.max(np.abs(linkage.transform(jet)), axis=1)
        bounds = np.array([[0.01 * distance], [1.0], [0.0], [0.0]])
        found = linkage.transform_bounds(jet[:, 20:21], bounds)[:, 0]
        assert np.all(found[1:] <= most * np.maximum(largest[1:], 0.1))
