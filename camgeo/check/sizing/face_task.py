"""The conditions of a flat face on the place of the cam axis.

The face starts on the x axis of a guide, or at the height f = `face_offset` over it on a rocker,
whose pivot is the origin; the cam axis lies below it, mirrored if the face lies clockwise of the
line pivot -> cam axis. So a place is -i r_G on a guide and P = l_1 exp(-i chi_0) = x - i y on a
rocker, r_G = f + y.

With theta the angle by which the rocker has turned, tau = 1 - sigma m theta' and w = 1/tau (see
`camgeo.mechanism.face`), all conditions are linear in the place:

- distance of the face from the axis: h = f + x sin theta + y cos theta > 0;
- its lever about the pivot: q = w (x cos theta - y sin theta) >= tan mu |f|, and above 0;
- radius of curvature: p = f tau + x ((2 - w) sin theta + w^2 theta'' cos theta)
  + y ((2 - w) cos theta - w^2 theta'' sin theta) >= rho tau.

On a guide h = r_G + kappa_F s and p = h + kappa_F s'', so that r_G >= rho - kappa_F (s + s''), and
the transmission angle is always 90 degrees. On a rocker the pivot is kept; each condition leaves
an arc of chi_0. tau > 0 and a velocity without jumps do not depend on the place.
"""

from __future__ import annotations

import cmath
import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.sizing.placing import Placing, Rocking
from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.oscillating_flat import OscillatingFlat
from camgeo.mechanism.translating_flat import TranslatingFlat
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.outline.convex import SMALLEST, touch
from camgeo.units import TURN

Rows = tuple[FloatArray, FloatArray, FloatArray]
"""a, b, c (n,) of conditions a x + b y >= c."""

CONVEX, OVER_AXIS, LEVER = "convexity", "face-over-axis", "transmission-angle"
"""Names of the conditions."""

INSET = 1e-9
"""Angle [rad] by which a rocker's face stays off the line through pivot and cam axis."""

SLACK = 1e-14
"""An angle [rad] this close to the end of an arc lies on it."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What is required of a flat face.

    Attributes
    ----------
    tangent : of the transmission angle.
    radius : smallest radius of curvature of the outline [mm], above 0.
    clearance : smallest distance of the face from the cam axis [mm], above 0.
    """

    tangent: float
    radius: float
    clearance: float


class FaceTask(Placing):
    """A cam with a flat face, whose axis is to be placed beside it, see `face_task_of`.

    Attributes
    ----------
    names : of its conditions, see `slack`.
    """

    __slots__ = ()

    names: ClassVar[tuple[str, ...]]

    def asked(self, angle: float, radius: float) -> Asked:
        """What is required: a transmission angle [rad] and a radius of curvature [mm], see
        `size_for_face`; a cam with a cusp, or one that touches its axis, is excluded.
        """
        least = 2.0 * SMALLEST * (self.follower.base_radius + abs(self.present))
        return Asked(math.tan(angle), max(radius, least), least)

    @property
    def top(self) -> float:
        """Height of the face in its starting position [mm], see the module."""
        return self.base_radius_at(0j)

    @abstractmethod
    def lever(self, asked: Asked) -> float:
        """Smallest position of the contact [mm] along the face."""

    @abstractmethod
    def rows(self, name: str, phi: FloatArray, side: Side, asked: Asked) -> Rows:
        """The condition `name` at `phi` (n,) [rad]."""

    @abstractmethod
    def lowest(self, known: Rows) -> complex | None:
        """The place with the smallest base circle that meets `known`; None if there is none."""

    def slack(self, curve: PitchCurve, name: str, asked: Asked) -> Extremes:
        """Local extremes over the turn of the margin of the condition `name` [mm]."""
        lever = self.lever(asked)

        def value(phi: FloatArray, side: Side) -> FloatArray:
            at = touch(curve, phi, side)
            if name == CONVEX:
                return np.asarray(at.pace[0] - asked.radius * at.turn[0])
            if name == OVER_AXIS:
                return np.asarray(at.distance - asked.clearance)
            return np.asarray(at.contact[0] - lever)

        def slopes(phi: FloatArray, side: Side) -> FloatArray:
            at = touch(curve, phi, side)
            if name == CONVEX:
                return np.asarray(at.pace[1] - asked.radius * at.turn[1])
            if name == OVER_AXIS:  # where the follower turns, and where the face stands square
                return np.stack((curve.motion.jet(phi, side)[1], at.contact[0]))
            return np.asarray(at.contact[1])

        return extremes(curve, value, slopes)


