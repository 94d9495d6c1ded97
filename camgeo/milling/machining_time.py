"""Machining time of programs and contours, from a model of the controller's planner.

`camgeo.milling.look_ahead` has the model. Here moves become the blocks that it plans: one for each
line and arc, or the chords into which a controller divides an arc. Left out are what is not in the
moves: tool changes, dwells, halts, and the traverse to the first point.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.look_ahead import SECONDS, Blocks, Dynamics, block_times
from camgeo.milling.machine import Machine
from camgeo.milling.moves import ArcFeed, Move, Point, Rapid, Stop, Toolpath
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, grouped, phase


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
        """Of the whole operation."""
        return self.cutting + self.traverses


def toolpath_times(
    toolpath: Toolpath, dynamics: Dynamics, *, chord: float = 0.0, smoothing: float | None = None
) -> tuple[OperationTime, ...]:
    """The time of each operation, without the move to the first point of the program.

    Parameters
    ----------
    chord : deviation [mm] of the chords into which the controller divides arcs; 0 if it runs arcs.
    smoothing : as in `camgeo.milling.look_ahead.block_times`.
    """
    found = []
    at: Point | None = None
    for operation in toolpath.operations:
        blocks = blocks_of(operation.moves, at, chord=chord)
        at = operation.travel[-1].end
        times, _ = block_times(blocks, dynamics, smoothing)
        rapid = np.isinf(blocks.feeds)
        cutting = math.fsum(times[~rapid])
        due = math.fsum(blocks.lengths[~rapid] / blocks.feeds[~rapid])
        slowed = max(0.0, 1.0 - due / cutting) if cutting else 0.0
        found.append(
            OperationTime(operation.name, cutting, math.fsum(times[rapid]), len(blocks), slowed)
        )
    return tuple(found)


def times_on(
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
    blocks = _divided(
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


def blocks_of(moves: Iterable[Move | Stop], at: Point | None, *, chord: float = 0.0) -> Blocks:
    """The blocks of `moves`, run from rest to rest; those without length are left out.

    Parameters
    ----------
    at : where the cutter stands; None where that is not known, so that the first move is not run.
    chord : as in `toolpath_times`.
    """
    starts: list[Point] = []
    ends: list[Point] = []
    centres: list[complex] = []
    sweeps: list[float] = []
    feeds: list[float] = []
    rests: list[bool] = []
    numbers: list[int] = []
    rest = True
    for number, move in enumerate(moves):
        if isinstance(move, Stop):
            rest = True
            continue
        if at is not None and move.end != at:
            centre, sweep = 0j, 0.0
            if isinstance(move, ArcFeed):
                centre = complex(*move.centre)
                arms = complex(at[0], at[1]) - centre, complex(move.end[0], move.end[1]) - centre
                sweep = arc_sweep(*arms, ccw=move.ccw)
            starts.append(at)
            ends.append(move.end)
            centres.append(centre)
            sweeps.append(sweep)
            feeds.append(math.inf if isinstance(move, Rapid) else move.feed / SECONDS)
            rests.append(rest)
            numbers.append(number)
            rest = False
        at = move.end
    return _divided(
        np.array(starts, dtype=float).reshape(-1, 3),
        np.array(ends, dtype=float).reshape(-1, 3),
        np.array(centres, dtype=complex),
        np.array(sweeps, dtype=float),
        np.array(feeds, dtype=float),
        np.array(rests, dtype=bool),
        np.array(numbers, dtype=int),
        chord,
    )


def _divided(
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

    Arcs within `chord` as Grbl divides them (grbl/motion_control.c, mc_arc).
    """
    arms = starts[:, 0] + 1j * starts[:, 1] - centres
    radii = np.where(sweeps != 0.0, np.abs(arms), 0.0)
    if chord > 0.0:
        half = np.sqrt(chord * np.maximum(2.0 * radii - chord, chord))
        counts = np.maximum(np.floor(0.5 * np.abs(sweeps) * radii / half).astype(int), 1)
        which, part = grouped(counts)
        whole, arms, turns = counts[which], arms[which], sweeps[which]
        first = _turned(starts[which], ends[which], centres[which], arms, turns, part / whole)
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
    begin = 1j * np.sign(sweeps) * arms / np.where(arcs, radii, 1.0)
    first_way = np.where(arcs, begin, straight)
    last_way = np.where(arcs, begin * np.exp(1j * sweeps), straight)
    first, last = (
        np.column_stack((flat * way.real, flat * way.imag, rise)) for way in (first_way, last_way)
    )
    return Blocks(lengths, feeds, radii, first, last, rests, moves)


def _turned(
    starts: FloatArray,
    ends: FloatArray,
    centres: ComplexArray,
    arms: ComplexArray,
    sweeps: FloatArray,
    shares: FloatArray,
) -> FloatArray:
    """(n, 3) points at `shares` of lines and arcs."""
    points = starts + (ends - starts) * shares[:, None]
    arcs = sweeps != 0.0
    turned = centres + arms * np.exp(1j * sweeps * shares)
    points[:, 0] = np.where(arcs, turned.real, points[:, 0])
    points[:, 1] = np.where(arcs, turned.imag, points[:, 1])
    return points


def _space(points: ComplexArray) -> FloatArray:
    return np.column_stack((points.real, points.imag, np.zeros(len(points))))


def _plane(points: FloatArray) -> ComplexArray:
    found: ComplexArray = points[:, 0] + 1j * points[:, 1]
    return found


def arc_sweeps(starts: ComplexArray, ends: ComplexArray, turns: FloatArray) -> FloatArray:
    """(n,) as `arc_sweep`, of arms (n,) and their directions (n,): 1 counter-clockwise, else -1."""
    found = np.angle(ends / starts) * turns
    found = np.where(found < -0.5 * np.pi, found + 2.0 * np.pi, found)
    return turns * np.maximum(found, 0.0)


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
