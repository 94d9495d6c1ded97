"""Independent measures for tests: exact distances from lines and arcs, dense points of both.

Nothing of the code under test is used here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import shapely
from scipy.spatial import cKDTree

from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray

SLACK = 1e-9
"""Excess width of boxes, relative and [mm]: more than all rounding."""

RUN = 8
"""Chords of a dense path in one element of its tree: it is built ten times as fast as with one."""


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

    @classmethod
    def around(
        cls,
        rng: np.random.Generator,
        radii: tuple[float, float],
        sweeps: tuple[float, float],
        straight: float,
    ) -> Self:
        """Through 5 to 12 points about the origin, drawn within `radii` and `sweeps`; sweeps of
        less than `straight` are lines."""
        count = int(rng.integers(5, 13))
        points = rng.uniform(*radii, count) * np.exp(2j * np.pi * np.arange(count) / count)
        turned = rng.uniform(*sweeps, count)
        return cls.through(points, np.where(np.abs(turned) < straight, 0.0, turned))

    @property
    def area(self) -> float:
        """Signed area by Green's theorem, x dy of chords and of circle segments."""
        chords = 0.5 * np.sum((np.conj(self.starts) * self.ends).imag)
        radii = np.where(self.sweeps != 0.0, np.abs(self.starts - self.centres), 0.0)
        return float(chords + 0.5 * np.sum(radii**2 * (self.sweeps - np.sin(self.sweeps))))

    @property
    def centroid(self) -> complex:
        """Of what it encloses [mm], as of fine chords."""
        start = self.dense(2_000)
        end = np.roll(start, -1)
        cross = (start.conj() * end).imag
        return complex(np.sum((start + end) * cross) / (3.0 * np.sum(cross)))

    def dense(self, count: int) -> ComplexArray:
        """At least `count` points, the same number on each piece, its start included."""
        each = max(2, -(-count // len(self.starts)))
        part = np.arange(each) / each
        start, end = self.starts[:, None], self.ends[:, None]
        # From the start, not from the centre, which may be a million kilometres away.
        arcs = start + (start - self.centres[:, None]) * np.expm1(1j * self.sweeps[:, None] * part)
        lines = start + (end - start) * part
        return np.where(self.sweeps[:, None] != 0.0, arcs, lines).ravel()

    def distances(self, points: ComplexArray) -> FloatArray:
        """(n,) exact distance of each point from the nearest piece.

        Only pieces whose box is no farther than the nearest of the starts are measured.
        """
        nearest, _ = _tree(self.starts).query(_plane(points))
        found = self._boxes.query(_boxes(points, nearest * (1.0 + SLACK) + SLACK))
        distances: FloatArray = np.full(len(points), np.inf)
        np.minimum.at(distances, found[0], self.apart(points[found[0]], found[1]))
        return distances

    @property
    def _boxes(self) -> shapely.STRtree:
        """A box about each piece: about the circle over its chord, or about one twice as large as
        the arc's own where that turns by more than half a turn.
        """
        half = 0.5 * np.abs(self.ends - self.starts)
        around = 2.0 * np.abs(self.starts - self.centres)
        reach = np.where(np.abs(self.sweeps) > np.pi, around, half)
        return shapely.STRtree(_boxes(0.5 * (self.starts + self.ends), reach))

    def apart(self, p: ComplexArray, piece: IntArray) -> FloatArray:
        """Exact distance of each point from its own piece."""
        starts, ends = self.starts[piece], self.ends[piece]
        sweeps, centres = self.sweeps[piece], self.centres[piece]
        at_ends = np.minimum(np.abs(p - starts), np.abs(p - ends))
        chord = ends - starts
        size = np.where(chord == 0.0, 1.0, np.abs(chord))
        local = (p - starts) * np.conj(chord / size)
        within = (local.real >= 0.0) & (local.real <= size)
        from_line = np.where(within, np.abs(local.imag), at_ends)
        arm = p - centres
        first = np.where(sweeps != 0.0, starts - centres, 1.0)
        turned = np.angle(arm * np.conj(first)) * np.sign(sweeps)
        within = np.mod(turned, 2.0 * np.pi) <= np.abs(sweeps)
        # The difference of both radii, without their rounding: by that of their squares.
        away = p - starts
        squares = (away * np.conj(away + 2.0 * first)).real
        from_radius = np.abs(squares) / (np.abs(arm) + np.abs(first))
        from_arc = np.where(within, from_radius, at_ends)
        found: FloatArray = np.where(sweeps != 0.0, from_arc, from_line)
        return found


def _boxes(middles: ComplexArray, reach: FloatArray) -> Any:
    """Squares about `middles`, from `reach` to the left to `reach` to the right."""
    x, y = middles.real, middles.imag
    return shapely.box(x - reach, y - reach, x + reach, y + reach)


def _plane(points: ComplexArray) -> FloatArray:
    """(n, 2) coordinates of `points` (n,)."""
    return np.ascontiguousarray(points, np.complex128).view(np.float64).reshape(-1, 2)


def _tree(points: ComplexArray) -> Any:
    """Finds the nearest of `points`, quickly built: they are in order along a curve."""
    return cKDTree(_plane(points), balanced_tree=False, compact_nodes=False)


class DensePath:
    """A closed curve by dense points: distances from its chords, too large by a chord's sagitta,
    h^2 kappa/8 for chords of length h.
    """

    def __init__(self, points: ComplexArray) -> None:
        kept = points[points != np.roll(points, -1)]
        first = np.arange(0, len(kept), RUN)
        # Runs of chords share a point with the next; the last one closes the curve.
        rows = (first[:, None] + np.arange(RUN + 1)).ravel()
        row = np.repeat(np.arange(len(first)), RUN + 1)[rows <= len(kept)]
        corners = kept[rows[rows <= len(kept)] % len(kept)]
        self._chords = shapely.STRtree(shapely.linestrings(corners.real, corners.imag, indices=row))

    def distances(self, points: ComplexArray) -> FloatArray:
        """(n,) distance of each point from the path."""
        found: FloatArray = self._chords.query_nearest(
            shapely.points(points.real, points.imag), return_distance=True, all_matches=False
        )[1]
        return found


def polygon(points: ComplexArray) -> shapely.Polygon:
    """Polygon through `points`."""
    return shapely.Polygon(np.column_stack((points.real, points.imag)))
