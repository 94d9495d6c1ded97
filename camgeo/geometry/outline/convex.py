"""Whether a flat face can touch all of a cam: the extremes of the quantities that must be positive.

A face touches only what is convex. With the turn tau and the radius of curvature rho of
`camgeo.kinematics.mechanism.face`, the outline's tangent turns in one sense where tau > 0, by one
turn in all, because the follower returns to its start; and the outline is traversed forwards where
rho > 0. A closed curve whose tangent turns once in one sense has no crossing and is convex: no
search is needed to show that all of it remains. The cam axis lies inside if the face keeps clear of
it, h > 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.geometry.pieces import Extremes, centres_at, extremes, halves, turn_cells
from camgeo.geometry.pitch_curve import PitchCurve, in_blocks, joints
from camgeo.kinematics.mechanism.face import Touch, flat_follower
from camgeo.numeric.arrays import FloatArray, Side, ascending
from camgeo.numeric.kept import kept_with_owner

SMALLEST = 1e-9
"""Radius of curvature, as a fraction of the base radius, that counts as a cusp: a thousand times
the rounding of the sums."""

NO_JUMP = 1e-12
"""Jump of the contact, as a fraction of the base radius, that is ignored: below the tolerance for
the closure of a curve."""

HALVINGS = 40
"""Most rounds of halving, until no cell is left in which a cusp could hide."""

Extreme = tuple[float, float]
"""A value and its cam angle [rad]."""


@dataclass(frozen=True, slots=True)
class Convexity:
    """The quantities that decide whether a flat face can touch all of the cam.

    Attributes
    ----------
    turn : smallest tau.
    radius : smallest rho [mm]; minus infinity where tau <= 0, which admits no radius.
    clearance : smallest distance h of the face from the cam axis [mm].
    jump : largest jump of the contact along the face [mm], positive in the direction of travel
        along the outline: there a straight stretch of the outline lies flush with the face.
        Negative where it jumps back, which no outline permits. 0 without a shock.
    jumps : number of cam angles at which it jumps.
    size : length [mm] with which the other values are to be compared.
    """

    turn: Extreme
    radius: Extreme
    clearance: Extreme
    jump: Extreme
    jumps: int
    size: float

    @property
    def is_convex(self) -> bool:
        """Whether such a cam exists."""
        least = SMALLEST * self.size
        return (
            self.turn[0] > 0.0
            and self.jumps == 0
            and min(self.radius[0], self.clearance[0]) > least
        )


def touch(curve: PitchCurve, phi: FloatArray, side: Side = "right") -> Touch:
    """The contact of the flat follower of `curve` at `phi` (n,) [rad]."""
    return flat_follower(curve.follower).touch(curve.motion.jet(phi, side), curve.rotation)


@kept_with_owner
def convexity(curve: PitchCurve) -> Convexity:
    """The contact curve of a flat follower."""
    size = curve.follower.base_radius
    turn = smallest_turn(curve)
    clearance = _distances(curve).smallest()
    radius = (-np.inf, turn[1]) if turn[0] <= 0.0 else _proved_radius(curve)
    jump, count = _jumps(curve, NO_JUMP * size)
    return Convexity(turn, radius, clearance, jump, count, size)


def smallest_turn(curve: PitchCurve) -> Extreme:
    """The smallest tau."""
    return extremes(
        curve,
        lambda phi, side: touch(curve, phi, side).turn[0],
        lambda phi, side: touch(curve, phi, side).turn[1],
    ).smallest()


def contact_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes [mm] of the place of the contact along the face; tau must be positive."""
    return extremes(
        curve,
        lambda phi, side: touch(curve, phi, side).contact[0],
        lambda phi, side: touch(curve, phi, side).contact[1],
    )


def _distances(curve: PitchCurve) -> Extremes:
    """Extremes of h: where the follower turns, and where a rocker's face stands square."""

    def slopes(phi: FloatArray, side: Side) -> FloatArray:
        return np.stack((curve.motion.jet(phi, side)[1], touch(curve, phi, side).contact[0]))

    return extremes(curve, lambda phi, side: touch(curve, phi, side).distance, slopes)


def smallest_radius(curve: PitchCurve) -> Extreme:
    """The smallest rho = p / tau [mm] where its slope changes its sign; tau must be positive."""

    def radius(phi: FloatArray, side: Side) -> FloatArray:
        at = touch(curve, phi, side)
        return np.asarray(at.pace[0] / at.turn[0])

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        at = touch(curve, phi, side)
        return np.asarray(at.pace[1] * at.turn[0] - at.pace[0] * at.turn[1])

    return extremes(curve, radius, slope).smallest()


@in_blocks
def _pace_and_turn(curve: PitchCurve, phi: FloatArray, side: Side = "right") -> FloatArray:
    """(2, n) p and tau: near a cusp of a long flank cells are many."""
    at = touch(curve, phi, side)
    return np.stack((at.pace[0], at.turn[0]))


def _proved_radius(curve: PitchCurve) -> Extreme:
    """`smallest_radius`, or a cam angle that it misses where rho <= 0.

    Cells are halved until p is bounded away from 0 over each. |Z''| bounds |p'|.
    """
    found = smallest_radius(curve)
    if found[0] <= SMALLEST * curve.follower.base_radius:
        return found
    low, high = turn_cells(curve)
    for _ in range(HALVINGS):
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        pace, turn = _pace_and_turn(curve, middle)
        least = int(np.argmin(pace))
        if pace[least] <= 0.0:  # missed by every sample
            return float(pace[least] / turn[least]), float(middle[least])
        # Along a circle p is the same all over.
        near = np.isnan(centres_at(curve, middle))
        near &= pace <= half * curve.speed_bounds(low, high)[1]
        if not np.any(near):
            break
        low, high = halves(low, high, near)
    return found


def _jumps(curve: PitchCurve, least: float) -> tuple[Extreme, int]:
    """The worst jump of the contact along the outline: the largest one backwards, else forwards."""
    phi = ascending(np.append(curve.breaks, 0.0))
    before, after = (touch(curve, phi, side).contact[0] for side in ("left", "right"))
    gaps = joints(curve).gaps
    jumping = gaps > least
    if not np.any(jumping):
        return (0.0, 0.0), 0
    facing = flat_follower(curve.follower).facing
    # The outline runs along the face, to the right for sigma = +1: t = -i sigma n.
    ways = curve.rotation * facing * (after - before)
    worst = int(np.argmin(np.where(jumping, ways, np.inf)))
    if ways[worst] > 0.0:
        worst = int(np.argmax(np.where(jumping, ways, -np.inf)))
    return (float(ways[worst]), float(phi[worst])), int(np.count_nonzero(jumping))
