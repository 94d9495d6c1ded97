"""The triangle of a linkage: shaft, pin and the tip of the crank, closed by crank and coupler."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.sketch import Dimension, MechanismSketch, Places
from camgeo.kinematics.mechanism.values import Length
from camgeo.kinematics.motion import Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.interval import WIDENED, Angles, Interval
from camgeo.units import TURN

Size = Literal["crank", "coupler"]

ROUNDING = 8.0 * 2.0**-52
"""A difference of lengths up to this fraction of crank and coupler is zero up to rounding."""

SLACK = 64.0 * 2.0**-52
"""An angle [rad] beyond the end of a range by no more than this lies at its end."""

IN_LINE = 1e-6
"""Largest sine of the angle between two members that are in line on this branch of the linkage;
on the other branch they are far from it."""


AREA = 2.0**-40
"""Fraction of the area of a triangle that far exceeds its rounding."""

ROUNDS = 2
"""How often angles and slopes are enclosed in turn: for small cells two rounds settle all but the
last digits."""


@dataclass(frozen=True)
class RockerCrank(ABC):
    """What linkages share whose crank turns the rocker: the triangle of shaft, pin and tip.

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
            """Side of the tip."""

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
        """Directions in which the pin moves over the same positions; the opposite ones if its pace
        is negative.
        """

    @property
    @abstractmethod
    def _pin_pace(self) -> tuple[float, float]:
        """Pace of the pin [mm per mm or rad], signed, and by how much its direction turns with the
        position, -1, 0 or 1.
        """

    @property
    def _crank_longer(self) -> bool:
        return self.crank > self.coupler

    @property
    @abstractmethod
    def _start_gaps(self) -> tuple[float, float]:
        """(crank + coupler)^2 - d^2 and d^2 - (crank - coupler)^2 [mm^2] at position 0."""

    def missing_length(self, position: FloatArray) -> FloatArray:
        """(n,) [mm] by how much crank and coupler miss the pin; <= 0 where they reach it."""
        d = self._distance(position)
        return np.maximum(d - (self.crank + self.coupler), abs(self.crank - self.coupler) - d)

    def half_angle(self, growth: FloatArray, d: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Sine and cosine, times a common factor, of half the angle pin - shaft - tip, in (0, pi).

        `d` (n,) is the distance shaft - pin [mm], `growth` (n,) its square minus that at
        the start [mm^2]: with `_start_gaps` a dead centre at the start keeps the digits of the
        motion, which d has lost.

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
        # At a dead centre the radicand may round to a tiny negative number.
        return np.sqrt(np.maximum(first, 0.0)), np.sqrt(np.maximum(second, 0.0))

    def half_angle_at(self, position: FloatArray) -> tuple[FloatArray, FloatArray]:
        """`half_angle` at `position` (n,)."""
        return self.half_angle(self._growth(position), self._distance(position))

    @abstractmethod
    def _far_sine(self, position: FloatArray) -> FloatArray:
        """(n,) sine of the angle between coupler and far member: `OUT` of `transmission_sines`."""

    def transmission_sines(self, position: FloatArray) -> FloatArray:
        """See `Linkage.transmission_sines`."""
        area = np.multiply(*self.half_angle_at(position)) / (2.0 * self.crank * self.coupler)
        return np.stack((self._far_sine(position), self.branch * area))

    def crank_angle(self, position: FloatArray) -> FloatArray:
        """theta (n,) [rad] at `position` (n,): Wirsig eq. 3.10, no poles."""
        sine, cosine = self.half_angle_at(position)
        return self._pin_angle(position) - self.branch * 2.0 * np.arctan2(sine, cosine)

    def transform_bounds(self, jet: Jet, bounds: Jet) -> Jet:
        """See `Linkage.transform_bounds`."""
        return chained(self._swing_slopes(jet[0], bounds[0]), bounds)

    def _swing_slopes(
        self, position: FloatArray, reach: FloatArray
    ) -> tuple[Interval, Interval, Interval]:
        """dpsi/dx and two more derivatives over the positions within `reach` (n,) of `position`
        (n,), up to their sign; infinite where these may touch a dead centre.

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
        rod /= np.abs(rod)
        rounding = WIDENED * (1.0 + (d + crank) / coupler)
        heading = self._pin_heading(position, reach)
        along, on_crank = (Angles(each.real, each.imag, rounding) for each in (rod, tip))
        between, to_coupler, to_crank = along - on_crank, heading - along, heading - on_crank
        ends = self._farthest_and_nearest(position, reach)
        # Twice the area of the triangle is concave in d^2.
        least = np.minimum(*(np.multiply(*self.half_angle(*end)) for end in ends))
        least *= (1.0 - AREA) / (2.0 * crank * coupler)
        whole = np.ones_like(least)
        area = Interval(least, whole) if self.branch > 0 else Interval(-whole, -least)
        theta1 = v1 = Interval(-np.inf * whole, np.inf * whole)
        for _ in range(ROUNDS):
            far, farther = times(reach, theta1), times(reach, v1)
            across = between.reaching(between.reach + far + farther)
            area = area.within(across.sine)
            inverse = area.inverse
            in_line = to_coupler.reaching(to_coupler.reach + farther)
            in_crank = to_crank.reaching(to_crank.reach + far)
            theta1 = theta1.within((in_line.cosine * inverse).scaled(pace / crank))
            v1 = v1.within((in_crank.cosine * inverse).scaled(-pace / coupler))
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


def passed_at_rest(divisor: FloatArray, jet: Jet, what: str) -> FloatArray:
    """`divisor` (n,), replaced by 1 where it is 0, at a dead centre, and the motion `jet` rests.

    GeometryError with key "linkage", which says that `what` is infinite, if it does not rest there.
    """
    if np.all(divisor):
        return divisor
    dead = divisor == 0.0
    if np.any(jet[1:, dead]):
        raise GeometryError(f"dead centre: {what} infinite", key="linkage")
    return np.where(dead, 1.0, divisor)


def chained(slopes: tuple[Interval, Interval, Interval], bounds: Jet) -> Jet:
    """(4, n) bounds of a motion q(x) from those of x, `bounds`, and the `slopes` dq/dx and two more
    over each cell, by the chain rule; 0 at rest, infinite where unknown.
    """
    q1, q2, q3 = (slope.magnitude for slope in slopes)
    x0, x1, x2, x3 = bounds
    with np.errstate(invalid="ignore", over="ignore"):
        second = q2 * x1 * x1 + q1 * x2
        out = np.stack((q1 * x0, q1 * x1, second, q3 * x1**3 + 3.0 * q2 * x1 * x2 + q1 * x3))
    resting = np.all(bounds == 0.0, axis=0)
    return np.where(resting, 0.0, np.where(np.isnan(out), np.inf, out))


def times(reach: FloatArray, slope: Interval) -> FloatArray:
    """(n,) how far a quantity with this `slope` moves within `reach` (n,); 0 at rest."""
    with np.errstate(invalid="ignore"):
        far = reach * slope.magnitude
    return np.where(reach == 0.0, 0.0, far)


def level(height: float, length: float) -> tuple[float, ...]:
    """Horizontal offsets [mm] of the end of a `length` that rises by `height`, if it can."""
    square = (length - height) * (length + height)
    return (math.sqrt(square), -math.sqrt(square)) if square >= 0.0 else ()


def in_line(places: tuple[float, ...], sines: FloatArray) -> tuple[float, ...]:
    """Those of `places` at which two members are in line, by the `sines` (n,) of their angle there.

    The remaining places are on the other branch.
    """
    return tuple(each for each, sine in zip(places, np.abs(sines), strict=True) if sine <= IN_LINE)


def turning(joint: ComplexArray, rates: FloatArray) -> ComplexArray:
    """(2, n) first and second derivative of `joint` (n,), which turns about 0 with `rates` (2, n).

    `rates` are the derivatives of its angle: z' = i a' z, z'' = (i a'' - a'^2) z.
    """
    first, second = rates
    return np.stack((1j * first * joint, (1j * second - first * first) * joint))


def drawn(shaft: complex, joints: tuple[ComplexArray, ComplexArray]) -> MechanismSketch[Places]:
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


def within(angles: Iterable[float], low: float, high: float) -> tuple[float, ...]:
    """Those in [low, high] [rad] of `angles`, and of all whole turns away from them, ascending."""
    found = {
        angle + TURN * turns
        for angle in angles
        for turns in range(math.ceil((low - angle) / TURN), math.floor((high - angle) / TURN) + 1)
    }
    return tuple(sorted(found))
