"""Effect `power-balance`: where the power of the camshaft goes."""

from __future__ import annotations

from typing import Final

from camgeo.dynamics.effects.effect import ELASTIC, GIVEN_SPEED, SPEED, STIFF_SHAFT, Effect
from camgeo.dynamics.effects.results import CONTACT_FORCE, DRIVE_TORQUE
from camgeo.record import schema_beside

EFFECT: Final = Effect(
    name="power-balance",
    title="power of the camshaft, what takes it, and the efficiency",
    compute="camgeo.dynamics.effects.power_balance.result:compute",
    schema=schema_beside(__file__),
    needs=(CONTACT_FORCE, DRIVE_TORQUE),
    keys=(SPEED,),
    numerical=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
