"""Effect `contact-pressure`: Hertzian pressure between cam and follower."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.contact_pressure.table import OF_FACE, OF_ROLLER, parse
from camgeo.effects.effect import ELASTIC, GIVEN_SPEED, STIFF_SHAFT, Effect
from camgeo.effects.results import CONTACT_FORCE
from camgeo.effects.rules import FLATS, ROLLERS, Only

EFFECT: Final = Effect(
    name="contact-pressure",
    title="pressure between cam and follower",
    compute="camgeo.effects.contact_pressure.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(Only(ROLLERS, *OF_ROLLER), Only(FLATS, *OF_FACE)),
    needs=(CONTACT_FORCE,),
    numerical=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
