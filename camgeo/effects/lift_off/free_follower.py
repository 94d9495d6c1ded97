"""The follower of a scene as one that may leave its walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camgeo.effects.lift_off.cells import ROUNDED
from camgeo.effects.lift_off.flight import FreeFollower
from camgeo.effects.lift_off.walls import Wall
from camgeo.effects.results import ContactForce, Inertia
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import merged


def free_of(
    contact: ContactForce,
    inertia: Inertia,
    course: TimeCourse,
    walls: tuple[Wall, ...],
    jumps: Sequence[float] = (),
) -> FreeFollower:
    """A follower with the forces of `contact`, inertia among them; for `jumps` see the class."""
    others = tuple(each for each in contact.forces if each is not inertia.force)
    cuts = merged(np.concatenate((contact.edges, *(each.borders for each in walls))))
    lifts = np.abs(walls[0].motion(cuts, "right")[0])
    least = ROUNDED * float(np.max(lifts))
    return FreeFollower(
        others, inertia, course, walls, contact.bearings, cuts, least, np.array(jumps)
    )
