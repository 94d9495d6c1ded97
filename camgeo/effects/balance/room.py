"""Whether holes lie in the material of a disc."""

from __future__ import annotations

import math
from functools import reduce
from operator import and_, xor
from typing import Any, Final

import numpy as np

from camgeo.effects.balance.holes import Row
from camgeo.part.part import Boundary, Part

SHARE: Final = 1e-4
"""Of a hole's diameter by which the polygons may be off the boundaries; it is taken off the
distances that are found."""


class Room:
    """The material through the whole thickness of a disc.

    Parameters
    ----------
    part : its boundaries.
    largest : diameter of a hole at most [mm].

    Raises
    ------
    UndercutError, ToleranceError, GeometryError
        If a boundary has no polygon close enough.
    """

    def __init__(self, part: Part, largest: float) -> None:
        self._tolerance = SHARE * largest
        self._boundaries = {each.name: self._polygon(each) for each in part.boundaries}
        # Boundaries lie inside each other: material begins at one and ends at the next.
        sections = [
            reduce(xor, (self._boundaries[each.name] for each in layer.boundaries))
            for layer in part.layers
        ]
        self._material = reduce(and_, sections)

    def _polygon(self, boundary: Boundary) -> Any:
        import shapely  # its import costs more than the rest of the effect

        vertices = boundary.polyline(self._tolerance, "fast").contour.vertices
        return shapely.Polygon(np.column_stack((vertices.real, vertices.imag)))

    def fault(self, row: Row) -> str:
        """Why the holes do not fit, a clause; empty if they do."""
        import shapely

        for angle, centre in zip(row.directions, row.centres, strict=True):
            place = f"the hole in the direction {math.degrees(angle) % 360.0:.4f} deg"
            if not shapely.contains_xy(self._material, centre.real, centre.imag):
                return f"{place} has its centre outside of the material"
            near, name = self._nearest(centre)
            if near <= 0.5 * row.diameter:
                return (
                    f"{place}, {row.diameter:.4f} mm in diameter, comes across the {name}, whose"
                    f" distance from its centre is {near:.4f} mm"
                )
        return ""

    def wall(self, row: Row) -> float:
        """Least material between a hole and a boundary [mm], for holes that fit."""
        return min(self._nearest(centre)[0] for centre in row.centres) - 0.5 * row.diameter

    def _nearest(self, centre: complex) -> tuple[float, str]:
        """Distance of the nearest boundary from `centre` [mm], a lower bound; and its name."""
        import shapely

        point = shapely.Point(centre.real, centre.imag)
        return min(
            (float(polygon.exterior.distance(point)) - self._tolerance, name)
            for name, polygon in self._boundaries.items()
        )
