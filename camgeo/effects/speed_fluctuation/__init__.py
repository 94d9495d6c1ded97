"""Effect `speed-fluctuation`: speed of a motor-driven cam over a turn in its steady state."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import ELASTIC, Effect
from camgeo.effects.results import DRIVE_TORQUE, SPEED_FLUCTUATION
from camgeo.effects.speed_fluctuation.table import parse

EFFECT: Final = Effect(
    name=SPEED_FLUCTUATION,
    title="speed of the motor-driven cam",
    compute="camgeo.effects.speed_fluctuation.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    needs=(DRIVE_TORQUE,),
    tabled=True,
    numerical=True,
    refined_by=(ELASTIC,),
)
