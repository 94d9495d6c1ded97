"""Heights of the cuts of one operation: its depths, and ramps between them as they are printed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.toolpath.cut import ContourCut, Cut
from camgeo_export.gcode.moves import CutterMove

MOVED: Final = 2.0**0.5
"""Steps by which the length of a printed move may be off: half a step in x and y at both ends."""


def at_no_height(cut: Cut, moves: Sequence[CutterMove], step: float) -> CutterMove | None:
    """The first of the feed moves of an operation that is neither at one of its heights nor part of
    a ramp; None if there is none.

    Level moves are at a depth, and over tabs at their tops; straight ones end at a depth or at the
    upper face. All heights are printed in steps of `step` [mm].
    """
    if not moves:
        return None
    from_z, to_z = (
        np.array([getattr(move, end) for move in moves]) for end in ("z_start", "z_end")
    )
    in_plane = np.array([move.start != move.end for move in moves])
    tabs = cut.tabs if isinstance(cut, ContourCut) else None
    heights = [*cut.depths, *([] if tabs is None else [cut.bottom + tabs.height])]
    settled = near(to_z, heights, step)
    straight = (to_z < from_z) & near(to_z, [*cut.depths, cut.top], step)
    sound = np.where(in_plane, (from_z != to_z) | settled, straight)
    if not np.all(sound):
        begun = near(from_z, [*heights, cut.top], step)
        sound |= in_plane & _in_ramps(moves, begun, settled, step)
    sound &= (cut.bottom - step <= to_z) & (to_z <= cut.top + step)
    wrong = np.flatnonzero(~sound)
    return moves[int(wrong[0])] if len(wrong) else None


def near(z: FloatArray, heights: Iterable[float], slack: float) -> BoolArray:
    """(n,) whether each of `z` (n,) is one of `heights` within a `slack` [mm]."""
    known = np.sort(np.array([*heights, -np.inf, np.inf]))
    place = np.clip(np.searchsorted(known, z), 1, len(known) - 1)  # which NaN exceeds
    found: BoolArray = (z - known[place - 1] <= slack) | (known[place] - z <= slack)
    return found


def _in_ramps(
    moves: Sequence[CutterMove], begun: BoolArray, settled: BoolArray, step: float
) -> BoolArray:
    """(n,) whether each move is level although it belongs to a ramp.

    A ramp has one slope, from the last height at which it is `begun` to the first at which it is
    `settled`; pieces of it that follow each other are level if it falls by no more than a step
    along them.
    """
    found = np.zeros(len(moves), dtype=np.bool_)
    along = np.cumsum([0.0, *(move.course.length for move in moves)])
    joined = [
        one.end == other.start and one.z_end == other.z_start for one, other in pairwise(moves)
    ]
    gaps = [0, *(np.flatnonzero(~np.array(joined, dtype=np.bool_)) + 1).tolist(), len(moves)]
    for start, stop in pairwise(gaps):
        level = np.array([move.z_start == move.z_end for move in moves[start:stop]])
        edges = np.flatnonzero(np.diff(np.concatenate(([False], level, [False])))) + start
        begins = np.flatnonzero(begun[start:stop]) + start
        ends = np.flatnonzero(settled[start:stop]) + start
        for first, last in edges.reshape(-1, 2).tolist():
            before, after = np.searchsorted(begins, first, "right"), np.searchsorted(ends, last)
            low = int(begins[before - 1]) if before else start
            high = int(ends[after]) + 1 if after < len(ends) else stop
            drop = abs(moves[low].z_start - moves[high - 1].z_end) - step
            whole = float(along[high] - along[low]) + (high - low) * MOVED * step
            part = float(along[last] - along[first]) - (last - first) * MOVED * step
            found[first:last] = part * drop <= step * whole
    return found
