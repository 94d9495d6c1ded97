"""What a program does, read by a small interpreter of its own, and what its cutter meets."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.moves import ArcFeed, Course, Move, Rapid, Stop
from camgeo.milling.plan import Cutting
from camgeo.milling.track import Track
from camgeo.numeric.arrays import FloatArray
from tests.toolpath.plane.tracks import dense

EDGE = 1e-7
"""Distance [mm] within which a point lies on an edge."""


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
    """(n,) [rad] that a cutter meets at places evenly along a track, but for its `first` and `last`
    [mm]. What `Cutting` finds, which `test_engagement` compares with counts of points, knows
    nothing of how the strategies pace their ways.
    """
    way = track.halved().pieces
    level = np.zeros(len(way))
    course = Course(
        way.starts, way.ends, way.sweeps, way.centres, level, level, np.arange(len(way))
    )
    found = Cutting(course, radius, (stock,), top=1.0)
    ends = np.cumsum(way.lengths)
    angles = []
    for place in np.linspace(first, track.length - last, count):
        piece = min(int(np.searchsorted(ends, place)), len(way) - 1)
        angles.append(found.angle(piece, 1.0 - float((ends[piece] - place) / way.lengths[piece])))
    return np.array(angles)


def swept(track: Track, radius: float) -> shapely.Geometry:
    """What a cutter passes over, by dense points."""
    points = dense(track, 30)
    return shapely.LineString(np.column_stack((points.real, points.imag))).buffer(radius)
