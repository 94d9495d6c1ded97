"""Whether a program of ours compensates for the cutter's radius as its cuts say."""

from __future__ import annotations

from collections.abc import Sequence

from camgeo.toolpath.compensation import mode_of, side_of
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.machine import Machine
from camgeo.toolpath.tool import WEAR
from camgeo_export.gcode.comments import Stated
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.centre import Radius, judge
from camgeo_export.interpreter.rules import Enough, Findings
from camgeo_export.interpreter.run import Run


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
