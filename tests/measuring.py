"""Measures of our own for tests: exact distances from lines and arcs, dense points of both.

Nothing of the code under test is used here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import shapely

from camgeo.numeric.arrays import ComplexArray, FloatArray

CHUNK = 2_000_000
"""Point-piece pairs looked at together."""


@dataclass(frozen=True)
class Outline:
    """Lines (sweep 0) and arcs from `starts` to `ends`, in turn."""

    starts: ComplexArray
    ends: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray

    @classmethod
    def through(cls, starts: ComplexArray, sweeps: FloatArray, *, closed: bool = True) -> Self:
        """Through the points `starts`, turning by `sweeps` (one more point than sweeps if open)."""
        ends = np.roll(starts, -1) if closed else starts[1:]
        starts = starts if closed else starts[:-1]
        arc = sweeps != 0.0
        # The centre lies on the bisector, half a chord times cot(sweep/2) left of the chord.
        cot = 1.0 / np.tan(0.5 * np.where(arc, sweeps, 1.0))
        centres = np.where(arc, 0.5 * (starts + ends) + 0.5j * (ends - starts) * cot, 0.0)
        return cls(starts, ends, sweeps, centres)

    @property
    def area(self) -> float:
        """Signed area by Green's theorem, x dy of chords and of circle segments."""
        chords = 0.5 * np.sum((np.conj(self.starts) * self.ends).imag)
        radii = np.where(self.sweeps != 0.0, np.abs(self.starts - self.centres), 0.0)
        return float(chords + 0.5 * np.sum(radii**2 * (self.sweeps - np.sin(self.sweeps))))

    def dense(self, count: int) -> ComplexArray:
        """At least `count` points, the same number on each piece, its start included."""
        each = max(2, -(-count // len(self.starts)))
        part = np.arange(each) / each
        start, end = self.starts[:, None], self.ends[:, None]
        turned = np.exp(1j * self.sweeps[:, None] * part)
        arcs = self.centres[:, None] + (start - self.centres[:, None]) * turned
        lines = start + (end - start) * part
        return np.where(self.sweeps[:, None] != 0.0, arcs, lines).ravel()

    def distances(self, points: ComplexArray) -> FloatArray:
        """(n,) exact distance of each point from the nearest piece."""
        step = max(1, CHUNK // len(self.starts))
        parts = [self._nearest(points[k : k + step]) for k in range(0, len(points), step)]
        return np.concatenate(parts)

    def _nearest(self, points: ComplexArray) -> FloatArray:
        p = points[:, None]
        at_ends = np.minimum(np.abs(p - self.starts), np.abs(p - self.ends))
        chord = self.ends - self.starts
        size = np.where(chord == 0.0, 1.0, np.abs(chord))
        local = (p - self.starts) * np.conj(chord / size)
        beside = (local.real >= 0.0) & (local.real <= size)
        from_line = np.where(beside, np.abs(local.imag), at_ends)
        arm = p - self.centres
        first = np.where(self.sweeps != 0.0, self.starts - self.centres, 1.0)
        turned = np.angle(arm * np.conj(first)) * np.sign(self.sweeps)
        beside = np.mod(turned, 2.0 * np.pi) <= np.abs(self.sweeps)
        from_arc = np.where(beside, np.abs(np.abs(arm) - np.abs(first)), at_ends)
        nearest: FloatArray = np.where(self.sweeps != 0.0, from_arc, from_line).min(axis=1)
        return nearest


class DensePath:
    """A closed curve by dense points: distances from its chords.

    Too large by a chord's sagitta at most, h^2 kappa/8 for chords of length h.
    """

    def __init__(self, points: ComplexArray) -> None:
        ends = np.roll(points, -1)
        keep = points != ends
        rows = np.stack((points[keep], ends[keep]), axis=1)
        coordinates = np.stack((rows.real, rows.imag), axis=2)
        chords: Any = shapely.linestrings(coordinates)
        self._tree = shapely.STRtree(chords)

    def distances(self, points: ComplexArray) -> FloatArray:
        """(n,) distance of each point from the path."""
        targets = shapely.points(points.real, points.imag)
        found, distances = self._tree.query_nearest(targets, return_distance=True)
        # A point that is as near to two chords is told twice.
        nearest: FloatArray = np.full(len(points), np.inf)
        np.minimum.at(nearest, found[0], distances)
        return nearest


def polygon(points: ComplexArray) -> shapely.Polygon:
    """Polygon through `points`."""
    return shapely.Polygon(np.column_stack((points.real, points.imag)))
