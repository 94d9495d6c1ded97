"""A cam by its definition, in series of the cam angle: Z = W exp(-i sigma phi), with its linkage.

Nothing here is shared with the engine: W is the place of the roller centre on the follower, its
derivatives are those of its series, and curvature and angles follow from the tangent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch
from operator import attrgetter
from typing import Any, Final

from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from tests.motion.exact_laws import exact_lift
from tests.stability.series import Number, Series, direction, logarithm, root, variable

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


# Linkages -------------------------------------------------------------------------------------

Transform = Callable[[Series], Series]
"""Raises GeometryError if the linkage does not close."""


@singledispatch
def exact_linkage(linkage: Any, *numbers: Number) -> tuple[Transform, Transform]:
    """The follower's motion over the demanded position, and the value compared.

    That value is a crank's position [rad], of which its motion is a difference, or the stroke of a
    slider [mm]. `numbers` are the lengths and angles of `linkage`, as in `Stage.parameters`.
    """
    raise TypeError(type(linkage), numbers)


@exact_linkage.register
def _(
    linkage: SliderCrank, crank: Number, coupler: Number, deflection: Number
) -> tuple[Transform, Transform]:
    lean = crank * mp.sin(deflection)
    start = linkage.slider_side * (coupler - lean if linkage.leans_away else coupler + lean)
    height = crank * mp.cos(deflection)

    def crank_angle(stroke: Series) -> Series:
        """theta [rad]: the pin's angle minus that of the triangle of shaft, tip and pin."""
        pin = -(start + linkage.stroke_direction * stroke) + mp.mpc(0, 1) * height
        # Measured from straight above the shaft: a pin on the guide through the shaft stays off the
        # branch cut of the logarithm whichever way half an ulp moves it.
        upward = logarithm(pin * mp.mpc(0, -1)).imag
        angle: Series = upward + mp.pi / 2 - linkage.branch * _triangle(crank, coupler, pin)
        return angle

    def swing(stroke: Series) -> Series:
        """psi [rad] from stroke 0, counter-clockwise positive, in (-pi, pi]."""
        psi = crank_angle(stroke) - crank_angle(Series((mp.mpf(0),))).terms[0]
        psi = psi - 2 * mp.pi * mp.ceil((psi.terms[0] - mp.pi) / (2 * mp.pi))
        turned: Series = -psi if linkage.mirrored else psi
        return turned

    return swing, crank_angle


@exact_linkage.register
def _(
    linkage: FourBar,
    crank: Number,
    coupler: Number,
    length: Number,
    shaft_x: Number,
    shaft_y: Number,
    lever_angle: Number,
) -> tuple[Transform, Transform]:
    shaft = mp.mpc(shaft_x, shaft_y)

    def crank_angle(motion: Series) -> Series:
        """theta [rad]: the pin's angle minus that of the triangle of shaft, tip and pin.

        The pin's angle is continuous: it is that of the longer of shaft and lever, from which the
        pin stays within a quarter turn, plus the difference.
        """
        lever = linkage.lever_sense * motion + lever_angle
        arm = length * direction(lever)
        if abs(shaft) > length:
            about, rest = logarithm((arm + shaft) / shaft).imag, mp.arg(shaft)
        else:
            about, rest = logarithm((arm + shaft) / arm).imag, lever
        angle: Series = about + rest - linkage.branch * _triangle(crank, coupler, arm + shaft)
        return angle

    def swing(motion: Series) -> Series:
        """psi [rad] from motion 0, counter-clockwise positive."""
        psi: Series = crank_angle(motion) - crank_angle(Series((mp.mpf(0),))).terms[0]
        return psi

    return swing, crank_angle


@exact_linkage.register
def _(
    linkage: SliderDrivenCrank, crank: Number, coupler: Number, deflection: Number
) -> tuple[Transform, Transform]:
    inner, height = linkage.inner, crank * mp.cos(deflection)
    crank_angle = exact_linkage(inner, crank, coupler, deflection)[1]

    def pin(theta: Series) -> Series:
        tip = crank * direction(theta)
        square = coupler**2 - (height - tip.imag) ** 2
        _check_reach(square, "the coupler does not reach the guide")
        place: Series = tip.real + linkage.side * root(square)
        return place

    def stroke(motion: Series) -> Series:
        """s [mm] from angle 0."""
        start = crank_angle(Series((mp.mpf(0),))).terms[0]
        turned = -motion if inner.mirrored else motion
        way = pin(turned + start) - pin(Series((start,))).terms[0]
        found: Series = -inner.stroke_direction * way
        return found

    return stroke, stroke


def _triangle(crank: Number, coupler: Number, pin: Series) -> Series:
    """Angle at the shaft of the triangle shaft, tip, pin [rad], by the law of cosines.

    GeometryError if crank and coupler do not reach the pin, or are collinear.
    """
    square = pin.real**2 + pin.imag**2
    opposite = (square + (crank**2 - coupler**2)) / (2 * crank * root(square))
    across = 1 - opposite**2
    _check_reach(across, "crank and coupler do not reach the pin")
    angle: Series = logarithm(opposite + mp.mpc(0, 1) * root(across)).imag
    return angle


