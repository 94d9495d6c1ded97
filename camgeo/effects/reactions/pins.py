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

Newton's second law for each body (Norton, Design of Machinery, chapter on dynamic force analysis,
which solves the same equations as one system).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from camgeo.effects.force import acceleration, at_rates, rates_of
from camgeo.effects.immovable import refuse_locked
from camgeo.effects.linked import shaft_and_turn
from camgeo.effects.reactions.load import Load
from camgeo.effects.results import BEYOND
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, dot

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity, Subject
    from camgeo.effects.force import Force
    from camgeo.effects.results import Gravity, Inertia
    from camgeo.mechanism.linkage_protocol import Linkage


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """The forces in the joints of a linkage at n cam angles, complex [N].

    Attributes
    ----------
    near : (n,) F_A, of the coupler on the follower's member.
    far : (n,) F_B, of the coupler on the far member.
    held : (n,) of its guide on a slider, across it; of its shaft on a lever or crank.
    """

    near: ComplexArray
    far: ComplexArray
    held: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class Pins:
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

    def at(self, phi: FloatArray, side: Side) -> Joints:
        """The forces at n cam angles [rad]."""
        linkage, inertia = self.linkage, self.inertia
        shaft, turn = shaft_and_turn(self.subject, linkage)
        stroke = self.subject.state.output.jet(phi, side)
        own = self.subject.state.motion.jet(phi, side, 2)
        one, none = np.ones(len(phi)), np.zeros(len(phi))
        places = linkage.joints(stroke[0])
        moved = linkage.joint_rates(stroke[0], stroke[1:3], own[1:3])
        per_far = linkage.joint_rates(stroke[0], np.stack((one, none)), np.stack((none, none)))
        # P and T: the tip T is on the rocker's shaft, or the pin P on a carriage.
        near, far = (1, 0) if self.subject.cam.follower.pivot is not None else (0, 1)
        rod, way = turn * (places[far] - places[near]), turn * per_far[far][0]
        along = rod / np.abs(rod)

        rates = rates_of(self.subject, phi, side)
        demand = -sum((at_rates(each.far(phi, side), rates) for each in self.forces if each.far),
                      start=none)  # fmt: skip
        left, moment = none + 0j, none
        pull = 0j if self.gravity is None else self.gravity.pull
        weight = 0j
        if inertia is not None:
            demand = demand + inertia.moved * acceleration(stroke[1:3], rates)
            turning = turn * (moved[far] - moved[near]) / rod
            moment = -inertia.coupler_moment * acceleration(turning.imag, rates)
            for each in (mass for mass in inertia.masses if mass.name in BEYOND):
                if each.name != "coupler":  # a slider
                    weight = each.mass * pull
                else:
                    left = each.mass * (pull - acceleration(each.rates(phi, side), rates))
                    lever = each.place(phi, side) - (shaft + turn * places[near])
                    moment = moment + dot(1j * lever, left)
        demand = demand - dot(way, weight)
        across = moment / np.abs(rod)
        pressed = (demand - across * dot(way, 1j * along)) / dot(way, along)
        on_far = (pressed + 1j * across) * along
        held = -(on_far + weight)
        if linkage.unit == "mm":  # friction and load along the guide are no reactions
            held = held - way * dot(way, held)
        return Joints(left - on_far, on_far, held)

    def loads(self) -> list[Load]:
        """What is reported of them."""
        member = self.linkage.member
        follower = self.subject.cam.follower.mover
        found = [
            Load("near pin force", f"force between {follower} and coupler", self._size("near")),
            Load("far pin force", f"force between coupler and {member}", self._size("far")),
        ]
        if self.linkage.unit == "mm":
            words = "force across the guide of the slider"
            found.append(Load("slider guide force", words, self._size("held")))
        return found

    def _size(self, joint: Literal["near", "far", "held"]) -> Quantity:
        return lambda phi, side: np.abs(getattr(self.at(phi, side), joint))


def pins_of(
    subject: Subject,
    linkage: Linkage,
    forces: tuple[Force, ...],
    inertia: Inertia | None,
    gravity: Gravity | None,
) -> Pins:
    """The joints of the `linkage` of `subject`.

    Raises
    ------
    EffectError
        If the follower cannot move the far member at some cam angle: the pins would carry any
        force.
    """
    refuse_locked(subject, "")
    return Pins(subject, linkage, forces, inertia, gravity)
