"""The smallest base circle for a flat face: its conditions on the place of the cam axis.

The face starts on the x axis of a guide, or at the height f = `face_offset` over it on a rocker,
whose pivot is the origin; the cam axis lies below it, mirrored if the face lies clockwise of the
line pivot -> cam axis. So a place is -i r_G on a guide and P = l_1 exp(-i chi_0) = x - i y on a
rocker, r_G = f + y.

With theta the angle by which the rocker has turned, tau = 1 - sigma m theta' and w = 1/tau (see
`camgeo.kinematics.mechanism.flat`), all conditions are linear in the place:

- distance of the face from the axis: h = f + x sin theta + y cos theta > 0;
- its lever about the pivot: q = w (x cos theta - y sin theta) >= tan mu |f|, and above 0;
- radius of curvature: p = f tau + x ((2 - w) sin theta + w^2 theta'' cos theta)
  + y ((2 - w) cos theta - w^2 theta'' sin theta) >= rho tau.

On a guide h = r_G + kappa_F s and p = h + kappa_F s'', so that r_G >= rho - kappa_F (s + s''), and
the transmission angle is always 90 degrees. On a rocker the pivot is kept; each condition leaves an
arc of chi_0. tau > 0 and a velocity without jumps do not depend on the place.
"""

from __future__ import annotations

import cmath
import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.disc import check_convexity, transmission_angle_extremes
from camgeo.check.sizing.smallest import CLOSE, MOST, Active, Rating, Sizing, require_angle
from camgeo.check.sizing.task import Placing, RockerPlacing
from camgeo.errors import GeometryError
from camgeo.geometry.pieces import (
    SMALLEST,
    Extremes,
    contact_extremes,
    convexity,
    extremes,
    smallest_radius,
    smallest_turn,
    touch,
)
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import SIDES, FloatArray, Side
from camgeo.numeric.extremes import Extreme
from camgeo.units import TURN

Rows = tuple[FloatArray, FloatArray, FloatArray]
"""a, b, c (n,) of conditions a x + b y >= c."""

CONVEX, FACE_OVER_AXIS, LEVER = "convexity", "face-over-axis", "transmission-angle"
"""Names of the conditions."""

INSET = 1e-9
"""Angle [rad] by which a rocker's face stays off the line through pivot and cam axis."""

SLACK = 1e-14
"""An angle [rad] this close to the end of an arc lies on it."""


@dataclass(frozen=True, slots=True)
class FaceLimits:
    """The limits that a flat face must keep.

    Attributes
    ----------
    tangent : tangent of the smallest transmission angle.
    radius : smallest radius of curvature of the outline [mm], above 0.
    clearance : smallest distance of the face from the cam axis [mm], above 0.
    """

    tangent: float
    radius: float
    clearance: float


