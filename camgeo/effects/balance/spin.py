"""The effect of an unbalance in a turning cam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.effects.effect import Column
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import ComplexArray, FloatArray, merged
from camgeo.numeric.extremes import Extreme, piecewise_extremes
from camgeo.numeric.roots import Function


@dataclass(frozen=True, slots=True)
class Spin:
    """A turning disc with an unbalance.

    Attributes
    ----------
    unbalance : U [t mm] in cam coordinates.
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise.
    course : how it turns.
    smooth_angles : (k,) [rad], between which the motion is smooth.
    """

    unbalance: complex
    rotation: int
    course: TimeCourse
    smooth_angles: FloatArray

    def force(self, phi: FloatArray) -> ComplexArray:
        """(n,) [N] inertia force on the shaft, in the axes of the frame.

        The centre of mass is at U/m exp(i sigma phi). Minus m times its second derivative is
        U exp(i sigma phi) (omega^2 - i sigma alpha): the centrifugal force U omega^2, and at
        varying speed the tangential one (Norton, "Machine Design", chapter on balancing, for the
        first; the second derivative gives both).
        """
        omega, alpha = self.course.rates(phi)[:2]
        turned = np.exp(1j * self.rotation * phi)
        found: ComplexArray = self.unbalance * turned * (omega**2 - 1j * self.rotation * alpha)
        return found

    def largest_force(self) -> Extreme:
        """Its largest magnitude [N], and the first cam angle [rad] at which it has it."""
        return self._largest(lambda phi: np.abs(self.force(phi)))

    def largest_speed(self) -> float:
        """The largest omega [rad/s]."""
        return self._largest(lambda phi: self.course.rates(phi)[0]).value

    def _largest(self, values: Function) -> Extreme:
        edges = merged(np.concatenate((self.smooth_angles, self.course.borders)))
        return piecewise_extremes(lambda phi, _side: values(phi), edges).highest

    def columns(self) -> tuple[Column, ...]:
        """The components of the inertia force on the shaft along the axes of the frame."""
        return (
            Column("unbalance force x", "N", lambda phi, _side: self.force(phi).real),
            Column("unbalance force y", "N", lambda phi, _side: self.force(phi).imag),
        )
