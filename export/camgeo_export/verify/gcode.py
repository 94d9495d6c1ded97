"""Verification of milling programs: our own, and others that use only the words we read."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby, pairwise, zip_longest
from typing import Final

import numpy as np

from camgeo.design.linting import Bench, LineFinding
from camgeo.design.product import Product, programs_of, sides_of
from camgeo.design.verify import Check, Origin, Reading, at_most, failed, unit_check
from camgeo.errors import FileError, ToleranceError
from camgeo.geometry.contour.contour import Contour, distances
from camgeo.milling.compensation import Limit, mode_of, side_of
from camgeo.milling.cut import AreaCut, ContourCut, Cut, LetterCut, PointCut
from camgeo.milling.machine import Machine, load
from camgeo.milling.moves import Heights, centre_feed
from camgeo.milling.tool import CONTROL
from camgeo.milling.track import Track
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.reading import PROGRAM, check_text
from camgeo.scene.formats.gcode import FORMAT
from camgeo.units import MM_PER, counted, place_text
from camgeo_export.gcode.comments import (
    FEED_DECIMALS,
    Grid,
    Stated,
    about_operation,
    about_program,
    budget,
    comment_texts,
    spelled,
    stated,
)
from camgeo_export.gcode.measure import bench_of, beyond_slack, centred, fault_of, too_near
from camgeo_export.gcode.moves import CutterMove, Loop
from camgeo_export.interpreter.run import Run, notes_of, run_bytes
from camgeo_export.reading import distances_from
from camgeo_export.verify.plane import SLOPE, Shape, contour_checks, shapes_of
from camgeo_export.verify.simulated import WORK, simulation_checks, work_findings

NAMES = {1.0: "mm", 25.4: "inch"}


CONCERNS = {"arcs": ("form",), "safety": ("safety",), "frame": ("frame", "limits")}
"""Checks of what the interpreter finds, apart from a path that it cannot tell."""


class GcodeVerifier:
    """Verifies a milling program."""

    format = "gcode"

    def origin(self, data: bytes) -> Origin:
        """From the comments."""
        try:
            check_text(data, PROGRAM, "the file")
        except FileError as error:
            return Origin(damage=str(error))
        said = stated(notes_of(data.decode("ascii", "replace")))
        return Origin(bool(said.version), said.scene, said.tolerance)

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
        bench = bench_of(product, machine) if reading.ours else Bench()
        try:
            program = run_bytes(data, machine, bench, fatal=("words", "path"))
            program.refuse("words", "path")
            program = program.in_the_part(product.milled.zero)
        except FileError as error:
            hint = "" if reading.ours else f"; it is read as a program for {machine.name}"
            return (failed("program", f"{error}{hint}"),)
        unit = NAMES.get(program.mm_per_unit, "unknown")
        checks = [unit_check(unit, reading, product.unit, f"the scene is in {product.unit}")]
        checks += [_without(program, name, *concerns) for name, concerns in CONCERNS.items()]
        compensated = (*_compensation(product, program, machine, reading),)
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
        if reading.ours:
            said = stated(program.comments)
            checks += cutting_checks(product, program, said, machine, spec.heights, tolerance)
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


def _compensation(
    product: Product, program: Run, machine: Machine, reading: Reading
) -> Iterator[Check]:
    """Programs of ours are compensated as they are to be; of others the offsets are not known."""
    move, cuts = program.compensated, product.milled.cuts
    if not reading.ours:
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
        allowed = tolerance + cut.slack
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
            if all(loop.operation == cut.name for loop in own):  # it is one of ours
                wanted = cut.cleared and cut.room > 0.0
                checks += lead_checks(
                    program, cut.name, contour, heights, allowed, climb=cut.climb, wanted=wanted,
                    across=mode_of(cut) == CONTROL,
                )  # fmt: skip
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


VERIFIER = GcodeVerifier()


# -- cutting --------------------------------------------------------------------------------------
# How one of our programs runs its tools: numbers, feeds, speeds, heights, and its comments.


COARSE: Final = 0.01
"""Tolerance [mm] of a wall by which the two halves of a loop are told apart."""

SLOWED = 1e-3
"""Share by which a feed that depends on a radius or a slope may be off: both are printed rounded,
and tiny arcs have few digits."""

PRINTED = 0.5 * 10.0**-FEED_DECIMALS * (1.0 + 1e-9)
"""Rounding of a printed speed or diameter, in its unit."""


def cutting_checks(
    product: Product,
    program: Run,
    stated: Stated,
    machine: Machine,
    heights: Heights,
    tolerance: float,
) -> list[Check]:
    """All checks of one of our programs that its closed paths do not show."""
    cuts = product.milled.cuts
    away = product.milled.gcode.tool_change_height
    checks = [_heights(program, heights, away), _comments(product, program, stated, machine)]
    checks += [_cutters(cuts, stated), _work_offset(product, program, machine)]
    for cut in cuts:
        own = [move for move in program.moves if move.operation == cut.name]
        cuts_of = [move for move in own if move.kind != "rapid"]
        checks += _of_cut(cut, cuts_of, program, machine, tolerance)
    return checks


def _heights(program: Run, heights: Heights, away: float | None) -> Check:
    """All traverses are at the clearance or the retract height, or that of tool changes, or lead
    there.
    """
    known = (heights.clearance, heights.retract, *(() if away is None else (away,)))
    for move in program.moves:
        off = min(abs(move.z_end - each) for each in known)
        high = off <= program.step or move.z_end == math.inf
        if move.kind == "rapid" and not high:
            note = (
                f"line {move.line}: a traverse to Z {move.z_end:g} mm, not {heights.clearance:g} mm"
            )
            return failed("traverses", note)
    return Check("traverses", "", f"at Z {heights.clearance:g} mm", ok=True)


def _of_cut(
    cut: Cut, moves: Sequence[CutterMove], program: Run, machine: Machine, tolerance: float
) -> list[Check]:
    """Tool, speed, feeds and heights of one operation."""
    tool, scale = cut.tool, program.mm_per_unit
    step = machine.numbers.feed_step("mm" if scale == MM_PER["mm"] else "inch")
    rounding = 0.5 * step * scale * (1.0 + 1e-9)
    turns = 0.5 if machine.spindle.whole_speed else PRINTED
    straight = [move for move in moves if _drops(move) and move.start == move.end]
    sinking = cut.sinking if isinstance(cut, PointCut) else tool.plunge_feed
    others = [move for move in moves if move not in straight]
    checks = [
        _same("tool", cut.name, ((each.tool, each.line) for each in moves), tool.number, "", 0.0),
        _same(
            "tool length", cut.name, ((each.offset, each.line) for each in moves), tool.number, "",
            0.0,
        ),
        _same(
            "spindle speed", cut.name, ((each.speed, each.line) for each in moves),
            tool.spindle_speed, "rev/min", turns,
        ),
        _same(
            "plunge feed", cut.name, ((each.feed, each.line) for each in straight), sinking,
            "mm/min", rounding,
        ),
        _feeds(cut, others, rounding, tolerance, program.step),
    ]  # fmt: skip
    if (stray := at_no_height(cut, moves, program.step)) is not None:
        note = f"line {stray.line}: a cut at Z {stray.z_end:g} mm, which is not one of its depths"
        return [*checks, failed("moves", note, cut.name)]
    lowest = min((move.z_end for move in moves), default=cut.bottom)
    if lowest > cut.bottom + program.step:
        note = f"no deeper than Z {lowest:g} mm, not Z {cut.bottom:g} mm"
        return [*checks, failed("moves", note, cut.name)]
    return checks


def _drops(move: CutterMove) -> bool:
    return move.z_end < move.z_start


def _feeds(
    cut: Cut, moves: Sequence[CutterMove], rounding: float, tolerance: float, step: float
) -> Check:
    """That the contact of each move runs at the tool's feed, no faster and no slower: the centre is
    slowed where the wall lies around its arc, and on the way down.
    """
    tool = cut.tool
    worst, line, value, wanted = 0.0, 0, tool.feed, tool.feed
    back = _on_the_way_back(cut, moves)
    for move, free in zip(moves, back, strict=True):
        least, most = _allowed(cut, move, tolerance, step)
        most = tool.feed if free else most
        off = max(least - move.feed, move.feed - most, 0.0)
        off = max(0.0, off - SLOWED * most) if move.feed < tool.feed else off
        if off > worst:
            worst, line, value, wanted = off, move.line, move.feed, most
    ok = worst <= rounding
    note = "" if ok else f"line {line}"
    return Check("feed", cut.name, float(value), float(wanted), rounding, "mm/min", ok, note)


def _on_the_way_back(cut: Cut, moves: Sequence[CutterMove]) -> list[bool]:
    """Which arcs of a trochoidal slot lead back to the wall, mostly through what loops have swept:
    where there is no contact the centre runs at the tool's feed.
    """
    if not isinstance(cut, AreaCut) or not cut.slot:
        return [False] * len(moves)
    wall = Track.around(cut.walls[0].arcs(COARSE, "fast").contour)
    starts, ends = (
        distances(np.array([getattr(move.course, end) for move in moves]), wall)
        for end in ("start", "end")
    )
    return [
        bool(move.sweep) and move.course.radius < cut.tool.radius and not _drops(move) and near
        for move, near in zip(moves, (ends < starts - COARSE).tolist(), strict=True)
    ]


def _allowed(cut: Cut, move: CutterMove, tolerance: float, step: float) -> tuple[float, float]:
    """The least and the largest feed [mm/min] that a move may have, one and the same on an arc.

    The wall lies around an arc that turns to the free side, and around each one between two walls.
    A line may stand for a piece of an arc that is flat within `tolerance` [mm]; then its feed is
    slowed for any radius from the least one that is as flat. Both ends of a ramp are printed in
    steps of `step` [mm], so a piece of few of them may slope otherwise than the ramp.
    """
    tool, length = cut.tool, move.course.length
    radius = move.course.radius if move.sweep else length * length / (8.0 * tolerance)
    slow = centre_feed(tool.feed, radius, cut.contact_radius, inside=True)
    both = isinstance(cut, ContourCut) and bool(cut.left)
    around = both or (move.sweep > 0.0) == cut.climb
    feeds = (slow if around or not move.sweep else tool.feed, tool.feed)
    if move.sweep and around:
        feeds = (slow, slow)
    if not _drops(move):
        return feeds
    drop, reach = move.z_start - move.z_end, math.sqrt(2.0) * step
    steepest, flattest = max(length - reach, 0.0) / (drop + step), math.inf
    if drop > step:
        flattest = (length + reach) / (drop - step)
    most = (tool.plunge_feed * math.hypot(1.0, each) for each in (steepest, flattest))
    least, largest = (min(feed, each) for feed, each in zip(feeds, most, strict=True))
    return least, largest


def _same(
    name: str,
    of: str,
    found: Iterable[tuple[float, int]],
    expected: float,
    unit: str,
    limit: float,
) -> Check:
    """That all values `found`, each with its line, are the `expected` one."""
    values = list(found)
    worst, line = max(values, key=lambda each: abs(each[0] - expected), default=(expected, 0))
    ok = abs(worst - expected) <= limit
    note = "" if ok else f"line {line}"
    return Check(name, of, float(worst), float(expected), limit, unit, ok, note)


def _work_offset(product: Product, program: Run, machine: Machine) -> Check:
    """All cuts are made with the work offset of the scene."""
    name = product.milled.gcode.work_offset or next(iter(machine.work_offsets))
    expected = machine.work_offsets.get(name, "")
    for move in program.moves:
        if move.kind != "rapid" and move.work_offset != expected:
            note = f"line {move.line}: a cut with {move.work_offset or 'no offset stated'}"
            return Check("work offset", "", move.work_offset, expected, ok=False, note=note)
    return Check("work offset", "", expected, expected, ok=True)


def _cutters(cuts: Sequence[Cut], stated: Stated) -> Check:
    """The cutters that its comments name are those that it is computed for."""
    wanted = {cut.tool.number: cut.tool.diameter for cut in cuts}
    named = dict(stated.tools)
    text = "; ".join(f"tool {number} of {size:g} mm" for number, size in stated.tools)
    expected = "; ".join(f"tool {number} of {size:g} mm" for number, size in wanted.items())
    same = named.keys() == wanted.keys() and all(
        abs(named[number] - size) <= PRINTED for number, size in wanted.items()
    )
    if same:
        return Check("cutters", "", text, expected, ok=True)
    return failed("cutters", f"its comments name {text or 'none'}, not {expected}")


def _of_operations(product: Product, grid: Grid, stated: Stated, machine: Machine) -> Iterator[str]:
    """The comments on each operation, with the offsets that they state themselves."""
    offsets = iter(stated.offsets)
    for cut in product.milled.cuts:
        said = ""
        if side_of(cut) and machine.compensation is not None:
            tool, most = cut.tool, next(offsets, math.nan)
            limit = Limit(cut.name, mode_of(cut), tool.number, tool.radius, most)
            said = limit.sentence(machine.compensation, partial(spelled, unit=product.unit))
        yield from about_operation(cut, grid, product.milled.zero, said)


def _comments(product: Product, program: Run, stated: Stated, machine: Machine) -> Check:
    """That a program of our own version has the comments that it writes; the scene is checked
    elsewhere.
    """
    if stated.version != product.version:
        note = "" if stated.version else "they do not name a version of camgeo"
        return Check("comments", "", f"of camgeo {stated.version}", ok=None, note=note)
    unkept = failed("comments", "they state no tolerance that a program can meet")
    if stated.tolerance is None:
        return unkept
    try:
        shares = budget(machine, product.unit, stated.tolerance)
    except ToleranceError:
        return unkept
    grid = Grid(shares.decimals, MM_PER[product.unit])
    texts = about_program(product, machine, shares, product.milled.cuts, stated.scene)
    texts += _of_operations(product, grid, stated, machine)
    expected = [line.strip() for line in comment_texts(texts, machine.text)]
    for found, wanted in zip_longest(program.comments, expected, fillvalue=""):
        if found != wanted:
            return failed("comments", f"'{found}' where '{wanted}' is expected")
    return Check("comments", "", float(len(expected)), ok=True)


# -- leads ----------------------------------------------------------------------------------------
# How a program's cutter enters its closed path and leaves it: tangent, and on the free side.
#
# The closed path itself is proved elsewhere; the leads are checked by samples.


PARTS = 64
"""Points per lead; chords of half a turn lie 3e-4 of the radius off it."""


def lead_checks(
    program: Run,
    operation: str,
    path: Contour,
    heights: Collection[float],
    tolerance: float,
    *,
    climb: bool,
    wanted: bool,
    across: bool = False,
) -> list[Check]:
    """Checks of all cuts at its heights that one operation makes off its closed path.

    Parameters
    ----------
    path : the closed path in the direction of cutting.
    heights : at which it is cut [mm].
    tolerance : [mm].
    climb : whether the material lies on its right, or else on its left.
    wanted : whether each pass must begin and end off the path.
    across : whether the outer pieces of leads go across to them, as the controller takes up the
        radius of the cutter there.
    """
    vertices = set(path.vertices.tolist())

    def is_cut(move: CutterMove) -> bool:
        there = move.z_start == move.z_end and move.z_end in heights
        # A finish with leads runs higher only over tabs.
        there |= wanted and move.start != move.end
        cuts = move.kind != "rapid" and move.operation == operation
        return there and cuts and move.course.length > 0.0

    def is_lead(move: CutterMove) -> bool:
        return is_cut(move) and not (move.start in vertices and move.end in vertices)

    outer = set(_switching(program.moves)) if across else set()
    leads = [move for move in program.moves if is_lead(move)]
    pairs = [
        (before, after)
        for before, after in pairwise(program.moves)
        if is_cut(before) and is_cut(after) and (is_lead(before) or is_lead(after))
        if before.line not in outer and after.line not in outer
    ]
    checks = []
    if wanted:
        runs = [list(run) for cut, run in groupby(program.moves, is_cut) if cut]
        bare = [run for run in runs if not (is_lead(run[0]) and is_lead(run[-1]))]
        found = f"{len(runs) - len(bare)} of {len(runs)}"
        note = f"line {bare[0][0].line}: a pass begins or ends on the path itself" if bare else ""
        checks.append(Check("leads", operation, found, ok=not bare, note=note))
    if leads:
        checks.append(_gouge(leads, path, tolerance, operation, climb=climb))
    return checks + ([_kink(pairs, tolerance, operation)] if pairs else [])


def _switching(moves: Sequence[CutterMove]) -> Iterator[int]:
    """Lines of the moves in which compensation begins and ends."""
    for before, after in pairwise(moves):
        if bool(before.compensation) != bool(after.compensation):
            yield after.line


def _gouge(
    leads: list[CutterMove], path: Contour, tolerance: float, operation: str, *, climb: bool
) -> Check:
    """How far a lead crosses the closed path into the material."""
    import shapely

    course = path.points(0.25 * tolerance)
    if len(course) < 3:  # there and back
        return failed("gouge", "the closed path encloses nothing", operation)
    shares = np.linspace(0.0, 1.0, PARTS + 1)
    points = np.concatenate([move.course.at(shares) for move in leads])
    polygon = shapely.Polygon(np.column_stack((course.real, course.imag)))
    shapely.prepare(polygon)
    inside = shapely.contains_xy(polygon, points.real, points.imag)
    # On the right of a clockwise path is its inside, on that of another one its outside.
    wrong = inside if (path.area < 0.0) == climb else ~inside
    depth = np.where(wrong, distances_from(course, points), 0.0)
    worst = int(np.argmax(depth))
    place = complex(points[worst])
    note = f"into the material near {place_text(place)}" if depth[worst] > tolerance else ""
    return at_most("gouge", float(depth[worst]), tolerance, "mm", operation, note)


def _kink(pairs: list[tuple[CutterMove, CutterMove]], tolerance: float, operation: str) -> Check:
    """The largest kink where a lead meets the closed path, or another lead."""
    before, after = zip(*pairs, strict=True)
    arriving = np.array([move.course.heading(move.end) for move in before])
    leaving = np.array([move.course.heading(move.start) for move in after])
    kinks = np.abs(np.angle(leaving * np.conj(arriving)))
    lengths = [np.array([move.course.length for move in moves]) for moves in (before, after)]
    limits = np.minimum(SLOPE * tolerance * (1.0 / lengths[0] + 1.0 / lengths[1]), math.pi)
    worst = int(np.argmax(kinks - limits))
    value, limit = math.degrees(float(kinks[worst])), math.degrees(float(limits[worst]))
    note = f"at {place_text(after[worst].start)}"
    return at_most("kink", value, limit, "deg", f"{operation}, leads", note)


# -- heights --------------------------------------------------------------------------------------
# Heights of the cuts of one operation: its depths, and ramps between them as they are printed.


MOVED: Final = 2.0**0.5
"""Steps by which the length of a printed move may be off: half a step in x and y at both ends."""


def at_no_height(cut: Cut, moves: Sequence[CutterMove], step: float) -> CutterMove | None:
    """The first of the feed moves of an operation that is neither at one of its heights nor part of
    a ramp; None if there is none.

    Level moves are at a depth, and over tabs at their tops; straight ones end at a depth or at the
    upper face. All heights are printed in steps of `step` [mm].
    """
    if not moves:
        return None
    from_z, to_z = (
        np.array([getattr(move, end) for move in moves]) for end in ("z_start", "z_end")
    )
    in_plane = np.array([move.start != move.end for move in moves])
    tabs = cut.tabs if isinstance(cut, ContourCut) else None
    heights = [*cut.depths, *([] if tabs is None else [cut.bottom + tabs.height])]
    settled = near(to_z, heights, step)
    straight = (to_z < from_z) & near(to_z, [*cut.depths, cut.top], step)
    sound = np.where(in_plane, (from_z != to_z) | settled, straight)
    if not np.all(sound):
        begun = near(from_z, [*heights, cut.top], step)
        sound |= in_plane & _in_ramps(moves, begun, settled, step)
    sound &= (cut.bottom - step <= to_z) & (to_z <= cut.top + step)
    wrong = np.flatnonzero(~sound)
    return moves[int(wrong[0])] if len(wrong) else None


def near(z: FloatArray, heights: Iterable[float], slack: float) -> BoolArray:
    """(n,) whether each of `z` (n,) is one of `heights` within a `slack` [mm]."""
    known = np.sort(np.array([*heights, -np.inf, np.inf]))
    place = np.clip(np.searchsorted(known, z), 1, len(known) - 1)  # which NaN exceeds
    found: BoolArray = (z - known[place - 1] <= slack) | (known[place] - z <= slack)
    return found


def _in_ramps(
    moves: Sequence[CutterMove], begun: BoolArray, settled: BoolArray, step: float
) -> BoolArray:
    """(n,) whether each move is level although it belongs to a ramp.

    A ramp has one slope, from the last height at which it is `begun` to the first at which it is
    `settled`; pieces of it that follow each other are level if it falls by no more than a step
    along them.
    """
    found = np.zeros(len(moves), dtype=np.bool_)
    along = np.cumsum([0.0, *(move.course.length for move in moves)])
    joined = [
        one.end == other.start and one.z_end == other.z_start for one, other in pairwise(moves)
    ]
    gaps = [0, *(np.flatnonzero(~np.array(joined, dtype=np.bool_)) + 1).tolist(), len(moves)]
    for start, stop in pairwise(gaps):
        level = np.array([move.z_start == move.z_end for move in moves[start:stop]])
        edges = np.flatnonzero(np.diff(np.concatenate(([False], level, [False])))) + start
        begins = np.flatnonzero(begun[start:stop]) + start
        ends = np.flatnonzero(settled[start:stop]) + start
        for first, last in edges.reshape(-1, 2).tolist():
            before, after = np.searchsorted(begins, first, "right"), np.searchsorted(ends, last)
            low = int(begins[before - 1]) if before else start
            high = int(ends[after]) + 1 if after < len(ends) else stop
            drop = abs(moves[low].z_start - moves[high - 1].z_end) - step
            whole = float(along[high] - along[low]) + (high - low) * MOVED * step
            part = float(along[last] - along[first]) - (last - first) * MOVED * step
            found[first:last] = part * drop <= step * whole
    return found
