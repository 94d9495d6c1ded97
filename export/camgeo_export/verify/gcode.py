"""Verification of milling programs: our own, and others that use only the words we read.

Each closed path is measured, and the program simulated as it is written: its moves take the blank
down to the part.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby
from types import MappingProxyType
from typing import Final

import numpy as np
import shapely

from camgeo.design.linting import LineFinding, WorkData
from camgeo.design.milled import job
from camgeo.design.product import Product, product_sides, side_programs
from camgeo.design.verify import (
    Check,
    Origin,
    ReadingOptions,
    at_most,
    failed,
    parse_tolerance,
    reported,
    unit_check,
)
from camgeo.errors import FileError, SceneError
from camgeo.geometry.contour.contour import HALF_TURN, Contour, Pieces, distances, least_distance
from camgeo.geometry.contour.spline import SplineContour
from camgeo.milling.bench import Bench as Workbench
from camgeo.milling.compensation import compensation_mode, compensation_side
from camgeo.milling.cut import AreaCut, ContourCut, Cut, LetterCut
from camgeo.milling.judged import (
    Side,
    SimulatedSide,
    side_flaws,
    simulate_sides,
    tool_run,
    toolpath_runs,
)
from camgeo.milling.machine import Machine, load
from camgeo.milling.milling import END_MILL, WEAR, MillingSpec, Tool
from camgeo.milling.moves import ArcFeed, Course, Feed, Move, Point, Rapid, feed_course
from camgeo.milling.plan import inside
from camgeo.milling.simulation import ALLOWED, Flaw, Setup, ToolRun
from camgeo.milling.track import Track, track_along
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, joined, taken
from camgeo.reading import PROGRAM, check_text
from camgeo.scene.formats.gcode import FORMAT
from camgeo.units import MM_PER, counted
from camgeo_export.interpreter.moves import (
    CutterMove,
    Enough,
    Findings,
    Loop,
    Radius,
    check_compensation,
)
from camgeo_export.interpreter.moves import ProgramRun as Program
from camgeo_export.interpreter.run import run
from camgeo_export.reading import NUMBER_SLACK, text_tokens
from camgeo_export.verify.plane import Shape, boundary_shapes, contour_checks

NAMES = {1.0: "mm", 25.4: "inch"}


CONCERNS = {"arcs": ("form",), "safety": ("safety",), "frame": ("frame", "limits")}
"""Checks of what the interpreter reports, apart from an unknown path, with their concerns."""


class GcodeVerifier:
    """Verifies a milling program."""

    format = "gcode"
    slack = NUMBER_SLACK
    tokens = staticmethod(text_tokens)

    def origin(self, data: bytes) -> Origin:
        """The origin that the comments state."""
        try:
            check_text(data, PROGRAM, "the file")
        except FileError as error:
            return Origin(damage=str(error))
        notes = parse_notes(comment_texts(data.decode("ascii", "replace")))
        return Origin(notes.version, notes.scene, notes.tolerance)

    def checks(
        self, product: Product, data: bytes, reading: ReadingOptions, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, safety, every operation at each depth, each closed path against its exact one."""
        if lacking := FORMAT.lacking(product.values):
            note = f"the scene {' and '.join(lacking)} to be compared with a program"
            return (failed("operations", note),)
        notes = parse_notes(comment_texts(data.decode("ascii", "replace")))
        if (side := _side(product, notes.second)) is None:
            return (failed("program", "it mills a second side, which the scene does not have"),)
        programs = side_programs(side)
        if len(programs) > 1 and not 1 <= notes.program <= len(programs):
            note = f"its comments do not say which of the {len(programs)} programs it is"
            return (failed("program", note),)
        product = programs[notes.program - 1 if len(programs) > 1 else 0]
        machine = load(product.milled.gcode.machine)
        limits = machine.arcs
        bench = program_bench(product, machine) if notes.version else WorkData()
        try:
            program = run(data, machine, bench, fatal=("words", "path"))
            program.refuse("words", "path")
            program = program.in_the_part(product.milled.zero)
        except FileError as error:
            hint = "" if notes.version else f"; it is read as a program for {machine.name}"
            return (failed("program", f"{error}{hint}"),)
        compensated = (*_compensation(product, program, machine),)
        checks = [
            unit_check(NAMES.get(program.mm_per_unit, "unknown"), reading),
            *(_without(program, name, *concerns) for name, concerns in CONCERNS.items()),
            *compensated,
        ]
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
        if all(check.ok is not False for check in checks):  # else the fault is reported already
            checks += simulation_checks(product, program, tolerance)
        return tuple(checks)

    def worked(self, product: Product, data: bytes, machine: Machine) -> tuple[LineFinding, ...]:
        """What a program of any origin does to the blank and the part of a scene, by line; nothing
        of one whose path is not known.
        """
        program = run(data, machine, WorkData())
        side = _side(product, parse_notes(program.comments).second)
        if side is None:
            note = "it mills a second side, which the scene does not have"
            return (LineFinding(0, "unknown-side", WORK, note),)
        if program.compensated is not None or any(
            finding.concerns in ("words", "path") for finding in program.findings
        ):
            return ()
        return work_findings(side, program.in_the_part(side.milled.zero))


