"""Effect `drive-torque`: the torque that the camshaft needs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.dynamics.effects.effect import ELASTIC, GIVEN_SPEED, STIFF_SHAFT, Effect, data_of
from camgeo.dynamics.effects.results import CONTACT_FORCE, DRIVE_TORQUE
from camgeo.record import schema_beside


@dataclass(frozen=True, slots=True)
class TorqueLimits:
    """Limits of torque and speed fluctuation.

    Attributes
    ----------
    limit : largest torque allowed [N mm]; None for no limit.
    fluctuation : allowed speed fluctuation, to size a flywheel; None to size none.
    """

    limit: float | None = None
    fluctuation: float | None = None


EFFECT: Final = Effect(
    name=DRIVE_TORQUE,
    title="torque on the camshaft",
    compute="camgeo.dynamics.effects.drive_torque.result:compute",
    schema=schema_beside(__file__),
    parse=partial(data_of, TorqueLimits),
    needs=(CONTACT_FORCE,),
    numerical=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
