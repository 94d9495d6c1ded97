"""The chamfers of a part: which edges have one, and whether there is room for it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from typing import Final

import numpy as np

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import surely_apart, winding_number
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import OF_RETURN, Bevel, Boundary, Part, Wall
from camgeo.part.spec import BOTH, KEY, LOWER, UPPER, Chamfer, Chamfers
from camgeo.units import at_cam_angles

TABLES: Final = {
    "outline": "outline",
    "inner flank": "outline",
    "outer flank": "outline",
    "rim": "rim",
    "bore": "bore",
    "hub": "hub",
    "lower hub": "hub",
    "bolt hole": "bolt_circle",
    "counterbore": "bolt_circle",
    "lightening hole": "lightening_holes",
}
"""The fields of `Chamfers`, by the names of boundaries without a number."""


def bevelled(part: Part, chamfers: Chamfers, tolerance: float) -> Part:
    """The part with chamfers.

    Parameters
    ----------
    part : with its heights, and sharp edges.
    tolerance : of contours [mm] that show that chamfers stay clear of all else.

    Raises
    ------
    GeometryError
        With the key of the scene, if there is no room for a chamfer, or no edge to have it.
    """
    part.require_heights()
    found: list[Bevel] = []
    for field in fields(chamfers):
        chamfer: Chamfer | None = getattr(chamfers, field.name)
        if chamfer is None:
            continue
        own = list(_bevels(part, field.name, chamfer, tolerance))
        if not own:
            where = "" if chamfer.edges == BOTH else f" on the {chamfer.edges} side"
            message = f"there is no such edge{where}"
            raise GeometryError(message, key=f"{KEY}.{field.name}")
        found += own
    for bevel in found:
        _require_clear(bevel, found, part, tolerance)
    return replace(part, bevels=tuple(found))


def _table(boundary: Boundary) -> str:
    """Which chamfer a boundary has."""
    name = boundary.name.removeprefix(OF_RETURN)
    kind, _, number = name.rpartition(" ")
    return TABLES.get(kind if number.isdigit() else name, "")


def _bevels(part: Part, name: str, chamfer: Chamfer, tolerance: float) -> Iterator[Bevel]:
    """A chamfer along all edges that it is stated for."""
    key, width = f"{KEY}.{name}.width", chamfer.width
    for wall in part.walls:
        if _table(wall.boundary) != name:
            continue
        ends = [
            upper
            for upper, side in ((False, LOWER), (True, UPPER))
            if chamfer.edges in (side, BOTH) and _is_outer(part, wall, tolerance, upper=upper)
        ]
        if not ends:
            continue
        high = wall.z1 - wall.z0
        if len(ends) * width >= high:
            raise GeometryError(
                f"must be less than {high / len(ends):.6g} mm, of a wall of {high:.6g} mm with"
                f" {'two such edges' if len(ends) > 1 else 'one such edge'}",
                key=key,
                value=f"{width:g}",
            )
        edge = _edge(wall.boundary, width, key)
        for upper in ends:
            z = wall.z1 if upper else wall.z0
            yield Bevel(wall.boundary, edge, width, width, z, upper=upper)


def _is_outer(part: Part, wall: Wall, tolerance: float, *, upper: bool) -> bool:
    """Whether a wall ends at a face on which nothing stands beyond it: neither at the foot of a
    hub, nor at the floor of a groove or a counterbore.
    """
    if upper:
        beyond = [layer for layer in part.layers if layer.z0 == wall.z1]
    else:
        beyond = [layer for layer in part.layers if layer.z1 == wall.z0]
    place = complex(wall.boundary.beside(tolerance).contour.vertices[0])
    return not any(
        winding_number(each.beside(tolerance).contour, place)
        for layer in beyond
        for each in layer.boundaries
    )


def _edge(boundary: Boundary, width: float, key: str) -> Boundary:
    """The inner edge of a chamfer, exact; GeometryError with the `key` if there is none."""
    name = f"chamfer of the {boundary.name}"
    if isinstance(boundary, CurveBoundary):
        _require_parallel(boundary, width, key)
    elif (
        isinstance(boundary, ExactBoundary)
        and not boundary.hole
        and width >= (radius := boundary.round_radius)
    ):
        message = f"must be less than the radius of the {boundary.name}, {radius:.6g} mm"
        raise GeometryError(message, key=key, value=f"{width:g}")
    return boundary.inset(width, name)


def _require_parallel(boundary: CurveBoundary, width: float, key: str) -> None:
    """GeometryError unless the parallel at `width` [mm] within the material is whole.

    It is the flank that a roller larger by as much would make: where nothing of that is trimmed,
    the parallel neither has a cusp nor comes to itself, and nor do those between.
    """
    value = f"{width:g}"
    if any(each.distance == 0.0 for each in boundary.path.pivots):
        message = f"the {boundary.name} has a corner, along which there is no chamfer"
        raise GeometryError(message, key=key, value=value)
    curve = boundary.path.stretches[0].curve
    sign = 1.0 if boundary.hole else -1.0
    limit, angle = _smallest_radius(curve, sign)
    if width >= limit:
        raise GeometryError(
            f"must be less than {limit:.6g} mm, the smallest radius of the {boundary.name} where it"
            f" goes round material, {at_cam_angles(angle)}",
            key=key,
            value=value,
        )
    if not curve.pitch.follower.has_pitch_curve:
        return  # the contact curve of a flat face is convex, and so are its parallels
    try:
        trimmed = real_outline(WorkingCurve(curve.pitch, curve.distance + sign * width)).is_trimmed
    except (GeometryError, UndercutError):
        trimmed = True
    if trimmed:
        message = f"is too large: the chamfer of the {boundary.name} would come to itself"
        raise GeometryError(message, key=key, value=value)


def _smallest_radius(curve: WorkingCurve, sign: float) -> tuple[float, float]:
    """Of a flank where it goes round material [mm], and at which cam angle [rad]; infinite if it
    does so nowhere. `sign` is that of the parallel within the material.

    A parallel of the pitch curve at d is regular while 1 + d kappa > 0.
    """
    bends = curvature_extremes(curve.pitch)
    bend, angle = bends.smallest() if sign > 0.0 else bends.largest()
    against = -sign * bend
    if against <= 0.0:
        return math.inf, angle
    return 1.0 / against - sign * curve.distance, angle


def _reach(bevel: Bevel) -> float:
    """How far [mm] from its boundary the edge of a chamfer is at most: farther at corners."""
    wall, edge = bevel.boundary, bevel.edge
    if isinstance(wall, ExactBoundary) and isinstance(edge, ExactBoundary) and wall.corner_radius:
        return float(np.max(np.abs(edge.exact.vertices - wall.exact.counter_clockwise().vertices)))
    return bevel.width


def _heights(bevel: Bevel) -> tuple[float, float]:
    """Between which a chamfer is [mm]."""
    return min(bevel.z, bevel.foot), max(bevel.z, bevel.foot)


def _require_clear(bevel: Bevel, bevels: Sequence[Bevel], part: Part, tolerance: float) -> None:
    """GeometryError if a chamfer comes to another boundary, or to its chamfer, at its heights."""
    low, high = _heights(bevel)
    near = {
        each.name: each
        for layer in part.layers
        if layer.z0 <= high and low <= layer.z1
        for each in layer.boundaries
        if each != bevel.boundary
    }
    own = bevel.boundary.beside(tolerance)
    for other in near.values():
        widths = (
            _reach(each)
            for each in bevels
            if each.boundary == other and _heights(each)[0] <= high and low <= _heights(each)[1]
        )
        apart = surely_apart(own, other.beside(tolerance))
        if apart <= _reach(bevel) + max(widths, default=0.0):
            name = _table(bevel.boundary)
            raise GeometryError(
                f"the chamfer of the {bevel.boundary.name} comes to the {other.name},"
                f" {apart:.4g} mm away",
                key=f"{KEY}.{name}.width",
                value=f"{bevel.width:g}",
            )
