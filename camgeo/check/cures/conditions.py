"""What a cam must hold, as margins over the cam angle: positive where a limit is kept.

Each is a function of the place alone, so that the place where it is worst proves for which other
values of a size it is broken too. What no place decides by itself, as whether a flank crosses
itself, is left to the checks.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.finding import CONVEXITY, UNDERCUT
from camgeo.check.follower import check_follower
from camgeo.check.transmission_angle import transmission_angle_extremes
from camgeo.curve.extremes import Extremes, curvature_extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.together import one_curve
from camgeo.errors import GeometryError
from camgeo.lazy import Ledger
from camgeo.mechanism.several import alike
from camgeo.motion.piece import SNAP
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.outline.cusps import CUSP
from camgeo.units import TURN

Discs = tuple[Cam, ...]
"""The cam, or the main and the return cam of a pair. Both have one drive."""

SIDES: Final[tuple[Side, Side]] = ("right", "left")

Range = tuple[float, float]
"""Cam angles [rad] of two breaks, or the ends of a dwell."""


def sized(discs: Discs, number: int = 0, **sizes: float) -> Discs:
    """The same with other dimensions of the follower of disc `number`, as its table states them.

    A return roller follows the main one in what is not stated for it. GeometryError if the
    dimensions are impossible.
    """
    main, *others = discs
    if number == 0:
        main = main.sized(**sizes)
    changed = [main]
    for place, cam in enumerate(others, start=1):
        mount = cam.mount
        assert mount is not None  # what makes it the second disc of a pair
        mount = mount.sized(**sizes) if place == number else mount
        follower = mount.roller(main.follower)
        changed.append(replace(cam, follower=follower, mount=mount, ledger=Ledger()))
    return tuple(changed)


def moved(discs: Discs, plan: MotionPlan) -> Discs:
    """The same with another motion plan."""
    main, *others = discs
    main = main.moved(plan)
    return (main, *(replace(cam, drive=main.drive, ledger=Ledger()) for cam in others))


def plan_of(discs: Discs) -> MotionPlan:
    """The motion plan of their drive."""
    return discs[0].drive.plan


def angles_of(plan: MotionPlan, number: int) -> Range:
    """Cam angles [rad] at which a segment starts and ends."""
    first, last = plan.joints_deg[number : number + 2]
    return math.radians(float(first)), math.radians(float(last))


def segment_at(plan: MotionPlan, angle: float) -> int:
    """Index of the segment that contains the cam angle [rad]; the last with a length if none
    does.
    """
    last = 0
    for number, segment in enumerate(plan.segments):
        if not segment.span:
            continue
        start, end = angles_of(plan, number)
        if start <= angle < end:
            return number
        last = number
    return last


@dataclass(frozen=True, slots=True)
class Condition(ABC):
    """A limit at each cam angle.

    Attributes
    ----------
    names : beginnings of the names of the findings that report where it is broken.
    vital : whether there is no disc then.
    """

    names: ClassVar[tuple[str, ...]]
    vital: ClassVar[bool] = False

    @abstractmethod
    def over_turn(self, cam: Cam) -> Extremes:
        """All local extremes of the margin. GeometryError if the pitch curve stands still."""

    @abstractmethod
    def at(self, curve: PitchCurve, cams: Sequence[Cam], phi: FloatArray, side: Side) -> FloatArray:
        """(n,) what has the sign of the margins at `phi` (n,) [rad], and no poles, on `curve`,
        which is that of `cams`: one for each place, or one for all.
        """


@dataclass(frozen=True, slots=True)
class Bend(Condition):
    """1 + d kappa of the flanks in use: neither cusp nor local undercut, with the play of a groove.

    With `ratio` the rule r_R <= ratio r_K: the same, of a roller r_R/ratio without play.
    """

    names: ClassVar[tuple[str, ...]] = UNDERCUT
    vital = True

    ratio: float | None = None

    def _distances(self, cam: Cam) -> tuple[float, ...]:
        if self.ratio is None:
            return cam.distances
        radius = cam.follower.roller_radius / self.ratio
        return tuple(math.copysign(radius, each) for each in cam.distances)

    def over_turn(self, cam: Cam) -> Extremes:
        bends = curvature_extremes(cam.disc.pitch_curve)
        every = [1.0 + each * bends.values for each in self._distances(cam)]
        return Extremes(bends.phi, np.min(every, axis=0))

    def at(self, curve: PitchCurve, cams: Sequence[Cam], phi: FloatArray, side: Side) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=2)
        bend = curve.follower.curvature(relative, np.ones_like(phi), curve.rotation)
        speed = np.hypot(relative.u, relative.v)
        distances = np.array([self._distances(cam) for cam in cams]).T
        size = np.array([cam.follower.base_radius for cam in cams])
        return np.asarray(np.min(speed**3 + distances * bend, axis=0) / size**3)


@dataclass(frozen=True, slots=True)
class Ratio(Bend):
    """See `Bend`."""

    names = ("radius-ratio",)
    vital = False


@dataclass(frozen=True, slots=True)
class Angle(Condition):
    """The transmission angle beyond its `limit` [rad]."""

    names = ("transmission-angle",)

    limit: float

    def over_turn(self, cam: Cam) -> Extremes:
        found = transmission_angle_extremes(cam.disc.pitch_curve)
        return Extremes(found.phi, found.values - self.limit)

    def at(self, curve: PitchCurve, _: Sequence[Cam], phi: FloatArray, side: Side) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=1)
        u, v = np.abs(relative.u), np.abs(relative.v)
        return np.asarray(u * math.cos(self.limit) - v * math.sin(self.limit))


@dataclass(frozen=True, slots=True)
class Convex(Condition):
    """The radius of curvature under a flat face, as a fraction of the base radius."""

    names = (CONVEXITY,)
    vital = True

    def over_turn(self, cam: Cam) -> Extremes:
        from camgeo.outline.convex import SMALLEST, convexity  # few cams have a flat face

        radius, phi = convexity(cam.disc.pitch_curve).radius
        margin = radius / cam.follower.base_radius - SMALLEST
        return Extremes(np.array([phi]), np.array([margin]))

    def at(self, curve: PitchCurve, _: Sequence[Cam], phi: FloatArray, side: Side) -> FloatArray:
        from camgeo.outline.convex import SMALLEST, touch

        found, size = touch(curve, phi, side), curve.follower.base_radius
        return np.asarray(found.pace[0] - SMALLEST * size * found.turn[0])


Conditions = tuple[Condition, ...]


def worst_place(
    discs: Discs, conditions: Conditions, within: Range | None = None
) -> tuple[Condition, int, float] | None:
    """The first of the `conditions` that a disc breaks, the number of the disc, and the cam angle
    [rad] where it is worst; None if all are kept. `within` is all that is looked at.

    GeometryError if there is no such mechanism: it does not close, its roller covers the cam axis,
    its guide touches the base circle, or its roller centre stands still.
    """
    for number, cam in enumerate(discs):
        inside = cam.contact.runs_inside
        for wrong in check_follower(cam.follower, runs_on_inner=inside, clearance=cam.clearance):
            raise GeometryError(wrong.sentence, key="follower")
        for condition in conditions:
            found = condition.over_turn(cam)
            start, end = (0, len(found.phi)) if within is None else places_in(found, within)
            worst = start + int(np.argmin(found.values[start:end]))
            if found.values[worst] <= CUSP:
                return condition, number, float(found.phi[worst])
    return None


def places_in(found: Extremes, within: Range) -> tuple[int, int]:
    """The first and the last but one of the places `found` from one cam angle to the other, these
    seen from inside.
    """
    shift = TURN if within[0] < found.phi[0] - SNAP else 0.0
    start, end = within[0] + shift + SNAP, within[1] + shift - SNAP
    first = max(int(np.searchsorted(found.phi, start, side="right")) - 1, 0)
    return first, min(int(np.searchsorted(found.phi, end)) + 1, len(found.phi))


def margin_of_either_side(
    condition: Condition, curve: PitchCurve, cams: Sequence[Cam], phi: float, count: int
) -> FloatArray:
    """(count,) see `Condition.at`, all at `phi` [rad]: at a break the smaller one."""
    places = np.full(count, phi)
    both = [condition.at(curve, cams, places, side) for side in SIDES]
    return np.asarray(np.minimum(*both))


def margins_of_each(condition: Condition, cams: Sequence[Cam | None], phi: float) -> FloatArray:
    """(n,) the same of `cams` of one motion; -1 where there is no mechanism."""
    margins = np.full(len(cams), -1.0)
    kinds: dict[Hashable, list[int]] = {}
    for k, cam in enumerate(cams):
        if cam is not None:
            kinds.setdefault(alike(cam.follower), []).append(k)
    for places in kinds.values():
        some = [cam for k in places if (cam := cams[k]) is not None]
        curves = [cam.disc.pitch_curve for cam in some]
        curve = one_curve(curves, np.arange(len(some)), 1) if len(some) > 1 else curves[0]
        margins[places] = margin_of_either_side(condition, curve, some, phi, len(some))
    return margins
