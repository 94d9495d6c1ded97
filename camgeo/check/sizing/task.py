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
from typing import Any, ClassVar, Final, Self

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.finding import Limits, forbidding
from camgeo.check.machine import linkage_findings
from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import find_crossings
from camgeo.geometry.pieces import Extremes, extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
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
    """A cam whose axis is to be placed beside its follower, see the module.

    Attributes
    ----------
    cam : the present design; all dimensions of the follower that are not placed are kept.
    second : name of the quantity that, with the base radius, determines a place.
    held : the pivot [mm]; None on a guide.
    present : place of the cam axis in the present design [mm].
    seen : signs of x and y in a picture for the real and the imaginary part of a place.
    """

    cam: Cam

    second: ClassVar[str]
    held: ClassVar[complex | None]

    @property
    @abstractmethod
    def seen(self) -> tuple[int, int]:
        """See the class."""

    @property
    @abstractmethod
    def present(self) -> complex:
        """See the class."""

    @abstractmethod
    def second_length(self, place: complex) -> float:
        """The `second` quantity [mm] at `place`."""

    @abstractmethod
    def base_radius(self, place: complex) -> float:
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
        findings = forbidding(linkage_findings(self.cam.drive, Limits()))
        return findings[0].sentence if findings else None

    @property
    def sides(self) -> tuple[Self, ...]:
        """The task itself, and a rocker also on the other side of the line pivot -> cam axis.

        On a guide there is nothing else to find: its mirror image is another offset.
        """
        if self.arm_side is None:
            return (self,)
        return self, replace(self, cam=self.cam.sized(arm_side=-self.arm_side))

    def placed_lengths(self, place: complex) -> dict[str, float | complex]:
        """All lengths of the follower [mm] that `place` decides, by their scene's keys."""
        return {"base_radius": self.base_radius(place), **self.moved(place)}

    def placed_cam(self, place: complex) -> Cam:
        """The cam with its axis at `place`; a rocker keeps the direction of its pivot.

        GeometryError if there is no such mechanism.
        """
        return self.cam.sized(**self.placed_lengths(place))

    def pitch_curve(self, place: complex) -> PitchCurve:
        """The pitch curve of `placed_cam`."""
        follower = replace(self.follower, **self.placed_lengths(place))
        return PitchCurve(self.motion, follower, self.cam.rotation)


class RockerPlacing(Placing):
    """A cam axis to be placed beside a rocker.

    The pivot is the origin, the follower starts along the x axis, and the axes are mirrored if the
    follower lies clockwise of the line pivot -> cam axis.
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

    def second_length(self, place: complex) -> float:
        """See `Placing`: the distance of the pivot from the cam axis."""
        return abs(place)


# -- task -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Terms:
    """The terms of u, v and the curvature at n cam angles that do not depend on the place.

    Attributes
    ----------
    p, q : (n,) [mm/rad].
    turn : (n,) complex r, of magnitude 1.
    alpha, beta : (n,) [mm/rad^2]; |Z'|^3 kappa = |Z'|^2 - alpha u + beta v.
    p1, q1, turning : (n,) dp/dphi, dq/dphi, and d(-arg r)/dphi.
    centre : (n,) complex, the roller centre in the axes of the follower: r B [mm].

    For p, q and r see the module.
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
        return np.asarray(np.abs(self.centre - self.turn * place))

    def across_and_along(self, place: complex | ComplexArray) -> tuple[FloatArray, FloatArray]:
        """u, v [mm/rad] for one place, or (k, n) for places (k, 1)."""
        seen = self.turn * place
        return self.p - seen.imag, self.q - seen.real

    def curvature(self, place: complex | ComplexArray) -> FloatArray:
        """kappa [1/mm], shape as of `across_and_along`; Z' must not vanish."""
        u, v = self.across_and_along(place)
        square = u * u + v * v  # |Z'|^2, so that the divisor is |Z'|^3
        return np.asarray((square - self.alpha * u + self.beta * v) / (square * np.sqrt(square)))

    def half_planes(self, tangent: float) -> tuple[ComplexArray, FloatArray]:
        """Normals n (n,) and c (n,) of u >= `tangent` v, which is Re(conj(n) P) >= c."""
        return np.conj((tangent + 1j) * self.turn), tangent * self.q - self.p


