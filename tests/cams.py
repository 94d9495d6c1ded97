"""Cams put together from their parts."""

from __future__ import annotations

from camgeo.cam.cam import Cam, Contact, Drive
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.plan import MotionPlan
from camgeo.units import LiftUnit


def cam_of(
    plan: MotionPlan,
    follower: Follower,
    rotation: int = 1,
    contact: Contact = Contact.INNER,
    linkage: Linkage | None = None,
) -> Cam:
    unit: LiftUnit = follower.lift_unit
    if linkage is not None:
        unit = linkage.unit
    return Cam(Drive(plan, linkage, unit), follower, rotation, contact)
