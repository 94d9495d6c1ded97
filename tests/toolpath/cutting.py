"""What a cutter meets along its path, by exact crossings: independent of the strategies' pacing.

The part of the cutter's circle that is in material is bounded by crossings of that circle with the
outline of the blank and with the edges of what earlier places have swept, which are lines and arcs.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from camgeo.geometry.contour.contour import Contour, distances, winding_number
from camgeo.milling.moves import ArcFeed, Move, Rapid, Stop
from camgeo.milling.track import Track
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.toolpath.plane.tracks import dense

BEHIND = 1e-4
"""The last stretch [mm] of the path that does not count as swept: the cutter's own circle lies on
the edge of what it sweeps."""

EDGE = 1e-7
"""Distance [mm] within which a point lies on an edge."""


def engagement(track: Track, stock: Contour, radius: float, at: float) -> float:
    """[rad] of the cutter's circle in material `at` a distance [mm] along `track`."""
    (centre,), _ = track.at(np.array([at]))
    before = track.between(0.0, max(at - BEHIND, 2.0 * EDGE))
    near = _near(before, complex(centre), 2.0 * radius)
    edges = [*_edges_of(stock, 0.0)]
    if near is not None:
        edges += _edges_of(near, radius)
    found = [angle for edge in edges for angle in _crossings(complex(centre), radius, *edge)]
    angles = np.sort(np.mod(np.array(found), 2.0 * np.pi))
    if not len(angles):
        angles = np.zeros(1)
    spans = np.diff(np.append(angles, angles[0] + 2.0 * np.pi))
    rim = centre + radius * np.exp(1j * (angles + 0.5 * spans))
    inside = np.array([winding_number(stock, complex(each)) != 0 for each in rim])
    if near is not None:
        inside &= distances(rim, near) > radius + EDGE**1.2
    return float(np.sum(spans[inside]))


def _near(track: Track, place: complex, reach: float) -> Track | None:
    """The pieces within `reach` of `place`, each with its neighbours' ends."""
    middles = 0.5 * (track.starts + track.ends)
    off = np.abs(middles - place) - np.maximum(track.lengths, EDGE)
    kept = np.flatnonzero(off <= reach)
    if not len(kept):
        return None
    # As a chain of separate pieces: what lies between them is dropped by zero sweeps of no length.
    vertices, sweeps, centres = [], [], []
    for k in kept:
        vertices += [track.starts[k], track.ends[k]]
        sweeps.append(track.sweeps[k])
        centres.append(track.centres[k])
    return _Loose(np.array(vertices), np.array(sweeps), np.array(centres))


class _Loose(Track):
    """Pieces that do not join; `vertices` has both ends of each."""

    __slots__ = ()

    @property
    def starts(self) -> ComplexArray:
        return self.vertices[::2]

    @property
    def ends(self) -> ComplexArray:
        return self.vertices[1::2]


def _edges_of(path: Track | Contour, by: float) -> Iterator[tuple[complex, float, complex]]:
    """(centre, radius, 0) of circles and (point, 0, direction) of lines on which the edges of what
    a disc of radius `by` sweeps along `path` lie."""
    starts = path.starts if isinstance(path, Track) else path.vertices
    for start, end, sweep, centre in zip(starts, path.ends, path.sweeps, path.centres, strict=True):
        if sweep:
            radius = abs(start - centre)
            for each in {radius + by, abs(radius - by)}:
                yield complex(centre), float(each), 0j
        elif start != end:
            along = complex(end - start) / abs(end - start)
            for side in {by, -by}:
                yield complex(start + 1j * side * along), 0.0, along
        if by:
            yield complex(start), by, 0j
            yield complex(end), by, 0j


def _crossings(
    place: complex, radius: float, point: complex, other: float, along: complex
) -> tuple[float, ...]:
    """Directions [rad] from `place` in which the circle about it meets a circle or a line."""
    between = complex(point - place)
    if along:
        off = (along.conjugate() * between).imag
        if abs(off) >= radius:
            return ()
        foot = between - along * (along.conjugate() * between).real
        half = along * np.sqrt(radius**2 - off**2)
        return float(np.angle(foot + half)), float(np.angle(foot - half))
    apart = abs(between)
    if apart < EDGE or not abs(radius - other) < apart < radius + other:
        return ()
    lever = (apart**2 + radius**2 - other**2) / (2.0 * apart)
    turn = float(np.arccos(np.clip(lever / radius, -1.0, 1.0)))
    ahead = float(np.angle(between))
    return ahead + turn, ahead - turn


@dataclass(frozen=True)
class Step:
    """A feed move: from `start` to `end` in the plane [mm], heights of the tip before and after it
    [mm], centre and sweep [rad] of its arc, 0 of a line, and its feed [mm/min].
    """

    start: complex
    end: complex
    high: float
    low: float
    centre: complex
    sweep: float
    feed: float

    @property
    def radius(self) -> float:
        """Of its arc [mm]."""
        return abs(self.start - self.centre)

    @property
    def way(self) -> float:
        """Length in the plane [mm]."""
        return self.radius * abs(self.sweep) if self.sweep else abs(self.end - self.start)


def steps_of(moves: Iterable[Move | Stop]) -> list[Step]:
    """The feed moves of a program, by a small interpreter of its own."""
    found: list[Step] = []
    x = y = z = math.nan
    for move in moves:
        if isinstance(move, Stop):
            continue
        start, end, high = complex(x, y), complex(*move.end[:2]), z
        x, y, z = move.end
        if isinstance(move, Rapid):
            continue
        centre, sweep = 0j, 0.0
        if isinstance(move, ArcFeed):
            centre, sense = complex(*move.centre), 1.0 if move.ccw else -1.0
            turned = sense * float(np.angle((end - centre) / (start - centre)))
            sweep = sense * (turned if turned > -EDGE else turned + 2.0 * math.pi)
        found.append(Step(start, end, high, z, centre, sweep, move.feed))
    return found


def levels(moves: list[Move], below: float) -> dict[float, Track]:
    """The cuts at each even height under `below` [mm], each in one chain, by height."""
    found: dict[float, list[Step]] = {}
    for step in steps_of(moves):
        if step.high == step.low < below:
            found.setdefault(step.low, []).append(step)
    return {z: _chain(steps) for z, steps in found.items()}


def _chain(steps: list[Step]) -> Track:
    assert all(abs(a.end - b.start) < 1e-9 for a, b in pairwise(steps))
    vertices = [*(step.start for step in steps), steps[-1].end]
    sweeps, centres = ([getattr(step, key) for step in steps] for key in ("sweep", "centre"))
    return Track(np.array(vertices), np.array(sweeps), np.array(centres))


def engagements(track: Track, stock: Contour, radius: float, count: int, first: float = 0.05,
                last: float = 0.05) -> FloatArray:  # fmt: skip
    """(n,) `engagement` at places evenly along a track, but for its `first` and `last` [mm]."""
    places = np.linspace(first, track.length - last, count)
    return np.array([engagement(track, stock, radius, each) for each in places])


def swept(track: Track, radius: float) -> shapely.Geometry:
    """What a cutter passes over, by dense points."""
    points = dense(track, 30)
    return shapely.LineString(np.column_stack((points.real, points.imag))).buffer(radius)
