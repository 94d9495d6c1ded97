"""The masses that have a weight, and their positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.effect import driving_slider
from camgeo.effects.inertia.rates import joints_per_lift
from camgeo.effects.inertia.table import MassProperties
from camgeo.effects.linked import shaft_and_turn
from camgeo.mechanism.triangle import turning
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.effects.results import Mass
    from camgeo.mechanism.linkage_protocol import Linkage


def masses_of(subject: Subject, data: MassProperties) -> tuple[Mass, ...]:
    """The masses of `data` that are not 0."""
    found: list[Mass] = []
    follower, linkage = subject.cam.follower, subject.drive.linkage
    pivot = follower.pivot
    if pivot is not None:
        centre = pivot if data.rocker_centre is None else data.rocker_centre
        found.append(_OnRocker("rocker", data.rocker_mass, subject, pivot, centre - pivot))
        found.append(_OnRocker("roller", data.roller_mass, subject, pivot, follower.start_arm))
    else:
        found.append(_OnGuide("follower", data.mass, subject))
        found.append(_OnGuide("roller", data.roller_mass, subject))
    if linkage is not None:
        placed = (subject, linkage, *shaft_and_turn(subject, linkage))
        if driving_slider(subject) is not None:
            found.append(_OnCoupler("slider", data.mass, *placed, 1.0))
        found.append(_OnCoupler("coupler", data.coupler_mass, *placed, data.coupler_centre))
    return tuple(each for each in found if each.mass)


@dataclass(frozen=True, slots=True)
class _OnGuide:
    """The roller centre of a translating follower, or the foot of the cam axis on its face."""

    name: str
    mass: float
    subject: Subject

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        cam = self.subject.cam
        lift = self.subject.state.motion.jet(phi, side, 1)[0]
        return np.asarray(cam.follower.start_arm + cam.follower.way * lift)

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return self.per_coordinate(phi, phi)

    def rates(self, phi: FloatArray, side: Side) -> ComplexArray:
        lifts = self.subject.state.motion.jet(phi, side, 2)[1:3]
        return np.asarray(self.subject.cam.follower.way * lifts)

    def per_coordinate(self, _: FloatArray, q: FloatArray) -> ComplexArray:
        return np.full(len(q), self.subject.cam.follower.way)


@dataclass(frozen=True, slots=True)
class _OnRocker:
    """A point of the rocker; `start` is its position at cam angle 0 relative to the pivot [mm]."""

    name: str
    mass: float
    subject: Subject
    pivot: complex
    start: complex

    def _lever(self, q: FloatArray) -> ComplexArray:
        swing = self.subject.cam.follower.swing_sense * q
        return np.asarray(self.start * np.exp(1j * swing))

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(self.pivot + self._lever(self.subject.state.motion.jet(phi, side, 1)[0]))

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return self.per_coordinate(phi, self.subject.state.motion.jet(phi, side, 1)[0])

    def rates(self, phi: FloatArray, side: Side) -> ComplexArray:
        swing = self.subject.state.motion.jet(phi, side, 2)
        return turning(self._lever(swing[0]), self.subject.cam.follower.swing_sense * swing[1:3])

    def per_coordinate(self, _: FloatArray, q: FloatArray) -> ComplexArray:
        return np.asarray(1j * self.subject.cam.follower.swing_sense * self._lever(q))


@dataclass(frozen=True, slots=True)
class _OnCoupler:
    """A point of the coupler: `share` is 0 at the tip of the crank, 1 at the far pin.

    `shaft` is the shaft of the crank relative to the cam axis [mm], `turn` the direction of the
    linkage's own x axis in the drawing.
    """

    name: str
    mass: float
    subject: Subject
    linkage: Linkage
    shaft: complex
    turn: complex
    share: float

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        pin, tip = self.linkage.joints(self.subject.state.output.jet(phi, side)[0])
        return np.asarray(self.shaft + self.turn * (tip + self.share * (pin - tip)))

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return self._per_lift(self.subject.state.output.jet(phi, side)[0])

    def rates(self, phi: FloatArray, side: Side) -> ComplexArray:
        state = self.subject.state
        stroke, own = state.output.jet(phi, side), state.motion.jet(phi, side, 2)
        pin, tip = self.linkage.joint_rates(stroke[0], stroke[1:3], own[1:3])
        return np.asarray(self.turn * (tip + self.share * (pin - tip)))

    def per_coordinate(self, phi: FloatArray, q: FloatArray) -> ComplexArray:
        far = self.subject.drive.far_end
        assert far is not None  # it is on a coupler
        return self._per_lift(far.place(phi, q))

    def _per_lift(self, position: FloatArray) -> ComplexArray:
        pin, tip = joints_per_lift(self.linkage, position)
        return np.asarray(self.turn * (tip + self.share * (pin - tip)))
