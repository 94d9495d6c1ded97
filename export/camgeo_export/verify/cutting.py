"""How one of our programs runs its tools: numbers, feeds, speeds, heights, and its comments."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import zip_longest

from camgeo.errors import ToleranceError
from camgeo.formats.gcode import FORMAT
from camgeo.product.product import Product
from camgeo.toolpath.cut import ContourCut
from camgeo.toolpath.machine import Machine
from camgeo.units import MM_PER
from camgeo.verifying.verification import Check, failed
from camgeo_export.gcode.blocks import FEED_DECIMALS, Grid, budget
from camgeo_export.gcode.comments import Stated, about_operation, about_program, comment_texts
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.run import Run

PRINTED = 0.5 * 10.0**-FEED_DECIMALS * (1.0 + 1e-9)
"""Rounding of a printed speed or diameter, in its unit."""


def cutting_checks(
    product: Product, program: Run, stated: Stated, machine: Machine, safe_height: float
) -> list[Check]:
    """All checks of one of our programs that its closed paths do not show."""
    cuts = product.milled.contour_cuts
    checks = [_heights(program, safe_height), _comments(product, program, stated, machine)]
    checks += [_cutters(cuts, stated), _work_offset(product, program, machine)]
    for cut in cuts:
        own = [move for move in program.moves if move.operation == cut.name]
        checks += _of_cut(cut, [move for move in own if move.kind != "rapid"], program, machine)
    return checks


def _heights(program: Run, safe_height: float) -> Check:
    """All traverses are at the safe height, or lead there."""
    for move in program.moves:
        high = abs(move.z_end - safe_height) <= program.step or move.z_end == math.inf
        if move.kind == "rapid" and not high:
            note = f"line {move.line}: a traverse to Z {move.z_end:g} mm, not {safe_height:g} mm"
            return failed("traverses", note)
    return Check("traverses", "", f"at Z {safe_height:g} mm", ok=True)


def _of_cut(
    cut: ContourCut, moves: Sequence[CutterMove], program: Run, machine: Machine
) -> list[Check]:
    """Tool, speed and feeds of one operation, and that its cuts are level or straight down."""
    tool, scale = cut.tool, program.mm_per_unit
    step = machine.numbers.feed_step("mm" if scale == MM_PER["mm"] else "inch")
    rounding = 0.5 * step * scale * (1.0 + 1e-9)
    turns = 0.5 if machine.spindle.whole_speed else PRINTED
    flat = [move for move in moves if move.z_start == move.z_end]
    down = [move for move in moves if move.z_start != move.z_end]
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
            "feed", cut.name, ((each.feed, each.line) for each in flat), tool.feed, "mm/min",
            rounding,
        ),
        _same(
            "plunge feed", cut.name, ((each.feed, each.line) for each in down), tool.plunge_feed,
            "mm/min", rounding,
        ),
    ]  # fmt: skip
    for move in moves:
        note = ""
        if move.z_start != move.z_end and (move.end != move.start or move.z_end > move.z_start):
            note = "a cut that is neither level nor straight down"
        elif min(abs(move.z_end - depth) for depth in cut.depths) > program.step:
            note = f"a cut at Z {move.z_end:g} mm, which is not one of its depths"
        if note:
            return [*checks, failed("moves", f"line {move.line}: {note}", cut.name)]
    return checks


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
    name = product.options[FORMAT].work_offset or next(iter(machine.work_offsets))
    expected = machine.work_offsets.get(name, "")
    for move in program.moves:
        if move.kind != "rapid" and move.work_offset != expected:
            note = f"line {move.line}: a cut with {move.work_offset or 'no offset stated'}"
            return Check("work offset", "", move.work_offset, expected, ok=False, note=note)
    return Check("work offset", "", expected, expected, ok=True)


def _cutters(cuts: Sequence[ContourCut], stated: Stated) -> Check:
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
    texts = about_program(product, machine, shares, product.milled.contour_cuts, stated.scene)
    for cut in product.milled.contour_cuts:
        texts += about_operation(cut, grid)
    expected = [line.strip() for line in comment_texts(texts, machine.text)]
    for found, wanted in zip_longest(program.comments, expected, fillvalue=""):
        if found != wanted:
            return failed("comments", f"'{found}' where '{wanted}' is expected")
    return Check("comments", "", float(len(expected)), ok=True)
