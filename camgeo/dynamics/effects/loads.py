"""Loads on the pivot or the guide of a follower, and forces in the joints of a linkage.

The cam presses on the follower with F_c = |N| (s n + f_t t), in the notation of `friction`. With
the forces F of spring, weights and the coupler of a linkage (`camgeo.dynamics.effects.loads`), and
the masses m at their centres with the accelerations a, the balance of forces on a rocker gives the
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
from typing import Final

import numpy as np
from numpy.typing import NDArray

from camgeo.dynamics.effects.effect import Results, Subject
from camgeo.dynamics.effects.forces import Force, at_rates, cam_rates, refuse_locked, shaft_and_turn
from camgeo.dynamics.effects.results import (
    GRAVITY,
    INERTIA,
    SPRING,
    Friction,
    Gravity,
    Inertia,
    Mass,
    Spring,
)
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.numeric.arrays import ComplexArray, FloatArray, Number, Side, dot

BEYOND: Final = ("slider", "coupler")
"""Names of the masses beyond the follower itself."""


def acceleration(jet: NDArray[Number]) -> NDArray[Number]:
    """(4, n) coefficients of d^2 x/dt^2 = x'' omega^2 + x' alpha (VDI 2143-1, eq. 2), from x' and
    x'' (2, n).
    """
    still = np.zeros_like(jet[0])
    return np.stack((still, still, jet[1], jet[0]))


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
        """(n,) weight of the follower's own masses."""
        return np.full(len(phi), self.pull * sum(mass.mass for mass in self.follower_masses()))

    def follower_masses(self) -> list[Mass]:
        """The masses of the follower itself."""
        masses = () if self.inertia is None else self.inertia.masses
        return [mass for mass in masses if mass.name not in BEYOND]

    def of_spring(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) force of the spring on the follower; 0 if it acts as a torque."""
        spring = self.spring
        if spring is None or spring.line is None:
            return np.zeros(len(phi), dtype=np.complex128)
        size = spring.preload - spring.stiffness * spring.way(phi, side)[0]
        return np.asarray(size * spring.line(phi, side))

    def of_coupler(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, n) coefficients c0 to c3 of its force on the follower, see
        `camgeo.dynamics.effects.forces`; 0 without one.
        """
        if self.coupler is None:
            return np.zeros((4, len(phi)), dtype=np.complex128)
        return self.coupler.joints(phi, side).near

    def on_pivot(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, n) coefficients of R + F_c."""
        coefficients = -self.of_coupler(phi, side)
        # Springs and weights do not depend on the speed.
        coefficients[0] -= self.of_spring(phi, side) + self.weight(phi)
        for mass in self.follower_masses():
            coefficients += mass.mass * acceleration(mass.rates(phi, side))
        return coefficients

    def on_guide(self, phi: FloatArray, side: Side) -> FloatArray:
        """(4, n) coefficients of S without that of F_c."""
        force = self.of_coupler(phi, side)
        force[0] += self.weight(phi)
        return self.across(force)

    def across(self, force: ComplexArray) -> FloatArray:
        """(..., n) component of a `force` across the guide, to the right looking outwards."""
        follower = self.subject.cam.follower
        right = -1j * math.copysign(1.0, follower.reach) * follower.way
        return np.asarray(np.real(np.conj(right) * force))

    def on_bearings(self, friction: Friction, phi: FloatArray, side: Side) -> ComplexArray:
        """(4, k, n) coefficients of the loads that rub in pivot or guide, without those of the
        contact.
        """
        if self.subject.cam.follower.pivot is not None:
            return self.on_pivot(phi, side)[:, np.newaxis]
        return self._end_forces(friction, self.on_guide(phi, side), phi, side).swapaxes(0, 1)

    def per_far(self, friction: Friction, phi: FloatArray, side: Side) -> ComplexArray:
        """(k, n) the loads of `on_bearings` by one unit more of force on the far member of the
        linkage, along its motion; 0 without one.
        """
        zero = np.zeros(len(phi), dtype=np.complex128)
        force = zero if self.coupler is None else self.coupler.per_far(phi, side)
        if self.subject.cam.follower.pivot is not None:
            return -force[np.newaxis]
        return self._end_forces(friction, self.across(force), phi, side)

    def _end_forces(
        self, friction: Friction, force: FloatArray, phi: FloatArray, side: Side
    ) -> ComplexArray:
        """(k, ..., n) the forces of near and far end for the side `force`, or of the guide."""
        overhang = friction.bearing(phi, side, 1).overhang
        ends = guide_ends(force, 0.0, overhang, friction.guide_length).astype(np.complex128)
        return ends if friction.guide_length is not None else ends[:1]


def follower_loads(
    subject: Subject, results: Results, forces: tuple[Force, ...], *, idle: bool
) -> Loads:
    """The loads on the follower besides the contact, with all `forces`. A coupler on which nothing
    acts is included only if `idle`.

    Raises
    ------
    EffectError
        If the follower cannot move the far member of its linkage at some cam angle: the joints
        would carry any force.
    """
    inertia, gravity = results.get(INERTIA), results.get(GRAVITY)
    linkage, coupler = subject.drive.linkage, None
    beyond = inertia is not None and (
        inertia.moved > 0.0 or any(mass.name in BEYOND for mass in inertia.masses)
    )
    beyond = beyond or any(force.far is not None for force in forces)
    if linkage is not None and (idle or beyond):
        refuse_locked(subject, "")
        coupler = Coupler(subject, linkage, forces, inertia, gravity)
    return Loads(subject, inertia, gravity, results.get(SPRING), coupler)


# -- coupler --------------------------------------------------------------------------------------
# Forces in the joints of a linkage: its members cut free.
#
# The coupler joins the follower's member at A and the far member at B, u = (B - A)/L its direction.
# The force F_B of the coupler on the far member does the work that its mass m and the generalised
# force Q on it leave, with the demanded coordinate x and b = dB/dx,
#
#     b.F_B = m d^2 x/dt^2 - Q - m_s g.b,
#
# m_s the mass of a slider, whose weight it is: the law of motion of the far member, a slider along
# its guide or a lever about its shaft. The coupler of mass m_c, with its centre of mass C and its
# moment of inertia J_c about it, turns at v. With w = m_c (g - a_C), its moments about A and its
# forces give
#
#     (B - A) x F_B = (C - A) x w - J_c d^2 v/dt^2,     F_A = w - F_B
#
# with the force F_A on the follower's member. So F_B is known across u, and along u it is
#
#     F_B.u = (b.F_B - (b.iu) (F_B.iu)) / (b.u),
#
# where b.u is that sine of the transmission angle which is 0 where the follower cannot move the far
# member. A dead centre, at which the far member could not move the follower, is no exception. The
# guide of a slider carries -(F_B + m_s g) across it, the shaft of a lever or crank, whose mass is
# not known, -F_B.
#
# The motion of all members is known, so none of this depends on the contact force, nor on friction
# in the bearings of the follower.
#
# Newton's second law for each body (Norton, Design of Machinery, chapter on dynamic force analysis,
# which solves the same equations as one system).


@dataclass(frozen=True, slots=True, eq=False)
class JointForces:
    """The forces in the joints of a linkage at n cam angles, complex [N], in the drawing.

    Attributes
    ----------
    near : (..., n) F_A, of the coupler on the follower's member.
    far : (..., n) F_B, of the coupler on the far member.
    held : (..., n) of its guide on a slider, across it; of its shaft on a lever or crank.
    """

    near: ComplexArray
    far: ComplexArray
    held: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class Coupler:
    """The linkage of a design and what acts on it; see the module.

    Attributes
    ----------
    subject : the design.
    linkage : of it.
    forces : all except that of the contact.
    inertia, gravity : None for what the scene does not have.
    """

    subject: Subject
    linkage: Linkage
    forces: tuple[Force, ...]
    inertia: Inertia | None
    gravity: Gravity | None

    def joints(self, phi: FloatArray, side: Side) -> JointForces:
        """Coefficients (4, n) c0 to c3 of the forces, see `camgeo.dynamics.effects.forces`."""
        linkage, inertia = self.linkage, self.inertia
        stroke = self.subject.state.output.jet(phi, side)
        follower = self.subject.state.motion.jet(phi, side, 2)
        near, rod, way = self._pose(stroke[0])
        along = rod / np.abs(rod)

        demand, moment = np.zeros((2, 4, len(phi)))
        for force in self.forces:
            if force.far is not None:
                demand -= force.far(phi, side)
        left = np.zeros((4, len(phi)), dtype=np.complex128)
        pull = 0j if self.gravity is None else self.gravity.pull
        weight = np.zeros_like(left)
        if inertia is not None:
            demand += inertia.moved * acceleration(stroke[1:3])
            first, last = self._ends(linkage.joint_rates(stroke[0], stroke[1:3], follower[1:3]))
            turning = (last - first) / rod
            moment -= inertia.coupler_moment * acceleration(turning.imag)
            for mass in inertia.masses:
                if mass.name == "coupler":
                    left -= mass.mass * acceleration(mass.rates(phi, side))
                    left[0] += mass.mass * pull
                    # dot(i r, F) is the moment of F about A, with r from A.
                    moment += dot(1j * (mass.place(phi, side) - near), left)
                elif mass.name in BEYOND:  # a slider
                    weight[0] = mass.mass * pull
        demand -= dot(way, weight)
        # Across the coupler F_B follows from moments about A, along it from the work on the far
        # member.
        across = moment / np.abs(rod)
        pressed = (demand - across * dot(way, 1j * along)) / dot(way, along)
        on_far = (pressed + 1j * across) * along
        held = -(on_far + weight)
        if linkage.unit == "mm":  # friction and load along the guide are no reactions
            held = held - way * dot(way, held)
        return JointForces(left - on_far, on_far, held)

    def at_speed(self, phi: FloatArray, side: Side) -> JointForces:
        """The forces (n,) at the speed of the scene."""
        rates, joints = cam_rates(self.subject, phi, side), self.joints(phi, side)
        return JointForces(
            *(at_rates(force, rates) for force in (joints.near, joints.far, joints.held))
        )

    def per_far(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) F_A for one unit more of Q."""
        _, rod, way = self._pose(self.subject.state.output.jet(phi, side)[0])
        return np.asarray(rod / dot(way, rod))

    def _pose(self, stroke: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """A, B - A and b (n,) with the far member at `stroke` (n,)."""
        shaft, _ = shaft_and_turn(self.subject, self.linkage)
        still = np.zeros((2, len(stroke)))
        one = np.stack((np.ones(len(stroke)), still[0]))
        near, far = self._ends(self.linkage.joints(stroke))
        way = self._ends(self.linkage.joint_rates(stroke, one, still))[1][0]
        return shaft + near, far - near, way

    def _ends(self, both: tuple[ComplexArray, ComplexArray]) -> tuple[ComplexArray, ComplexArray]:
        """A and B, or their derivatives, from those of P and T in `both`, turned into the drawing:
        a rocker has the tip T, a carriage the pin P.
        """
        _, turn = shaft_and_turn(self.subject, self.linkage)
        pin, tip = (turn * point for point in both)
        return (pin, tip) if self.subject.cam.follower.pivot is None else (tip, pin)
