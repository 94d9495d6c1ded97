"""Forces in the joints of a linkage: its members cut free.

The coupler joins the follower's member at A and the far member at B, u = (B - A)/L its direction.
The force F_B of the coupler on the far member does the work that its mass m and the generalised
force Q on it leave, with the demanded coordinate x and b = dB/dx,

    b.F_B = m d^2 x/dt^2 - Q - m_s g.b,

m_s the mass of a slider, whose weight it is: the law of motion of the far member, a slider along
its guide or a lever about its shaft. The coupler of mass m_c, with its centre of mass C and its
moment of inertia J_c about it, turns at v. With w = m_c (g - a_C), its moments about A and its
forces give

    (B - A) x F_B = (C - A) x w - J_c d^2 v/dt^2,     F_A = w - F_B

with the force F_A on the follower's member. So F_B is known across u, and along u it is

    F_B.u = (b.F_B - (b.iu) (F_B.iu)) / (b.u),

where b.u is that sine of the transmission angle which is 0 where the follower cannot move the far
member. A dead centre, at which the far member could not move the follower, is no exception. The
guide of a slider carries -(F_B + m_s g) across it, the shaft of a lever or crank, whose mass is
not known, -F_B.

The motion of all members is known, so none of this depends on the contact force, nor on friction in
the bearings of the follower.

Newton's second law for each body (Norton, Design of Machinery, chapter on dynamic force analysis,
which solves the same equations as one system).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.force import acceleration
from camgeo.effects.immovable import refuse_locked
from camgeo.effects.linked import shaft_and_turn
from camgeo.effects.results import BEYOND
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, dot

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.effects.force import Force
    from camgeo.effects.results import Gravity, Inertia
    from camgeo.mechanism.linkage_protocol import Linkage


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
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

    def joints(self, phi: FloatArray, side: Side) -> Joints:
        """Coefficients (4, n) c0 to c3 of the forces, see `camgeo.effects.force`."""
        linkage, inertia = self.linkage, self.inertia
        stroke = self.subject.state.output.jet(phi, side)
        own = self.subject.state.motion.jet(phi, side, 2)
        near, rod, way = self._pose(stroke[0])
        along = rod / np.abs(rod)

        demand, moment = np.zeros((2, 4, len(phi)))
        for each in self.forces:
            if each.far is not None:
                demand -= each.far(phi, side)
        left = np.zeros((4, len(phi)), dtype=np.complex128)
        pull = 0j if self.gravity is None else self.gravity.pull
        weight = np.zeros_like(left)
        if inertia is not None:
            demand += inertia.moved * acceleration(stroke[1:3])
            first, last = self._ends(linkage.joint_rates(stroke[0], stroke[1:3], own[1:3]))
            turning = (last - first) / rod
            moment -= inertia.coupler_moment * acceleration(turning.imag)
            for mass in inertia.masses:
                if mass.name == "coupler":
                    left -= mass.mass * acceleration(mass.rates(phi, side))
                    left[0] += mass.mass * pull
                    moment += dot(1j * (mass.place(phi, side) - near), left)
                elif mass.name in BEYOND:  # a slider
                    weight[0] = mass.mass * pull
        demand -= dot(way, weight)
        across = moment / np.abs(rod)
        pressed = (demand - across * dot(way, 1j * along)) / dot(way, along)
        on_far = (pressed + 1j * across) * along
        held = -(on_far + weight)
        if linkage.unit == "mm":  # friction and load along the guide are no reactions
            held = held - way * dot(way, held)
        return Joints(left - on_far, on_far, held)

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
        """Of A and of B what is of P and of T in `both`, turned into the drawing: a rocker has the
        tip T, a carriage the pin P.
        """
        _, turn = shaft_and_turn(self.subject, self.linkage)
        pin, tip = (turn * each for each in both)
        return (pin, tip) if self.subject.cam.follower.pivot is None else (tip, pin)


def acts_beyond(forces: tuple[Force, ...], inertia: Inertia | None) -> bool:
    """Whether anything acts on coupler or far member of a linkage."""
    heavy = inertia is not None and (
        inertia.moved > 0.0 or any(each.name in BEYOND for each in inertia.masses)
    )
    return heavy or any(each.far is not None for each in forces)


def coupler_of(
    subject: Subject,
    linkage: Linkage,
    forces: tuple[Force, ...],
    inertia: Inertia | None,
    gravity: Gravity | None,
) -> Coupler:
    """The `linkage` of `subject`.

    Raises
    ------
    EffectError
        If the follower cannot move the far member at some cam angle: the joints would carry any
        force.
    """
    refuse_locked(subject, "")
    return Coupler(subject, linkage, forces, inertia, gravity)
