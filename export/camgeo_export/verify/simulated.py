"""A program as it is written, simulated: its moves take the blank down to the part."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final

from camgeo.contour.pieces import HALF_TURN
from camgeo.contour.spline import Arc
from camgeo.product.milled import job
from camgeo.product.product import Product
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.holding import Obstacle
from camgeo.toolpath.judged import run_with, runs_of
from camgeo.toolpath.milling import MillingSpec
from camgeo.toolpath.moves import ArcFeed, Feed, Move, Point, Rapid
from camgeo.toolpath.setup import Run
from camgeo.toolpath.sides import settled
from camgeo.toolpath.tool import Tool
from camgeo.verifying.verification import Check, failed, reported
from camgeo.wording import counted
from camgeo_export.errors import FileError
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.run import Run as Program

NAME: Final = "simulation"

UNFED: Final = 1.0
"""Feed [mm/min] of cuts before any is programmed; the material does not depend on it."""


def simulation_checks(product: Product, program: Program, tolerance: float) -> list[Check]:
    """That the program leaves the part, and does nothing on the way that must not be done.

    One check, or one for each flaw. The path may lie within `tolerance` [mm] of the exact one.
    """
    spec = product.milled.spec
    assert spec is not None  # for the scene has a tool
    if program.compensated is not None:
        return [reported(NAME, "none", note="the control computes the path of the cutter")]
    try:
        runs = _among_others(product, runs_in(product, program), tolerance)
    except FileError as error:
        return [failed(NAME, str(error))]
    whole = product.milled if product.milled.whole is None else product.milled.whole
    level = program.step if math.isfinite(program.step) else 0.0
    done = job(whole, whole.cuts, runs, tolerance, level=level)
    told = [
        (flaw, flaw.sentence if side.side.runs is runs else f"of the other side, {flaw.sentence}")
        for side, flaws in zip(done, settled(done), strict=True)
        for flaw in flaws
    ]
    if wrong := [(flaw, text) for flaw, text in told if not flaw.watched]:
        return [failed(NAME, text, flaw.operation) for flaw, text in wrong]
    names = {run.name for run in runs}
    checks = [Check(NAME, "", counted(len(names), "operation"), ok=True)]
    return checks + [Check(NAME, flaw.operation, ok=None, note=text) for flaw, text in told]


def _among_others(product: Product, runs: tuple[Run, ...], tolerance: float) -> tuple[Run, ...]:
    """The runs of one of several programs, among those that the others should have."""
    whole = product.milled.whole
    if whole is None:
        return runs
    own = {cut.name for cut in product.milled.cuts}
    planned = runs_of(whole.toolpath(tolerance))
    first = next(k for k, each in enumerate(planned) if each.name in own)
    others = [each for each in planned if each.name not in own]
    return (*others[:first], *runs, *others[first:])


@dataclass(frozen=True, slots=True)
class Traced:
    """What a tool of a program does in one operation.

    Attributes
    ----------
    run : its moves.
    tool : that runs them.
    lines : of the program, one for each move.
    """

    run: Run
    tool: Tool
    lines: tuple[int, ...]


def runs_in(product: Product, program: Program) -> tuple[Run, ...]:
    """What each tool of a program does, operation by operation; raises like `traced`."""
    return tuple(each.run for each in traced(product, program, product.milled.cuts))


def traced(product: Product, program: Program, cuts: Iterable[Cut]) -> tuple[Traced, ...]:
    """What each tool of a program does, operation by operation, with its lines; `cuts` are those
    that it may name.

    Moves from and to places that the program has not stated are left out; the machine's reference
    is above all other heights.

    Raises
    ------
    FileError
        If a tool cuts that the scene does not have.
    """
    spec = product.milled.spec
    tools = {tool.number: tool for tool in spec.tools} if spec is not None else {}
    named = {cut.name: cut for cut in cuts}
    above = max((abs(z) for z in _heights(program.moves)), default=0.0)
    above = max(above, product.milled.gcode.heights.clearance)
    found = []
    for (name, number), group in groupby(program.moves, lambda move: (move.operation, move.tool)):
        moves = list(group)
        cut = named.get(name)
        known = cut.tool if cut is not None and cut.tool.number == number else tools.get(number)
        if known is None and all(move.kind == "rapid" for move in moves):
            continue  # above the blank, before the first tool
        tool = _required(known, number, moves)
        obstacles = _always_there(spec) if cut is None else cut.obstacles
        title = name or f"tool {number}"
        for start, chain, lines in _chains(moves, above):
            run = run_with(tool, title, chain, obstacles, start)
            found.append(Traced(run, tool, lines))
    return tuple(found)


def _always_there(spec: MillingSpec | None) -> tuple[Obstacle, ...]:
    """Clamps and screws that neither come nor go."""
    clamps = () if spec is None or spec.holding is None else spec.holding.clamps
    return tuple(each.obstacle for each in clamps if not (each.since or each.until))


def _required(tool: Tool | None, number: int, moves: Sequence[CutterMove]) -> Tool:
    if tool is not None:
        return tool
    line = next(move.line for move in moves if move.kind != "rapid")
    what = f"tool {number} is none of the scene's" if number else "no tool is called"
    raise FileError(f"line {line}: {what}")


def _heights(moves: Sequence[CutterMove]) -> Iterator[float]:
    """All heights of a program that are known [mm]."""
    return (z for move in moves for z in (move.z_start, move.z_end) if math.isfinite(z))


def _chains(
    moves: Sequence[CutterMove], above: float
) -> Iterator[tuple[Point, tuple[Move, ...], tuple[int, ...]]]:
    """Moves that join, with their starts and their lines."""
    start: Point | None = None
    chain: list[Move] = []
    lines: list[int] = []
    for move in moves:
        begin = _point(move.start, move.z_start, above)
        end = _point(move.end, move.z_end, above)
        if begin is None or end is None:
            if start is not None and chain:
                yield start, tuple(chain), tuple(lines)
            start, chain, lines = None, [], []
            continue
        start = start or begin
        chain += _moves(move, begin, end)
        lines += [move.line] * (len(chain) - len(lines))
    if start is not None and chain:
        yield start, tuple(chain), tuple(lines)


def _point(place: complex, z: float, above: float) -> Point | None:
    """A place [mm]; None if it is not known."""
    if cmath.isnan(place) or math.isnan(z):
        return None
    return (float(place.real), float(place.imag), float(z) if math.isfinite(z) else above)


def _moves(move: CutterMove, start: Point, end: Point) -> Iterator[Move]:
    """A move of at most half a turn each."""
    if move.kind == "rapid":
        yield Rapid(end)
        return
    feed = float(move.feed) or UNFED
    if not move.sweep:
        yield Feed(end, feed)
        return
    arcs = move.course.split(HALF_TURN)
    for k, arc in enumerate(arcs, start=1):
        share = k / len(arcs)
        z = end[2] if k == len(arcs) else start[2] + share * (end[2] - start[2])
        yield _arc(arc, z, feed)


def _arc(arc: Arc, z: float, feed: float) -> ArcFeed:
    end, centre = complex(arc.end), complex(arc.centre)
    return ArcFeed((end.real, end.imag, z), (centre.real, centre.imag), arc.sweep > 0.0, feed)
