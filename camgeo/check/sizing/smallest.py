"""The smallest base circle for a transmission angle and the rule r_R <= ratio r_K (eq. 3.36), of a
cam that has no undercut, local or global.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from camgeo.check.flank import check_convexity, transmission_angle_extremes
from camgeo.check.sizing.bends import (
    Conditions,
    conditions,
    extreme_angles,
    meets,
    samples_of,
    smallest_with_bends,
    worst_ratio,
)
from camgeo.check.sizing.task import CONVEX, OVER_AXIS, Asked, Covers, FaceTask, Rows, Task
from camgeo.errors import GeometryError
from camgeo.geometry.outline.clearance import nearest_to_axis
from camgeo.geometry.outline.convex import (
    contact_extremes,
    convexity,
    smallest_radius,
    smallest_turn,
)
from camgeo.geometry.outline.outline import CUSP
from camgeo.geometry.pieces import curvature_extremes, extremes, smooth_pieces
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, dot
from camgeo.numeric.extremes import Extreme
from camgeo.units import TURN

ACTIVE = 1e-9
"""A condition this close to its limit is active: in rad for the angle, absolute for the ratio."""

SAME = 1e-7
"""Cam angles [rad] closer than this are the same."""

TOUCHES = 1e-7
"""A point within this fraction of |d| of being covered decides, if nothing else is as close."""

BESIDE = 1e-9
"""Fraction by which the roller stays beside the cam axis."""

SIDES: Final = {1: "ccw", -1: "cw"}
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
    """What a place of the cam axis results in.

    Attributes
    ----------
    place : see `Task` [mm].
    follower : with the cam axis there.
    transmission_angle : the smallest [rad], with its cam angle [rad].
    radius_ratio : the largest r_R/r_K, with its cam angle [rad]; 0 for a flat face.
    radius_of_curvature : the smallest of the outline under a flat face [mm], with its cam angle.
    face : where on a flat face the contact begins and ends [mm], with their cam angles.
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
        radius: float = self.follower.base_radius
        return radius

    @property
    def arm_side(self) -> str | None:
        """That of a rocker, as in scenes; None on a guide."""
        side = getattr(self.follower, "arm_side", None)
        return None if side is None else SIDES[side]

    @property
    def contact(self) -> tuple[float, float] | None:
        """From where to where the contact runs on a flat face [mm]."""
        return None if self.face is None else (self.face[0].value, self.face[1].value)


@dataclass(frozen=True, slots=True, eq=False)
class Sizing:
    """The answer.

    Attributes
    ----------
    angle, ratio : what was required; mu [rad] and r_R/r_K.
    construction : Flocke's; None for a flat face, and where no size will do.
    flocke : its proposal rated; None if its region is empty.
    for_angle : the smallest base circle for the transmission angle alone; None if there is none.
    answer : that for both; None if there is none.
    active : the conditions that decide it, at most two except by symmetry.
    nearest_angle : largest transmission angle [rad] that can be kept, if the required one cannot.
    nearest_ratio : smallest r_R/r_K of a grid of places, if the required one was not found.
    none_below : base radius [mm] below which there certainly is no place for all of it.
    reach : largest base radius [mm] searched for both; None if the answer is exact.
    radius : smallest radius of curvature required of the outline under a flat face [mm].
    hopeless : why no size at all will do; None if it is a matter of size.
    rounds : of exchange that the search took; 0 without one.
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
    examined: Conditions | None = field(default=None, repr=False)

    @property
    def exact(self) -> bool:
        """Whether the answer is exact to rounding; else `none_below` says what is proved."""
        return self.answer is not None and self.reach is None


def size(task: Task, angle: float, ratio: float) -> Sizing:
    """Flocke's proposal and the smallest base circle.

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
        raise GeometryError("must be above 0 and at most 1", key="radius_ratio", value=f"{ratio:g}")
    ratio = min(ratio, NO_CUSP)
    if task.cam.clearance > 0.0:  # beyond it, the flanks of a groove with play come to a cusp
        ratio = min(ratio, NO_CUSP * task.follower.roller_radius / task.cam.disc.flank_distance)
    tangent, hopeless = math.tan(angle), task.hopeless
    if hopeless is not None:
        return Sizing(angle, ratio, none_below=math.inf, hopeless=hopeless)
    construction = flocke(task, tangent)
    proposal = None if construction.place is None else rate(task, construction.place)
    begun = Sizing(angle, ratio, construction, proposal)
    place = smallest_place(task, tangent)
    if place is None:
        return replace(begun, nearest_angle=largest_angle(task), none_below=math.inf)
    base = abs(place - task.start)
    if not base > 0.0:
        raise GeometryError("there is nothing to size: the follower does not move", key="motion")
    for_angle = rate(task, place)
    if for_angle is not None and meets(task, place, tangent, ratio):
        now = conditions(task, tangent, ratio, extreme_angles(task, place, tangent, ratio)[0])
        return replace(
            begun,
            for_angle=for_angle,
            answer=for_angle,
            active=active_conditions(task, for_angle, angle, ratio),
            none_below=base,
            examined=now,
        )
    least = max(base, task.half * (1.0 + BESIDE))
    found = smallest_with_bends(task, tangent, ratio, least)
    answer = None if found.place is None else rate(task, found.place)
    pairs = found.examined.covers
    active = () if answer is None else active_conditions(task, answer, angle, ratio, pairs)
    least_ratio = found.least_ratio if math.isfinite(found.least_ratio) else None
    return replace(
        begun,
        for_angle=for_angle,
        answer=answer,
        active=active,
        nearest_ratio=least_ratio if answer is None else None,
        none_below=found.bound,
        reach=found.reach,
        rounds=found.rounds,
        examined=found.examined,
    )


