"""How one of our programs runs its tools: numbers, feeds, speeds, heights, and its comments."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import zip_longest
from typing import Final

import numpy as np

from camgeo.contour.nearness import distances
from camgeo.errors import ToleranceError
from camgeo.product.product import Product
from camgeo.toolpath.compensation import Limit, mode_of, side_of
from camgeo.toolpath.cut import AreaCut, ContourCut, Cut, PointCut
from camgeo.toolpath.feeds import centre_feed
from camgeo.toolpath.machine import Machine
from camgeo.toolpath.moves import Heights
from camgeo.toolpath.plane.track import Track
from camgeo.units import MM_PER
from camgeo.verifying.verification import Check, failed
from camgeo_export.gcode.blocks import FEED_DECIMALS, Grid, budget
from camgeo_export.gcode.comments import (
    Stated,
    about_operation,
    about_program,
    comment_texts,
    spelled,
)
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.run import Run
from camgeo_export.verify.heights import at_no_height

COARSE: Final = 0.01
"""Tolerance [mm] of a wall by which the two halves of a loop are told apart."""

SLOWED = 1e-3
"""Share by which a feed that depends on a radius or a slope may be off: both are printed rounded,
and tiny arcs have few digits."""

PRINTED = 0.5 * 10.0**-FEED_DECIMALS * (1.0 + 1e-9)
"""Rounding of a printed speed or diameter, in its unit."""


def cutting_checks(
    product: Product,
    program: Run,
    stated: Stated,
    machine: Machine,
    heights: Heights,
    tolerance: float,
) -> list[Check]:
    """All checks of one of our programs that its closed paths do not show."""
    cuts = product.milled.cuts
    away = product.milled.gcode.tool_change_height
    checks = [_heights(program, heights, away), _comments(product, program, stated, machine)]
    checks += [_cutters(cuts, stated), _work_offset(product, program, machine)]
    for cut in cuts:
        own = [move for move in program.moves if move.operation == cut.name]
        cuts_of = [move for move in own if move.kind != "rapid"]
        checks += _of_cut(cut, cuts_of, program, machine, tolerance)
    return checks


def _heights(program: Run, heights: Heights, away: float | None) -> Check:
    """All traverses are at the clearance or the retract height, or that of tool changes, or lead
    there.
    """
    known = (heights.clearance, heights.retract, *(() if away is None else (away,)))
    for move in program.moves:
        off = min(abs(move.z_end - each) for each in known)
        high = off <= program.step or move.z_end == math.inf
        if move.kind == "rapid" and not high:
            note = (
                f"line {move.line}: a traverse to Z {move.z_end:g} mm, not {heights.clearance:g} mm"
            )
            return failed("traverses", note)
    return Check("traverses", "", f"at Z {heights.clearance:g} mm", ok=True)


def _of_cut(
    cut: Cut, moves: Sequence[CutterMove], program: Run, machine: Machine, tolerance: float
) -> list[Check]:
    """Tool, speed, feeds and heights of one operation."""
    tool, scale = cut.tool, program.mm_per_unit
    step = machine.numbers.feed_step("mm" if scale == MM_PER["mm"] else "inch")
    rounding = 0.5 * step * scale * (1.0 + 1e-9)
    turns = 0.5 if machine.spindle.whole_speed else PRINTED
    straight = [move for move in moves if _drops(move) and move.start == move.end]
    sinking = cut.sinking if isinstance(cut, PointCut) else tool.plunge_feed
    others = [move for move in moves if move not in straight]
    checks = [
        _same("tool", cut.name, ((each.tool, each.line) for each in moves), tool.number, "", 0.0),
        _same(
            "tool length", cut.name, ((each.offset, each.line) for each in moves), tool.number, "",
            0.0,
        ),
        _same(
            "spindle speed", cut.name, ((each.speed, each.line) for each in moves),
            tool.spindle_speed, "rev/min", turns,
        ),
        _same(
            "plunge feed", cut.name, ((each.feed, each.line) for each in straight), sinking,
            "mm/min", rounding,
        ),
        _feeds(cut, others, rounding, tolerance, program.step),
    ]  # fmt: skip
    if (stray := at_no_height(cut, moves, program.step)) is not None:
        note = f"line {stray.line}: a cut at Z {stray.z_end:g} mm, which is not one of its depths"
        return [*checks, failed("moves", note, cut.name)]
    lowest = min((move.z_end for move in moves), default=cut.bottom)
    if lowest > cut.bottom + program.step:
        note = f"no deeper than Z {lowest:g} mm, not Z {cut.bottom:g} mm"
        return [*checks, failed("moves", note, cut.name)]
    return checks


def _drops(move: CutterMove) -> bool:
    return move.z_end < move.z_start


def _feeds(
    cut: Cut, moves: Sequence[CutterMove], rounding: float, tolerance: float, step: float
) -> Check:
    """That the contact of each move runs at the tool's feed, no faster and no slower: the centre is
    slowed where the wall lies around its arc, and on the way down.
    """
    tool = cut.tool
    worst, line, value, wanted = 0.0, 0, tool.feed, tool.feed
    back = _on_the_way_back(cut, moves)
    for move, free in zip(moves, back, strict=True):
        least, most = _allowed(cut, move, tolerance, step)
        most = tool.feed if free else most
        off = max(least - move.feed, move.feed - most, 0.0)
        off = max(0.0, off - SLOWED * most) if move.feed < tool.feed else off
        if off > worst:
            worst, line, value, wanted = off, move.line, move.feed, most
    ok = worst <= rounding
    note = "" if ok else f"line {line}"
    return Check("feed", cut.name, float(value), float(wanted), rounding, "mm/min", ok, note)


def _on_the_way_back(cut: Cut, moves: Sequence[CutterMove]) -> list[bool]:
    """Which arcs of a trochoidal slot lead back to the wall, mostly through what loops have swept:
    where there is no contact the centre runs at the tool's feed.
    """
    if not isinstance(cut, AreaCut) or not cut.slot:
        return [False] * len(moves)
    wall = Track.around(cut.walls[0].arcs(COARSE, "fast").contour)
    starts, ends = (
        distances(np.array([getattr(move.course, end) for move in moves]), wall)
        for end in ("start", "end")
    )
    return [
        bool(move.sweep) and move.course.radius < cut.tool.radius and not _drops(move) and near
        for move, near in zip(moves, (ends < starts - COARSE).tolist(), strict=True)
    ]


def _allowed(cut: Cut, move: CutterMove, tolerance: float, step: float) -> tuple[float, float]:
    """The least and the largest feed [mm/min] that a move may have, one and the same on an arc.

    The wall lies around an arc that turns to the free side, and around each one between two walls.
    A line may stand for a piece of an arc that is flat within `tolerance` [mm]; then its feed is
    slowed for any radius from the least one that is as flat. Both ends of a ramp are printed in
    steps of `step` [mm], so a piece of few of them may slope otherwise than the ramp.
    """
    tool, length = cut.tool, move.course.length
    radius = move.course.radius if move.sweep else length * length / (8.0 * tolerance)
    slow = centre_feed(tool.feed, radius, cut.contact_radius, inside=True)
    both = isinstance(cut, ContourCut) and bool(cut.left)
    around = both or (move.sweep > 0.0) == cut.climb
    feeds = (slow if around or not move.sweep else tool.feed, tool.feed)
    if move.sweep and around:
        feeds = (slow, slow)
    if not _drops(move):
        return feeds
    drop, reach = move.z_start - move.z_end, math.sqrt(2.0) * step
    steepest, flattest = max(length - reach, 0.0) / (drop + step), math.inf
    if drop > step:
        flattest = (length + reach) / (drop - step)
    most = (tool.plunge_feed * math.hypot(1.0, each) for each in (steepest, flattest))
    least, largest = (min(feed, each) for feed, each in zip(feeds, most, strict=True))
    return least, largest


def _same(
    name: str,
    of: str,
    found: Iterable[tuple[float, int]],
    expected: float,
    unit: str,
    limit: float,
) -> Check:
    """That all values `found`, each with its line, are the `expected` one."""
    values = list(found)
    worst, line = max(values, key=lambda each: abs(each[0] - expected), default=(expected, 0))
    ok = abs(worst - expected) <= limit
    note = "" if ok else f"line {line}"
    return Check(name, of, float(worst), float(expected), limit, unit, ok, note)


def _work_offset(product: Product, program: Run, machine: Machine) -> Check:
    """All cuts are made with the work offset of the scene."""
    name = product.milled.gcode.work_offset or next(iter(machine.work_offsets))
    expected = machine.work_offsets.get(name, "")
    for move in program.moves:
        if move.kind != "rapid" and move.work_offset != expected:
            note = f"line {move.line}: a cut with {move.work_offset or 'no offset stated'}"
            return Check("work offset", "", move.work_offset, expected, ok=False, note=note)
    return Check("work offset", "", expected, expected, ok=True)


def _cutters(cuts: Sequence[Cut], stated: Stated) -> Check:
    """The cutters that its comments name are those that it is computed for."""
    wanted = {cut.tool.number: cut.tool.diameter for cut in cuts}
    named = dict(stated.tools)
    text = "; ".join(f"tool {number} of {size:g} mm" for number, size in stated.tools)
    expected = "; ".join(f"tool {number} of {size:g} mm" for number, size in wanted.items())
    same = named.keys() == wanted.keys() and all(
        abs(named[number] - size) <= PRINTED for number, size in wanted.items()
    )
    if same:
        return Check("cutters", "", text, expected, ok=True)
    return failed("cutters", f"its comments name {text or 'none'}, not {expected}")


def _of_operations(product: Product, grid: Grid, stated: Stated, machine: Machine) -> Iterator[str]:
    """The comments on each operation, with the offsets that they state themselves."""
    offsets = iter(stated.offsets)
    for cut in product.milled.cuts:
        said = ""
        if side_of(cut) and machine.compensation is not None:
            tool, most = cut.tool, next(offsets, math.nan)
            limit = Limit(cut.name, mode_of(cut), tool.number, tool.radius, most)
            said = limit.sentence(machine.compensation, partial(spelled, unit=product.unit))
        yield from about_operation(cut, grid, product.milled.zero, said)


def _comments(product: Product, program: Run, stated: Stated, machine: Machine) -> Check:
    """That a program of our own version has the comments that it writes; the scene is checked
    elsewhere.
    """
    if stated.version != product.version:
        note = "" if stated.version else "they do not name a version of camgeo"
        return Check("comments", "", f"of camgeo {stated.version}", ok=None, note=note)
    unkept = failed("comments", "they state no tolerance that a program can meet")
    if stated.tolerance is None:
        return unkept
    try:
        shares = budget(machine, product.unit, stated.tolerance)
    except ToleranceError:
        return unkept
    grid = Grid(shares.decimals, MM_PER[product.unit])
    texts = about_program(product, machine, shares, product.milled.cuts, stated.scene)
    texts += _of_operations(product, grid, stated, machine)
    expected = [line.strip() for line in comment_texts(texts, machine.text)]
    for found, wanted in zip_longest(program.comments, expected, fillvalue=""):
        if found != wanted:
            return failed("comments", f"'{found}' where '{wanted}' is expected")
    return Check("comments", "", float(len(expected)), ok=True)
