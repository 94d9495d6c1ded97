"""Walls with chamfers: rings of edges that faces share, cones on arcs and inclined planes on lines.

The edge of a chamfer has a line or an arc for each of its wall's, at the same angles about the same
centres, so that their ends lie on straight lines in both faces that meet there. Where a line and an
arc meet in a corner, it is mitred, and the plane and the cone meet along a parabola.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.parallel import parallel as mitred
from camgeo.contour.spline import Arc
from camgeo.errors import GeometryError, ToleranceError
from camgeo_export.step.frame import UNCERTAINTY
from camgeo_export.step.geometry import DOWN, UP, Ends, Pen, Strand, radius_of
from camgeo_export.step.text import Ref, flag

SHARPEST = 1e-3
"""Turn [rad] at a joint up to which an arc of the parallel still ends on its circle."""


def parallel(strands: Sequence[Strand], width: float, name: str) -> tuple[Arc, ...]:
    """The strands `width` [mm] farther to the left, where the material is.

    Raises
    ------
    GeometryError
        With key "output.step.walls" for splines, with "part.chamfers" where an arc is too small.
    ToleranceError
        If ends are off their circles by more than the uncertainty that the file states.
    """
    arcs = [strand for strand in strands if isinstance(strand, Arc)]
    if len(arcs) < len(strands):
        message = "chamfers are along lines and arcs: a parallel of a spline is none"
        raise GeometryError(message, key="output.step.walls", value='"spline"')
    if any(_is_bent(*pair) for pair in zip((arcs[-1], *arcs[:-1]), arcs, strict=True)):
        return _mitred(arcs, width, name)
    places = []
    for before, after in zip((arcs[-1], *arcs[:-1]), arcs, strict=True):
        one, other = (1j * each.heading(after.start) for each in (before, after))
        one, other = one / abs(one), other / abs(other)
        places.append(after.start + width * (one + other) / (1.0 + (one.conjugate() * other).real))
    found = []
    for strand, (start, end) in zip(arcs, pairwise((*places, places[0])), strict=True):
        radius = radius_of(strand) - math.copysign(width, strand.sweep)
        if strand.sweep and not radius > 0.0:
            message = f"an arc of the {name} has no parallel {width:g} mm within the material"
            raise GeometryError(message, key="part.chamfers", value=f"{width:g}")
        moved = Arc(start, end, strand.sweep, strand.centre)
        off = max(abs(abs(each - strand.centre) - radius) for each in (start, end))
        if strand.sweep and off > UNCERTAINTY:
            message = f"arcs of the {name} do not meet at the edge of its chamfer"
            raise ToleranceError(message, UNCERTAINTY, off)
        found.append(moved)
    return tuple(found)


def _mitred(arcs: Sequence[Arc], width: float, name: str) -> tuple[Arc, ...]:
    """The same of strands of which some meet in corners."""
    try:
        moved = mitred(contour_of(arcs), -width)
    except GeometryError:
        message = f"the {name} has no parallel {width:g} mm within the material"
        raise GeometryError(message, key="part.chamfers", value=f"{width:g}") from None
    pieces = zip(moved.vertices.tolist(), moved.ends.tolist(), moved.sweeps.tolist(),
                 moved.centres.tolist(), strict=True)  # fmt: skip
    return tuple(Arc(*piece) for piece in pieces)


def _is_bent(before: Arc, after: Arc) -> bool:
    """Whether a line and an arc meet in a corner; raises GeometryError if two arcs do."""
    if not before.sweep and not after.sweep:
        return False
    one, other = (each.heading(after.start) for each in (before, after))
    if abs(other / abs(other) - one / abs(one)) <= SHARPEST:
        return False
    if before.sweep and after.sweep:
        message = "two arcs meet in a corner, along which there is no chamfer"
        raise GeometryError(message, key="part.chamfers")
    return True


def _bend(line: Arc, arc: Arc, start: complex, end: complex) -> tuple[complex, float]:
    """The middle one of the three control points of the parabola along which a corner moves from
    `start` to `end`: its place, and its height as a share of the way.

    Along the line, u from the foot of the centre, it moves evenly with the parameter of the
    parabola; across it and upwards with u^2.
    """
    way = (line.end - line.start) / abs(line.end - line.start)
    one, other = (abs(((each - arc.centre) * way.conjugate()).real) for each in (start, end))
    share = one / (one + other)
    along = ((end - start) * way.conjugate()).real * way
    return start + 0.5 * along + share * (end - start - along), share


def contour_of(strands: Sequence[Arc]) -> Contour:
    """The same pieces as a contour."""
    vertices, sweeps, centres = zip(
        *((each.start, each.sweep, each.centre) for each in strands), strict=True
    )
    return Contour(np.array(vertices), np.array(sweeps), np.array(centres))


@dataclass(frozen=True, slots=True)
class Row:
    """The ends and the edges of strands at one height.

    Attributes
    ----------
    strands : their pieces.
    z : height [mm].
    points, vertices, edges : of the file, one for each strand; vertices at their starts.
    """

    strands: tuple[Strand, ...]
    z: float
    points: list[Ref]
    vertices: list[Ref]
    edges: list[Ref]


def row_of(pen: Pen, strands: tuple[Strand, ...], z: float) -> Row:
    """The edges along strands at a height [mm]."""
    file = pen.file
    points = [pen.point(each.start, z) for each in strands]
    vertices = [file.add("VERTEX_POINT", "", each) for each in points]
    edges = []
    for k, strand in enumerate(strands):
        after = (k + 1) % len(strands)
        curve, same = pen.level(strand, Ends(z, points[k], points[after]))
        edges.append(
            file.add("EDGE_CURVE", "", vertices[k], vertices[after], curve, flag(same))
        )  # fmt: skip
    return Row(strands, z, points, vertices, edges)


def posts_of(pen: Pen, lower: Row, upper: Row) -> list[Ref]:
    """The edges from the ends of one row to those of the row above."""
    found = []
    for k, (one, other) in enumerate(zip(lower.strands, upper.strands, strict=True)):
        along = other.start - one.start
        before, after = lower.strands[k - 1], one
        if lower.strands is upper.strands:
            line = pen.post(lower.points[k])
        elif isinstance(before, Arc) and isinstance(after, Arc) and _is_bent(before, after):
            pair = (before, after) if after.sweep else (after, before)
            place, share = _bend(*pair, one.start, other.start)
            middle = pen.point(place, (1.0 - share) * lower.z + share * upper.z)
            line = pen.parabola((lower.points[k], middle, upper.points[k]))
        else:
            line = pen.rising(lower.points[k], along, upper.z - lower.z)
        ends = (lower.vertices[k], upper.vertices[k])
        found.append(pen.file.add("EDGE_CURVE", "", *ends, line, flag(True)))
    return found


def surface_of(pen: Pen, lower: Row, upper: Row, k: int) -> tuple[Ref, bool]:
    """The surface between strands `k` of two rows, and whether its normal points to their right."""
    one, other = lower.strands[k], upper.strands[k]
    if lower.strands is upper.strands:
        return pen.upright(one, Ends(lower.z, lower.points[k], lower.points[k]))
    assert isinstance(one, Arc)  # as all strands of chamfers are
    assert isinstance(other, Arc)
    high = upper.z - lower.z
    if not one.sweep:
        way = (one.end - one.start) / abs(one.end - one.start)
        inwards = ((other.start - one.start) * (1j * way).conjugate()).real
        # To the right of the way by the height, and up by as much as the face leans in.
        return pen.plane(lower.points[k], (-1j * way * high, inwards), way), True
    radii = radius_of(one), radius_of(other)
    angle = math.atan2(abs(radii[1] - radii[0]), high)
    grows = radii[1] > radii[0]
    # From its smaller end up or down; it runs counter-clockwise about its axis, from the first.
    ahead = (one.sweep > 0.0) == grows
    longer = one if abs(one.sweep) >= abs(other.sweep) else other
    first = (longer.start if ahead else longer.end) - one.centre
    base = pen.placement(one.centre, lower.z if grows else upper.z, UP if grows else DOWN, first)
    return pen.cone(base, min(radii), angle), one.sweep > 0.0
