"""How fast a controller runs through blocks: corners, look-ahead, acceleration, time of each block.

A controller has a number of blocks planned beyond the one that it runs, and must be able to stop at
the end of the last of them. With the square of the speed as the unknown that is linear along the
path, so the plan of all blocks is one backward and one forward pass: first the largest entry speed
from which the machine can still stop, then the largest one that it can reach.

That is what Grbl's planner computes (gnea/grbl at bfb67f0, grbl/planner.c);
tests/toolpath/test_grbl_planner.py compares each block with that planner, compiled. LinuxCNC's
planner, too, plans backwards over a number of blocks, runs an arc within P through a corner of
`G64 P`, and passes a corner without one only if the velocity jumps by no more than a share of the
acceleration times its period (src/emc/tp/tp.c, tpRunOptimization, tpSetupTangent); with its planner
this has not been compared. Left out are the jerk, the rounding of lengths to motor steps,
overrides, and LinuxCNC's reserve of acceleration while it blends.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

import numpy as np

from camgeo.milling.tool import FeedRate
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, frozen
from camgeo.numeric.checked import check_fields, number, positive, whole

SECONDS: Final = 60.0
"""Of a minute, the unit of time of feeds."""

STRAIGHT: Final = 0.999999
"""Cosine of the turn, 0.081 degrees, up to which a corner counts as straight in Grbl's planner."""

MOST_BLOCKS: Final = 10_000
"""No controller plans as many ahead."""


