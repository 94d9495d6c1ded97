"""Effect `lift-off`: where the follower leaves its flank, and what prevents it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from camgeo.dynamics.effects.effect import (
    ELASTIC,
    GIVEN_SPEED,
    ROLLERS,
    STIFF_SHAFT,
    Effect,
    Kind,
    Only,
    data_of,
)
from camgeo.dynamics.effects.results import CONTACT_FORCE, INERTIA, SPRING
from camgeo.record import schema_beside


@dataclass(frozen=True, slots=True)
class ContactMargin:
    """The contact force that must remain, the clearance of the roller, and how it rebounds.

    Attributes
    ----------
    margin : contact force that must remain [N].
    backlash : clearance of the roller in a groove or, between two discs, of the return roller along
        its normal [mm]; None for the side clearance in the scene.
    restitution : of an impact, speed after it by speed before it, 0 to 1.
    """

    margin: float = 0.0
    backlash: float | None = None
    restitution: float = 0.0


PLAYED: Final = Kind(
    "yoked",
    (True,),
    "is not for a yoke, [follower.yoke], whose play follows from its breadth",
    "Not with a yoke.",
    "yoke",
)


EFFECT: Final = Effect(
    name="lift-off",
    title="where the follower leaves its flank, from which speed, and what prevents it",
    compute="camgeo.dynamics.effects.lift_off.result:compute",
    schema=schema_beside(__file__),
    parse=partial(data_of, ContactMargin),
    rules=(Only(PLAYED, "backlash"), Only(ROLLERS, "backlash")),
    needs=(CONTACT_FORCE,),
    uses=(INERTIA, SPRING),
    numerical=True,
    premise="motion",
    refined_by=(
        replace(ELASTIC, caution="an elastic one may leave the cam at a lower speed"),
        GIVEN_SPEED,
        STIFF_SHAFT,
    ),
)
