"""Forces on the free bodies: follower with its roller, and cam.

The cam presses on the roller with F_c = |N| (s n + f_t t), in the notation of `friction`, at its
centre, and the roller turns its pin by the moment -m_p. With the forces F of spring and weights,
and the masses m at their centres with the accelerations a, the balance of forces on a rocker gives
the force of its pivot,

    R = sum m a - F_c - F_A - sum F,

with the force F_A of the coupler of a linkage, see `pins`. On a flat face F_c acts at the contact;
in a conjugate pair it is that of the disc that carries. Loads and torsion springs are torques, and
need none; a rocker of which only the moment of inertia is stated counts as balanced about its
pivot. A guided follower accelerates along its guide, across which the two ends must carry the side
force S of F_c, F_A and the weights, to the right looking outwards, and the tilting moment M:

    R_2 = (a S + M) / b,    R_1 = -((a + b) S + M) / b,

with the near end at the distance a outwards of the roller's centre and the far end b beyond. The
weights act on the line of the guide. A flat face is pressed at the distance e to the right of the
axis of its guide, so that M = N e. For the camshaft see `shaft`.

Newton's second law for each body (Norton, Design of Machinery, chapter on dynamic force analysis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.force import acceleration, rates_of
from camgeo.effects.results import BEYOND
from camgeo.effects.touching import INNER, OUTER, bearing_of, carrier
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.effects.reactions.pins import Pins
    from camgeo.effects.results import ContactForce, Gravity, Inertia, Mass, Spring


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
    pins: Pins | None

    def of_cam(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) F_c, of the disc that carries."""
        normal = self.contact.normal(phi, side)
        sliding = np.abs(normal) * bearing_of(self.contact, phi, side).tangential
        found = np.zeros(len(phi), dtype=np.complex128)
        for sense, here in ((INNER, normal >= 0.0), (OUTER, normal < 0.0)):
            if not np.any(here):
                continue
            disc, flank = carrier(self.subject, sense)
            relative = disc.state.curve.relative_jet(phi[here], side, order=1)
            ahead = relative.along[1] + 1j * relative.across[1]
            tangent = ahead / np.abs(ahead) * np.exp(1j * relative.axis)
            across = 1j * disc.cam.rotation * flank * np.abs(normal[here])
            found[here] = (across + sliding[here]) * tangent
        return found

    def own(self) -> list[Mass]:
        """The masses of the follower itself."""
        masses = () if self.inertia is None else self.inertia.masses
        return [each for each in masses if each.name not in BEYOND]

    @property
    def pull(self) -> complex:
        """Acceleration of free fall [mm/s^2]; 0 if the scene does not name gravity."""
        return 0j if self.gravity is None else self.gravity.pull

    def weight(self, phi: FloatArray) -> ComplexArray:
        """(n,) of the follower's own masses."""
        return np.full(len(phi), self.pull * sum(each.mass for each in self.own()))

    def of_linkage(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) F_A, of the coupler; 0 without a linkage."""
        if self.pins is None:
            return np.zeros(len(phi), dtype=np.complex128)
        return self.pins.at(phi, side).near

    def of_spring(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) on the follower; 0 if it is a torque."""
        spring = self.spring
        if spring is None or spring.line is None:
            return np.zeros(len(phi), dtype=np.complex128)
        size = spring.preload - spring.stiffness * spring.way(phi, side)[0]
        return np.asarray(size * spring.line(phi, side))

    def of_pivot(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) R on a rocker."""
        applied = self.of_cam(phi, side) + self.of_linkage(phi, side)
        applied += self.of_spring(phi, side) + self.weight(phi)
        rates = rates_of(self.subject, phi)
        for each in self.own():
            applied -= each.mass * acceleration(each.rates(phi, side), rates)
        return -applied

    def of_guide(self, phi: FloatArray, side: Side) -> FloatArray:
        """(2, n) R_1 and R_2 of a guide with two ends; else the side force alone, and 0."""
        friction = self.contact.friction
        follower = self.subject.cam.follower
        right = -1j * math.copysign(1.0, follower.reach) * follower.way
        load = self.of_cam(phi, side) + self.of_linkage(phi, side) + self.weight(phi)
        force = np.real(np.conj(right) * load)
        if friction is None or friction.guide_length is None:
            return np.stack((-force, np.zeros(len(phi))))
        length = friction.guide_length
        bearing = bearing_of(self.contact, phi, side)
        moment = np.abs(self.contact.normal(phi, side)) * bearing.tilt
        far = (bearing.overhang * force + moment) / length
        return np.stack((-force - far, far))

    def tilting(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) M [N mm] of a flat face whose guide has no stated length, about the cam axis's foot
        on it; counter-clockwise positive.
        """
        relative = self.subject.state.curve.relative_jet(phi, side, order=1)
        return np.asarray(self.contact.normal(phi, side) * relative.along[0])
