"""The coordinates of the masses, as functions of cam angle and of the follower's coordinate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.inertia.table import MassProperties
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.mechanism.far_end import FarEnd
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.motion import Jet, Motion


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Derivatives of one coordinate x of a mass at n cam angles.

    Attributes
    ----------
    inertia : m [t], or the moment of inertia [t mm^2] if x is an angle [rad].
    first, second : (n,) x' and x'' over the cam angle [mm or rad per rad^k].
    per_lift : (n,) dx/dq over the follower's coordinate q.
    """

    inertia: float
    first: FloatArray
    second: FloatArray
    per_lift: FloatArray


Train = Callable[[FloatArray, Side], list[Rates]]
"""All coordinates with an inertia, at n cam angles [rad]."""


def at_follower(subject: Subject, data: MassProperties) -> float:
    """Inertia of the follower itself: its mass [t], or its moment about the pivot [t mm^2].

    The roller counts as a point mass at its centre, without the inertia of its spin.
    """
    follower = subject.cam.follower
    own = {"mm": data.mass, "rad": data.moment_of_inertia}[follower.lift_unit]
    return own + data.roller_mass * follower.reach**2


def train_of(subject: Subject, data: MassProperties) -> DirectTrain | LinkedTrain:
    """The train of `subject` with the masses of `data`."""
    own = at_follower(subject, data)
    linkage = subject.drive.linkage
    if linkage is not None and data.beyond(linkage):
        return LinkedTrain(subject.state.output, linkage, own, data)
    return DirectTrain(subject.state.motion, own)


@dataclass(frozen=True, slots=True)
class DirectTrain:
    """All inertia moves along the follower's own coordinate."""

    motion: Motion
    inertia: float

    def __call__(self, phi: FloatArray, side: Side) -> list[Rates]:
        jet = self.motion.jet(phi, side, 2)
        return [Rates(self.inertia, jet[1], jet[2], np.ones(len(phi)))]


def joints_per_lift(linkage: Linkage, position: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """dP/dq and dT/dq (n,) of the coupler's pin and tip by the follower's coordinate q."""
    way = linkage.per_follower(position)
    still = np.zeros_like(way)
    pin, tip = linkage.joint_rates(
        position, np.stack((way, still)), np.stack((np.ones_like(way), still))
    )
    return pin[0], tip[0]


@dataclass(frozen=True, slots=True)
class LinkedTrain:
    """The follower, the member with the demanded motion, and the coupler as a rigid body.

    With pin P, tip of the crank T and D = P - T = l_4 exp(i v), the coupler turns at v' = Im(D'/D),
    v'' = Im(D''/D), since D'' = (i v'' - v'^2) D, and its centre of mass is C = T + lambda D (rigid
    body kinematics in complex numbers).
    """

    output: Motion
    linkage: Linkage
    inertia: float
    data: MassProperties

    def __call__(self, phi: FloatArray, side: Side) -> list[Rates]:
        return self.rates(self.output.jet(phi, side))

    def rates(self, stroke: Jet) -> list[Rates]:
        """With the far end at `stroke` (4, n), with derivatives by whatever `stroke` has them."""
        linkage, data = self.linkage, self.data
        own = linkage.transform(stroke, 2)
        found = [
            Rates(self.inertia, own[1], own[2], np.ones(len(own[1]))),
            Rates(data.far(linkage), stroke[1], stroke[2], linkage.per_follower(stroke[0])),
        ]
        pin, tip = linkage.joints(stroke[0])
        rod, share = pin - tip, data.coupler_centre
        pins, tips = linkage.joint_rates(stroke[0], stroke[1:3], own[1:3])
        rods = pins - tips
        centres = tips + share * rods
        pin_per_lift, tip_per_lift = joints_per_lift(linkage, stroke[0])
        rod_per_lift = pin_per_lift - tip_per_lift
        per_lift = tip_per_lift + share * rod_per_lift
        mass = data.coupler_mass
        found.append(Rates(mass, centres[0].real, centres[1].real, per_lift.real))
        found.append(Rates(mass, centres[0].imag, centres[1].imag, per_lift.imag))
        turns = (rods / rod).imag
        moment = data.turning(linkage)
        found.append(Rates(moment, turns[0], turns[1], (rod_per_lift / rod).imag))
        return [each for each in found if each.inertia]


def reduced(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """M (n,), see `Inertia.to_follower`."""
    out = np.zeros(len(phi))
    for each in train(phi, side):
        out += each.inertia * each.per_lift * each.per_lift
    return out


def reduced_at(
    train: DirectTrain | LinkedTrain, far: FarEnd | None, phi: FloatArray, q: FloatArray
) -> FloatArray:
    """(2, n) M and dM/dq / 2, see `Inertia.at`: the sums of m (dx/dq)^2 and m dx/dq d^2x/dq^2."""
    out = np.zeros((2, len(q)))
    if far is None or isinstance(train, DirectTrain):
        out[0] = train.inertia
        return out
    for each in train.rates(far.jet(phi, q)):
        out += each.inertia * each.per_lift * np.stack((each.first, each.second))
    return out


def inertia_force(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """(4, n) coefficients of the sum of -m (d^2 x/dt^2) dx/dq at n cam angles.

    d^2 x/dt^2 = x'' omega^2 + x' alpha (VDI 2143-1, eq. 2). By Lagrange's equation it is
    -(M d^2 q/dt^2 + dM/dq (dq/dt)^2 / 2), of the reduced inertia M(q).
    """
    out = np.zeros((4, len(phi)))
    for each in train(phi, side):
        of_lift = -each.inertia * each.per_lift
        out[2] += of_lift * each.second
        out[3] += of_lift * each.first
    return out


def at_cam(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """(2, n) J [t mm^2] and dJ/dphi [t mm^2/rad]: T = J omega^2 / 2 at the camshaft.

    J is the sum of m x'^2, which is M q'^2; its derivative that of 2 m x' x''.
    """
    out = np.zeros((2, len(phi)))
    for each in train(phi, side):
        out[0] += each.inertia * each.first * each.first
        out[1] += 2.0 * each.inertia * each.first * each.second
    return out