def _side(product: Product, second: bool) -> Product | None:
    """The side that a program mills, which says whether it is the second, unless it is known; None
    if there is no such side.
    """
    sides = product_sides(product)
    if len(sides) == 1:
        return product if product.second_side or not second else None
    return sides[second]


def _compensation(product: Product, program: Program, machine: Machine) -> Iterator[Check]:
    """The checks that a program of ours has the radius compensation that its cuts ask for; of other
    programs the offsets are not known.
    """
    move, cuts = program.compensated, product.milled.cuts
    if not parse_notes(program.comments).version:
        if move is not None:
            yield failed(
                "compensation",
                f"line {move.line}: the controller offsets the cutter from the path by a value that"
                " the program does not state",
            )
    elif fault := compensation_fault(cuts, program, machine, parse_notes(program.comments)):
        yield failed("compensation", fault)
    elif move is not None:
        for cut, most in zip(
            filter(compensation_side, cuts), parse_notes(program.comments).offsets, strict=True
        ):
            note = f"its offset may be {most:g} mm off in either direction"
            yield Check("compensation", cut.name, compensation_mode(cut), ok=True, note=note)


def _without(program: Program, name: str, *concerns: str) -> Check:
    """The check that no finding of the interpreter has one of these concerns."""
    try:
        program.refuse(*concerns)
    except FileError as error:
        return failed(name, str(error))
    return Check(name, "", counted(len(program.moves), "move"), ok=True)


def _paths(product: Product, program: Program, tolerance: float, extra: float) -> list[Check]:
    """Checks that every operation runs its closed path at each of its depths, and no other."""
    centres = tuple(cut.centre for cut in product.milled.contour_cuts)
    exact = boundary_shapes(centres, product.drawn.base_radius, tolerance)
    # The area within a cutter's path is of no interest.
    shapes = {
        cut.name: replace(shape, name=cut.name, deviation=partial(beyond_slack, cut), area=None)
        for cut, shape in zip(product.milled.contour_cuts, exact, strict=True)
    }
    areas = {cut.name: cut for cut in product.milled.cuts if isinstance(cut, AreaCut | LetterCut)}
    others = {cut.name for cut in product.milled.cuts} - set(shapes)
    closed_paths = [loop for loop in program.loops(tolerance) if loop.operation not in others]
    loops = [(_owner(loop, shapes), loop) for loop in closed_paths]
    checks: list[Check] = []
    for name, area in areas.items():
        short = too_near(area, [move for move in program.moves if move.operation == name])
        checks.append(at_most("wall", short, tolerance, "mm", name))
    for cut in product.milled.contour_cuts:
        cut_loops = [loop for name, loop in loops if name == cut.name]
        checks.append(_passes(cut, cut_loops, max(program.step, tolerance)))
        # Passes at several depths along the same path are compared once.
        same: dict[bytes, list[Loop]] = {}
        for loop in cut_loops:
            shape = loop.contour.vertices.tobytes() + loop.contour.sweeps.tobytes()
            same.setdefault(shape, []).append(loop)
        for alike in same.values():
            heights = sorted((loop.z for loop in alike), reverse=True)
            where = (
                ""
                if len(heights) == len(cut_loops)
                else f"Z {', '.join(f'{z:g}' for z in heights)} mm"
            )
            contour = alike[0].contour
            mismatch = extra + max(loop.mismatch for loop in alike)
            checks += contour_checks(
                shapes[cut.name], contour, tolerance, extra=mismatch, where=where
            )
    for name, loop in loops:
        if name not in shapes:
            note = f"a closed path at Z {loop.z:g} mm does not belong to any operation of the part"
            checks.append(failed("operations", note, name))
    return checks


def _passes(cut: ContourCut, loops: list[Loop], slack: float) -> Check:
    """The check that there is one closed path at each depth."""
    depths = np.array(cut.depths)
    missing = depths[~near(depths, (loop.z for loop in loops), slack)].tolist()
    count = len(depths)
    passes = f"{count - len(missing)} of {count}"
    note = f"no closed path at Z {', '.join(f'{z:g}' for z in missing)} mm" if missing else ""
    level = np.array([loop.z for loop in loops if loop.level])
    stray = level[~near(level, cut.depths, slack)]
    if len(stray) and not missing:
        note = f"a closed path at Z {stray[0]:g} mm, which is not one of its depths"
    return Check("passes", cut.name, passes, ok=not note, note=note)


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
    return np.asarray((z - known[place - 1] <= slack) | (known[place] - z <= slack))


