"""Volume, centre of mass and moments of inertia of a part, from its exact boundaries.

The body has a uniform density. Each upright face contributes what its boundary encloses between its
heights, with the sign of its material side, so any list of layers is covered.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.outline.moments import Moments, total
from camgeo.part.part import Boundary, Layer, Part

TOLERANCE: Final = 1e-10
"""Of the integrals over each boundary, see `camgeo.outline.moments.path_moments`."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A part as a body of uniform density, in cam coordinates with z upward, 0 on the upper face of
    the disc.

    Attributes
    ----------
    volume : [mm^3].
    centre : (3,) centre of mass [mm].
    inertia : (3, 3) inertia tensor about the centre of mass, for a density of 1 [mm^5]: moments of
        inertia in the diagonal, products with a minus sign off it.
    axial : moment of inertia about the cam axis, for a density of 1 [mm^5].
    share : estimate of the relative error of volume and moment of inertia about the cam axis.
    centre_error : estimate of the error of the centre of mass in the plane [mm].
    """

    volume: float
    centre: FloatArray
    inertia: FloatArray
    axial: float
    share: float
    centre_error: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", frozen(self.centre, np.float64))
        object.__setattr__(self, "inertia", frozen(self.inertia, np.float64))


def solid(part: Part, tolerance: float = TOLERANCE) -> Solid:
    """The part as a body; raises GeometryError like `Part.require_heights`."""
    part.require_heights()
    volume, first, second, axial = [], [], [], []
    volume_errors, first_errors, axial_errors = [], [], []
    for wall in part.walls:
        sign = -1.0 if wall.boundary.hole else 1.0
        plane = wall.boundary.moments(tolerance).scaled(sign)
        plane2 = wall.boundary.second_moments(tolerance).scaled(sign)
        height, z1, z2 = ((wall.z1**power - wall.z0**power) / power for power in (1, 2, 3))
        x, y = plane.first.real, plane.first.imag
        xx, yy = (0.5 * (plane2.polar + turn * plane2.square.real) for turn in (1.0, -1.0))
        xy = 0.5 * plane2.square.imag
        volume.append(plane.area * height)
        first.append((x * height, y * height, plane.area * z1))
        second.append((xx * height, yy * height, plane.area * z2, xy * height, x * z1, y * z1))
        axial.append(plane2.polar * height)
        volume_errors.append(plane.area_error * height)
        first_errors.append(plane.first_error * height)
        axial_errors.append(plane2.polar_error * height)
    whole = math.fsum(volume)
    centre = np.array([math.fsum(column) for column in zip(*first, strict=True)]) / whole
    xx, yy, zz, xy, xz, yz = (math.fsum(column) for column in zip(*second, strict=True))
    about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    about -= whole * np.outer(centre, centre)
    turning, unsure = math.fsum(axial), math.fsum(volume_errors) / whole
    return Solid(
        volume=whole,
        centre=centre,
        inertia=np.trace(about) * np.eye(3) - about,
        axial=turning,
        share=max(unsure, math.fsum(axial_errors) / turning),
        centre_error=math.fsum(first_errors) / whole + unsure * float(np.hypot(*centre[:2])),
    )


def section_area(layer: Layer, tolerance: float = TOLERANCE) -> float:
    """Area of the material in a layer [mm^2]."""
    return total(_material(each, tolerance) for each in layer.boundaries).area


def disc_moments(part: Part, density: float, tolerance: float) -> Moments:
    """Mass [t] as the area, and mass times centre of mass [t mm] as the first moment.

    Parameters
    ----------
    part : with known thickness. Each boundary counts with the height of its walls.
    density : [t/mm^3].
    tolerance : of the integrals over the outlines, see `camgeo.outline.moments.path_moments`.
    """
    return total(
        total(_material(wall.boundary, tolerance) for wall in walls).scaled(density * height)
        for height, walls in groupby(part.walls, lambda wall: wall.z1 - wall.z0)
    )


def _material(boundary: Boundary, tolerance: float) -> Moments:
    """Inside a boundary there is material along its wall; inside a hole there is none."""
    return boundary.moments(tolerance).scaled(-1.0 if boundary.hole else 1.0)


def largest_diameter(part: Part) -> tuple[float, float | None]:
    """Of the circle about the cam axis that the part sweeps [mm]; where a flank is its farthest
    place, with the cam angle [rad] at which that is in contact.
    """
    outer = [each.farthest() for each in part.boundaries if not each.hole]
    radius, place = max(outer, key=lambda found: found[0])
    return 2.0 * radius, place