@dataclass(frozen=True, slots=True)
class RollerTask(Placing):
    """A cam with a roller whose axis is to be placed beside its follower, see `from_cam`.

    Attributes
    ----------
    start : roller centre at cam angle 0 [mm].
    sense : sense of the cam's rotation in the axes of places: +1 counter-clockwise, -1 clockwise.
    directions : the first and the last direction [rad] in which the cam axis may lie from the
        roller centre at cam angle 0.
    """

    @property
    def start(self) -> complex:
        """See the class: the origin on a guide, the end of the arm on a rocker."""
        return 0j if self.held is None else complex(self.follower.arm)

    @property
    def sense(self) -> int:
        """See the class: the axes are mirrored on a guide, and beside a clockwise arm."""
        return self.cam.rotation * (self.arm_side or -1)

    @property
    def directions(self) -> tuple[float, float]:
        """See the class."""
        return -math.pi, 0.0

    @abstractmethod
    def lift_terms(self, lift: Jet) -> Terms:
        """The terms for lifts with two derivatives (3, n), not necessarily of one motion."""

    def base_radius(self, place: complex) -> float:
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

    def direction_half_planes(self) -> tuple[ComplexArray, FloatArray]:
        """Normals n (k,) and c (k,) of the half-planes Re(conj(n) P) >= c that keep the place in
        the allowed direction, if there is a single one.
        """
        if self.directions[0] < self.directions[1]:
            return np.empty(0, dtype=np.complex128), np.empty(0)
        # x >= 0 and x <= 0: the line through the start along which a yoke is placed.
        return np.array([1.0 + 0j, -1.0 + 0j]), np.zeros(2)

    def terms(self, phi: FloatArray, side: Side = "right") -> Terms:
        """The terms at `phi` (n,) [rad]."""
        return self.lift_terms(self.motion.jet(phi, side, 2))

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

    @staticmethod
    def from_cam(cam: Cam) -> RollerTask:
        """The task of placing the axis of `cam`.

        GeometryError with key "follower.kind" if its follower has no roller.
        """
        kind = TASKS.get(type(cam.follower))
        if kind is None:
            name = cam.follower.kind
            message = f'this needs a roller follower, and this one is "{name}"'
            raise GeometryError(message, key="follower.kind", value=name)
        return kind(cam)


