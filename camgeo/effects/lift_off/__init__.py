"""Effect `lift-off`: where the follower leaves its flank, and what keeps it."""

from __future__ import annotations

from typing import Final

from camgeo.effects.effect import Effect, schema_beside
from camgeo.effects.lift_off.spec import parse
from camgeo.effects.results import CONTACT_FORCE, INERTIA, SPRING
from camgeo.effects.rules import ONE_CONTACT, ROLLERS, Only

EFFECT: Final = Effect(
    name="lift-off",
    title="where the follower leaves its flank, from which speed on, and what keeps it",
    compute="camgeo.effects.lift_off.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(Only(ONE_CONTACT), Only(ROLLERS, "backlash")),
    needs=(CONTACT_FORCE,),
    uses=(INERTIA, SPRING),
    numerical=True,
)
