"""The slider-crank the other way round: the cam drives the slider, the crank's angle is demanded.

Frame as in `camgeo.kinematics.mechanism.slider_crank`: crank shaft at the origin, pin P = -X + i
e_sk, X = s_0 + eps_s s, tip T = l_sk exp(i theta), |P - T| = l_4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linkage import OUT
from camgeo.kinematics.mechanism.sketch import MechanismSketch, Places
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.triangle import (
    AREA,
    ROUNDING,
    SLACK,
    Size,
    chained,
    crank_and_coupler,
    in_line,
    level,
    passed_at_rest,
    turning,
    within,
)
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot
from camgeo.numeric.checked import instance
from camgeo.numeric.interval import Interval, about

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
            message = "dead centre at stroke 0: the coupler is square to the guide of the slider"
            raise GeometryError(message, key="linkage")

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
        """Sense of theta for a positive psi."""
        return -1.0 if self.inner.mirrored else 1.0

    def _theta(self, angle: FloatArray) -> FloatArray:
        theta: FloatArray = self.inner.start_angle + self._sense * angle
        return theta

    def _drop(self, angle: FloatArray) -> FloatArray:
        """(n,) [mm] height of the guide above the crank's tip, l_4 sin v."""
        drop: FloatArray = self.inner.guide_height - self.crank * np.sin(self._theta(angle))
        return drop

    def missing_length(self, angle: FloatArray) -> FloatArray:
        """(n,) [mm] by how much the coupler misses the guide; <= 0 where it reaches it."""
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
        pin, tip = (place + turn * (each - start) for each in (pins, tips))
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
        far, own = self.transmission_sines(angle)
        if np.any(np.abs(far) <= ROUNDING * (1.0 + self.crank / self.coupler)):
            message = "crank and coupler are in line: the slider cannot turn the crank"
            raise GeometryError(message, key="linkage")
        turned = -self.inner.stroke_direction * self._sense
        return np.asarray(turned * own / (self.crank * far))

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
        # From above the shaft, the law of cosines; the sine of the tip's direction.
        sine = ((crank - coupler) * (crank + coupler) + height * height) / (2.0 * height * crank)
        thetas = [math.atan2(sine, x) for x in level(sine, 1.0) if x * self.side <= 0.0]
        return self._angles(thetas, low, high)

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.locked_positions`: crank and coupler are in line."""
        thetas: list[float] = []
        for signed in (self.crank + self.coupler, self.crank - self.coupler):
            ahead = 0.0 if signed > 0.0 else math.pi  # the tip towards the pin, or opposite
            if signed:
                thetas += [each + ahead for each in _rising(self.inner.guide_height, signed)]
        found = self._angles(thetas, low - SLACK, high + SLACK)
        return in_line(found, self.transmission_sines(np.array(found))[OUT])

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
            "the coupler is square to the guide while the crank moves, the slider's velocity is",
        )
        out = np.empty((order + 1, jet.shape[1]))
        out[0] = self._way(angle, drop, along)
        turn1 = self._sense * jet[1]
        tip1 = 1j * turn1 * tip
        p1 = np.divide(dot(rod, tip1), below, out=out[1])
        if order > 1:
            turn2 = self._sense * jet[2]
            tip2 = (1j * turn2 - turn1 * turn1) * tip
            rod1 = p1 - tip1
            p2 = np.divide(dot(rod, tip2) - dot(rod1, rod1), below, out=out[2])
        if order > 2:
            turn3 = self._sense * jet[3]
            tip3 = (1j * (turn3 - turn1**3) - 3.0 * turn1 * turn2) * tip
            np.divide(dot(rod, tip3) - 3.0 * dot(rod1, p2 - tip2), below, out=out[3])
        # X = -Re P, s = eps_s (X - s_0)
        out *= -float(self.inner.stroke_direction)
        return out

    def transform_bounds(self, jet: Jet, bounds: Jet) -> Jet:
        """See `Linkage.transform_bounds`.

        Interval arithmetic for the derivatives with respect to the crank's angle theta, of
        l_4 sin v = e_sk - l_sk sin theta for the coupler's direction v, and of
        Re P = l_sk cos theta + l_4 cos v.
        """
        inner, crank, coupler = self.inner, self.crank, self.coupler
        theta = about(self._theta(jet[0]), bounds[0])
        sine_theta, cosine_theta = theta.sine, theta.cosine
        height = np.full_like(jet[0], inner.guide_height)
        drop = Interval(height, height) - sine_theta.scaled(crank)
        whole = np.full_like(height, coupler)
        drop = drop.within(Interval(-whole, whole))
        least, most = (
            np.sqrt((coupler - each) * (coupler + each))
            for each in (drop.magnitude, drop.mignitude)
        )
        along = Interval((1.0 - AREA) * least, np.minimum((1.0 + AREA) * most, coupler))
        along = along if self.side > 0 else -along
        lift, way = sine_theta.scaled(crank), cosine_theta.scaled(crank)
        # l_4 sin v and l_4 cos v differentiated: v' l_4 cos v, ...
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
        found: list[float] = []
        for down in (self.coupler, -self.coupler):
            found += _rising(self.inner.guide_height - down, self.crank)
        return self._angles(found, low, high)

    def _angles(
        self, thetas: tuple[float, ...] | list[float], low: float, high: float
    ) -> tuple[float, ...]:
        """The angles in [low, high] [rad] at which theta is one of `thetas`, up to whole turns."""
        return within([self._sense * (each - self.inner.start_angle) for each in thetas], low, high)

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
