"""The acceleration of a cam that a motor drives.

With J what turns with the camshaft, T_m the motor's torque, and the cam's torque T a multiple g of
the generalised contact force R = c0 + c1 omega + c2 omega^2 + c3 alpha, g one number for R > 0 and
another for R < 0, the equation of motion J alpha = T_m(omega) - T gives, r being R without its last
term,

    alpha = (T_m - g r) / (J + g c3),        R = (J r + c3 T_m) / (J + g c3),

so that the sign of J r + c3 T_m tells which g it is. Without friction g = q', and J + g c3 is the
moment of inertia of all reduced to the camshaft, J + M q'^2 (Volmer, Getriebetechnik, chapter on
dynamics: reduction to the driving member). The state is y = omega^2 / 2, for which
dy/dphi = alpha, regular down to standstill.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.effects.speed_fluctuation.spec import Motor
from camgeo.numeric.arrays import FloatArray


class StuckError(ArithmeticError):
    """No acceleration satisfies the equation of motion: friction jams or locks the follower."""


@dataclass(frozen=True, slots=True, eq=False)
class Shaft:
    """What turns and what drives it.

    Attributes
    ----------
    inertia : J [t mm^2], above 0.
    motor : its torque over the speed.
    """

    inertia: float
    motor: Motor

    def rate(self, law: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """alpha [rad/s^2], and its derivative with respect to y [1/rad].

        Parameters
        ----------
        law : (6, ...) c0 to c3, g where R > 0, g where R < 0.
        y : (...) [rad^2/s^2], above 0.
        """
        c0, c1, c2, c3, ahead, behind = law
        omega = np.sqrt(2.0 * y)
        drive, slope = self.motor.torque(omega)
        rest = c0 + omega * (c1 + omega * c2)
        gain = np.where(self.inertia * rest + c3 * drive >= 0.0, ahead, behind)
        gain = np.where((rest == 0.0) & (c3 == 0.0), 0.0, gain)
        moment = self.inertia + gain * c3
        if not np.all(moment > 0.0):
            raise StuckError
        alpha = (drive - gain * rest) / moment
        growth = (slope - gain * (c1 + 2.0 * omega * c2)) / (omega * moment)
        return alpha, growth