class FaceTask(Placing):
    """A cam with a flat face, whose axis is to be placed beside it, see `FaceTask.from_cam`.

    Attributes
    ----------
    names : names of the conditions, see `slack`.
    """

    __slots__ = ()

    names: ClassVar[tuple[str, ...]]

    def required_limits(self, angle: float, radius: float) -> FaceLimits:
        """The limits for a transmission angle [rad] and a radius of curvature [mm], see `size`.

        The radius is raised so that a cam with a cusp is excluded, and so is a face on the axis.
        """
        least = 2.0 * SMALLEST * (self.follower.base_radius + abs(self.present))
        return FaceLimits(math.tan(angle), max(radius, least), least)

    def moved(self, _: complex) -> dict[str, float | complex]:
        """See `Placing`: guide and pivot are kept, so no other length follows from the place."""
        return {}

    @property
    def top(self) -> float:
        """Height of the face in its starting position [mm], see the module."""
        return self.base_radius(0j)

    @abstractmethod
    def lever(self, limits: FaceLimits) -> float:
        """Smallest allowed position of the contact [mm] along the face."""

    @abstractmethod
    def rows(self, name: str, phi: FloatArray, side: Side, limits: FaceLimits) -> Rows:
        """The condition `name` at `phi` (n,) [rad]."""

    @abstractmethod
    def lowest(self, known: Rows) -> complex | None:
        """The place with the smallest base circle that meets `known`; None if there is none."""

    def slack(self, curve: PitchCurve, name: str, limits: FaceLimits) -> Extremes:
        """Local extremes over the turn of the margin of the condition `name` [mm]."""
        lever = self.lever(limits)

        def value(phi: FloatArray, side: Side) -> FloatArray:
            contact = touch(curve, phi, side)
            if name == CONVEX:
                return np.asarray(contact.pace[0] - limits.radius * contact.turn[0])
            if name == FACE_OVER_AXIS:
                return np.asarray(contact.distance - limits.clearance)
            return np.asarray(contact.contact[0] - lever)

        def slopes(phi: FloatArray, side: Side) -> FloatArray:
            contact = touch(curve, phi, side)
            if name == CONVEX:
                return np.asarray(contact.pace[1] - limits.radius * contact.turn[1])
            if name == FACE_OVER_AXIS:  # where the follower turns, and where the face stands square
                return np.stack((curve.motion.jet(phi, side)[1], contact.contact[0]))
            return np.asarray(contact.contact[1])

        return extremes(curve, value, slopes)

    @staticmethod
    def from_cam(cam: Cam) -> FaceTask:
        """The task of placing the axis of `cam`, which has a flat face."""
        return FACE_TASKS[type(cam.follower)](cam)

    def rate_place(self, place: complex) -> Rating | None:
        """The rating of the cam with its axis at `place`; None if there is no such mechanism, or
        its face turns back in the cam.
        """
        try:
            curve = self.pitch_curve(place)
            if smallest_turn(curve)[0] <= 0.0:
                return None
            angle = transmission_angle_extremes(curve).smallest()
            contact = contact_extremes(curve)
        except GeometryError:
            return None
        bend = smallest_radius(curve)
        ends = Extreme(*contact.smallest()), Extreme(*contact.largest())
        none = Extreme(0.0, 0.0)
        return Rating(place, curve.follower, Extreme(*angle), none, Extreme(*bend), ends)

    def size(self, angle: float, radius: float) -> Sizing:
        """The smallest base circle for a flat face.

        Parameters
        ----------
        angle : smallest transmission angle mu [rad], in (0, pi/2).
        radius : smallest radius of curvature of the outline [mm], 0 for any convex one.

        Raises
        ------
        GeometryError
            If one of them is out of range, or the follower does not move.
        """
        require_angle(angle)
        if not 0.0 <= radius < math.inf:
            key = "radius_of_curvature"
            raise GeometryError("must be a length, 0 or more", key=key, value=f"{radius:g}")
        low, high = lift_range(self.motion)
        if low == high:
            raise GeometryError(
                "there is nothing to size: the follower does not move", key="motion"
            )
        limits = self.required_limits(angle, radius)
        hopeless = _hopeless(self)
        place, active = (None, ()) if hopeless else smallest_for_face(self, limits)
        answer = None if place is None else self.rate_place(place)
        none_below = math.inf if answer is None else answer.base_radius
        return Sizing(
            angle,
            ratio=1.0,
            answer=answer,
            active=active,
            none_below=none_below,
            radius=radius,
            hopeless=hopeless,
        )


class FaceOnGuide(FaceTask):
    """A flat face on a guide, of which only the base radius is sized."""

    __slots__ = ()

    second = "offset"
    held = None
    seen = (1, 1)
    names = (CONVEX, FACE_OVER_AXIS)

    @property
    def present(self) -> complex:
        """See `Placing`."""
        return complex(0.0, -self.follower.base_radius)

    def second_length(self, _: complex) -> float:
        """See `Placing`: where the guide lies does not matter."""
        return 0.0

    def base_radius(self, place: complex) -> float:
        """See `Placing`."""
        return -place.imag

    def lever(self, _: FaceLimits) -> float:
        """See `FaceTask`: a follower on a guide moves wherever its face is pushed."""
        return -math.inf

    def rows(self, name: str, phi: FloatArray, side: Side, limits: FaceLimits) -> Rows:
        """See `FaceTask`."""
        lift = self.follower.direction * self.motion.jet(phi, side, 2)
        none, one = np.zeros(len(phi)), np.ones(len(phi))
        if name == CONVEX:
            return none, one, limits.radius - (lift[0] + lift[2])
        return none, one, limits.clearance - lift[0]

    def lowest(self, known: Rows) -> complex | None:
        """See `FaceTask`."""
        return complex(0.0, -float(np.max(known[2])))


