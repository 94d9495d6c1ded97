"""Verification of STEP files of upright solids, ours and those of CAD programs."""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from camgeo.design.product import Product
from camgeo.design.verify import (
    Check,
    Origin,
    ReadingOptions,
    at_most,
    failed,
    near,
    parse_tolerance,
    unit_check,
)
from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.spline import Arc
from camgeo.numeric.arrays import FloatArray, phase
from camgeo.numeric.quadrature import gauss, nodes_for_singularity
from camgeo.units import MM_PER, TURN, counted
from camgeo_export.dxf.reader import closed
from camgeo_export.part21 import (
    Face,
    Solid,
    Use,
    header_record,
)
from camgeo_export.reading import ARC_SLACK, AnyContour, text_tokens
from camgeo_export.verify.body import (
    Surfaces,
    group_levels,
    no_body,
)

OURS, SCENE, TOLERANCE = "camgeo ", "scene ", "tolerance "
"""How the lines of the description in our files begin."""

TOPOLOGY = ("closed", "oriented")
"""Checks without which there are no boundaries to compare."""


class StepVerifier:
    """Verifies a STEP file."""

    format = "step"
    slack = ARC_SLACK
    tokens = staticmethod(text_tokens)

    def origin(self, data: bytes) -> Origin:
        """The origin that the description in the header states."""
        try:
            values = header_record(data, "FILE_DESCRIPTION").values
        except FileError as error:
            return Origin(damage=str(error))
        lines = values[0] if values and isinstance(values[0], tuple) else ()
        texts = [line for line in lines if isinstance(line, str)]

        def stated(word: str) -> str:
            return next((line.removeprefix(word) for line in texts if line.startswith(word)), "")

        version = texts[0].removeprefix(OURS) if texts and texts[0].startswith(OURS) else ""
        return Origin(version, stated(SCENE), parse_tolerance(stated(TOLERANCE)))

    def checks(
        self, product: Product, data: bytes, reading: ReadingOptions, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, the shell, and the solid against the part."""
        try:
            solid = Solid.from_bytes(data)
        except FileError as error:
            return (failed("file", str(error)),)
        part = product.drawn.part
        checks = [unit_check(solid.unit_name, reading)]
        try:
            part.require_heights()
        except GeometryError as error:
            return (*checks, no_body(error))
        # The uncertainty that the file states counts if it is stricter than the tolerance.
        shell = shell_checks(solid, min(solid.uncertainty or tolerance, tolerance))
        checks += shell
        if not all(check.ok for check in shell if check.name in TOPOLOGY):
            return tuple(checks)
        bounds = level_bounds(solid)
        ranges, contours = levels(bounds, tolerance)
        # Heights count from the lowest face.
        base = float(ranges[0, 0]) if len(ranges) else 0.0
        try:
            volume = volume_by_levels(bounds, solid.faces)
        except FileError as error:
            return (*checks, failed("body", str(error)))
        surfaces = Surfaces(
            ranges - base,
            contours.__getitem__,
            lambda low, high: slope_contours(solid, low + base, high + base, tolerance),
            gap(solid),
        )
        return (*checks, *surfaces.checks(part, product.drawn.base_radius, volume, tolerance))


VERIFIER = StepVerifier()


# -- shell ----------------------------------------------------------------------------------------
# Whether the faces of a STEP file form one closed, outward shell of level and upright faces and
# chamfers between them, or where not.


SAME_VOLUME = 1e-9
"""Relative difference of the volumes by flat faces and by walls up to which they agree."""

Bound = tuple[float, AnyContour]
"""A loop of a flat face: its height [mm], and its contour in its direction seen from above."""


def shell_checks(solid: Solid, tolerance: float) -> list[Check]:
    """All checks of the shell; edges must meet vertices and surfaces within `tolerance` [mm]."""
    checks = [_closed(solid), _oriented(solid)]
    if not all(check.ok for check in checks):
        return checks
    checks += [_uncertainty(solid, tolerance), _walls(solid, tolerance)]
    if all(check.ok for check in checks):
        checks.append(_outwards(solid))
    return checks


def gap(solid: Solid) -> float:
    """Bound [mm] on the distance between the curves of a solid and those through its vertices.

    An arc through both vertices is the circle's own, turned and stretched: it moves no point by
    more than thrice as far as its ends.
    """
    return 3.0 * max(use.edge.gap for use in _uses(solid))


def level_bounds(solid: Solid) -> list[Bound]:
    """The loops of all flat faces, in the order of the file; raises FileError."""
    return [_bound(loop) for face in solid.faces if face.is_level for loop in face.loops]


def levels(bounds: Sequence[Bound], tolerance: float) -> tuple[FloatArray, list[list[AnyContour]]]:
    """(k, 2) least and greatest height of each level, from 0, and the contours at each."""
    if not bounds:
        return np.zeros((0, 2)), []
    numbers, ranges = group_levels(np.array([z for z, _ in bounds]), tolerance)
    contours: list[list[AnyContour]] = [[] for _ in ranges]
    for (_, contour), number in zip(bounds, numbers.tolist(), strict=True):
        contours[number].append(contour)
    return ranges, contours


def volume_by_levels(bounds: Iterable[Bound], faces: Iterable[Face]) -> float:
    """The enclosed volume [mm^3] by flat faces, with the `bounds`, and by the chamfers among the
    `faces`; positive where they look outwards. Raises FileError for one that cannot be read.
    """
    leaning = (column_volume(face) for face in faces if face.is_inclined)
    return math.fsum((*(z * contour.area for z, contour in bounds), *leaning))


def _uses(solid: Solid) -> Iterator[Use]:
    return (use for face in solid.faces for use in face.uses)


def _closed(solid: Solid) -> Check:
    """The check that each loop is closed, each edge has two faces, and all faces are connected."""
    for face in solid.faces:
        for loop in face.loops:
            for use, following in zip(loop, (*loop[1:], loop[0]), strict=True):
                if use.ends[1] != following.ends[0]:
                    return failed(
                        "closed",
                        f"a loop of {face.label} is open: edge #{use.edge.number} does not end"
                        f" where #{following.edge.number} begins",
                    )
    users: dict[int, list[int]] = defaultdict(list)
    for number, face in enumerate(solid.faces):
        for use in face.uses:
            users[use.edge.number].append(number)
    single = [edge for edge, faces in users.items() if len(faces) != 2]
    if single:
        times = len(users[single[0]])
        note = f"edge #{single[0]} is used by {counted(times, 'loop')}, not by two"
        return Check("closed", "", float(len(single)), None, 0.0, "open edges", ok=False, note=note)
    parts = _parts(len(solid.faces), users.values())
    if parts != 1:
        return failed("closed", f"its faces form {parts} shells that are not connected")
    return Check("closed", "", 0.0, None, 0.0, "open edges", ok=True)


def _parts(count: int, pairs: Iterable[Sequence[int]]) -> int:
    """The number of connected parts of `count` faces that `pairs` connect."""
    head = list(range(count))

    def first(number: int) -> int:
        # Union-find: chains of heads are halved while they are followed.
        while head[number] != number:
            head[number] = head[head[number]]
            number = head[number]
        return number

    for one, other in pairs:
        head[first(one)] = first(other)
    return sum(first(number) == number for number in range(count))


def _oriented(solid: Solid) -> Check:
    """The check that both faces of an edge traverse it in opposite directions."""
    turns: dict[int, int] = defaultdict(int)
    for use in _uses(solid):
        turns[use.edge.number] += 1 if use.forward else -1
    twice = [edge for edge, turn in turns.items() if turn]
    note = f"edge #{twice[0]} is used twice in the same direction" if twice else ""
    return Check("oriented", "", float(len(twice)), None, 0.0, "edges run twice", not twice, note)


def _uncertainty(solid: Solid, tolerance: float) -> Check:
    """The check that ends lie on their curves, and edges on the surfaces of their faces."""
    worst, place = 0.0, ""
    for face in solid.faces:
        for use in face.uses:
            distance = max(use.edge.gap, face.edge_distance(use.edge))
            # Also true for NaN.
            if not distance <= worst:
                worst, place = distance, f"edge #{use.edge.number} of {face.label}"
    note = (
        "" if worst <= tolerance else f"{place} does not meet its vertices, or leaves the surface"
    )
    return at_most("uncertainty", worst, tolerance, "mm", note=note)


def _walls(solid: Solid, tolerance: float) -> Check:
    """The check that each face is level or between two heights, its normal out of the material."""
    for face in solid.faces:
        note = _flat_fault(face) if face.is_level else _wall_fault(face, tolerance)
        if note:
            return failed("walls", f"{face.label} {note}")
    return Check("walls", "", "upright", ok=True)


def _flat_fault(face: Face) -> str:
    """What is wrong with a level face: one loop goes round it, the others round its holes."""
    if not all(use.edge.strands for use in face.uses):
        return "has an upright edge"
    # The largest loop bounds the face, all others its holes.
    areas = sorted((_bound(loop)[1].area for loop in face.loops), key=abs)
    signs = [area > 0.0 for area in areas]
    holes = [sign != face.is_upward for sign in signs]
    right = all(holes[:-1]) and not holes[-1] and all(areas)
    return "" if right else "is turned against its edges"


def _wall_fault(face: Face, tolerance: float) -> str:
    """What is wrong with a face between two heights: it must lie on the left of its lower edges,
    and on the left of its upper ones.
    """
    low, high = face.heights
    if face.is_inclined:
        try:
            edge_rows(face)
        except FileError as error:
            return f"cannot be read: {error}"
    for use in (use for use in face.uses if use.edge.strands):
        below = abs(use.edge.z - low) <= tolerance
        if not below and abs(use.edge.z - high) > tolerance:
            return f"has edge #{use.edge.number} between its lower and its upper end"
        if any(face.rises_to_left(strand) != below for strand in use.strands):
            return "is turned against its edges"
    return ""


def _outwards(solid: Solid) -> Check:
    """The check that the volume is positive, and the same by flat faces and by walls."""
    by_levels = volume_by_levels(level_bounds(solid), solid.faces)
    by_walls = math.fsum(_volume_of_wall(face) for face in solid.faces if not face.is_level)
    if not by_levels > 0.0:
        return failed("outwards", "the shell is turned inside out")
    return near("outwards", by_walls, by_levels, SAME_VOLUME * by_levels, "mm^3")


def _volume_of_wall(face: Face) -> float:
    """The share of a wall in the volume [mm^3]."""
    if face.is_inclined:
        return inclined_volume(face)
    low, high = face.heights
    moments = [
        strand.moment
        for use in face.uses
        for strand in use.strands
        if use.edge.z - low < high - use.edge.z
    ]
    return (high - low) * math.fsum(moments)


def _bound(loop: Sequence[Use]) -> Bound:
    return loop[0].edge.z, closed([strand for use in loop for strand in use.strands])


# -- inclined -------------------------------------------------------------------------------------
# The inclined faces of a STEP file, cones and planes: chamfers between two heights.


FARTHEST = 1e3
"""Half heights of a face beyond which the turning point of a parabola, seen from the middle, no
longer matters to the quadrature."""

RowStrand = tuple[Use, Arc]
"""A strand with the use of its edge, in the direction of the strand."""


def edge_rows(face: Face) -> tuple[list[RowStrand], list[RowStrand]]:
    """The lower and the upper strands of an inclined face in pairs, the material on their left.

    Raises
    ------
    FileError
        If there are not as many, of the same kinds, or splines among them.
    """
    low, high = face.heights
    rows: tuple[list[RowStrand], list[RowStrand]] = ([], [])
    for use in (use for use in face.uses if use.edge.strands):
        upper = use.edge.z - low > high - use.edge.z
        way = Use(use.edge, use.forward != upper)
        for strand in way.strands:
            if not isinstance(strand, Arc):
                raise FileError(f"{face.label} has an edge that is neither a line nor an arc")
            rows[upper].append((way, strand))
    # A face runs through its upper edges the other way.
    rows[True].reverse()
    kinds = [[bool(strand.sweep) for _, strand in row] for row in rows]
    if kinds[0] != kinds[1] or not kinds[0]:
        raise FileError(f"{face.label} has different edges above and below")
    return rows


def _is_bent(face: Face) -> bool:
    """Whether some of its edges between lower and upper ones are parabolas."""
    return any(use.edge.bend is not None for use in face.uses)


def _section(face: Face, rows: tuple[list[RowStrand], list[RowStrand]], z: float) -> list[Arc]:
    """The section at a height [mm] of a face with bent edges, in as many pieces as it has below."""
    lower, upper = ([strand for _, strand in row] for row in rows)
    posts = {use.edge.foot: use.edge for use in face.uses if not use.edge.strands}
    ends = _chained(rows[0])
    if any(end not in posts for end in ends):
        raise FileError(f"{face.label} has no edges between its lower and its upper ones")
    start, end = (posts[end].section_point(z) for end in ends)
    shares = [k / len(lower) for k in range(1, len(lower))]
    low, high = face.heights
    share = (z - low) / (high - low)
    centre = lower[0].centre
    turn = math.fsum((1.0 - share) * a.sweep + share * b.sweep
                     for a, b in zip(lower, upper, strict=True))  # fmt: skip
    if not turn:
        inner = [start + fraction * (end - start) for fraction in shares]
    else:
        # The angle is known up to whole revolutions; the turn interpolated between the edges shows
        # how many there are.
        angle = phase((end - centre) / (start - centre))
        turn = angle + TURN * round((turn - angle) / TURN)
        inner = [centre + (start - centre) * cmath.exp(1j * fraction * turn) for fraction in shares]
    places = pairwise((start, *inner, end))
    return [Arc(a, b, turn / len(lower), centre) for a, b in places]


def _middles(face: Face, rows: tuple[list[RowStrand], list[RowStrand]]) -> list[Arc]:
    """The section of a face half way up."""
    if _is_bent(face):
        return _section(face, rows, 0.5 * sum(face.heights))
    return [_middle_section(one, other) for (_, one), (_, other) in zip(*rows, strict=True)]


def _middle_section(lower: Arc, upper: Arc) -> Arc:
    """The section half way between two strands that belong together."""
    if not lower.sweep:
        start, end = 0.5 * (lower.start + upper.start), 0.5 * (lower.end + upper.end)
        return Arc(start, end, 0.0, 0j)
    share = 0.5 * (1.0 + upper.radius / lower.radius)
    start, end = (
        lower.centre + share * (point - lower.centre) for point in (lower.start, lower.end)
    )  # fmt: skip
    return Arc(start, end, lower.sweep, lower.centre)


def inclined_volume(face: Face) -> float:
    """The share of an inclined face in the volume [mm^3], by its sections: with Simpson's rule,
    exact as their areas are quadratic in the height, or along bent edges with Gauss's rule.
    """
    low, high = face.heights
    if _is_bent(face):
        return _volume_by_sections(face, low, high)
    return (high - low) * math.fsum(
        (one.moment + 4.0 * _middle_section(one, other).moment + other.moment) / 6.0
        for (_, one), (_, other) in zip(*edge_rows(face), strict=True)
    )


def _volume_by_sections(face: Face, low: float, high: float) -> float:
    """The share of a face with bent edges in the volume [mm^3]: sections are analytic in z except
    where a parabola turns, which determines the number of nodes.
    """
    half = 0.5 * (high - low)
    bends = [use.edge.bend for use in face.uses if use.edge.bend is not None]
    if not all(bend.is_monotonic for bend in bends):
        raise FileError(f"{face.label} has an edge that rises and falls")
    # The turning point nearest to the middle, in half heights, limits how smooth the sections are.
    place = min(FARTHEST, *(abs(bend.turning - low - half) / half for bend in bends))
    rows = edge_rows(face)
    heights, _, weights = gauss(np.array([low]), np.array([high]), nodes_for_singularity(-place))
    return half * math.fsum(
        weight * strand.moment
        for weight, z in zip(weights.tolist(), heights[0].tolist(), strict=True)
        for strand in _section(face, rows, z)
    )


def column_volume(face: Face) -> float:
    """The share of an inclined face in the volume by heights [mm^3], as that of a flat face: the
    integral of z over its area seen from above.
    """
    low, high = face.heights
    lower, upper = (math.fsum(strand.moment for _, strand in row) for row in edge_rows(face))
    return inclined_volume(face) - (high * upper - low * lower)


def slope_contours(
    solid: Solid, low: float, high: float, tolerance: float
) -> Iterator[list[AnyContour]]:
    """The contours of the lower edges, of the sections half way up and of the upper edges of the
    inclined faces from `low` to `high` [mm], within `tolerance` [mm]; raises FileError.
    """
    ends = np.array([low, high])
    faces = [
        face
        for face in solid.faces
        if face.is_inclined and np.all(np.abs(ends - face.heights) <= tolerance)
    ]
    if not faces:
        raise FileError("there is no chamfer")
    rows = [edge_rows(face) for face in faces]
    chains = [_chained(lower) for lower, _ in rows]
    # The order in which lower edges follow each other is that of the faces all the way up.
    order = _loops(chains)
    for place in range(3):
        contours = []
        for loop in order:
            strands = []
            for k in loop:
                if place == 1:
                    strands += _middles(faces[k], rows[k])
                else:
                    strands += [strand for _, strand in rows[k][place // 2]]
            contours.append(closed(strands))
        yield contours


def _chained(row: Sequence[RowStrand]) -> tuple[int, int]:
    """The vertices where a row begins and ends."""
    return row[0][0].ends[0], row[-1][0].ends[1]


def _loops(chains: Iterable[tuple[int, int]]) -> list[list[int]]:
    """The numbers of chains, loop by loop, each from the vertex where the one before it ends."""
    successors = {start: (number, end) for number, (start, end) in enumerate(chains)}
    loops = []
    while successors:
        first = next(iter(successors))
        vertex = first
        loop: list[int] = []
        while not loop or vertex != first:
            if vertex not in successors:
                raise FileError("the faces of a chamfer do not form a closed ring")
            number, vertex = successors.pop(vertex)
            loop.append(number)
        loops.append(loop)
    return loops


# -- measure --------------------------------------------------------------------------------------
# A STEP file of ours read back and compared with the exact curves.


UNCERTAINTY = 1e-7
"""Uncertainty that our files state [mm]."""


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of the solid from the part, in the plane and in height.

    Raises FileError unless it is one closed, outward shell along Z in the unit of the product.
    """
    part = product.drawn.part
    try:
        part.require_heights()
    except GeometryError as error:
        raise FileError(f"the scene has no solid to compare this with: {error.message}") from None
    solid = Solid.from_bytes(data)
    if solid.unit != MM_PER[product.unit]:
        raise FileError(f"the solid is in {solid.unit_name}, not in {product.unit}")
    for check in shell_checks(solid, UNCERTAINTY):
        if not check.ok:
            raise FileError(f"the solid fails the check '{check.name}': {check.note}")
    ranges, contours = levels(level_bounds(solid), UNCERTAINTY)
    surfaces = Surfaces(
        ranges,
        contours.__getitem__,
        lambda low, high: slope_contours(solid, low, high, UNCERTAINTY),
        gap(solid),
    )
    return surfaces.deviation(part)