def require_angle(angle: float) -> None:
    """GeometryError unless `angle` [rad] can be required of a transmission angle."""
    if not 0.0 < angle < math.radians(89.9):
        raise GeometryError(
            "must be above 0 and below 89.9 degrees",
            key="transmission_angle",
            value=f"{math.degrees(angle):g}",
        )


def rate(task: Task, place: complex) -> Rating | None:
    """What the cam axis at `place` results in; None if there is no such mechanism."""
    try:
        curve = task.pitch_curve_at(place)
        angle = transmission_angle_extremes(curve).smallest()
        ratio = worst_ratio(task, place)
    except GeometryError:
        return None
    return Rating(place, curve.follower, Extreme(*angle), Extreme(*ratio))


def active_conditions(
    task: Task, rating: Rating, angle: float, ratio: float, covers: Covers | None = None
) -> tuple[Active, ...]:
    """The conditions that are at their limits, by cam angle; of pairs one of their angles."""
    curve = task.pitch_curve_at(rating.place)
    angles = transmission_angle_extremes(curve)
    found = [
        Active("transmission-angle", float(phi) % TURN)
        for phi in angles.phi[np.abs(angles.values - angle) <= ACTIVE]
    ]
    bends = curvature_extremes(curve)
    for sign in task.signs:
        near = np.abs(sign * task.follower.roller_radius * bends.values - ratio) <= ACTIVE
        found += [Active("radius-ratio", float(phi) % TURN) for phi in bends.phi[near]]
    if task.half > 0.0:
        apart, phi = nearest_to_axis(curve)
        if apart <= task.half * (1.0 + 2.0 * BESIDE):
            found.append(Active("roller-over-axis", phi))
    if covers is not None and len(covers.first):
        gap = np.abs(covers.gap(np.array([rating.place]))[0][0] / covers.distance)
        least = int(np.argmin(gap))
        if gap[least] <= TOUCHES:
            found.append(Active("global-undercut", float(covers.first[least]) % TURN))
    kept: list[Active] = []
    for each in sorted(found, key=lambda item: (item.name, item.cam_angle)):
        last = kept[-1] if kept else None
        if last is None or last.name != each.name or each.cam_angle - last.cam_angle >= SAME:
            kept.append(each)
    return tuple(kept)


# -- faces ----------------------------------------------------------------------------------------
# The smallest base circle for a flat face: by exchange, from below, as for the transmission angle.
#
# The place with the smallest base circle that meets some conditions is found, those that it breaks
# most are added, and so on until none is broken, see `camgeo.check.sizing.smallest`. On a rocker
# that place is the smallest chi_0 that the arcs of all conditions have in common. So the answer is
# exact.


