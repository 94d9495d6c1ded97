"""Points of an exact flank to be measured, with their true normals.

At a step of the cam angle, or evenly along the flank: the arc length of each cell is Gauss's
integral of the pace ds/dphi, an exact function of the cam angle, and Newton's method finds the cam
angle of a length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.inspection.exact_flank import ExactFlank, Feet, Places
from camgeo.inspection.normals import false_share, off_radius
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.extremes import Extreme
from camgeo.numeric.quadrature import gauss
from camgeo.numeric.roots import inverse
from camgeo.outline.path import Stretch

MOST: Final = 200_000
"""Points of a flank."""

NODES: Final = 8
"""Of Gauss's rule on a cell of a quarter of a degree: exact to rounding between the breaks."""

ROOM: Final = 1e-9
"""The ball fits if no place of the flank is nearer to its centre than its radius less this share
of the flank's size."""


@dataclass(frozen=True, slots=True, eq=False)
class ProbePoints:
    """Points of one flank to be measured.

    Attributes
    ----------
    flank : of which they are.
    places : (n,) of the points, in the order of the path.
    missing : number of steps at which the disc has nothing of the flank.
    ball : radius of the measuring ball [mm], 0 for a point.
    """

    flank: ExactFlank
    places: Places
    missing: int = 0
    ball: float = 0.0

    @property
    def centres(self) -> ComplexArray:
        """(n,) complex [mm] of the ball when it touches the points."""
        found: ComplexArray = self.places.points + self.ball * self.places.normals
        return found

    @property
    def off_radius(self) -> Extreme:
        """The largest angle [rad] between a normal and the radius, with its cam angle."""
        angles = np.abs(off_radius(self._feet))
        worst = int(np.argmax(angles))
        return Extreme(float(angles[worst]), float(self.places.phi[worst]))

    @property
    def feigned(self) -> float:
        """The largest deviation [mm] that radial normals would feign with this ball."""
        return float(np.max(false_share(off_radius(self._feet)))) * self.ball

    @property
    def obstructed(self) -> Extreme | None:
        """How much nearer [mm] than its radius another place of the flank is to the ball where it
        fits worst, with the cam angle; None if it fits everywhere.
        """
        if self.ball == 0.0:
            return None
        short = self.ball - self.flank.feet(self.centres).distances
        worst = int(np.argmax(short))
        if short[worst] <= ROOM * self.flank.size:
            return None
        return Extreme(float(short[worst]), float(self.places.phi[worst]))

    @property
    def _feet(self) -> Feet:
        return Feet(self.places, np.zeros(len(self.places)))


def at_cam_angles(flank: ExactFlank, phi: FloatArray, ball: float = 0.0) -> ProbePoints:
    """Points at the cam angles `phi` (n,) [rad] in [0, 2 pi), ascending.

    Raises GeometryError if the disc has nothing of the flank at any of them.
    """
    course = flank.course_of(phi)
    there = ~np.isnan(course)
    if not np.any(there):
        raise GeometryError("the disc has nothing of the flank at any of these cam angles")
    places = flank.at(course[there])
    # As asked for: a turn added and taken away again would round it.
    places.phi[:] = phi[there]
    return ProbePoints(flank, places, int(np.count_nonzero(~there)), ball)


def evenly(flank: ExactFlank, spacing: float, ball: float = 0.0) -> ProbePoints:
    """Points as far apart along the flank as possible, at most `spacing` [mm], all equally.

    The first one is at the start of the path, or half a spacing from it where that is a corner.

    Raises GeometryError if these would be more than `MOST`.
    """
    nodes, lengths = flank.nodes, _lengths(flank)
    total = float(lengths[-1])
    if total > MOST * spacing:
        raise GeometryError(
            f"points {spacing:g} mm apart on a flank of {total:.6g} mm would be more than {MOST:,}"
        )
    count = max(1, math.ceil(total / spacing))
    first = 0.0 if flank.path.is_whole else 0.5
    wanted: FloatArray = (np.arange(count, dtype=np.float64) + first) * (total / count)
    used = np.concatenate(([True], np.diff(lengths) > 0.0))  # the second of two at a corner is not
    edges, marks = nodes.course[used], lengths[used]

    def length(course: FloatArray) -> FloatArray:
        cell = np.clip(np.searchsorted(edges, course, side="right") - 1, 0, len(edges) - 2)
        return marks[cell] + _integrals(flank, edges[cell], course)

    course = inverse(length, lambda u: _paces(flank, u), edges, wanted)
    return ProbePoints(flank, flank.at(course), 0, ball)


def length_of(flank: ExactFlank) -> float:
    """Length of the flank [mm]."""
    return float(_lengths(flank)[-1])


def _lengths(flank: ExactFlank) -> FloatArray:
    """(k,) [mm] from the start of the path to each of its nodes."""
    course = flank.nodes.course
    return np.concatenate(([0.0], np.cumsum(_integrals(flank, course[:-1], course[1:]))))


def _integrals(flank: ExactFlank, low: FloatArray, high: FloatArray) -> FloatArray:
    """(n,) lengths [mm] of the path from `low` (n,) to `high` (n,) [rad], within a cell each."""
    places, half, weights = gauss(low, high, NODES)
    return np.asarray(half * (_paces(flank, places.ravel()).reshape(places.shape) @ weights))


def _paces(flank: ExactFlank, course: FloatArray) -> FloatArray:
    """(n,) length per position u [mm/rad]."""
    element, along = flank.element_at(course)
    found = np.empty(len(course))
    for number, each in enumerate(flank.path.elements):
        which = element == number
        if not np.any(which):
            continue
        if isinstance(each, Stretch):
            found[which] = flank.curve.pace(each.start + along[which])
        else:
            found[which] = abs(each.distance)
    return found
