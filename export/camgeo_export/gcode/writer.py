"""G-code: the milling program of the part in the words of a machine profile."""

from __future__ import annotations

from camgeo.errors import Fault, SceneError
from camgeo.formats.gcode import FORMAT
from camgeo.product.product import Product
from camgeo.toolpath.machine import KEY, Machine, load
from camgeo.toolpath.machine_tables import filled
from camgeo.toolpath.machining_time import toolpath_time
from camgeo.toolpath.spec import Tool
from camgeo.units import MM_PER
from camgeo.writing.writer import Written
from camgeo_export.gcode.blocks import Budget, Grid, Speller, budget, number
from camgeo_export.gcode.comments import about_operation, about_program, commented
from camgeo_export.gcode.measure import measure


class GcodeWriter:
    """Writes a milling program."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The program, in the product's unit; path blending counts against `tolerance` [mm]."""
        machine = load(product.options[FORMAT].machine)
        shares = budget(machine, product.unit, tolerance)
        toolpath = product.milled.toolpath(shares.fit)
        grid = Grid(shares.decimals, MM_PER[product.unit])
        speller = Speller(grid, shares, machine.arcs)
        cuts = [operation.cut for operation in toolpath.operations]
        about = about_program(product, machine, shares, cuts, product.scene_hash)
        lines = commented(about, machine.text)
        lines += _frame(product, machine, shares)
        tool: Tool | None = None
        for operation in toolpath.operations:
            cut = operation.cut
            change = _change(tool, cut.tool, machine)
            if change:
                speller.retract(toolpath.safe_height)
                lines += (*change, *speller.take())
            tool = cut.tool
            lines += commented(about_operation(cut, grid), machine.text)
            for move in operation.moves:
                speller.move(move)
            lines += speller.take()
        speller.retract(toolpath.safe_height)
        lines += speller.take()
        lines += (*machine.spindle.off, *machine.program.end)
        _check_length(lines, machine)
        facts: dict[str, int | float | str] = {
            "operations": len(toolpath.operations),
            "arcs": speller.arcs,
            "lines": speller.lines,
            "decimals": shares.decimals,
            "budget_fit_mm": _short(shares.fit),
            "budget_rounding_mm": _short(shares.rounding),
            "budget_chords_mm": _short(shares.chord),
            "path_blending_mm": _short(shares.blending),
        }
        if shares.interpolation > 0.0:
            facts["controller_arcs_mm"] = _short(shares.interpolation)
        if machine.dynamics is not None:
            facts["machining_time_s"] = round(toolpath_time(toolpath, machine.dynamics), 1)
        return Written("".join(line + "\n" for line in lines).encode("ascii"), facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Run the program in our own interpreter and measure the cutter path [mm]."""
        return measure(product, data)


def _frame(product: Product, machine: Machine, shares: Budget) -> list[str]:
    """Modal state and path blending."""
    offset = next(iter(machine.work_offsets.values()))
    unit = machine.unit.of(product.unit)
    state = filled(machine.program.safe_start, unit=unit, work_offset=offset)
    if machine.smoothing is None:
        return state
    if shares.blending > 0.0:
        printed = f"{shares.blending / MM_PER[product.unit]:.{shares.decimals}f}"
        return [*state, *filled(machine.smoothing.on, p=printed)]
    return [*state, *machine.smoothing.off]


def _change(before: Tool | None, tool: Tool, machine: Machine) -> list[str]:
    """From one tool and its speed to the next; the cutter is at the safe height."""
    blocks: tuple[str, ...] = ()
    if before is None or before.number != tool.number:
        blocks += machine.tool_change.change + machine.tool_change.length_offset
    if blocks or before is None or before.spindle_speed != tool.spindle_speed:
        blocks += machine.spindle.clockwise
    words = {"tool": str(tool.number), "speed": number(tool.spindle_speed)}
    return filled(blocks, **words)


def _short(length: float) -> float:
    """A share of the budget, to four digits."""
    return float(f"{length:.4g}")


def _check_length(lines: list[str], machine: Machine) -> None:
    for line in lines:
        if len(line) > machine.text.line_length:
            message = f"its text.line_length is too short for the block {line}"
            raise SceneError([Fault(KEY, repr(machine.name), message)])


WRITER = GcodeWriter()
