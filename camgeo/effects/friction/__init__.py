"""Effect `friction`: Coulomb, rolling and viscous friction, and the margin against jamming."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import Effect
from camgeo.effects.friction.table import (
    OF_FACE,
    OF_GUIDE,
    OF_LEVER,
    OF_PIVOT,
    OF_ROLLER,
    parse,
    tilts,
)
from camgeo.effects.results import FRICTION
from camgeo.effects.rules import (
    DRIVING_SLIDER,
    FLATS,
    GUIDED,
    ONE_ROLLER,
    ROCKING,
    ROLLERS,
    ROUND,
    STRAIGHT,
    Only,
)

EFFECT: Final = Effect(
    name=FRICTION,
    title="friction in guide, pivot, slider, roller and face",
    compute="camgeo.effects.friction.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(
        Only(ONE_ROLLER, *OF_LEVER),
        Only(GUIDED, *OF_GUIDE),
        Only(ROCKING, *OF_PIVOT),
        Only(ROLLERS, *OF_ROLLER),
        Only(ROUND, *OF_ROLLER),
        Only(FLATS, *OF_FACE),
        tilts,
        Only(DRIVING_SLIDER, "slider"),
        Only(STRAIGHT, "guide_viscous"),
    ),
    tabled=True,
)
