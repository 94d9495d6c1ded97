"""Forces on the free bodies: follower with its roller, and cam.

The cam presses on the roller with F_c = |N| (s n + f_t t), in the notation of `friction`, at its
centre, and the roller turns its pin by the moment -m_p. With the forces F of spring and weights,
and the masses m at their centres with the accelerations a, the balance of forces on a rocker gives
the force of its pivot,

    R = sum m a - F_c - sum F.

Loads and torsion springs are torques, and need none; a rocker of which only the moment of inertia
is stated counts as balanced about its pivot. A guided follower accelerates along its guide, across
which the two ends must carry the side force S of F_c and of the weights, to the right looking
outwards, and the tilting moment M:

    R_2 = (a S + M) / b,    R_1 = -((a + b) S + M) / b,

with the near end at the distance a outwards of the roller's centre and the far end b beyond. The
weights act on the line of the guide. The bearings of the camshaft carry F_c.

Newton's second law for each body (Norton, Design of Machinery, chapter on dynamic force analysis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.touching import bearing_of
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.effects.results import ContactForce, Gravity, Inertia, Spring


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """The bodies and what acts on them; None for what the scene does not have.

    Forces are complex [N], in the axes of the drawing, for n cam angles [rad].
    """

    subject: Subject
    contact: ContactForce
    inertia: Inertia | None
    gravity: Gravity | None
    spring: Spring | None

    def of_cam(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) F_c."""
        relative = self.subject.state.curve.relative_jet(phi, side, order=1)
        ahead = relative.along[1] + 1j * relative.across[1]
        tangent = ahead / np.abs(ahead) * np.exp(1j * relative.axis)
        normal = self.contact.normal(phi, side)
        along = np.abs(normal) * bearing_of(self.contact, phi, side).tangential
        across = 1j * self.subject.cam.rotation * normal
        return np.asarray((across + along) * tangent)

    def weight(self, phi: FloatArray) -> ComplexArray:
        """(n,) of all masses."""
        found = np.zeros(len(phi), dtype=np.complex128)
        if self.gravity is not None and self.inertia is not None:
            found += self.gravity.pull * sum(each.mass for each in self.inertia.masses)
        return found

    def of_spring(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) on the follower; 0 if it is a torque."""
        spring = self.spring
        if spring is None or spring.line is None:
            return np.zeros(len(phi), dtype=np.complex128)
        size = spring.preload - spring.stiffness * spring.way(phi, side)[0]
        return np.asarray(size * spring.line(phi, side))

    def of_pivot(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) R on a rocker."""
        applied = self.of_cam(phi, side) + self.of_spring(phi, side) + self.weight(phi)
        return np.asarray(self._momentum(phi, side) - applied)

    def of_guide(self, phi: FloatArray, side: Side) -> FloatArray:
        """(2, n) R_1 and R_2 of a guide with two ends; else the side force alone, and 0."""
        friction = self.contact.friction
        follower = self.subject.cam.follower
        right = -1j * math.copysign(1.0, follower.reach) * follower.way
        load = self.of_cam(phi, side) + self.weight(phi)
        force = np.real(np.conj(right) * load)
        if friction is None or friction.guide_length is None:
            return np.stack((-force, np.zeros(len(phi))))
        length = friction.guide_length
        bearing = bearing_of(self.contact, phi, side)
        moment = np.abs(self.contact.normal(phi, side)) * bearing.tilt
        far = (bearing.overhang * force + moment) / length
        return np.stack((-force - far, far))

    def _momentum(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) the sum of m a of a rocker's masses."""
        found = np.zeros(len(phi), dtype=np.complex128)
        course, pivot = self.subject.state.course, self.subject.cam.follower.pivot
        if self.inertia is None or course is None or pivot is None:
            return found
        jet = self.subject.state.motion.jet(phi, side, 2)
        omega, alpha = course.rates(phi)[:2]
        speed, gain = jet[1] * omega, jet[2] * omega**2 + jet[1] * alpha
        turn = 1j * self.subject.cam.follower.swing_sense * gain - speed**2
        for each in self.inertia.masses:
            found += each.mass * turn * (each.place(phi, side) - pivot)
        return found
