"""Effect `gravity`: the weights of the masses."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.dynamics.effects.effect import Effect, data_of
from camgeo.dynamics.effects.results import GRAVITY, INERTIA
from camgeo.record import schema_beside

STANDARD_GRAVITY: Final = 9806.65
"""g_n [mm/s^2] (3rd CGPM 1901, resolution on the standard value of the acceleration of gravity;
ISO 80000-3, acceleration of free fall)."""


@dataclass(frozen=True, slots=True)
class GravityDirection:
    """The direction of gravity, from the table ``[effects.gravity]``.

    Attributes
    ----------
    angle : direction of gravity [rad], counter-clockwise from the x axis.
    """

    angle: float = -0.5 * math.pi

    @property
    def pull(self) -> complex:
        """The acceleration of free fall [mm/s^2]."""
        return STANDARD_GRAVITY * cmath.rect(1.0, self.angle)


EFFECT: Final = Effect(
    name=GRAVITY,
    title="weights",
    compute="camgeo.dynamics.effects.gravity.result:compute",
    schema=schema_beside(__file__),
    parse=partial(data_of, GravityDirection),
    needs=(INERTIA,),
    keys=((f"effects.{INERTIA}",),),
    premise="motion",
    regardless=("weight",),
)
