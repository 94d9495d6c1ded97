"""Cams put together from their parts."""

from __future__ import annotations

from camgeo.cam.cam import Cam
from camgeo.cam.contact import Contact
from camgeo.cam.drive import Drive
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.linkage_protocol import Linkage
from camgeo.motion.plan import MotionPlan
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
