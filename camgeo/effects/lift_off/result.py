"""Effect `lift-off`: where the follower leaves its flank, from which speed on, and what keeps it.

In a groove, or between two discs: which side carries, where they change, and the impact at the end
of the clearance.
"""

from __future__ import annotations

from typing import Final

from camgeo.effects.effect import Request
from camgeo.effects.lift_off import Spec
from camgeo.effects.lift_off.inputs import Flank
from camgeo.effects.lift_off.of_flank import ForceClosed, of_flank
from camgeo.effects.lift_off.of_groove import FormClosed, of_groove
from camgeo.effects.results import CONTACT_FORCE, INERTIA, SPRING
from camgeo.effects.touching import holds_both_ways
from camgeo.errors import GeometryError

NAME: Final = "lift-off"


def compute(request: Request[Spec]) -> ForceClosed | FormClosed:
    """What becomes of the contact.

    Raises
    ------
    GeometryError
        If the scene gives a margin for a roller in a groove, which leaves its flanks all the time,
        or a backlash for one that touches one flank only, or one that is not the side clearance of
        its groove.
    EffectError
        If an impact speed cannot be told to the tolerance.
    """
    subject, spec = request.subject, request.spec
    contact = request.results[CONTACT_FORCE]
    inertia = request.results.get(INERTIA)
    if holds_both_ways(subject):
        if spec.margin > 0.0:
            raise GeometryError(
                "a margin is for a roller on one flank; in a groove, or between two discs, the"
                " force changes its sign",
                key=f"effects.{NAME}.margin",
                value=f"{spec.margin:g}",
            )
        backlash = _backlash(spec, subject.cam.clearance)
        return of_groove(subject, contact, inertia, backlash, request.tolerance)
    if spec.backlash is not None:
        raise GeometryError(
            'a backlash is for a roller in a groove, contact = "groove", or between two discs',
            key=f"effects.{NAME}.backlash",
            value=f"{spec.backlash:g}",
        )
    flank = Flank(subject, contact, subject.cam.contact.push, spec.margin, inertia)
    return of_flank(flank, request.results.get(SPRING))


def _backlash(spec: Spec, side_clearance: float) -> float:
    """The clearance [mm] that the roller crosses.

    A groove that is as wide as the roller may be said to have a backlash, by wear for instance.
    """
    if spec.backlash is None:
        return side_clearance
    if side_clearance > 0.0 and spec.backlash != side_clearance:
        raise GeometryError(
            f"contradicts [follower] side_clearance, {side_clearance:g} mm: leave it out, or give"
            " the same",
            key=f"effects.{NAME}.backlash",
            value=f"{spec.backlash:g}",
        )
    return spec.backlash
