"""Flocke's construction of the cam axis (Wirsig section 2.4.1, eqs. 2.41 and 2.42 corrected).

It takes the largest velocities of both senses at both end positions of the follower: more than any
cam angle demands, so its place always keeps the transmission angle, and lies farther out than
necessary. A single end position, or velocities in the middle of the stroke, would not be safe.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.check.sizing.exchange import nearest_point
from camgeo.check.sizing.task import Task
from camgeo.curve.extremes import extremes
from camgeo.motion.extremes import lift_range
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side


@dataclass(frozen=True, slots=True, eq=False)
class Flocke:
    """The construction and its proposal.

    Attributes
    ----------
    normals, bounds : (8,) or more half-planes Re(conj(n) P) >= c of the region, see `Task`.
    place : the place of the cam axis in it with the smallest base circle [mm]; None if it is empty.
    """

    normals: ComplexArray
    bounds: FloatArray
    place: complex | None


def flocke(task: Task, tangent: float) -> Flocke:
    """The construction for a transmission angle of atan(`tangent`)."""
    lifts = np.repeat(lift_range(task.motion), 2)
    rates = np.tile(_velocity_range(task), 2)
    terms = task.terms_of(np.stack((lifts, rates, np.zeros_like(lifts))))
    sides = zip(
        terms.half_planes(tangent), terms.half_planes(-tangent), task.held_to(), strict=True
    )
    normals, bounds = (np.concatenate(each) for each in sides)
    return Flocke(normals, bounds, nearest_point(normals, bounds, task.start))


def _velocity_range(task: Task) -> tuple[float, float]:
    """Smallest and largest s' [mm or 1/rad] over the turn."""

    def velocity(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(task.motion.jet(phi, side, 1)[1])

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(task.motion.jet(phi, side, 2)[2])

    found = extremes(task.motion, velocity, acceleration)
    return found.smallest()[0], found.largest()[0]