VERIFIER = GcodeVerifier()


# -- simulation ------------------------------------------------------------------------------------
NAME: Final = "simulation"

UNFED: Final = 1.0
"""Feed [mm/min] of cuts before any is programmed; the material does not depend on it."""


def simulation_checks(product: Product, program: Program, tolerance: float) -> list[Check]:
    """Checks that the program leaves the part, and does nothing forbidden on the way.

    One check, or one for each flaw. The path may lie within `tolerance` [mm] of the exact one.
    """
    if program.compensated is not None:
        return [reported(NAME, "none", note="the controller computes the path of the cutter")]
    try:
        traces = trace_program(product, program, product.milled.cuts)
        runs = _among_others(product, tuple(trace.run for trace in traces), tolerance)
    except FileError as error:
        return [failed(NAME, str(error))]
    whole = product.milled if product.milled.whole is None else product.milled.whole
    level = program.step if math.isfinite(program.step) else 0.0
    sides = job(whole, whole.cuts, runs, tolerance, level=level)
    reports = [
        (flaw, flaw.sentence if side.side.runs is runs else f"of the other side, {flaw.sentence}")
        for side, flaws in zip(sides, side_flaws(sides), strict=True)
        for flaw in flaws
    ]
    if wrong := [(flaw, text) for flaw, text in reports if not flaw.watched]:
        return [failed(NAME, text, flaw.operation) for flaw, text in wrong]
    names = {run.name for run in runs}
    checks = [Check(NAME, "", counted(len(names), "operation"), ok=True)]
    return checks + [Check(NAME, flaw.operation, ok=None, note=text) for flaw, text in reports]


def _among_others(
    product: Product, runs: tuple[ToolRun, ...], tolerance: float
) -> tuple[ToolRun, ...]:
    """The runs of one of several programs, among those that the others should have."""
    whole = product.milled.whole
    if whole is None:
        return runs
    names = {cut.name for cut in product.milled.cuts}
    planned = toolpath_runs(whole.toolpath(tolerance))
    first = next(k for k, operation in enumerate(planned) if operation.name in names)
    others = [operation for operation in planned if operation.name not in names]
    return (*others[:first], *runs, *others[first:])


def _spec(product: Product) -> MillingSpec:
    spec = product.milled.spec
    assert spec is not None  # for the scene has a tool
    return spec


@dataclass(frozen=True, slots=True)
class Trace:
    """What a tool of a program does in one operation.

    Attributes
    ----------
    run : its moves.
    tool : that runs them.
    lines : of the program, one for each move.
    """

    run: ToolRun
    tool: Tool
    lines: tuple[int, ...]


def trace_program(product: Product, program: Program, cuts: Iterable[Cut]) -> tuple[Trace, ...]:
    """What each tool of a program does, operation by operation, with its lines; `cuts` are those
    that it may name.

    Moves from and to places that the program has not stated are left out; the machine's reference
    is above all other heights.

    Raises
    ------
    FileError
        If a tool cuts that the scene does not have.
    """
    spec = _spec(product)
    tools = {tool.number: tool for tool in spec.tools}
    clamps = () if spec.holding is None else spec.holding.clamps
    always = tuple(clamp.obstacle for clamp in clamps if not (clamp.since or clamp.until))
    named = {cut.name: cut for cut in cuts}
    # The reference of the machine is infinitely high; a height above all others stands for it.
    heights = [abs(z) for move in program.moves for z in (move.z_start, move.z_end)]
    above = max(filter(math.isfinite, heights), default=0.0)
    above = max(above, product.milled.gcode.heights.clearance)
    traces = []
    for (name, number), group in groupby(program.moves, lambda move: (move.operation, move.tool)):
        moves = list(group)
        cut = named.get(name)
        known = cut.tool if cut is not None and cut.tool.number == number else tools.get(number)
        if known is None and all(move.kind == "rapid" for move in moves):
            continue  # above the blank, before the first tool
        if known is None:
            line = next(move.line for move in moves if move.kind != "rapid")
            what = f"tool {number} is not a tool of the scene" if number else "no tool was called"
            raise FileError(f"line {line}: {what}")
        obstacles = always if cut is None else cut.obstacles  # those that neither come nor go
        title = name or f"tool {number}"
        for start, chain, lines in _chains(moves, above):
            traces.append(Trace(tool_run(known, title, chain, obstacles, start), known, lines))
    return tuple(traces)


