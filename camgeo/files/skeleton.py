"""The skeleton of a mechanism: its links and joints in one position, put together for a picture."""

from __future__ import annotations

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.drawn import traced_point
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.sketch import MechanismSketch
from camgeo.motion.extremes import lift_range


def skeleton(cam: Cam, returning: Follower | None, phi: float) -> MechanismSketch:
    """The mechanism of `cam` at the cam angle `phi` [rad].

    `returning` is the follower on the return disc of a conjugate pair, None if there is none.
    """
    follower, linkage = cam.follower, cam.drive.linkage
    motion, ends = cam.drive.motion, face_ends(cam.disc.pitch_curve)
    lift = float(motion.jet(np.array([phi]))[0, 0])
    lifts = lift_range(motion)
    farthest = max(lifts, key=lambda each: follower.reach * each)
    found = follower.sketch(lift, farthest, ends)
    if returning is not None:
        reach = max(abs(traced_point(each, at)) for each in (follower, returning) for at in lifts)
        found += returning.beside(traced_point(follower, lift), lift, reach)
    if cam.yoke_breadth > 0.0:
        found += follower.far_side(lift, ends, cam.yoke_breadth)
    if linkage is None:
        return found
    position = float(cam.drive.plan.jet(np.array([phi]))[0, 0])
    return found + linkage.sketch(*follower.linked_at(farthest), position)


def face_ends(curve: PitchCurve) -> tuple[float, float]:
    """Where a flat face begins and ends [mm]: as the scene says, else as the contact needs it.

    Zeros for a roller, which has no face.
    """
    if curve.follower.face is not None:
        return curve.follower.face
    from camgeo.outline.convex import contact_extremes  # few cams have a flat face

    places = contact_extremes(curve)
    return places.smallest()[0], places.largest()[0]
