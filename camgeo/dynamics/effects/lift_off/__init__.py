"""Effect `lift-off`: where the follower leaves its flank, and what prevents it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from camgeo.dynamics.effects.effect import (
    ELASTIC,
    GIVEN_SPEED,
    ROLLERS,
    STIFF_SHAFT,
    Effect,
    Kind,
    Only,
)
from camgeo.dynamics.effects.results import CONTACT_FORCE, INERTIA, SPRING
from camgeo.record import schema_beside

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