def _chains(
    moves: Sequence[CutterMove], above: float
) -> Iterator[tuple[Point, tuple[Move, ...], tuple[int, ...]]]:
    """Moves that join, with their starts and their lines."""
    steps = (_step(move, above) for move in moves)
    for _, group in groupby(steps, lambda step: step is None):
        chain = [step for step in group if step is not None]
        if chain:
            numbered_moves = [(move, line) for _, parts, line in chain for move in parts]
            yield (
                chain[0][0],
                tuple(move for move, _ in numbered_moves),
                tuple(line for _, line in numbered_moves),
            )


def _step(move: CutterMove, above: float) -> tuple[Point, list[Move], int] | None:
    """The start of a move, its parts and its line; None if one of its ends is not known."""
    begin, end = _point(move.start, move.z_start, above), _point(move.end, move.z_end, above)
    if begin is None or end is None:
        return None
    return begin, list(_moves(move, begin, end)), move.line


def _point(place: complex, z: float, above: float) -> Point | None:
    """A place [mm]; None if it is not known."""
    if cmath.isnan(place) or math.isnan(z):
        return None
    return (float(place.real), float(place.imag), float(z) if math.isfinite(z) else above)


def _moves(move: CutterMove, start: Point, end: Point) -> Iterator[Move]:
    """The moves of a path as toolpaths have them, arcs of half a revolution at most."""
    if move.kind == "rapid":
        yield Rapid(end)
        return
    feed = float(move.feed) or UNFED
    if not move.sweep:
        yield Feed(end, feed)
        return
    arcs = move.course.split(HALF_TURN)
    for k, arc in enumerate(arcs, start=1):
        share = k / len(arcs)
        z = end[2] if k == len(arcs) else start[2] + share * (end[2] - start[2])
        place, centre = complex(arc.end), complex(arc.centre)
        end_of_arc = (place.real, place.imag, z)
        yield ArcFeed(end_of_arc, (centre.real, centre.imag), arc.sweep > 0.0, feed)


# -- lines ----------------------------------------------------------------------------------------
# What a program of any origin does to the blank of a scene, by line.


WORK: Final = "work"
"""What these findings concern."""

RULES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "rapid": "rapid-in-material",
        "plunge": "plunge",
        "gouge": "gouged-part",
        "obstacle": "collision",
        "depth": "too-low",
        "shank": "shank",
        "loose": "loose-piece",
        "rest": "rest",
    }
)
"""Rules by the names of flaws."""

DEEPER: Final = 1e-3
"""By how much a depth may exceed what is stated [mm]: heights are printed rounded."""


def work_findings(product: Product, program: Program) -> tuple[LineFinding, ...]:
    """What the tools of the scene, run as the program says, do to its blank and its part."""
    cuts = _cuts(product)
    try:
        traces = trace_program(product, program, cuts)
    except FileError as error:
        place, _, what = str(error).rpartition(": ")
        line = int(place.removeprefix("line ")) if place else 0
        return (LineFinding(line, "unknown-tool", WORK, what),)
    if not traces:
        return ()
    # Flaws are reported once for each name of a run, so each run gets one of its own.
    runs = tuple(replace(trace.run, name=f"{k} {trace.run.name}") for k, trace in enumerate(traces))
    sides = _simulate_sides(
        product, cuts, runs, program.step if math.isfinite(program.step) else 0.0
    )
    bench = Workbench(product.milled.part, _spec(product))
    findings = []
    for side, flaws in zip(sides, side_flaws(sides), strict=True):
        in_program = side.side.runs is runs
        for flaw, seen in zip(side.simulation.flaws, flaws, strict=True):
            if in_program and not seen.watched:
                findings.append(_finding(flaw, seen, traces, bench))
            elif not seen.watched:  # as it is planned, or what is left after both sides
                findings.append(
                    LineFinding(0, RULES[seen.name], WORK, f"of the other side, {seen.sentence}")
                )
        findings += _too_deep(side.setup, traces) if in_program else ()
    return tuple(sorted(findings, key=lambda finding: finding.line or math.inf))


def _simulate_sides(
    product: Product, cuts: tuple[Cut, ...], runs: tuple[ToolRun, ...], level: float
) -> tuple[SimulatedSide, ...]:
    """Simulates both sides of the job, or the only one, even if the scene itself cannot plan it."""
    milled = product.milled
    try:
        return job(milled, cuts, runs, product.scene.output.tolerance, level=level, allowed=ALLOWED)
    except SceneError:
        side = Side(milled.part, _spec(product), cuts, runs)
        return simulate_sides([side], allowed=ALLOWED, level=level, side_count=1)


