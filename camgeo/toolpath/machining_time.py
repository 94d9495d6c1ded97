"""Machining time, estimated from the lengths of the blocks, feed and acceleration.

A controller must be able to stop at the end of the block that it runs, or of the next one, as it
looks no farther ahead. From rest, with the acceleration a, a block of length L allows sqrt(2 a L);
so blocks shorter than feed^2/(2 a) never reach the feed. On an arc of radius r the lateral
acceleration is v^2/r, bounded by the same a. Each cutting block is run at the least of the three
speeds, and the time is the sum of L/v: halving a block never saves time. LinuxCNC's documentation
states the rule as feed^2/A with A half the largest acceleration, which keeps the other half for
blending.

Left out are ramps between blocks of different speed, braking in corners, the jerk, the time a
controller takes to read a block, and tool changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import FloatArray, phase
from camgeo.numeric.checked import check_fields, positive
from camgeo.toolpath.moves import ArcFeed, Feed, Point, Rapid, Toolpath
from camgeo.toolpath.tool import FeedRate

SECONDS = 60.0
"""Of a minute, the unit of time of feeds."""


@dataclass(frozen=True, slots=True)
class Dynamics:
    """The dynamics of a machine.

    Attributes
    ----------
    acceleration : along the path [mm/s^2], positive.
    rapid_feed : of traverses [mm/min], positive.
    """

    acceleration: Annotated[float, partial(positive, unit="mm/s^2")]
    rapid_feed: FeedRate

    def __post_init__(self) -> None:
        check_fields(self, "dynamics.")


def block_times(
    lengths: FloatArray, radii: FloatArray, feed: float | FloatArray, acceleration: float
) -> FloatArray:
    """(n,) [s] time of each cutting block.

    Parameters
    ----------
    lengths : (n,) [mm], not negative.
    radii : (n,) [mm] of arcs; 0 for lines.
    feed : [mm/min], one or (n,).
    acceleration : [mm/s^2].
    """
    bend = np.where(radii > 0.0, acceleration * radii, np.inf)
    speeds = np.sqrt(np.minimum(2.0 * acceleration * lengths, bend))
    speeds = np.minimum(speeds, np.asarray(feed) / SECONDS)
    times: FloatArray = np.zeros(len(lengths))
    return np.divide(lengths, speeds, out=times, where=lengths > 0.0)


def contour_time(contour: Contour, feed: float, acceleration: float) -> float:
    """Time [s] of one round of `contour` at `feed` [mm/min], one block per piece."""
    return math.fsum(block_times(contour.lengths, contour.radii, feed, acceleration))


def traverse_time(length: float, dynamics: Dynamics) -> float:
    """Time [s] of a traverse of `length` [mm] from rest to rest, even if too short for the rapid
    feed.
    """
    speed, acceleration = dynamics.rapid_feed / SECONDS, dynamics.acceleration
    if speed * speed >= acceleration * length:
        return 2.0 * math.sqrt(length / acceleration)
    return length / speed + speed / acceleration


def toolpath_time(toolpath: Toolpath, dynamics: Dynamics) -> float:
    """Time [s] of a whole program, without the move to its first point, which is unknown."""
    at: Point | None = None
    traverses = 0.0
    lengths: list[float] = []
    radii: list[float] = []
    feeds: list[float] = []
    for operation in toolpath.operations:
        for move in operation.travel:
            if at is None:
                at = move.end
                continue
            if isinstance(move, Rapid):
                traverses += traverse_time(math.dist(at, move.end), dynamics)
            else:
                length, radius = _measures(at, move)
                lengths.append(length)
                radii.append(radius)
                feeds.append(move.feed)
            at = move.end
    cuts = block_times(np.array(lengths), np.array(radii), np.array(feeds), dynamics.acceleration)
    return math.fsum((traverses, *cuts.tolist()))


def _measures(start: Point, move: Feed | ArcFeed) -> tuple[float, float]:
    """Length and radius [mm] of a cut; the radius of a line is 0."""
    if isinstance(move, Feed):
        return math.dist(start, move.end), 0.0
    arm = complex(start[0], start[1]) - complex(*move.centre)
    turn = arc_sweep(arm, complex(move.end[0], move.end[1]) - complex(*move.centre), ccw=move.ccw)
    return math.hypot(abs(arm) * turn, move.end[2] - start[2]), abs(arm)


def arc_sweep(start: complex, end: complex, *, ccw: bool) -> float:
    """Signed angle [rad] from arm `start` to arm `end`, at most half a turn in that direction.

    An angle slightly below 0 is a rounded 0; one slightly beyond half a turn is not taken for a
    turn in the other direction.
    """
    turn = phase(end / start) * (1.0 if ccw else -1.0)
    if turn < -0.5 * math.pi:
        turn += 2.0 * math.pi
    turn = max(turn, 0.0)
    return turn if ccw else -turn
