"""The smallest preload and the smallest stiffness of a spring that keep the roller on its flank.

The force on the flank is linear in both (Norton, Machine Design, chapter on cam design: spring rate
and preload against follower jump): preload times a, stiffness times b, and the rest, each over the
cam angle. Wherever a is above 0 the preload has to be at least the quotient of what is missing
and a; wherever a is below 0, which a lever may bring about, the preload must not be above it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.effects.lift_off.inputs import TOUCH, Flank
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import grid_of, piecewise_extremes
from camgeo.numeric.roots import roots_on_grid

BOUNDLESS: Final = 1e200
"""Stands for a quotient by 0: far beyond all quotients, and its differences are finite."""

BLUNT: Final = 1e-10
"""Where the spring does less than this share of its largest effect, it counts as none."""


@dataclass(frozen=True, slots=True)
class Least:
    """The least value of a property of the spring.

    Attributes
    ----------
    value : in its unit; None if none is enough.
    place : cam angle [rad] that asks for it, or at which none helps.
    """

    value: float | None
    place: float


def least_of(flank: Flank, per_unit: Quantity, now: float, edges: FloatArray) -> Least:
    """The least preload or stiffness, of which the spring has `now` and gives `per_unit` of it.

    The least x >= 0 with rest + x effect >= 0 all over the turn, effect and rest generalised forces
    in the sense in which the flank pushes; what else the spring has stays.
    """

    def parts(phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(n,) effect and rest."""
        outwards = flank.outwards(phi, side)
        effect = -outwards * per_unit(phi, side)
        rest = np.sum(flank.reserve(phi, side, outwards), axis=0) - now * effect
        return effect, rest

    roots = roots_on_grid(lambda phi: per_unit(phi, "right"), grid_of(edges))
    cuts = merged(np.concatenate((edges, roots)))
    effects, rests = parts(grid_of(cuts).ravel(), "right")
    blunt = BLUNT * float(np.max(np.abs(effects)))
    none = TOUCH * float(np.max(np.abs(rests)))

    def bound(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) what the value has to be at least, 0 where nothing is missing."""
        effect, rest = parts(phi, side)
        found = np.zeros(len(phi))
        np.divide(-rest, effect, out=found, where=(effect > blunt) & (rest < -none))
        found[(np.abs(effect) <= blunt) & (rest < -none)] = BOUNDLESS
        return found

    def left(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) what is left with the least value; below 0 where a lever has turned over."""
        effect, rest = parts(phi, side)
        return rest + least.value * effect

    least = piecewise_extremes(bound, cuts).highest
    if least.value >= BOUNDLESS:
        return Least(None, least.place)
    if np.min(effects) < -blunt:
        over = piecewise_extremes(left, cuts)
        if over.lowest.value < -TOUCH * over.magnitude:
            return Least(None, over.lowest.place)
    return Least(least.value, least.place)
