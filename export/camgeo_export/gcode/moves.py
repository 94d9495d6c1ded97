"""Moves of a milling program that was read, and the closed paths that they form."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import Arc
from camgeo.numeric.arrays import IntArray
from camgeo.reading import PATHS, PROGRAM, beyond
from camgeo.units import counted

if TYPE_CHECKING:
    from shapely import STRtree


Kind = Literal["rapid", "line", "arc"]

LEAST_LENGTH = 30.0
"""Least length of a run that is closed with a gap, as a multiple of the gap."""

NEAR: Final = 2_000_000
"""Pairs of moves, the end of one near the start of the other, that may close a path."""


@dataclass(frozen=True, slots=True, eq=False)
class CutterMove:
    """One move; lengths in mm, feed in mm/min.

    Attributes
    ----------
    kind : "rapid", "line" or "arc".
    start, end : (x + iy); nan + nan i until the program has set a position.
    z_start, z_end : heights; infinite at the machine's reference.
    centre : of an arc.
    sweep : angle turned along an arc [rad], positive counter-clockwise.
    mismatch : difference of an arc's radii at its ends.
    feed : 0 for a traverse.
    speed : of the spindle [rev/min], negative counter-clockwise; 0 while it stands still.
    operation : the last one named by a comment.
    tool : number of the current one; 0 before the first change.
    offset : number of the tool whose length is compensated; 0 before the first.
    line : in the file, counted from 1.
    compensation : side of the path on which the control keeps the cutter, "left" or "right", or
        empty: then the path is that of its centre.
    radius_offset : number of the offset with which it does so; 0 without.
    oversize : what the program adds to the radius of that offset [mm].
    coolant : "flood", "mist", "through" or "off".
    work_offset : word of the work offset, e.g. "G54"; empty before one is stated.
    """

    kind: Kind
    start: complex
    end: complex
    z_start: float
    z_end: float
    centre: complex
    sweep: float
    mismatch: float
    feed: float
    speed: float
    operation: str
    tool: int
    offset: int
    line: int
    compensation: str = ""
    radius_offset: int = 0
    oversize: float = 0.0
    coolant: str = "off"
    work_offset: str = ""

    @property
    def course(self) -> Arc:
        """Its line or arc in the plane."""
        return Arc(self.start, self.end, self.sweep, self.centre)


@dataclass(frozen=True, slots=True, eq=False)
class Event:
    """What a program does between moves.

    Attributes
    ----------
    kind : "tool change", "spindle off", "stop", "dwell" or "end".
    word : that does it.
    at, z : position [mm]; NaN where unknown, infinite at the reference.
    tool : number of the one in the spindle, after a change of it.
    seconds : of a dwell.
    line : in the file, counted from 1.
    """

    kind: str
    word: str
    at: complex
    z: float
    tool: int
    seconds: float
    line: int


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A closed run of cuts.

    Attributes
    ----------
    operation : its name.
    tool : number of the tool that cuts it.
    z : least height [mm].
    level : whether all of it runs at that height.
    contour : path of the tool centre in the direction of cutting; arcs meet their end points.
    mismatch : largest difference of radii [mm]: the controller's path lies within it of `contour`.
    """

    operation: str
    tool: int
    z: float
    level: bool
    contour: Contour
    mismatch: float


def nearly_closed(run: list[CutterMove], gap: float) -> list[Loop]:
    """The part of an open run that comes back to within `gap` [mm] of its beginning, if any."""
    if not gap or not run:
        return []
    import shapely

    starts = np.array([move.start for move in run])
    ends = np.array([move.end for move in run])
    along = np.cumsum([0.0, *(move.course.length for move in run)])
    tree = shapely.STRtree(np.asarray(shapely.points(starts.real, starts.imag)))
    points = np.asarray(shapely.points(ends.real, ends.imag))
    last, first = _near(tree, points, gap)
    long = (last >= first) & (along[last + 1] - along[first] >= LEAST_LENGTH * gap)
    if not np.any(long):
        return []
    first, last = first[long], last[long]
    best = int(np.argmin(np.abs(starts[first] - ends[last])))
    apart = abs(starts[first[best]] - ends[last[best]])
    return [loop_of(run[first[best] : last[best] + 1], float(apart))]


def _near(tree: STRtree, points: np.ndarray[Any, Any], gap: float) -> tuple[IntArray, IntArray]:
    """Numbers of `points` and of those in the `tree` that lie within `gap` [mm] of them.

    Raises FileError if there are too many such pairs: then the moves of the program are far shorter
    than the gap.
    """
    found: list[IntArray] = []
    left, some = NEAR, max(NEAR // len(points), 1)
    for first in range(0, len(points), some):
        pairs = tree.query(points[first : first + some], predicate="dwithin", distance=gap)
        left -= pairs.shape[1]
        if left < 0:
            raise FileError(
                f"more than {NEAR:,} pairs of moves lie within the tolerance {gap:g} mm of each"
                " other: closed paths cannot be distinguished"
            )
        found.append(pairs + np.array([[first], [0]]))
    last, earlier = np.concatenate(found, axis=1)
    return last, earlier


def loop_of(run: list[CutterMove], gap: float) -> Loop:
    """The closed path of a run of moves, with a `gap` [mm] at its end."""
    vertices = np.array([move.start for move in run])
    sweeps = np.array([move.sweep for move in run])
    mismatch = max(move.mismatch for move in run) + gap
    heights = {run[0].z_start, *(move.z_end for move in run)}
    contour = Contour.through(vertices, sweeps)
    first = run[0]
    return Loop(first.operation, first.tool, min(heights), len(heights) == 1, contour, mismatch)


# -- loops ----------------------------------------------------------------------------------------
# The closed paths that the moves of a program run in the plane, level or not.


def closed_paths(moves: Iterable[CutterMove], gap: float = 0.0) -> list[Loop]:
    """Closed runs of cuts in the plane; leads into and out of them are omitted.

    A run that ends up to `gap` [mm] from where it began is closed, too; its mismatch is larger by
    that. The cutter may come down along a run, or be lifted over tabs; where it moves along Z alone
    or traverses, the run ends.
    """
    found: list[Loop] = []
    run: list[CutterMove] = []
    # A point already visited closes a loop; the search then starts again, so that a path which
    # overlaps its beginning is found once, and no loop contains another.
    reached: dict[complex, int] = {}
    for move in moves:
        cuts = move.kind != "rapid" and not (move.start == move.end and move.sweep == 0.0)
        cuts = cuts and not (cmath.isnan(move.start) or math.isnan(move.z_start))
        if not cuts or (run and run[-1].operation != move.operation):
            found += nearly_closed(run, gap)
            run, reached = [], {}
        if not cuts:
            continue
        reached[move.start] = len(run)
        run.append(move)
        if len(found) > PATHS:
            raise beyond("the program", counted(len(found), "closed path"), PATHS, PROGRAM)
        if move.end in reached:
            found.append(loop_of(run[reached[move.end] :], 0.0))
            run, reached = [], {}
    return found + nearly_closed(run, gap)
