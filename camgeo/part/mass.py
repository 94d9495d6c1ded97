"""Volume, centre of mass and moments of inertia of a part, from its exact boundaries.

The body has a uniform density. Each face around it contributes what its boundary encloses between
its heights, with the sign of its material side, so any list of layers is covered.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.numeric.quadrature import gauss, nodes_beside
from camgeo.outline.moments import Moments, total
from camgeo.part.bands import Band
from camgeo.part.part import Boundary, Layer, Part

TOLERANCE: Final = 1e-10
"""Of the integrals over each boundary, see `camgeo.outline.moments.path_moments`."""

NODES: Final = 3
"""Of the Gauss rule over the height of a chamfer without corners."""


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
    for each in _slices(part):
        sign = -1.0 if each.section.hole else 1.0
        plane = each.section.moments(tolerance).scaled(sign)
        plane2 = each.section.second_moments(tolerance).scaled(sign)
        height, z1, z2 = each.height, each.first, each.second
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


@dataclass(frozen=True, slots=True)
class _Slice:
    """A section, and what it stands for in integrals of 1, z and z^2 over z [mm, mm^2, mm^3]."""

    section: Boundary
    height: float
    first: float
    second: float


def _slices(part: Part) -> Iterator[_Slice]:
    """The sections over which integrals of a part are taken: of an upright face its only one.

    Of a chamfer those at the nodes of a Gauss rule. What a parallel of a smooth boundary encloses
    is a polynomial of its distance, the area of degree 2, the first moments of 3, the second ones
    of 4, and with the powers of z none is above degree 4; the rule is exact for 5. Beside mitred
    corners more nodes are exact but for rounding, see `camgeo.contour.parallel.corner_radius`.
    """
    for band in part.bands:
        if band.is_upright:
            yield _Slice(
                band.wall, *((band.z1**power - band.z0**power) / power for power in (1, 2, 3))
            )
            continue
        yield from _sections(band)


def _sections(band: Band) -> Iterator[_Slice]:
    """The sections of a chamfer over which integrals are taken."""
    radius = band.wall.corner_radius
    nodes = NODES if radius is None else nodes_beside(-1.0 - radius / band.width)
    places, half, weights = gauss(np.array([band.z0]), np.array([band.z1]), nodes)
    for z, share in zip(places[0].tolist(), (half[0] * weights).tolist(), strict=True):
        yield _Slice(band.section(z), share, share * z, share * z * z)


def volume_within(band: Band, tolerance: float = TOLERANCE) -> float:
    """What a chamfer encloses [mm^3], of a hole as well."""
    return math.fsum(each.height * each.section.moments(tolerance).area for each in _sections(band))


def section_area(layer: Layer, tolerance: float = TOLERANCE) -> float:
    """Area of the material in a layer [mm^2]."""
    return total(_material(each, tolerance) for each in layer.boundaries).area


def disc_moments(part: Part, density: float, tolerance: float) -> Moments:
    """Mass [t] as the area, and mass times centre of mass [t mm] as the first moment.

    Parameters
    ----------
    part : with known thickness. Each boundary counts with the height of its faces.
    density : [t/mm^3].
    tolerance : of the integrals over the outlines, see `camgeo.outline.moments.path_moments`.
    """
    return total(
        total(_material(each.section, tolerance) for each in slices).scaled(density * height)
        for height, slices in groupby(_slices(part), lambda each: each.height)
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
