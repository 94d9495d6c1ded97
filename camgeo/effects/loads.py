"""Loads on the pivot or the guide of a follower: one definition for friction and for reactions.

The cam presses on the follower with F_c = |N| (s n + f_t t), in the notation of `friction`. With
the forces F of spring, weights and the coupler of a linkage (`camgeo.effects.coupler`), and the
masses m at their centres with the accelerations a, the balance of forces on a rocker gives the
force of its pivot,

    R = sum m a - sum F - F_c.

Loads and torsion springs are torques, and need none; a rocker of which only the moment of inertia
is stated counts as balanced about its pivot. The masses of the follower itself move as it does,
whatever elastic train is behind it; through a coupler the train loads the pivot. A guided follower
accelerates along its guide, across which the two ends must carry the side force S of F_c, of the
coupler and of the weights, to the right looking outwards, and the tilting moment M:

    R_2 = (a S + M) / b,    R_1 = -((a + b) S + M) / b,

with the near end at the distance a outwards of the roller's centre and the far end b beyond. The
weights act on the line of the guide, and the coupler on a carriage at the roller's centre. Without
b the guide carries R_1 = -S.

Newton's second law for each body (Norton, Design of Machinery, chapter on dynamic force analysis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.force import acceleration
from camgeo.effects.results import BEYOND
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.coupler import Coupler
    from camgeo.effects.effect import Subject
    from camgeo.effects.results import Friction, Gravity, Inertia, Mass, Spring


def guide_ends(
    force: FloatArray, moment: FloatArray | float, overhang: FloatArray, length: float | None
) -> FloatArray:
    """(2, ..., n) R_1 and R_2 for the side force S and the moment M; -S and 0 without a length."""
    if length is None:
        return np.stack((-force, np.zeros_like(force)))
    far = (overhang * force + moment) / length
    near = -((overhang + length) * force + moment) / length
    return np.stack((near, far))


@dataclass(frozen=True, slots=True, eq=False)
class Loads:
    """What acts on the follower besides the contact; None for what the scene does not have.

    Forces are complex [N], in the axes of the drawing, for n cam angles [rad].
    """

    subject: Subject
    inertia: Inertia | None
    gravity: Gravity | None
    spring: Spring | None
    coupler: Coupler | None

    @property
    def pull(self) -> complex:
        """Acceleration of free fall [mm/s^2]; 0 if the scene does not name gravity."""
        return 0j if self.gravity is None else self.gravity.pull

    def weight(self, phi: FloatArray) -> ComplexArray:
        """(n,) of the follower's own masses."""
        return np.full(len(phi), self.pull * sum(each.mass for each in self.own()))

    def own(self) -> list[Mass]:
        """The masses of the follower itself."""
        masses = () if self.inertia is None else self.inertia.masses
        return [each for each in masses if each.name not in BEYOND]

    def of_spring(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) on the follower; 0 if it is a torque."""
        spring = self.spring
        if spring is None or spring.line is None:
            return np.zeros(len(phi), dtype=np.complex128)
        size = spring.preload - spring.stiffness * spring.way(phi, side)[0]
        return np.asarray(size * spring.line(phi, side))

    def of_coupler(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, n) coefficients c0 to c3 of its force on the follower, see `camgeo.effects.force`; 0
        without one.
        """
        if self.coupler is None:
            return np.zeros((4, len(phi)), dtype=np.complex128)
        return self.coupler.joints(phi, side).near

    def on_pivot(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, n) coefficients of R + F_c."""
        found = -self.of_coupler(phi, side)
        found[0] -= self.of_spring(phi, side) + self.weight(phi)
        for each in self.own():
            found += each.mass * acceleration(each.rates(phi, side))
        return found

    def on_guide(self, phi: FloatArray, side: Side) -> FloatArray:
        """(4, n) coefficients of S without that of F_c."""
        force = self.of_coupler(phi, side)
        force[0] += self.weight(phi)
        return self.across(force)

    def across(self, force: ComplexArray) -> FloatArray:
        """(..., n) of a `force`, across the guide to the right looking outwards."""
        follower = self.subject.cam.follower
        right = -1j * math.copysign(1.0, follower.reach) * follower.way
        return np.asarray(np.real(np.conj(right) * force))

    def on_bearings(self, friction: Friction, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, k, n) coefficients of the loads that rub in pivot or guide, without those of the
        contact.
        """
        if self.subject.cam.follower.pivot is not None:
            return self.on_pivot(phi, side)[:, np.newaxis]
        return self._on_ends(friction, self.on_guide(phi, side), phi, side).swapaxes(0, 1)

    def per_far(self, friction: Friction, phi: FloatArray, side: Side) -> ComplexArray:
        """(k, n) the loads of `on_bearings` by one unit more of force on the far member of the
        linkage, along its motion; 0 without one.
        """
        zero = np.zeros(len(phi), dtype=np.complex128)
        force = zero if self.coupler is None else self.coupler.per_far(phi, side)
        if self.subject.cam.follower.pivot is not None:
            return -force[np.newaxis]
        return self._on_ends(friction, self.across(force), phi, side)

    def _on_ends(
        self, friction: Friction, force: FloatArray, phi: FloatArray, side: Side
    ) -> ComplexArray:
        """(k, ..., n) the forces of near and far end for the side `force`, or of the guide."""
        overhang = friction.bearing(phi, side, 1).overhang
        ends = guide_ends(force, 0.0, overhang, friction.guide_length).astype(np.complex128)
        return ends if friction.guide_length is not None else ends[:1]
