"""Effect `inertia`: the masses that are moved, and their inertia forces."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import GIVEN_SPEED, RIGID, SPEED, STIFF_SHAFT, Effect
from camgeo.effects.inertia.table import OF_COUPLER, OF_ROCKER, parse
from camgeo.effects.results import INERTIA
from camgeo.effects.rules import LINKED, ROCKING, ROLLERS, STRAIGHT, TURNING, Only

EFFECT: Final = Effect(
    name=INERTIA,
    title="inertia force",
    compute="camgeo.effects.inertia.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(
        Only(ROCKING, *OF_ROCKER),
        Only(ROLLERS, "roller_mass"),
        Only(LINKED, *OF_COUPLER),
        Only(TURNING, "output_moment"),
        Only(STRAIGHT, "mass"),
    ),
    keys=(SPEED,),
    tabled=True,
    premise="motion",
    regardless=("reduced-mass", "reduced-moment-of-inertia"),
    refined_by=(RIGID, GIVEN_SPEED, STIFF_SHAFT),
)