def _cuts(product: Product) -> tuple[Cut, ...]:
    """The cuts that the scene plans; if its tools cannot make them, stand-ins along every wall."""
    try:
        return product.milled.cuts
    except SceneError:
        return tuple(
            ContourCut(
                name=wall.boundary.name,
                strategy="profile",
                tool=_spec(product).tools[0],
                top=wall.z1,
                depths=(wall.z0,),
                centre=wall.boundary,
                right=wall.boundary.name,
            )
            for wall in product.milled.part.walls
        )


def _finding(flaw: Flaw, seen: Flaw, traces: Sequence[Trace], bench: Workbench) -> LineFinding:
    """The finding on a flaw, with its line; `seen` is the flaw with its place as the work lies."""
    number, _, name = flaw.operation.partition(" ")
    trace = traces[int(number)]
    what = seen.sentence.removeprefix(f"{flaw.operation}: ")
    reason = _too_large(flaw, trace.tool, bench) if flaw.name in ("gouge", "rest") else ""
    what = f"{name}: {what}; {reason}" if reason else f"{name}: {what}"
    return LineFinding(_line(flaw, trace), RULES[flaw.name], WORK, what)


def _too_large(flaw: Flaw, tool: Tool, bench: Workbench) -> str:
    """Why the tool is too large for the wall at the place of a flaw; empty if it is not."""
    place = np.array([complex(*flaw.place[:2])])
    contours = [wall.boundary.arcs(ALLOWED, "fast").contour for wall in bench.part.walls]
    away = [float(distances(place, Track.around(contour))[0]) for contour in contours]
    return bench.too_large(tool, bench.part.walls[int(np.argmin(away))].boundary)


def _line(flaw: Flaw, trace: Trace) -> int:
    """The first line of a run that reaches the place and the depth of a flaw; 0 if none does."""
    run = trace.run
    if flaw.name == "rest":
        return 0
    if flaw.name == "loose":
        lined = zip(trace.lines, run.moves, strict=True)
        return max((line for line, move in lined if not isinstance(move, Rapid)), default=0)
    moves = [Feed(move.end, 1.0) if isinstance(move, Rapid) else move for move in run.moves]
    course = feed_course(moves, run.start)
    rapid = np.array([isinstance(move, Rapid) for move in run.moves])
    wanted = rapid[course.moves] == (flaw.name == "rapid")
    x, y, z = flaw.place
    away = course.distances(np.full(len(course), complex(x, y)))
    away = np.where(wanted & (course.lowest <= z + DEEPER), away, np.inf)
    if not np.any(np.isfinite(away)):
        return 0
    touching = np.flatnonzero(away <= max(run.radius, float(np.min(away))) + ALLOWED)
    return trace.lines[int(course.moves[touching[0]])]


def _too_deep(setup: Setup, traces: Sequence[Trace]) -> Iterator[LineFinding]:
    """The first move of each run that digs deeper than its tool may, for each limit."""
    reported: set[tuple[int, str]] = set()
    for depth in depths(setup, [trace.run for trace in traces]):
        trace = traces[depth.run]
        limits = _limits(trace.tool, depth) if trace.tool.kind == END_MILL else ()
        for rule, value, limit, what in limits:
            if limit is not None and value > limit + DEEPER and (depth.run, rule) not in reported:
                reported.add((depth.run, rule))
                x, y, _ = depth.place
                text = f"{trace.run.name}: {what} at X {x:.4g}, Y {y:.4g} mm"
                line = trace.lines[depth.move]
                yield LineFinding(line, rule, WORK, text, f"{value:.4g} mm", f"{limit:g} mm")


def _limits(tool: Tool, depth: Depth) -> tuple[tuple[str, float, float | None, str], ...]:
    """Rule, depth, limit if any and words for what an end mill must not do."""
    return (
        ("slot-depth", depth.ahead, tool.stepdown, "a slot deeper than the tool's stepdown"),
        ("flute-length", depth.engagement, tool.flute_length, "deeper than the cutting edges are"),
        (
            "holder",
            depth.engagement,
            tool.stick_out,
            "deeper than the tool sticks out of its holder",
        ),
    )


# -- reach ----------------------------------------------------------------------------------------
# How much material stands before and beside a cutter: against its stepdown and its edges.
#
# Every feed move is judged at its end and in its middle, in front of the cutter and on both sides:
# there the material reaches from the tip up to what moves before it have left, exactly. In front of
# a cutter it stands as deep as the cutter digs a slot.


SHARES: Final = (0.5, 1.0)
"""Places along each piece at which the cutter is judged, as shares of its length."""