JUMP = "contact-jump"
"""Name of the finding that the velocity jumps."""

ACTIVE_SHARE = 1e-9
"""A condition this close to its limit, as a fraction of the size of its terms, is active."""

ENLARGED = 1e-5
"""Fraction by which a cam is enlarged to prove that no extreme was missed."""


def size_for_face(task: FaceTask, angle: float, radius: float) -> Sizing:
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
    low, high = lift_range(task.motion)
    if low == high:
        raise GeometryError("there is nothing to size: the follower does not move", key="motion")
    asked = task.asked(angle, radius)
    hopeless = _hopeless(task)
    place, active = (None, ()) if hopeless else smallest_for_face(task, asked)
    answer = None if place is None else rate_face(task, place)
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


def _hopeless(task: FaceTask) -> str | None:
    """Why no size will do (the linkage, a face that turns back, a velocity jump), or None."""
    if task.hopeless is not None:
        return task.hopeless
    curve = task.pitch_curve_at(task.present)
    findings = check_convexity(curve)
    if smallest_turn(curve)[0] <= 0.0:
        return findings[0].sentence
    return next((each.sentence for each in findings if each.name == JUMP), None)


def rate_face(task: FaceTask, place: complex) -> Rating | None:
    """What the cam axis at `place` results in; None if there is no such mechanism, or its face
    turns back in the cam.
    """
    try:
        curve = task.pitch_curve_at(place)
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


def smallest_for_face(task: FaceTask, asked: Asked) -> tuple[complex | None, tuple[Active, ...]]:
    """The place with the smallest base circle for which `asked` holds, and what decides it.

    None if there is none. tau must be positive over the turn, and the velocity without jumps.
    """
    known: Rows = task.rows(OVER_AXIS, np.zeros(1), "right", asked)
    place = task.lowest(known)
    for _ in range(MOST):
        if place is None:
            return None, ()
        curve = task.pitch_curve_at(place)
        broken, active = False, []
        for name in task.names:
            found = task.slack(curve, name, asked)
            size = CLOSE * (abs(place) + task.base_radius_at(place))
            worst = found.values < -size
            active += [
                Active(name, float(phi) % TURN)
                for phi in found.phi[np.abs(found.values) <= ACTIVE_SHARE * size / CLOSE]
            ]
            if np.any(worst):
                broken = True
                for side in BOTH_SIDES:
                    known = _joined(known, task.rows(name, found.phi[worst], side, asked))
        if not broken:
            missed = _missed(task, place)
            if missed is None:
                return place, tuple(active)
            known = _joined(known, task.rows(CONVEX, np.array([missed]), "right", asked))
        before, place = place, task.lowest(known)
        if place == before:
            return place, tuple(active)
    return None, ()


def _missed(task: FaceTask, place: complex) -> float | None:
    """Cam angle [rad] of a cusp or undercut that `slack` misses; None without one, as is usual.

    Of a cam that is larger by `BESIDE`: close to a cusp the proof takes ever smaller cells.
    """
    try:
        cam = task.cam.sized(base_radius=(1.0 + ENLARGED) * task.base_radius_at(place))
    except GeometryError:  # the face stands square to the line of centres
        return None
    found = convexity(cam.disc.pitch_curve)
    return None if found.is_convex else found.radius[1]


def _joined(one: Rows, other: Rows) -> Rows:
    a, b, c = (np.concatenate(each) for each in zip(one, other, strict=True))
    return a, b, c


# -- exchange -------------------------------------------------------------------------------------
# The smallest base circle for a transmission angle: a convex problem, solved by exchange.
#
# Every cam angle gives half-planes in which the cam axis must lie. The place nearest to the roller
# centre is found for some of them, those it violates most are added, and so on until none is
# violated. The worst violations are roots of a slope, so this converges like Newton's method.


CLOSE = 2e-14
"""A condition broken by this fraction of its terms is met up to rounding."""

MOST = 80
"""Most rounds; a dozen is usual."""

BISECTIONS = 26

