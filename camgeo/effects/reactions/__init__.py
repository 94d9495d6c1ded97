"""Effect `reactions`: forces in the bearings of follower and camshaft."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import ELASTIC, GIVEN_SPEED, Effect
from camgeo.effects.results import CONTACT_FORCE, GRAVITY, INERTIA, SPRING
from camgeo.effects.rules import ONE_CONTACT, Only

EFFECT: Final = Effect(
    name="reactions",
    title="forces in guide, pivot, pins and camshaft bearings",
    compute="camgeo.effects.reactions.result:compute",
    schema=schema_beside(__file__),
    rules=(Only(ONE_CONTACT),),
    needs=(CONTACT_FORCE,),
    uses=(INERTIA, GRAVITY, SPRING),
    numerical=True,
    refined_by=(ELASTIC, GIVEN_SPEED),
)
