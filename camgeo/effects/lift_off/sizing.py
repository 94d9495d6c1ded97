"""The speed at which the roller first leaves its flank, and the spring that keeps it there.

With the cam running f times as fast as in the scene, the contact force is a quadratic in f at every
cam angle: weights and springs are constant, viscous friction is proportional to f, inertia to f^2.
The lift-off speed is the smallest f at which the force falls to its margin anywhere (the "jump
speed" of textbooks: Norton, Machine Design, chapter on cam design, follower jump; Rothbart, Cam
Design Handbook, chapter on dynamics).

The force on the flank is linear in preload and stiffness (Norton, Machine Design, chapter on cam
design: spring rate and preload against follower jump): a times the preload, b times the stiffness,
and the rest, each a function of cam angle. Where a is above 0, the preload must be at least the
missing force divided by a. Where a is below 0, which is possible with a lever, it must not exceed
this.

Friction in pivot or guide adds the sizes of their loads, with which neither is a polynomial any
more. With the directions of the loads given it is one, and has the value and the derivative of the
whole at the speed, or at the spring, for which they are taken. So both are found again with the
directions at the value found before, until it stays: Newton's method for the whole turn.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.effects.lift_off.flank import Flank
from camgeo.effects.touching import TOUCH
from camgeo.errors import EffectError
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, grid_of, piecewise_extremes, piecewise_highest
from camgeo.numeric.roots import roots_on_grid

FASTEST: Final = 1e6
"""A factor of the speed at which inertia alone directs the loads."""

BOUNDLESS: Final = 1e200
"""Stands for division by 0: far above all quotients, with finite differences."""

MOST_STEPS: Final = 100
"""Largest number of times that a value is found again."""

SETTLED: Final = 1e-13
"""Relative change of a value that has settled."""

BLUNT: Final = 1e-10
"""Where the spring has less than this share of its largest effect, it has none."""


def least_of(
    flank: Flank,
    per_unit: Quantity,
    now: float,
    edges: FloatArray,
    load: Callable[[FloatArray, Side], ComplexArray] | None = None,
) -> Extreme:
    """The least preload or stiffness; the spring has `now`, with the effect `per_unit` of it.

    This is the least x >= 0 with rest + x effect >= 0 over the whole turn, where effect and rest
    are generalised forces in the direction in which the flank pushes, and the other property of the
    spring is unchanged. It comes with the cam angle [rad] that determines it; if no value is enough
    it is infinite, with the cam angle at which none helps. `load` (k, n) is that of pivot or guide
    for one unit more of x; None if there is none.
    """
    if flank.contact.bearings is None:
        return _least(flank, per_unit, now, edges)
    found = _least(flank, per_unit, now, edges, load, now)
    for _ in range(MOST_STEPS):
        if load is None or np.isinf(found.value):
            return found
        last = found
        found = _least(flank, per_unit, now, edges, load, last.value)
        if abs(found.value - last.value) <= SETTLED * last.value:
            return found
    raise EffectError("no least value of the spring settles with the friction in the pivot")


def _least(
    flank: Flank,
    per_unit: Quantity,
    now: float,
    edges: FloatArray,
    load: Callable[[FloatArray, Side], ComplexArray] | None = None,
    guess: float = 0.0,
) -> Extreme:
    """The same with the directions of the loads that they have with `guess`."""

    def parts(phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(n,) effect and rest."""
        outwards = flank.outwards(phi, side)
        effect = -outwards * per_unit(phi, side)
        if load is None:
            return effect, flank.left(phi, side) - now * effect
        more = (guess - now) * load(phi, side)
        slope = effect + flank.slope(phi, side, more, load(phi, side))
        return slope, flank.left(phi, side, more) + (guess - now) * effect - guess * slope

    roots = roots_on_grid(lambda phi: per_unit(phi, "right"), grid_of(edges))
    cuts = merged(np.concatenate((edges, roots)))
    effects, rests = parts(grid_of(cuts).ravel(), "right")
    blunt = BLUNT * float(np.max(np.abs(effects)))
    none = TOUCH * float(np.max(np.abs(rests)))

    def bound(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) lower bound of the value, 0 where no force is missing."""
        effect, rest = parts(phi, side)
        found = np.zeros(len(phi))
        np.divide(-rest, effect, out=found, where=(effect > blunt) & (rest < -none))
        found[(np.abs(effect) <= blunt) & (rest < -none)] = BOUNDLESS
        return found

    def left(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) reserve with the least value; below 0 where a lever has reversed."""
        effect, rest = parts(phi, side)
        return rest + least.value * effect

    least = piecewise_highest(bound, cuts)
    if least.value >= BOUNDLESS:
        return Extreme(np.inf, least.place)
    if np.min(effects) < -blunt:
        over = piecewise_extremes(left, cuts)
        if over.lowest.value < -TOUCH * over.magnitude:
            return Extreme(np.inf, over.lowest.place)
    return least


