"""The inclined faces of a STEP file, cones and planes: chamfers between two heights."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from camgeo.contour.spline import Arc
from camgeo_export.dxf.curves import closed
from camgeo_export.errors import FileError
from camgeo_export.matching import AnyContour
from camgeo_export.part21.curves import ALIGNED, Cone, Plane
from camgeo_export.part21.solid import Face, Solid, Use, swept

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
    these are squares of lengths.
    """
    low, high = swept(face)
    return (high - low) * math.fsum(
        (one.moment + 4.0 * _middle(one, other).moment + other.moment) / 6.0
        for (_, one), (_, other) in zip(*rows_of(face), strict=True)
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
                for (_, one), (_, other) in zip(*rows[k], strict=True):
                    strands.append((one, _middle(one, other), other)[place])
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
