"""The masses that have a weight, with their places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.effect import driving_slider
from camgeo.effects.inertia.rates import joints_per_lift
from camgeo.effects.inertia.spec import InertiaSpec
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import ComplexArray, FloatArray

if TYPE_CHECKING:
    from collections.abc import Callable

    from camgeo.effects.effect import Subject
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
    follower = subject.cam.follower
    pivot = follower.pivot
    if pivot is not None:
        centre = pivot if spec.rocker_centre is None else spec.rocker_centre
        rocker = _OnRocker(subject, pivot, centre - pivot)
        found.append(Mass("rocker", spec.rocker_mass, rocker.place, rocker.per_lift))
        roller = _OnRocker(subject, pivot, follower.start_arm)
        found.append(Mass("roller", spec.roller_mass, roller.place, roller.per_lift))
        shaft, turn = pivot, 1.0 + 0.0j
        if driving_slider(subject) is not None:
            assert subject.cam.drive.linkage is not None  # it has the slider
            slider = _OnCoupler(subject, subject.cam.drive.linkage, shaft, turn, 1.0)
            found.append(Mass("slider", spec.mass, slider.place, slider.per_lift))
    else:
        guided = _OnGuide(subject)
        found.append(Mass("follower", spec.mass, guided.place, guided.per_lift))
        found.append(Mass("roller", spec.roller_mass, guided.place, guided.per_lift))
        shaft, turn = guided.shaft_and_turn(subject.cam.drive.linkage)
    if subject.cam.drive.linkage is not None:
        coupler = _OnCoupler(subject, subject.cam.drive.linkage, shaft, turn, spec.coupler_centre)
        found.append(Mass("coupler", spec.coupler_mass, coupler.place, coupler.per_lift))
    return tuple(each for each in found if each.mass)


@dataclass(frozen=True, slots=True)
class _OnGuide:
    """The roller centre of a translating follower, or the foot of the cam axis on its face."""

    subject: Subject

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        cam = self.subject.cam
        lift = cam.drive.motion.jet(phi, side, 1)[0]
        return np.asarray(cam.follower.start_arm + cam.follower.way * lift)

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.full(len(phi), self.subject.cam.follower.way)

    def shaft_and_turn(self, linkage: Linkage | None) -> tuple[complex, complex]:
        """Place of the shaft of the crank that the follower turns [mm], and the linkage's turn.

        The linkage is stated in a frame of its own; the pin is taken to be in the roller's centre,
        and its guide to be that of the follower.
        """
        if linkage is None:
            return 0.0j, 1.0 + 0.0j
        still, one = np.zeros((2, 1)), np.array([[1.0], [0.0]])
        pin, ahead = linkage.joints(still[0])[0], linkage.joint_rates(still[0], still, one)[0]
        follower = self.subject.cam.follower
        turn = complex(follower.way / ahead[0, 0])
        return follower.start_arm - turn * complex(pin[0]), turn


@dataclass(frozen=True, slots=True)
class _OnRocker:
    """A point of the rocker; `start` leads to it from the pivot at cam angle 0 [mm]."""

    subject: Subject
    pivot: complex
    start: complex

    def _lever(self, phi: FloatArray, side: Side) -> ComplexArray:
        cam = self.subject.cam
        swing = cam.follower.swing_sense * cam.drive.motion.jet(phi, side, 1)[0]
        return np.asarray(self.start * np.exp(1j * swing))

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(self.pivot + self._lever(phi, side))

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(1j * self.subject.cam.follower.swing_sense * self._lever(phi, side))


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
