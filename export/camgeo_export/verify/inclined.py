"""The inclined faces of a STEP file, cones and planes: chamfers between two heights."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from camgeo.contour.spline import Arc
from camgeo.numeric.arrays import phase
from camgeo.numeric.quadrature import gauss, nodes_beside
from camgeo.units import TURN
from camgeo_export.dxf.curves import closed
from camgeo_export.errors import FileError
from camgeo_export.matching import AnyContour
from camgeo_export.part21.curves import ALIGNED, Cone, Plane
from camgeo_export.part21.solid import Edge, Face, Solid, Use, swept

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
    return [_middle(one, other) for (_, one), (_, other) in zip(*rows, strict=True)]


def _middle(lower: Arc, upper: Arc) -> Arc:
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
        (one.moment + 4.0 * _middle(one, other).moment + other.moment) / 6.0
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
