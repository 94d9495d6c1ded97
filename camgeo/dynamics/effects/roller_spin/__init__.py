"""Effect `roller-spin`: how the roller turns, and where it skids."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from camgeo.dynamics.effects.effect import (
    ELASTIC,
    GIVEN_SPEED,
    ONE_ROLLER,
    ROLLERS,
    ROUND,
    SPEED,
    STIFF_SHAFT,
    Effect,
    Only,
    data_of,
)
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.record import schema_beside


@dataclass(frozen=True, slots=True)
class RollerData:
    """The roller, from the table ``[effects.roller-spin]``.

    Attributes
    ----------
    moment_of_inertia : J of the turning parts about the pin [t mm^2].
    traction : largest ratio of tangential to normal force at the contact.
    """

    moment_of_inertia: float
    traction: float


EFFECT: Final = Effect(
    name="roller-spin",
    title="spin of the roller, and where it skids",
    compute="camgeo.dynamics.effects.roller_spin.result:compute",
    schema=schema_beside(__file__),
    parse=partial(data_of, RollerData),
    rules=(Only(ONE_ROLLER), Only(ROLLERS), Only(ROUND)),
    needs=(CONTACT_FORCE,),
    keys=(SPEED,),
    tabled=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
