"""Effect `drive-torque`: the torque that the camshaft needs."""

from __future__ import annotations

from typing import Final

from camgeo.dynamics.effects.effect import ELASTIC, GIVEN_SPEED, STIFF_SHAFT, Effect
from camgeo.dynamics.effects.results import CONTACT_FORCE, DRIVE_TORQUE
from camgeo.record import schema_beside

EFFECT: Final = Effect(
    name=DRIVE_TORQUE,
    title="torque on the camshaft",
    compute="camgeo.dynamics.effects.drive_torque.result:compute",
    schema=schema_beside(__file__),
    needs=(CONTACT_FORCE,),
    numerical=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
