"""The acceleration of a motor-driven cam.

The moment of inertia J of everything that turns with the camshaft, the motor torque T_m and the
torque T of the cam obey the equation of motion J alpha = T_m(omega) - T. T is g times the
generalised contact force R = c0 + c1 omega + c2 omega^2 + c3 alpha, with one value of g for R > 0
and another for R < 0. With r, which is R without its last term, this gives

    alpha = (T_m - g r) / (J + g c3),        R = (J r + c3 T_m) / (J + g c3),

so the sign of J r + c3 T_m determines g. Without friction g = q', and J + g c3 is the total moment
of inertia reduced to the camshaft, J + M q'^2 (Volmer, Getriebetechnik, chapter on dynamics:
reduction to the driving member). The state is y = omega^2 / 2, for which dy/dphi = alpha, regular
down to standstill.

With friction in pivot or guide under their whole loads, alpha = (T_m - T)/J, with T proportional to
|N|, makes R and the loads linear in |N|, so that the balance of `camgeo.effects.bearing_friction`
has J among its numbers and gives alpha without any iteration over it. Its root is the only one on
the flank that must carry if its kappa is above 0; otherwise no acceleration is certain, and the
follower counts as stuck. The linear law at the root has g and R as above, and the slope of alpha.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from camgeo.effects.bearing_friction import LINEAR, RubbingLaw
from camgeo.numeric.arrays import ComplexArray, FloatArray


class StuckError(ArithmeticError):
    """No acceleration satisfies the equation of motion: friction jams or locks the follower."""


class Drive(Protocol):
    """What drives the camshaft."""

    def torque(self, omega: FloatArray, /) -> tuple[FloatArray, FloatArray]:
        """Torque on the camshaft [N mm] and its derivative [N mm s] at the speeds `omega` (...)
        [rad/s].
        """


Driven = TypeVar("Driven", bound=Drive, covariant=True)


@dataclass(frozen=True, slots=True, eq=False)
class Shaft(Generic[Driven]):
    """The camshaft and its motor.

    Attributes
    ----------
    inertia : J [t mm^2], above 0.
    motor : its torque over speed.
    """

    inertia: float
    motor: Driven

    def push(self, law: FloatArray, y: FloatArray) -> FloatArray:
        """J r + c3 T_m (...), which has the sign of R; parameters as for `rate`."""
        c0, c1, c2, c3 = law[:4]
        omega = np.sqrt(2.0 * y)
        if len(law) != LINEAR:
            return self.inertia * RubbingLaw.of(law).released(*self._free(y)[:2])
        found: FloatArray = self.inertia * (c0 + omega * (c1 + omega * c2))
        found += c3 * self.motor.torque(omega)[0]
        return found

    def linear(self, law: FloatArray, y: FloatArray) -> FloatArray:
        """(6, ...) the linear law at y, see `RubbingLaw`; parameters as for `rate`."""
        if len(law) == LINEAR:
            return law
        return RubbingLaw.of(law).linear(*self._free(y))

    def loads(self, law: FloatArray, y: FloatArray) -> ComplexArray:
        """(k, ...) the loads of pivot or guide at y, of the rows (9 + 12 k, ...)."""
        return RubbingLaw.of(law).loads(*self._free(y))

    def _free(self, y: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """omega, the acceleration without a contact, and what a torque takes from it."""
        omega, slowing = np.sqrt(2.0 * y), 1.0 / self.inertia
        return omega, slowing * self.motor.torque(omega)[0], slowing

    def rate(self, law: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """alpha [rad/s^2], and its derivative with respect to y [1/rad]; see `response`."""
        return self.response(law, y)[:2]

    def response(self, law: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """alpha [rad/s^2], and its derivatives with respect to y [1/rad] and to the torque of the
        motor [1/(t mm^2)].

        Parameters
        ----------
        law : (6, ...) c0 to c3, g where R > 0, g where R < 0; or the rows of a `RubbingLaw`.
        y : (...) [rad^2/s^2], above 0.
        """
        linear = self.linear(law, y)
        c0, c1, c2, c3, ahead, behind = linear
        omega = np.sqrt(2.0 * y)
        drive, slope = self.motor.torque(omega)
        rest = c0 + omega * (c1 + omega * c2)
        gain = np.where(self.push(linear, y) >= 0.0, ahead, behind)
        gain = np.where((rest == 0.0) & (c3 == 0.0), 0.0, gain)
        moment = self.inertia + gain * c3
        if not np.all(moment > 0.0):
            raise StuckError
        alpha = (drive - gain * rest) / moment
        growth = (slope - gain * (c1 + 2.0 * omega * c2)) / (omega * moment)
        return alpha, growth, 1.0 / moment
