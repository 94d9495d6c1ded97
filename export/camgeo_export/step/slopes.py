"""Walls with chamfers: rings of edges that faces share, cones on arcs and inclined planes on lines.

The edge of a chamfer has a line or an arc for each of its wall's, at the same angles about the same
centres, so that their ends lie on straight lines in both faces that meet there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgeo.contour.contour import Contour
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
    places = []
    for before, after in zip((arcs[-1], *arcs[:-1]), arcs, strict=True):
        one, other = (1j * each.heading(after.start) for each in (before, after))
        one, other = one / abs(one), other / abs(other)
        bent = before.sweep or after.sweep
        if bent and abs(other - one) > SHARPEST:
            message = f"the {name} has a corner beside an arc, along which there is no cone"
            raise GeometryError(message, key="part.chamfers")
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
        line = (
            pen.rising(lower.points[k], along, upper.z - lower.z)
            if lower.strands is not upper.strands
            else pen.post(lower.points[k])
        )
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
    first = (one.start if ahead else one.end) - one.centre
    base = pen.placement(one.centre, lower.z if grows else upper.z, UP if grows else DOWN, first)
    return pen.cone(base, min(radii), angle), one.sweep > 0.0
