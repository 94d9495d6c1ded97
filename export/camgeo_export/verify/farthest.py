"""Where a contour is farthest from an outline: by samples, to show the user where to look."""

from __future__ import annotations

import numpy as np

from camgeo.contour.bezier import at
from camgeo.contour.contour import Contour
from camgeo.contour.spline import CubicSpline, SplineContour
from camgeo.numeric.arrays import ComplexArray, FloatArray

PARTS = 16
"""Points per line or cubic."""


def farthest(
    polygon: Contour, contour: Contour | SplineContour, sagitta: float
) -> tuple[float, complex]:
    """Largest distance [mm] found between the two and its place [mm].

    In both directions; for splines, only from them to the polygon. Arcs are replaced by chords
    that lie within `sagitta` [mm] of them.
    """
    found = [_largest(polygon.vertices, points_of(contour, sagitta))]
    if isinstance(contour, Contour):
        found.append(_largest(contour.points(sagitta), polygon.vertices))
    return max(found, key=lambda each: each[0])


def points_of(contour: Contour | SplineContour, sagitta: float) -> ComplexArray:
    """(m,) complex [mm] points on the contour, in any order."""
    share = np.arange(PARTS) / PARTS
    if isinstance(contour, Contour):
        lines = contour.sweeps == 0.0
        starts, ends = contour.vertices[lines, None], contour.ends[lines, None]
        between = (starts + (ends - starts) * share).ravel()
        return np.concatenate((contour.points(sagitta), between))
    parts: list[ComplexArray] = []
    for strand in contour.strands:
        if isinstance(strand, CubicSpline):
            parts.append(at(strand.beziers, share).ravel())
        else:
            parts.append(strand.at(share))
    return np.concatenate(parts)


def _largest(course: ComplexArray, points: ComplexArray) -> tuple[float, complex]:
    """Largest distance of `points` from the closed polygon `course`, and where."""
    distances = distances_from(course, points)
    index = int(np.argmax(distances))
    return float(distances[index]), complex(points[index])


def distances_from(course: ComplexArray, points: ComplexArray) -> FloatArray:
    """(n,) distance of `points` from the closed polygon `course`."""
    import shapely

    ends = np.stack((course, np.roll(course, -1)), axis=1)
    sides = np.asarray(shapely.linestrings(np.stack((ends.real, ends.imag), axis=2)))
    tree = shapely.STRtree(sides)
    places = shapely.points(points.real, points.imag)
    index, distances = tree.query_nearest(places, return_distance=True, all_matches=False)
    nearest = np.zeros(len(points))
    nearest[index[0]] = distances
    return nearest
