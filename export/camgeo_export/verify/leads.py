"""How a program's cutter enters its closed path and leaves it: tangent, and on the free side.

The closed path itself is proved elsewhere; the leads are checked by samples.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from itertools import groupby, pairwise

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.verifying.verification import Check, at_most, failed
from camgeo.wording import place_text
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.run import Run
from camgeo_export.matching import distances_from
from camgeo_export.verify.plane import SLOPE

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
