"""Verification of STEP files of upright solids, ours and those of CAD programs."""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgeo.design.product import Product
from camgeo.design.verify import (
    Check,
    Origin,
    Reading,
    at_most,
    failed,
    length_of,
    near,
    unit_check,
)
from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.spline import Arc, CubicSpline
from camgeo.numeric.arrays import FloatArray, phase
from camgeo.numeric.quadrature import gauss, nodes_beside
from camgeo.units import TURN, counted
from camgeo_export.dxf.reader import closed
from camgeo_export.part21.solid import (
    ALIGNED,
    Cone,
    Cylinder,
    Edge,
    Extrusion,
    Face,
    Model,
    Plane,
    Solid,
    Strand,
    Use,
    apart,
    off_surface,
    solid_of,
    swept,
)
from camgeo_export.part21.text import Exchange, Record, exchange_of
from camgeo_export.reading import OF_ARCS, AnyContour, text_tokens
from camgeo_export.verify.body import level_checks, levels_of, no_body, slope_checks, slopes_of

OURS, SCENE, TOLERANCE = "camgeo ", "scene ", "tolerance "
"""How the lines of the description in our files begin."""

TOPOLOGY = ("closed", "oriented")
"""Checks without which there are no boundaries to compare."""


class StepVerifier:
    """Verifies a STEP file."""

    format = "step"
    slack = OF_ARCS

    def tokens(self, data: bytes) -> Iterator[tuple[str, str]]:
        """Those of its lines."""
        return text_tokens(data)

    def origin(self, data: bytes) -> Origin:
        """From the description in the header."""
        try:
            values = header_of(exchange_of(data, whole=False), "FILE_DESCRIPTION").values
        except FileError as error:
            return Origin(damage=str(error))
        lines = values[0] if values and isinstance(values[0], tuple) else ()
        texts = [line for line in lines if isinstance(line, str)]

        def stated(word: str) -> str:
            return next((line.removeprefix(word) for line in texts if line.startswith(word)), "")

        version = texts[0].removeprefix(OURS) if texts and texts[0].startswith(OURS) else ""
        return Origin(version, stated(SCENE), length_of(stated(TOLERANCE)))

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, the shell, and the solid against the part."""
        try:
            solid = solid_of(Model.of(exchange_of(data)))
        except FileError as error:
            return (failed("file", str(error)),)
        part = product.drawn.part
        checks = [unit_check(solid.unit_name, reading)]
        try:
            part.require_heights()
        except GeometryError as error:
            return (*checks, no_body(error))
        stated = solid.uncertainty
        shell = shell_checks(solid, min(stated or tolerance, tolerance))
        checks += shell
        if not all(check.ok for check in shell if check.name in TOPOLOGY):
            return tuple(checks)
        bounds = bounds_of(solid)
        ranges, contours = levels(bounds, tolerance)
        base = float(ranges[0, 0]) if len(ranges) else 0.0
        try:
            found = volume_of(bounds, solid.faces)
        except FileError as error:
            return (*checks, failed("body", str(error)))
        off = gap(solid)
        extent, own = product.drawn.base_radius, contours.__getitem__
        checks += level_checks(part, extent, ranges - base, own, found, tolerance, off)
        for slope in slopes_of(part):
            there = slope_contours(solid, slope.z0 + base, slope.z1 + base, tolerance)
            checks += slope_checks(slope, extent, there, tolerance, off)
        return tuple(checks)


def header_of(exchange: Exchange, kind: str) -> Record:
    """A record of the header; FileError unless there is one."""
    found = [record for record in exchange.header if record.kind == kind]
    if len(found) != 1:
        raise FileError(f"the header has {kind} {len(found)} times, expected once")
    return found[0]


VERIFIER = StepVerifier()


# -- shell ----------------------------------------------------------------------------------------
# Whether the faces of a STEP file form one closed, outward shell of level and upright faces and
# chamfers between them, or where not.


MIDDLE = np.array([0.5])
"""Share of an arc at which it is compared with the surfaces of its faces and their senses."""

SAME_VOLUME = 1e-9
"""By how much the volumes by flat faces and by walls may differ, relative."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A loop of a flat face: its height [mm] and its contour, in its direction from above."""

    z: float
    contour: AnyContour
    area: float


def is_flat(face: Face) -> bool:
    """Whether a face is level."""
    return isinstance(face.surface, Plane) and abs(face.surface.normal.place) <= ALIGNED


