"""What stops a follower that is free: its only flank, or two walls with a clearance between them.

The walls of a roller in a groove are its flanks: on the inner one its centre runs on the parallel
of the pitch curve at half the clearance inwards, on the outer one at half of it outwards. Between
the discs of a conjugate pair they are the two discs: with the main roller on its disc the follower
makes the motion of the state, and the return disc gives way by the clearance along its normal. The
sides of a yoke run on one disc, half a turn apart: with q on the first one, the lift on the second
one exceeds q by the breadth b of the yoke minus the width w of the cam, if a positive lift moves
the first one outward (`camgeo.cam.breadth`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.cam.breadth import HALF, Breadth
from camgeo.curve.working_curve import WorkingCurve
from camgeo.effects.effect import Quantity, Subject
from camgeo.effects.touching import INNER, OUTER, leverage_of
from camgeo.mechanism.follower_path import path_of
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.outline.replay_lift import PlayedLift
from camgeo.units import TURN

LIFTS: Final = 3
"""Lift, velocity and acceleration."""


@dataclass(frozen=True, slots=True, eq=False)
class Wall:
    """A side that pushes the follower, and the motion of a follower that touches it.

    Attributes
    ----------
    sense : the side, see `camgeo.effects.touching`.
    motion : (3, n) lift with two derivatives [mm or rad per rad^k].
    leverage : (n,) force on q [1 or mm/rad] per unit of the force with which it pushes; it pushes
        in the direction of its sign.
    borders : (k,) cam angles [rad] in [0, 2 pi) where the formula of the motion changes.
    """

    sense: int
    motion: Quantity
    leverage: Quantity
    borders: FloatArray

    def outwards(self, angle: float) -> float:
        """Direction of q in which it pushes at one `angle` [rad], +1 or -1."""
        return float(np.sign(self.leverage(np.array([angle]), "right")[0]))


def of_state(subject: Subject, sense: int) -> Wall:
    """The flank `sense`, with the motion of the state."""

    def motion(phi: FloatArray, side: Side) -> FloatArray:
        return subject.state.motion.jet(phi, side, 2)[:LIFTS]

    def leverage(phi: FloatArray, side: Side) -> FloatArray:
        return leverage_of(subject, phi, side, sense)

    return Wall(sense, motion, leverage, subject.state.motion.borders)


def with_clearance(subject: Subject, clearance: float) -> tuple[Wall, Wall]:
    """The walls of a groove, or of a pair of discs, with a `clearance` [mm] above 0, or the two
    sides of a yoke, whose clearance follows from its breadth.

    Their motions raise GeometryError where the clearance is too large for the curves.
    """
    other, breadth = subject.returning, subject.cam.breadth
    if other is None:
        half = 0.5 * clearance
        return _played(subject, -half, INNER, INNER), _played(subject, half, OUTER, OUTER)
    if breadth is not None:
        return of_state(subject, INNER), _opposite(subject, breadth)
    return of_state(subject, INNER), _played(other, -clearance, OUTER, INNER)


def _opposite(subject: Subject, breadth: Breadth) -> Wall:
    """The second side of a yoke, on the disc half a turn on.

    b - h_0 - kappa_F q = h_0 + kappa_F s(phi + pi), q its lift.
    """
    cam, state = subject.cam, subject.state
    highest = breadth.reach * (cam.yoke_breadth - 2.0 * breadth.height)

    def motion(phi: FloatArray, side: Side) -> FloatArray:
        found = -state.motion.jet(phi + HALF, side, 2)[:LIFTS]
        found[0] += highest
        return np.asarray(found)

    def leverage(phi: FloatArray, side: Side) -> FloatArray:
        return -state.curve.leverage(phi + HALF, side)

    return Wall(OUTER, motion, leverage, (state.motion.borders + HALF) % TURN)


def _played(subject: Subject, distance: float, sense: int, flank: int) -> Wall:
    """The wall `sense`, the `flank` of its disc, with the roller's centre on the parallel at
    `distance` [mm] of its pitch curve.
    """
    cam = subject.cam
    curve = WorkingCurve(subject.state.curve, distance)
    lift = PlayedLift(path_of(cam.follower, cam.rotation), curve)

    def leverage(phi: FloatArray, side: Side) -> FloatArray:
        return flank * lift.leverage(phi, side)

    return Wall(sense, lift.jet, leverage, lift.borders)
