"""Effect `gravity`: the weights of the masses."""

from __future__ import annotations

from typing import Final

from camgeo.dynamics.effects.effect import Effect
from camgeo.dynamics.effects.results import GRAVITY, INERTIA
from camgeo.record import schema_beside

EFFECT: Final = Effect(
    name=GRAVITY,
    title="weights",
    compute="camgeo.dynamics.effects.gravity.result:compute",
    schema=schema_beside(__file__),
    needs=(INERTIA,),
    keys=((f"effects.{INERTIA}",),),
    premise="motion",
    regardless=("weight",),
)
