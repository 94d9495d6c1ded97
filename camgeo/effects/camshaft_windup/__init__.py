"""Effect `camshaft-windup`: torsion of the camshaft between its drive and the cam."""

from __future__ import annotations

from typing import Final

from camgeo.declared import schema_beside
from camgeo.effects.camshaft_windup.table import parse
from camgeo.effects.effect import ELASTIC, Effect
from camgeo.effects.results import CAMSHAFT_WINDUP, DRIVE_TORQUE

EFFECT: Final = Effect(
    name=CAMSHAFT_WINDUP,
    title="torsion of the camshaft",
    compute="camgeo.effects.camshaft_windup.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    needs=(DRIVE_TORQUE,),
    keys=(("cam.speed",),),
    tabled=True,
    numerical=True,
    refined_by=(ELASTIC,),
)
