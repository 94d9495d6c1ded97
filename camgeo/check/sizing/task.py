"""What is to be sized, and the conditions that a place of the cam axis must meet.

The place is a complex number P [mm] in axes in which the follower starts at a fixed point:

- translating: P = e - i s_G, roller centre at cam angle 0 in the origin, guide upwards, mirrored so
  that a positive offset is positive;
- oscillating: P = l_1 exp(-i psi_G), pivot in the origin, the arm at cam angle 0 along the x axis,
  mirrored if the arm lies clockwise of the line pivot -> cam axis.

With a = r P, r = 1 for a guide and exp(-i psi) for a rocker, the parts of Z' across and along the
follower are u = p - Im a, v = q - Re a (Wirsig section 3.3.4), linear in P. A transmission angle of
at least mu is u >= T v and u >= -T v, T = tan mu: two half-planes at each cam angle.

Turned with the cam, the roller centre is (B - P) exp(-i sense phi), B its place in those axes.
"""

from __future__ import annotations

import cmath
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.finding import Limits, forbidding
from camgeo.check.judge import linkage_findings
from camgeo.errors import GeometryError
from camgeo.geometry.outline.convex import SMALLEST, touch
from camgeo.geometry.outline.outline import find_crossings
from camgeo.geometry.pieces import Extremes, extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.motion import Jet, Motion
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, Side, joined, taken
from camgeo.units import TURN

# -- placing --------------------------------------------------------------------------------------
# A cam whose axis is to be placed beside its follower, whatever touches the cam.
#
# A place is a complex number [mm] in axes in which the follower starts in a fixed position, which
# each kind states.


@dataclass(frozen=True, slots=True)
class Placing(ABC):
    """See the module.

    Attributes
    ----------
    cam : the present design; all dimensions of the follower that are not placed are kept.
    second : the quantity that, with the base radius, determines a place.
    held : the pivot [mm]; None on a guide.
    present : place of the cam axis in the present design [mm].
    seen : signs of x and y in a picture for the real and the imaginary part of a place.
    """

    cam: Cam

    second: ClassVar[str]
    held: ClassVar[complex | None]

    if TYPE_CHECKING:  # that every kind has

        @property
        def seen(self) -> tuple[int, int]: ...

    @property
    @abstractmethod
    def present(self) -> complex:
        """See the class."""

    @abstractmethod
    def second_of(self, place: complex) -> float:
        """The `second` quantity [mm] at `place`."""

    @abstractmethod
    def base_radius_at(self, place: complex) -> float:
        """r_G [mm] with the cam axis at `place`."""

    @abstractmethod
    def moved(self, place: complex) -> dict[str, float | complex]:
        """Values [mm] of the follower, by its scene's keys, with the cam axis at `place`."""

    @property
    def motion(self) -> Motion:
        """The follower's own motion [mm or rad]."""
        return self.cam.drive.motion

    @property
    def follower(self) -> Any:
        """The follower of the present design."""
        return self.cam.follower

    @property
    def arm_side(self) -> int | None:
        """The side of a rocker's arm; None on a guide."""
        side: int = self.follower.arm_side if self.held is not None else 0
        return side or None

    @property
    def hopeless(self) -> str | None:
        """Why no size will do, if the linkage is at fault; else None."""
        found = forbidding(linkage_findings(self.cam.drive, Limits()))
        return found[0].sentence if found else None

    @property
    def sides(self) -> tuple[Self, ...]:
        """The task itself, and a rocker also on the other side of the line pivot -> cam axis.

        On a guide there is nothing else to find: its mirror image is another offset.
        """
        if self.arm_side is None:
            return (self,)
        return self, replace(self, cam=self.cam.sized(arm_side=-self.arm_side))

    def lengths_at(self, place: complex) -> dict[str, float | complex]:
        """All lengths of the follower [mm] that `place` decides, by their scene's keys."""
        return {"base_radius": self.base_radius_at(place), **self.moved(place)}

    def cam_at(self, place: complex) -> Cam:
        """The cam with its axis at `place`; a rocker keeps the direction of its pivot.

        GeometryError if there is no such mechanism.
        """
        return self.cam.sized(**self.lengths_at(place))

    def follower_at(self, place: complex) -> Any:
        """The follower of `cam_at`."""
        return replace(self.follower, **self.lengths_at(place))

    def pitch_curve_at(self, place: complex) -> PitchCurve:
        """The pitch curve of `cam_at`."""
        return PitchCurve(self.motion, self.follower_at(place), self.cam.rotation)