BOTH_SIDES: Final[tuple[Side, ...]] = ("right", "left")


def smallest_place(task: Task, tangent: float) -> complex | None:
    """Place [mm] of the cam axis with the smallest base circle and mu >= atan(`tangent`).

    None if no place keeps that angle over the whole turn.
    """
    normals, bounds = task.held_to()
    place: complex = task.start
    for _ in range(MOST):
        broken = False
        for t in (tangent, -tangent):
            found = task.slack(place, t)
            size = (abs(place) + abs(task.start)) * math.hypot(1.0, t)
            size += float(np.max(np.abs(bounds), initial=0.0))
            worst = found.values < -CLOSE * size
            if np.any(worst):
                broken = True
                for side in BOTH_SIDES:
                    more = task.terms(found.phi[worst], side).half_planes(t)
                    normals = np.concatenate((normals, more[0]))
                    bounds = np.concatenate((bounds, more[1]))
        if not broken:
            return place
        normals, bounds = _different(normals, bounds)
        nearest = nearest_point(normals, bounds, task.start)
        if nearest is None:
            return None
        if nearest == place:
            return place
        place = nearest
    return place


def largest_angle(task: Task) -> float:
    """The largest transmission angle [rad] that some place keeps over the turn, from below."""
    low, high = 0.0, math.radians(89.0)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if smallest_place(task, math.tan(middle)) is None:
            high = middle
        else:
            low = middle
    return low


