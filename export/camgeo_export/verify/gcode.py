"""Verification of milling programs: our own, and others that use only the words we read."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from camgeo.design.linting import Bench, LineFinding
from camgeo.design.product import Product, programs_of, sides_of
from camgeo.design.verify import Check, Origin, Reading, at_most, failed, unit_check
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.compensation import mode_of, side_of
from camgeo.milling.cut import AreaCut, ContourCut, LetterCut
from camgeo.milling.machine import Machine, load
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.reading import PROGRAM, check_text
from camgeo.scene.formats.gcode import FORMAT
from camgeo.units import counted
from camgeo_export.gcode.comments import stated
from camgeo_export.gcode.measure import bench_of, beyond_slack, centred, fault_of, too_near
from camgeo_export.gcode.moves import Loop
from camgeo_export.interpreter.run import Run, notes_of, run_bytes
from camgeo_export.reading import COMPUTED, text_tokens
from camgeo_export.verify.plane import Shape, contour_checks, shapes_of
from camgeo_export.verify.simulated import WORK, simulation_checks, work_findings

NAMES = {1.0: "mm", 25.4: "inch"}


CONCERNS = {"arcs": ("form",), "safety": ("safety",), "frame": ("frame", "limits")}
"""Checks of what the interpreter finds, apart from a path that it cannot tell."""


class GcodeVerifier:
    """Verifies a milling program."""

    format = "gcode"
    slack = COMPUTED

    def tokens(self, data: bytes) -> Iterator[tuple[str, str]]:
        """Those of its lines."""
        return text_tokens(data)

    def origin(self, data: bytes) -> Origin:
        """From the comments."""
        try:
            check_text(data, PROGRAM, "the file")
        except FileError as error:
            return Origin(damage=str(error))
        said = stated(notes_of(data.decode("ascii", "replace")))
        return Origin(said.version, said.scene, said.tolerance)

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, safety, every operation at each depth, each closed path against its exact one."""
        if lacking := FORMAT.lacking(product.values):
            note = f"to compare a program with it the scene {' and '.join(lacking)}"
            return (failed("operations", note),)
        said = stated(notes_of(data.decode("ascii", "replace")))
        if (side := _side(product, said.second)) is None:
            return (failed("program", "it is for a second side, which the scene does not have"),)
        programs = programs_of(side)
        if len(programs) > 1 and not 1 <= said.program <= len(programs):
            note = f"it does not say which one of {len(programs)} programs it is"
            return (failed("program", note),)
        product = programs[said.program - 1 if len(programs) > 1 else 0]
        spec = product.milled.gcode
        machine = load(spec.machine)
        limits = machine.arcs
        bench = bench_of(product, machine) if said.version else Bench()
        try:
            program = run_bytes(data, machine, bench, fatal=("words", "path"))
            program.refuse("words", "path")
            program = program.in_the_part(product.milled.zero)
        except FileError as error:
            hint = "" if said.version else f"; it is read as a program for {machine.name}"
            return (failed("program", f"{error}{hint}"),)
        unit = NAMES.get(program.mm_per_unit, "unknown")
        checks = [unit_check(unit, reading)]
        checks += [_without(program, name, *concerns) for name, concerns in CONCERNS.items()]
        compensated = (*_compensation(product, program, machine),)
        checks += compensated
        rest = 0.0
        if all(check.ok for check in compensated):
            program, rest = centred(product.milled.cuts, program, machine)
        mismatch = max((move.mismatch for move in program.moves), default=0.0)
        note = "radii of an arc at its two ends"
        checks.append(at_most("arc ends", mismatch, limits.radius_tolerance, "mm", note=note))
        blending = program.blending + program.naive_cam
        note = "" if math.isfinite(blending) else "G64 without P sets no bound"
        checks.append(at_most("path blending", blending, tolerance, "mm", note=note))
        arcs = any(move.kind == "arc" for move in program.moves)
        extra = blending + rest + (limits.interpolation if arcs else 0.0)
        checks += _paths(product, program, tolerance, extra)
        if all(check.ok is not False for check in checks):  # else it is told where it goes wrong
            checks += simulation_checks(product, program, tolerance)
        return tuple(checks)

    def worked(self, product: Product, data: bytes, machine: Machine) -> tuple[LineFinding, ...]:
        """What a program of any origin does to the blank and the part of a scene, by line; nothing
        of one whose path is not known.
        """
        program = run_bytes(data, machine, Bench())
        side = _side(product, stated(program.comments).second)
        if side is None:
            note = "it is for a second side, which the scene does not have"
            return (LineFinding(0, "unknown-side", WORK, note),)
        if program.compensated is not None or any(
            each.concerns in ("words", "path") for each in program.findings
        ):
            return ()
        return work_findings(side, program.in_the_part(side.milled.zero))


