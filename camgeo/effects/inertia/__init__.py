"""Inertia: the masses that are moved, their inertia forces, and what they amount to elsewhere.

All masses move as the cam angle says, so that their generalised force on the follower follows from
d'Alembert's principle in Lagrange's form (virtual work of -m x'' and -J v''), and their inertia as
felt at the follower or at the camshaft from their kinetic energy. VDI 2142 and the textbooks of
machine dynamics (Volmer, "Getriebetechnik", reduction of masses; Norton, "Design of Machinery",
the chapters on dynamics and cam dynamics) say the same for the single mass.
"""

from __future__ import annotations

from typing import Final

from camgeo.effects.effect import SPEED, Effect
from camgeo.effects.inertia.result import compute
from camgeo.effects.inertia.spec import parse

EFFECT: Final = Effect(
    name="inertia",
    title="inertia force",
    compute=compute,
    parse=parse,
    keys=(SPEED,),
    tabled=True,
)
