"""Effect `drive-torque`: what the camshaft has to be given."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import Effect, spec_of
from camgeo.effects.results import CONTACT_FORCE, DRIVE_TORQUE


@dataclass(frozen=True, slots=True)
class Spec:
    """The table.

    Attributes
    ----------
    limit : largest torque allowed [N mm]; None if there is none.
    fluctuation : allowed fluctuation of the speed, for the flywheel; None if none is sought.
    """

    limit: float | None = None
    fluctuation: float | None = None


EFFECT: Final = Effect(
    name=DRIVE_TORQUE,
    title="torque on the camshaft",
    compute="camgeo.effects.drive_torque.result:compute",
    schema=schema_beside(__file__),
    parse=partial(spec_of, Spec),
    needs=(CONTACT_FORCE,),
    numerical=True,
)
