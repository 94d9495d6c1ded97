"""Effect `roller-spin`: how the roller turns, and where it skids."""

from __future__ import annotations

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
)
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.record import schema_beside

EFFECT: Final = Effect(
    name="roller-spin",
    title="spin of the roller, and where it skids",
    compute="camgeo.dynamics.effects.roller_spin.result:compute",
    schema=schema_beside(__file__),
    rules=(Only(ONE_ROLLER), Only(ROLLERS), Only(ROUND)),
    needs=(CONTACT_FORCE,),
    keys=(SPEED,),
    tabled=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