def shell_checks(solid: Solid, within: float) -> list[Check]:
    """All checks of the shell; `within` is how near [mm] edges meet vertices and surfaces."""
    checks = [_closed(solid), _oriented(solid)]
    if not all(check.ok for check in checks):
        return checks
    checks.append(_uncertainty(solid, within))
    checks.append(_walls(solid, within))
    if all(check.ok for check in checks):
        checks.append(_outwards(solid))
    return checks


def gap(solid: Solid) -> float:
    """By how much [mm] the curves of a solid may be off those through its vertices, at most.

    An arc through both vertices is the circle's own, turned and stretched: it moves no point by
    more than thrice as far as its ends.
    """
    return 3.0 * max(use.edge.off for use in _uses(solid))


def bounds_of(solid: Solid) -> list[Bound]:
    """The loops of all flat faces, in the order of the file; raises FileError."""
    return [_bound(loop) for face in solid.faces if is_flat(face) for loop in face.loops]


def levels(bounds: Sequence[Bound], within: float) -> tuple[FloatArray, list[list[AnyContour]]]:
    """(k, 2) least and greatest height of each level, from 0, and the contours at each."""
    if not bounds:
        return np.zeros((0, 2)), []
    numbers, ranges = levels_of(np.array([bound.z for bound in bounds]), within)
    found: list[list[AnyContour]] = [[] for _ in ranges]
    for bound, number in zip(bounds, numbers.tolist(), strict=True):
        found[number].append(bound.contour)
    return ranges, found


def volume_of(bounds: Iterable[Bound], faces: Iterable[Face] = ()) -> float:
    """The enclosed volume [mm^3] by flat faces, with the `bounds`, and by the chamfers among the
    `faces`; positive where they look outwards. Raises FileError for one that cannot be read.
    """
    leaning = (volume_below(face) for face in faces if is_inclined(face))
    return math.fsum((*(bound.z * bound.area for bound in bounds), *leaning))


def _uses(solid: Solid) -> Iterator[Use]:
    return (use for face in solid.faces for loop in face.loops for use in loop)


def _closed(solid: Solid) -> Check:
    """Each loop is closed, each edge has two faces, and all faces hang together."""
    for face in solid.faces:
        for loop in face.loops:
            for use, following in zip(loop, (*loop[1:], loop[0]), strict=True):
                if use.ends[1] != following.ends[0]:
                    what = f"edge #{use.edge.number} does not end where #{following.edge.number}"
                    return failed("closed", f"a loop of {face.told} is open: {what} begins")
    users: dict[int, list[int]] = defaultdict(list)
    for number, face in enumerate(solid.faces):
        for loop in face.loops:
            for use in loop:
                users[use.edge.number].append(number)
    single = [edge for edge, faces in users.items() if len(faces) != 2]
    if single:
        times = len(users[single[0]])
        note = f"edge #{single[0]} is used by {counted(times, 'loop')}, not by two"
        return Check("closed", "", float(len(single)), None, 0.0, "open edges", ok=False, note=note)
    parts = _parts(len(solid.faces), users.values())
    if parts != 1:
        return failed("closed", f"its faces form {parts} shells that do not hang together")
    return Check("closed", "", 0.0, None, 0.0, "open edges", ok=True)


def _parts(count: int, pairs: Iterable[Sequence[int]]) -> int:
    """Into how many parts `count` faces fall that `pairs` connect."""
    head = list(range(count))

    def first(number: int) -> int:
        while head[number] != number:
            head[number] = head[head[number]]
            number = head[number]
        return number

    for one, other in pairs:
        head[first(one)] = first(other)
    return sum(first(number) == number for number in range(count))


def _oriented(solid: Solid) -> Check:
    """Both faces of an edge traverse it in opposite directions."""
    turns: dict[int, int] = defaultdict(int)
    for use in _uses(solid):
        turns[use.edge.number] += 1 if use.forward else -1
    twice = [edge for edge, turn in turns.items() if turn]
    note = f"edge #{twice[0]} is used twice in the same direction" if twice else ""
    number = float(len(twice))
    return Check("oriented", "", number, None, 0.0, "edges run twice", not twice, note)


