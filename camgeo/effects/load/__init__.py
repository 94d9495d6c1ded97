"""Effect `load`: the process force over the cam angle."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.effect import Effect
from camgeo.effects.load.table import parse
from camgeo.effects.results import LOAD

EFFECT: Final = Effect(
    name=LOAD,
    title="process load",
    compute="camgeo.effects.load.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    tabled=True,
    premise="motion",
)
