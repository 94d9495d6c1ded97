"""Effect `spring-surge`: waves in a helical spring that harmonics of the lift excite."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import GIVEN_SPEED, SPEED, STIFF_SHAFT, Effect
from camgeo.effects.results import SPRING

EFFECT: Final = Effect(
    name="spring-surge",
    title="surge of the helical spring",
    compute="camgeo.effects.spring_surge.result:compute",
    schema=schema_beside(__file__),
    needs=(SPRING,),
    keys=(SPEED, ("effects.spring",)),
    numerical=True,
    premise="motion",
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
