"""Effect `vibration`: an elastic follower train in its steady state."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import GIVEN_SPEED, SPEED, STIFF_SHAFT, Effect
from camgeo.effects.results import INERTIA, LOAD, VIBRATION
from camgeo.effects.rules import ANGLES, LENGTHS, Only
from camgeo.effects.vibration.table import parse

EFFECT: Final = Effect(
    name=VIBRATION,
    title="vibration of the follower train",
    compute="camgeo.effects.vibration.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(
        Only(LENGTHS, "stiffness", "limit", "masses"),
        Only(ANGLES, "torsional_stiffness", "limit_angle", "moments"),
    ),
    uses=(INERTIA, LOAD),
    keys=(SPEED,),
    tabled=True,
    numerical=True,
    regardless=("natural-frequency", "time-constant", "settling"),
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
