"""Machining time of programs and contours, from a model of the controller's planner.

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

A block is a line or an arc, or one of the chords into which a controller divides an arc. Left out
is what is not in the moves: tool changes, dwells, halts, and the traverse to the first point.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.machine import Dynamics, Machine
from camgeo.milling.moves import Move, Point, Rapid, Stop, Toolpath, plane_piece
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, grouped
from camgeo.numeric.checked import CheckedFields, Floats, Integers, Truths

SECONDS: Final = 60.0
"""Seconds of a minute, the unit of time of feeds."""

STRAIGHT: Final = 0.999999
"""Cosine of the turn, 0.081 degrees, up to which a corner counts as straight in Grbl's planner."""


@dataclass(frozen=True, slots=True, eq=False)
class Blocks(CheckedFields):
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

    lengths: Floats
    feeds: Floats
    radii: Floats
    starts: Floats
    ends: Floats
    rests: Truths
    moves: Integers

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
    # With v^2 as the unknown all is linear along the path: within a block it changes by at most 2 a
    # s. The speeds at the ends of blocks and at their peaks are such squares until the roots are
    # taken.
    gain = 2.0 * acceleration * blocks.lengths
    cumulative_gain = np.concatenate(([0.0], np.cumsum(gain)))
    highest = _junctions(blocks, dynamics, smoothing)
    highest[1:] = np.minimum(highest[1:], np.minimum(nominal[1:], nominal[:-1]) ** 2)
    highest[blocks.rests] = 0.0
    highest[0] = 0.0
    entry = _entries(highest, cumulative_gain, dynamics.look_ahead)
    leave = np.append(entry[1:], 0.0)
    # Accelerating from the entry and braking to the exit meet at the mean of both ends, half the
    # gain above it; a lower nominal speed cuts the peak off.
    peak = np.minimum(nominal**2, 0.5 * (entry + leave + gain))
    peak = np.maximum(peak, np.maximum(entry, leave))  # but for rounding, as the plan is feasible
    top, first, last = np.sqrt(peak), np.sqrt(entry), np.sqrt(leave)
    ramps = (2.0 * top - first - last) / acceleration
    cruise = np.maximum(blocks.lengths - (2.0 * peak - entry - leave) / (2.0 * acceleration), 0.0)
    return ramps + cruise / top, first


def _limits(blocks: Blocks, dynamics: Dynamics) -> tuple[FloatArray, FloatArray]:
    """(n,) acceleration [mm/s^2] and largest speed [mm/s] of each block by itself."""
    arcs = blocks.radii > 0.0
    # The limits hold for each axis: along a line the axis with the largest component reaches them
    # first. An arc takes all directions, so it has the limit of one axis.
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
    squares = np.zeros(len(blocks))
    incoming, outgoing = blocks.ends[:-1], blocks.starts[1:]
    cosine = np.clip(np.sum(incoming * outgoing, axis=1), -1.0, 1.0)
    # A circle of radius r that touches both sides of a corner, which turns by 2 h, passes it at the
    # distance r (1 / cos h - 1), so r = deviation cos h / (1 - cos h).
    half = np.sqrt(0.5 * (1.0 + cosine))  # cosine of half the turn
    across = outgoing - incoming
    size = np.linalg.norm(across, axis=1)
    share = np.max(np.abs(across), axis=1) / np.where(size > 0.0, size, 1.0)
    deviation = dynamics.junction_deviation if smoothing is None else smoothing
    straight = cosine > STRAIGHT
    rest = np.where(straight, 1.0, 1.0 - half)
    radius = deviation * half / rest
    if smoothing is not None:
        # It touches the sides at r tan h from the corner, at most half of the shorter neighbour.
        sine = np.sqrt(0.5 * (1.0 - cosine))
        room = 0.5 * np.minimum(blocks.lengths[:-1], blocks.lengths[1:])
        radius = np.minimum(radius, room * half / np.where(sine > 0.0, sine, 1.0))
    # In a straight corner nothing limits the speed; the ones only avoid divisions by 0.
    size, share = np.where(straight, 1.0, size), np.where(straight, 1.0, share)
    jump = (dynamics.velocity_jump / size) ** 2
    fast = np.maximum(dynamics.acceleration / share * radius, jump)
    squares[1:] = np.where(straight, np.inf, fast)
    return squares


