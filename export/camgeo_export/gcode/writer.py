"""G-code: the milling program of the part in the words of a machine profile."""

from __future__ import annotations

from typing import Final

from camgeo.check.finding import Finding
from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.formats.gcode import FORMAT
from camgeo.numeric.checked import one_of
from camgeo.product.product import Product
from camgeo.toolpath.blank import box
from camgeo.toolpath.compensation import KEY as KEY_OF_COMPENSATION
from camgeo.toolpath.compensation import mode_of
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.machine import KEY, Machine, load
from camgeo.toolpath.machining_time import toolpath_times
from camgeo.toolpath.moves import Toolpath
from camgeo.toolpath.spec import GcodeSpec
from camgeo.writing.writer import Written
from camgeo_export.gcode.blocks import budget
from camgeo_export.gcode.comments import about_program, side_sentence
from camgeo_export.gcode.frame import Program, Setup, numbered, written
from camgeo_export.gcode.measure import measure

ENDINGS: Final = {"lf": "\n", "crlf": "\r\n"}


class GcodeWriter:
    """Writes a milling program."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The program, in the product's unit; path blending counts against `tolerance` [mm]."""
        spec = product.milled.gcode
        machine = load(spec.machine)
        setup = setup_of(product, spec, machine)
        shares = budget(machine, product.unit, tolerance)
        toolpath = product.milled.toolpath(shares.fit)
        watched = _safe(product, shares.fit, tolerance, toolpath)
        cuts = [operation.cut for operation in toolpath.operations]
        _check_tools(cuts, machine)
        about = about_program(product, machine, shares, cuts, product.scene_hash)
        program = written(toolpath, machine, shares, setup, about)
        lines = numbered(program.lines, machine)
        _check_length(lines, machine)
        _check_reach(program, machine)
        facts: dict[str, int | float | str] = {
            "operations": len(toolpath.operations),
            **({"side": side_sentence(product)} if side_sentence(product) else {}),
            "zero": setup.zero.sentence,
            "arcs": program.speller.arcs,
            "lines": program.speller.lines,
            "decimals": shares.decimals,
            "budget_fit_mm": _short(shares.fit),
            "budget_rounding_mm": _short(shares.rounding),
            "budget_chords_mm": _short(shares.chord),
            "path_blending_mm": _short(shares.blending),
        }
        if shares.interpolation > 0.0:
            facts["controller_arcs_mm"] = _short(shares.interpolation)
        if program.limits:
            facts["compensation"] = ", ".join(
                f"{each.operation} {each.mode} {each.most:.3f} mm"
                for each in program.limits.values()
            )
        if machine.dynamics is not None:
            smoothing = shares.blending if shares.blending > 0.0 else None
            times = toolpath_times(
                toolpath, machine.dynamics, chord=shares.interpolation, smoothing=smoothing
            )
            facts["machining_time_s"] = round(sum(each.seconds for each in times), 1)
            facts["machining_times"] = ", ".join(f"{t.name} {t.seconds:.1f} s" for t in times)
        ending = ENDINGS[machine.text.line_ending]
        return Written("".join(line + ending for line in lines).encode("ascii"), facts, watched)

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """The disc, or one for each program where the machine cannot change tools."""
        return product.programs

    def measure(self, product: Product, data: bytes) -> float:
        """Run the program in our own interpreter and measure the cutter path [mm]."""
        return measure(product, data)


def _safe(
    product: Product, fit: float, tolerance: float, toolpath: Toolpath
) -> tuple[Finding, ...]:
    """What is to be watched in all programs, told with the first; raises UnsafeError like it."""
    whole = product.milled.whole
    if whole is None:
        return product.milled.safe(toolpath, tolerance)
    return () if product.program else whole.safe(whole.toolpath(fit), tolerance)


def setup_of(product: Product, spec: GcodeSpec, machine: Machine) -> Setup:
    """What the scene asks of the program; SceneError for what the machine does not have."""
    offset = spec.work_offset or next(iter(machine.work_offsets))
    allowed = {
        "coolant": machine.coolant.kinds,
        "work_offset": tuple(machine.work_offsets),
        "compensation": machine.compensations,
    }
    faults = []
    wanted = {("output.gcode.coolant", spec.coolant), ("output.gcode.work_offset", offset)}
    wanted |= {("tool.coolant", cut.tool.coolant or "off") for cut in product.milled.cuts}
    wanted |= {(KEY_OF_COMPENSATION, mode_of(cut)) for cut in product.milled.cuts}
    for key, value in sorted(wanted):
        try:
            one_of(key, value, allowed[key.rpartition(".")[2]])
        except GeometryError as error:
            message = f"{error.message} for {machine.name}"
            faults.append(Fault(error.key, repr(value), message))
    if faults:
        raise SceneError(faults)
    spin_up = machine.spindle.spin_up if spec.spin_up is None else spec.spin_up
    words = machine.work_offsets[offset]
    milled, away = product.milled, spec.tool_change_height
    before = 0 if milled.first is None else len(milled.first.programs)
    number = spec.program_number + product.position + 2 * (before + (product.program or 0))
    assert milled.spec is not None  # for there are cuts
    blank = box(milled.spec.stock, milled.part, milled.zero)
    return Setup(
        product.name, product.unit, words, spec.coolant, spin_up, number, away, milled.zero, blank
    )


def _short(length: float) -> float:
    """A share of the budget, to four digits."""
    return float(f"{length:.4g}")


def _check_tools(cuts: list[Cut], machine: Machine) -> None:
    tools = dict.fromkeys(cut.tool.number for cut in cuts)
    if len(tools) > 1 and not machine.tool_change.change:
        named = " and ".join(map(str, tools))
        message = f"a program cannot change tools there, but tools {named} are needed"
        allowed = "write one for each of them, or use a profile with tool_change.change"
        raise SceneError([Fault(KEY, repr(machine.name), f"{message}: {allowed}")])


def _check_length(lines: list[str], machine: Machine) -> None:
    for line in lines:
        if len(line) > machine.text.line_length:
            message = f"its text.line_length is too short for the block {line}"
            raise SceneError([Fault(KEY, repr(machine.name), message)])


def _check_reach(program: Program, machine: Machine) -> None:
    grid = program.speller.grid
    largest = grid.mm(program.speller.reach) / grid.mm_per_unit
    if largest > machine.numbers.largest:
        message = f"its numbers.largest is too small for the coordinate {largest:g}"
        raise SceneError([Fault(KEY, repr(machine.name), message)])


WRITER = GcodeWriter()
