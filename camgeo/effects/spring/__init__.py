"""Effect `spring`: a linear spring that closes the contact."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import Effect
from camgeo.effects.results import SPRING
from camgeo.effects.spring.table import parse

EFFECT: Final = Effect(
    name=SPRING,
    title="force of the spring that closes the contact",
    compute="camgeo.effects.spring.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    tabled=True,
    premise="motion",
)
