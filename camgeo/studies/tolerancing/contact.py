"""What deviating machines cost in contact force, if the scene asks for that effect.

The normal force is that of the nominal machine, changed by the inertia of what is accelerated
otherwise and by the leverage of the normal, which turns: with the mass M reduced to the follower, B
the force on it per unit of normal force, and L the leverage,

    N' = (N + M (dq'' omega^2 + dq' alpha) / B) L / L'.

That springs and friction change too is left out: a spring gives way by the error of the position, a
tiny part of the lift.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE, INERTIA
from camgeo.errors import EffectError
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ContactForces:
    """On the flank that carries, at n cam angles; negative where that would have to pull.

    Attributes
    ----------
    nominal : (n,) normal force [N].
    per_velocity, per_acceleration : (n,) [N] per unit of q' and of q''.
    leverage : (n,) magnitude of L [1 or mm/rad].
    """

    nominal: FloatArray
    per_velocity: FloatArray
    per_acceleration: FloatArray
    leverage: FloatArray

    def of(self, off: FloatArray, leverage: FloatArray) -> FloatArray:
        """(m, n) [N] of machines whose q, q' and q'' are off by `off` (3, m, n), with the magnitude
        of their `leverage` (m, n).
        """
        inertia = self.per_velocity * off[1] + self.per_acceleration * off[2]
        return np.asarray((self.nominal + inertia) * (self.leverage / leverage))


def contact_forces(design: Design, flank: Flank, phi: FloatArray) -> ContactForces | None:
    """Of the nominal machine at `phi` (n,) [rad].

    None if the scene names no contact force or no inertia, if it states no speed, or if there is no
    contact force, which is a finding of the effect.
    """
    if not {CONTACT_FORCE, INERTIA} <= set(design.scene.effects):
        return None
    try:
        force = design.effects.result(CONTACT_FORCE)
        mass = design.effects.result(INERTIA).to_follower(phi, "right")
    except EffectError:
        return None
    course = design.effects.course(CONTACT_FORCE)
    if course is None:
        return None
    sense = -flank.sign
    omega, alpha = course.rates(phi)[:2]
    per = mass / force.bracket(phi, "right", sense)
    leverage = np.abs(design.cam.disc.pitch_curve.leverage(phi))
    nominal = sense * force.normal(phi, "right")
    return ContactForces(nominal, per * alpha, per * omega**2, leverage)
