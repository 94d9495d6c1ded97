"""A closed contour of lines and arcs: the form in which the geometry hands on an outline.

Vertices, sweeps and centres are arrays, so that a contour of 100,000 pieces needs no more memory
than its numbers. Piece i runs from vertex i to vertex i + 1, the last one back to vertex 0, so that
neighbours share their end points exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal, Self

import numpy as np

from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, frozen, grouped
from camgeo.outline.moments import Moments, piece_moments, segment_areas

EPS: Final = float(np.finfo(np.float64).eps)

POINTS: Final = 500_000
"""Points of a full turn: their chords lie within 2e-11 of the radius of it, a fifth of the finest
tolerance of a cam of that size. Files have arcs of any size."""


def is_straight(
    start: ComplexArray | complex, end: ComplexArray | complex, sweep: FloatArray | float
) -> BoolArray:
    """(n,) which pieces from `start` to `end` (n,) [mm] that turn by `sweep` (n,) [rad] are lines.

    Those that leave their chord by less than their ends are rounded: no centre could be stated.
    """
    sagitta = 0.5 * np.abs(end - start) * np.tan(0.25 * np.abs(sweep))
    return np.asarray(sagitta <= EPS * np.maximum(np.abs(start), np.abs(end)))


def radii_of(starts: ComplexArray, sweeps: FloatArray, centres: ComplexArray) -> FloatArray:
    """(n,) [mm] radius of each piece, an arc; 0 for lines."""
    return np.where(sweeps != 0.0, np.abs(starts - centres), 0.0)


def lengths_of(
    starts: ComplexArray, ends: ComplexArray, sweeps: FloatArray, radii: FloatArray
) -> FloatArray:
    """(n,) [mm] length of each piece from `starts` to `ends`, with the `radii` of arcs."""
    return np.where(sweeps != 0.0, np.abs(sweeps) * radii, np.abs(ends - starts))


@dataclass(frozen=True, slots=True, eq=False)
class Contour:
    """Closed chain of lines and circular arcs in the plane.

    Attributes
    ----------
    vertices : (n,) complex [mm], start of each piece.
    sweeps : (n,) [rad], angle turned along the piece, positive counter-clockwise; 0 is a line.
        At most one turn; a full circle is one piece with sweep +-2 pi.
    centres : (n,) complex [mm], centre of each arc; 0 where the piece is a line.
    """

    vertices: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, np.complex128))
        object.__setattr__(self, "sweeps", frozen(self.sweeps, np.float64))
        object.__setattr__(self, "centres", frozen(self.centres, np.complex128))

    def __len__(self) -> int:
        return len(self.vertices)

    @property
    def ends(self) -> ComplexArray:
        """(n,) complex [mm], end of each piece."""
        return np.roll(self.vertices, -1)

    @property
    def radii(self) -> FloatArray:
        """(n,) [mm] radius of each arc; 0 for lines."""
        return radii_of(self.vertices, self.sweeps, self.centres)

    @property
    def arc_count(self) -> int:
        """Number of arcs among the pieces."""
        return int(np.count_nonzero(self.sweeps))

    @property
    def lengths(self) -> FloatArray:
        """(n,) [mm] length of each piece."""
        return lengths_of(self.vertices, self.ends, self.sweeps, self.radii)

    @property
    def length(self) -> float:
        """Length of the whole contour [mm]."""
        return math.fsum(self.lengths)

    @property
    def area(self) -> float:
        """Enclosed area [mm^2], positive if the contour runs counter-clockwise."""
        start, end = self.vertices, self.ends
        chord = 0.5 * (start.real * end.imag - start.imag * end.real)
        segments = segment_areas(np.abs(end - start), self.radii, self.sweeps)
        return math.fsum(np.concatenate((chord, segments)))

    @property
    def moments(self) -> Moments:
        """Area and first moments of the region inside.

        They are computed about the mean of the vertices and shifted from there, so that a small
        contour far from the origin keeps its digits.
        """
        middle = complex(np.mean(self.vertices))
        about = piece_moments(
            self.vertices - middle, self.ends - middle, self.sweeps, self.centres - middle
        )
        first_error = about.first_error + about.area_error * abs(middle)
        first = about.first + about.area * middle
        return Moments(about.area, first, about.area_error, first_error)

    def reversed(self) -> Self:
        """The same outline in the opposite direction."""
        return type(self)(np.roll(self.vertices[::-1], 1), -self.sweeps[::-1], self.centres[::-1])

    def rolled(self, first: int) -> Self:
        """The same outline, beginning with its piece `first`."""
        return type(self)(
            np.roll(self.vertices, -first),
            np.roll(self.sweeps, -first),
            np.roll(self.centres, -first),
        )

    def counter_clockwise(self) -> Self:
        """The same outline, counter-clockwise."""
        return self if self.area >= 0.0 else self.reversed()

    def split(self, max_sweep: float) -> Self:
        """The same outline with each arc cut into equal parts of at most `max_sweep` [rad]."""
        parts = np.maximum(1, np.ceil(np.abs(self.sweeps) / max_sweep - 1e-12)).astype(int)
        index, step = grouped(parts)
        sweeps = self.sweeps[index] / parts[index]
        centres = self.centres[index]
        turned = centres + (self.vertices[index] - centres) * np.exp(1j * sweeps * step)
        vertices = np.where(step == 0, self.vertices[index], turned)
        return type(self)(vertices, sweeps, centres)

    def points(self, sagitta: float) -> ComplexArray:
        """(m,) complex [mm] points on the contour, chords at most `sagitta` [mm] off its arcs.

        For topology and pictures only; no geometry is derived from these points. There are at most
        `POINTS` of them a turn.
        """
        radii = np.maximum(self.radii, sagitta)
        step = 2.0 * np.arccos(np.clip(1.0 - sagitta / radii, 0.0, 1.0))
        step = np.maximum(step, 2.0 * np.pi / POINTS)
        counts = np.maximum(1, np.ceil(np.abs(self.sweeps) / step)).astype(int)
        index, number = grouped(counts)
        part = number / counts[index]
        arm = self.vertices[index] - self.centres[index]
        arc = self.centres[index] + arm * np.exp(1j * self.sweeps[index] * part)
        return np.where(part == 0.0, self.vertices[index], arc)

    @classmethod
    def polygon(cls, vertices: ComplexArray) -> Self:
        """Straight pieces between `vertices` (n,) [mm]."""
        return cls(vertices, np.zeros(len(vertices)), np.zeros_like(vertices))

    @classmethod
    def through(cls, vertices: ComplexArray, sweeps: FloatArray) -> Self:
        """Pieces between `vertices` (n,) [mm] that turn by `sweeps` (n,) [rad], as in files.

        The centres follow from both, so that each arc passes through its end points; one that is
        straight except for rounding is a line.
        """
        ends = np.roll(vertices, -1)
        straight = is_straight(vertices, ends, sweeps)
        half = np.tan(0.5 * np.where(straight, 1.0, sweeps))
        middles = vertices + 0.5 * (ends - vertices) * (1.0 + 1j / half)
        return cls(vertices, np.where(straight, 0.0, sweeps), np.where(straight, 0.0, middles))

    @classmethod
    def circle(cls, radius: float, centre: complex = 0j) -> Self:
        """A full circle [mm] as two half arcs, counter-clockwise."""
        vertices = np.array([centre + radius, centre - radius])
        return cls(vertices, np.array([np.pi, np.pi]), np.array([centre, centre]))


Effort = Literal["fast", "fewest"]
"""Effort of a fit: one pass, or the fewest pieces and then the least deviation."""

Form = Literal["polyline", "arcs", "spline"]
"""Form of a contour, named by the entities of a drawing."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A contour and its proof.

    Attributes
    ----------
    contour : the closed contour.
    deviation : upper bound [mm] of the distance between contour and exact curve, in both
        directions and for every point; rounding of the arithmetic included.
    tolerance : requested tolerance [mm]; `deviation` never exceeds it.
    """

    contour: Contour
    deviation: float
    tolerance: float
