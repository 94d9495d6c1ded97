"""Effect `shock-spectrum`: what remains of the vibration after each move."""

from __future__ import annotations

from typing import Final

from camgeo.effects.effect import Effect, schema_beside
from camgeo.effects.shock_spectrum.spec import parse

EFFECT: Final = Effect(
    name="shock-spectrum",
    title="shock spectrum of the moves",
    compute="camgeo.effects.shock_spectrum.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
)
