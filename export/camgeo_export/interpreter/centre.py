"""The path of the cutter's centre where the control compensates for its radius.

As LinuxCNC runs it (src/emc/rs274ngc/interp_convert.cc), and other controls but for what they do
around outer corners: the straight move that enters ends beside its end, inner corners are cut where
the parallels meet, outer ones are rounded, and the move after the compensation leads to where it is
programmed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

from camgeo.numeric.arrays import phase
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.compensation import TANGENT, Compensator, kept
from camgeo_export.interpreter.offsets import Parallel, meeting
from camgeo_export.interpreter.rules import Findings

FAR: Final = 4.0
"""Parallels of neighbours that meet farther from their corner than this many radii do not."""

Radius = Callable[[CutterMove], float]
"""Offset of a compensated move [mm]; negative for the other side, NaN if it is not known."""


def centres(moves: Sequence[CutterMove], radius: Radius) -> tuple[CutterMove, ...]:
    """The same moves along the cutter's centre; where the offset is 0 they are unchanged."""
    found: list[CutterMove] = []
    for run, after in _runs(moves):
        size = radius(run[0]) if run else 0.0
        if size == 0.0:
            found += run
        elif run:
            found += _displaced(run, size)
        if after is not None:
            found.append(replace(after, start=found[-1].end) if run and size else after)
    return tuple(found)


def judge(moves: Sequence[CutterMove], radius: Radius, findings: Findings) -> None:
    """Find what controls refuse in compensated moves, and what would gouge, with these offsets."""
    for run, after in _runs(moves):
        if not run:
            continue
        compensator = Compensator(findings)
        compensator.enter()
        for move in run:
            compensator.take(move, move.compensation, radius(move))
        if after is not None:
            compensator.leave(after, radius(run[0]))


def _runs(
    moves: Iterable[CutterMove],
) -> Iterator[tuple[list[CutterMove], CutterMove | None]]:
    """Stretches of compensated moves, each with the move after it; single other moves likewise."""
    run: list[CutterMove] = []
    for move in moves:
        if move.compensation:
            run.append(move)
        else:
            yield run, move
            run = []
    if run:
        yield run, None


def _displaced(run: Sequence[CutterMove], radius: float) -> Iterator[CutterMove]:
    side, size = kept(run[0].compensation, radius)
    sign = 1.0 if side == "left" else -1.0
    flat = [move for move in run if move.start != move.end or move.kind == "arc"]
    parallels = iter([Parallel(move, sign, size) for move in flat])
    after = next(parallels, None)
    before: Parallel | None = None
    at = run[0].start
    for move in run:
        if move.start == move.end and move.kind != "arc":
            yield replace(move, start=at, end=at)  # along Z
            continue
        assert after is not None
        own, after = after, next(parallels, None)
        if before is not None and (turn := _turn(before, own)) < -TANGENT:
            point = own.beside(move.start)
            yield replace(
                move, kind="arc", start=at, end=point, z_end=move.z_start, centre=move.start,
                sweep=turn * sign,
            )  # fmt: skip
            at = point
        end = own.beside(move.end) if after is None else _joint(own, after)
        centre, sweep, mismatch = move.centre, 0.0, 0.0
        if move.kind == "arc":
            arms = at - centre, end - centre
            turned = phase(arms[1] / arms[0]) if arms[0] else 0.0
            sweep = turned + 2.0 * math.pi * round((move.sweep - turned) / (2.0 * math.pi))
            mismatch = max(move.mismatch, abs(abs(arms[1]) - abs(arms[0])))
        yield replace(move, start=at, end=end, sweep=sweep, mismatch=mismatch)
        at, before = end, own


def _turn(before: Parallel, after: Parallel) -> float:
    """Change of direction at a corner [rad], positive towards the cutter: an inner one."""
    corner = after.move.start
    return phase(after.heading(corner) / before.heading(corner)) * after.side


def _joint(before: Parallel, after: Parallel) -> complex:
    """Where the parallel of a move ends, before another one."""
    corner, turn = after.move.start, _turn(before, after)
    end = before.beside(corner)
    if turn < -TANGENT:
        return end
    if turn > TANGENT:
        point = meeting(before, after)
        if point is not None and abs(point - corner) <= FAR * before.radius:
            return point
    return end
