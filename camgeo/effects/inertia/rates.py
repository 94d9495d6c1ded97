"""The coordinates in which masses move, over the cam angle and over the follower's coordinate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.effect import driving_slider
from camgeo.effects.inertia.spec import InertiaSpec
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.motion.motion import Motion
    from camgeo.motion.plan import MotionPlan


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """How one coordinate x of a mass goes at n cam angles.

    Attributes
    ----------
    inertia : m [t], or moment of inertia [t mm^2] if x is an angle [rad].
    first, second : (n,) x' and x'' over the cam angle [mm or rad per rad^k].
    per_lift : (n,) dx/dq over the follower's coordinate q.
    """

    inertia: float
    first: FloatArray
    second: FloatArray
    per_lift: FloatArray


Train = Callable[[FloatArray, Side], list[Rates]]
"""All coordinates that have an inertia, at n cam angles [rad]."""


def at_follower(subject: Subject, spec: InertiaSpec) -> float:
    """What moves with the follower itself: its mass [t], or moment about the pivot [t mm^2].

    The roller counts as a point in its centre: what it takes to spin it is not in it.
    """
    follower = subject.follower
    if isinstance(follower, OscillatingRoller):
        return spec.moment_of_inertia + spec.roller_mass * follower.arm**2
    if follower.rocks:
        return spec.moment_of_inertia
    return spec.mass + spec.roller_mass


def train_of(subject: Subject, spec: InertiaSpec) -> Train:
    """The train of `subject` with the masses of `spec`."""
    own = at_follower(subject, spec)
    linkage = driving_slider(subject)
    if linkage is not None and (spec.mass or spec.coupler_mass or spec.coupler_moment):
        return LinkedTrain(subject.plan, linkage, own, spec)
    return DirectTrain(subject.motion, own)


@dataclass(frozen=True, slots=True)
class DirectTrain:
    """All inertia moves with the follower's own coordinate."""

    motion: Motion
    inertia: float

    def __call__(self, phi: FloatArray, side: Side) -> list[Rates]:
        jet = self.motion.jet(phi, side, 2)
        return [Rates(self.inertia, jet[1], jet[2], np.ones(len(phi)))]


@dataclass(frozen=True, slots=True)
class LinkedTrain:
    """Rocker, slider, and coupler as a rigid body.

    With pin P, crank's tip T and D = P - T = l_4 exp(i v) the coupler turns as v' = Im(D'/D),
    v'' = Im(D''/D), since D'' = (i v'' - v'^2) D, and its centre of mass is C = T + lambda D: rigid
    body kinematics in complex numbers. The slider goes with the stroke s, the tip as T' = i psi' T.
    """

    plan: MotionPlan
    linkage: SliderCrank
    inertia: float
    spec: InertiaSpec

    def __call__(self, phi: FloatArray, side: Side) -> list[Rates]:
        linkage, spec = self.linkage, self.spec
        stroke = self.plan.jet(phi, side)
        swing = linkage.transform(stroke, 2)
        slide, turn = linkage.per_swing(stroke[0])
        found = [
            Rates(self.inertia, swing[1], swing[2], np.ones(len(phi))),
            Rates(spec.mass, stroke[1], stroke[2], slide),
        ]
        pin, tip = linkage.joints(stroke[0])
        sense = float(linkage.slider_sense)
        rod = pin - tip
        tip1, tip2 = 1j * swing[1] * tip, (1j * swing[2] - swing[1] ** 2) * tip
        rod1, rod2 = sense * stroke[1] - tip1, sense * stroke[2] - tip2
        share = spec.coupler_centre
        centre1, centre2 = tip1 + share * rod1, tip2 + share * rod2
        tip_per_lift = 1j * tip
        per_lift = (1.0 - share) * tip_per_lift + share * sense * slide
        mass = spec.coupler_mass
        found.append(Rates(mass, centre1.real, centre2.real, per_lift.real))
        found.append(Rates(mass, centre1.imag, centre2.imag, per_lift.imag))
        found.append(Rates(self.moment, (rod1 / rod).imag, (rod2 / rod).imag, turn))
        return [each for each in found if each.inertia]

    @property
    def moment(self) -> float:
        """The coupler's about its centre of mass [t mm^2]; of a slender rod, m l^2/12, by default.

        (Tables of mass properties, e.g. in the appendix of Norton, "Design of Machinery".)
        """
        moment = self.spec.coupler_moment
        return self.spec.coupler_mass * self.linkage.coupler**2 / 12.0 if moment is None else moment
