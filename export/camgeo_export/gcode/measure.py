"""A program run again and compared with the exact cutter path."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from camgeo.design.linting import Bench
from camgeo.design.product import Product
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour, least_distance
from camgeo.geometry.contour.spline import SplineContour
from camgeo.milling.compensation import mode_of, side_of
from camgeo.milling.cut import AreaCut, ContourCut, Cut, LetterCut
from camgeo.milling.machine import Machine, load
from camgeo.milling.milling import WEAR
from camgeo.milling.track import Track
from camgeo.units import MM_PER
from camgeo_export.gcode.comments import Stated, stated
from camgeo_export.gcode.moves import CutterMove, Loop
from camgeo_export.interpreter.compensation import Radius, judge
from camgeo_export.interpreter.iso import Enough, Findings
from camgeo_export.interpreter.run import Run, run_bytes


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of the cutter from its exact path.

    That of a roughing counts beyond its slack. Includes path blending, and how far the
    controller's own path departs from an arc.

    Raises FileError if the program is incomplete, unsafe or in the wrong unit.
    """
    spec = product.milled.gcode
    machine = load(spec.machine)
    program = run_bytes(data, machine, bench_of(product, machine), most=1)
    program.refuse("words", "path")
    program = program.in_the_part(product.milled.zero)
    if program.mm_per_unit != MM_PER[product.unit]:
        raise FileError(f"the program is not in {product.unit}")
    program.refuse()
    said, cuts = stated(program.comments), product.milled.cuts
    if said.tolerance is None:  # then it could not be verified later
        raise FileError("the program does not state its tolerance")
    if fault := fault_of(cuts, program, machine, said):
        raise FileError(fault)
    gap = 0.0 if program.compensated is None else program.step
    program, rest = centred(cuts, program, machine)
    along = {cut.name: cut for cut in cuts if isinstance(cut, ContourCut)}
    areas = {cut.name: cut for cut in cuts if isinstance(cut, AreaCut | LetterCut)}
    others = {cut.name for cut in cuts} - set(along)
    loops = [loop for loop in program.loops(gap) if loop.operation not in others]
    _check_complete(cuts, program, loops)
    for name, area in areas.items():
        of_area = [move for move in program.moves if move.operation == name]
        if (short := too_near(area, of_area)) > program.step:
            raise FileError(f"{name!r} comes {short:.3g} mm too near to a wall")
    deviations = (
        loop.mismatch + beyond_slack(along[loop.operation], loop.contour.counter_clockwise())
        for loop in loops
    )
    path = max(deviations, default=0.0)  # there may be a face or a drilled hole alone
    arcs = any(move.kind == "arc" for move in program.moves)
    own = machine.arcs.interpolation if arcs else 0.0
    return path + rest + program.blending + program.naive_cam + own


def beyond_slack(cut: ContourCut, contour: Contour | SplineContour) -> float:
    """Proved deviation [mm] of a counter-clockwise path from the exact one of a cut; of a roughing
    beyond its slack.
    """
    return max(0.0, cut.centre.deviation(contour) - cut.slack)


def bench_of(product: Product, machine: Machine) -> Bench:
    """The work of a program of ours: its blank, and its heights, which are printed rounded; all in
    its own coordinates.
    """
    heights, milling = product.milled.gcode.heights, product.milled.spec
    z = product.milled.zero.z
    step = 10.0 ** -machine.numbers.decimals.of(product.unit) * MM_PER[product.unit]
    names = tuple(cut.name for cut in product.milled.cuts)
    return Bench(
        stock_top=(0.0 if milling is None else milling.stock.top) - z,
        clearance=heights.retract - z - 0.5 * step,
        operations=names,
    )


def _check_complete(cuts: tuple[Cut, ...], program: Run, loops: list[Loop]) -> None:
    """Every cut must use its tool, and one along a path must close it at each of its depths."""
    tools = {cut.name: cut.tool.number for cut in cuts}
    for loop in loops:
        if loop.operation not in tools:
            raise FileError(f"the program cuts {loop.operation!r}, which the part does not have")
    for move in program.moves:
        wanted = tools.get(move.operation, move.tool)
        if move.kind != "rapid" and move.tool != wanted:
            raise FileError(f"{move.operation!r} is cut with tool {move.tool}, not {wanted}")
    for cut in cuts:
        if isinstance(cut, ContourCut):
            heights = {loop.z for loop in loops if loop.operation == cut.name}
        else:
            cutting = (move for move in program.moves if move.kind != "rapid")
            heights = {move.z_end for move in cutting if move.operation == cut.name}
        for depth in cut.depths:
            if not any(abs(height - depth) <= program.step for height in heights):
                what = "closed path" if isinstance(cut, ContourCut) else "cut"
                raise FileError(f"no {what} of {cut.name!r} at Z {depth:g} mm")


# -- areas ----------------------------------------------------------------------------------------
# How near a program comes to the walls of an area that it clears.