class Rocking(Placing):
    """Beside a rocker: its pivot is the origin, the follower starts along the x axis, and the axes
    are mirrored if it lies clockwise of the line pivot -> cam axis.
    """

    __slots__ = ()

    second = "pivot at"
    held = 0j

    @property
    def present(self) -> complex:
        """See `Placing`."""
        return cmath.rect(self.follower.centre_distance, -self.follower.start_angle)

    @property
    def seen(self) -> tuple[int, int]:
        """See `Placing`."""
        return 1, self.follower.arm_side

    def second_of(self, place: complex) -> float:
        """See `Placing`: the distance of the pivot from the cam axis."""
        return abs(place)


# -- task -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Terms:
    """What u, v and the curvature are made of at n cam angles, see the module.

    Attributes
    ----------
    p, q : (n,) [mm/rad].
    turn : (n,) complex r, of magnitude 1.
    alpha, beta : (n,) [mm/rad^2]; |Z'|^3 kappa = |Z'|^2 - alpha u + beta v.
    p1, q1, turning : (n,) dp/dphi, dq/dphi, and d(-arg r)/dphi.
    centre : (n,) complex, the roller centre in the axes of the follower: r B [mm].
    """

    p: FloatArray
    q: FloatArray
    turn: ComplexArray
    alpha: FloatArray
    beta: FloatArray
    p1: FloatArray
    q1: FloatArray
    turning: FloatArray
    centre: ComplexArray

    def to_axis(self, place: complex | ComplexArray) -> FloatArray:
        """Distance of the roller centre from the cam axis [mm], shape as of `across_and_along`."""
        distance: FloatArray = np.abs(self.centre - self.turn * place)
        return distance

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

    def half_planes(self, tangent: float) -> tuple[ComplexArray, FloatArray]:
        """Normals n (n,) and c (n,) of u >= `tangent` v, which is Re(conj(n) P) >= c."""
        return np.conj((tangent + 1j) * self.turn), tangent * self.q - self.p


@dataclass(frozen=True, slots=True)
class Task(Placing):
    """A cam with a roller, whose axis is to be placed beside its follower, see `task_of`.

    Attributes
    ----------
    start : roller centre at cam angle 0 [mm].
    sense : in which the cam turns in the axes of places: +1 counter-clockwise, -1 clockwise.
    directions : the first and the last direction [rad] in which the cam axis may lie from the
        roller centre at cam angle 0.
    """

    if TYPE_CHECKING:  # that every kind has

        @property
        def start(self) -> complex: ...

        @property
        def sense(self) -> int: ...

    @property
    def directions(self) -> tuple[float, float]:
        """See the class."""
        return -math.pi, 0.0

    @abstractmethod
    def terms_of(self, lift: Jet) -> Terms:
        """What the conditions are made of for lifts (3, n), not necessarily of one motion."""

    def base_radius_at(self, place: complex) -> float:
        """See `Placing`."""
        return abs(place - self.start)

    @property
    def signs(self) -> tuple[float, ...]:
        """Sign of the curvature that counts for each flank in use: an inner flank runs inside."""
        return tuple(-float(flank.sign) for flank in self.cam.contact.flanks)

    @property
    def half(self) -> float:
        """Distance [mm] that the roller centre must keep from the cam axis; 0 in a ring."""
        return self.cam.disc.flank_distance if self.cam.contact.runs_inside else 0.0

    def held_to(self) -> tuple[ComplexArray, FloatArray]:
        """Normals n (k,) and c (k,) of the half-planes Re(conj(n) P) >= c of its directions."""
        if self.directions[0] < self.directions[1]:
            return np.empty(0, dtype=np.complex128), np.empty(0)
        return np.array([1.0 + 0j, -1.0 + 0j]), np.zeros(2)

    def terms(self, phi: FloatArray, side: Side = "right") -> Terms:
        """What the conditions are made of at `phi` (n,) [rad]."""
        return self.terms_of(self.motion.jet(phi, side, 2))

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


