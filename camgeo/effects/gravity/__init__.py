"""Effect `gravity`: the weights of the masses."""

from __future__ import annotations

from typing import Final

from camgeo.effects.effect import Effect, schema_beside
from camgeo.effects.gravity.spec import parse
from camgeo.effects.results import GRAVITY, INERTIA

EFFECT: Final = Effect(
    name=GRAVITY,
    title="weights",
    compute="camgeo.effects.gravity.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    needs=(INERTIA,),
    keys=((f"effects.{INERTIA}",),),
)