RIM: Final = 1e-3
"""Share of the radius by which the places looked at lie inside the cutter ahead, and outside on its
sides; what lies twice that inside those that came by before counts as cleared."""

SIDES: Final = np.array([1.0 - RIM, -1j * (1.0 + RIM), 1j * (1.0 + RIM)])
"""Places that are looked at, in radii, seen in the direction of the cutter."""

BATCH: Final = 64
"""Places that are compared with the courses at once."""


@dataclass(frozen=True, slots=True)
class Depth:
    """The deepest material at a cutter in one run.

    Attributes
    ----------
    run, move : numbers of the run, and of the move in it.
    ahead : depth of the slot that the cutter digs [mm].
    engagement : height of the material above the tip, ahead or on a side [mm].
    place : of the tip.
    """

    run: int
    move: int
    ahead: float
    engagement: float
    place: Point


def depths(setup: Setup, runs: Sequence[ToolRun]) -> Iterator[Depth]:
    """The material at the cutter in each feed move that is not straight up or down."""
    courses = [feed_course(run.moves, run.start) for run in runs]
    if not any(len(course) for course in courses):
        return
    whole = joined(courses)
    owners = np.concatenate([np.full(len(course), k) for k, course in enumerate(courses)])
    radii = np.array([run.radius for run in runs])[owners]
    standing = _standing(setup)
    moving = np.flatnonzero(whole.lengths > 0.0)
    for first in range(0, len(moving), BATCH):
        yield from _piece_depths(
            moving[first : first + BATCH], whole, owners, radii, standing
        )  # fmt: skip


def _standing(setup: Setup) -> Callable[[ComplexArray], FloatArray]:
    """The Z [mm] up to which material reaches at places (n,) at first; -infinite beside it."""
    if setup.leftover is None:
        blank = Pieces.around(setup.blank)
        return lambda places: np.where(inside(blank, places), setup.top, -np.inf)
    slabs = setup.leftover.slabs

    def left(places: ComplexArray) -> FloatArray:
        heights = np.full(len(places), -np.inf)
        for slab in slabs:  # from the lowest
            heights[shapely.contains_xy(slab.material, places.real, places.imag)] = slab.z1
        return heights

    return left


def _piece_depths(
    pieces: np.ndarray[tuple[int], np.dtype[np.intp]],
    whole: Course,
    owners: np.ndarray[tuple[int], np.dtype[np.intp]],
    radii: FloatArray,
    standing: Callable[[ComplexArray], FloatArray],
) -> Iterator[Depth]:
    """The material at the cutter on some pieces of the course, in their order."""
    numbers = np.repeat(pieces, len(SHARES))
    shares = np.tile(SHARES, len(pieces))
    some = taken(whole, numbers)
    places, tips = some.points_by_share(shares), some.from_z + shares * (some.to_z - some.from_z)
    # The radius of the cutter in its direction, which `SIDES` turns to the places looked at.
    rims = radii[numbers] * some.tangents(places)
    looked = (places[:, None] + rims[:, None] * SIDES).ravel()
    order = np.repeat(numbers, len(SIDES))
    tops = standing(looked)
    cleared = _cleared(whole, _near(whole, looked, radii), looked, order, radii)
    material = np.minimum(tops, cleared).reshape(-1, len(SIDES)) - tips[:, None]
    for k, piece in enumerate(numbers.tolist()):
        tip = (float(places[k].real), float(places[k].imag), float(tips[k]))
        ahead, engagement = max(0.0, float(material[k, 0])), max(0.0, float(np.max(material[k])))
        yield Depth(int(owners[piece]), int(whole.moves[piece]), ahead, engagement, tip)


def _near(whole: Course, places: ComplexArray, radii: FloatArray) -> BoolArray:
    """(n,) which pieces may come within their radius of one of `places`."""
    middle = 0.5 * (whole.starts + whole.ends)
    half = 0.5 * np.abs(whole.ends - whole.starts)
    centre = complex(np.mean(places))
    wide = float(np.max(np.abs(places - centre)))
    return np.asarray(np.abs(middle - centre) <= half + radii + wide)


def _cleared(
    whole: Course,
    near: BoolArray,
    places: ComplexArray,
    order: np.ndarray[tuple[int], np.dtype[np.intp]],
    radii: FloatArray,
) -> FloatArray:
    """(k,) lowest Z [mm] of a tip that passed over each place before; infinite if none did."""
    picked = np.flatnonzero(near)
    some = taken(whole, picked)
    passed = some.distances(places[:, None]) < (1.0 - 2.0 * RIM) * radii[picked]
    passed &= picked[None, :] < order[:, None]
    return np.asarray(
        np.min(np.where(passed, some.lowest[None, :], np.inf), axis=1, initial=np.inf)
    )


