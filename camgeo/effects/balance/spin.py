"""What an unbalance does in a turning cam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.effects.effect import Column
from camgeo.motion.motion import Side
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import ComplexArray, FloatArray, merged
from camgeo.numeric.extremes import piecewise_extremes


@dataclass(frozen=True, slots=True)
class Spin:
    """A disc with an unbalance, turning.

    Attributes
    ----------
    unbalance : U [t mm] in cam coordinates.
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise.
    course : how it turns.
    smooth_angles : (k,) [rad], see `camgeo.effects.effect.Subject`.
    """

    unbalance: complex
    rotation: int
    course: TimeCourse
    smooth_angles: FloatArray

    def force(self, phi: FloatArray) -> ComplexArray:
        """(n,) [N] force of inertia on the shaft, in the axes of the frame.

        The centre of mass is at U/m exp(i sigma phi). Minus m times its second derivative is
        U exp(i sigma phi) (omega^2 - i sigma alpha): the centrifugal force U omega^2, and at
        varying speed the tangential one (Norton, "Machine Design", chapter on balancing, for the
        first; the second derivative gives both).
        """
        omega, alpha = self.course.rates(phi)[:2]
        turned = np.exp(1j * self.rotation * phi)
        found: ComplexArray = self.unbalance * turned * (omega**2 - 1j * self.rotation * alpha)
        return found

    def largest_force(self) -> tuple[float, float]:
        """Its largest magnitude [N], and at which cam angle [rad] it first is that."""

        def magnitude(phi: FloatArray, _side: Side) -> FloatArray:
            return np.abs(self.force(phi))

        largest = piecewise_extremes(magnitude, self._edges()).highest
        return largest.value, largest.place

    def largest_speed(self) -> float:
        """The largest omega [rad/s]."""

        def omega(phi: FloatArray, _side: Side) -> FloatArray:
            speed: FloatArray = self.course.rates(phi)[0]
            return speed

        return piecewise_extremes(omega, self._edges()).highest.value

    def _edges(self) -> FloatArray:
        return merged(np.concatenate((self.smooth_angles, self.course.borders)))

    def columns(self) -> tuple[Column, ...]:
        """The force of inertia on the shaft, by its parts along the axes of the frame."""
        return (
            Column("unbalance force x", "N", lambda phi, _side: self.force(phi).real),
            Column("unbalance force y", "N", lambda phi, _side: self.force(phi).imag),
        )
