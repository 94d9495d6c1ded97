"""The milling program: the moves of each cut, from its strategy, within a machine's limits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice

from camgeo.contour.contour import Effort
from camgeo.contour.spline import Arc
from camgeo.errors import GeometryError
from camgeo.reading import PROGRAM_LINES
from camgeo.toolpath.compensation import limits_of
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.machine_tables import ArcLimits
from camgeo.toolpath.machining_time import arc_sweep
from camgeo.toolpath.moves import ArcFeed, Heights, Move, Operation, Point, Stop, Toolpath, too_long
from camgeo.toolpath.strategies import STRATEGIES
from camgeo.toolpath.tool import ToolError


def plan_toolpath(
    cuts: Iterable[Cut],
    heights: Heights,
    limits: ArcLimits,
    tolerance: float,
    effort: Effort = "fewest",
) -> Toolpath:
    """The whole program; its arcs lie within `tolerance` [mm] of the exact cutter paths.

    Arcs are at most as large as `limits` of the machine allow.

    Raises
    ------
    GeometryError
        `ToolError`, if a cutter is too large for its cut; with key "toolpath", if there is no
        strategy for it.
    FileError
        If there are more moves than lines are allowed in a program that is read.
    """
    operations: list[Operation] = []
    left = PROGRAM_LINES
    for cut in cuts:
        if cut.strategy not in STRATEGIES:
            known = ", ".join(STRATEGIES)
            message = f"{cut.name} has no such strategy; there are {known}"
            raise GeometryError(message, "toolpath", cut.strategy)
        moves = _moves_of(cut, heights, tolerance, effort)
        first, *others = islice(divided(moves, limits.largest_turn), left + 1)
        # After a halt the cutter comes back above its first point, wherever it was taken.
        stop = (Stop(cut.stop), first) if cut.stop else ()
        operation = Operation(cut, (first, *stop, *others))
        left -= len(operation.moves)
        if left < 0:
            raise too_long()
        operations.append(operation)
    limits_of(operations)  # raises where compensation has no room
    return Toolpath(heights, tuple(operations))


def _moves_of(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:
    """Those of its strategy; what is wrong with the tool there is said of this cut's."""
    try:
        return STRATEGIES[cut.strategy](cut, heights, tolerance, effort)
    except ToolError:
        raise
    except GeometryError as error:
        if error.key == "tool":
            raise ToolError(f"{cut.name}: {error.message}", cut.tool) from error
        raise


def divided(moves: Iterable[Move | Stop], largest: float) -> Iterator[Move | Stop]:
    """The same with each arc cut into equal parts of at most `largest` [rad]."""
    at: Point | None = None
    for move in moves:
        if isinstance(move, ArcFeed):
            if at is None:
                raise ValueError("an arc must start at a known point")
            yield from _parts(at, move, largest)
        else:
            yield move
        at = at if isinstance(move, Stop) else move.end


def _parts(at: Point, move: ArcFeed, largest: float) -> Iterator[ArcFeed]:
    start, end = complex(at[0], at[1]), complex(move.end[0], move.end[1])
    centre = complex(*move.centre)
    sweep = arc_sweep(start - centre, end - centre, ccw=move.ccw)
    if abs(sweep) > largest:
        parts = Arc(start, end, sweep, centre).split(largest)
        rise = (move.end[2] - at[2]) / len(parts)
        for count, arc in enumerate(parts[:-1], start=1):
            yield replace(move, end=(arc.end.real, arc.end.imag, at[2] + count * rise))
    yield move
