"""Where the follower cannot move the far end of its linkage, however hard it pushes.

There dx/dq of `Linkage.per_follower` is infinite: what has a mass or a load at the far end needs an
infinite force of the follower.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from camgeo.motion.extremes import SAMPLES, lift_range, pieces, turning_angles
from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import roots_on_grid

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage


def locked_at(linkage: Linkage, demanded: Motion) -> tuple[float, float] | None:
    """First cam angle [rad] and position [mm or rad] at which the follower cannot move the far end.

    None if the motion that is `demanded` of the far end keeps clear of all such positions.
    """
    found = linkage.locked_positions(*lift_range(demanded))
    if not found:
        return None
    starts, ends = np.array(pieces(demanded)).T
    grid = np.linspace(starts, ends, SAMPLES, axis=1)
    resting = np.concatenate((demanded.borders, turning_angles(demanded), [0.0]))
    lift = demanded.jet(resting)[0]
    places = []
    for each in found:
        crossed = roots_on_grid(partial(_beyond, demanded, each), grid)
        nearest = resting[np.argmin(np.abs(lift - each))]
        places.append((float(min(crossed, default=nearest)), each))
    return min(places)


def _beyond(demanded: Motion, position: float, phi: FloatArray) -> FloatArray:
    return np.asarray(demanded.jet(phi)[0] - position)
