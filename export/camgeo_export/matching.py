"""Which contour of a file is which boundary of the part."""

from __future__ import annotations

from collections.abc import Sequence

from camgeo.contour.contour import Contour
from camgeo.contour.spline import SplineContour
from camgeo.part.part import Boundary
from camgeo_export.errors import FileError

LOOSE = 1e-3
"""Tolerance at which a boundary's area is taken, relative to the extent of the drawing: coarse
enough to cost nothing, and the areas of nested boundaries differ by more."""


def deviation(
    contours: Sequence[Contour | SplineContour], boundaries: tuple[Boundary, ...]
) -> float:
    """Proved bound [mm] of the distance between the `contours` of a file and the `boundaries`.

    Boundaries of a part lie inside each other, so the order of their areas tells them apart. A
    wrong pair would show as a large deviation, never as a small one. Raises FileError unless there
    are as many contours as boundaries.
    """
    if len(contours) != len(boundaries):
        names = ", ".join(boundary.name for boundary in boundaries)
        raise FileError(f"{len(contours)} closed contours, expected {len(boundaries)}: {names}")
    loose = LOOSE * max(reach_of(contour) for contour in contours)
    found = sorted(
        (contour.counter_clockwise() for contour in contours), key=lambda contour: contour.area
    )
    wanted = sorted(boundaries, key=lambda boundary: boundary.polyline(loose, "fast").contour.area)
    pairs = zip(wanted, found, strict=True)
    return max(boundary.deviation(contour) for boundary, contour in pairs)


def reach_of(contour: Contour | SplineContour) -> float:
    """Largest distance of its vertices, or of its control points, from the cam axis [mm]."""
    if isinstance(contour, SplineContour):
        return contour.reach
    return float(abs(contour.vertices).max())
