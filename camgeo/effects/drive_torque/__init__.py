"""Effect `drive-torque`: what the camshaft has to be given."""

from __future__ import annotations

from typing import Final

from camgeo.effects.drive_torque.spec import parse
from camgeo.effects.effect import Effect, schema_beside
from camgeo.effects.results import CONTACT_FORCE, DRIVE_TORQUE

EFFECT: Final = Effect(
    name=DRIVE_TORQUE,
    title="torque on the camshaft",
    compute="camgeo.effects.drive_torque.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    needs=(CONTACT_FORCE,),
    numerical=True,
)