class OnGuide(RollerTask):
    """A follower on an upright guide, with the cam axis anywhere below it."""

    __slots__ = ()

    second = "offset"
    held = None
    seen = (-1, 1)

    @property
    def directions(self) -> tuple[float, float]:
        """See `RollerTask`: both rollers of a yoke lie in line with the cam axis."""
        below = -0.5 * math.pi
        return (-math.pi, 0.0) if self.cam.yoke is None else (below, below)

    @property
    def present(self) -> complex:
        """See `RollerTask`."""
        return complex(self.follower.offset, -self.follower.start_height)

    def second_length(self, place: complex) -> float:
        """See `RollerTask`: the offset."""
        return place.real

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Placing`."""
        return {"offset": place.real if self.cam.yoke is None else 0.0}

    def lift_terms(self, lift: Jet) -> Terms:
        """See `RollerTask`."""
        one, none = np.ones(lift.shape[1], dtype=np.complex128), np.zeros(lift.shape[1])
        height, rate, bend = self.follower.direction * lift[:3]
        q = self.cam.rotation * rate
        bend_of_q = self.cam.rotation * bend
        return Terms(height, q, one, bend, q, rate, bend_of_q, none, 1j * height)


class OnRocker(RockerPlacing, RollerTask):
    """A follower on a rocker, with the cam axis anywhere about the pivot.

    The direction from the cam axis to the pivot is kept.
    """

    __slots__ = ()

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `RollerTask`."""
        away = self.follower.pivot / self.follower.centre_distance
        return {"pivot": away * abs(place)}

    def lift_terms(self, lift: Jet) -> Terms:
        """See `RollerTask`."""
        none, arm = np.zeros(lift.shape[1]), self.follower.arm
        sense = self.follower.arm_side * self.follower.swing_sense
        angle, rate, bend = sense * lift[:3]
        along = self.sense * rate
        q = arm * (1.0 - along)
        return Terms(
            none, q, np.exp(-1j * angle), arm * bend, -along * q,
            none, -arm * self.sense * bend, rate, np.full(len(q), complex(arm)),
        )  # fmt: skip


TASKS: Final[dict[type[Follower], type[RollerTask]]] = {
    TranslatingRoller: OnGuide,
    OscillatingRoller: OnRocker,
}
"""The task by the class of the follower."""


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
# There are too many pairs to examine all of them. The relevant ones follow from what the outline of
# a place has lost.


TOUCHING = 3e-9
"""A point covered by less than this fraction of |d| counts as touched, which is somewhat more than
in `camgeo.geometry.pieces`."""

AROUND, ACROSS = 720, 17
"""Number of cam angles over the turn, and between two crossings, at which covering is examined."""

MOST = 120
"""Most pairs that one place adds to the conditions."""

ZOOMS, GRID = 14, 5
"""Steps of a refinement, each in half the range, and cam angles that it tries on each side."""


@dataclass(frozen=True, slots=True, eq=False)
class Covers:
    """Pairs of cam angles with the terms of their conditions, see above.

    Attributes
    ----------
    first, second : (k,) phi_1 and phi_2 [rad].
    distance : (k,) d [mm].
    difference, turned, normal : (k,) complex B_1 - B_2 E, 1 - E, and N_1 + P [mm].
    """

    first: FloatArray
    second: FloatArray
    distance: FloatArray
    difference: ComplexArray
    turned: ComplexArray
    normal: ComplexArray

    def gap(self, places: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """(n, k) distance beyond |d| of point and centre [mm], and |N_1| [mm/rad], at places (n,).

        Negative where the point is covered.
        """
        seen = places[:, np.newaxis]
        normal = self.normal - seen
        pace = np.abs(normal)
        # The unit normal times d leads from the roller centre to the point on the flank.
        with np.errstate(divide="ignore", invalid="ignore"):
            offset = self.distance * (normal / pace)
        reach = np.abs(self.difference - seen * self.turned + offset)
        return reach - np.abs(self.distance), pace

    def change(self, half: FloatArray, pace: FloatArray) -> FloatArray:
        """(n, k) bound on the change of `gap` [mm] within `half` (n, 1) [mm] of the places."""
        with np.errstate(divide="ignore", invalid="ignore"):
            # A unit normal that turns by t moves by 2 sin(t/2) <= sqrt(2) sin t up to a right
            # angle, and by 2 at most.
            turn = np.where(pace > half, math.sqrt(2.0) * half / pace, 2.0)
        return np.asarray(half * np.abs(self.turned) + np.abs(self.distance) * turn)

    def met(self, places: ComplexArray) -> BoolArray:
        """(n,) whether no point of a pair is covered with the cam axis at the places (n,)."""
        gap, _ = self.gap(places)
        return np.asarray(np.all(gap >= 0.0, axis=1))

    def some(self, wanted: BoolArray | IntArray) -> Covers:
        """The pairs that are `wanted`, a mask or indices."""
        return taken(self, wanted)

    def __add__(self, other: Covers) -> Covers:
        return joined((self, other))


def pair_conditions(
    task: RollerTask, first: FloatArray, second: FloatArray, distance: float | FloatArray
) -> Covers:
    """The conditions of pairs of cam angles `first` and `second` (k,) [rad] of flanks at the
    `distance` d [mm] from the pitch curve.
    """
    places, ways = _centres(task, first)
    others, _ = _centres(task, second)
    turned = np.exp(-1j * task.sense * (second - first))
    distances = np.broadcast_to(np.asarray(distance, dtype=np.float64), first.shape)
    # N_1 + P, along the normal of the pitch curve at the first angle.
    normals = places + 1j * task.sense * ways
    return Covers(first, second, distances, places - others * turned, 1.0 - turned, normals)


def no_pairs(task: RollerTask) -> Covers:
    """No pairs at all."""
    return pair_conditions(task, np.empty(0), np.empty(0), 0.0)


def _centres(task: RollerTask, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """B and B' (n,) at `phi` (n,) [rad], in the axes of places."""
    terms = task.terms(phi)
    # `centre` is r B, so conj(r) turns it back.
    back = np.conj(terms.turn)
    return back * terms.centre, 1j * back * (terms.p1 + terms.turning * terms.centre)


def covered_pairs(task: RollerTask, place: complex) -> Covers:
    """Pairs at which the flanks in use are cut off with the cam axis at `place`, the worst first.

    Empty if they are not cut off, or only touch up to rounding. What is cut off at a corner of the
    pitch curve is left out: a jump of the velocity rules the disc out at every size.
    """
    disc = task.placed_cam(place).disc
    kinks = np.array([pivot.phi_end for pivot in disc.pitch_path.pivots])
    pairs = no_pairs(task)
    for name, flank in disc.flanks:
        try:
            if not disc.outline(name).is_trimmed:
                continue
            crossings = find_crossings(flank, disc.bends)
        except GeometryError:  # nothing remains of the flank, or it is unknown what remains
            crossings = ()
        angles = sorted(
            angle for crossing in crossings for angle in (crossing.first, crossing.second)
        )
        # Between two neighbouring crossings a flank is covered as a whole or not at all; the last
        # stretch passes cam angle 0. Without crossings all of it is one stretch.
        ends = [*angles[1:], *(angle + TURN for angle in angles[:1])]
        stretches = list(zip(angles, ends, strict=True)) or [(0.0, TURN)]
        for start, end in stretches:
            if not (angles and np.any((kinks - start) % TURN <= end - start)):
                pairs = pairs + _stretch_pairs(task, place, flank.distance, start, end)
    # Pairs that only touch, up to rounding, do not rule the place out.
    gap = pairs.gap(np.array([place]))[0][0]
    order = np.argsort(gap)[:MOST]
    return pairs.some(order[gap[order] < -TOUCHING * np.abs(pairs.distance[order])])


def _stretch_pairs(
    task: RollerTask, place: complex, distance: float, start: float, end: float
) -> Covers:
    """Pairs of the flank between two of its crossings, which is covered as a whole or nowhere.

    They are samples of its points, each with the nearest roller centre, and the refined deepest
    point.
    """
    count = max(ACROSS, math.ceil(AROUND * (end - start) / (2.0 * TURN)))
    # Midpoints, as the ends of a stretch lie on the border of what covers it.
    share = (np.arange(count) + 0.5) / count
    first = start + (end - start) * share
    around = np.linspace(0.0, TURN, AROUND, endpoint=False)
    gap = _gaps(task, place, distance, first[:, np.newaxis], around)
    second = around[np.argmin(gap, axis=1)]
    first, second = _deepest(task, place, distance, (first, second), (0.0, TURN / AROUND))
    depth = pair_conditions(task, first, second, distance).gap(np.array([place]))[0][0]
    if not np.any(depth < 0.0):
        return no_pairs(task)
    best = np.argmin(depth, keepdims=True)
    wide = (end - start) / count, TURN / AROUND
    one, other = _deepest(task, place, distance, (first[best], second[best]), wide)
    return pair_conditions(task, np.append(first, one), np.append(second, other), distance)


def _deepest(
    task: RollerTask,
    place: complex,
    distance: float,
    pairs: tuple[FloatArray, FloatArray],
    wide: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """For each of the `pairs` (k,), (k,) the deepest one within `wide` [rad] of its two angles.

    The grid about the best pair so far is halved `ZOOMS` times; a range of 0 keeps its angle.
    """
    first, second = pairs
    first_reach, second_reach = wide
    share = np.linspace(-1.0, 1.0, 2 * GRID - 1)
    ways = share if first_reach > 0.0 else np.zeros(1)
    one, other = (offsets.ravel() for offsets in np.meshgrid(ways, share, indexing="ij"))
    every = np.arange(len(first))
    for _ in range(ZOOMS):
        firsts = first[:, np.newaxis] + first_reach * one
        seconds = second[:, np.newaxis] + second_reach * other
        least = np.argmin(_gaps(task, place, distance, firsts, seconds), axis=1)
        first, second = firsts[every, least], seconds[every, least]
        first_reach, second_reach = 0.5 * first_reach, 0.5 * second_reach
    return first, second


def _gaps(
    task: RollerTask, place: complex, distance: float, first: FloatArray, second: FloatArray
) -> FloatArray:
    """`Covers.gap` of one place at cam angles of shapes (k, n) and (n,), or both (k, n) [mm]."""
    starts, ways = _centres(task, first.ravel())
    normals = starts + 1j * task.sense * ways - place
    points = starts - place + distance * (normals / np.abs(normals))
    centres, _ = _centres(task, second.ravel())
    # Both are turned with the cam, back to cam angle 0, where they can be compared.
    turned = (
        vectors * np.exp(-1j * task.sense * phi)
        for vectors, phi in (
            (points.reshape(first.shape), first),
            ((centres - place).reshape(second.shape), second),
        )
    )
    point, centre = turned
    return np.asarray(np.abs(point - centre) - abs(distance))
