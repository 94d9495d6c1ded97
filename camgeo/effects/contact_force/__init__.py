"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

from typing import Final

from camgeo.effects.contact_force.spec import FORCES, parse
from camgeo.effects.effect import Effect, schema_beside
from camgeo.effects.results import CONTACT_FORCE, FRICTION
from camgeo.effects.rules import ONE_CONTACT, Only

EFFECT: Final = Effect(
    name=CONTACT_FORCE,
    title="force between cam and follower along their common normal",
    compute="camgeo.effects.contact_force.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(Only(ONE_CONTACT),),
    uses=(*FORCES, FRICTION),
    keys=(tuple(f"effects.{name}" for name in FORCES),),
)
