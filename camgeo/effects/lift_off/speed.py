"""The speed of the cam at which the roller first leaves its flank.

Run f times as fast as the scene has it, the contact force is a quadratic in f at every cam angle:
weights and springs stay, viscous friction grows with f, inertia with f^2. The smallest f at which
the force falls to its margin anywhere is sought ("jump speed" of the textbooks: Norton, Machine
Design, chapter on cam design, follower jump; Rothbart, Cam Design Handbook, chapter on dynamics).
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
"""Stands for a quotient by 0; far beyond all quotients, and its differences are finite."""


@dataclass(frozen=True, slots=True)
class LiftOffSpeed:
    """When contact is first lost.

    Attributes
    ----------
    factor : of the scene's speed; 0 if at any speed, infinite if at none.
    place : cam angle [rad]; of no meaning if at none.
    """

    factor: float
    place: float


def lift_off_speed(flank: Flank, edges: FloatArray) -> LiftOffSpeed:
    """The smallest factor of the speed at which the force on `flank` falls below its margin.

    Parameters
    ----------
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the coefficients are smooth.
    """

    def static(phi: FloatArray, side: Side) -> FloatArray:
        at_rest: FloatArray = flank.reserve(phi, side)[0]
        return at_rest

    rest = piecewise_extremes(static, edges)
    if rest.lowest.value < -TOUCH * rest.magnitude:
        return LiftOffSpeed(0.0, rest.lowest.place)

    def discriminant(phi: FloatArray) -> FloatArray:
        r0, r1, r2 = flank.reserve(phi, "right")
        found: FloatArray = r1 * r1 - 4.0 * r0 * r2
        return found

    # Where the discriminant vanishes two roots meet and end: there the slowness jumps.
    cuts = merged(np.concatenate((edges, roots_on_grid(discriminant, grid_of(edges)))))
    slowest = piecewise_extremes(_slowness(flank), cuts).highest
    if slowest.value <= 0.0:
        return LiftOffSpeed(np.inf, slowest.place)
    if slowest.value >= BOUNDLESS:
        return LiftOffSpeed(0.0, slowest.place)
    return LiftOffSpeed(1.0 / slowest.value, slowest.place)


def _slowness(flank: Flank) -> Quantity:
    """(n,) 1 / f of the smallest positive f with r0 + f r1 + f^2 r2 = 0, 0 if there is none."""

    def slowness(phi: FloatArray, side: Side) -> FloatArray:
        r0, r1, r2 = flank.reserve(phi, side)
        r0 = np.maximum(r0, 0.0)
        # Divided by the largest coefficient, so that no square over- or underflows.
        size = np.maximum(np.maximum(r0, np.abs(r1)), np.abs(r2))
        r0, r1, r2 = np.stack((r0, r1, r2)) / np.where(size > 0.0, size, 1.0)
        square = r1 * r1 - 4.0 * r0 * r2
        root = np.sqrt(np.maximum(square, 0.0))
        # The largest root of r0 k^2 + r1 k + r2, k = 1 / f, in the form that does not cancel.
        falling = r1 < 0.0
        above = np.where(falling, root - r1, -2.0 * r2)
        below = np.where(falling, 2.0 * r0, r1 + root)
        bounded = below * BOUNDLESS > above
        found = np.where(above > 0.0, BOUNDLESS, 0.0)
        np.divide(above, below, out=found, where=bounded & (below > 0.0))
        found[square < 0.0] = 0.0
        return np.clip(found, 0.0, BOUNDLESS)

    return slowness
