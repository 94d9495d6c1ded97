"""Effect `lift-off`: where the follower leaves its flank, and what keeps it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import Effect, spec_of
from camgeo.effects.results import CONTACT_FORCE, INERTIA, SPRING
from camgeo.effects.rules import ONE_CONTACT, ROLLERS, Only


@dataclass(frozen=True, slots=True)
class Spec:
    """What the scene says.

    Attributes
    ----------
    margin : contact force that has to remain [N].
    backlash : clearance of the roller in a groove, or between two discs the play of the roller that
        comes to carry, along its normal [mm]; None if it is the scene's side clearance.
    """

    margin: float = 0.0
    backlash: float | None = None


EFFECT: Final = Effect(
    name="lift-off",
    title="where the follower leaves its flank, from which speed on, and what keeps it",
    compute="camgeo.effects.lift_off.result:compute",
    schema=schema_beside(__file__),
    parse=partial(spec_of, Spec),
    rules=(Only(ONE_CONTACT), Only(ROLLERS, "backlash")),
    needs=(CONTACT_FORCE,),
    uses=(INERTIA, SPRING),
    numerical=True,
)