def _check_reach(square: Series, fault: str) -> None:
    """GeometryError where a root is not real, or lacks derivatives that are requested."""
    if not square.terms[0] > 0 and (len(square.terms) > 1 or square.terms[0] < 0):
        raise GeometryError(fault, key="linkage")


# Flat faces -----------------------------------------------------------------------------------
# The envelope of the lines of the face in the cam frame: the contact is where a line crosses its
# neighbour, by Cramer's rule, and its derivatives are those of the series.


@dataclass(frozen=True, slots=True, eq=False)
class FaceJet:
    """A flat face and its contact at one cam angle, seen from the cam.

    Attributes
    ----------
    lift : [mm or rad].
    normal : of the face, away from the cam axis.
    distance : of the face from the cam axis [mm].
    along : direction along the face in which the place of the contact is measured.
    origin : point from which the place of the contact is measured, or the point above it [mm].
    rotation : sigma.
    """

    lift: Series
    normal: Series
    distance: Series
    along: Series
    origin: Series
    rotation: int

    @property
    def contact(self) -> Series:
        """Z [mm], a term shorter than the lift."""
        a, b, h = (_shorter(each) for each in (self.normal.real, self.normal.imag, self.distance))
        a1, b1, h1 = self.normal.real.slope(), self.normal.imag.slope(), self.distance.slope()
        cross = a * b1 - b * a1
        x, y = (h * b1 - b * h1) / cross, (a * h1 - h * a1) / cross
        contact: Series = x + y * mp.mpc(0, 1)
        return contact

    @property
    def turn(self) -> Series:
        """tau, a term shorter than the lift."""
        turn: Series = -self.rotation * _dot(_square_to(_shorter(self.normal)), self.normal.slope())
        return turn

    @property
    def pace(self) -> Series:
        """p [mm/rad], two terms shorter than the lift: the part of Z' along t."""
        t = -self.rotation * _square_to(_shorter(_shorter(self.normal)))
        return _dot(t, self.contact.slope())

    @property
    def place(self) -> Series:
        """The place of the contact along the face [mm], a term shorter than the lift."""
        return _dot(_shorter(self.along), self.contact - _shorter(self.origin))

    @property
    def pressure_angle(self) -> Number:
        """Acute angle between the face's normal and the way of a rocker's contact [rad]."""
        lever = self.contact.terms[0] - self.origin.terms[0]
        turned = lever * mp.conj(self.normal.terms[0])
        return mp.atan2(abs(mp.re(turned)), abs(mp.im(turned)))


def face_jet(stage: Stage, phi: Number, parameters: Sequence[Number]) -> FaceJet:
    """The face at the cam angle `phi` [rad]; `parameters` as of `Stage`.

    GeometryError if the face cannot be that far from the cam axis.
    """
    s = stage.demanded(phi, parameters, TERMS)
    base, *rest = parameters[6:]
    normal, distance, along, origin = _held(stage.follower, s, base, *rest)
    turn = direction(variable(-stage.rotation * phi, -stage.rotation, TERMS))
    return FaceJet(s, normal * turn, distance, along * turn, origin * turn, stage.rotation)


@singledispatch
def _held(follower: Any, *_: Any) -> tuple[Series, Series, Series, Series]:
    """Normal, distance, direction and origin of the face in the fixed frame, see `FaceJet`."""
    raise TypeError(type(follower))


@_held.register
def _face_on_guide(
    follower: TranslatingFlat, s: Series, base: Number, guide: Number
) -> tuple[Series, Series, Series, Series]:
    normal = variable(mp.expj(guide), 0, TERMS)
    along = normal / mp.mpc(0, 1)  # to the right
    return normal, base + follower.direction * s, along, variable(mp.mpf(0), 0, TERMS)


@_held.register
def _face_on_rocker(
    follower: OscillatingFlat, s: Series, base: Number, x: Number, y: Number, offset: Number
) -> tuple[Series, Series, Series, Series]:
    pivot = mp.mpc(x, y)
    if not abs(base - offset) < abs(pivot):
        raise GeometryError("the face cannot lie there", key="follower.base_radius")
    corner = mp.asin((base - offset) / abs(pivot))
    side = follower.arm_side
    sense = 1 if follower.direction is None else follower.direction * side
    along = direction(sense * s + (mp.arg(-pivot) + side * corner))
    normal = along * mp.mpc(0, side)
    origin = variable(pivot, 0, TERMS)
    return normal, _dot(normal, origin) + offset, along, origin


def _shorter(x: Series) -> Series:
    return Series(x.terms[:-1])


def _dot(a: Series, b: Series) -> Series:
    product: Series = a.real * b.real + a.imag * b.imag
    return product


def _square_to(x: Series) -> Series:
    turned: Series = x * mp.mpc(0, 1)
    return turned
