"""A program run again and compared with the exact cutter path."""

from __future__ import annotations

from camgeo.formats.gcode import FORMAT
from camgeo.product.product import Product
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.machine import load
from camgeo.units import MM_PER
from camgeo_export.errors import FileError
from camgeo_export.gcode.comments import stated
from camgeo_export.gcode.moves import Loop
from camgeo_export.gcode.reader import Program, read


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of the cutter from its exact path.

    Includes path blending, and how far the controller's own path departs from an arc.

    Raises FileError if the program is incomplete, unsafe or in the wrong unit.
    """
    program = read(data.decode("ascii", "replace"))
    if program.mm_per_unit != MM_PER[product.unit]:
        raise FileError(f"the program is not in {product.unit}")
    spec = product.options[FORMAT]
    limits = load(spec.machine).arcs
    program.verify(spec.safe_height, limits.radius_tolerance)
    if stated(program.comments).tolerance is None:  # then it could not be verified later
        raise FileError("the program does not state its tolerance")
    loops = program.loops()
    _check_complete(product.milled.cuts, program, loops)
    centres = {cut.name: cut.centre for cut in product.milled.cuts}
    path = max(
        loop.mismatch + centres[loop.operation].deviation(loop.contour.counter_clockwise())
        for loop in loops
    )
    arcs = any(move.kind == "arc" for move in program.moves)
    own = limits.interpolation if arcs else 0.0
    return path + program.blending + program.naive_cam + own


def _check_complete(cuts: tuple[Cut, ...], program: Program, loops: list[Loop]) -> None:
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
