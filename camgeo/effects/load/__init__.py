"""Load: the force of the process over the cam angle.

The load F acts against a positive demanded motion s, so that its generalised force on the follower
is Q = -F ds/dq by virtual work: -F where the follower makes the demanded motion itself. A positive
load on what turns, a rocker without linkage, or the lever or crank at the far end of one, is a
torque against its positive angle.
"""

from __future__ import annotations

from typing import Final

from camgeo.effects.effect import Effect
from camgeo.effects.load.result import compute
from camgeo.effects.load.spec import parse

EFFECT: Final = Effect(
    name="load",
    title="load of the process",
    compute=compute,
    parse=parse,
    tabled=True,
)