def _different(normals: ComplexArray, bounds: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Each half-plane once."""
    rows = np.unique(np.column_stack((normals.real, normals.imag, bounds)), axis=0)
    return rows[:, 0] + 1j * rows[:, 1], rows[:, 2]


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
    length = np.abs(normals)
    normals, bounds = normals / length, bounds / length
    feet = start + normals * (bounds - dot(normals, start))
    first, second = np.triu_indices(len(normals), 1)
    n1, n2, c1, c2 = normals[first], normals[second], bounds[first], bounds[second]
    area = n1.real * n2.imag - n1.imag * n2.real
    crossing = np.abs(area) > ROUNDING
    area = np.where(crossing, area, 1.0)
    vertices = ((c1 * n2.imag - c2 * n1.imag) + 1j * (c2 * n1.real - c1 * n2.real)) / area
    points = np.concatenate(([start], feet, vertices[crossing]))
    size = np.abs(points) + np.max(np.abs(bounds), initial=0.0)
    inside = np.ones(len(points), dtype=np.bool_)
    for normal, bound in zip(normals, bounds, strict=True):
        inside &= dot(points, normal) >= bound - ROUNDING * size
    if not np.any(inside):
        return None
    found = points[inside]
    return complex(found[np.argmin(np.abs(found - start))])


# -- flocke ---------------------------------------------------------------------------------------
# Flocke's construction of the cam axis (Wirsig section 2.4.1, eqs. 2.41 and 2.42 corrected).
#
# It takes the largest velocities of both senses at both end positions of the follower: more than
# any cam angle demands, so its place always keeps the transmission angle, and lies farther out than
# necessary. A single end position, or velocities in the middle of the stroke, would not be safe.


@dataclass(frozen=True, slots=True, eq=False)
class Flocke:
    """The construction and its proposal.

    Attributes
    ----------
    normals, bounds : (8,) or more half-planes Re(conj(n) P) >= c of the region, see `Task`.
    place : the place of the cam axis in it with the smallest base circle [mm]; None if it is empty.
    """

    normals: ComplexArray
    bounds: FloatArray
    place: complex | None


def flocke(task: Task, tangent: float) -> Flocke:
    """The construction for a transmission angle of atan(`tangent`)."""
    lifts = np.repeat(lift_range(task.motion), 2)
    rates = np.tile(_velocity_range(task), 2)
    terms = task.terms_of(np.stack((lifts, rates, np.zeros_like(lifts))))
    sides = zip(
        terms.half_planes(tangent), terms.half_planes(-tangent), task.held_to(), strict=True
    )
    normals, bounds = (np.concatenate(each) for each in sides)
    return Flocke(normals, bounds, nearest_point(normals, bounds, task.start))


def _velocity_range(task: Task) -> tuple[float, float]:
    """Smallest and largest s' [mm or 1/rad] over the turn."""

    def velocity(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(task.motion.jet(phi, side, 1)[1])

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(task.motion.jet(phi, side, 2)[2])

    found = extremes(task.motion, velocity, acceleration)
    return found.smallest()[0], found.largest()[0]


# -- region ---------------------------------------------------------------------------------------
# Where the cam axis may lie, for each row of a grid, with exact borders.
#
# The region of the transmission angle is convex: a row of equal Im P meets it in one interval. Its
# ends are the largest lower and the smallest upper bound of Re P over the cam angles.


SAMPLES = 65
SECTIONS, STEPS = 8, 12
"""A bracket is divided into sections; the two about the best cut form the next one."""


def row_limits(task: Task, tangent: float, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lower and upper end (k,), (k,) of Re P [mm] at Im P = `rows` (k,) [mm].

    In a row that does not meet the region the lower end is above the upper one. Ends are exact up
    to rounding where the decisive bound is smooth over the cam angle.
    """
    share = np.linspace(1e-9, 1.0 - 1e-9, SAMPLES)
    pieces = [
        each.start + (each.end - each.start) * (share[:1] if each.dwell else share)
        for each in smooth_pieces(task.motion)
    ]
    phi = np.concatenate(pieces)
    left = np.concatenate([np.append(each[:1], each[:-1]) for each in pieces])
    right = np.concatenate([np.append(each[1:], each[-1:]) for each in pieces])
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
    start = task.terms(np.zeros(1))
    low = np.where(rows < start.p[0], low, np.inf)
    return low, high


def _bound(
    task: Task, tangent: float, phi: FloatArray, rows: FloatArray, *, upper: bool
) -> FloatArray:
    """Lower bound of Re P, or minus the upper one, from u >= `tangent` v; -inf where it has none.

    `phi` and `rows` are broadcast; the motion is evaluated once at each cam angle.
    """
    terms = task.terms(phi.ravel())
    factor = (tangent + 1j) * terms.turn
    along, across = factor.real.reshape(phi.shape), factor.imag.reshape(phi.shape)
    constant = (tangent * terms.q - terms.p).reshape(phi.shape)
    rest = constant + across * rows
    used = np.broadcast_to(along < 0.0 if upper else along > 0.0, rest.shape)
    out = np.full(rest.shape, -np.inf)
    np.divide(rest, np.broadcast_to(along, rest.shape), out=out, where=used)
    if upper:
        out[used] *= -1.0
    return out


def _refined(
    task: Task,
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
    each = np.arange(len(rows))
    for _ in range(STEPS):
        grid = left[:, np.newaxis] + (right - left)[:, np.newaxis] * share
        values = _bound(task, tangent, grid, rows[:, np.newaxis], upper=upper)
        index = np.argmax(values, axis=1)
        best = np.maximum(best, values[each, index])
        width = (right - left) / SECTIONS
        left, right = grid[each, index] - width, grid[each, index] + width
    return best


def ratio_map(task: Task, columns: FloatArray, rows: FloatArray, most: float) -> FloatArray:
    """(rows, columns) largest r_R/r_K for the sign that matters, for a picture.

    On a grid of cam angles; `most` where it is larger or the roller centre stands still.
    """
    places = columns + 1j * rows[:, np.newaxis]
    now = conditions(task, 0.0, most, samples_of(task))
    with np.errstate(all="ignore"):  # a pitch curve may have cusps here
        worst = np.array([now.worst_ratio(row) for row in places])
    return np.where(worst <= most, np.maximum(worst, 0.0), most)


def flocke_limits(found: Flocke, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """As `row_limits`, for the region of Flocke's construction."""
    low, high = np.full(len(rows), -np.inf), np.full(len(rows), np.inf)
    for normal, bound in zip(found.normals, found.bounds, strict=True):
        rest = bound - normal.imag * rows
        if normal.real > 0.0:
            low = np.maximum(low, rest / normal.real)
        elif normal.real < 0.0:
            high = np.minimum(high, rest / normal.real)
    return low, high