def lift_off_speed(flank: Flank, edges: FloatArray) -> Extreme:
    """The smallest speed factor at which the force on `flank` falls below its margin, with the cam
    angle [rad]; 0 if this happens at any speed, infinite if it never happens.

    Parameters
    ----------
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the coefficients are smooth.
    """

    def static(phi: FloatArray, side: Side) -> FloatArray:
        at_rest: FloatArray = flank.reserve(phi, side, factor=0.0)[0]
        return at_rest

    rest = piecewise_extremes(static, edges)
    if rest.lowest.value < -TOUCH * rest.magnitude:
        return Extreme(0.0, rest.lowest.place)

    if flank.contact.bearings is None:
        return _speed(flank, edges, 1.0)
    found = _speed(flank, edges, 1.0)
    if np.isinf(found.value):
        found = _speed(flank, edges, FASTEST)
    for _ in range(MOST_STEPS):
        if found.value == 0.0 or np.isinf(found.value):
            return found
        last = found
        found = _speed(flank, edges, last.value)
        if abs(found.value - last.value) <= SETTLED * last.value:
            return found
    raise EffectError("no lift-off speed settles with the friction in the pivot")


def _speed(flank: Flank, edges: FloatArray, factor: float) -> Extreme:
    """The same with the directions of the loads that they have at `factor`."""

    def discriminant(phi: FloatArray) -> FloatArray:
        r0, r1, r2 = flank.reserve(phi, "right", factor=factor)
        found: FloatArray = r1 * r1 - 4.0 * r0 * r2
        return found

    # Where the discriminant is 0, two roots meet and vanish, and the slowness jumps.
    cuts = merged(np.concatenate((edges, roots_on_grid(discriminant, grid_of(edges)))))
    slowest = piecewise_highest(_slowness(flank, factor), cuts)
    if slowest.value <= 0.0:
        return Extreme(np.inf, slowest.place)
    if slowest.value >= BOUNDLESS:
        return Extreme(0.0, slowest.place)
    return Extreme(1.0 / slowest.value, slowest.place)


def _slowness(flank: Flank, factor: float) -> Quantity:
    """(n,) 1 / f for the smallest positive f with r0 + f r1 + f^2 r2 = 0, or 0 without one."""

    def slowness(phi: FloatArray, side: Side) -> FloatArray:
        r0, r1, r2 = flank.reserve(phi, side, factor=factor)
        r0 = np.maximum(r0, 0.0)
        # Divided by the largest coefficient, so that squares neither overflow nor underflow.
        size = np.maximum(np.maximum(r0, np.abs(r1)), np.abs(r2))
        r0, r1, r2 = np.stack((r0, r1, r2)) / np.where(size > 0.0, size, 1.0)
        square = r1 * r1 - 4.0 * r0 * r2
        root = np.sqrt(np.maximum(square, 0.0))
        # The largest root of r0 k^2 + r1 k + r2, k = 1 / f, in the form without cancellation.
        falling = r1 < 0.0
        above = np.where(falling, root - r1, -2.0 * r2)
        below = np.where(falling, 2.0 * r0, r1 + root)
        bounded = below * BOUNDLESS > above
        found = np.where(above > 0.0, BOUNDLESS, 0.0)
        np.divide(above, below, out=found, where=bounded & (below > 0.0))
        found[square < 0.0] = 0.0
        return np.clip(found, 0.0, BOUNDLESS)

    return slowness
