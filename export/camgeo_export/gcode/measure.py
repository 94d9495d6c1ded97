"""A program run again and compared with the exact cutter path."""

from __future__ import annotations

from camgeo.formats.gcode import FORMAT
from camgeo.product.product import Product
from camgeo.toolpath.cut import ContourCut
from camgeo.toolpath.machine import Machine, load
from camgeo.units import MM_PER
from camgeo.verifying.linting import Bench
from camgeo_export.errors import FileError
from camgeo_export.gcode.comments import stated
from camgeo_export.gcode.moves import Loop
from camgeo_export.interpreter.run import Run, run_bytes


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of the cutter from its exact path.

    Includes path blending, and how far the controller's own path departs from an arc.

    Raises FileError if the program is incomplete, unsafe or in the wrong unit.
    """
    spec = product.options[FORMAT]
    machine = load(spec.machine)
    program = run_bytes(data, machine, bench_of(product, machine), most=1)
    program.refuse("words", "path")
    if program.mm_per_unit != MM_PER[product.unit]:
        raise FileError(f"the program is not in {product.unit}")
    program.refuse()
    if program.compensated is not None:
        raise FileError(f"line {program.compensated.line}: compensated by the control")
    if stated(program.comments).tolerance is None:  # then it could not be verified later
        raise FileError("the program does not state its tolerance")
    loops = program.loops()
    _check_complete(product.milled.contour_cuts, program, loops)
    centres = {cut.name: cut.centre for cut in product.milled.contour_cuts}
    path = max(
        loop.mismatch + centres[loop.operation].deviation(loop.contour.counter_clockwise())
        for loop in loops
    )
    arcs = any(move.kind == "arc" for move in program.moves)
    own = machine.arcs.interpolation if arcs else 0.0
    return path + program.blending + program.naive_cam + own


def bench_of(product: Product, machine: Machine) -> Bench:
    """The work of a program of ours: traverses at its safe height, which is printed rounded."""
    step = 10.0 ** -machine.numbers.decimals.of(product.unit) * MM_PER[product.unit]
    names = tuple(cut.name for cut in product.milled.cuts)
    return Bench(clearance=product.options[FORMAT].safe_height - 0.5 * step, operations=names)


def _check_complete(cuts: tuple[ContourCut, ...], program: Run, loops: list[Loop]) -> None:
    """Every cut must use its tool, on its closed path at each of its depths."""
    tools = {cut.name: cut.tool.number for cut in cuts}
    for loop in loops:
        if loop.operation not in tools:
            raise FileError(f"the program cuts {loop.operation!r}, which the part does not have")
        if loop.tool != tools[loop.operation]:
            raise FileError(
                f"{loop.operation!r} is cut with tool {loop.tool}, not {tools[loop.operation]}"
            )
    for cut in cuts:
        heights = [loop.z for loop in loops if loop.operation == cut.name]
        for depth in cut.depths:
            if not any(abs(height - depth) <= program.step for height in heights):
                raise FileError(f"no closed path of {cut.name!r} at Z {depth:g} mm")
