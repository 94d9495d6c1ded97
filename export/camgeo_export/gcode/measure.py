"""A program run again and compared with the exact cutter path."""

from __future__ import annotations

from camgeo.contour.contour import Contour
from camgeo.contour.spline import SplineContour
from camgeo.product.product import Product
from camgeo.toolpath.cut import AreaCut, ContourCut, Cut, LetterCut
from camgeo.toolpath.machine import Machine, load
from camgeo.units import MM_PER
from camgeo.verifying.linting import Bench
from camgeo_export.errors import FileError
from camgeo_export.gcode.comments import stated
from camgeo_export.gcode.compensated import centred, fault_of
from camgeo_export.gcode.moves import Loop
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
        from camgeo_export.gcode.areas import too_near  # few programs clear areas

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
