"""Smallest and largest lift of a motion, exactly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.numeric.isolation import INSIDE, isolated_roots, places_between
from camgeo.units import TURN


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
    places = places_between(np.append(starts, TURN))

    def of_order(order: int) -> Callable[[FloatArray, IntArray], FloatArray]:
        return lambda phi, _: np.asarray(motion.jet(phi, "right", 1)[order])

    velocity = of_order(1)
    known = velocity(places.ravel(), np.empty(0, dtype=np.intp)).reshape(1, *places.shape)
    roots, _ = isolated_roots(velocity, of_order(0), places, known)
    # At rest at an end of its piece a law may round to 0 at the outermost place.
    piece = np.searchsorted(starts, roots) - 1
    off = 4.0 * INSIDE * (ends - starts)[piece]
    found: FloatArray = roots[(roots - starts[piece] > off) & (ends[piece] - roots > off)]
    return found
