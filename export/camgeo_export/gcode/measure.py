"""A program run again and held against the exact cutter path."""

from __future__ import annotations

from camgeo.files.product import Product
from camgeo.units import MM_PER
from camgeo_export.errors import FileError
from camgeo_export.gcode.machine import load
from camgeo_export.gcode.reader import Loop, Program, read


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of the cutter from its exact path.

    Path blending counts, and how far the controller's own path leaves an arc.

    Raises FileError if the program is incomplete, unsafe or in the wrong unit.
    """
    program = read(data.decode("ascii", "replace"))
    if program.mm_per_unit != MM_PER[product.unit]:
        raise FileError(f"the program is not in {product.unit}")
    if product.gcode is None:
        raise FileError("the scene has no [output.gcode] that this program could be held against")
    limits = load(product.gcode.machine).arcs
    program.verify(product.gcode.safe_height, limits.radius_tolerance)
    loops = program.loops()
    _check_complete(product, program, loops)
    path = max(
        loop.mismatch + product.toolpath_deviation(loop.operation, loop.contour.counter_clockwise())
        for loop in loops
    )
    arcs = any(move.kind == "arc" for move in program.moves)
    own = limits.interpolation if arcs else 0.0
    return path + program.blending + program.naive_cam + own


def _check_complete(product: Product, program: Program, loops: list[Loop]) -> None:
    """Every operation must run its closed path at each of its depths."""
    toolpath = product.toolpath(_tolerance(program))
    wanted = [operation.name for operation in toolpath.operations]
    for loop in loops:
        if loop.operation not in wanted:
            raise FileError(f"the program cuts {loop.operation!r}, which the part does not have")
    for operation in toolpath.operations:
        heights = [loop.z for loop in loops if loop.operation == operation.name]
        for depth in operation.depths:
            if not any(abs(height - depth) <= program.step for height in heights):
                raise FileError(f"no closed path of {operation.name!r} at Z {depth:g} mm")


def _tolerance(program: Program) -> float:
    for note in program.comments:
        words = note.split()
        if len(words) == 3 and words[0] == "tolerance" and words[2] == "mm":
            return float(words[1])
    raise FileError("the program does not name its tolerance")
