"""What is to be sized, and the conditions that a place of the cam axis has to meet.

The place is a complex number P [mm] in axes in which the follower starts at a fixed point:

- translating: P = e - i s_G, roller centre at cam angle 0 in the origin, guide upwards, mirrored so
  that a positive offset is positive;
- oscillating: P = l_1 exp(-i psi_G), pivot in the origin, the arm at cam angle 0 along the x axis,
  mirrored if the arm lies clockwise of the line pivot -> cam axis.

With a = r P, r = 1 for a guide and exp(-i psi) for a rocker, the parts of Z' across and along the
follower are u = p - Im a, v = q - Re a (Wirsig section 3.3.4), linear in P. A transmission angle of
at least mu is u >= T v and u >= -T v, T = tan mu: two half-planes at each cam angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.sizing.places import Places, Terms, at_place, places_of
from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.motion.motion import Motion, Side
from camgeo.numeric.arrays import ComplexArray, FloatArray

SIDES: Final[tuple[Side, ...]] = ("right", "left")


@dataclass(frozen=True, slots=True)
class Task:
    """A cam whose axis is to be placed.

    Attributes
    ----------
    cam : the present design; the follower's arm, roller radius and directions are kept.

    Raises
    ------
    GeometryError
        With the key of its kind, if the follower has no roller.
    """

    cam: Cam

    def __post_init__(self) -> None:
        places_of(self.cam.follower)

    @property
    def motion(self) -> Motion:
        """The follower's own motion [mm or rad]."""
        return self.cam.drive.motion

    @property
    def follower(self) -> Any:
        """The follower of the present design."""
        return self.cam.follower

    @property
    def places(self) -> Places:
        """Where the cam axis may be placed beside it."""
        return places_of(self.cam.follower)

    @property
    def start(self) -> complex:
        """Roller centre at cam angle 0 [mm]."""
        return self.places.start

    @property
    def present(self) -> complex:
        """Place of the cam axis in the present design [mm]."""
        return self.places.present

    def follower_at(self, place: complex) -> Any:
        """The follower with the cam axis at `place` [mm], see `at_place`."""
        return at_place(self.cam.follower, self.places, place)

    def pitch_curve_at(self, place: complex) -> PitchCurve:
        """The pitch curve with the cam axis at `place` [mm]."""
        return PitchCurve(self.motion, self.follower_at(place), self.cam.rotation)

    def terms(self, phi: FloatArray, side: Side = "right") -> Terms:
        """What the conditions are made of at `phi` (n,) [rad]."""
        return self.places.terms(self.motion.jet(phi, side, 2), self.cam.rotation)

    def slack(self, place: complex, tangent: float) -> Extremes:
        """Local extremes of u - `tangent` v [mm/rad] over the turn, by the roots of its slope."""

        def value(phi: FloatArray, side: Side) -> FloatArray:
            u, v = self.terms(phi, side).across_and_along(place)
            return np.asarray(u - tangent * v)

        def slope(phi: FloatArray, side: Side) -> FloatArray:
            terms = self.terms(phi, side)
            seen = terms.turn * place
            u1 = terms.p1 + terms.turning * seen.real
            v1 = terms.q1 - terms.turning * seen.imag
            return np.asarray(u1 - tangent * v1)

        return extremes(self.motion, value, slope)

    def half_planes(self, phi: FloatArray, tangent: float) -> tuple[ComplexArray, FloatArray]:
        """Normals n (k,) and c (k,) of u >= `tangent` v, which is Re(conj(n) P) >= c.

        Of both sides of each of the cam angles `phi` (k / 2,) [rad].
        """
        normals, bounds = [], []
        for side in SIDES:
            terms = self.terms(phi, side)
            normals.append(np.conj((tangent + 1j) * terms.turn))
            bounds.append(tangent * terms.q - terms.p)
        return np.concatenate(normals), np.concatenate(bounds)


def tangent_of(angle: float) -> float:
    """T = tan mu of a transmission angle [rad] in (0, pi/2)."""
    return math.tan(angle)
