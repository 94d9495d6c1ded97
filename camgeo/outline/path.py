"""Closed paths of stretches of parallels and of turns about a point.

The outline of a real disc is one: the remaining stretches of a working curve, and between two of
them either a corner or, where the follower's velocity jumps, the arc of the roller turning about
its centre. So is each parallel of it: the path of a cutter, or that of the roller centre on the
real disc.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from camgeo.curve.working_curve import WorkingCurve
from camgeo.displayed import Brief
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN


class Flank(StrEnum):
    """A flank by its name: the inner one bounds a disc, the outer one a hole."""

    INNER = "inner"
    OUTER = "outer"

    @property
    def sign(self) -> int:
        """Sign of its distance from the pitch curve, and of the direction that presses a roller."""
        return -1 if self is Flank.INNER else 1


@dataclass(frozen=True, slots=True)
class Stretch:
    """A stretch of a parallel of the pitch curve, traversed with growing cam angle.

    Attributes
    ----------
    curve : the parallel; regular inside the stretch.
    start, end : cam angles [rad], start in [0, 2 pi), start < end <= start + 2 pi. At `start` the
        right-hand values count, at `end` the left-hand ones.
    """

    curve: WorkingCurve
    start: float
    end: float

    @property
    def marks(self) -> FloatArray:
        """(m + 1,) cam angles [rad] from its start to its end, the curve smooth between them."""
        borders = np.concatenate((self.curve.borders, self.curve.borders + TURN))
        inside = borders[(borders > self.start) & (borders < self.end)]
        return np.concatenate(([self.start], inside, [self.end]))


@dataclass(frozen=True, slots=True)
class Pivot:
    """A turn of the normal about a point: centre + distance * n, n turning by `sweep`.

    With distance 0 it is a corner of the path; else an arc of the radius |distance|.

    Attributes
    ----------
    centre : [mm].
    distance : [mm], positive where the path lies on the outer side of the centre, as for a
        `WorkingCurve`.
    normal : n at the start, unit, outward.
    sweep : angle by which n turns [rad], counter-clockwise positive, in (-pi, pi).
    before, after : cam angles [rad] in [0, 2 pi] of the ends of the neighbouring stretches.
    """

    centre: complex
    distance: float
    normal: complex
    sweep: float
    before: float
    after: float

    @property
    def start(self) -> complex:
        """Where it begins [mm]."""
        return self.centre + self.distance * self.normal

    @property
    def end(self) -> complex:
        """Where it ends [mm]."""
        return self.centre + self.distance * self.normal * cmath.exp(1j * self.sweep)


Element = Stretch | Pivot


@dataclass(frozen=True, slots=True)
class Path(Brief):
    """A closed path; each element begins where the one before it ends.

    Attributes
    ----------
    elements : in the order of traversal, with growing cam angle.
    """

    elements: tuple[Element, ...]

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """The stretches, in order."""
        return tuple(each for each in self.elements if isinstance(each, Stretch))

    @property
    def pivots(self) -> tuple[Pivot, ...]:
        """The corners and arcs between them, in order."""
        return tuple(each for each in self.elements if isinstance(each, Pivot))

    @property
    def is_whole(self) -> bool:
        """True if the path is one parallel all round, with nothing cut off."""
        return len(self.elements) == 1

    def offset(self, by: float) -> Path:
        """The parallel at `by` [mm] farther outward; corners become arcs.

        Nothing is trimmed: the caller must ensure that stretches stay regular and the path free of
        crossings.
        """
        return Path(tuple(_offset(each, by) for each in self.elements))


def whole(curve: WorkingCurve) -> Path:
    """The path that is `curve` all round; its tangent must be continuous."""
    return Path((Stretch(curve, 0.0, TURN),))


def _offset(element: Element, by: float) -> Element:
    if isinstance(element, Stretch):
        curve = WorkingCurve(element.curve.pitch, element.curve.distance + by)
        return replace(element, curve=curve)
    return replace(element, distance=element.distance + by)
