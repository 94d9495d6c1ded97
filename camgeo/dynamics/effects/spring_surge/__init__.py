"""Effect `spring-surge`: waves in a helical spring that harmonics of the lift excite."""

from __future__ import annotations

from typing import Final

from camgeo.dynamics.effects.effect import GIVEN_SPEED, SPEED, STIFF_SHAFT, Effect
from camgeo.dynamics.effects.results import SPRING
from camgeo.record import schema_beside

EFFECT: Final = Effect(
    name="spring-surge",
    title="surge of the helical spring",
    compute="camgeo.dynamics.effects.spring_surge.result:compute",
    schema=schema_beside(__file__),
    needs=(SPRING,),
    keys=(SPEED, ("effects.spring",)),
    numerical=True,
    premise="motion",
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