class OnGuide(Task):
    """On a guide, upright, below which the axis lies anywhere."""

    __slots__ = ()

    second = "offset"
    held = None
    start = 0j
    seen = (-1, 1)

    @property
    def sense(self) -> int:
        """See `Task`: the axes are mirrored."""
        return -self.cam.rotation

    @property
    def directions(self) -> tuple[float, float]:
        """See `Task`: both rollers of a yoke lie in line with the cam axis."""
        below = -0.5 * math.pi
        return (-math.pi, 0.0) if self.cam.yoke is None else (below, below)

    @property
    def present(self) -> complex:
        """See `Task`."""
        return complex(self.follower.offset, -self.follower.start_height)

    def second_of(self, place: complex) -> float:
        """See `Task`: the offset."""
        return place.real

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Placing`."""
        return {"offset": place.real if self.cam.yoke is None else 0.0}

    def terms_of(self, lift: Jet) -> Terms:
        """See `Task`."""
        one, none = np.ones(lift.shape[1], dtype=np.complex128), np.zeros(lift.shape[1])
        height, rate, bend = self.follower.direction * lift[:3]
        q = self.cam.rotation * rate
        bend_of_q = self.cam.rotation * bend
        return Terms(height, q, one, bend, q, rate, bend_of_q, none, 1j * height)


class OnRocker(Rocking, Task):
    """On a rocker: the axis lies anywhere about its pivot, whose direction from it is kept."""

    __slots__ = ()

    @property
    def start(self) -> complex:
        """See `Task`."""
        return complex(self.follower.arm)

    @property
    def sense(self) -> int:
        """See `Task`."""
        turning: int = self.cam.rotation * self.follower.arm_side
        return turning

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Task`."""
        away = self.follower.pivot / self.follower.centre_distance
        return {"pivot": away * abs(place)}

    def terms_of(self, lift: Jet) -> Terms:
        """See `Task`."""
        none, arm = np.zeros(lift.shape[1]), self.follower.arm
        sense = self.follower.arm_side * self.follower.swing_sense
        turning = self.follower.arm_side * self.cam.rotation
        angle, rate, bend = sense * lift[:3]
        along = turning * rate
        q = arm * (1.0 - along)
        return Terms(
            none, q, np.exp(-1j * angle), arm * bend, -along * q,
            none, -arm * turning * bend, rate, np.full(len(q), complex(arm)),
        )  # fmt: skip


TASKS: Final[dict[type[Follower], type[Task]]] = {
    TranslatingRoller: OnGuide,
    OscillatingRoller: OnRocker,
}
"""The task by the class of the follower."""


def task_of(cam: Cam) -> Task:
    """The task of placing the axis of `cam`.

    GeometryError with key "follower.kind" if its follower has no roller.
    """
    kind = TASKS.get(type(cam.follower))
    if kind is None:
        name = cam.follower.kind
        message = f'this needs a roller follower, and this one is "{name}"'
        raise GeometryError(message, key="follower.kind", value=name)
    return kind(cam)


# -- face task ------------------------------------------------------------------------------------
# The conditions of a flat face on the place of the cam axis.
#
# The face starts on the x axis of a guide, or at the height f = `face_offset` over it on a rocker,
# whose pivot is the origin; the cam axis lies below it, mirrored if the face lies clockwise of the
# line pivot -> cam axis. So a place is -i r_G on a guide and P = l_1 exp(-i chi_0) = x - i y on a
# rocker, r_G = f + y.
#
# With theta the angle by which the rocker has turned, tau = 1 - sigma m theta' and w = 1/tau (see
# `camgeo.kinematics.mechanism.face`), all conditions are linear in the place:
#
# - distance of the face from the axis: h = f + x sin theta + y cos theta > 0;
# - its lever about the pivot: q = w (x cos theta - y sin theta) >= tan mu |f|, and above 0;
# - radius of curvature: p = f tau + x ((2 - w) sin theta + w^2 theta'' cos theta)
#   + y ((2 - w) cos theta - w^2 theta'' sin theta) >= rho tau.
#
# On a guide h = r_G + kappa_F s and p = h + kappa_F s'', so that r_G >= rho - kappa_F (s + s''),
# and the transmission angle is always 90 degrees. On a rocker the pivot is kept; each condition
# leaves an arc of chi_0. tau > 0 and a velocity without jumps do not depend on the place.


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


FACE_TASKS: Final[dict[type[Follower], type[FaceTask]]] = {
    TranslatingFlat: FaceOnGuide,
    OscillatingFlat: FaceOnRocker,
}
"""The task by the class of the follower."""


def face_task_of(cam: Cam) -> FaceTask:
    """The task of placing the axis of `cam`, which has a flat face."""
    return FACE_TASKS[type(cam.follower)](cam)


# -- covering -------------------------------------------------------------------------------------
# Global undercut as a condition on the place of the cam axis.
#
# A flank is cut off where the roller, elsewhere on its way, covers it: where the roller centre at a
# cam angle phi_2 is nearer than the flank's distance |d| to the point that the flank has at phi_1.
# In the axes of `camgeo.check.sizing.task`, turned with the cam at phi_1, the point less the centre
# is
#
#     B_1 - P - (B_2 - P) E + d N_1 / |N_1|,
#
# E = exp(-i sense (phi_2 - phi_1)), N_1 = B_1 + i sense B_1' - P, along the normal and as long as
# the velocity of the roller centre. Every pair of cam angles at which it is shorter than |d| rules
# the place out, whatever else is known of it. Between places h apart it changes by at most h |1 -
# E| + |d| times the turn of N_1, whose sine is at most h / |N_1|.
#
# There are too many pairs to examine all of them. The relevant ones are found from what the outline
# of a place has lost.


TOUCHING = 3e-9
"""A point covered by less than this fraction of |d| counts as touched: somewhat more than in
`camgeo.geometry.outline.clearance`."""

AROUND, ACROSS = 720, 17
"""Cam angles over the turn, and between two crossings, at which covering is sought."""

MOST = 120
"""Most pairs taken from one place."""

ZOOMS, GRID = 14, 5
"""Steps of a refinement, each in half the range, and cam angles that it tries on each side."""


@dataclass(frozen=True, slots=True, eq=False)
class Covers:
    """Pairs of cam angles, and what their conditions are made of, see the module.

    Attributes
    ----------
    first, second : (k,) phi_1 and phi_2 [rad].
    distance : (k,) d [mm].
    apart, turned, normal : (k,) complex B_1 - B_2 E, 1 - E, and N_1 + P [mm].
    """

    first: FloatArray
    second: FloatArray
    distance: FloatArray
    apart: ComplexArray
    turned: ComplexArray
    normal: ComplexArray

    def gap(self, places: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """(n, k) distance beyond |d| of point and centre [mm], and |N_1| [mm/rad], at places (n,).

        Negative where the point is covered.
        """
        seen = places[:, np.newaxis]
        normal = self.normal - seen
        pace = np.abs(normal)
        with np.errstate(divide="ignore", invalid="ignore"):
            offset = self.distance * (normal / pace)
        reach = np.abs(self.apart - seen * self.turned + offset)
        return reach - np.abs(self.distance), pace

    def change(self, half: FloatArray, pace: FloatArray) -> FloatArray:
        """(n, k) most by which `gap` [mm] changes within `half` (n, 1) [mm] of places."""
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.where(pace > half, math.sqrt(2.0) * half / pace, 2.0)
        return np.asarray(half * np.abs(self.turned) + np.abs(self.distance) * turn)

    def met(self, places: ComplexArray) -> BoolArray:
        """(n,) whether no point is covered with the cam axis at the places (n,)."""
        gap, _ = self.gap(places)
        return np.asarray(np.all(gap >= 0.0, axis=1))

    def some(self, wanted: BoolArray | IntArray) -> Covers:
        """Those of the pairs that are `wanted`."""
        return taken(self, wanted)

    def __add__(self, other: Covers) -> Covers:
        return joined((self, other))


def pairs_of(
    task: Task, first: FloatArray, second: FloatArray, distance: float | FloatArray
) -> Covers:
    """The conditions at the cam angles `first` and `second` (k,) [rad] of flanks at d [mm]."""
    places, ways = _centres(task, first)
    others, _ = _centres(task, second)
    turned = np.exp(-1j * task.sense * (second - first))
    distances = np.broadcast_to(np.asarray(distance, dtype=np.float64), first.shape)
    normals = places + 1j * task.sense * ways
    return Covers(first, second, distances, places - others * turned, 1.0 - turned, normals)


def no_pairs(task: Task) -> Covers:
    """No pairs at all."""
    return pairs_of(task, np.empty(0), np.empty(0), 0.0)


def _centres(task: Task, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """B and B' (n,) at `phi` (n,) [rad], in the axes of places."""
    terms = task.terms(phi)
    back = np.conj(terms.turn)
    return back * terms.centre, 1j * back * (terms.p1 + terms.turning * terms.centre)


