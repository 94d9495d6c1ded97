"""The inertia force of an unbalanced disc, and the errors of all figures of its balance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.effects.balance.holes import Row
from camgeo.effects.effect import Bound, Column, Quantity
from camgeo.effects.turning_disc import unbalance_force
from camgeo.effects.wording import KG
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, piecewise_highest

GRAM_MM: Final = 1e6
"""From t mm to g mm."""


@dataclass(frozen=True, slots=True)
class Errors:
    """The data from which the errors of all figures follow.

    Attributes
    ----------
    mass, mass_error : [t].
    unbalance, unsure : U and its error [t mm].
    radius : of a solid disc of that mass [mm].
    """

    mass: float
    mass_error: float
    unbalance: float
    unsure: float
    radius: float

    def figures(self, spin: Spin | None, arm: float | None, holes: Row | None) -> dict[str, Bound]:
        """By the names of findings and columns; `arm` is the radius of the counterweight [mm]."""
        scale = self.mass * self.radius
        own = Bound(self.unsure, scale)
        centre = self.unbalance / self.mass
        off = (self.unsure + centre * self.mass_error) / self.mass
        found = {
            "disc-mass": Bound(self.mass_error, self.mass).times(KG),
            "centre-of-mass": Bound(off, self.radius),
            "unbalance": own.times(GRAM_MM),
        }
        if spin is not None:
            forces = ("unbalance-force", "unbalance force x", "unbalance force y")
            found |= dict.fromkeys(forces, own.times(spin.largest_force_of_unit()))
        if arm is not None:
            found["counterweight"] = own.times(KG / arm)
        if holes is not None:  # d grows no faster than U, see `camgeo.effects.balance.holes`
            share = self.unsure / self.unbalance
            found["balancing-holes"] = Bound(share * holes.diameter, holes.diameter)
        return found


@dataclass(frozen=True, slots=True, eq=False)
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

    def force(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) [N] inertia force on the shaft, in the axes of the frame."""
        return unbalance_force(self.unbalance, self.rotation, phi, self.course.rates(phi, side))

    def largest_force(self) -> Extreme:
        """Its largest magnitude [N], and the first cam angle [rad] at which it has it."""
        return self._largest(lambda phi, side: np.abs(self.force(phi, side)))

    def largest_force_of_unit(self) -> float:
        """The same for an unbalance of 1 t mm."""
        return replace(self, unbalance=1.0 + 0.0j).largest_force().value

    def largest_speed(self) -> float:
        """The largest omega [rad/s]."""
        return self._largest(lambda phi, side: self.course.rates(phi, side)[0]).value

    def _largest(self, values: Quantity) -> Extreme:
        edges = merged(np.concatenate((self.smooth_angles, self.course.borders)))
        return piecewise_highest(values, edges)

    def columns(self) -> tuple[Column, ...]:
        """The components of the inertia force on the shaft along the axes of the frame."""
        return (
            Column("unbalance force x", "N", lambda phi, side: self.force(phi, side).real),
            Column("unbalance force y", "N", lambda phi, side: self.force(phi, side).imag),
        )
