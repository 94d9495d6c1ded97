"""Where the velocity of a mass jumps, so that no finite force moves it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.motion.joints import breaks

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity, Subject
    from camgeo.effects.results import Inertia
    from camgeo.numeric.arrays import FloatArray

JUMP: Final = 1e-9
"""A jump of the velocity by less than this share of the largest is rounding."""


def shocks(subject: Subject, inertia: Inertia | None) -> list[float]:
    """The cam angles [rad] at which it does; none without any mass there."""
    if inertia is None:
        return []
    jumps = [each.cam_angle for each in breaks(subject.cam.drive.plan) if each.order < 1]
    return [phi for phi in jumps if inertia.to_follower(np.array([phi]), "right")[0] > 0.0]


def torque_shocks(subject: Subject, per_alpha: Quantity, edges: FloatArray) -> FloatArray:
    """(k,) the cam angles [rad] at which the torque on the camshaft is infinite.

    The velocity of the follower jumps there, and `per_alpha`, what its forces grow by with the
    acceleration of the cam, is not 0; `edges` (m,) [rad] tell where it moves.
    """
    motion = subject.cam.drive.motion
    places = np.asarray(motion.breaks)
    if not len(places):
        return places
    jump = np.abs(motion.jet(places, "right", 1)[1] - motion.jet(places, "left", 1)[1])
    inside = np.abs(motion.jet(edges[:-1] + 0.5 * np.diff(edges), "right", 1)[1])
    heavy = (per_alpha(places, "left") != 0.0) | (per_alpha(places, "right") != 0.0)
    hit: FloatArray = places[
        heavy & (jump > JUMP * max(float(np.max(inside)), float(np.max(jump))))
    ]
    return hit