# -- measure --------------------------------------------------------------------------------------
# A program run again and compared with the exact cutter path.


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of the cutter from its exact path.

    Of a roughing cut only what exceeds its slack counts. Path blending is included, and how far the
    controller's own path departs from an arc.

    Raises FileError if the program is incomplete, unsafe or in the wrong unit.
    """
    machine = load(product.milled.gcode.machine)
    program = run(data, machine, program_bench(product, machine), most=1)
    program.refuse("words", "path")
    program = program.in_the_part(product.milled.zero)
    if program.mm_per_unit != MM_PER[product.unit]:
        raise FileError(f"the program is not in {product.unit}")
    program.refuse()
    notes, cuts = parse_notes(program.comments), product.milled.cuts
    if notes.tolerance is None:  # then it could not be verified later
        raise FileError("the program does not state its tolerance")
    if fault := compensation_fault(cuts, program, machine, notes):
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
            raise FileError(f"{name!r} comes {short:.3g} mm too close to a wall")
    path = max(
        (
            loop.mismatch + beyond_slack(along[loop.operation], loop.contour.counter_clockwise())
            for loop in loops
        ),
        default=0.0,  # there may be a face or a drilled hole alone
    )
    arcs = any(move.kind == "arc" for move in program.moves)
    interpolation = machine.arcs.interpolation if arcs else 0.0
    return path + rest + program.blending + program.naive_cam + interpolation


def beyond_slack(cut: ContourCut, contour: Contour | SplineContour) -> float:
    """Proved deviation [mm] of a counter-clockwise path from the exact one of a cut; of a roughing
    beyond its slack.
    """
    return max(0.0, cut.centre.deviation(contour) - cut.slack)


def program_bench(product: Product, machine: Machine) -> WorkData:
    """What the interpreter needs to know of the work of a program of ours: its blank, and its
    heights, which are printed rounded; all in the coordinates of the program.
    """
    heights, milling = product.milled.gcode.heights, product.milled.spec
    z = product.milled.zero.z
    step = 10.0 ** -machine.numbers.decimals.for_unit(product.unit) * MM_PER[product.unit]
    return WorkData(
        stock_top=(0.0 if milling is None else milling.stock.top) - z,
        clearance=heights.retract - z - 0.5 * step,
        operations=tuple(cut.name for cut in product.milled.cuts),
    )


def _check_complete(cuts: tuple[Cut, ...], program: Program, loops: list[Loop]) -> None:
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
    """By how much [mm] the cuts among `moves` come closer to a wall than the cutter's radius plus
    the allowance; 0 if none does.
    """
    groups = groupby(moves, lambda move: move.kind != "rapid" and move.start != move.end)
    tracks = [track_along([move.course for move in group]) for is_cut, group in groups if is_cut]
    least = [np.inf]
    for wall in cut.walls:
        fit = wall.arcs(FINE, "fast")
        around = Track.around(fit.contour)
        least += [least_distance(track, around) + fit.deviation for track in tracks]
    return float(max(0.0, cut.tool.radius + cut.allowance - min(least)))


# -- compensated ----------------------------------------------------------------------------------
# Whether a program of ours compensates for the cutter's radius as its cuts say.


def offset_function(cuts: Sequence[Cut], machine: Machine, excess: float = 0.0) -> Radius:
    """Gives the offset of each compensated move [mm] if the tool table holds the nominal radii, or
    as much more as `excess` [mm].
    """
    table = {
        cut.tool.number: _table_radius(cut, machine) + excess
        for cut in cuts
        if compensation_side(cut)
    }
    return lambda move: table[move.radius_offset] + move.oversize


def centred(cuts: Sequence[Cut], program: Program, machine: Machine) -> tuple[Program, float]:
    """A program along the cutter's centre, and by how much it is off that [mm].

    A nominal radius that is printed rounded leaves an offset below the last decimal.
    """
    offset = offset_function(cuts, machine)
    sizes = [abs(offset(move)) for move in program.moves if move.compensation]
    rest = max((size for size in sizes if size <= program.step), default=0.0)

    def printed(move: CutterMove) -> float:
        size = offset(move)
        return size if abs(size) > program.step else 0.0

    return program.centred(printed), rest


def _table_radius(cut: Cut, machine: Machine) -> float:
    """The radius [mm] that the table holds for the nominal cutter."""
    words = machine.compensation
    alone = compensation_mode(cut) == WEAR and (words is None or not words.nominal)
    return 0.0 if alone else cut.tool.radius


def compensation_fault(
    cuts: Sequence[Cut], program: Program, machine: Machine, notes: ProgramNotes
) -> str:
    """What is wrong with the compensation of a program; empty if nothing is.

    Every cut is compensated as it is to be, from a straight move to another one, with the offset
    of its tool; and the controller can run it with each offset that its comments allow.
    """
    compensated = [cut for cut in cuts if compensation_side(cut)]
    names = {cut.name for cut in compensated}
    for move in program.moves:
        if move.compensation and move.operation not in names:
            return (
                f"line {move.line}: radius compensation is on, which no cut of the scene asks for"
            )
    if not compensated:
        return ""
    if len(notes.offsets) != len(compensated):
        return "its comments do not say how far the offsets of its tools may be off"
    for cut, most in zip(compensated, notes.offsets, strict=True):
        moves = [move for move in program.moves if move.operation == cut.name]
        fault = _cut_fault(cut, moves, program.step, machine) or _offset_fault(
            cut, moves, machine, most
        )
        if fault:
            return fault
    return ""


def _cut_fault(cut: Cut, moves: Sequence[CutterMove], step: float, machine: Machine) -> str:
    side, tool = compensation_side(cut), cut.tool
    flat = [move for move in moves if move.kind != "rapid" and move.start != move.end]
    oversize = _table_radius(cut, machine) and compensation_mode(cut) == WEAR
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
            return f"line {move.line}: the oversize is {move.oversize:g} mm, not {expected:g} mm"
    return ""


def _offset_fault(cut: Cut, moves: Sequence[CutterMove], machine: Machine, most: float) -> str:
    """What a controller refuses with an offset that the comments allow; empty if nothing."""
    for excess in (0.0, most, -most):
        findings = Findings(1)
        try:
            check_compensation(moves, offset_function((cut,), machine, excess), findings)
        except Enough:
            return f"with an offset {excess:g} mm from its nominal value, {findings.reported[0]}"
    return ""


# -- comments --------------------------------------------------------------------------------------
# What the comments of a program state.


NOTE: Final = re.compile(r"\(([^()]*)\)|;(.*)")
"""A comment in brackets, or one up to the end of the line, in whatever dialect."""

NUMBER = r"([-+.\de]+)"

TOLERANCE = re.compile(rf"\btolerance (?:{NUMBER} inch, )?{NUMBER} mm", re.IGNORECASE)

PROGRAM_NUMBER = re.compile(
    r"program (\d{1,4}) of \d{1,4}, run in this order", re.ASCII | re.IGNORECASE
)

OFFSET = re.compile(
    r"\bcompensation (?:wear|control): .{1,200}?"
    rf"at most (?:{NUMBER} inch, )?{NUMBER} mm either way",
    re.IGNORECASE,
)

SCENE = re.compile(r"\bscene ((?:[0-9a-f]+ ?)+)", re.IGNORECASE)

SECOND_SIDE = "second side:"
"""How the comment begins that says that a program mills the second side."""

HASH_DIGITS = 64


@dataclass(frozen=True, slots=True, eq=False)
class ProgramNotes:
    """What the comments of a program state.

    Attributes
    ----------
    version : of camgeo, which wrote it; empty if they do not say so.
    scene : hash of the scene; empty if there is none.
    tolerance : [mm], or None.
    program : number from 1 where the machine needs one for each tool; 0 where it holds all.
    offsets : how far that of each compensated operation may be off [mm], in their order.
    second : whether it mills the second side.
    """

    version: str
    scene: str
    tolerance: float | None
    program: int = 0
    offsets: tuple[float, ...] = ()
    second: bool = False


def comment_texts(text: str) -> list[str]:
    """The comments in a text of any dialect, without brackets."""
    return [(bracketed or rest).strip() for bracketed, rest in NOTE.findall(text)]


def parse_notes(notes: Iterable[str]) -> ProgramNotes:
    """What `notes`, the comments of a program without brackets, state; long ones may be wrapped."""
    lines = [note.strip() for note in notes]
    text = " ".join(lines)
    scene, tolerance = SCENE.search(text), TOLERANCE.search(text)
    named = (re.match(r"camgeo (\S+)", line, re.IGNORECASE) for line in lines)
    versions = [match[1].rstrip(",").lower() for match in named if match]
    return ProgramNotes(
        versions[0] if versions else "",
        scene.group(1).replace(" ", "")[:HASH_DIGITS].lower() if scene else "",
        parse_tolerance(tolerance.group(2).lower()) if tolerance else None,
        int(one.group(1)) if (one := PROGRAM_NUMBER.search(text)) else 0,
        tuple(_size(most) for _, most in OFFSET.findall(text)),
        any(line.lower().startswith(SECOND_SIDE) for line in lines),
    )


def _size(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
