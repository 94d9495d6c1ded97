"""Effect `kinematics`: velocity, acceleration and jerk in time."""

from __future__ import annotations

from typing import Final

from camgeo.dynamics.effects.effect import GIVEN_SPEED, SPEED, STIFF_SHAFT, Effect
from camgeo.record import schema_beside

EFFECT: Final = Effect(
    name="kinematics",
    title="motion in time",
    compute="camgeo.dynamics.effects.kinematics.result:compute",
    schema=schema_beside(__file__),
    keys=(SPEED,),
    of_drive=True,
    premise="motion",
    regardless=("turn-time",),
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