FINE = 1e-3
"""Tolerance of the walls [mm]; their proved deviation counts in favour of the program."""


def too_near(cut: AreaCut | LetterCut, moves: Sequence[CutterMove]) -> float:
    """By how much [mm] the cuts among `moves` come nearer to a wall than the cutter's radius and
    the allowance; 0 if none does.
    """
    least = np.inf
    for wall in cut.walls:
        fit = wall.arcs(FINE, "fast")
        around = Track.around(fit.contour)
        for is_cut, group in groupby(moves, _moves_in_the_plane):
            if is_cut:
                least = min(least, least_distance(_track(list(group)), around) + fit.deviation)
    return float(max(0.0, cut.tool.radius + cut.allowance - least))


def _moves_in_the_plane(move: CutterMove) -> bool:
    return move.kind != "rapid" and move.start != move.end


def _track(moves: Sequence[CutterMove]) -> Track:
    vertices = np.array([moves[0].start, *(move.end for move in moves)])
    sweeps = np.array([move.sweep for move in moves])
    return Track(vertices, sweeps, np.array([move.centre for move in moves]))


# -- compensated ----------------------------------------------------------------------------------
# Whether a program of ours compensates for the cutter's radius as its cuts say.


def offset_of(cuts: Sequence[Cut], machine: Machine, off: float = 0.0) -> Radius:
    """The offset of each compensated move [mm], if the tool table holds what it is to hold.

    With `off` [mm] it holds as much more.
    """
    table = {cut.tool.number: _of_table(cut, machine) + off for cut in cuts if side_of(cut)}
    return lambda move: table[move.radius_offset] + move.oversize


def centred(cuts: Sequence[Cut], program: Run, machine: Machine) -> tuple[Run, float]:
    """A program along the cutter's centre, and by how much it is off that [mm].

    A nominal radius that is printed rounded leaves an offset below the last decimal.
    """
    offset = offset_of(cuts, machine)
    sizes = [abs(offset(move)) for move in program.moves if move.compensation]
    rest = max((size for size in sizes if size <= program.step), default=0.0)

    def printed(move: CutterMove) -> float:
        size = offset(move)
        return size if abs(size) > program.step else 0.0

    return program.centred(printed), rest


def _of_table(cut: Cut, machine: Machine) -> float:
    """The radius [mm] that the table holds for the nominal cutter."""
    words = machine.compensation
    alone = mode_of(cut) == WEAR and (words is None or not words.nominal)
    return 0.0 if alone else cut.tool.radius


def fault_of(cuts: Sequence[Cut], program: Run, machine: Machine, said: Stated) -> str:
    """What is wrong with the compensation of a program; empty if nothing is.

    Every cut is compensated as it is to be, from a straight move to another one, with the offset
    of its tool; and the controller can run it with each offset that its comments allow.
    """
    compensated = [cut for cut in cuts if side_of(cut)]
    names = {cut.name for cut in compensated}
    for move in program.moves:
        if move.compensation and move.operation not in names:
            return f"line {move.line}: compensated by the control"
    if not compensated:
        return ""
    if len(said.offsets) != len(compensated):
        return "its comments do not say how far the offsets of its tools may be off"
    for cut, most in zip(compensated, said.offsets, strict=True):
        own = [move for move in program.moves if move.operation == cut.name]
        found = _of_cut(cut, own, program.step, machine) or _beyond(cut, own, machine, most)
        if found:
            return found
    return ""


def _of_cut(cut: Cut, moves: Sequence[CutterMove], step: float, machine: Machine) -> str:
    side, tool = side_of(cut), cut.tool
    flat = [move for move in moves if move.kind != "rapid" and move.start != move.end]
    oversize = _of_table(cut, machine) and mode_of(cut) == WEAR
    expected = -tool.radius if oversize else 0.0
    for number, move in enumerate(flat):
        if not move.compensation:
            # Only the way off the path: a line behind a compensated move.
            if move.kind != "line" or not (number and flat[number - 1].compensation):
                return f"line {move.line}: {cut.name!r} is cut without compensation"
        elif move.compensation != side:
            return f"line {move.line}: the cutter is kept on the {move.compensation}, not {side}"
        elif move.radius_offset != tool.number:
            return f"line {move.line}: offset {move.radius_offset}, not that of tool {tool.number}"
        elif abs(move.oversize - expected) > step:
            return f"line {move.line}: {move.oversize:g} mm are added, not {expected:g} mm"
    return ""


def _beyond(cut: Cut, moves: Sequence[CutterMove], machine: Machine, most: float) -> str:
    """What a controller refuses with an offset that the comments allow."""
    for off in (0.0, most, -most):
        findings = Findings(1)
        try:
            judge(moves, offset_of((cut,), machine, off), findings)
        except Enough:
            return f"with an offset {off:g} mm off its nominal one, {findings.found[0]}"
    return ""