def _entries(highest: FloatArray, cumulative_gain: FloatArray, ahead: int) -> FloatArray:
    """(n,) square of the speed with which each block is entered.

    Parameters
    ----------
    highest : (n,) square of the largest speed at the beginning of each block.
    cumulative_gain : (n + 1,) what the square of the speed can gain up to the start of each block,
        and up to the end of the last one [mm^2/s^2].
    ahead : number of blocks, the one entered among them, within which the machine can stop.
    """
    count = len(highest)
    ahead = min(ahead, count)
    # Seen from the start of the path: with G the cumulative gain, v_i^2 can brake to v_j^2 if
    # v_i^2 + G_i <= v_j^2 + G_j, for all j that are planned, and to 0 at the end of the last one.
    sums = np.concatenate((highest + cumulative_gain[:-1], np.full(ahead, np.inf)))
    lowest = np.lib.stride_tricks.sliding_window_view(sums, ahead)[:count].min(axis=1)
    end = cumulative_gain[np.minimum(np.arange(count) + ahead, count)]
    able = np.minimum(lowest, end) - cumulative_gain[:-1]  # speeds from which it can stop
    # And it can be reached by accelerating if v_i^2 - G_i <= v_j^2 - G_j for all earlier j.
    reached = np.minimum.accumulate(able - cumulative_gain[:-1]) + cumulative_gain[:-1]
    # The sums grow along the path, so their differences may exceed the bounds by some rounding.
    entries: FloatArray = np.clip(np.minimum(reached, able), 0.0, highest)
    return entries


@dataclass(frozen=True, slots=True)
class OperationTime:
    """The time of one operation.

    Attributes
    ----------
    name : of the operation.
    cutting, traverses : seconds at feed and at rapid feed.
    blocks : number of blocks that the controller plans.
    slowed : share of the cutting time that exceeds length over feed.
    """

    name: str
    cutting: float
    traverses: float
    blocks: int
    slowed: float

    @property
    def seconds(self) -> float:
        """Time of the whole operation [s]."""
        return self.cutting + self.traverses


def toolpath_times(
    toolpath: Toolpath, dynamics: Dynamics, *, chord: float = 0.0, smoothing: float | None = None
) -> tuple[OperationTime, ...]:
    """The time of each operation, without the move to the first point of the program.

    Parameters
    ----------
    chord : deviation [mm] of the chords into which the controller divides arcs; 0 if it runs arcs.
    smoothing : as of `block_times`.
    """
    operation_times = []
    position: Point | None = None
    for operation in toolpath.operations:
        blocks = controller_blocks(operation.moves, position, chord=chord)
        position = operation.travel[-1].end
        times, _ = block_times(blocks, dynamics, smoothing)
        rapid = np.isinf(blocks.feeds)
        cutting = math.fsum(times[~rapid])
        due = math.fsum(blocks.lengths[~rapid] / blocks.feeds[~rapid])
        slowed = max(0.0, 1.0 - due / cutting) if cutting else 0.0
        operation_times.append(
            OperationTime(operation.name, cutting, math.fsum(times[rapid]), len(blocks), slowed)
        )
    return tuple(operation_times)


def machine_times(
    machine: Machine, toolpath: Toolpath, tolerance: float
) -> tuple[OperationTime, ...] | None:
    """The times on a machine that may leave the path within `tolerance` [mm] as its profile says;
    None if its dynamics are not known.
    """
    if machine.dynamics is None:
        return None
    chord, smoothing = machine.arcs.interpolation, machine.smoothed(tolerance)
    return toolpath_times(toolpath, machine.dynamics, chord=chord, smoothing=smoothing)


def contour_time(
    contour: Contour,
    feed: float,
    dynamics: Dynamics,
    *,
    chord: float = 0.0,
    smoothing: float | None = None,
) -> float:
    """Time [s] of one round of `contour` at `feed` [mm/min] from rest to rest; as `toolpath_times`.

    An infinite feed gives the shortest round that the controller can run.
    """
    count = len(contour)
    blocks = _divide_arcs(
        _space(contour.vertices),
        _space(contour.ends),
        contour.centres,
        contour.sweeps,
        np.full(count, feed / SECONDS),
        np.arange(count) == 0,
        np.arange(count),
        chord,
    )
    return math.fsum(block_times(blocks, dynamics, smoothing)[0])


