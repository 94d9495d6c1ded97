"""Effect `balance`: mass, centre of mass and unbalance of the disc."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.balance.table import parse
from camgeo.effects.effect import GIVEN_SPEED, STIFF_SHAFT, Effect
from camgeo.effects.rules import ONE_DISC, Only

EFFECT: Final = Effect(
    name="balance",
    title="balance of the disc",
    compute="camgeo.effects.balance.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(Only(ONE_DISC),),
    keys=(("part.thickness",),),
    numerical=True,
    premise="disc",
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
