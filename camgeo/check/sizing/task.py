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

import cmath
import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.kinds import RollerFollower, require_roller
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.motion.motion import Motion, Side
from camgeo.numeric.arrays import ComplexArray, FloatArray

SIDES: Final[tuple[Side, ...]] = ("right", "left")


@dataclass(frozen=True, slots=True, eq=False)
class Terms:
    """What u, v and the curvature are made of at n cam angles, see the module.

    Attributes
    ----------
    p, q : (n,) [mm/rad].
    turn : (n,) complex r, of magnitude 1.
    alpha, beta : (n,) [mm/rad^2]; |Z'|^3 kappa = |Z'|^2 - alpha u + beta v.
    p1, q1, turning : (n,) dp/dphi, dq/dphi, and d(-arg r)/dphi.
    """

    p: FloatArray
    q: FloatArray
    turn: ComplexArray
    alpha: FloatArray
    beta: FloatArray
    p1: FloatArray
    q1: FloatArray
    turning: FloatArray

    def across_and_along(self, place: complex | ComplexArray) -> tuple[FloatArray, FloatArray]:
        """u, v [mm/rad] for one place, or (k, n) for places (k, 1)."""
        seen = self.turn * place
        return self.p - seen.imag, self.q - seen.real

    def curvature(self, place: complex | ComplexArray) -> FloatArray:
        """kappa [1/mm], shape as of `across_and_along`; Z' must not vanish."""
        u, v = self.across_and_along(place)
        square = u * u + v * v
        kappa: FloatArray = (square - self.alpha * u + self.beta * v) / (square * np.sqrt(square))
        return kappa


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
        require_roller(self.cam.follower)

    @property
    def motion(self) -> Motion:
        """The follower's own motion [mm or rad]."""
        return self.cam.drive.motion

    @property
    def follower(self) -> RollerFollower:
        """The follower of the present design."""
        return require_roller(self.cam.follower)

    @property
    def start(self) -> complex:
        """Roller centre at cam angle 0 [mm]."""
        follower = self.follower
        return complex(follower.arm) if isinstance(follower, OscillatingRoller) else 0j

    @property
    def present(self) -> complex:
        """Place of the cam axis in the present design [mm]."""
        follower = self.follower
        if isinstance(follower, OscillatingRoller):
            return cmath.rect(follower.centre_distance, -follower.start_angle)
        return complex(follower.offset, -follower.start_height)

    def follower_at(self, place: complex) -> RollerFollower:
        """The follower with the cam axis at `place` [mm].

        An oscillating one keeps the direction in which the pivot lies. Raises GeometryError if
        there is no such mechanism.
        """
        base = abs(place - self.start)
        if isinstance(self.follower, OscillatingRoller):
            away = self.follower.pivot / self.follower.centre_distance
            return replace(self.follower, base_radius=base, pivot=away * abs(place))
        return replace(self.follower, base_radius=base, offset=place.real)

    def pitch_curve_at(self, place: complex) -> PitchCurve:
        """The pitch curve with the cam axis at `place` [mm]."""
        return PitchCurve(self.motion, self.follower_at(place), self.cam.rotation)

    def terms(self, phi: FloatArray, side: Side = "right") -> Terms:
        """What the conditions are made of at `phi` (n,) [rad]."""
        lift = self.motion.jet(phi, side, 2)
        follower = self.follower
        one, none = np.ones(len(phi), dtype=np.complex128), np.zeros(len(phi))
        if isinstance(follower, OscillatingRoller):
            sense = follower.arm_side * follower.swing_sense
            rotation, arm = follower.arm_side * self.cam.rotation, follower.arm
            angle, rate, bend = sense * lift[0], sense * lift[1], sense * lift[2]
            along = rotation * rate
            q = arm * (1.0 - along)
            return Terms(
                none, q, np.exp(-1j * angle), arm * bend, -along * q,
                none, -arm * rotation * bend, rate,
            )  # fmt: skip
        height, rate, bend = follower.direction * lift[:3]
        q = self.cam.rotation * rate
        return Terms(height, q, one, bend, q, rate, self.cam.rotation * bend, none)

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