def _uncertainty(solid: Solid, within: float) -> Check:
    """Ends lie on their curves, edges on the surfaces of their faces."""
    worst, place = 0.0, ""
    for face in solid.faces:
        for loop in face.loops:
            for use in loop:
                off = max(use.edge.off, _off(face, use.edge))
                if not off <= worst:
                    worst, place = off, f"edge #{use.edge.number} of {face.told}"
    note = "" if worst <= within else f"{place} does not meet its vertices, or leaves the surface"
    return at_most("uncertainty", worst, within, "mm", note=note)


def _off(face: Face, edge: Edge) -> float:
    """How far [mm] an edge is from the surface of one of its faces."""
    surface = face.surface
    off = [off_surface(surface, point.place, point.z) for point in edge.places]
    if not edge.strands:
        one, other = edge.places
        off.append(off_surface(surface, 0.5 * (one.place + other.place), 0.5 * (one.z + other.z)))
    if edge.bend is not None:
        # By how much a cone misses it is of the fourth degree: it vanishes if five values do.
        along = [edge.bend.at(share) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
        off = [off_surface(surface, point.place, point.z) for point in along]
    for strand in edge.strands:
        if isinstance(surface, Extrusion):
            off.append(_off_extrusion(surface, strand))
        elif isinstance(strand, Arc):
            off.append(off_surface(surface, _middle(strand), edge.z))
        elif isinstance(surface, Cylinder | Cone):
            off.append(math.inf)  # no spline follows a circle
        else:
            off += [off_surface(surface, each, edge.z) for each in strand.controls.tolist()]
    if isinstance(surface, Extrusion) and not edge.strands:
        ends = (surface.curve.start, surface.curve.end)
        off.append(min(abs(end - edge.places[0].place) for end in ends))
    return max(off)


def _off_extrusion(surface: Extrusion, strand: Strand) -> float:
    if isinstance(strand, Arc):
        return math.inf
    return min(apart(surface.curve, strand), apart(surface.curve, strand.reversed()))


def _is_ahead(curve: CubicSpline, strand: CubicSpline) -> bool:
    """Whether a strand has the direction of the curve that it follows."""
    return apart(curve, strand) <= apart(curve, strand.reversed())


def _middle(arc: Arc) -> complex:
    """The point in its middle."""
    return complex(arc.at(MIDDLE)[0])


def _walls(solid: Solid, within: float) -> Check:
    """Each face is level, or between two heights, with its normal out of the material."""
    for face in solid.faces:
        note = _flat_fault(face) if is_flat(face) else _wall_fault(face, within)
        if note:
            return failed("walls", f"{face.told} {note}")
    return Check("walls", "", "upright", ok=True)


def _flat_fault(face: Face) -> str:
    """What is wrong with a level face: one loop goes round it, the others round its holes."""
    assert isinstance(face.surface, Plane)
    up = (face.surface.normal.z > 0.0) == face.same
    if any(not use.edge.strands for loop in face.loops for use in loop):
        return "has an upright edge"
    areas = sorted((_bound(loop).area for loop in face.loops), key=abs)
    signs = [area > 0.0 for area in areas]
    right = signs[-1] == up and all(sign != up for sign in signs[:-1]) and all(areas)
    return "" if right else "is turned against its edges"


def _wall_fault(face: Face, within: float) -> str:
    """What is wrong with one between two heights: the edges below it have it on their left, and so
    have those above.
    """
    low, high = swept(face)
    if is_inclined(face):
        try:
            rows_of(face)
        except FileError as error:
            return f"cannot be read: {error}"
    for loop in face.loops:
        for use in loop:
            if not use.edge.strands:
                continue
            z = use.edge.z
            below = abs(z - low) <= within
            if not below and abs(z - high) > within:
                return f"has edge #{use.edge.number} between its lower and its upper end"
            for strand in use.strands:
                if (_left_is_up(face, strand)) != below:
                    return "is turned against its edges"
    return ""


def _left_is_up(face: Face, strand: Strand) -> bool:
    """Whether up is on the left of a strand seen from outside the face."""
    surface = face.surface
    if isinstance(surface, Extrusion):
        ahead = isinstance(strand, CubicSpline) and _is_ahead(surface.curve, strand)
        return (surface.up > 0.0) == (face.same == ahead)
    place, heading = strand.start, strand.end - strand.start
    if isinstance(strand, Arc):
        place = _middle(strand)
        heading = strand.heading(place)
    normal = surface.normal.place if isinstance(surface, Plane) else place - surface.centre
    return ((normal.conjugate() * heading).imag > 0.0) == face.same


def _outwards(solid: Solid) -> Check:
    """The volume is positive, and the same by flat faces and by walls."""
    bounds = bounds_of(solid)
    by_levels = volume_of(bounds, solid.faces)
    by_walls = math.fsum(_volume_of_wall(face) for face in solid.faces if not is_flat(face))
    if not by_levels > 0.0:
        return failed("outwards", "the shell is turned inside out")
    return near("outwards", by_walls, by_levels, SAME_VOLUME * by_levels, "mm^3")


def _volume_of_wall(face: Face) -> float:
    """The share of a wall in the volume [mm^3]."""
    if is_inclined(face):
        return volume_within(face)
    low, high = swept(face)
    moments = [
        strand.moment
        for loop in face.loops
        for use in loop
        for strand in use.strands
        if use.edge.z - low < high - use.edge.z
    ]
    return (high - low) * math.fsum(moments)


def _bound(loop: Sequence[Use]) -> Bound:
    strands = [strand for use in loop for strand in use.strands]
    contour = closed(strands)
    return Bound(loop[0].edge.z, contour, contour.area)


# -- inclined -------------------------------------------------------------------------------------
# The inclined faces of a STEP file, cones and planes: chamfers between two heights.


FARTHEST = 1e3
"""Half heights of a face, from its middle, beyond which no parabola needs to be known to turn."""

Row = tuple[Use, Arc]
"""A strand and the edge that it is of, which runs as the strand does."""


def is_inclined(face: Face) -> bool:
    """Whether a face is neither level nor upright."""
    if isinstance(face.surface, Plane):
        normal = face.surface.normal
        return min(abs(normal.place), abs(normal.z)) > ALIGNED
    return isinstance(face.surface, Cone)


def rows_of(face: Face) -> tuple[list[Row], list[Row]]:
    """As many lower and upper strands of an inclined face, with the material on their left.

    Raises
    ------
    FileError
        If there are not as many, of the same kinds, or splines among them.
    """
    low, high = swept(face)
    rows: tuple[list[Row], list[Row]] = ([], [])
    for use in (use for loop in face.loops for use in loop if use.edge.strands):
        upper = use.edge.z - low > high - use.edge.z
        way = Use(use.edge, use.forward != upper)
        for strand in way.strands:
            if not isinstance(strand, Arc):
                raise FileError(f"{face.told} has an edge that is neither a line nor an arc")
            rows[upper].append((way, strand))
    rows[True].reverse()
    kinds = [[bool(strand.sweep) for _, strand in row] for row in rows]
    if kinds[0] != kinds[1] or not kinds[0]:
        raise FileError(f"{face.told} has other edges above than below")
    return rows


def _is_bent(face: Face) -> bool:
    """Whether some of its edges between lower and upper ones are parabolas."""
    return any(use.edge.bend is not None for loop in face.loops for use in loop)


def _section(face: Face, rows: tuple[list[Row], list[Row]], z: float) -> list[Arc]:
    """The section at a height [mm] of a face with bent edges, in as many pieces as it has below."""
    lower, upper = ([strand for _, strand in row] for row in rows)
    posts = {_lowest(use.edge): use.edge for loop in face.loops for use in loop
             if not use.edge.strands}  # fmt: skip
    ends = _chained(rows[0])
    if any(end not in posts for end in ends):
        raise FileError(f"{face.told} has no edges between those below and above")
    start, end = (_place_at(posts[end], z) for end in ends)
    shares = [k / len(lower) for k in range(1, len(lower))]
    low, high = swept(face)
    share = (z - low) / (high - low)
    centre = lower[0].centre
    turn = math.fsum((1.0 - share) * a.sweep + share * b.sweep
                     for a, b in zip(lower, upper, strict=True))  # fmt: skip
    if not turn:
        inner = [start + each * (end - start) for each in shares]
    else:
        angle = phase((end - centre) / (start - centre))
        turn = angle + TURN * round((turn - angle) / TURN)
        inner = [centre + (start - centre) * cmath.exp(1j * each * turn) for each in shares]
    places = pairwise((start, *inner, end))
    return [Arc(a, b, turn / len(lower), centre) for a, b in places]


def _lowest(edge: Edge) -> int:
    """The vertex at the lower end of an edge between two heights."""
    one, other = edge.places
    return edge.ends[0] if one.z < other.z else edge.ends[1]


def _place_at(edge: Edge, z: float) -> complex:
    """Where an edge between two heights is at one of them [mm]."""
    if edge.bend is not None:
        return edge.bend.place_at(z)
    one, other = edge.places
    share = (z - one.z) / (other.z - one.z)
    return (1.0 - share) * one.place + share * other.place


def _middles(face: Face, rows: tuple[list[Row], list[Row]]) -> list[Arc]:
    """The section half way up."""
    if _is_bent(face):
        return _section(face, rows, 0.5 * sum(swept(face)))
    return [_middle_section(one, other) for (_, one), (_, other) in zip(*rows, strict=True)]


def _middle_section(lower: Arc, upper: Arc) -> Arc:
    """The section half way up."""
    if not lower.sweep:
        start, end = 0.5 * (lower.start + upper.start), 0.5 * (lower.end + upper.end)
        return Arc(start, end, 0.0, 0j)
    share = 0.5 * (1.0 + upper.radius / lower.radius)
    start, end = (
        lower.centre + share * (each - lower.centre) for each in (lower.start, lower.end)
    )  # fmt: skip
    return Arc(start, end, lower.sweep, lower.centre)


def volume_within(face: Face) -> float:
    """The share of an inclined face in the volume [mm^3], by its sections: Simpson's rule, exact as
    these are squares of lengths, or if edges are bent Gauss's one with enough nodes.
    """
    low, high = swept(face)
    if _is_bent(face):
        return _volume_by_sections(face, low, high)
    return (high - low) * math.fsum(
        (one.moment + 4.0 * _middle_section(one, other).moment + other.moment) / 6.0
        for (_, one), (_, other) in zip(*rows_of(face), strict=True)
    )


def _volume_by_sections(face: Face, low: float, high: float) -> float:
    """The same for bent edges: sections are analytic in z but where a parabola turns."""
    half = 0.5 * (high - low)
    bends = [use.edge.bend for loop in face.loops for use in loop if use.edge.bend is not None]
    if not all(each.is_monotonic for each in bends):
        raise FileError(f"{face.told} has an edge that rises and falls")
    place = min(FARTHEST, *(abs(each.turning - low - half) / half for each in bends))
    rows = rows_of(face)
    heights, _, weights = gauss(np.array([low]), np.array([high]), nodes_beside(-place))
    return half * math.fsum(
        weight * strand.moment
        for weight, z in zip(weights.tolist(), heights[0].tolist(), strict=True)
        for strand in _section(face, rows, z)
    )


def volume_below(face: Face) -> float:
    """The same by heights, as of flat faces: the integral of z over its area seen from above."""
    low, high = swept(face)
    lower, upper = (math.fsum(strand.moment for _, strand in row) for row in rows_of(face))
    return volume_within(face) - (high * upper - low * lower)


def slope_contours(
    solid: Solid, low: float, high: float, within: float
) -> Iterator[list[AnyContour]]:
    """Of the inclined faces from `low` to `high`, `within` a length [mm], the contours of the lower
    edges, of the sections half way up and of the upper edges; raises FileError.
    """
    faces = []
    for face in filter(is_inclined, solid.faces):
        ends = swept(face)
        if abs(ends[0] - low) <= within and abs(ends[1] - high) <= within:
            faces.append(face)
    if not faces:
        raise FileError("there is no chamfer")
    rows = [rows_of(face) for face in faces]
    chains = [_chained(lower) for lower, _ in rows]
    # The order in which lower edges follow each other is that of the faces all the way up.
    order = _loops(chains)
    for place in range(3):
        found = []
        for loop in order:
            strands = []
            for k in loop:
                if place == 1:
                    strands += _middles(faces[k], rows[k])
                else:
                    strands += [strand for _, strand in rows[k][place // 2]]
            found.append(closed(strands))
        yield found


def _chained(row: Sequence[Row]) -> tuple[int, int]:
    """The vertices where a row begins and ends."""
    return row[0][0].ends[0], row[-1][0].ends[1]


def _loops(chains: Iterable[tuple[int, int]]) -> list[list[int]]:
    """The numbers of chains, loop by loop, each from the vertex where the one before it ends."""
    after = {start: (number, end) for number, (start, end) in enumerate(chains)}
    found = []
    while after:
        first = next(iter(after))
        vertex = first
        loop: list[int] = []
        while not loop or vertex != first:
            if vertex not in after:
                raise FileError("the faces of a chamfer do not go round")
            number, vertex = after.pop(vertex)
            loop.append(number)
        found.append(loop)
    return found