def covered(task: Task, place: complex) -> Covers:
    """Pairs at which the flanks in use are cut off with the cam axis at `place`, the worst first.

    Empty if they are not, or only touch to rounding. What is cut off at a corner of the pitch curve
    is left out: a jump of the velocity rules the disc out at every size.
    """
    disc = task.cam_at(place).disc
    kinks = np.array([pivot.after for pivot in disc.pitch_path.pivots])
    found = no_pairs(task)
    for name, flank in disc.flanks:
        try:
            if not disc.outline(name).is_trimmed:
                continue
            crossings = find_crossings(flank, disc.bends)
        except GeometryError:  # nothing is left, or what is left cannot be decided
            crossings = ()
        angles = sorted(angle for each in crossings for angle in (each.first, each.second))
        ends = [*angles[1:], *(angle + TURN for angle in angles[:1])]
        stretches = list(zip(angles, ends, strict=True)) or [(0.0, TURN)]
        for start, end in stretches:
            if not (angles and np.any((kinks - start) % TURN <= end - start)):
                found = found + _of_stretch(task, place, flank.distance, start, end)
    gap = found.gap(np.array([place]))[0][0]
    order = np.argsort(gap)[:MOST]
    return found.some(order[gap[order] < -TOUCHING * np.abs(found.distance[order])])


