"""The masses that have a weight, with their places."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from camgeo.effects.effect import driving_slider
from camgeo.effects.inertia.rates import joints_per_lift
from camgeo.effects.inertia.spec import InertiaSpec
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import ComplexArray, FloatArray

if TYPE_CHECKING:
    from collections.abc import Callable

    from camgeo.effects.effect import Subject
    from camgeo.mechanism.kinds import AnyGuided, AnyRocker
    from camgeo.mechanism.linkage_protocol import Linkage


@dataclass(frozen=True, slots=True, eq=False)
class Mass:
    """A mass in its centre.

    Attributes
    ----------
    name : "follower", "roller", "rocker", "slider" or "coupler".
    mass : [t].
    place : (n,) complex [mm] where it is at n cam angles [rad], seen from the cam axis, as the
        drawing of the cam has it. A translating follower is taken to be in its roller's centre, or
        in the foot of the cam axis on its face, and a slider in its pin: where on the body does not
        matter for a body that does not turn.
    per_lift : (n,) complex [1 or mm/rad] dx/dq of that place over the follower's coordinate.
    """

    name: str
    mass: float
    place: Callable[[FloatArray, Side], ComplexArray]
    per_lift: Callable[[FloatArray, Side], ComplexArray]


def masses_of(subject: Subject, spec: InertiaSpec) -> tuple[Mass, ...]:
    """Those of `spec` that are not 0."""
    found = []
    if subject.cam.follower.rocks:
        follower = cast("AnyRocker", subject.cam.follower)
        centre = follower.pivot if spec.rocker_centre is None else spec.rocker_centre
        rocker = _OnRocker(subject, follower, centre - follower.pivot)
        found.append(Mass("rocker", spec.rocker_mass, rocker.place, rocker.per_lift))
        if isinstance(follower, OscillatingRoller):
            roller = _OnRocker(subject, follower, _arm_at_0(follower))
            found.append(Mass("roller", spec.roller_mass, roller.place, roller.per_lift))
        shaft, turn = follower.pivot, 1.0 + 0.0j
        if driving_slider(subject) is not None:
            assert subject.cam.drive.linkage is not None  # it has the slider
            slider = _OnCoupler(subject, subject.cam.drive.linkage, shaft, turn, 1.0)
            found.append(Mass("slider", spec.mass, slider.place, slider.per_lift))
    else:
        guided = _OnGuide(subject, cast("AnyGuided", subject.cam.follower))
        found.append(Mass("follower", spec.mass, guided.place, guided.per_lift))
        found.append(Mass("roller", spec.roller_mass, guided.place, guided.per_lift))
        shaft, turn = guided.shaft_and_turn(subject.cam.drive.linkage)
    if subject.cam.drive.linkage is not None:
        coupler = _OnCoupler(subject, subject.cam.drive.linkage, shaft, turn, spec.coupler_centre)
        found.append(Mass("coupler", spec.coupler_mass, coupler.place, coupler.per_lift))
    return tuple(each for each in found if each.mass)


def _arm_at_0(follower: OscillatingRoller) -> complex:
    """From the pivot to the roller centre at cam angle 0 [mm]."""
    angle = cmath.phase(-follower.pivot) + follower.arm_side * follower.start_angle
    return cmath.rect(follower.arm, angle)


@dataclass(frozen=True, slots=True)
class _OnGuide:
    """The roller centre of a translating follower, or the foot of the cam axis on its face."""

    subject: Subject
    follower: AnyGuided

    @property
    def way(self) -> complex:
        return self.follower.direction * cmath.rect(1.0, self.follower.guide_angle)

    @property
    def start(self) -> complex:
        follower = self.follower
        start = 1j * follower.base_radius
        if isinstance(follower, TranslatingRoller):
            start = complex(follower.offset, follower.start_height)
        return start * cmath.rect(1.0, follower.guide_angle - 0.5 * math.pi)

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(
            self.start + self.way * self.subject.cam.drive.motion.jet(phi, side, 1)[0]
        )

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.full(len(phi), self.way)

    def shaft_and_turn(self, linkage: Linkage | None) -> tuple[complex, complex]:
        """Place of the shaft of the crank that the follower turns [mm], and the linkage's turn.

        The linkage is stated in a frame of its own; the pin is taken to be in the roller's centre,
        and its guide to be that of the follower.
        """
        if linkage is None:
            return 0.0j, 1.0 + 0.0j
        still, one = np.zeros((2, 1)), np.array([[1.0], [0.0]])
        pin, ahead = linkage.joints(still[0])[0], linkage.joint_rates(still[0], still, one)[0]
        turn = complex(self.way / ahead[0, 0])
        return self.start - turn * complex(pin[0]), turn


@dataclass(frozen=True, slots=True)
class _OnRocker:
    """A point of the rocker; `start` leads to it from the pivot at cam angle 0 [mm]."""

    subject: Subject
    follower: AnyRocker
    start: complex

    def _lever(self, phi: FloatArray, side: Side) -> ComplexArray:
        swing = self.follower.swing_sense * self.subject.cam.drive.motion.jet(phi, side, 1)[0]
        return np.asarray(self.start * np.exp(1j * swing))

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(self.follower.pivot + self._lever(phi, side))

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(1j * self.follower.swing_sense * self._lever(phi, side))


@dataclass(frozen=True, slots=True)
class _OnCoupler:
    """A point of the coupler: `share` 0 is the crank's tip, 1 the far pin.

    `shaft` is the crank's shaft seen from the cam axis [mm], `turn` the direction of the linkage's
    own x axis in the drawing.
    """

    subject: Subject
    linkage: Linkage
    shaft: complex
    turn: complex
    share: float

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        pin, tip = self.linkage.joints(self.subject.cam.drive.plan.jet(phi, side)[0])
        return np.asarray(self.shaft + self.turn * (tip + self.share * (pin - tip)))

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        pin, tip = joints_per_lift(self.linkage, self.subject.cam.drive.plan.jet(phi, side)[0])
        return np.asarray(self.turn * (tip + self.share * (pin - tip)))
