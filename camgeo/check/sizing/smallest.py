"""The smallest base circle for a transmission angle and the rule r_R <= ratio r_K (eq. 3.36), of a
cam that has no undercut, local or global.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from camgeo.check.disc import transmission_angle_extremes
from camgeo.check.sizing.task import Covers, RollerTask, Terms, covered_pairs, no_pairs
from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import CUSP
from camgeo.geometry.pieces import curvature_extremes, extremes, nearest_to_axis, smooth_pieces
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import (
    SIDES,
    BoolArray,
    ComplexArray,
    FloatArray,
    Side,
    dot,
    joined,
    taken,
)
from camgeo.numeric.extremes import Extreme
from camgeo.units import TURN

ACTIVE = 1e-9
"""A condition this close to its limit is active: in rad for the angle, as a difference of ratios
for r_R/r_K."""

SAME = 1e-7
"""Cam angles [rad] closer than this are the same."""

TOUCHES = 1e-7
"""A point within this fraction of |d| of being covered decides, if nothing else is as close."""

AXIS_MARGIN = 1e-9
"""Fraction of its radius by which the roller stays clear of the cam axis."""

ARM_SIDES: Final = {1: "ccw", -1: "cw"}
"""The side of an arm, as in scenes."""

NO_CUSP = 1.0 - 2.0 * CUSP
"""Largest r_R/r_K: at 1 the flank has a cusp."""


@dataclass(frozen=True, slots=True)
class Active:
    """A condition that decides the size.

    Attributes
    ----------
    name : "transmission-angle", "radius-ratio", "roller-over-axis" or "global-undercut"; for a flat
        face "convexity", "face-over-axis" or "transmission-angle".
    cam_angle : where it is at its limit [rad] in [0, 2 pi); in a dwell, its beginning.
    """

    name: str
    cam_angle: float


@dataclass(frozen=True, slots=True)
class Rating:
    """The properties of the cam with its axis at one place.

    Attributes
    ----------
    place : the place of the cam axis [mm], see `RollerTask`.
    follower : the follower with the cam axis there.
    transmission_angle : smallest transmission angle [rad], with its cam angle [rad].
    radius_ratio : largest r_R/r_K, with its cam angle [rad]; 0 for a flat face.
    radius_of_curvature : smallest radius of curvature of the outline under a flat face [mm], with
        its cam angle.
    face : first and last position of the contact on a flat face [mm], with their cam angles.
    """

    place: complex
    follower: Any
    transmission_angle: Extreme
    radius_ratio: Extreme
    radius_of_curvature: Extreme | None = None
    face: tuple[Extreme, Extreme] | None = None

    @property
    def base_radius(self) -> float:
        """r_G [mm]."""
        return float(self.follower.base_radius)

    @property
    def arm_side(self) -> str | None:
        """The arm side of a rocker, as in scenes; None on a guide."""
        side = getattr(self.follower, "arm_side", None)
        return None if side is None else ARM_SIDES[side]

    @property
    def contact(self) -> tuple[float, float] | None:
        """First and last position of the contact on a flat face [mm]; None for a roller."""
        return None if self.face is None else (self.face[0].value, self.face[1].value)

    @staticmethod
    def from_place(task: RollerTask, place: complex) -> Rating | None:
        """The rating of the cam with its axis at `place`; None if there is no such mechanism."""
        try:
            curve = task.pitch_curve(place)
            angle = transmission_angle_extremes(curve).smallest()
            ratio = worst_ratio(task, place)
        except GeometryError:
            return None
        return Rating(place, curve.follower, Extreme(*angle), Extreme(*ratio))


@dataclass(frozen=True, slots=True, eq=False)
class Sizing:
    """The smallest base circle for given limits, and how it was determined.

    Attributes
    ----------
    angle, ratio : the required transmission angle mu [rad] and r_R/r_K.
    construction : Flocke's construction; None for a flat face, and where no size will do.
    flocke : rating of the construction's proposal; None if its region is empty.
    for_angle : rating of the smallest base circle for the transmission angle alone; None if there
        is none.
    answer : rating of the smallest base circle for all limits; None if there is none.
    active : the conditions that decide the answer, at most two except by symmetry.
    nearest_angle : largest transmission angle [rad] that can be kept, if the required one cannot.
    nearest_ratio : smallest r_R/r_K of a grid of places, if no place kept the required one.
    none_below : base radius [mm] below which there certainly is no place that keeps all limits.
    reach : largest base radius [mm] searched for all limits; None if the answer is exact.
    radius : smallest radius of curvature required of the outline under a flat face [mm].
    hopeless : why no size at all will do; None if it is a matter of size.
    rounds : rounds of exchange that the search took; 0 if it took none.
    examined : the conditions that decide near the answer of a roller.
    """

    angle: float
    ratio: float
    construction: Flocke | None = None
    flocke: Rating | None = None
    for_angle: Rating | None = None
    answer: Rating | None = None
    active: tuple[Active, ...] = ()
    nearest_angle: float | None = None
    nearest_ratio: float | None = None
    none_below: float = 0.0
    reach: float | None = None
    radius: float | None = None
    hopeless: str | None = None
    rounds: int = 0
    examined: PlaceConditions | None = field(default=None, repr=False)

    @property
    def exact(self) -> bool:
        """Whether the answer is exact up to rounding; else `none_below` is what is proved."""
        return self.answer is not None and self.reach is None

    @staticmethod
    def solve(task: RollerTask, angle: float, ratio: float) -> Sizing:
        """Rate Flocke's proposal and determine the smallest base circle of a roller follower.

        Parameters
        ----------
        task : the mechanism.
        angle : smallest transmission angle mu [rad], in (0, pi/2).
        ratio : largest r_R/r_K, in (0, 1].

        Raises
        ------
        GeometryError
            If the angle or the ratio is out of range, or the follower does not move.
        """
        require_angle(angle)
        if not 0.0 < ratio <= 1.0:
            raise GeometryError(
                "must be above 0 and at most 1", key="radius_ratio", value=f"{ratio:g}"
            )
        ratio = min(ratio, NO_CUSP)
        if task.cam.clearance > 0.0:  # beyond it, the flanks of a groove with play come to a cusp
            ratio = min(ratio, NO_CUSP * task.follower.roller_radius / task.cam.disc.flank_distance)
        tangent, hopeless = math.tan(angle), task.hopeless
        if hopeless is not None:
            return Sizing(angle, ratio, none_below=math.inf, hopeless=hopeless)
        construction = flocke(task, tangent)
        proposal = (
            None if construction.place is None else Rating.from_place(task, construction.place)
        )
        sizing = Sizing(angle, ratio, construction, proposal)
        place = smallest_place(task, tangent)
        if place is None:
            return replace(sizing, nearest_angle=largest_angle(task), none_below=math.inf)
        base = abs(place - task.start)
        if not base > 0.0:
            raise GeometryError(
                "there is nothing to size: the follower does not move", key="motion"
            )
        for_angle = Rating.from_place(task, place)
        # If the place that the angle alone decides keeps the rest too, it is the exact answer.
        if for_angle is not None and meets(task, place, tangent, ratio):
            conditions = place_conditions(
                task, tangent, ratio, extreme_angles(task, place, tangent, ratio)[0]
            )
            return replace(
                sizing,
                for_angle=for_angle,
                answer=for_angle,
                active=active_conditions(task, for_angle, angle, ratio),
                none_below=base,
                examined=conditions,
            )
        least = max(base, task.half * (1.0 + AXIS_MARGIN))
        nearest = smallest_with_bends(task, tangent, ratio, least)
        answer = None if nearest.place is None else Rating.from_place(task, nearest.place)
        pairs = nearest.examined.covers
        active = () if answer is None else active_conditions(task, answer, angle, ratio, pairs)
        least_ratio = nearest.least_ratio if math.isfinite(nearest.least_ratio) else None
        return replace(
            sizing,
            for_angle=for_angle,
            answer=answer,
            active=active,
            nearest_ratio=least_ratio if answer is None else None,
            none_below=nearest.bound,
            reach=nearest.reach,
            rounds=nearest.rounds,
            examined=nearest.examined,
        )


def require_angle(angle: float) -> None:
    """GeometryError unless `angle` [rad] can be required of a transmission angle."""
    if not 0.0 < angle < math.radians(89.9):
        raise GeometryError(
            "must be above 0 and below 89.9 degrees",
            key="transmission_angle",
            value=f"{math.degrees(angle):g}",
        )


def active_conditions(
    task: RollerTask, rating: Rating, angle: float, ratio: float, covers: Covers | None = None
) -> tuple[Active, ...]:
    """The conditions that are at their limits, each with its cam angle; of pairs the first one."""
    curve = task.pitch_curve(rating.place)
    angles = transmission_angle_extremes(curve)
    active = [
        Active("transmission-angle", float(phi) % TURN)
        for phi in angles.phi[np.abs(angles.values - angle) <= ACTIVE]
    ]
    bends = curvature_extremes(curve)
    for sign in task.signs:
        near = np.abs(sign * task.follower.roller_radius * bends.values - ratio) <= ACTIVE
        active += [Active("radius-ratio", float(phi) % TURN) for phi in bends.phi[near]]
    if task.half > 0.0:
        distance, phi = nearest_to_axis(curve)
        if distance <= task.half * (1.0 + 2.0 * AXIS_MARGIN):
            active.append(Active("roller-over-axis", phi))
    if covers is not None and len(covers.first):
        gap = np.abs(covers.gap(np.array([rating.place]))[0][0] / covers.distance)
        least = int(np.argmin(gap))
        if gap[least] <= TOUCHES:
            active.append(Active("global-undercut", float(covers.first[least]) % TURN))
    distinct: list[Active] = []
    for condition in sorted(active, key=lambda item: (item.name, item.cam_angle)):
        last = distinct[-1] if distinct else None
        if (
            last is None
            or last.name != condition.name
            or condition.cam_angle - last.cam_angle >= SAME
        ):
            distinct.append(condition)
    return tuple(distinct)


# -- exchange -------------------------------------------------------------------------------------
# The smallest base circle for a transmission angle: a convex problem, solved by exchange.
#
# Every cam angle gives half-planes in which the cam axis must lie. The place nearest to the roller
# centre is determined for some of them, those it violates most are added, and so on until none is
# violated. The worst violations are roots of a slope, so this converges like Newton's method.


CLOSE = 2e-14
"""A condition broken by this fraction of its terms is met up to rounding."""

MOST = 80
"""Most rounds; a dozen is usual."""

BISECTIONS = 26
"""Bisections of the largest transmission angle: to about 1e-6 degrees."""


def smallest_place(task: RollerTask, tangent: float) -> complex | None:
    """Place [mm] of the cam axis with the smallest base circle and mu >= atan(`tangent`).

    None if no place keeps that angle over the whole turn.
    """
    normals, bounds = task.direction_half_planes()
    place: complex = task.start
    for _ in range(MOST):
        broken = False
        for t in (tangent, -tangent):
            margins = task.slack(place, t)
            size = (abs(place) + abs(task.start)) * math.hypot(1.0, t)
            size += float(np.max(np.abs(bounds), initial=0.0))
            worst = margins.values < -CLOSE * size
            if np.any(worst):
                broken = True
                for side in SIDES:
                    more = task.terms(margins.phi[worst], side).half_planes(t)
                    normals = np.concatenate((normals, more[0]))
                    bounds = np.concatenate((bounds, more[1]))
        if not broken:
            return place
        # Both sides of a smooth place give the same half-plane.
        rows = np.unique(np.column_stack((normals.real, normals.imag, bounds)), axis=0)
        normals, bounds = rows[:, 0] + 1j * rows[:, 1], rows[:, 2]
        nearest = nearest_point(normals, bounds, task.start)
        if nearest is None:
            return None
        if nearest == place:
            return place
        place = nearest
    return place


def largest_angle(task: RollerTask) -> float:
    """The largest transmission angle [rad] that some place keeps over the turn, from below."""
    low, high = 0.0, math.radians(89.0)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if smallest_place(task, math.tan(middle)) is None:
            high = middle
        else:
            low = middle
    return low


ROUNDING = 1e-13
"""A point outside a half-plane by this fraction of the size of all of them lies on its border."""


def nearest_point(normals: ComplexArray, bounds: FloatArray, start: complex) -> complex | None:
    """The point P with Re(conj(n) P) >= c for all n, c that is nearest to `start`.

    Parameters
    ----------
    normals : n (k,) complex, not zero.
    bounds : c (k,).

    Returns
    -------
    None if no point lies in all half-planes. It is `start`, its foot on one of the lines, or a
    crossing of two lines; all of these are tried.
    """
    # With unit normals the bounds are distances of the borders from the origin.
    length = np.abs(normals)
    normals, bounds = normals / length, bounds / length
    feet = start + normals * (bounds - dot(normals, start))
    first, second = np.triu_indices(len(normals), 1)
    n1, n2, c1, c2 = normals[first], normals[second], bounds[first], bounds[second]
    area = n1.real * n2.imag - n1.imag * n2.real
    # Parallel borders have no crossing; the divisor 1 only avoids a warning.
    crossing = np.abs(area) > ROUNDING
    area = np.where(crossing, area, 1.0)
    # Cramer's rule for the two borders.
    vertices = ((c1 * n2.imag - c2 * n1.imag) + 1j * (c2 * n1.real - c1 * n2.real)) / area
    points = np.concatenate(([start], feet, vertices[crossing]))
    size = np.abs(points) + np.max(np.abs(bounds), initial=0.0)
    inside = np.ones(len(points), dtype=np.bool_)
    for normal, bound in zip(normals, bounds, strict=True):
        inside &= dot(points, normal) >= bound - ROUNDING * size
    if not np.any(inside):
        return None
    candidates = points[inside]
    return complex(candidates[np.argmin(np.abs(candidates - start))])


# -- flocke ---------------------------------------------------------------------------------------
# Flocke's construction of the cam axis (Wirsig section 2.4.1, eqs. 2.41 and 2.42 corrected).
#
# It takes the largest velocities of both senses at both end positions of the follower: more than
# any cam angle demands, so its place always keeps the transmission angle, and lies farther out than
# necessary. A single end position, or velocities in the middle of the stroke, would not be safe.


@dataclass(frozen=True, slots=True, eq=False)
class Flocke:
    """Flocke's construction and its proposal.

    Attributes
    ----------
    normals, bounds : (8,) or more half-planes Re(conj(n) P) >= c of the region, see `RollerTask`.
    place : the place of the cam axis in it with the smallest base circle [mm]; None if it is empty.
    """

    normals: ComplexArray
    bounds: FloatArray
    place: complex | None

    def row_limits(self, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lower and upper end of Re P in rows of this region, as for the function `row_limits`."""
        low, high = np.full(len(rows), -np.inf), np.full(len(rows), np.inf)
        for normal, bound in zip(self.normals, self.bounds, strict=True):
            rest = bound - normal.imag * rows
            if normal.real > 0.0:
                low = np.maximum(low, rest / normal.real)
            elif normal.real < 0.0:
                high = np.minimum(high, rest / normal.real)
        return low, high


