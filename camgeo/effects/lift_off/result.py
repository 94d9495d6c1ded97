"""Effect `lift-off`: where the follower leaves its flank, from which speed, and what prevents it.

In a groove, between two discs, or in a yoke: which side carries, where this changes, and the impact
after the clearance has been crossed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from camgeo.effects.effect import Request
from camgeo.effects.lift_off import ContactMargin
from camgeo.effects.lift_off.flank import Flank
from camgeo.effects.lift_off.force_closed import ForceClosed, of_flank
from camgeo.effects.lift_off.form_closed import FormClosed, of_groove
from camgeo.effects.results import CONTACT_FORCE, INERTIA, SPRING
from camgeo.effects.touching import holds_both_ways
from camgeo.errors import GeometryError

NAME: Final = "lift-off"


def compute(request: Request[ContactMargin]) -> ForceClosed | FormClosed:
    """Where contact is lost, or changes sides.

    Raises
    ------
    GeometryError
        If the scene gives a margin for a roller in a groove, which changes flanks in operation, a
        backlash for a roller on a single flank, or one that differs from the side clearance.
    """
    subject, data = request.subject, request.data
    contact = request.results[CONTACT_FORCE]
    inertia = request.results.get(INERTIA)
    if holds_both_ways(subject):
        if data.margin > 0.0:
            raise GeometryError(
                "a margin is for a follower on one flank; in a groove, in a yoke, or between two"
                " discs, the force changes sign",
                key=f"effects.{NAME}.margin",
                value=f"{data.margin:g}",
            )
        cam = subject.cam
        backlash = _backlash(data, cam.clearance)
        if cam.breadth is not None:
            backlash = cam.breadth.play(cam.yoke_breadth)
        return of_groove(subject, contact, inertia, backlash, data.restitution, request.tolerance)
    if data.backlash is not None:
        raise GeometryError(
            'a backlash is for a roller in a groove, contact = "groove", or between two discs',
            key=f"effects.{NAME}.backlash",
            value=f"{data.backlash:g}",
        )
    flank = Flank(subject, contact, subject.cam.contact.push, data.margin)
    closed = of_flank(flank, request.results.get(SPRING), request.near)
    if not contact.lost_contact:
        return closed
    from camgeo.effects.lift_off.landing import flown_from  # few followers leave the flank

    flown = flown_from(flank, inertia, data.restitution, request.tolerance)
    return replace(
        closed,
        findings=(*closed.findings, *flown.findings),
        flights=flown.flights,
        flown=flown.ranges,
        errors={**closed.errors, **flown.errors},
    )


def _backlash(data: ContactMargin, side_clearance: float) -> float:
    """The clearance [mm] that the roller crosses.

    A groove as wide as the roller may still be given a backlash, e.g. for wear.
    """
    if data.backlash is None:
        return side_clearance
    if side_clearance > 0.0 and data.backlash != side_clearance:
        raise GeometryError(
            f"contradicts [follower] side_clearance, {side_clearance:g} mm: omit it or give the"
            " same value",
            key=f"effects.{NAME}.backlash",
            value=f"{data.backlash:g}",
        )
    return data.backlash
