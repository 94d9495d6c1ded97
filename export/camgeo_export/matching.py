"""Assignment of a file's contours to the boundaries of the part."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.spline import SplineContour
from camgeo.part.part import Boundary
from camgeo_export.errors import FileError
from camgeo_export.verify.farthest import points_of

LOOSE = 1e-3
"""Tolerance at which a boundary's area is computed, relative to the extent of the drawing: coarse
enough to cost nothing, and the areas of nested boundaries differ by more."""

ALIKE = 0.05
"""Areas that differ by less than this fraction do not show which is which: that of a small hole is
known no better with a tolerance for the whole drawing."""

AnyContour = Contour | SplineContour


def deviation(contours: Sequence[AnyContour], boundaries: tuple[Boundary, ...]) -> float:
    """Proved bound [mm] on the distance between the `contours` of a file and the `boundaries`.

    A wrong pairing would show as a large deviation, never as a small one. Raises FileError unless
    there are as many contours as boundaries.
    """
    if len(contours) != len(boundaries):
        names = ", ".join(boundary.name for boundary in boundaries)
        raise FileError(f"{len(contours)} closed contours, expected {len(boundaries)}: {names}")
    # A power of 2, so that all files of a part need the same polygons, which are computed once.
    loose = LOOSE * 2.0 ** math.floor(math.log2(max(map(reach_of, contours))))
    outlines = [boundary.polyline(loose, "fast").contour for boundary in boundaries]
    pairs = zip(boundaries, paired(contours, outlines), strict=True)
    return max(boundary.deviation(contour.counter_clockwise()) for boundary, contour in pairs)


def paired(contours: Sequence[AnyContour], outlines: Sequence[Contour]) -> list[AnyContour]:
    """The contours of a file in the order of as many `outlines`, approximate polygons of the part.

    The order of the areas distinguishes boundaries that lie inside each other; those of the same
    size, such as the holes of a bolt circle, lie at different places.
    """
    order = sorted(range(len(outlines)), key=lambda k: abs(outlines[k].area))
    free = sorted(contours, key=lambda each: abs(each.area))
    found: dict[int, AnyContour] = {}
    while order:
        limit = abs(outlines[order[0]].area) * (1.0 + ALIKE)
        alike = [k for k in order if abs(outlines[k].area) <= limit]
        order, ours, free = order[len(alike) :], free[: len(alike)], free[len(alike) :]
        for k in alike:
            away = [_apart(each, outlines[k]) for each in ours]
            found[k] = ours.pop(int(np.argmin(away)))
    return [found[k] for k in range(len(outlines))]


def _apart(contour: AnyContour, outline: Contour) -> float:
    """How far two contours differ in place and size [mm]."""
    sizes = math.sqrt(abs(contour.area)) - math.sqrt(abs(outline.area))
    return abs(_middle(contour) - _middle(outline)) + abs(sizes)


def _middle(contour: AnyContour) -> complex:
    """Middle of its bounding box [mm]."""
    points = points_of(contour, LOOSE * reach_of(contour))
    sides = (points.real, points.imag)
    x, y = (0.5 * float(np.min(each) + np.max(each)) for each in sides)
    return complex(x, y)


def reach_of(contour: AnyContour) -> float:
    """Largest distance of its vertices, or of its control points, from the cam axis [mm]."""
    if isinstance(contour, SplineContour):
        return contour.reach
    return float(abs(contour.vertices).max())
