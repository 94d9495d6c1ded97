"""Walls of a solid that its tolerance does not keep apart."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import combinations

import numpy as np
import shapely

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import least_distance
from camgeo.contour.pieces import Pieces
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Boundary, Part

Nearest = Callable[[str, str], tuple[float, complex] | None]
"""Of the rings of two boundaries, by their names: how near they come [mm], and where; None if that
is farther than the tolerance."""


def require_apart(part: Part, nearest: Nearest, tolerance: float) -> None:
    """Raise GeometryError with key "part" and the place if two walls, or edges at one height, come
    within `tolerance` [mm], that of the rings: no file of it tells them apart.
    """
    for one, other in _together(part):
        if (found := nearest(one, other)) is not None:
            apart, place = found
            message = (
                f"a solid within {tolerance:g} mm does not keep the {one} and the {other} apart:"
                f" {apart:.3g} mm are left near ({place.real:.5g}, {place.imag:.5g}) mm; take a"
                " smaller tolerance"
            )
            raise GeometryError(message, key="part")


def _together(part: Part) -> list[tuple[str, str]]:
    """Names of boundaries that are in one layer, or end or begin at one height."""
    groups: list[Iterable[Boundary]] = [layer.boundaries for layer in part.layers]
    groups += [level.boundaries for level in part.levels]
    found = {
        (one.name, other.name): None for group in groups for one, other in combinations(group, 2)
    }
    return list(found)


def of_polygons(rings: Mapping[str, ComplexArray], tolerance: float) -> Nearest:
    """Of polygons (n,) [mm]."""
    lines = {
        name: shapely.LinearRing(np.column_stack((ring.real, ring.imag)))
        for name, ring in rings.items()
    }
    # Without their trees each side of one is compared with each of the other.
    shapely.prepare(list(lines.values()))

    def nearest(one: str, other: str) -> tuple[float, complex] | None:
        if not shapely.dwithin(lines[one], lines[other], tolerance):
            return None
        x, y = shapely.get_coordinates(shapely.shortest_line(lines[one], lines[other]))[0]
        return float(shapely.distance(lines[one], lines[other])), complex(x, y)

    return nearest


def of_contours(contours: Mapping[str, Contour], tolerance: float) -> Nearest:
    """Of contours of lines and arcs, in closed form."""
    boxes = {name: _box(contour) for name, contour in contours.items()}

    def nearest(one: str, other: str) -> tuple[float, complex] | None:
        if not shapely.dwithin(boxes[one], boxes[other], tolerance):
            return None
        runs = [Pieces.around([contours[name]]) for name in (one, other)]
        apart = least_distance(*runs)
        if apart > tolerance:
            return None
        corners = contours[one].vertices, contours[other].vertices
        off = np.abs(corners[0][:, None] - corners[1])
        return apart, complex(corners[0][np.argmin(np.min(off, axis=1))])

    return nearest


def _box(contour: Contour) -> shapely.Polygon:
    """Around the contour: no piece is farther from its ends than its arc is high."""
    high = np.where(
        contour.sweeps != 0.0, 2.0 * contour.radii * np.sin(0.25 * contour.sweeps) ** 2, 0.0
    )
    points = np.concatenate((contour.vertices, contour.ends))
    reach = float(np.max(high, initial=0.0))
    low, top = np.min(points.real), np.max(points.real)
    left, right = np.min(points.imag), np.max(points.imag)
    return shapely.box(low - reach, left - reach, top + reach, right + reach)