def controller_blocks(
    moves: Iterable[Move | Stop], position: Point | None, *, chord: float = 0.0
) -> Blocks:
    """The blocks of `moves`, run from rest to rest; those without length are left out.

    Parameters
    ----------
    position : where the cutter stands [mm]; None where that is not known, so that the first move is
        not run.
    chord : as in `toolpath_times`.
    """
    rows: list[tuple[float, ...]] = []
    rest = True
    for number, move in enumerate(moves):
        if isinstance(move, Stop):
            rest = True
            continue
        if position is not None and move.end != position:
            piece = plane_piece(position, move)
            arc = piece.centre.real, piece.centre.imag, piece.sweep
            feed = math.inf if isinstance(move, Rapid) else move.feed / SECONDS
            rows.append((*position, *move.end, *arc, feed, rest, number))
            rest = False
        position = move.end
    table = np.array(rows, dtype=np.float64).reshape(-1, 12)
    x, y, sweeps, feeds, rests, numbers = table[:, 6:].T
    return _divide_arcs(
        table[:, :3],
        table[:, 3:6],
        x + 1j * y,
        sweeps,
        feeds,
        rests == 1.0,
        numbers.astype(np.int64),
        chord,
    )


def _divide_arcs(
    starts: FloatArray,
    ends: FloatArray,
    centres: ComplexArray,
    sweeps: FloatArray,
    feeds: FloatArray,
    rests: BoolArray,
    moves: IntArray,
    chord: float,
) -> Blocks:
    """Blocks of lines and arcs from `starts` (n, 3) to `ends` (n, 3) [mm].

    If `chord` [mm] is above 0, arcs are divided into chords within it, as Grbl divides them
    (grbl/motion_control.c, mc_arc).
    """
    arms = starts[:, 0] + 1j * starts[:, 1] - centres
    radii = np.where(sweeps != 0.0, np.abs(arms), 0.0)
    if chord > 0.0:
        half = np.sqrt(chord * np.maximum(2.0 * radii - chord, chord))
        counts = np.maximum(np.floor(0.5 * np.abs(sweeps) * radii / half).astype(int), 1)
        which, part = grouped(counts)
        whole, arms, turns = counts[which], arms[which], sweeps[which]
        first = _arc_points(starts[which], ends[which], centres[which], arms, turns, part / whole)
        last = np.concatenate((first[1:], ends[-1:]))
        final = part == whole - 1
        last[final] = ends[which[final]]
        lengths = np.linalg.norm(last - first, axis=1)
        along = (last - first) / lengths[:, None]
        rests = rests[which] & (part == 0)
        return Blocks(
            lengths, feeds[which], np.zeros(len(which)), along, along, rests, moves[which]
        )
    rise = ends[:, 2] - starts[:, 2]
    arcs = sweeps != 0.0
    flat = np.where(arcs, radii * np.abs(sweeps), np.abs(_plane(ends) - _plane(starts)))
    lengths = np.hypot(flat, rise)
    flat, rise = flat / lengths, rise / lengths
    straight = _plane(ends) - _plane(starts)
    size = np.abs(straight)
    straight = straight / np.where(size > 0.0, size, 1.0)
    # The tangent at the start of an arc is square to its arm; it turns by the sweep up to the end.
    begin = 1j * np.sign(sweeps) * arms / np.where(arcs, radii, 1.0)
    first_way = np.where(arcs, begin, straight)
    last_way = np.where(arcs, begin * np.exp(1j * sweeps), straight)
    first, last = (
        np.column_stack((flat * way.real, flat * way.imag, rise)) for way in (first_way, last_way)
    )
    return Blocks(lengths, feeds, radii, first, last, rests, moves)


def _arc_points(
    starts: FloatArray,
    ends: FloatArray,
    centres: ComplexArray,
    arms: ComplexArray,
    sweeps: FloatArray,
    shares: FloatArray,
) -> FloatArray:
    """(n, 3) points [mm] at the `shares` (n,) of the lengths of lines and arcs."""
    points = starts + (ends - starts) * shares[:, None]
    arcs = sweeps != 0.0
    turned = centres + arms * np.exp(1j * sweeps * shares)
    points[:, 0] = np.where(arcs, turned.real, points[:, 0])
    points[:, 1] = np.where(arcs, turned.imag, points[:, 1])
    return points


def _space(points: ComplexArray) -> FloatArray:
    return np.column_stack((points.real, points.imag, np.zeros(len(points))))


def _plane(points: FloatArray) -> ComplexArray:
    plane: ComplexArray = points[:, 0] + 1j * points[:, 1]
    return plane