def flocke(task: RollerTask, tangent: float) -> Flocke:
    """Flocke's construction for a transmission angle of atan(`tangent`)."""
    lifts = np.repeat(lift_range(task.motion), 2)
    rates = np.tile(_velocity_range(task), 2)
    terms = task.lift_terms(np.stack((lifts, rates, np.zeros_like(lifts))))
    sides = zip(
        terms.half_planes(tangent),
        terms.half_planes(-tangent),
        task.direction_half_planes(),
        strict=True,
    )
    normals, bounds = (np.concatenate(parts) for parts in sides)
    return Flocke(normals, bounds, nearest_point(normals, bounds, task.start))


def _velocity_range(task: RollerTask) -> tuple[float, float]:
    """Smallest and largest s' [mm/rad or rad/rad] over the turn."""

    def velocity(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(task.motion.jet(phi, side, 1)[1])

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(task.motion.jet(phi, side, 2)[2])

    velocities = extremes(task.motion, velocity, acceleration)
    return velocities.smallest()[0], velocities.largest()[0]


# -- region ---------------------------------------------------------------------------------------
# Where the cam axis may lie, for each row of a grid, with exact borders.
#
# The region of the transmission angle is convex: a row of equal Im P meets it in one interval. Its
# ends are the largest lower and the smallest upper bound of Re P over the cam angles.


SAMPLES = 65
"""Cam angles per piece at which bounds are sampled."""

SECTIONS, STEPS = 8, 12
"""A bracket is divided into sections; the two about the best cut form the next one."""


def row_limits(task: RollerTask, tangent: float, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lower and upper end (k,), (k,) of Re P [mm] at Im P = `rows` (k,) [mm].

    In a row that does not meet the region the lower end is above the upper one. Ends are exact up
    to rounding where the decisive bound is smooth over the cam angle.
    """
    share = np.linspace(1e-9, 1.0 - 1e-9, SAMPLES)
    pieces = [
        piece.start + (piece.end - piece.start) * (share[:1] if piece.dwell else share)
        for piece in smooth_pieces(task.motion)
    ]
    phi = np.concatenate(pieces)
    # The neighbours of each sample, between which an extreme next to it lies.
    left = np.concatenate([np.append(angles[:1], angles[:-1]) for angles in pieces])
    right = np.concatenate([np.append(angles[1:], angles[-1:]) for angles in pieces])
    low = np.full(len(rows), -np.inf)
    high = np.full(len(rows), np.inf)
    for t in (tangent, -tangent):
        for upper in (False, True):
            values = _bound(task, t, phi[np.newaxis, :], rows[:, np.newaxis], upper=upper)
            best = np.argmax(values, axis=1)
            ends = _refined(task, t, left[best], right[best], rows, upper=upper)
            ends = np.maximum(ends, values[np.arange(len(rows)), best])
            if upper:
                high = np.minimum(high, -ends)
            else:
                low = np.maximum(low, ends)
    # Rows in which u is not positive at cam angle 0 have no place.
    start = task.terms(np.zeros(1))
    low = np.where(rows < start.p[0], low, np.inf)
    return low, high


def _bound(
    task: RollerTask, tangent: float, phi: FloatArray, rows: FloatArray, *, upper: bool
) -> FloatArray:
    """Lower bound of Re P, or minus the upper one, from u >= `tangent` v; -inf where it has none.

    `phi` and `rows` are broadcast; the motion is evaluated once at each cam angle.
    """
    terms = task.terms(phi.ravel())
    factor = (tangent + 1j) * terms.turn
    along, across = factor.real.reshape(phi.shape), factor.imag.reshape(phi.shape)
    constant = (tangent * terms.q - terms.p).reshape(phi.shape)
    # u >= T v is Re(conj(n) P) >= c, so along Re P >= rest, whose sign decides which bound it is.
    rest = constant + across * rows
    used = np.broadcast_to(along < 0.0 if upper else along > 0.0, rest.shape)
    bounds = np.full(rest.shape, -np.inf)
    np.divide(rest, np.broadcast_to(along, rest.shape), out=bounds, where=used)
    if upper:
        bounds[used] *= -1.0
    return bounds


def _refined(
    task: RollerTask,
    tangent: float,
    left: FloatArray,
    right: FloatArray,
    rows: FloatArray,
    *,
    upper: bool,
) -> FloatArray:
    """The largest bound (k,) in each bracket of cam angles, one for each row."""
    share = np.arange(1.0, SECTIONS) / SECTIONS
    best = np.full(len(rows), -np.inf)
    numbers = np.arange(len(rows))
    for _ in range(STEPS):
        grid = left[:, np.newaxis] + (right - left)[:, np.newaxis] * share
        values = _bound(task, tangent, grid, rows[:, np.newaxis], upper=upper)
        index = np.argmax(values, axis=1)
        best = np.maximum(best, values[numbers, index])
        width = (right - left) / SECTIONS
        left, right = grid[numbers, index] - width, grid[numbers, index] + width
    return best


def ratio_map(task: RollerTask, columns: FloatArray, rows: FloatArray, most: float) -> FloatArray:
    """(rows, columns) largest r_R/r_K for the sign that matters, for a picture.

    It is taken on a grid of cam angles, and is `most` where it is larger or the roller centre
    stands still.
    """
    places = columns + 1j * rows[:, np.newaxis]
    conditions = place_conditions(task, 0.0, most, sample_angles(task))
    with np.errstate(all="ignore"):  # a pitch curve may have cusps here
        worst = np.array([conditions.worst_ratio(row) for row in places])
    return np.where(worst <= most, np.maximum(worst, 0.0), most)


# -- bends ----------------------------------------------------------------------------------------
# The smallest base circle where r_R against r_K, or global undercut, matters too: not a convex
# problem.
#
# Seen from the roller centre at cam angle 0 the cam axis lies in a direction theta in (-pi, 0).
# Conditions are examined at a set of cam angles. Cells of places that certainly break one of them
# are excluded, which leaves the neighbourhoods of the nearest places; there the nearest place is
# determined along each direction, and the direction with the smallest distance is enclosed. Then
# the cam angles at which the conditions of that place are extreme join the set, and the pairs at
# which its flanks are cut off, until it meets the conditions at all of them.


REACH, ROOM = 40.0, 4.0
"""The largest base radius searched: as a multiple of that for the transmission angle, and of
r_R/ratio. Far out the pitch curve is nearly a circle, and r_K nearly the base radius."""

DIRECTIONS, RADII = 61, 81
"""Size of the grid of places whose smallest ratio is reported if none is small enough."""

ZOOM, FINEST = 8.0, 1e-12
"""Each step encloses the direction eight times closer, down to this [rad]."""

MOST_STEPS = 40
"""Most steps; a step that ends at the end of its range moves the range, and widens it."""

LEAST_WIDTH, LEAST_SHARE = 1e-6, 1e-4
"""Least range of directions [rad], and of radii as a share of the first range, of a later
search."""

AGAIN = 4.0, 100.0
"""Range of directions and of radii of a later search, as multiples of the last move; at least those
above, and at most those of the first search."""

WIDTH = 1e-2
"""Half the range of directions [rad] about the last place that is searched for the next one."""

STRAY = 1e-3
"""If the nearest place is this fraction beyond the bound of the cells, they are searched again."""

BELOW, ABOVE = 0.06, 0.03
"""Range about the last radius that is searched for the next one; each step takes a third of it."""

DIGITS = 1e-12
"""Width of the last halves of a range of radii, as a fraction of the first range."""

SLIGHT = 1e-12
"""Conditions broken by this fraction of their terms count as met."""

ROUNDS = 40
"""Most rounds; a dozen is usual."""

STEP, GROWTH = 1e-9, 4.0
"""After the last round: the first step outward, as a fraction of the radius, and its growth."""


def worst_ratio(task: RollerTask, place: complex) -> tuple[float, float]:
    """Largest r_R/r_K for the sign that matters, at least 0, and its cam angle [rad].

    Raises GeometryError if the roller centre stands still in the cam.
    """
    bends = curvature_extremes(task.pitch_curve(place))
    curvatures = [
        (sign, bends.largest() if sign > 0.0 else bends.smallest()) for sign in task.signs
    ]
    sign, (kappa, phi) = max(curvatures, key=lambda signed: signed[0] * signed[1][0])
    return max(task.follower.roller_radius * sign * kappa, 0.0), phi


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """The place with the smallest base circle that keeps all conditions.

    Attributes
    ----------
    place : the place [mm]; None if the search has no result.
    bound : base radius [mm] below which there certainly is no place; infinite if there is none up
        to the largest one searched.
    least_ratio : without a place, the smallest r_R/r_K of a grid of places that keep the
        transmission angle; infinite if there are none.
    reach : largest base radius [mm] searched.
    rounds : rounds of exchange that the search took.
    examined : all cam angles, and pairs of them, that were examined.
    """

    place: complex | None
    bound: float
    least_ratio: float
    reach: float
    rounds: int
    examined: PlaceConditions


def smallest_with_bends(task: RollerTask, tangent: float, ratio: float, least: float) -> Nearest:
    """The place with the smallest base circle for mu and r_R/r_K, without undercut.

    Parameters
    ----------
    tangent : T = tan mu.
    ratio : largest r_R/r_K.
    least : base radius [mm] below which there is no place.
    """
    reach = max(REACH * least, ROOM * (task.follower.roller_radius / ratio + abs(task.start)))
    phi, covers = sample_angles(task), no_pairs(task)
    last: tuple[Start, ...] = ()
    share, bound = 1.0, least
    previous = 0.0, math.inf
    for number in range(1, ROUNDS + 1):
        conditions = place_conditions(task, tangent, ratio, phi, covers)
        reached = [_enclosed(task, conditions, start, least, share) for start in last]
        radius = min((pair[1] for pair in reached), default=math.inf)
        # Conditions are only added, so the nearest place can only move away; the cells are searched
        # again if it has moved by more than they left open.
        if not radius <= bound * (1.0 + STRAY):
            cells = nearest_cells(conditions, task.start, bound, reach, task.directions)
            bound = max(bound, cells.bound)
            if not cells.starts:
                least_ratio = _least_ratio(task, conditions, least, reach)
                return Nearest(None, bound, least_ratio, reach, number, conditions)
            reached += [_enclosed(task, conditions, start, least) for start in cells.starts]
            reached += [start[:2] for start in cells.starts]
        theta, radius = min(reached, key=lambda pair: pair[1])
        place = _place(task, theta, radius)
        extreme, broken = extreme_angles(task, place, tangent, ratio)
        more = no_pairs(task) if broken else covered_pairs(task, place)
        if not (broken or len(more.first)):
            return Nearest(place, bound, 0.0, reach, number, conditions)
        # The next round searches about this place, in ranges that follow its last move.
        moves = abs(theta - previous[0]), abs(radius - previous[1]) / radius
        last = ((theta, radius, min(max(AGAIN[0] * moves[0], LEAST_WIDTH), WIDTH)),)
        share, previous = min(max(AGAIN[1] * moves[1], LEAST_SHARE), 1.0), (theta, radius)
        phi = np.unique(np.concatenate((phi, extreme)))
        covers = covers + more
    place_beyond = _outward(task, theta, radius, tangent, ratio, reach)
    return Nearest(place_beyond, bound, math.inf, reach, ROUNDS, conditions)


def _place(task: RollerTask, theta: float, radius: float) -> complex:
    return complex(task.start + radius * np.exp(1j * theta))


def _outward(
    task: RollerTask, theta: float, radius: float, tangent: float, ratio: float, reach: float
) -> complex | None:
    """The first place farther out in the direction `theta` [rad] that meets all conditions, in
    growing steps; None if there is none up to `reach` [mm].
    """
    step = STEP
    while radius * (1.0 + step) < reach:
        place = _place(task, theta, radius * (1.0 + step))
        if meets(task, place, tangent, ratio):
            return place
        step *= GROWTH
    return None


def meets(task: RollerTask, place: complex, tangent: float, ratio: float) -> bool:
    """Whether the cam axis at `place` meets all conditions over the whole turn, up to rounding."""
    try:
        broken = extreme_angles(task, place, tangent, ratio)[1]
    except GeometryError:
        return False
    return not broken and not len(covered_pairs(task, place).first)


def extreme_angles(
    task: RollerTask, place: complex, tangent: float, ratio: float
) -> tuple[FloatArray, bool]:
    """Cam angles [rad] at which the conditions are extreme, and whether one is broken."""
    angles, broken = [], False
    size = abs(place) + abs(task.start)
    for t in (tangent, -tangent):
        margins = task.slack(place, t)
        broken = broken or float(np.min(margins.values)) < -SLIGHT * size * math.hypot(1.0, t)
        angles.append(margins.phi)
    curve = task.pitch_curve(place)
    try:
        bends = curvature_extremes(curve)
    except GeometryError:  # it stands still somewhere
        return np.concatenate(angles), True
    angles.append(bends.phi)
    for sign in task.signs:
        worst = float(np.max(sign * bends.values)) * task.follower.roller_radius
        broken = broken or worst > ratio * (1.0 + SLIGHT)
    if task.half > 0.0:
        distance, phi = nearest_to_axis(curve)
        broken = broken or distance <= task.half
        angles.append(np.array([phi]))
    return np.concatenate(angles), broken


def _least_ratio(
    task: RollerTask, conditions: PlaceConditions, least: float, reach: float
) -> float:
    first, last = task.directions
    theta = first + (last - first) * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    radii = np.geomspace(least, reach, RADII)
    places = (task.start + radii * np.exp(1j * theta)[:, np.newaxis]).ravel()
    free = PlaceConditions(conditions.terms, conditions.tangent, 0.0, 1.0, conditions.signs)
    inside = places[free.met(places)]
    return float(np.min(conditions.worst_ratio(inside))) if len(inside) else math.inf


def _enclosed(
    task: RollerTask, conditions: PlaceConditions, start: Start, least: float, share: float = 1.0
) -> tuple[float, float]:
    """Direction [rad] and base radius [mm] of the smallest circle near `start`; an infinite radius
    if there is none.

    `share` is the fraction of the full range of radii with which the search begins.
    """
    best, radius, width = start
    for _ in range(MOST_STEPS):
        # Cam angles at which the whole neighbourhood meets the conditions can be skipped.
        places = np.array([task.start + radius * np.exp(1j * best)])
        near = local_conditions(conditions, places, 1.1 * radius * (width + BELOW * share))
        theta = np.clip(best + width * np.linspace(-1.0, 1.0, 33), *task.directions)
        scan = radius * np.linspace(1.0 - BELOW * share, 1.0 + ABOVE * share, 46)
        halvings = max(1, math.ceil(math.log2(share / DIGITS)))
        reached = _nearest_along(task, near, theta, np.maximum(scan, least), halvings)
        index = int(np.argmin(reached))
        if not np.isfinite(reached[index]):
            return best, math.inf
        moved = theta[index] != best and index in (0, len(theta) - 1)
        best, radius = float(theta[index]), float(reached[index])
        if moved:  # it may lie beyond the end of the range
            width = min(2.0 * width, WIDTH)
            continue
        if width <= FINEST:
            break
        width /= ZOOM
        share /= 3.0
    return best, radius


def _nearest_along(
    task: RollerTask,
    conditions: PlaceConditions,
    theta: FloatArray,
    scan: FloatArray,
    halvings: int,
) -> FloatArray:
    """(k,) smallest base radius [mm] within `scan` in each direction; infinite if there is none."""
    ways = np.exp(1j * theta)
    met = conditions.met((task.start + scan * ways[:, np.newaxis]).ravel()).reshape(len(theta), -1)
    some = np.any(met, axis=1)
    first = np.argmax(met, axis=1)
    # The limit lies between the first radius that meets all conditions and the one before it; where
    # the first radius of the scan does, both are the same and nothing is bisected.
    good, bad = scan[first], scan[np.maximum(first - 1, 0)]
    for _ in range(halvings):
        middle = 0.5 * (good + bad)
        fine = conditions.met(task.start + middle * ways)
        good, bad = np.where(fine, middle, good), np.where(fine, bad, middle)
    return np.where(some, good, np.inf)


# -- cells ----------------------------------------------------------------------------------------
# Where the smallest base circle may be: cells that certainly break a condition are excluded.
#
# A cell is a patch of directions and distances seen from the roller centre at cam angle 0. Between
# its middle and any of its places (u, v) changes by at most half the diagonal, h, so all of it
# breaks
#
# - the transmission angle, if u - T |v| + h sqrt(1 + T^2) < 0 at one cam angle;
# - the curvature of one sign, if the largest value of
#   K rho^3 - sign (rho^2 - alpha u + beta v), K = ratio/r_R, rho = |(u, v)|,
#   is below 0 at one cam angle: the linear terms change by at most h |(alpha, beta)|, and the rest
#   has no maximum inside the range of rho;
# - the distance of the roller from the cam axis, if at one cam angle it is below half - h;
# - that no point of a flank is covered, see `camgeo.check.sizing.task`.
#
# The remaining cells are halved both ways. No place is dropped without proof: only those nearer
# than the best one found, by more than `GAP` of its distance, still matter.


FIRST_DIRECTIONS = 32
"""Number of directions of the first cells, which are as long as they are wide."""

LEVELS = 11
"""The last cells are 1e-4 of their distance wide."""

GAP = 2e-4
"""A place nearer by less than this fraction is left to the search along directions."""

MOST_CELLS = 12_000
"""Most cells of one level; the farthest beyond that are dropped, and bound what is proved."""

MOST_RUNS = 4
"""Neighbourhoods of the nearest places that are searched further."""

BLOCK = 2_000_000
"""Most values computed at once."""

Start = tuple[float, float, float]
"""Direction, base radius, and half the range of directions to search."""


@dataclass(frozen=True, slots=True)
class Neighbourhoods:
    """Neighbourhoods of the nearest places.

    Attributes
    ----------
    starts : one start of a search in each, the nearest first; empty if the middle of no cell meets
        the conditions.
    bound : base radius [mm] below which every place breaks a condition; infinite if all places do.
    """

    starts: tuple[Start, ...]
    bound: float


def nearest_cells(
    conditions: PlaceConditions,
    start: complex,
    least: float,
    reach: float,
    directions: tuple[float, float] = (-math.pi, 0.0),
) -> Neighbourhoods:
    """The neighbourhoods of the places nearest to `start` that meet `conditions`.

    They lie from `least` to `reach` [mm] away, in a range of `directions` [rad]; if the range is a
    single direction the cells have no width.
    """
    first, last = directions
    count = FIRST_DIRECTIONS if first < last else 1
    rows = max(1, math.ceil(math.log(reach / least) * FIRST_DIRECTIONS / math.pi))
    # Half the height of a cell in the logarithm of the distance, in which cells are square.
    height = 0.5 * math.log(reach / least) / rows
    width = 0.5 * (last - first) / count
    theta = first + width * (2.0 * np.arange(count) + 1.0)
    depth = math.log(least) + height * (2.0 * np.arange(rows) + 1.0)
    theta, depth = (grid.ravel() for grid in np.meshgrid(theta, depth))
    best, bound = math.inf, math.inf
    good = np.empty((2, 0))
    for _ in range(LEVELS):
        radius = np.exp(depth)
        places = start + radius * np.exp(1j * theta)
        # A bound on half the diagonal of a cell: its far side is exp(height) times as long as its
        # middle.
        half = radius * math.exp(height) * math.hypot(width, height)
        left = ~excluded(conditions, places, half)
        theta, depth, radius, places = theta[left], depth[left], radius[left], places[left]
        met = conditions.met(places)
        if np.any(met):
            best = min(best, float(np.min(radius[met])))
            good = np.concatenate((good, np.stack((theta[met], radius[met]))), axis=1)
        lower = np.exp(depth - height)
        open_ = lower < (1.0 - GAP) * best
        theta, depth, lower = theta[open_], depth[open_], lower[open_]
        if len(theta) > MOST_CELLS:
            # The nearest cells go on; below the nearest dropped one everything is still examined.
            order = np.argsort(lower)
            bound = min(bound, float(lower[order[MOST_CELLS]]))
            theta, depth = theta[order[:MOST_CELLS]], depth[order[:MOST_CELLS]]
        if not len(theta):
            break
        width, height = 0.5 * width, 0.5 * height
        ways = (-1.0, 1.0) if width > 0.0 else (0.0,)
        theta, depth = (
            np.concatenate([theta + s * width for s in ways for _ in range(2)]),
            np.concatenate([depth + s * height for _ in ways for s in (-1.0, 1.0)]),
        )
    if len(theta):
        bound = min(bound, float(np.exp(np.min(depth) - height)))
    return Neighbourhoods(_starts(good, best, width), min(bound, (1.0 - GAP) * best))


def excluded(conditions: PlaceConditions, places: ComplexArray, half: FloatArray) -> BoolArray:
    """(k,) whether all places within `half` (k,) [mm] of `places` (k,) break a condition."""
    count = 1 + len(places) * conditions.count // BLOCK
    parts = zip(np.array_split(places, count), np.array_split(half, count), strict=True)
    return np.concatenate(
        [_excluded(conditions, block[:, None], reach[:, None]) for block, reach in parts]
    )


def _excluded(conditions: PlaceConditions, places: ComplexArray, half: FloatArray) -> BoolArray:
    terms = conditions.terms
    u, v = terms.across_and_along(places)
    tilted = u - conditions.tangent * np.abs(v) + half * math.hypot(1.0, conditions.tangent)
    broken: BoolArray = np.any(tilted < 0.0, axis=1)
    if conditions.half > 0.0:
        broken |= np.any(terms.to_axis(places) + half <= conditions.half, axis=1)
    if conditions.covers is not None and len(conditions.covers.first) and not np.all(broken):
        rest = ~broken
        gap, pace = conditions.covers.gap(places[rest, 0])
        sure = gap + conditions.covers.change(half[rest], pace) < 0.0
        broken[rest] = np.any(sure, axis=1)
    rest = ~broken
    if not np.any(rest) or not conditions.roller > 0.0:
        return broken
    u, v, half = u[rest], v[rest], half[rest]
    rho = np.hypot(u, v)
    linear = terms.alpha * u - terms.beta * v
    slack = half * np.hypot(terms.alpha, terms.beta)
    bent = np.zeros(len(u), dtype=np.bool_)
    for sign in conditions.signs:
        # Without a maximum inside the range of rho, the larger value at its ends is the largest.
        value = np.full(rho.shape, -np.inf)
        for end in (np.maximum(rho - half, 0.0), rho + half):
            square = end * end
            value = np.maximum(
                value, (conditions.ratio / conditions.roller) * square * end - sign * square
            )
        bent |= np.any(value + sign * linear + slack < 0.0, axis=1)
    broken[rest] = bent
    return broken


def local_conditions(
    conditions: PlaceConditions, place: ComplexArray, half: float
) -> PlaceConditions:
    """The `conditions` without the cam angles and pairs at which all places within `half` [mm]
    of `place` (1,) meet them.

    At least one cam angle remains.
    """
    terms = conditions.terms
    u, v = terms.across_and_along(place)
    needed = u - conditions.tangent * np.abs(v) - half * math.hypot(1.0, conditions.tangent) < 0.0
    needed |= terms.to_axis(place) - half <= conditions.half
    covers = conditions.covers
    if covers is not None:
        gap, pace = covers.gap(place)
        covers = covers.some((gap - covers.change(np.array([[half]]), pace) < 0.0)[0])
    if conditions.roller > 0.0:
        slope = conditions.ratio / conditions.roller
        rho = np.hypot(u, v)
        low, high = np.maximum(rho - half, 0.0), rho + half
        linear = terms.alpha * u - terms.beta * v
        slack = half * np.hypot(terms.alpha, terms.beta)
        for sign in conditions.signs:
            # The minimum of slope rho^3 - sign rho^2, at 2/(3 slope) if that is in the range.
            end = np.clip(2.0 / (3.0 * slope), low, high) if sign > 0.0 else low
            needed |= end * end * (slope * end - sign) + sign * linear - slack < 0.0
    if not np.any(needed):
        needed[0] = True
    return replace(conditions, terms=taken(terms, needed), covers=covers)


def _starts(good: FloatArray, best: float, width: float) -> tuple[Start, ...]:
    """Starts in runs of neighbouring directions whose places are about as near as the nearest."""
    near = good[:, good[1] <= (1.0 + 4.0 * GAP) * best]
    if not near.shape[1]:
        return ()
    near = near[:, np.argsort(near[0])]
    cuts = np.flatnonzero(np.diff(near[0]) > 0.05) + 1
    runs = np.split(near, cuts, axis=1)
    runs.sort(key=lambda run: float(np.min(run[1])))
    starts = []
    for run in runs[:MOST_RUNS]:
        first = int(np.argmin(run[1]))
        reach = float(np.max(np.abs(run[0] - run[0, first])))
        starts.append((float(run[0, first]), float(run[1, first]), reach + 4.0 * width + 1e-3))
    return tuple(starts)


# -- conditions -----------------------------------------------------------------------------------
# All conditions on a place of the cam axis, at a set of cam angles.


ANGLES = 17
"""Cam angles per piece to start with; the exchange adds those that matter."""

BLOCK_OF_PLACES = 4_000_000
"""Most values computed at once."""


@dataclass(frozen=True, slots=True, eq=False)
class PlaceConditions:
    """All conditions on a place of the cam axis at a set of cam angles.

    Attributes
    ----------
    terms : the terms at these cam angles.
    tangent : tangent of the transmission angle.
    roller : r_R [mm].
    ratio : largest r_R/r_K.
    signs : signs of the curvatures that count.
    half : distance [mm] of the roller centre from the cam axis, see `RollerTask.half`.
    covers : pairs of cam angles; None if global undercut is left out.
    """

    terms: Terms
    tangent: float
    roller: float
    ratio: float
    signs: tuple[float, ...]
    half: float = 0.0
    covers: Covers | None = None

    @property
    def count(self) -> int:
        """The number of conditions on a place."""
        return len(self.terms.q) + (0 if self.covers is None else len(self.covers.first))

    def met(self, places: ComplexArray) -> BoolArray:
        """(k,) whether the places (k,) meet all conditions."""
        parts = np.array_split(places, 1 + len(places) * self.count // BLOCK_OF_PLACES)
        return np.concatenate([self._met(part) for part in parts])

    def _met(self, places: ComplexArray) -> BoolArray:
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        met = np.asarray(np.all(u >= self.tangent * np.abs(v), axis=1) & np.all(u > 0.0, axis=1))
        # Dearer conditions are computed only at places that meet the cheaper ones.
        if np.any(met) and self.half > 0.0:
            distance = self.terms.to_axis(places[met][:, np.newaxis])
            met[met] = np.all(distance > self.half, axis=1)
        if np.any(met):
            met[met] = self.worst_ratio(places[met]) <= self.ratio
        if np.any(met) and self.covers is not None:
            met[met] = self.covers.met(places[met])
        return met

    def room(self, places: ComplexArray) -> FloatArray:
        """(k,) margin of the tightest condition at the places (k,), as a fraction of its limit or
        as an angle [rad]; negative where one is broken.
        """
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        with np.errstate(divide="ignore", invalid="ignore"):
            # With u = |Z'| sin mu and v = |Z'| cos mu, (u - T |v|) / |Z'| over sqrt(1 + T^2) is the
            # sine of the angle by which mu exceeds its limit.
            angle_sine = (u - self.tangent * np.abs(v)) / np.hypot(u, v)
            margins = [np.min(angle_sine, axis=1) / math.hypot(1.0, self.tangent)]
            margins.append(1.0 - self.worst_ratio(places) / self.ratio)
        if self.half > 0.0:
            distance = self.terms.to_axis(places[:, np.newaxis])
            margins.append(np.min(distance, axis=1) / self.half - 1.0)
        if self.covers is not None and len(self.covers.first):
            gap = self.covers.gap(places)[0] / np.abs(self.covers.distance)
            margins.append(np.min(gap, axis=1))
        return np.asarray(np.nan_to_num(np.min(margins, axis=0), nan=-np.inf))

    def with_more(self, task: RollerTask, phi: FloatArray, covers: Covers) -> PlaceConditions:
        """These conditions and those of the `task` at the cam angles `phi` (n,) [rad] and of the
        pairs `covers`.
        """
        more = place_conditions(task, self.tangent, self.ratio, phi, covers).terms
        every = covers if self.covers is None else self.covers + covers
        return replace(self, terms=joined((self.terms, more)), covers=every)

    def worst_ratio(self, places: ComplexArray) -> FloatArray:
        """(k,) largest r_R/r_K for the sign that matters; Z' must not vanish."""
        kappa = self.terms.curvature(places[:, np.newaxis])
        worst = [np.max(sign * kappa, axis=1) for sign in self.signs]
        return np.asarray(self.roller * np.max(worst, axis=0))


def sample_angles(task: RollerTask) -> FloatArray:
    """(n,) cam angles [rad] inside all pieces, including their ends up to rounding."""
    share = np.linspace(0.0, 1.0, ANGLES)
    # At the very ends the neighbouring pieces would decide.
    share[0], share[-1] = 1e-9, 1.0 - 1e-9
    samples = [
        piece.start + (piece.end - piece.start) * (share[:1] if piece.dwell else share)
        for piece in smooth_pieces(task.motion)
    ]
    return np.concatenate(samples)


def place_conditions(
    task: RollerTask, tangent: float, ratio: float, phi: FloatArray, covers: Covers | None = None
) -> PlaceConditions:
    """The conditions at the cam angles `phi` (n,) [rad] and on both sides of each break, and those
    of the pairs `covers`.
    """
    breaks = task.motion.breaks
    right = task.terms(np.concatenate((phi, breaks)))
    terms = joined((right, task.terms(breaks, "left")))
    roller, half = task.follower.roller_radius, task.half
    return PlaceConditions(terms, tangent, roller, ratio, task.signs, half, covers)
