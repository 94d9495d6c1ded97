"""The course of a cutter: lines and arcs of its centre in the plane, with the heights of its tip.

Exact to the rounding of a few operations: no piece is replaced by chords.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from camgeo.geometry.contour.contour import Pieces
from camgeo.milling.moves import ArcFeed, Move, Point, Rapid, Stop
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, taken
from camgeo.numeric.checked import Floats, Integers


@dataclass(frozen=True, slots=True, eq=False)
class Course(Pieces):
    """Pieces in the order in which they are run.

    Attributes
    ----------
    starts, ends, sweeps, centres : as of all pieces, at most half a turn each, so that the circle
        around its chord holds a piece; the ends are equal where the cutter moves along Z alone.
    from_z, to_z : (n,) Z of the tip [mm] at both ends of each piece, with a constant slope between.
    moves : (n,) index of the move that it is part of.
    """

    from_z: Floats
    to_z: Floats
    moves: Integers

    @property
    def highest(self) -> FloatArray:
        """(n,) largest Z of the tip [mm] on each piece."""
        return np.maximum(self.from_z, self.to_z)

    @property
    def lowest(self) -> FloatArray:
        """(n,) least Z of the tip [mm] on each piece."""
        return np.minimum(self.from_z, self.to_z)

    @property
    def cleared(self) -> FloatArray:
        """(n,) Z [mm] down to which all of a piece has been run: that of its higher end, and of a
        move along Z that of its lower one.
        """
        upright = (self.starts == self.ends) & (self.sweeps == 0.0)
        return np.where(upright, self.lowest, self.highest)

    def part(self, first: FloatArray, last: FloatArray) -> Course:
        """The part of each from the share `first` to the share `last` (n,) of its length."""
        found = self.between(first, last)
        low, high = self._tip(first), self._tip(last)
        return Course(found.starts, found.ends, found.sweeps, found.centres, low, high, self.moves)

    def _tip(self, shares: FloatArray) -> FloatArray:
        """(n,) Z [mm] at a share of the length of each piece."""
        inner = self.from_z + (self.to_z - self.from_z) * shares
        return np.where(shares == 1.0, self.to_z, inner)


def below(course: Course, z: float) -> Course:
    """The parts of the pieces on which the tip is not above `z` [mm]."""
    course = taken(course, course.lowest <= z)
    if np.all(course.highest <= z):
        return course
    rise = course.to_z - course.from_z
    share = np.divide(z - course.from_z, rise, out=np.ones(len(course)), where=rise != 0.0)
    share = np.clip(share, 0.0, 1.0)
    first = np.where(course.from_z > z, share, 0.0)
    found = course.part(first, np.where(course.to_z > z, share, 1.0))
    low, high = np.minimum(found.from_z, z), np.minimum(found.to_z, z)  # which rounding may exceed
    return Course(found.starts, found.ends, found.sweeps, found.centres, low, high, found.moves)


def arc_sweeps(starts: ComplexArray, ends: ComplexArray, turns: FloatArray) -> FloatArray:
    """(n,) as `arc_sweep`, of arms (n,) and their directions (n,): 1 counter-clockwise, else -1."""
    found = np.angle(ends / starts) * turns
    found = np.where(found < -0.5 * np.pi, found + 2.0 * np.pi, found)
    return turns * np.maximum(found, 0.0)


def course_of(moves: Iterable[Move | Stop], at: Point | None = None) -> Course:
    """The course of the feed moves; traverses cut nothing and are left out.

    Parameters
    ----------
    at : where the cutter stands before; None if the first move is a traverse.
    """
    points: list[Point] = []
    rows: list[tuple[int, float, float, float]] = []  # of the move, its centre, its direction
    for number, move in enumerate(moves):
        if isinstance(move, Stop):
            continue
        if at is not None and not isinstance(move, Rapid):
            points += (at, move.end)
            if isinstance(move, ArcFeed):
                rows.append((number, *move.centre, 1.0 if move.ccw else -1.0))
            else:
                rows.append((number, 0.0, 0.0, 0.0))
        at = move.end
    ends = np.array(points, dtype=np.float64).reshape(-1, 2, 3)
    columns = np.array(rows, dtype=np.float64).reshape(-1, 4)
    flat = ends[:, :, 0] + 1j * ends[:, :, 1]
    centres = columns[:, 1] + 1j * columns[:, 2]
    sweeps = np.zeros(len(columns))
    arcs = np.flatnonzero(columns[:, 3])
    if len(arcs):
        arms = flat[arcs] - centres[arcs, None]
        sweeps[arcs] = arc_sweeps(arms[:, 0], arms[:, 1], columns[arcs, 3])
    z, numbers = ends[:, :, 2], columns[:, 0].astype(np.intp)
    whole = Course(flat[:, 0], flat[:, 1], sweeps, centres, z[:, 0], z[:, 1], numbers)
    index, first, last = whole.halves()
    return whole if len(index) == len(whole) else taken(whole, index).part(first, last)


def alike(course: Course) -> IntArray:
    """(n,) the first piece that is the same in the plane as each."""
    rows = np.column_stack((course.starts, course.ends, course.sweeps, course.centres))
    size = rows.dtype.itemsize * rows.shape[1]
    first: dict[bytes, int] = {}
    keys = np.ascontiguousarray(rows).view(f"V{size}")[:, 0].tolist()
    return np.array([first.setdefault(key, k) for k, key in enumerate(keys)], dtype=np.intp)
