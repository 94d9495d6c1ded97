"""A roller that rolls on the flank that carries, and the moments that act on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.effects.effect import Request, Subject
from camgeo.effects.results import CONTACT_FORCE, ContactForce
from camgeo.effects.roller_spin import RollerData
from camgeo.effects.touching import INNER, OUTER, bearing_of, holds_both_ways
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN

FLANK, PIN, CAM = 0, 1, 2
"""What rubs on the roller: its flank by traction, its pin, and the cam by rolling friction."""


def in_turn(phi: FloatArray, side: Side) -> FloatArray:
    """(n,) cam angles `phi` (n,) [rad] of any turn from 0 to 2 pi, which is 0 from the left."""
    phi = np.mod(phi, TURN)
    return np.where(phi == 0.0, TURN, phi) if side == "left" else phi


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """The rolling roller.

    Attributes
    ----------
    subject : the design.
    course : how the cam turns.
    contact : force at the contact.
    data : of the roller.
    senses : (k,) s, the flank that carries, or the only one, between the edges of `contact`.
    alone : side of a yoke, see `camgeo.effects.touching`, that presses this roller; 0 without one.
    """

    subject: Subject
    course: TimeCourse
    contact: ContactForce
    data: RollerData
    senses: FloatArray
    alone: int = 0

    @classmethod
    def each(cls, request: Request[RollerData]) -> tuple[Self, ...]:
        """The roller of a scene, or both of a yoke, each on the inner flank as it touches it."""
        subject, contact = request.subject, request.results[CONTACT_FORCE]
        if subject.returning is None:
            return (cls._of_one(request),)
        senses = np.full(len(contact.edges) - 1, float(INNER))
        return tuple(
            cls(touched, request.course, contact, request.data, senses, alone)
            for touched, alone in ((subject, INNER), (subject.returning, OUTER))
        )

    @classmethod
    def _of_one(cls, request: Request[RollerData]) -> Self:
        subject, contact = request.subject, request.results[CONTACT_FORCE]
        senses = np.full(len(contact.edges) - 1, float(subject.cam.contact.push))
        if holds_both_ways(subject):
            middle = 0.5 * (contact.edges[:-1] + contact.edges[1:])
            inner = contact.normal(middle, "right") >= 0.0
            senses = np.where(inner, float(INNER), float(OUTER))
        return cls(subject, request.course, contact, request.data, senses)

    @property
    def reversals(self) -> FloatArray:
        """(n,) cam angles [rad] at which the roller changes flanks."""
        return np.asarray(self.contact.edges[:-1][self.senses != np.roll(self.senses, 1)])

    def sense(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) s."""
        piece = np.searchsorted(self.contact.edges, in_turn(phi, side), side) - 1
        return np.asarray(self.senses[piece])

    def pressing(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) |N| [N]; 0 where the only flank would have to pull, or the other side of a yoke
        carries.
        """
        normal = self.contact.normal(phi, side)
        if self.alone:
            return np.maximum(self.alone * normal, 0.0)
        if holds_both_ways(self.subject):
            return np.abs(normal)
        return np.maximum(self.subject.cam.contact.push * normal, 0.0)

    def spin(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray, FloatArray]:
        """omega_R and that relative to the pin [rad/s], and d omega_R/dt [rad/s^2], (n,) each."""
        subject = self.subject
        relative = subject.state.curve.relative_jet(phi, side, order=2)
        first, second = (relative.along[k] + 1j * relative.across[k] for k in (1, 2))
        pace = np.abs(first)
        gain = np.real(np.conj(first) * second) / pace
        sigma = subject.cam.rotation
        share = self.sense(phi, side) * sigma / subject.cam.follower.roller_radius
        omega, alpha = self.course.rates(phi, side)[:2]
        rate = sigma - share * pace
        return (
            np.asarray(rate * omega),
            np.asarray((rate - relative.turning) * omega),
            np.asarray(rate * alpha - share * gain * omega**2),
        )

    def traction(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) T [N]."""
        sense, radius = self.sense(phi, side), self.subject.cam.follower.roller_radius
        lever = sense * self.subject.cam.rotation / radius
        needed = lever * self.data.moment_of_inertia * self.spin(phi, side)[2]
        return np.asarray(needed + self._shared(phi, side) * self.pressing(phi, side))

    def _shared(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) f_t, see `friction`."""
        friction = self.contact.friction
        if not self.alone or friction is None:
            return bearing_of(self.contact, phi, side).tangential
        return friction.bearing(phi, side, self.alone).tangential

    def reserve(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) mu_T |N| - |T| [N]."""
        there = self.data.traction * self.pressing(phi, side)
        return np.asarray(there - np.abs(self.traction(phi, side)))

    @property
    def levers(self) -> FloatArray:
        """(3,) largest moments per unit of |N| [mm] of flank, pin and cam."""
        friction = self.contact.friction
        pin, rolling = (0.0, 0.0) if friction is None else friction.on_roller
        radius = self.subject.cam.follower.roller_radius
        return np.array([self.data.traction * radius, pin, rolling])

    def rubbed(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(3, n) angular velocities at which flank, pin and cam do not rub on the roller [rad/s],
        omega_R, chi' omega and sigma omega, and (3, n) their rates in time [rad/s^2].
        """
        sigma, swing = self.subject.cam.rotation, self.subject.cam.follower.swing_sense
        omega, alpha = self.course.rates(phi, side)[:2]
        turned, _, rate = self.spin(phi, side)
        velocity, acceleration = self.subject.state.motion.jet(phi, side, 2)[1:3]
        swung = swing * (acceleration * omega**2 + velocity * alpha)
        return (
            np.stack((turned, swing * velocity * omega, sigma * omega)),
            np.stack((rate, swung, sigma * alpha)),
        )