def _of_stretch(task: Task, place: complex, distance: float, start: float, end: float) -> Covers:
    """Pairs of the flank between two of its crossings, which is covered as a whole or nowhere.

    Samples of its points, each with the nearest roller centre, and the deepest point, refined.
    """
    count = max(ACROSS, math.ceil(AROUND * (end - start) / (2.0 * TURN)))
    share = (np.arange(count) + 0.5) / count
    first = start + (end - start) * share
    around = np.linspace(0.0, TURN, AROUND, endpoint=False)
    gap = _gaps(task, place, distance, first[:, np.newaxis], around)
    second = around[np.argmin(gap, axis=1)]
    first, second = _deepest(task, place, distance, (first, second), (0.0, TURN / AROUND))
    depth = pairs_of(task, first, second, distance).gap(np.array([place]))[0][0]
    if not np.any(depth < 0.0):
        return no_pairs(task)
    best = np.argmin(depth, keepdims=True)
    wide = (end - start) / count, TURN / AROUND
    one, other = _deepest(task, place, distance, (first[best], second[best]), wide)
    return pairs_of(task, np.append(first, one), np.append(second, other), distance)


def _deepest(
    task: Task,
    place: complex,
    distance: float,
    pairs: tuple[FloatArray, FloatArray],
    wide: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """For each of `pairs` (k,), (k,) the deepest within `wide` [rad] of its two angles."""
    first, second = pairs
    ahead, beside = wide
    share = np.linspace(-1.0, 1.0, 2 * GRID - 1)
    ways = share if ahead > 0.0 else np.zeros(1)
    one, other = (each.ravel() for each in np.meshgrid(ways, share, indexing="ij"))
    every = np.arange(len(first))
    for _ in range(ZOOMS):
        firsts = first[:, np.newaxis] + ahead * one
        seconds = second[:, np.newaxis] + beside * other
        least = np.argmin(_gaps(task, place, distance, firsts, seconds), axis=1)
        first, second = firsts[every, least], seconds[every, least]
        ahead, beside = 0.5 * ahead, 0.5 * beside
    return first, second


def _gaps(
    task: Task, place: complex, distance: float, first: FloatArray, second: FloatArray
) -> FloatArray:
    """`Covers.gap` of one place at cam angles of shapes (k, n) and (n,), or both (k, n) [mm]."""
    starts, ways = _centres(task, first.ravel())
    normals = starts + 1j * task.sense * ways - place
    points = starts - place + distance * (normals / np.abs(normals))
    centres, _ = _centres(task, second.ravel())
    turned = (
        each * np.exp(-1j * task.sense * phi)
        for each, phi in (
            (points.reshape(first.shape), first),
            ((centres - place).reshape(second.shape), second),
        )
    )
    point, centre = turned
    return np.asarray(np.abs(point - centre) - abs(distance))
