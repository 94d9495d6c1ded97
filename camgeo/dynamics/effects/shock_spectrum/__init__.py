"""Effect `shock-spectrum`: the residual vibration after each move."""

from __future__ import annotations

from typing import Final

from camgeo.dynamics.effects.effect import GIVEN_SPEED, STIFF_SHAFT, Effect, Refinement
from camgeo.record import schema_beside

EFFECT: Final = Effect(
    name="shock-spectrum",
    title="shock spectrum of the moves",
    compute="camgeo.dynamics.effects.shock_spectrum.result:compute",
    schema=schema_beside(__file__),
    of_plan=True,
    refined_by=(
        Refinement("vibration", "a train that is at rest when a move begins"),
        GIVEN_SPEED,
        STIFF_SHAFT,
    ),
)
