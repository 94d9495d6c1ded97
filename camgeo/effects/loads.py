"""Loads on the pivot or the guide of a follower: one definition for friction and for reactions.

The cam presses on the follower with F_c = |N| (s n + f_t t), in the notation of `friction`. With
the forces F of spring and weights, and the masses m at their centres with the accelerations a, the
balance of forces on a rocker gives the force of its pivot,

    R = sum m a - sum F - F_c.

Loads and torsion springs are torques, and need none; a rocker of which only the moment of inertia
is stated counts as balanced about its pivot. The masses of the follower itself move as it does,
whatever elastic train is behind it. A guided follower accelerates along its guide, across
which the two ends must carry the side force S of F_c and of the weights, to the right looking
outwards, and the tilting moment M:

    R_2 = (a S + M) / b,    R_1 = -((a + b) S + M) / b,

with the near end at the distance a outwards of the roller's centre and the far end b beyond. The
weights act on the line of the guide. Without b the guide carries R_1 = -S.

Newton's second law for each body (Norton, Design of Machinery, chapter on dynamic force analysis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.results import BEYOND
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.effects.results import Friction, Gravity, Inertia, Mass, Spring


def guide_ends(
    force: FloatArray, moment: FloatArray | float, overhang: FloatArray, length: float | None
) -> FloatArray:
    """(2, n) R_1 and R_2 for the side force S and the moment M; -S and 0 without a length b."""
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

    def on_pivot(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, n) coefficients c0 to c3 of R + F_c, see `camgeo.effects.force`."""
        found = np.zeros((4, len(phi)), dtype=np.complex128)
        found[0] = -(self.of_spring(phi, side) + self.weight(phi))
        for each in self.own():
            first, second = each.rates(phi, side)
            found[2] += each.mass * second
            found[3] += each.mass * first
        return found

    def across(self, force: ComplexArray) -> FloatArray:
        """(n,) of a `force`, across the guide to the right looking outwards."""
        follower = self.subject.cam.follower
        right = -1j * math.copysign(1.0, follower.reach) * follower.way
        return np.asarray(np.real(np.conj(right) * force))

    def on_bearings(self, friction: Friction, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, k, n) coefficients of the loads that rub in pivot or guide, without those of the
        contact.

        They are 0 behind a linkage, whose coupler loads the follower too: there the contact alone
        counts.
        """
        subject = self.subject
        if subject.drive.linkage is not None:
            count = 1 if friction.guide_length is None else 2
            return np.zeros((4, count, len(phi)), dtype=np.complex128)
        if subject.cam.follower.pivot is not None:
            return self.on_pivot(phi, side)[:, np.newaxis]
        overhang = friction.bearing(phi, side, 1).overhang
        weight = self.across(self.weight(phi))
        ends = guide_ends(weight, 0.0, overhang, friction.guide_length)
        found = np.zeros((4, *ends.shape), dtype=np.complex128)
        found[0] = ends
        return found if friction.guide_length is not None else found[:, :1]
