"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

from typing import Final

from camgeo.dynamics.effects.effect import ELASTIC, GIVEN_SPEED, STIFF_SHAFT, Effect
from camgeo.dynamics.effects.results import (
    CONTACT_FORCE,
    FRICTION,
    GRAVITY,
    INERTIA,
    LOAD,
    SPRING,
    VIBRATION,
)
from camgeo.record import schema_beside

FORCES: Final = (INERTIA, GRAVITY, LOAD, SPRING)
"""Effects that act on the follower, besides friction."""


EFFECT: Final = Effect(
    name=CONTACT_FORCE,
    title="force between cam and follower along their common normal",
    compute="camgeo.dynamics.effects.contact_force.result:compute",
    schema=schema_beside(__file__),
    uses=(*FORCES, FRICTION, VIBRATION),
    keys=(tuple(f"effects.{name}" for name in FORCES),),
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
