"""Effect `shock-spectrum`: the residual vibration after each move."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.dynamics.effects.effect import GIVEN_SPEED, STIFF_SHAFT, Effect, Refinement, data_of
from camgeo.record import schema_beside


@dataclass(frozen=True, slots=True)
class SpectrumRange:
    """Range and damping of the spectrum.

    Attributes
    ----------
    highest_ratio : upper end of the spectrum.
    damping : damping ratio of the train.
    """

    highest_ratio: float = 10.0
    damping: float = 0.0


EFFECT: Final = Effect(
    name="shock-spectrum",
    title="shock spectrum of the moves",
    compute="camgeo.dynamics.effects.shock_spectrum.result:compute",
    schema=schema_beside(__file__),
    parse=partial(data_of, SpectrumRange),
    of_plan=True,
    refined_by=(
        Refinement("vibration", "a train that is at rest when a move begins"),
        GIVEN_SPEED,
        STIFF_SHAFT,
    ),
)
