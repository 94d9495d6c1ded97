"""A roller with play, pressed against one flank of its groove: the lift that it really makes.

The roller touches the flank, which lies half the groove's width from the pitch curve, so that its
centre runs on the pitch curve's parallel at half the clearance. At the cam angle phi it touches
the flank where the demanded motion would touch it at another cam angle theta: the one at which the
follower's path at phi meets the parallel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.follower_path import Bows, FollowerPath, lift_jet
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.outline.path import Path
from camgeo.outline.replay_course import AS_DEMANDED, Course
from camgeo.outline.roller_path import branches, circles
from camgeo.units import TURN

STEPS = 40
"""Newton steps at most; the parallel is near the pitch curve, so that five are many."""

SETTLED = 64.0 * 2.0**-52
"""A last step [rad] below this, a few roundings of a cam angle, and theta is found."""

LONGEST = 0.2
"""Longest Newton step [rad]."""

AT = 1e-9
"""This near to a break [rad] theta counts as the break, seen from the side that is asked for."""


@dataclass(frozen=True)
class PlayedLift:
    """The lift of a roller whose centre runs on a parallel of the pitch curve.

    Attributes
    ----------
    path : of the follower.
    parallel : the curve of the roller centres: the pitch curve's parallel at -c/2 for a roller on
        the inner flank of a groove with the clearance c, at +c/2 on the outer one. Regular, and
        without corners.
    """

    path: FollowerPath
    parallel: WorkingCurve

    @cached_property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] in [0, 2 pi) at which the roller passes breaks of the curve."""
        angles, _ = self.path.cam_angle_of(self.parallel.point(self.parallel.breaks))
        return ascending(angles)

    def jet(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(3, n) lift with two derivatives [mm or rad per rad^k] at `phi` (n,) [rad].

        The path meets the circle of curvature of the parallel there as it does the parallel itself
        up to the second order.

        Raises
        ------
        GeometryError
            If the path does not meet the parallel near by, or is tangent to it.
        """
        theta = self.touching(phi)
        at = self._at_breaks(theta)
        points, tangents, _ = self.parallel.traced(at, side)
        normals = 1j * self.parallel.pitch.rotation * tangents
        _, q = self.path.cam_angle_of(points)
        return lift_jet(self.path, phi, q, Bows(points, normals, self.parallel.curvature(at, side)))

    def touching(self, phi: FloatArray) -> FloatArray:
        """(n,) theta [rad] at `phi` (n,) [rad], by Newton's method; raises as `jet`."""
        theta = np.asarray(phi, dtype=np.float64)
        for _ in range(STEPS):
            points, tangents, pace = self.parallel.traced(theta)
            angles, q = self.path.cam_angle_of(points)
            # Along the parallel dZ = (Z_phi) dphi + (Z_q) dq; the part across the path is dphi's.
            across = np.conj(self.path.along(angles, q)[0])
            turning = (across * (-1j * self.path.rotation) * points).imag
            rate = (across * tangents).imag * pace
            if np.any(rate * turning <= 0.0):
                break
            away = np.remainder(phi - angles + math.pi, TURN) - math.pi
            step = np.clip(away * turning / rate, -LONGEST, LONGEST)
            theta = theta + step
            if np.max(np.abs(step), initial=0.0) <= SETTLED * TURN:
                return theta
        raise GeometryError(
            "the play is too large to be followed: the follower's path does not meet the curve of"
            " the roller centre on that flank near by"
        )

    def _at_breaks(self, theta: FloatArray) -> FloatArray:
        """`theta` in one turn, on the breaks themselves where it is there to rounding."""
        breaks = np.append(self.parallel.breaks, self.parallel.breaks[:1] + TURN)
        turned = np.remainder(theta, TURN)
        above = np.searchsorted(breaks, turned)
        for index in (above - 1, np.minimum(above, len(breaks) - 1)) if len(breaks) else ():
            near = np.abs(turned - breaks[index]) <= AT
            turned = np.where(near, breaks[index], turned)
        return np.where(turned >= TURN, turned - TURN, turned)


def course_with_play(
    pitch: PitchCurve, outline: Path, path: FollowerPath, press: int, clearance: float
) -> Course:
    """The course of a roller with play, pressed against a flank of its groove.

    Parameters
    ----------
    outline : the flank.
    press : -1 if the roller is pressed inward, +1 if outward.
    clearance : groove's width less the roller's diameter [mm], above 0.

    Raises
    ------
    GeometryError
        If the flank is trimmed or has a corner.
    """
    if not outline.is_whole:
        raise GeometryError(
            "the flank is trimmed or has a corner, and the groove has side clearance: replay a"
            " drawing of it"
        )
    played = PlayedLift(path, WorkingCurve(pitch, 0.5 * press * clearance))
    none = branches(circles(np.empty(0, dtype=np.complex128), 1.0), path)
    return Course(path, pitch.motion, none, np.zeros(1), np.full(1, AS_DEMANDED), played)
