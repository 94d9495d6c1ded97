"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.dynamics.effects.effect import ELASTIC, GIVEN_SPEED, STIFF_SHAFT, Effect, data_of
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


@dataclass(frozen=True, slots=True)
class ForceLimit:
    """The largest contact force allowed: `limit` [N], None for no limit."""

    limit: float | None = None


EFFECT: Final = Effect(
    name=CONTACT_FORCE,
    title="force between cam and follower along their common normal",
    compute="camgeo.dynamics.effects.contact_force.result:compute",
    schema=schema_beside(__file__),
    parse=partial(data_of, ForceLimit),
    uses=(*FORCES, FRICTION, VIBRATION),
    keys=(tuple(f"effects.{name}" for name in FORCES),),
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
