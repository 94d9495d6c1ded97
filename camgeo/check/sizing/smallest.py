"""The smallest base circle for a transmission angle and the rule r_R <= ratio r_K (eq. 3.36), of a
cam that has no undercut, local or global.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from camgeo.check.sizing.bends import (
    extreme_angles,
    meets,
    smallest_with_bends,
    worst_ratio,
)
from camgeo.check.sizing.conditions import Conditions, conditions
from camgeo.check.sizing.covering import Covers
from camgeo.check.sizing.exchange import largest_angle, smallest_place
from camgeo.check.sizing.flocke import Flocke, flocke
from camgeo.check.sizing.task import Task
from camgeo.check.transmission_angle import transmission_angle_extremes
from camgeo.curve.extremes import curvature_extremes
from camgeo.errors import GeometryError
from camgeo.numeric.extremes import Extreme
from camgeo.outline.clearance import nearest_to_axis
from camgeo.outline.cusps import CUSP
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