class FaceOnGuide(FaceTask):
    """On a guide: the base radius alone is to be found."""

    __slots__ = ()

    second = "offset"
    held = None
    seen = (1, 1)
    names = (CONVEX, OVER_AXIS)

    @property
    def present(self) -> complex:
        """See `Placing`."""
        return complex(0.0, -self.follower.base_radius)

    def second_of(self, _: complex) -> float:
        """See `Placing`: where the guide lies does not matter."""
        return 0.0

    def base_radius_at(self, place: complex) -> float:
        """See `Placing`."""
        return -place.imag

    def moved(self, _: complex) -> dict[str, float | complex]:
        """See `Placing`."""
        return {}

    def lever(self, _: Asked) -> float:
        """See `FaceTask`: it moves on its guide wherever it is pushed."""
        return -math.inf

    def rows(self, name: str, phi: FloatArray, side: Side, asked: Asked) -> Rows:
        """See `FaceTask`."""
        lift = self.follower.direction * self.motion.jet(phi, side, 2)
        none, one = np.zeros(len(phi)), np.ones(len(phi))
        if name == CONVEX:
            return none, one, asked.radius - (lift[0] + lift[2])
        return none, one, asked.clearance - lift[0]

    def lowest(self, known: Rows) -> complex | None:
        """See `FaceTask`."""
        return complex(0.0, -float(np.max(known[2])))


class FaceOnRocker(Rocking, FaceTask):
    """On a rocker, whose pivot is kept: the base radius is to be found."""

    __slots__ = ()

    names = (CONVEX, OVER_AXIS, LEVER)

    def base_radius_at(self, place: complex) -> float:
        """See `Placing`."""
        radius: float = self.follower.face_offset - place.imag
        return radius

    def moved(self, _: complex) -> dict[str, float | complex]:
        """See `Placing`."""
        return {}

    def lever(self, asked: Asked) -> float:
        """See `FaceTask`."""
        offset: float = self.follower.face_offset
        return max(asked.tangent * abs(offset), asked.clearance)

    def rows(self, name: str, phi: FloatArray, side: Side, asked: Asked) -> Rows:
        """See `FaceTask`."""
        follower = self.follower
        lift = follower.arm_side * follower.swing_sense * self.motion.jet(phi, side, 2)
        sine, cosine = np.sin(lift[0]), np.cos(lift[0])
        if name == OVER_AXIS:
            return sine, cosine, np.full(len(phi), asked.clearance - follower.face_offset)
        turn = 1.0 - self.cam.rotation * follower.arm_side * lift[1]
        w = 1.0 / turn
        if name == LEVER:
            return w * cosine, -w * sine, np.full(len(phi), self.lever(asked))
        bent = w * w * lift[2]
        return (
            (2.0 - w) * sine + bent * cosine,
            (2.0 - w) * cosine - bent * sine,
            (asked.radius - follower.face_offset) * turn,
        )

    def lowest(self, known: Rows) -> complex | None:
        """See `FaceTask`: the smallest chi_0 inside the arcs of all conditions."""
        a, b, c = known
        distance = self.follower.centre_distance
        size = distance * np.hypot(a, b)
        if np.any(c > size):
            return None
        middle = np.arctan2(b, a)
        share = np.divide(c, size, out=np.full_like(c, -1.0), where=size > 0.0)
        half = np.arccos(np.clip(share, -1.0, 1.0))
        low = INSET - 0.5 * math.pi
        # At most once to the beginning of each arc: the angle only grows.
        for _ in range(len(a) + 1):
            before = np.remainder(low - middle + half, TURN)  # beyond the beginning of the arc
            outside = (before > 2.0 * half + SLACK) & (TURN - before > SLACK)
            if not np.any(outside):
                return cmath.rect(distance, -low)
            low += float(np.max(TURN - before[outside]))
            if low > 0.5 * math.pi - INSET:
                return None
        return None


TASKS: Final[dict[type[Follower], type[FaceTask]]] = {
    TranslatingFlat: FaceOnGuide,
    OscillatingFlat: FaceOnRocker,
}
"""The task by the class of the follower."""


def face_task_of(cam: Cam) -> FaceTask:
    """The task of placing the axis of `cam`, which has a flat face."""
    return TASKS[type(cam.follower)](cam)
