"""A cam at the end of an elastic shaft: its equations of motion over the cam angle.

Its drive turns at constant speed Omega. The windup w is the angle by which the cam lags behind the
drive, the speed of the cam is omega. The shaft carries k w + c (Omega - omega), so that over the
cam angle, with y = omega^2 / 2,

    dy/dphi = alpha = (k w + c (Omega - omega) - T) / J,        dw/dphi = Omega / omega - 1,

with the torque T of the cam solved for alpha as in `camgeo.effects.shaft.rate`. The unknowns are v,
with y = Omega^2 (1/2 + v), and w: of a stiff shaft both are small, and keep their precision, as

    Omega / omega - 1 = -2 v / (r (1 + r)),        r = omega / Omega = sqrt(1 + 2 v).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from camgeo.effects.camshaft_windup.table import ElasticShaft
from camgeo.effects.shaft.rate import Shaft
from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Twist:
    """The torque of the shaft on the cam over its speed, at given windups.

    Attributes
    ----------
    stiffness, viscosity : k [N mm/rad] and c [N mm s].
    speed : Omega [rad/s].
    windup : (...) w [rad].
    """

    stiffness: float
    viscosity: float
    speed: float
    windup: FloatArray

    def torque(self, omega: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque [N mm] and its derivative [N mm s] at the speeds `omega` (...) [rad/s]."""
        carried = self.stiffness * self.windup + self.viscosity * (self.speed - omega)
        return carried, np.full(carried.shape, -self.viscosity)


@dataclass(frozen=True, slots=True, eq=False)
class Wound:
    """The cam at the end of the shaft.

    Attributes
    ----------
    shaft : the elastic shaft.
    speed : Omega [rad/s] of its drive.
    """

    shaft: ElasticShaft
    speed: float

    def driven(self, windup: FloatArray) -> Shaft[Twist]:
        """The cam with the shaft wound up by `windup` (...) [rad]."""
        own = self.shaft
        twist = Twist(own.stiffness, own.viscosity, self.speed, windup)
        return Shaft(own.moment_of_inertia, twist)

    def stiffened(self, factor: float) -> Wound:
        """The same with a shaft stiffer by the `factor`."""
        stiffness = factor * self.shaft.stiffness
        return Wound(replace(self.shaft, stiffness=stiffness), self.speed)

    def y(self, v: FloatArray) -> FloatArray:
        """(...) omega^2 / 2 [rad^2/s^2]."""
        return np.asarray(self.speed**2 * (0.5 + v))

    def rates(self, laws: FloatArray, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(..., 2) derivatives of v and w by the cam angle, and theirs (..., 2, 2) by v and w.

        Parameters
        ----------
        laws : (6 or more, ...) the torque law.
        state : (..., 2) v and w.
        """
        v, w = state[..., 0], state[..., 1]
        alpha, growth, per_torque = self.driven(w).response(laws, self.y(v))
        r = np.sqrt(1.0 + 2.0 * v)
        found = np.stack((alpha / self.speed**2, -2.0 * v / (r * (1.0 + r))), axis=-1)
        slopes = np.zeros((*v.shape, 2, 2))
        slopes[..., 0, 0] = growth
        slopes[..., 0, 1] = self.shaft.stiffness / self.speed**2 * per_torque
        slopes[..., 1, 0] = -1.0 / r**3
        return found, slopes
