"""The linkages between the demanded motion and the follower: slider-cranks and four-bars."""

from __future__ import annotations

import cmath
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linkage import ROUNDING, TO_FAR_END, Size, periodic_angles
from camgeo.kinematics.mechanism.sketch import Dimension, Guide, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Angle, Branch, Length, Place, Sense, angle
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot, phase
from camgeo.numeric.checked import Truth, check_fields, instance
from camgeo.numeric.interval import WIDENED, Angles, Interval
from camgeo.units import TURN

# -- triangle --------------------------------------------------------------------------------------
# The triangle of a linkage: shaft, pin and the tip of the crank, closed by crank and coupler.


SLACK = 64.0 * 2.0**-52
"""An angle [rad] that exceeds the end of a range by no more than this counts as at its end."""

IN_LINE = 1e-6
"""Largest sine of the angle between two members that counts as in line; on the other branch of the
linkage the members are far from being in line."""


AREA = 2.0**-40
"""Fraction of the area of a triangle by which bounds are widened; it far exceeds the rounding."""

ROUNDS = 2
"""How often angles and slopes are enclosed alternately: for small cells two rounds determine all
but the last digits."""


@dataclass(frozen=True)
class RockerCrank(ABC):
    """Base of linkages whose crank turns the rocker: the triangle of shaft, pin and tip.

    Attributes
    ----------
    crank : from the rocker's shaft to the tip [mm].
    coupler : from the tip to the pin, by which the far end moves [mm].
    """

    crank: Length
    coupler: Length

    if TYPE_CHECKING:  # a field of each

        @property
        @abstractmethod
        def branch(self) -> int:
            """Side of the pin on which the crank's tip lies, seen from the shaft: +1 clockwise."""

    @abstractmethod
    def _distance(self, position: FloatArray) -> FloatArray:
        """d (n,) [mm], from the shaft to the pin."""

    @abstractmethod
    def _pin_angle(self, position: FloatArray) -> FloatArray:
        """Direction (n,) [rad] from the shaft to the pin."""

    @abstractmethod
    def _growth(self, position: FloatArray) -> FloatArray:
        """(n,) d^2 minus its value at position 0 [mm^2]."""

    @abstractmethod
    def _farthest_and_nearest(
        self, position: FloatArray, reach: FloatArray
    ) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
        """`_growth` and `_distance` (n,) where d is largest and where it is smallest, over the
        positions within `reach` (n,) of `position` (n,).
        """

    @abstractmethod
    def _pin_heading(self, position: FloatArray, reach: FloatArray) -> Angles:
        """Directions in which the pin moves for the positions within `reach` (n,) of `position`
        (n,); the opposite directions if the pace of the pin is negative.
        """

    @property
    @abstractmethod
    def _pin_pace(self) -> tuple[float, float]:
        """Pace of the pin [mm per mm or rad], signed, and the rate at which its direction turns
        with the position: -1, 0 or 1.
        """

    @property
    def _crank_longer(self) -> bool:
        return self.crank > self.coupler

    @property
    @abstractmethod
    def _start_gaps(self) -> tuple[float, float]:
        """(crank + coupler)^2 - d^2 and d^2 - (crank - coupler)^2 [mm^2] at position 0."""

    def missing_length(self, position: FloatArray) -> FloatArray:
        """(n,) [mm] distance by which crank and coupler miss the pin; <= 0 where they reach it."""
        d = self._distance(position)
        return np.maximum(d - (self.crank + self.coupler), abs(self.crank - self.coupler) - d)

    def half_angle(self, growth: FloatArray, d: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Sine and cosine, times a common factor, of half the angle pin - shaft - tip, in (0, pi).

        `d` (n,) is the distance shaft - pin [mm], `growth` (n,) its square minus that at the start
        [mm^2]. Together with `_start_gaps` it keeps the digits of a motion that starts at a dead
        centre, which would be lost in d.

        The squares add up to 4 l_sk d; the product is D/2, twice the area of the triangle shaft,
        pin, tip, zero at a dead centre (D as in the robust form of Wirsig eq. 3.10).
        """
        outer, inner = self._start_gaps
        difference = self.crank - self.coupler
        shortest = abs(difference)
        reach = d + shortest
        near = (inner + growth) / reach  # d - |l_sk - l_4|
        cancels = inner + np.abs(growth) > reach * reach  # the pin has come close to the shaft
        near = np.where(cancels, d - shortest, near)
        short, long = (near, reach) if self._crank_longer else (reach, near)
        total = d + (self.crank + self.coupler)
        first = (outer - growth) / total * short
        second = long * total
        # At a dead centre rounding may make the radicands slightly negative.
        return np.sqrt(np.maximum(first, 0.0)), np.sqrt(np.maximum(second, 0.0))

    def position_half_angle(self, position: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(n,), (n,) the results of `half_angle` at `position` (n,)."""
        return self.half_angle(self._growth(position), self._distance(position))

    @abstractmethod
    def _far_sine(self, position: FloatArray) -> FloatArray:
        """(n,) sine of the angle between coupler and far member, row `TO_FAR_END` of
        `transmission_sines`.
        """

    def transmission_sines(self, position: FloatArray) -> FloatArray:
        """See `Linkage.transmission_sines`."""
        area = np.multiply(*self.position_half_angle(position)) / (2.0 * self.crank * self.coupler)
        return np.stack((self._far_sine(position), self.branch * area))

    def crank_angle(self, position: FloatArray) -> FloatArray:
        """theta (n,) [rad] at `position` (n,), by Wirsig eq. 3.10 in a form without poles."""
        sine, cosine = self.position_half_angle(position)
        return self._pin_angle(position) - self.branch * 2.0 * np.arctan2(sine, cosine)

    def transform_bounds(self, jet: Jet, bounds: Jet) -> Jet:
        """See `Linkage.transform_bounds`."""
        return chained(self._swing_slopes(jet[0], bounds[0]), bounds)

    def _swing_slopes(
        self, position: FloatArray, reach: FloatArray
    ) -> tuple[Interval, Interval, Interval]:
        """Ranges of dpsi/dx and of two more derivatives, up to their sign, over the positions
        within `reach` (n,) of `position` (n,); infinite where these may touch a dead centre.

        With the direction v of the coupler, unit vectors along coupler and crank, and the
        derivatives of the pin P:

            l_sk theta'   sin(v - theta) = P'.e_v
            l_4  v'       sin(v - theta) = -P'.e_theta
            l_sk theta''  sin(v - theta) = P''.e_v + l_sk theta'^2 cos(v - theta) + l_4 v'^2
            l_4  v''      sin(v - theta) = -(P''.e_theta + l_4 v'^2 cos(v - theta) + l_sk theta'^2)
            l_sk (theta''' - theta'^3) sin(v - theta)
                = P'''.e_v + 3 l_sk theta' theta'' cos(v - theta) + 3 l_4 v' v''

        Interval arithmetic: near a dead centre the terms of a sum almost cancel, so that bounds of
        their magnitudes alone would exceed it by many orders. The angles are enclosed by their
        slopes and these by the angles, in turn.
        """
        crank, coupler, (pace, turns) = self.crank, self.coupler, self._pin_pace
        tip = np.exp(1j * self.crank_angle(position))
        d = self._distance(position)
        rod = d * np.exp(1j * self._pin_angle(position)) - crank * tip
        # Unit vector along the coupler: exp(i v).
        rod /= np.abs(rod)
        rounding = WIDENED * (1.0 + (d + crank) / coupler)
        heading = self._pin_heading(position, reach)
        along, on_crank = (Angles(vector.real, vector.imag, rounding) for vector in (rod, tip))
        crank_to_coupler, to_coupler, to_crank = (
            along - on_crank,
            heading - along,
            heading - on_crank,
        )
        ends = self._farthest_and_nearest(position, reach)
        # sin(v - theta) is twice the area of the triangle over crank and coupler. The area is
        # concave in d^2, so over a range of d it is smallest at one of the ends.
        least = np.minimum(*(np.multiply(*self.half_angle(*end)) for end in ends))
        least *= (1.0 - AREA) / (2.0 * crank * coupler)
        whole = np.ones_like(least)
        area = Interval(least, whole) if self.branch > 0 else Interval(-whole, -least)
        # Nothing is known of the slopes at first; the area alone bounds them in the first round.
        theta1 = v1 = Interval(-np.inf * whole, np.inf * whole)
        for _ in range(ROUNDS):
            # How far crank and coupler turn within the cell.
            far, farther = times(reach, theta1), times(reach, v1)
            across = crank_to_coupler.reaching(crank_to_coupler.reach + far + farther)
            # Both enclose sin(v - theta): one follows from the area, one from the directions.
            area = area.intersection(across.sine)
            inverse = area.inverse
            in_line = to_coupler.reaching(to_coupler.reach + farther)
            in_crank = to_crank.reaching(to_crank.reach + far)
            theta1 = theta1.intersection((in_line.cosine * inverse).scaled(pace / crank))
            v1 = v1.intersection((in_crank.cosine * inverse).scaled(-pace / coupler))
        swing, turn = theta1.squared().scaled(crank), v1.squared().scaled(coupler)
        cosine = across.cosine
        theta2 = swing * cosine + turn
        v2 = turn * cosine + swing
        if turns:
            theta2 += in_line.sine.scaled(-turns * pace)
            v2 += in_crank.sine.scaled(-turns * pace)
        theta2, v2 = (theta2 * inverse).scaled(1.0 / crank), (v2 * inverse).scaled(-1.0 / coupler)
        theta3 = (theta1 * theta2 * cosine).scaled(3.0 * crank) + (v1 * v2).scaled(3.0 * coupler)
        if turns:
            theta3 += in_line.cosine.scaled(-pace)
        theta3 = (theta3 * inverse).scaled(1.0 / crank) + theta1.squared() * theta1
        return theta1, theta2, theta3

    @cached_property
    def start_angle(self) -> float:
        """theta at position 0 [rad]."""
        return float(self.crank_angle(np.zeros(1))[0])

    def resized(self, size: Size, length: float) -> Self:
        """See `Linkage.resized`."""
        changes: dict[str, Any] = {size: length}
        return replace(self, **changes)


def passed_at_rest(divisor: FloatArray, jet: Jet, message: str) -> FloatArray:
    """`divisor` (n,), with 1 in place of 0 at dead centres at which the motion `jet` (4, n) rests.

    GeometryError with key "linkage" and `message`, which says what is infinite, if it moves there.
    """
    if np.all(divisor):
        return divisor
    dead = divisor == 0.0
    if np.any(jet[1:, dead]):
        raise GeometryError(message, key="linkage")
    return np.where(dead, 1.0, divisor)


def chained(slopes: tuple[Interval, Interval, Interval], bounds: Jet) -> Jet:
    """(4, n) bounds of a motion q(x) over cells, by the chain rule; 0 at rest, infinite where
    unknown.

    `slopes` are the ranges of dq/dx and of two more derivatives over each cell, `bounds` (4, n) the
    bounds of x and its derivatives.
    """
    q1, q2, q3 = (slope.magnitude for slope in slopes)
    x0, x1, x2, x3 = bounds
    with np.errstate(invalid="ignore", over="ignore"):
        second = q2 * x1 * x1 + q1 * x2
        chained_bounds = np.stack(
            (q1 * x0, q1 * x1, second, q3 * x1**3 + 3.0 * q2 * x1 * x2 + q1 * x3)
        )
    # A cell at rest has no motion even where the slopes are infinite, 0 times infinity.
    resting = np.all(bounds == 0.0, axis=0)
    return np.where(resting, 0.0, np.where(np.isnan(chained_bounds), np.inf, chained_bounds))


def times(reach: FloatArray, slope: Interval) -> FloatArray:
    """(n,) how far a quantity with this `slope` moves within `reach` (n,); 0 at rest."""
    with np.errstate(invalid="ignore"):
        far = reach * slope.magnitude
    return np.where(reach == 0.0, 0.0, far)


def level(height: float, length: float) -> tuple[float, ...]:
    """Both horizontal offsets [mm] of the end of a `length` that rises by `height`; none if it is
    too short.
    """
    square = (length - height) * (length + height)
    return (math.sqrt(square), -math.sqrt(square)) if square >= 0.0 else ()


def in_line(places: tuple[float, ...], sines: FloatArray) -> tuple[float, ...]:
    """The `places` at which two members are in line on this branch of the linkage.

    `sines` (n,) are the sines of the angle between the members at these places; places with a large
    one belong to the other branch.
    """
    return tuple(
        place for place, sine in zip(places, np.abs(sines), strict=True) if sine <= IN_LINE
    )


def turning(joint: ComplexArray, rates: FloatArray) -> ComplexArray:
    """(2, n) first and second derivative of `joint` (n,), which turns about 0 with `rates` (2, n).

    `rates` are the derivatives of its angle: z' = i a' z, z'' = (i a'' - a'^2) z.
    """
    first, second = rates
    return np.stack((1j * first * joint, (1j * second - first * first) * joint))


def rocker_crank_sketch(
    shaft: complex, joints: tuple[ComplexArray, ComplexArray]
) -> MechanismSketch[Places]:
    """Crank and coupler of a linkage on the rocker's `shaft` [mm]; `joints` are seen from there."""
    pin, tip = (shaft + joint for joint in joints)
    return crank_and_coupler(shaft, tip, pin)


def crank_and_coupler(
    shaft: complex, tip: ComplexArray, pin: ComplexArray
) -> MechanismSketch[Places]:
    """Crank and coupler at these places [mm]; `tip` and `pin` are (n,)."""
    return MechanismSketch(
        links=((shaft, tip), (tip, pin)),
        joints=(tip, pin),
        shafts=(shaft,),
        dimensions=(Dimension("crank", shaft, tip), Dimension("coupler", tip, pin)),
    )


# -- slider crank ----------------------------------------------------------------------------------
# Slider-crank between the slider, whose stroke is demanded, and the rocker that follows the cam.
#
# Frame of the formulas (as in the thesis's program): the rocker shaft B_0 at the origin, the
# slider's guide horizontal at height e_sk above it. The pin on the slider is P = -X + i e_sk with
# X = s_0 + eps_s s, positive X to the left; the crank tip is T = l_sk exp(i theta), |P - T| = l_4.


AcuteAngle = Annotated[float, partial(angle, low=-0.5 * math.pi, high=0.5 * math.pi)]


@dataclass(frozen=True)
class SliderCrank(RockerCrank):
    """Slider-crank on the rocker shaft (Wirsig section 3.3.1, corrected as docs/sources.md says).

    Attributes
    ----------
    crank : l_sk, crank on the rocker shaft [mm].
    coupler : l_4 [mm].
    deflection : alpha_sk, angle of the crank from the perpendicular to the guide at stroke 0 [rad],
        -pi/2 to pi/2.
    leans_away : True if at stroke 0 the crank leans away from the slider (Q21 "ja"),
        s_0 = l_4 - l_sk sin alpha_sk; False if towards it, s_0 = l_4 + l_sk sin alpha_sk.
    slider_side : +1 if at stroke 0 the slider is to the left of the rocker shaft, -1 to the right
        (Q25; the thesis's program ignores it for a crank that leans towards the slider).
    stroke_direction : eps_s, +1 if a positive stroke moves the slider to the left, -1 to the right
        (Q22).
    branch : eps_b, +1 if the crank tip lies clockwise of the pin seen from the rocker shaft, -1
        counter-clockwise (Q23, "erster" and "zweiter Quadrant").
    mirrored : True if the linkage is seen from behind: the rocker turns the other way (Q24).

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "linkage", if the linkage does not
        close at stroke 0.
    """

    member: ClassVar[Literal["slider"]] = "slider"
    unit: ClassVar[Literal["mm"]] = "mm"

    deflection: Annotated[AcuteAngle, "crank_deflection"]
    leans_away: Annotated[Truth, "crank_leans"]
    slider_side: Sense
    stroke_direction: Sense
    branch: Branch
    mirrored: Truth = False

    def __post_init__(self) -> None:
        check_fields(self, "linkage.")
        gap = self.missing_length(np.zeros(1))[0]
        if gap > 0.0:
            raise GeometryError(
                f"the linkage does not close at stroke 0: it misses by {gap:.6g} mm", key="linkage"
            )

    @cached_property
    def guide_height(self) -> float:
        """e_sk, distance of the guide from the rocker shaft [mm]."""
        return self.crank * math.cos(self.deflection)

    @property
    def _height_square(self) -> float:
        return self.guide_height**2

    @cached_property
    def start_position(self) -> float:
        """s_0, X at stroke 0 [mm]."""
        lean = self.crank * math.sin(self.deflection)
        distance = self.coupler - lean if self.leans_away else self.coupler + lean
        return self.slider_side * distance

    @cached_property
    def coupler_angle(self) -> float:
        """Angle of the coupler, tip to pin, at stroke 0 [rad]; 0 or pi if parallel to the guide.

        The dimensions are defined for a coupler parallel to the guide at stroke 0; if it is not,
        the other branch was meant.
        """
        pin = -self.start_position + 1j * self.guide_height
        tip = self.crank * complex(math.cos(self.start_angle), math.sin(self.start_angle))
        return math.atan2((pin - tip).imag, (pin - tip).real)

    @cached_property
    def dead_strokes(self) -> tuple[float, ...]:
        """The strokes [mm] at which crank and coupler are in line."""
        return tuple(
            self.stroke_direction * (x - self.start_position)
            for reach in (self.crank + self.coupler, abs(self.crank - self.coupler))
            for x in level(self.guide_height, reach)
        )

    def dead_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.dead_positions`."""
        return tuple(stroke for stroke in self.dead_strokes if low <= stroke <= high)

    def turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.turning_positions`: where the pin passes the shaft."""
        passing = -self.stroke_direction * self.start_position
        return (passing,) if low <= passing <= high else ()

    def pin(self, stroke: FloatArray) -> tuple[FloatArray, FloatArray]:
        """X (n,) and d = |P| (n,) [mm] at `stroke` (n,) [mm]."""
        x = self.start_position + self.stroke_direction * stroke
        return x, np.sqrt(x * x + self._height_square)

    def _distance(self, stroke: FloatArray) -> FloatArray:
        """d (n,) [mm], from the shaft to the pin."""
        return self.pin(stroke)[1]

    def _pin_angle(self, stroke: FloatArray) -> FloatArray:
        """Direction (n,) [rad] from the shaft to the pin, in (0, pi)."""
        return np.arctan2(self.guide_height, -self.pin(stroke)[0])

    def _farthest_and_nearest(
        self, stroke: FloatArray, reach: FloatArray
    ) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
        x, start = np.abs(self.pin(stroke)[0]), self.start_position

        def growth_and_distance(x_reached: FloatArray) -> tuple[FloatArray, FloatArray]:
            return (x_reached - start) * (x_reached + start), np.hypot(x_reached, self.guide_height)

        return growth_and_distance(x + reach), growth_and_distance(np.maximum(x - reach, 0.0))

    def _pin_heading(self, stroke: FloatArray, reach: FloatArray) -> Angles:
        """The pin moves along the guide."""
        none = np.zeros_like(stroke)
        return Angles(none + 1.0, none, none)

    @property
    def _pin_pace(self) -> tuple[float, float]:
        return -self.stroke_direction, 0.0

    @cached_property
    def _start_gaps(self) -> tuple[float, float]:
        """(l_sk + l_4)^2 - d^2 and d^2 - (l_sk - l_4)^2 [mm^2] at stroke 0, accurate where tiny."""
        lean = -self.deflection if self.leans_away else self.deflection
        outer = math.sin(0.5 * (0.5 * math.pi - lean))
        inner = math.sin(0.5 * (0.5 * math.pi + lean))
        product = 4.0 * self.crank * self.coupler
        return product * outer * outer, product * inner * inner

    def _growth(self, stroke: FloatArray) -> FloatArray:
        """d^2 minus its value at stroke 0 [mm^2]."""
        return np.asarray(stroke * (2.0 * self.stroke_direction * self.start_position + stroke))

    def transform(self, jet: Jet, order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) rocker angle psi and derivatives [rad/rad^k] for strokes `jet`.

        `jet` (4, n) is the slider's stroke and its derivatives [mm/rad^k]; order is at least 1.

        psi is measured from stroke 0, counter-clockwise positive, in (-pi, pi].

        Raises
        ------
        GeometryError
            With key "linkage", at a dead centre that is not passed at rest: psi'' is infinite.
        """
        x, d = self.pin(jet[0])
        crank, coupler = self.crank, self.coupler
        half_sine, half_cosine = self.half_angle(self._growth(jet[0]), d)
        theta = np.arctan2(self.guide_height, -x)
        theta -= self.branch * 2.0 * np.arctan2(half_sine, half_cosine)
        # exp(i theta) without another sine: the direction of the pin, turned by the angle of the
        # triangle, whose cosine and sine follow from those of its half.
        product = half_sine * half_cosine
        scale = 1.0 / (4.0 * crank * d * d)
        versor = half_cosine * half_cosine
        versor -= half_sine * half_sine
        versor *= scale
        cross = product * scale
        cross *= 2.0 * self.branch
        height = self.guide_height
        cosine = height * cross - x * versor
        sine = height * versor + x * cross
        cos_v = (-1.0 / coupler) * x - (crank / coupler) * cosine
        # cos(v - theta) from the law of cosines, sin(v - theta) from the triangle's area.
        cos_transmission = cos_v * cosine + (height / coupler - (crank / coupler) * sine) * sine
        leverage = passed_at_rest(
            (self.branch / (2.0 * crank * coupler)) * product,
            jet,
            "dead centre: crank and coupler are in line while the slider starts to move, so the"
            " rocker's acceleration is infinite",
        )
        p1 = jet[1]
        of_crank = 1.0 / (crank * leverage)
        direction = -float(self.stroke_direction)
        per_crank = direction * cos_v  # theta' for p' = 1, the sign of p included
        per_crank *= of_crank
        swing_jet = np.empty((order + 1, jet.shape[1]))
        theta1 = np.multiply(p1, per_crank, out=swing_jet[1])
        if order > 1:
            of_coupler = (crank / coupler) * of_crank
            per_coupler = direction * cosine
            per_coupler *= of_coupler
            v1 = p1 * per_coupler
            np.negative(v1, out=v1)
            crank_centripetal = theta1 * theta1
            crank_centripetal *= crank
            coupler_centripetal = v1 * v1
            coupler_centripetal *= coupler
            theta2 = np.multiply(jet[2], per_crank, out=swing_jet[2])
            theta2 += (crank_centripetal * cos_transmission + coupler_centripetal) * of_crank
        if order > 2:
            v2 = (
                -jet[2] * per_coupler
                - (crank_centripetal + coupler_centripetal * cos_transmission) * of_coupler
            )
            mixed = (3.0 * crank) * cos_transmission * theta1 * theta2 + (3.0 * coupler) * v1 * v2
            theta3 = np.multiply(jet[3], per_crank, out=swing_jet[3])
            theta3 += theta1 * theta1 * theta1
            theta3 += mixed * of_crank
        swing = np.subtract(theta, self.start_angle, out=swing_jet[0])
        if len(swing) and not (np.max(swing) <= math.pi and np.min(swing) > -math.pi):
            # Only swings beyond half a turn, if there are any, lose whole turns.
            beyond = (swing > math.pi) | (swing <= -math.pi)
            swing[beyond] -= TURN * np.ceil((swing[beyond] - math.pi) / TURN)
        return np.negative(swing_jet, out=swing_jet) if self.mirrored else swing_jet

    @property
    def slider_sense(self) -> int:
        """Sign of the slider's displacement along x, in the drawing of the cam, per stroke.

        The frame of the formulas is the drawing with its origin in the rocker shaft; a `mirrored`
        linkage is seen from behind, with left and right exchanged.
        """
        return self.stroke_direction if self.mirrored else -self.stroke_direction

    def joints(self, stroke: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """P and T (n,) [mm]: slider's pin and crank's tip at `stroke` (n,) [mm], as in the drawing.

        Seen from the rocker shaft, with the axes of the drawing of the cam.
        """
        x, _ = self.pin(stroke)
        theta = self.crank_angle(stroke)
        sense = 1.0 if self.mirrored else -1.0
        pin = sense * x + 1j * self.guide_height
        tip = self.crank * (-sense * np.cos(theta) + 1j * np.sin(theta))
        return np.asarray(pin), np.asarray(tip)

    def sketch(self, place: complex, _: complex, position: FloatArray) -> MechanismSketch[Places]:
        """See `Linkage.sketch`."""
        joined = rocker_crank_sketch(place, self.joints(position))
        return joined + MechanismSketch(guides=(Guide(joined.joints[1], 1.0 + 0j),))

    @property
    def coupler_tilt(self) -> float:
        """See `Linkage`."""
        return abs(math.remainder(self.coupler_angle, math.pi))

    def joint_rates(
        self, stroke: FloatArray, demanded: FloatArray, own: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """See `Linkage.joint_rates`: P goes along the guide, T turns."""
        _, tip = self.joints(stroke)
        return (self.slider_sense * demanded).astype(np.complex128), turning(tip, own)

    def per_follower(self, stroke: FloatArray) -> FloatArray:
        """(n,) ds/dpsi [mm/rad] at `stroke` (n,) [mm], see `Linkage.per_follower`.

        From the derivative of P - T = l_4 exp(i v) with dT/dpsi = i T and P moving along the guide:
        ds/dpsi = -+ l_sk sin(v - theta) / cos v, the reciprocal of `transform`; 0 at a dead centre.

        Raises
        ------
        GeometryError
            With key "linkage", where the coupler is square to the guide, cos v = 0 up to
            rounding, see `locked_positions`.
        """
        far, near = self.transmission_sines(stroke)
        if np.any(np.abs(far) * self.coupler <= self._rounding):
            raise GeometryError(
                "the coupler is square to the guide: the rocker cannot move the slider",
                key="linkage",
            )
        slide = -self.stroke_direction * self.crank * near / far
        return np.asarray(-slide if self.mirrored else slide)

    def _far_sine(self, stroke: FloatArray) -> FloatArray:
        """cos v."""
        across = -self.pin(stroke)[0] - self.crank * np.cos(self.crank_angle(stroke))
        return np.asarray(across / self.coupler)

    def far_turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.far_turning_positions`: the crank is square to the guide."""
        strokes = [
            self.stroke_direction * (x - self.start_position)
            for tip in (self.crank, -self.crank)
            for x in level(self.guide_height - tip, self.coupler)
            if x * tip * self.branch >= 0.0
        ]
        return tuple(stroke for stroke in strokes if low <= stroke <= high)

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.locked_positions`: the strokes [mm] with the coupler square to the guide.

        There the pin is right above or below the crank's tip, Im T = e_sk -+ l_4: however hard the
        rocker pushes, it cannot move the slider.
        """
        low, high = low - self._rounding, high + self._rounding
        return tuple(stroke for stroke in self._across_strokes() if low <= stroke <= high)

    @property
    def _rounding(self) -> float:
        """The size [mm] up to which a length counts as zero."""
        return ROUNDING * (self.crank + self.coupler)

    def _across_strokes(self) -> list[float]:
        """The strokes [mm] at which, on this branch, the coupler is square to the guide."""
        # The tip (-x, e_sk - down) is clockwise of the pin (-x, e_sk) where x and `down` have
        # opposite signs.
        return [
            self.stroke_direction * (x - self.start_position)
            for down in (self.coupler, -self.coupler)
            for x in level(self.guide_height - down, self.crank)
            if x * down * self.branch <= 0.0
        ]

    def size_limits(self, size: Size, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.size_limits`.

        With X = a (l_4 - b l_sk sin alpha) + eps_s s, a the side of the slider, b = +1 if the crank
        leans away, and d^2 = X^2 + (l_sk cos alpha)^2, the condition d = l_sk + l_4 as well as
        d = |l_sk - l_4| is linear in each of the two lengths: their squares cancel. Between the
        ends of the stroke d is least where X = 0, at the height of the guide.
        """
        limits = _coupler_limits if size == "coupler" else _crank_limits
        quotients = limits(self, (low, high))
        return tuple(top / bottom for top, bottom in quotients if bottom != 0.0)


def _coupler_limits(
    linkage: SliderCrank, strokes: tuple[float, float]
) -> Iterator[tuple[float, float]]:
    """Numerators and denominators of the limits of l_4 [mm], see `SliderCrank.size_limits`."""
    crank, height, side = linkage.crank, linkage.guide_height, linkage.slider_side
    lean = crank * math.sin(linkage.deflection)
    lean = lean if linkage.leans_away else -lean
    yield crank + height, 1.0
    yield crank - height, 1.0
    for stroke in strokes:
        rest = linkage.stroke_direction * stroke - side * lean  # X = a l_4 + rest
        # l_sk^2 - e_sk^2 is lean^2, so this is lean^2 - rest^2.
        top = (lean - rest) * (lean + rest)
        yield top, 2.0 * (side * rest - crank)
        yield top, 2.0 * (side * rest + crank)
        yield -side * rest, 1.0


def _crank_limits(
    linkage: SliderCrank, strokes: tuple[float, float]
) -> Iterator[tuple[float, float]]:
    """Numerators and denominators of the limits of l_sk [mm], see `SliderCrank.size_limits`."""
    coupler, side = linkage.coupler, linkage.slider_side
    sine, cosine = math.sin(linkage.deflection), math.cos(linkage.deflection)
    sine = sine if linkage.leans_away else -sine
    yield coupler, 1.0 + cosine
    yield coupler, 1.0 - cosine
    for stroke in strokes:
        rest = side * linkage.stroke_direction * stroke + coupler  # a X = rest - b l_sk sin alpha
        top = (rest - coupler) * (rest + coupler)
        yield top, 2.0 * (coupler + rest * sine)
        yield -top, 2.0 * (coupler - rest * sine)
        yield rest, sine


# -- slider driven crank ---------------------------------------------------------------------------
# The slider-crank the other way round: the cam drives the slider, the crank's angle is demanded.
#
# Frame as for the slider-crank: crank shaft at the origin, pin P = -X + i
# e_sk, X = s_0 + eps_s s, tip T = l_sk exp(i theta), |P - T| = l_4.


PARALLEL = 1e-9
"""Largest sine of the coupler's angle to the guide at stroke 0 that counts as parallel."""


@dataclass(frozen=True)
class SliderDrivenCrank:
    """A slider-crank whose slider is the carriage of a translating follower.

    Attributes
    ----------
    inner : the same linkage, computed from stroke to angle; the crank's angle psi and the slider's
        stroke s are those of both.

    Of the two strokes that close the loop it takes the one with the coupler on the same side as at
    angle 0, so that cos v keeps its sign.

    Raises
    ------
    GeometryError
        With key "linkage", if the coupler is square to the guide at angle 0: a dead centre, from
        which the slider could go either way.
    """

    member: ClassVar[Literal["crank"]] = "crank"
    unit: ClassVar[Literal["rad"]] = "rad"

    inner: SliderCrank

    def __post_init__(self) -> None:
        instance("linkage", self.inner, SliderCrank, "a slider-crank, a `SliderCrank`")
        drop = float(self._drop(np.zeros(1))[0])
        if self.coupler - abs(drop) <= ROUNDING * (self.crank + self.coupler):
            raise GeometryError(
                "dead centre at stroke 0: the coupler is square to the guide of the slider",
                key="linkage",
            )

    @property
    def crank(self) -> float:
        """l_sk [mm]."""
        return self.inner.crank

    @property
    def coupler(self) -> float:
        """l_4 [mm]."""
        return self.inner.coupler

    @cached_property
    def side(self) -> int:
        """Sign of cos v, v the angle of the coupler from tip to pin; it never changes."""
        return 1 if math.cos(self.inner.coupler_angle) > 0.0 else -1

    @property
    def _sense(self) -> float:
        """Sense in which theta changes for a positive psi: +1, or -1 for a mirrored linkage."""
        return -1.0 if self.inner.mirrored else 1.0

    def _theta(self, angle: FloatArray) -> FloatArray:
        return np.asarray(self.inner.start_angle + self._sense * angle)

    def _drop(self, angle: FloatArray) -> FloatArray:
        """(n,) [mm] height of the guide above the crank's tip, l_4 sin v."""
        return np.asarray(self.inner.guide_height - self.crank * np.sin(self._theta(angle)))

    def missing_length(self, angle: FloatArray) -> FloatArray:
        """(n,) [mm] distance by which the coupler misses the guide; <= 0 where it reaches it."""
        return np.abs(self._drop(angle)) - self.coupler

    def _along(self, drop: FloatArray) -> FloatArray:
        """(n,) [mm] component of the coupler along the guide, l_4 cos v; 0 at a dead centre."""
        coupler = self.coupler
        return self.side * np.sqrt(np.maximum((coupler - drop) * (coupler + drop), 0.0))

    @cached_property
    def _start(self) -> tuple[float, float]:
        """l_4 sin v and l_4 cos v at angle 0 [mm]."""
        drop = self._drop(np.zeros(1))
        return float(drop[0]), float(self._along(drop)[0])

    def _way(self, angle: FloatArray, drop: FloatArray, along: FloatArray) -> FloatArray:
        """Re P (n,) [mm] minus its value at angle 0, accurate to its own last digits.

        The differences of cosines and sines of theta are written as products, and that of l_4 cos v
        as the difference of (l_4 sin v)^2 over a sum, so that a long coupler cancels out.
        """
        start_drop, start_along = self._start
        half = 0.5 * self._sense * angle
        middle = self.inner.start_angle + half
        slope = (drop + start_drop) / (along + start_along)
        way = 2.0 * self.crank * np.sin(half) * (np.cos(middle) * slope - np.sin(middle))
        return np.asarray(way)

    def joints(self, angle: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """P and T (n,) [mm] at the crank's `angle` (n,) [rad], see `SliderCrank.joints`."""
        theta = self._theta(angle)
        sense = -self._sense
        reach = self.crank * np.cos(theta) + self._along(self._drop(angle))
        pin = -sense * reach + 1j * self.inner.guide_height
        tip = self.crank * (-sense * np.cos(theta) + 1j * np.sin(theta))
        return np.asarray(pin), np.asarray(tip)

    def sketch(
        self, place: complex, outward: complex, position: FloatArray
    ) -> MechanismSketch[Places]:
        """See `Linkage.sketch`: turned so that its slider runs along the follower's guide."""
        start = complex(self.joints(np.zeros(1))[0][0])
        pins, tips = self.joints(position)
        strokes, _ = self.inner.joints(np.array([0.0, self.crank]))
        way = complex(strokes[1] - strokes[0])
        turn = outward * abs(way) / way
        pin, tip = (place + turn * (joint - start) for joint in (pins, tips))
        shaft = place - turn * start
        return crank_and_coupler(shaft, tip, pin)

    @property
    def coupler_tilt(self) -> float:
        """See `Linkage`."""
        return self.inner.coupler_tilt

    def joint_rates(
        self, angle: FloatArray, demanded: FloatArray, own: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """See `Linkage.joint_rates`: P goes along the guide, T turns."""
        _, tip = self.joints(angle)
        pin = (self.inner.slider_sense * own).astype(np.complex128)
        return pin, turning(tip, demanded)

    def per_follower(self, angle: FloatArray) -> FloatArray:
        """(n,) dpsi/ds [rad/mm] at the crank's `angle` (n,) [rad], see `Linkage.per_follower`.

        From Re(conj(D) (P' - T')) = 0: Re D over Re(conj(D) i T), a quotient of the sines.

        Raises
        ------
        GeometryError
            With key "linkage", where crank and coupler are in line, up to rounding.
        """
        far, near = self.transmission_sines(angle)
        if np.any(np.abs(far) <= ROUNDING * (1.0 + self.crank / self.coupler)):
            raise GeometryError(
                "crank and coupler are in line: the slider cannot turn the crank", key="linkage"
            )
        turned = -self.inner.stroke_direction * self._sense
        return np.asarray(turned * near / (self.crank * far))

    def transmission_sines(self, angle: FloatArray) -> FloatArray:
        """See `Linkage.transmission_sines`: Re(conj(D) i T) / (l_sk l_4), and cos v."""
        tip, drop = np.exp(1j * self._theta(angle)), self._drop(angle)
        along = self._along(drop)
        return np.stack((dot(along + 1j * drop, 1j * tip), along)) / self.coupler

    def far_turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.far_turning_positions`: the pin passes the shaft, nearest to it."""
        height, crank, coupler = self.inner.guide_height, self.crank, self.coupler
        if not height:
            return ()
        # The pin is right above the shaft, so the law of cosines gives the cosine of the angle
        # between crank and vertical, the sine of the tip's direction.
        sine = ((crank - coupler) * (crank + coupler) + height * height) / (2.0 * height * crank)
        thetas = [math.atan2(sine, x) for x in level(sine, 1.0) if x * self.side <= 0.0]
        return self._angles(thetas, low, high)

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.locked_positions`: crank and coupler are in line."""
        thetas: list[float] = []
        for signed in (self.crank + self.coupler, self.crank - self.coupler):
            ahead = 0.0 if signed > 0.0 else math.pi  # the tip towards the pin, or opposite
            if signed:
                thetas += [theta + ahead for theta in _rising(self.inner.guide_height, signed)]
        positions = self._angles(thetas, low - SLACK, high + SLACK)
        return in_line(positions, self.transmission_sines(np.array(positions))[TO_FAR_END])

    def transform(self, jet: Jet, order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) stroke s and derivatives [mm/rad^k] for the crank's angles `jet`.

        `jet` (4, n) is the demanded angle and its derivatives [rad/rad^k]; order is at least 1.

        With the coupler D = P - T, P' = p' real, and the derivatives of |D|^2 = l_4^2:

            p'   = Re(conj(D) T') / Re D
            p''  = (Re(conj(D) T'') - |D'|^2) / Re D
            p''' = (Re(conj(D) T''') - 3 Re(conj(D') D'')) / Re D

        Raises
        ------
        GeometryError
            With key "linkage", at a dead centre that is not passed at rest.
        """
        angle = jet[0]
        theta = self._theta(angle)
        tip = self.crank * np.exp(1j * theta)
        drop = self._drop(angle)
        along = self._along(drop)
        rod = along + 1j * drop
        below = passed_at_rest(
            along,
            jet,
            "dead centre: the coupler is square to the guide while the crank moves, so the slider's"
            " velocity is infinite",
        )
        stroke_jet = np.empty((order + 1, jet.shape[1]))
        stroke_jet[0] = self._way(angle, drop, along)
        turn1 = self._sense * jet[1]
        tip1 = 1j * turn1 * tip
        p1 = np.divide(dot(rod, tip1), below, out=stroke_jet[1])
        if order > 1:
            turn2 = self._sense * jet[2]
            tip2 = (1j * turn2 - turn1 * turn1) * tip
            rod1 = p1 - tip1
            p2 = np.divide(dot(rod, tip2) - dot(rod1, rod1), below, out=stroke_jet[2])
        if order > 2:
            turn3 = self._sense * jet[3]
            tip3 = (1j * (turn3 - turn1**3) - 3.0 * turn1 * turn2) * tip
            np.divide(dot(rod, tip3) - 3.0 * dot(rod1, p2 - tip2), below, out=stroke_jet[3])
        # X = -Re P, s = eps_s (X - s_0)
        stroke_jet *= -float(self.inner.stroke_direction)
        return stroke_jet

    def transform_bounds(self, jet: Jet, bounds: Jet) -> Jet:
        """See `Linkage.transform_bounds`.

        Interval arithmetic for the derivatives with respect to the crank's angle theta, of
        l_4 sin v = e_sk - l_sk sin theta for the coupler's direction v, and of
        Re P = l_sk cos theta + l_4 cos v.
        """
        inner, crank, coupler = self.inner, self.crank, self.coupler
        theta = Angles.from_middles(self._theta(jet[0]), bounds[0])
        sine_theta, cosine_theta = theta.sine, theta.cosine
        height = np.full_like(jet[0], inner.guide_height)
        drop = Interval(height, height) - sine_theta.scaled(crank)
        whole = np.full_like(height, coupler)
        drop = drop.intersection(Interval(-whole, whole))
        least, most = (
            np.sqrt((coupler - size) * (coupler + size))
            for size in (drop.magnitude, drop.mignitude)
        )
        along = Interval((1.0 - AREA) * least, np.minimum((1.0 + AREA) * most, coupler))
        # cos v keeps its sign throughout the motion, see `side`.
        along = along if self.side > 0 else -along
        lift, way = sine_theta.scaled(crank), cosine_theta.scaled(crank)
        # By differentiating l_4 sin v = e_sk - l_sk sin theta three times with respect to theta.
        v1 = -way / along
        v2 = (lift + v1.squared() * drop) / along
        v3 = (way + (v1 * v2 * drop).scaled(3.0)) / along + v1.squared() * v1
        p1 = -lift - v1 * drop
        p2 = -way - v2 * drop - v1.squared() * along
        p3 = lift - v3 * drop - (v1 * v2 * along).scaled(3.0) + v1.squared() * v1 * drop
        return chained((p1, p2, p3), bounds)

    def turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.turning_positions`: where the crank is square to the guide."""
        return self._angles((0.5 * math.pi, -0.5 * math.pi), low, high)

    def dead_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.dead_positions`: the coupler is square to the guide."""
        thetas: list[float] = []
        for down in (self.coupler, -self.coupler):
            thetas += _rising(self.inner.guide_height - down, self.crank)
        return self._angles(thetas, low, high)

    def _angles(
        self, thetas: tuple[float, ...] | list[float], low: float, high: float
    ) -> tuple[float, ...]:
        """The crank's angles in [low, high] [rad] at which theta is one of `thetas`."""
        return periodic_angles(
            [self._sense * (theta - self.inner.start_angle) for theta in thetas], low, high
        )

    def size_limits(self, size: Size, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.size_limits`: the largest |l_sk (cos alpha - sin theta)| is l_4.

        Known where the coupler is parallel to the guide at stroke 0, for then theta does not depend
        on the lengths.
        """
        if abs(math.sin(self.inner.coupler_angle)) > PARALLEL:
            return ()
        positions = np.array([low, high, *self.turning_positions(low, high)])
        share = float(np.max(np.abs(self._drop(positions)))) / self.crank
        if share == 0.0:
            return ()
        return (self.crank * share,) if size == "coupler" else (self.coupler / share,)

    def resized(self, size: Size, length: float) -> SliderDrivenCrank:
        """See `Linkage.resized`."""
        return SliderDrivenCrank(self.inner.resized(size, length))


def _rising(height: float, length: float) -> list[float]:
    """Directions [rad] of a `length` [mm] of any sign that ends `height` [mm] above its start."""
    return [math.atan2(height, x) for x in level(height, length)]


# -- four bar --------------------------------------------------------------------------------------
# Four-bar linkage between a lever, whose angle is demanded, and the rocker that follows the cam.
#
# Frame of the formulas: the rocker shaft B_0 at the origin, axes as in the drawing of the cam. The
# pin on the lever is P = D_0 + l_c exp(i chi), chi = chi_0 + h x with the demanded angle x; the
# crank's tip is T = l_a exp(i theta), |P - T| = l_b.


@dataclass(frozen=True)
class FourBar(RockerCrank):
    """Crank on the rocker shaft, coupler, and output lever on a second fixed shaft.

    Attributes
    ----------
    crank : l_a, crank on the rocker shaft [mm].
    coupler : l_b, from the crank's tip to the lever's pin [mm].
    lever : l_c, from the second shaft to the pin [mm].
    shaft : D_0, the second shaft seen from the rocker shaft, complex [mm].
    lever_angle : chi_0, direction from the second shaft to the pin at motion 0, from the x axis
        [rad].
    lever_sense : h, +1 if a positive motion turns the lever counter-clockwise, -1 clockwise.
    branch : +1 if the crank tip lies clockwise of the pin seen from the rocker shaft, -1
        counter-clockwise; it does so throughout the motion.

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "linkage", if the linkage does not
        close at motion 0.
    """

    member: ClassVar[Literal["lever"]] = "lever"
    unit: ClassVar[Literal["rad"]] = "rad"

    lever: Length
    shaft: Place
    lever_angle: Angle
    lever_sense: Sense
    branch: Branch

    def __post_init__(self) -> None:
        check_fields(self, "linkage.")
        gap = float(self.missing_length(np.zeros(1))[0])
        if gap > ROUNDING * (self.crank + self.coupler):
            distance = abs(self.shaft + cmath.rect(self.lever, self.lever_angle))
            least, most = abs(distance - self.crank), distance + self.crank
            raise GeometryError(
                f"the linkage does not close at motion 0: it misses by {gap:.6g} mm; the coupler"
                f" must be {least:.6g} to {most:.6g} mm long",
                key="linkage",
            )

    @cached_property
    def _start_bend(self) -> float:
        """beta at motion 0 [rad]: the lever's direction, measured from that of the second shaft."""
        return self.lever_angle - self._shaft_angle

    @cached_property
    def _shaft_angle(self) -> float:
        """arg D_0 [rad]."""
        return phase(self.shaft)

    @cached_property
    def _shaft_distance(self) -> float:
        """|D_0| [mm]."""
        return abs(self.shaft)

    @property
    def _far_shaft(self) -> bool:
        return self._shaft_distance > self.lever

    def _bend(self, motion: FloatArray) -> FloatArray:
        return self._start_bend + self.lever_sense * motion

    def _distance(self, motion: FloatArray) -> FloatArray:
        """d = |P| (n,) [mm] at `motion` (n,) [rad], without cancellation."""
        # d^2 = (l_c - |D_0|)^2 + 4 l_c |D_0| cos^2(beta/2): a sum of squares, in which nothing
        # cancels.
        near = self._widest * np.cos(0.5 * self._bend(motion))
        return np.hypot(self.lever - self._shaft_distance, near)

    @cached_property
    def _widest(self) -> float:
        """2 sqrt(l_c |D_0|) [mm]."""
        return 2.0 * math.sqrt(self.lever * self._shaft_distance)

    @property
    def _least_square(self) -> float:
        """(l_c - |D_0|)^2 [mm^2]."""
        return (self.lever - self._shaft_distance) ** 2

    @property
    def _start_cosine(self) -> float:
        return math.cos(self._start_bend)

    @cached_property
    def _start_gaps(self) -> tuple[float, float]:
        """(l_a + l_b)^2 - d^2 and d^2 - (l_a - l_b)^2 [mm^2] at motion 0, without rounding.

        A gap that is only rounding becomes 0, so that a dead centre at the start remains one.
        """
        d = float(self._distance(np.zeros(1))[0])
        total, difference = self.crank + self.coupler, abs(self.crank - self.coupler)
        outer, inner = total - d, d - difference
        least = ROUNDING * total
        outer, inner = (gap if gap > least else 0.0 for gap in (outer, inner))
        return outer * (total + d), inner * (d + difference)

    def _growth(self, motion: FloatArray) -> FloatArray:
        """d^2 minus its value at motion 0 [mm^2], as a product."""
        half = 0.5 * self.lever_sense * motion
        growth = np.sin(self._start_bend + half) * np.sin(half)
        growth *= -4.0 * self.lever * self._shaft_distance
        return np.asarray(growth)

    def _farthest_and_nearest(
        self, motion: FloatArray, reach: FloatArray
    ) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
        distance, lever = self._shaft_distance, self.lever
        cosines = Angles.from_middles(self._bend(motion), reach).cosine
        least, start = self._least_square, self._start_cosine

        def growth_and_distance(cosine: FloatArray) -> tuple[FloatArray, FloatArray]:
            square = least + 2.0 * lever * distance * (1.0 + cosine)
            return 2.0 * lever * distance * (cosine - start), np.sqrt(square)

        return growth_and_distance(cosines.high), growth_and_distance(cosines.low)

    def _pin_heading(self, motion: FloatArray, reach: FloatArray) -> Angles:
        """The pin moves square to the lever."""
        return Angles.from_middles(
            self.lever_angle + self.lever_sense * motion + 0.5 * math.pi, reach
        )

    @property
    def _pin_pace(self) -> tuple[float, float]:
        return self.lever_sense * self.lever, self.lever_sense

    def _pin_angle(self, motion: FloatArray) -> FloatArray:
        """arg P (n,) [rad], continuous over any motion: that of the longer of D_0 and l_c, with
        which P turns, plus less than a quarter turn.
        """
        bend, distance = self._bend(motion), self._shaft_distance
        if self._far_shaft:
            ratio = 1.0 + (self.lever / distance) * np.exp(1j * bend)
            return np.asarray(self._shaft_angle + np.angle(ratio))
        ratio = 1.0 + (distance / self.lever) * np.exp(-1j * bend)
        return np.asarray(self.lever_angle + self.lever_sense * motion + np.angle(ratio))

    def joints(self, motion: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """P and T (n,) [mm]: lever's pin and crank's tip at `motion` (n,) [rad]."""
        pin = self.shaft + self.lever * np.exp(1j * (self.lever_angle + self.lever_sense * motion))
        return pin, self.crank * np.exp(1j * self.crank_angle(motion))

    def sketch(self, place: complex, _: complex, position: FloatArray) -> MechanismSketch[Places]:
        """See `Linkage.sketch`."""
        joined, far = rocker_crank_sketch(place, self.joints(position)), place + self.shaft
        pin = joined.joints[1]
        return joined + MechanismSketch(
            links=((far, pin),),
            shafts=(far,),
            dimensions=(Dimension("lever", far, pin), Dimension("shaft", place, far, vector=True)),
        )

    @property
    def coupler_tilt(self) -> float:
        """See `Linkage`; the dimensions of a four-bar imply no direction of the coupler."""
        return 0.0

    def joint_rates(
        self, motion: FloatArray, demanded: FloatArray, own: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """See `Linkage.joint_rates`: P turns with the lever, T with the crank."""
        pin, tip = self.joints(motion)
        return turning(pin - self.shaft, self.lever_sense * demanded), turning(tip, own)

    def per_follower(self, motion: FloatArray) -> FloatArray:
        """(n,) dx/dpsi at `motion` (n,) [rad], see `Linkage.per_follower`.

        From Re(conj(D) (P' - T')) = 0 with P' = i h x' (P - D_0), T' = i psi' T: l_a over h l_c
        times the quotient of the sines.

        Raises
        ------
        GeometryError
            With key "linkage", where coupler and lever are in line, up to rounding.
        """
        far, near = self.transmission_sines(motion)
        if np.any(np.abs(far) <= ROUNDING * (1.0 + self.lever / self.coupler)):
            raise GeometryError(
                "coupler and lever are in line: the rocker cannot move the lever", key="linkage"
            )
        return np.asarray(self.lever_sense * (self.crank / self.lever) * near / far)

    def _far_sine(self, motion: FloatArray) -> FloatArray:
        """Re(conj(D) i (P - D_0)) / (l_b l_c)."""
        pin, tip = self.joints(motion)
        return dot(pin - tip, 1j * (pin - self.shaft)) / (self.lever * self.coupler)

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.locked_positions`: coupler and lever are in line.

        The crank's tip is then l_c + l_b or |l_c - l_b| from the second shaft.
        """
        bends: list[float] = []
        for signed in (self.lever + self.coupler, self.lever - self.coupler):
            # The pin lies in the direction of the tip as seen from D_0, or opposite to it.
            ahead = 0.0 if signed > 0.0 else math.pi
            bends += [bend + ahead for bend in _bends(abs(self.shaft), abs(signed), self.crank)]
        positions = self._motions(bends, low - SLACK, high + SLACK)
        return in_line(positions, self._far_sine(np.array(positions)))

    def far_turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.far_turning_positions`: the crank lies on the line of the shafts, its tip
        nearest to the second shaft or farthest from it.
        """
        bends: list[float] = []
        for tip in (self.crank, -self.crank):  # along the line, from the rocker shaft
            beyond = tip - abs(self.shaft)
            for bend in _bends(abs(beyond), self.lever, self.coupler):
                bend += math.pi if beyond > 0.0 else 0.0
                if self.branch * tip * math.sin(bend) >= 0.0:
                    bends.append(bend)
        return self._motions(bends, low, high)

    def transform(self, jet: Jet, order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) rocker angle psi and derivatives [rad/rad^k] for lever angles `jet`.

        `jet` (4, n) is the demanded angle and its derivatives [rad/rad^k]; order is at least 1.
        psi is counted from motion 0, counter-clockwise positive, continuous over the motion.

        With the coupler D = P - T, N = Re(conj(D) i T) = l_a l_b sin(v - theta), and the
        derivatives of |D|^2 = l_b^2:

            theta'   = Re(conj(D) P') / N
            theta''  = (Re(conj(D) (P'' + theta'^2 T)) + |D'|^2) / N
            theta''' = (Re(conj(D) (P''' + (3 theta' theta'' + i theta'^3) T)) + 3 Re(conj(D') D''))
                       / N

        Raises
        ------
        GeometryError
            With key "linkage", at a dead centre that is not passed at rest: psi'' is infinite.
        """
        motion = jet[0]
        sine, cosine = self.position_half_angle(motion)
        theta = self._pin_angle(motion) - self.branch * 2.0 * np.arctan2(sine, cosine)
        leverage = passed_at_rest(
            0.5 * self.branch * (sine * cosine),
            jet,
            "dead centre: crank and coupler are in line while the lever starts to move, so the"
            " rocker's acceleration is infinite",
        )
        arm = self.lever * np.exp(1j * (self.lever_angle + self.lever_sense * motion))
        tip = self.crank * np.exp(1j * theta)
        rod = self.shaft + arm - tip
        turn1 = self.lever_sense * jet[1]
        pin1 = 1j * turn1 * arm
        swing_jet = np.empty((order + 1, jet.shape[1]))
        np.subtract(theta, self.start_angle, out=swing_jet[0])
        theta1 = np.divide(dot(rod, pin1), leverage, out=swing_jet[1])
        if order > 1:
            turn2 = self.lever_sense * jet[2]
            pin2 = (1j * turn2 - turn1 * turn1) * arm
            rod1 = pin1 - 1j * theta1 * tip
            tip_centripetal = theta1 * theta1 * tip
            theta2 = dot(rod, pin2 + tip_centripetal) + dot(rod1, rod1)
            theta2 = np.divide(theta2, leverage, out=swing_jet[2])
        if order > 2:
            turn3 = self.lever_sense * jet[3]
            pin3 = (1j * (turn3 - turn1**3) - 3.0 * turn1 * turn2) * arm
            rod2 = pin2 + tip_centripetal - 1j * theta2 * tip
            mixed = (3.0 * theta1 * theta2 + 1j * theta1**3) * tip
            theta3 = dot(rod, pin3 + mixed) + 3.0 * dot(rod1, rod2)
            np.divide(theta3, leverage, out=swing_jet[3])
        return swing_jet

    def turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.turning_positions`: where the lever lies on the line of the shafts."""
        return self._motions((0.0, math.pi), low, high)

    def dead_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.dead_positions`."""
        bends: list[float] = []
        for reach in (self.crank + self.coupler, abs(self.crank - self.coupler)):
            bends += _bends(abs(self.shaft), self.lever, reach)
        return self._motions(bends, low, high)

    def _motions(
        self, bends: tuple[float, ...] | list[float], low: float, high: float
    ) -> tuple[float, ...]:
        """The motions in [low, high] [rad] at which beta is one of `bends`, up to whole turns."""
        angles = [self.lever_sense * (bend - self._start_bend) for bend in bends]
        return periodic_angles(angles, low, high)

    def size_limits(self, size: Size, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.size_limits`: |l_a - l_b| <= d <= l_a + l_b, d from least to most."""
        positions = np.array([low, high, *self.turning_positions(low, high)])
        d = self._distance(positions)
        least, most = float(np.min(d)), float(np.max(d))
        other = self.crank if size == "coupler" else self.coupler
        return most - other, other - least, other + least


def _bends(distance: float, arm: float, reach: float) -> tuple[float, ...]:
    """Both angles [rad] of an `arm` [mm] whose end is `reach` [mm] away from a point.

    They are measured from the direction that leads away from the point, whose `distance` [mm] from
    the start of the arm must not be 0. Empty if there are none.
    """
    # Distance, arm and reach form a triangle; the tangent of half its outer angle has no
    # differences of nearly equal numbers.
    near = (reach - (arm - distance)) * (reach + (arm - distance))
    far = (arm + distance - reach) * (arm + distance + reach)
    if not distance or near < 0.0 or far < 0.0:
        return ()
    bend = 2.0 * math.atan2(math.sqrt(far), math.sqrt(near))
    return bend, -bend