def _side(product: Product, second: bool) -> Product | None:
    """The side that a program mills, which says whether it is the second, unless it is known; None
    if there is no such side.
    """
    sides = sides_of(product)
    if len(sides) == 1:
        return product if product.second_side or not second else None
    return sides[second]


def _compensation(product: Product, program: Run, machine: Machine) -> Iterator[Check]:
    """Programs of ours are compensated as they are to be; of others the offsets are not known."""
    move, cuts = program.compensated, product.milled.cuts
    if not stated(program.comments).version:
        if move is not None:
            note = f"line {move.line}: the control keeps the cutter off the path by what it knows"
            yield failed("compensation", note)
    elif fault := fault_of(cuts, program, machine, stated(program.comments)):
        yield failed("compensation", fault)
    elif move is not None:
        for cut, most in zip(filter(side_of, cuts), stated(program.comments).offsets, strict=True):
            note = f"its offset may be {most:g} mm off, either way"
            yield Check("compensation", cut.name, mode_of(cut), ok=True, note=note)


def _without(program: Run, name: str, *concerns: str) -> Check:
    """The check that no finding of the interpreter concerns one of these."""
    try:
        program.refuse(*concerns)
    except FileError as error:
        return failed(name, str(error))
    return Check(name, "", counted(len(program.moves), "move"), ok=True)


def _paths(product: Product, program: Run, tolerance: float, extra: float) -> list[Check]:
    """Every operation runs its closed path at each of its depths, and no other."""
    centres = tuple(cut.centre for cut in product.milled.contour_cuts)
    exact = shapes_of(centres, product.drawn.base_radius, tolerance)
    # The area within a cutter's path is of no interest.
    shapes = {
        cut.name: replace(shape, name=cut.name, deviation=partial(beyond_slack, cut), area=None)
        for cut, shape in zip(product.milled.contour_cuts, exact, strict=True)
    }
    areas = {cut.name: cut for cut in product.milled.cuts if isinstance(cut, AreaCut | LetterCut)}
    others = {cut.name for cut in product.milled.cuts} - set(shapes)
    found = [loop for loop in program.loops(tolerance) if loop.operation not in others]
    loops = [(_owner(loop, shapes), loop) for loop in found]
    checks: list[Check] = []
    for name, area in areas.items():
        short = too_near(area, [move for move in program.moves if move.operation == name])
        checks.append(at_most("wall", short, tolerance, "mm", name))
    for cut in product.milled.contour_cuts:
        own = [loop for name, loop in loops if name == cut.name]
        checks.append(_passes(cut, own, max(program.step, tolerance)))
        same: dict[bytes, list[Loop]] = {}
        for loop in own:
            same.setdefault(_key(loop.contour), []).append(loop)
        for alike in same.values():
            heights = sorted((loop.z for loop in alike), reverse=True)
            where = (
                "" if len(heights) == len(own) else f"Z {', '.join(f'{z:g}' for z in heights)} mm"
            )
            contour = alike[0].contour
            mismatch = extra + max(loop.mismatch for loop in alike)
            checks += contour_checks(
                shapes[cut.name], contour, tolerance, extra=mismatch, where=where
            )
    for name, loop in loops:
        if name not in shapes:
            note = f"a closed path at Z {loop.z:g} mm belongs to no operation of the part"
            checks.append(failed("operations", note, name))
    return checks


def _key(contour: Contour) -> bytes:
    return contour.vertices.tobytes() + contour.sweeps.tobytes()


def _passes(cut: ContourCut, loops: list[Loop], slack: float) -> Check:
    """One closed path at each depth."""
    depths = np.array(cut.depths)
    missing = depths[~near(depths, (loop.z for loop in loops), slack)].tolist()
    count = len(depths)
    found = f"{count - len(missing)} of {count}"
    note = f"no closed path at Z {', '.join(f'{z:g}' for z in missing)} mm" if missing else ""
    level = np.array([loop.z for loop in loops if loop.level])
    stray = level[~near(level, cut.depths, slack)]
    if len(stray) and not missing:
        note = f"a closed path at Z {stray[0]:g} mm, which is not one of its depths"
    return Check("passes", cut.name, found, ok=not note, note=note)


def _owner(loop: Loop, shapes: dict[str, Shape]) -> str:
    """The operation that a loop belongs to: the one it names, else the one closest in length."""
    if loop.operation in shapes or not shapes:
        return loop.operation
    length = loop.contour.length
    return min(shapes, key=lambda name: abs(shapes[name].length - length))


def near(z: FloatArray, heights: Iterable[float], slack: float) -> BoolArray:
    """(n,) whether each of `z` (n,) is one of `heights` within a `slack` [mm]."""
    known = np.sort(np.array([*heights, -np.inf, np.inf]))
    place = np.clip(np.searchsorted(known, z), 1, len(known) - 1)  # which NaN exceeds
    found: BoolArray = (z - known[place - 1] <= slack) | (known[place] - z <= slack)
    return found


VERIFIER = GcodeVerifier()
