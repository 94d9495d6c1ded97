"""Equal holes through a disc that cancel its unbalance.

The holes are in a row on a circle about the cam axis, symmetric about the heavy direction. Each of
n holes of diameter d on the radius R, through the thickness b of a disc of density rho, removes the
mass rho b pi d^2 / 4; neighbours are the angle delta apart. Together they remove the unbalance

    U = rho b pi d^2 / 4 * R * sin(n delta/2) / sin(delta/2),

the sum of n vectors of equal length, each rotated by delta relative to the previous one (Norton,
"Machine Design", chapter on balancing, static balance, for the vector sum of the m r products).
Half a diameter of material remains between neighbours: sin(delta/2) = 3 d / (4 R).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from operator import and_, sub, xor
from typing import Any, Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots
from camgeo.part.part import Boundary, Part

MOST_HOLES: Final = 24
"""If more were needed, the disc should be redesigned rather than balanced."""

PITCH: Final = 1.5
"""Centre distance of neighbouring holes, in diameters."""

SHARE: Final = 1e-4
"""Largest deviation of the polygons from the boundaries, as a share of the hole diameter; it is
subtracted from the distances found."""


@dataclass(frozen=True, slots=True)
class Row:
    """A row of equal holes.

    Attributes
    ----------
    count : number of holes.
    diameter : of each [mm].
    radius : of the circle of their centres about the cam axis [mm].
    directions : of their centres [rad], counter-clockwise from the x axis, ascending.
    """

    count: int
    diameter: float
    radius: float
    directions: tuple[float, ...]

    @property
    def centres(self) -> tuple[complex, ...]:
        """Of the holes, in cam coordinates [mm]."""
        return tuple(
            complex(self.radius * math.cos(angle), self.radius * math.sin(angle))
            for angle in self.directions
        )

    def moment(self, per_area: float) -> complex:
        """The unbalance that they remove [t mm], for `per_area` [t/mm^2] of the disc."""
        each = per_area * 0.25 * math.pi * self.diameter**2
        return each * complex(
            math.fsum(centre.real for centre in self.centres),
            math.fsum(centre.imag for centre in self.centres),
        )


def rows(unbalance: complex, per_area: float, radius: float, largest: float) -> Iterator[Row]:
    """Rows of holes that cancel `unbalance`, those with few holes first.

    Parameters
    ----------
    unbalance : [t mm], its direction in cam coordinates; not 0.
    per_area : mass of the disc per unit of area [t/mm^2], density times thickness.
    radius : of the circle of their centres [mm].
    largest : largest diameter of a hole [mm].

    A row with its gaps spans at most half a turn; up to there, more holes remove more.
    """
    heavy = math.atan2(unbalance.imag, unbalance.real)
    for count in range(1, MOST_HOLES + 1):
        diameter = _diameter(abs(unbalance), per_area, radius, count)
        if diameter is None or diameter > largest:
            continue
        delta = 0.0 if count == 1 else 2.0 * math.asin(0.5 * PITCH * diameter / radius)
        middle = 0.5 * (count - 1)
        directions = tuple(heavy + (k - middle) * delta for k in range(count))
        yield Row(count, diameter, radius, directions)


def _diameter(unbalance: float, per_area: float, radius: float, count: int) -> float | None:
    """Diameter of `count` holes that cancel `unbalance`; None if they need over half a turn."""
    share = unbalance / (per_area * 0.25 * math.pi * radius)  # d^2 sin(n delta/2) / sin(delta/2)
    if count == 1:
        return math.sqrt(share)
    # With u = delta/2 and d = 2 R sin(u) / PITCH: sin(u) sin(n u), which grows up to n u = pi/2.
    sought = share * (0.5 * PITCH / radius) ** 2
    last = 0.5 * math.pi / count
    if sought > math.sin(last):
        return None

    def missing(u: FloatArray) -> FloatArray:
        found: FloatArray = np.sin(u) * np.sin(count * u) - sought
        return found

    u = bracketed_roots(missing, np.array([0.0]), np.array([last]))
    return 2.0 * radius * math.sin(float(u[0])) / PITCH


def most(per_area: float, radius: float, largest: float) -> float:
    """The largest unbalance [t mm] that a row of holes can remove."""

    def of(count: int) -> float:
        if count == 1:
            return largest**2
        u = min(math.asin(min(0.5 * PITCH * largest / radius, 1.0)), 0.5 * math.pi / count)
        diameter = min(largest, 2.0 * radius * math.sin(u) / PITCH)
        return diameter**2 * math.sin(count * u) / math.sin(u)

    best = max(of(count) for count in range(1, MOST_HOLES + 1))
    return per_area * 0.25 * math.pi * radius * best


class Room:
    """The material through the whole thickness of a disc, beside its hubs.

    Parameters
    ----------
    part : its boundaries.
    largest : largest diameter of a hole [mm].

    Raises
    ------
    UndercutError, ToleranceError, GeometryError
        If a boundary has no polygon that is close enough.
    """

    def __init__(self, part: Part, largest: float) -> None:
        self._tolerance = SHARE * largest
        self._boundaries = {each.name: self._polygon(each) for each in part.boundaries}
        # Boundaries are nested: material begins at one and ends at the next.
        sections = [
            reduce(xor, (self._boundaries[each.name] for each in layer.boundaries))
            for layer in part.disc
        ]
        material = reduce(and_, sections)
        hubs = [layer.boundaries[0] for layer in part.layers if layer not in part.disc]
        self._material = reduce(sub, (self._boundaries[each.name] for each in hubs), material)

    def _polygon(self, boundary: Boundary) -> Any:
        import shapely  # its import takes longer than the rest of the effect

        vertices = boundary.polyline(self._tolerance, "fast").contour.vertices
        return shapely.Polygon(np.column_stack((vertices.real, vertices.imag)))

    def fault(self, row: Row) -> str:
        """The reason why the holes do not fit, as a clause; empty if they fit."""
        import shapely

        for angle, centre in zip(row.directions, row.centres, strict=True):
            place = f"the hole in the direction {math.degrees(angle) % 360.0:.4f} deg"
            if not shapely.contains_xy(self._material, centre.real, centre.imag):
                return f"{place} has its centre outside the material"
            near, name = self._nearest(centre)
            if near <= 0.5 * row.diameter:
                return (
                    f"{place}, {row.diameter:.4f} mm in diameter, cuts into the {name}, which is"
                    f" {near:.4f} mm from its centre"
                )
        return ""

    def wall(self, row: Row) -> float:
        """Smallest wall between a hole and a boundary [mm], for holes that fit."""
        return min(self._nearest(centre)[0] for centre in row.centres) - 0.5 * row.diameter

    def _nearest(self, centre: complex) -> tuple[float, str]:
        """A lower bound of the distance of the nearest boundary from `centre` [mm], and its
        name.
        """
        import shapely

        point = shapely.Point(centre.real, centre.imag)
        return min(
            (float(polygon.exterior.distance(point)) - self._tolerance, name)
            for name, polygon in self._boundaries.items()
        )
