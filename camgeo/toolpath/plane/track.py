"""An open chain of lines and arcs in the plane: the way of a cutter's centre, seen from above."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.pieces import Pieces
from camgeo.numeric.arrays import ComplexArray, FloatArray, frozen, taken

FLAT = 1e-9
"""An arc of a smaller sagitta [mm] is a line: far below what any program can state."""


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Lines and arcs, each beginning where the one before it ends.

    Attributes
    ----------
    vertices : (n + 1,) complex [mm], the ends of the n pieces.
    sweeps : (n,) [rad], angle turned along the piece, positive counter-clockwise; 0 is a line.
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
        return len(self.sweeps)

    @property
    def starts(self) -> ComplexArray:
        """(n,) complex [mm], start of each piece."""
        return self.vertices[:-1]

    @property
    def ends(self) -> ComplexArray:
        """(n,) complex [mm], end of each piece."""
        return self.vertices[1:]

    @property
    def start(self) -> complex:
        """Where it begins [mm]."""
        return complex(self.vertices[0])

    @property
    def end(self) -> complex:
        """Where it ends [mm]."""
        return complex(self.vertices[-1])

    @property
    def pieces(self) -> Pieces:
        """Its lines and arcs."""
        return Pieces.of(self)

    @property
    def lengths(self) -> FloatArray:
        """(n,) [mm] length of each piece."""
        return self.pieces.lengths

    @property
    def length(self) -> float:
        """Length of all pieces [mm]."""
        return float(np.sum(self.lengths))

    @property
    def headings(self) -> tuple[complex, complex]:
        """Unit tangents at its start and at its end, in its direction."""
        pieces = taken(self.pieces, [0, -1])
        first, last = pieces.tangents(np.array([self.start, self.end])).tolist()
        return first, last

    @classmethod
    def around(cls, contour: Contour) -> Self:
        """Once round a closed contour, from its first vertex."""
        vertices = np.append(contour.vertices, contour.vertices[0])
        return cls(vertices, contour.sweeps, contour.centres)

    @classmethod
    def line(cls, start: complex, end: complex) -> Self:
        """One line."""
        return cls(np.array([start, end]), np.zeros(1), np.zeros(1, dtype=np.complex128))

    @classmethod
    def arc(cls, start: complex, centre: complex, sweep: float) -> Self:
        """One arc from `start` about `centre` [mm] by `sweep` [rad]."""
        end = centre + (start - centre) * np.exp(1j * sweep)
        return cls(np.array([start, end]), np.array([sweep]), np.array([centre]))

    def reversed(self) -> Self:
        """The same in the opposite direction."""
        return type(self)(self.vertices[::-1], -self.sweeps[::-1], self.centres[::-1])

    def halved(self) -> Self:
        """The same with each arc in equal parts of at most half a turn."""
        pieces = self.pieces
        index, first, last = pieces.halves()
        parts = taken(pieces, index).between(first, last)
        vertices = np.append(parts.starts, self.vertices[-1])
        return type(self)(vertices, parts.sweeps, parts.centres)

    def at(self, distances: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(m,) points [mm] and unit tangents at `distances` (m,) [mm] from its start along it."""
        stops = np.concatenate(([0.0], np.cumsum(self.lengths)))
        index = np.clip(np.searchsorted(stops, distances, "right") - 1, 0, len(self) - 1)
        pieces = taken(self.pieces, index)
        lengths = pieces.lengths
        share = (distances - stops[index]) / np.where(lengths > 0.0, lengths, 1.0)
        points = pieces.at(np.clip(share, 0.0, 1.0))
        return points, pieces.tangents(points)

    def between(self, start: float, end: float) -> Self:
        """The part from `start` to `end` [mm] along it, 0 <= start < end <= length."""
        stops = np.concatenate(([0.0], np.cumsum(self.lengths)))
        slack = FLAT
        inner = np.flatnonzero((stops > start + slack) & (stops < end - slack))
        cuts = np.concatenate(([start], stops[inner], [end]))
        index = np.clip(
            np.searchsorted(stops, 0.5 * (cuts[:-1] + cuts[1:]), "right") - 1, 0, len(self) - 1
        )
        share = np.diff(cuts) / self.lengths[index]
        ends, _ = self.at(np.array([start, end]))
        if start <= slack:
            ends[0] = self.vertices[0]
        if end >= stops[-1] - slack:
            ends[1] = self.vertices[-1]
        vertices = np.concatenate((ends[:1], self.vertices[inner], ends[1:]))
        return type(self)(vertices, self.sweeps[index] * share, self.centres[index])


def chained(tracks: Iterable[Track]) -> Track:
    """One after the other; each begins where the one before it ends, to rounding."""
    parts = list(tracks)
    return Track(
        np.concatenate([parts[0].vertices[:1], *(each.vertices[1:] for each in parts)]),
        np.concatenate([each.sweeps for each in parts]),
        np.concatenate([each.centres for each in parts]),
    )


def biarcs(points: ComplexArray, tangents: ComplexArray) -> Track:
    """Two arcs of equal tangent length between each pair of neighbouring `points`.

    Parameters
    ----------
    points : (n,) complex [mm], distinct neighbours.
    tangents : (n,) unit, less than half a turn between neighbours.
    """
    start, end = points[:-1], points[1:]
    chord, both = end - start, tangents[:-1] + tangents[1:]
    # Equal tangent lengths d at both ends: |chord - d (t0 + t1)| = 2 d.
    square = np.abs(chord) ** 2
    along = (np.conj(chord) * both).real
    opening = 2.0 * (1.0 - (np.conj(tangents[:-1]) * tangents[1:]).real)
    length = square / (along + np.sqrt(along * along + opening * square))
    middle = 0.5 * (start + end + length * (tangents[:-1] - tangents[1:]))
    across = (chord - length * both) / (2.0 * length)
    vertices = np.append(np.column_stack((start, middle)).ravel(), points[-1])
    first = np.column_stack((tangents[:-1], across)).ravel()
    return tangential(vertices, first)


def tangential(vertices: ComplexArray, tangents: ComplexArray) -> Track:
    """The arcs between `vertices` (n + 1,) [mm] that leave with the unit `tangents` (n,)."""
    chords = np.diff(vertices)
    half = np.angle(chords * np.conj(tangents))
    lengths = np.abs(chords)
    flat = lengths * np.abs(half) <= 4.0 * FLAT
    radii = lengths / (2.0 * np.sin(np.where(flat, 1.0, half)))
    centres = np.where(flat, 0.0, vertices[:-1] + 1j * tangents * radii)
    return Track(vertices, np.where(flat, 0.0, 2.0 * half), centres)
