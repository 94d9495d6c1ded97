"""A cam by its definition, in series of the cam angle: Z = W exp(-i sigma phi).

Nothing here is shared with the engine: W is the place of the roller centre on the follower, its
derivatives are those of its series, and curvature and angles follow from the tangent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch
from operator import attrgetter
from typing import Any, Final

from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from tests.motion.exact_laws import exact_lift
from tests.stability.high_precision import Number
from tests.stability.linkage import exact_linkage
from tests.stability.series import Series, direction, logarithm, root, variable

TERMS = 4
"""Z to Z'''."""

AnyFollower = TranslatingRoller | OscillatingRoller | TranslatingFlat | OscillatingFlat

AnyLinkage = SliderCrank | FourBar | SliderDrivenCrank

NUMBERS: Final[Mapping[type, tuple[str, ...]]] = {
    TranslatingRoller: ("offset", "guide_angle"),
    TranslatingFlat: ("guide_angle",),
    OscillatingRoller: ("pivot.real", "pivot.imag", "arm"),
    OscillatingFlat: ("pivot.real", "pivot.imag", "face_offset"),
    SliderCrank: ("crank", "coupler", "deflection"),
    FourBar: ("crank", "coupler", "lever", "shaft.real", "shaft.imag", "lever_angle"),
    SliderDrivenCrank: ("inner.crank", "inner.coupler", "inner.deflection"),
}
"""The attributes of each kind that are lengths and angles, in the order of its exact numbers."""


@dataclass(frozen=True, slots=True)
class Stage:
    """The discrete part of a move of a cam; `parameters` gives its numbers.

    Attributes
    ----------
    law : of the move, from rest to rest.
    follower, linkage : only their discrete choices are used; their numbers are in the parameters.
    rotation : sigma.
    """

    law: str
    follower: AnyFollower
    linkage: AnyLinkage | None
    rotation: int

    def parameters(
        self, start: float, end: float, low: float, high: float, inflection: float
    ) -> tuple[float, ...]:
        """The inputs of `jet` after the cam angle.

        start, end are the joints of the move [rad], degrees converted to radians and rounded once
        as in the engine; low, high the lifts there [mm or rad]; then lambda, and the numbers of the
        follower and of the linkage.
        """
        follower, linkage = self.follower, self.linkage
        found = [start, end, low, high, inflection, follower.roller_radius, follower.base_radius]
        found += numbers_of(follower)
        return (*found, *(() if linkage is None else numbers_of(linkage)))

    def demanded(self, phi: Number, parameters: Sequence[Number], terms: int) -> Series:
        """The demanded motion at the cam angle `phi` [rad]."""
        start, end, low, high, inflection, *_ = parameters
        span = end - start
        z = variable((phi - start) / span, 1 / span, terms)
        up, down = exact_lift(self.law, "R-R", {"inflection": inflection}, z)
        # From the nearer end, so that a very small lift keeps its digits.
        s: Series = low + (high - low) * up if z.terms[0] <= 0.5 else high - (high - low) * down
        return s

    def jet(self, phi: Number, parameters: Sequence[Number], terms: int = TERMS) -> CamJet:
        """The cam of a roller at the cam angle `phi` [rad]."""
        s = self.demanded(phi, parameters, terms)
        roller, *rest = parameters[5:]
        own, counted = s, s
        if self.linkage is not None:
            numbers = 1 + len(numbers_of(self.follower))
            motion, position = exact_linkage(self.linkage, *rest[numbers:])
            own, counted, rest = motion(s), position(s), rest[:numbers]
        centre, path = _carried(self.follower, own, *rest)
        turn = direction(variable(-self.rotation * phi, -self.rotation, terms))
        return CamJet(counted, centre * turn, path * turn, roller, self.rotation)


@dataclass(frozen=True, slots=True, eq=False)
class CamJet:
    """A cam at one cam angle.

    Attributes
    ----------
    lift : the lift [mm or rad], or of a rocker behind a linkage the angle of the crank [rad].
    centre : Z [mm].
    path : direction in which the follower moves the roller centre, seen from the cam.
    roller, rotation : r_R [mm] and sigma.
    """

    lift: Series
    centre: Series
    path: Series
    roller: Number
    rotation: int

    @property
    def bend(self) -> Series:
        """The curvature kappa [1/mm], two terms shorter than Z; positive where convex."""
        x1, y1 = self.centre.real.slope(), self.centre.imag.slope()
        x2, y2 = x1.slope(), y1.slope()
        x1, y1 = Series(x1.terms[:-1]), Series(y1.terms[:-1])
        return -self.rotation * (x1 * y2 - y1 * x2) / root(x1 * x1 + y1 * y1) ** 3

    @property
    def tilt(self) -> Series:
        """Angle from the follower's path to the tangent [rad], a term shorter than Z."""
        path = Series(tuple(mp.conj(term) for term in self.path.terms[:-1]))
        return logarithm(self.centre.slope() * path).imag

    @property
    def transmission_angle(self) -> Number:
        """Acute angle between the tangent and the follower's path [rad].

        The normals of both are the curve's normal and the rocker, or the normal of the guide.
        """
        turned = self.centre.terms[1] * mp.conj(self.path.terms[0])
        return mp.atan2(abs(mp.im(turned)), abs(mp.re(turned)))

    def flank(self, distance: Number) -> Series:
        """The parallel at `distance` [mm], outward positive; a term shorter than Z."""
        x1, y1 = self.centre.real.slope(), self.centre.imag.slope()
        tangent = self.centre.slope() / root(x1 * x1 + y1 * y1)
        turn = self.rotation * mp.mpc(0, 1)
        flank: Series = Series(self.centre.terms[:-1]) + tangent * (distance * turn)
        return flank

    def parallel(self, distance: Number) -> Number:
        """The point at `distance` [mm] outward of Z."""
        tangent = self.centre.terms[1] / abs(self.centre.terms[1])
        return self.centre.terms[0] + distance * self.rotation * mp.mpc(0, 1) * tangent


def numbers_of(part: AnyFollower | AnyLinkage) -> tuple[float, ...]:
    """The lengths and angles of a follower, behind its radii, or of a linkage."""
    return tuple(attrgetter(name)(part) for name in NUMBERS[type(part)])


@singledispatch
def _carried(follower: Any, *_: Any) -> tuple[Series, Series]:
    """W, and the direction in which the follower moves it."""
    raise TypeError(type(follower))


@_carried.register
def _on_guide(
    follower: TranslatingRoller, s: Series, base: Number, offset: Number, guide: Number
) -> tuple[Series, Series]:
    """W and the direction of the guide."""
    if abs(offset) > base:
        raise GeometryError("the roller cannot lie on the base circle", key="follower.offset")
    along = mp.expj(guide)
    height = mp.sqrt(base**2 - offset**2) + follower.direction * s
    centre = height * along + offset * along / mp.mpc(0, 1)
    return centre, variable(along, 0, len(s.terms))


@_carried.register
def _on_rocker(
    follower: OscillatingRoller, s: Series, base: Number, x: Number, y: Number, arm: Number
) -> tuple[Series, Series]:
    """W and the direction across the rocker."""
    pivot = mp.mpc(x, y)
    distance = abs(pivot)
    if not abs(distance - arm) < base < distance + arm:
        raise GeometryError("pivot, cam axis and roller form no triangle", key="follower")
    corner = mp.acos((distance**2 + arm**2 - base**2) / (2 * distance * arm))
    sense = 1 if follower.direction is None else follower.direction * follower.arm_side
    rocker = direction(sense * s + (follower.arm_side * corner + mp.arg(-pivot)))
    return arm * rocker + pivot, mp.mpc(0, 1) * rocker
