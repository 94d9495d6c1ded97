"""The exact outlines that a file is compared with: what a verification needs of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.spline import SplineContour
from camgeo.numeric.arrays import ComplexArray
from camgeo.outline.moments import area as area_of_path
from camgeo.outline.path import Path
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from camgeo_export.verify.joints import joints_of

LOOSE = 1e-3
"""Tolerance of an outline's coarse polygon, as a fraction of its extent; it gives sizes, and
lengths for limits."""

FLAT = 1e-5
"""Kinks of an outline of lines and arcs up to this angle [rad] are not corners: those from rounding
are far smaller, those of an intended corner far larger."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """One exact outline.

    Attributes
    ----------
    name : of the boundary or the operation.
    deviation : proved bound [mm] on a contour's distance from it; raises GeometryError if the
        contour does not follow it.
    polygon : straight pieces within a tolerance [mm] of it.
    corners : (k,) complex [mm].
    length : [mm], to within the fraction `LOOSE` of the extent.
    area : [mm^2]; None where it is not known exactly.
    """

    name: str
    deviation: Callable[[Contour | SplineContour], float]
    polygon: Callable[[float], Contour]
    corners: ComplexArray
    length: float
    area: float | None


def shapes_of(boundaries: tuple[Boundary, ...], extent: float, tolerance: float) -> list[Shape]:
    """The shapes of a part's boundaries.

    Parameters
    ----------
    extent : size of the part [mm], for limits.
    tolerance : of the files [mm]; shorter arcs of an outline count as corners.
    """
    return [_shape(boundary, LOOSE * extent, tolerance) for boundary in boundaries]


def _shape(boundary: Boundary, loose: float, tolerance: float) -> Shape:
    def polygon(within: float) -> Contour:
        return boundary.polyline(within, "fast").contour

    length = polygon(loose).length
    if isinstance(boundary, CurveBoundary):
        corners = corners_of_path(boundary.path, tolerance)
        area: float | None = abs(area_of_path(boundary.path))
    else:
        exact = isinstance(boundary, ExactBoundary)
        contour = boundary.arcs(tolerance, "fast").contour
        corners = corners_of_contour(contour)
        area = abs(contour.area) if exact else None
    return Shape(boundary.name, boundary.deviation, polygon, corners, length, area)


def corners_of_path(path: Path, tolerance: float) -> ComplexArray:
    """(k,) complex [mm] corners of `path`, and the ends of its arcs shorter than `tolerance`."""
    slight = [each for each in path.pivots if abs(each.distance * each.sweep) <= tolerance]
    points = [point for each in slight for point in (each.start, each.end)]
    return np.array(points, dtype=np.complex128)


def corners_of_contour(contour: Contour) -> ComplexArray:
    """(k,) complex [mm] vertices at which a contour of tangent pieces still has a kink."""
    joints = joints_of(contour)
    corners: ComplexArray = joints.places[joints.kinks > FLAT]
    return corners
