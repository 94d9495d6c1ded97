"""Effect `kinematics`: velocity, acceleration and jerk in time."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import GIVEN_SPEED, SPEED, STIFF_SHAFT, Effect

EFFECT: Final = Effect(
    name="kinematics",
    title="motion in time",
    compute="camgeo.effects.kinematics.result:compute",
    schema=schema_beside(__file__),
    keys=(SPEED,),
    of_drive=True,
    premise="motion",
    regardless=("turn-time",),
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