class FaceOnRocker(RockerPlacing, FaceTask):
    """A flat face on a rocker with a given pivot, of which only the base radius is sized."""

    __slots__ = ()

    names = (CONVEX, FACE_OVER_AXIS, LEVER)

    def base_radius(self, place: complex) -> float:
        """See `Placing`."""
        return float(self.follower.face_offset - place.imag)

    def lever(self, limits: FaceLimits) -> float:
        """See `FaceTask`."""
        offset: float = self.follower.face_offset
        return max(limits.tangent * abs(offset), limits.clearance)

    def rows(self, name: str, phi: FloatArray, side: Side, limits: FaceLimits) -> Rows:
        """See `FaceTask`."""
        follower = self.follower
        lift = follower.arm_side * follower.swing_sense * self.motion.jet(phi, side, 2)
        sine, cosine = np.sin(lift[0]), np.cos(lift[0])
        # The conditions of the module, with all that does not depend on x and y on the right.
        if name == FACE_OVER_AXIS:
            return sine, cosine, np.full(len(phi), limits.clearance - follower.face_offset)
        turn = 1.0 - self.cam.rotation * follower.arm_side * lift[1]
        w = 1.0 / turn
        if name == LEVER:
            return w * cosine, -w * sine, np.full(len(phi), self.lever(limits))
        bent = w * w * lift[2]
        return (
            (2.0 - w) * sine + bent * cosine,
            (2.0 - w) * cosine - bent * sine,
            (limits.radius - follower.face_offset) * turn,
        )

    def lowest(self, known: Rows) -> complex | None:
        """See `FaceTask`: the smallest chi_0 inside the arcs of all conditions."""
        a, b, c = known
        distance = self.follower.centre_distance
        size = distance * np.hypot(a, b)
        if np.any(c > size):
            return None
        # With P = l_1 exp(-i chi_0) a condition is cos(chi_0 - middle) >= c / (l_1 |(a, b)|): an
        # arc of half width arccos of that. Without a and b it holds everywhere.
        middle = np.arctan2(b, a)
        share = np.divide(c, size, out=np.full_like(c, -1.0), where=size > 0.0)
        half = np.arccos(np.clip(share, -1.0, 1.0))
        low = INSET - 0.5 * math.pi
        # At most once to the beginning of each arc: the angle only grows.
        for _ in range(len(a) + 1):
            past = np.remainder(low - middle + half, TURN)  # beyond the beginning of the arc
            outside = (past > 2.0 * half + SLACK) & (TURN - past > SLACK)
            if not np.any(outside):
                return cmath.rect(distance, -low)
            low += float(np.max(TURN - past[outside]))
            if low > 0.5 * math.pi - INSET:
                return None
        return None


FACE_TASKS: Final[dict[type[Follower], type[FaceTask]]] = {
    TranslatingFlat: FaceOnGuide,
    OscillatingFlat: FaceOnRocker,
}
"""The task by the class of the follower."""


# -- faces ----------------------------------------------------------------------------------------
# By exchange, from below, as for the transmission angle.
#
# The place with the smallest base circle that meets some conditions is determined, those that it
# breaks most are added, and so on until none is broken, see `camgeo.check.sizing.smallest`. On a
# rocker that place is the smallest chi_0 that the arcs of all conditions have in common. So the
# answer is exact.


JUMP = "contact-jump"
"""Name of the finding on a velocity jump under a flat face."""

ACTIVE_SHARE = 1e-9
"""A condition this close to its limit, as a fraction of the size of its terms, is active."""

ENLARGED = 1e-5
"""Fraction by which a cam is enlarged to prove that no extreme was missed."""


def _hopeless(task: FaceTask) -> str | None:
    """Why no size will do: the linkage, a face that turns back, or a velocity jump; else None."""
    if task.hopeless is not None:
        return task.hopeless
    curve = task.pitch_curve(task.present)
    findings = check_convexity(curve)
    if smallest_turn(curve)[0] <= 0.0:
        return findings[0].sentence
    return next((finding.sentence for finding in findings if finding.name == JUMP), None)


def smallest_for_face(
    task: FaceTask, limits: FaceLimits
) -> tuple[complex | None, tuple[Active, ...]]:
    """The place with the smallest base circle that keeps the `limits`, and what decides it.

    None if there is no such place. tau must be positive over the turn, and the velocity without
    jumps.
    """
    known: Rows = task.rows(FACE_OVER_AXIS, np.zeros(1), "right", limits)
    place = task.lowest(known)
    for _ in range(MOST):
        if place is None:
            return None, ()
        curve = task.pitch_curve(place)
        broken, active = False, []
        for name in task.names:
            margins = task.slack(curve, name, limits)
            size = CLOSE * (abs(place) + task.base_radius(place))
            worst = margins.values < -size
            active += [
                Active(name, float(phi) % TURN)
                for phi in margins.phi[np.abs(margins.values) <= ACTIVE_SHARE * size / CLOSE]
            ]
            if np.any(worst):
                broken = True
                for side in SIDES:
                    known = _joined(known, task.rows(name, margins.phi[worst], side, limits))
        if not broken:
            missed = _missed(task, place)
            if missed is None:
                return place, tuple(active)
            known = _joined(known, task.rows(CONVEX, np.array([missed]), "right", limits))
        # Where the new conditions do not move the place, it breaks them by rounding only.
        previous, place = place, task.lowest(known)
        if place == previous:
            return place, tuple(active)
    return None, ()


def _missed(task: FaceTask, place: complex) -> float | None:
    """Cam angle [rad] of a cusp or undercut that `slack` misses; None without one, as is usual.

    It is looked for in a cam larger by the fraction `ENLARGED`: close to a cusp the proof takes
    ever smaller cells.
    """
    try:
        cam = task.cam.sized(base_radius=(1.0 + ENLARGED) * task.base_radius(place))
    except GeometryError:  # the face stands square to the line of centres
        return None
    shape = convexity(cam.disc.pitch_curve)
    return None if shape.is_convex else shape.radius[1]


def _joined(one: Rows, other: Rows) -> Rows:
    a, b, c = (np.concatenate(columns) for columns in zip(one, other, strict=True))
    return a, b, c
