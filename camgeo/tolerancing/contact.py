"""What deviating machines cost in contact force, if the scene asks for that effect.

The normal force of the nominal machine is changed by the inertia of what is accelerated otherwise:
with the mass M reduced to the follower, and B the force on it per unit of normal force,

    dN = M (dq'' omega^2 + dq' alpha) / B.

That springs, leverage and friction change too is left out: they change by the error itself, a tiny
part of the lift, while the acceleration follows its curvature.
"""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.design import Design
from camgeo.effects.results import CONTACT_FORCE, INERTIA
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.path import Flank


@dataclass(frozen=True, slots=True, eq=False)
class ContactForces:
    """On the flank that carries, at n cam angles; negative where that would have to pull.

    Attributes
    ----------
    nominal : (n,) normal force [N].
    per_velocity, per_acceleration : (n,) [N] per unit of q' and of q''.
    """

    nominal: FloatArray
    per_velocity: FloatArray
    per_acceleration: FloatArray

    def of(self, first: FloatArray, second: FloatArray) -> FloatArray:
        """(m, n) [N] of machines whose q' and q'' are off by `first` and `second` (m, n)."""
        return self.nominal + self.per_velocity * first + self.per_acceleration * second


def contact_forces(design: Design, flank: Flank, phi: FloatArray) -> ContactForces | None:
    """Of the nominal machine at `phi` (n,) [rad].

    None if the scene names no contact force or no inertia, if it states no speed, or if there is no
    contact force, which is a finding of the effect.
    """
    named, course = design.scene.effects, design.drive.time_course
    if course is None or not {CONTACT_FORCE, INERTIA} <= set(named):
        return None
    try:
        force = design.effects.result(CONTACT_FORCE)
        mass = design.effects.result(INERTIA).to_follower(phi, "right")
    except EffectError:
        return None
    sense = -flank.sign
    omega, alpha = course.rates(phi)[:2]
    per = mass / force.bracket(phi, "right", sense)
    return ContactForces(sense * force.normal(phi, "right"), per * alpha, per * omega**2)
