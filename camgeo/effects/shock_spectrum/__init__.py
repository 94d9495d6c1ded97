"""Effect `shock-spectrum`: what remains of the vibration after each move."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import Effect, spec_of


@dataclass(frozen=True, slots=True)
class Spec:
    """What the scene says.

    Attributes
    ----------
    highest_ratio : up to which the spectrum is looked at.
    damping : damping ratio of the train.
    """

    highest_ratio: float = 10.0
    damping: float = 0.0


EFFECT: Final = Effect(
    name="shock-spectrum",
    title="shock spectrum of the moves",
    compute="camgeo.effects.shock_spectrum.result:compute",
    schema=schema_beside(__file__),
    parse=partial(spec_of, Spec),
)