@dataclass(frozen=True, slots=True)
class Dynamics:
    """How a machine moves, and how far its controller looks ahead.

    Attributes
    ----------
    acceleration : of each axis [mm/s^2]; a move along a diagonal has more. On an arc it is also the
        largest centripetal acceleration.
    rapid_feed : of each axis in traverses [mm/min]; no cut is faster.
    look_ahead : number of blocks that are planned beyond the one that is run; 1 for a controller of
        which nothing is known.
    junction_deviation : [mm] by which the speed in corners is limited where the path is not
        smoothed: that of an arc which passes the corner at this distance. 0 for a stop there.
    velocity_jump : [mm/s] by which the velocity may change at once in a corner.
    block_time : shortest time of a block [s], which a controller needs to read or to run it.

    Raises
    ------
    GeometryError
        With the key in `dynamics`, if a value is invalid.
    """

    acceleration: Annotated[float, partial(positive, unit="mm/s^2")]
    rapid_feed: FeedRate
    look_ahead: Annotated[int, partial(whole, least=1, most=MOST_BLOCKS)] = 1
    junction_deviation: Annotated[float, partial(number, least=0.0, unit="mm")] = 0.0
    velocity_jump: Annotated[float, partial(number, least=0.0, unit="mm/s")] = 0.0
    block_time: Annotated[float, partial(number, least=0.0, unit="s")] = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "dynamics.")


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Lines and arcs in the order in which they are run.

    Attributes
    ----------
    lengths : (n,) [mm], above 0.
    feeds : (n,) programmed [mm/s]; infinite for traverses.
    radii : (n,) [mm] of arcs; 0 for lines.
    starts, ends : (n, 3) unit vectors along the path where each begins and ends.
    rests : (n,) whether the machine stands still before it.
    moves : (n,) index of the move that it is part of.
    """

    lengths: FloatArray
    feeds: FloatArray
    radii: FloatArray
    starts: FloatArray
    ends: FloatArray
    rests: BoolArray
    moves: IntArray

    def __post_init__(self) -> None:
        for name in ("lengths", "feeds", "radii", "starts", "ends"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.float64))
        object.__setattr__(self, "rests", frozen(self.rests, np.bool_))
        object.__setattr__(self, "moves", frozen(self.moves, np.int64))

    def __len__(self) -> int:
        return len(self.lengths)


def block_times(
    blocks: Blocks, dynamics: Dynamics, smoothing: float | None = None
) -> tuple[FloatArray, FloatArray]:
    """(n,) [s] time of each block, from rest to rest, and (n,) [mm/s] its speed at the beginning.

    Parameters
    ----------
    smoothing : deviation [mm] of arcs that the controller runs through corners, as of `G64 P`; None
        where it runs the exact path.
    """
    count = len(blocks)
    if not count:
        return np.zeros(0), np.zeros(0)
    acceleration, nominal = _limits(blocks, dynamics)
    gain = 2.0 * acceleration * blocks.lengths
    before = np.concatenate(([0.0], np.cumsum(gain)))
    highest = _junctions(blocks, dynamics, smoothing)
    highest[1:] = np.minimum(highest[1:], np.minimum(nominal[1:], nominal[:-1]) ** 2)
    highest[blocks.rests] = 0.0
    highest[0] = 0.0
    entry = _entries(highest, before, dynamics.look_ahead)
    leave = np.append(entry[1:], 0.0)
    peak = np.minimum(nominal**2, 0.5 * (entry + leave + gain))
    peak = np.maximum(peak, np.maximum(entry, leave))  # but for rounding, as the plan is feasible
    top, first, last = np.sqrt(peak), np.sqrt(entry), np.sqrt(leave)
    ramps = (2.0 * top - first - last) / acceleration
    even = np.maximum(blocks.lengths - (2.0 * peak - entry - leave) / (2.0 * acceleration), 0.0)
    return ramps + even / top, first


def _limits(blocks: Blocks, dynamics: Dynamics) -> tuple[FloatArray, FloatArray]:
    """(n,) acceleration [mm/s^2] and largest speed [mm/s] of each block by itself."""
    arcs = blocks.radii > 0.0
    share = np.where(arcs, 1.0, np.max(np.abs(blocks.starts), axis=1))
    acceleration = dynamics.acceleration / share
    nominal = np.minimum(blocks.feeds, dynamics.rapid_feed / SECONDS / share)
    bend = np.sqrt(dynamics.acceleration * blocks.radii)
    nominal = np.where(arcs, np.minimum(nominal, bend), nominal)
    if dynamics.block_time > 0.0:
        nominal = np.minimum(nominal, blocks.lengths / dynamics.block_time)
    return acceleration, nominal


def _junctions(blocks: Blocks, dynamics: Dynamics, smoothing: float | None) -> FloatArray:
    """(n,) square of the largest speed in the corner before each block; 0 before the first.

    The speed of a circle that touches both neighbours and passes the corner at the deviation. Where
    it is really run, it reaches no farther than the middle of either neighbour.
    """
    found = np.zeros(len(blocks))
    before, after = blocks.ends[:-1], blocks.starts[1:]
    cosine = np.clip(np.sum(before * after, axis=1), -1.0, 1.0)
    half = np.sqrt(0.5 * (1.0 + cosine))  # cosine of half the turn
    across = after - before
    size = np.linalg.norm(across, axis=1)
    share = np.max(np.abs(across), axis=1) / np.where(size > 0.0, size, 1.0)
    deviation = dynamics.junction_deviation if smoothing is None else smoothing
    straight = cosine > STRAIGHT
    rest = np.where(straight, 1.0, 1.0 - half)
    radius = deviation * half / rest
    if smoothing is not None:
        sine = np.sqrt(0.5 * (1.0 - cosine))
        room = 0.5 * np.minimum(blocks.lengths[:-1], blocks.lengths[1:])
        radius = np.minimum(radius, room * half / np.where(sine > 0.0, sine, 1.0))
    size, share = np.where(straight, 1.0, size), np.where(straight, 1.0, share)
    jump = (dynamics.velocity_jump / size) ** 2
    fast = np.maximum(dynamics.acceleration / share * radius, jump)
    found[1:] = np.where(straight, np.inf, fast)
    return found


def _entries(highest: FloatArray, before: FloatArray, ahead: int) -> FloatArray:
    """(n,) square of the speed with which each block is entered.

    Parameters
    ----------
    highest : (n,) square of the largest speed at the beginning of each block.
    before : (n + 1,) what the square of the speed can gain up to there.
    ahead : number of blocks, the one entered among them, within which the machine can stop.
    """
    count = len(highest)
    ahead = min(ahead, count)
    sums = np.concatenate((highest + before[:-1], np.full(ahead, np.inf)))
    lowest = np.lib.stride_tricks.sliding_window_view(sums, ahead)[:count].min(axis=1)
    end = before[np.minimum(np.arange(count) + ahead, count)]
    able = np.minimum(lowest, end) - before[:-1]  # speeds from which it can stop
    reached = np.minimum.accumulate(able - before[:-1]) + before[:-1]
    # Differences of long sums may miss what they bound by some rounding.
    entries: FloatArray = np.clip(np.minimum(reached, able), 0.0, highest)
    return entries
