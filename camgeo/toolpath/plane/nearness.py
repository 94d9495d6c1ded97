"""Distances from chains of lines and arcs, in closed form.

The point of a piece that is nearest to a given point is the foot of the perpendicular, if that lies
on the piece, or one of its ends. The distance between two pieces is taken at an end of one of them,
or on their common normal, or is 0 because they cross.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, taken
from camgeo.toolpath.plane.track import Track

BLOCK = 500_000
"""Pairs that are computed at once."""

TURN = 2.0 * np.pi


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """Lines and arcs, arrays of one shape, as of `Track`.

    `middle` is a point of each piece and `reach` [mm] a bound of the distance of its points from
    there.
    """

    start: ComplexArray
    end: ComplexArray
    sweep: FloatArray
    centre: ComplexArray
    middle: ComplexArray
    reach: FloatArray

    @classmethod
    def of(cls, track: Track) -> Self:
        start, end, sweep, centre = track.starts, track.ends, track.sweeps, track.centres
        half = centre + (start - centre) * np.exp(0.5j * sweep)
        middle = np.where(sweep == 0.0, 0.5 * (start + end), half)
        # Of an arc up to half a turn the ends are farthest from its middle.
        far = 2.0 * np.abs(start - centre)
        reach = np.where(np.abs(sweep) <= np.pi, np.abs(start - middle), far)
        return cls(start, end, sweep, centre, middle, reach)

    @property
    def radius(self) -> FloatArray:
        """[mm], of arcs."""
        return np.abs(self.start - self.centre)

    def faces(self, arm: ComplexArray) -> BoolArray:
        """Whether the ray along `arm` from the centre of each arc meets it."""
        turned = np.angle(arm * np.conj(self.start - self.centre))
        turned = np.mod(np.where(self.sweep < 0.0, -turned, turned), TURN)
        on: BoolArray = (self.sweep != 0.0) & (turned <= np.abs(self.sweep))
        return on

    def along(self, point: ComplexArray) -> FloatArray:
        """Where the foot of `point` lies on each line, as a share of its length."""
        chord = self.end - self.start
        square = np.where(chord == 0.0, 1.0, np.abs(chord) ** 2)
        share: FloatArray = ((point - self.start) * np.conj(chord)).real / square
        return share

    def apart(self, point: ComplexArray) -> FloatArray:
        """Distance [mm] of each point from its piece."""
        share = np.clip(self.along(point), 0.0, 1.0)
        to_line = np.abs(point - (self.start + share * (self.end - self.start)))
        at_ends = np.minimum(np.abs(point - self.start), np.abs(point - self.end))
        arm = point - self.centre
        to_arc = np.where(self.faces(arm), np.abs(np.abs(arm) - self.radius), at_ends)
        found: FloatArray = np.where(self.sweep == 0.0, to_line, to_arc)
        return found


def distances(points: ComplexArray, track: Track) -> FloatArray:
    """(n,) exact distance [mm] of each of `points` (n,) from the nearest piece of `track`."""
    pieces = _Pieces.of(track)
    step = max(1, BLOCK // len(track))
    found = [np.empty(0)]
    for k in range(0, len(points), step):
        some = points[k : k + step]
        off = np.abs(some[:, None] - pieces.middle)
        nearest = np.min(off + pieces.reach, axis=1)
        row, column = np.nonzero(off - pieces.reach <= nearest[:, None])
        apart = taken(pieces, column).apart(some[row])
        first = np.flatnonzero(np.diff(row, prepend=-1))
        found.append(np.minimum.reduceat(apart, first))
    return np.concatenate(found)


def least_distance(one: Track, other: Track) -> float:
    """The distance [mm] between two chains; 0 if they meet."""
    a, b = _Pieces.of(one), _Pieces.of(other)
    least = min(
        float(np.min(distances(one.vertices, other))), float(np.min(distances(other.vertices, one)))
    )
    step = max(1, BLOCK // len(other))
    for k in range(0, len(one), step):
        rows = np.arange(k, min(k + step, len(one)))
        off = np.abs(a.middle[rows, None] - b.middle) - a.reach[rows, None] - b.reach
        row, column = np.nonzero(off < least)
        if len(row):
            least = min(least, _between(taken(a, rows[row]), taken(b, column)))
    return least


def _between(a: _Pieces, b: _Pieces) -> float:
    """The least distance [mm] of inner points of pairs on a common normal, or 0 where they cross.

    Infinite if there is neither.
    """
    return min(_of_arcs(a, b), _of_arc_and_line(a, b), _of_arc_and_line(b, a), _of_lines(a, b))


def _least(values: FloatArray, valid: BoolArray) -> float:
    return float(np.min(values[valid], initial=np.inf))


def _of_arcs(a: _Pieces, b: _Pieces) -> float:
    between = b.centre - a.centre
    apart = np.abs(between)
    bent = (a.sweep != 0.0) & (b.sweep != 0.0) & (apart > 0.0)
    along: ComplexArray = np.divide(np.where(bent, between, 1.0), np.where(bent, apart, 1.0))
    ra, rb = a.radius, b.radius
    least = np.inf
    for one in (1.0, -1.0):
        for other in (1.0, -1.0):
            gap = np.abs(apart + other * rb - one * ra)
            least = min(least, _least(gap, bent & a.faces(one * along) & b.faces(other * along)))
    lever = (apart**2 + ra**2 - rb**2) / (2.0 * np.where(bent, apart, 1.0))
    meet = bent & (np.abs(lever) <= ra)
    height = np.sqrt(np.maximum(ra**2 - lever**2, 0.0))
    for side in (1j, -1j):
        arm: ComplexArray = along * (lever + side * height)
        if np.any(meet & a.faces(arm) & b.faces(a.centre + arm - b.centre)):
            return 0.0
    return least


def _of_arc_and_line(arc: _Pieces, line: _Pieces) -> float:
    mixed = (arc.sweep != 0.0) & (line.sweep == 0.0) & (line.start != line.end)
    share = line.along(arc.centre)
    chord = line.end - line.start
    foot = line.start + share * chord - arc.centre
    inside = mixed & (share >= 0.0) & (share <= 1.0)
    gap = np.abs(np.abs(foot) - arc.radius)
    least = _least(gap, inside & arc.faces(foot))
    length = np.where(mixed, np.abs(chord), 1.0)
    half = np.sqrt(np.maximum(arc.radius**2 - np.abs(foot) ** 2, 0.0)) / length
    meet = mixed & (np.abs(foot) <= arc.radius)
    for side in (1.0, -1.0):
        place = share + side * half
        on = meet & (place >= 0.0) & (place <= 1.0)
        if np.any(on & arc.faces(line.start + place * chord - arc.centre)):
            return 0.0
    return least


def _of_lines(a: _Pieces, b: _Pieces) -> float:
    along, across = a.end - a.start, b.end - b.start
    sine = (np.conj(along) * across).imag
    straight = (a.sweep == 0.0) & (b.sweep == 0.0) & (sine != 0.0)
    between, safe = b.start - a.start, np.where(straight, sine, 1.0)
    first = (np.conj(between) * across).imag / safe
    second = (np.conj(between) * along).imag / safe
    on = straight & (first >= 0.0) & (first <= 1.0) & (second >= 0.0) & (second <= 1.0)
    return 0.0 if np.any(on) else np.inf
