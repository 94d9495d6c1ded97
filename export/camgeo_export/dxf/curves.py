"""Strands of contours from the numbers of DXF entities, joined to closed contours."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.errors import GeometryError
from camgeo.wording import counted
from camgeo_export.errors import FileError

Strand = CubicSpline | Arc
Curve = Contour | SplineContour

SPLINE_KEYS = {"degree": 71, "knots": 72, "controls": 73}
"""Group codes of the numbers that a SPLINE must state."""

RATIONAL = 1e-12
"""Weights that differ by a larger fraction make a spline rational."""


def arc_of(centre: complex, radius: float, first: float, last: float) -> Arc:
    """The ARC around `centre` from the angle `first` to `last` [degrees], counter-clockwise."""
    sweep = (math.radians(last) - math.radians(first)) % (2.0 * math.pi) or 2.0 * math.pi
    start, end = (centre + radius * _unit(angle) for angle in (first, last))
    return Arc(start, end, sweep, centre)


def _unit(degrees: float) -> complex:
    return complex(math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))


def spline_of(tags: Sequence[tuple[int, float]], scale: float) -> CubicSpline:
    """The SPLINE given by `tags`, group codes with values, at `scale` [mm] per unit.

    Control points are in the axes of the drawing, whatever the extrusion is.

    Raises
    ------
    FileError
        If it is rational, of degree 4 or more, not flat, or has no control points.
    """

    def all_of(code: int) -> list[float]:
        return [value for group, value in tags if group == code]

    stated = {name: all_of(code) for name, code in SPLINE_KEYS.items()}
    knots, weights = all_of(40), all_of(41)
    x, y, z = all_of(10), all_of(20), all_of(30)
    if not x:
        raise FileError("has no control points, only points to be fitted through")
    if not stated["degree"]:
        raise FileError("states no degree (group 71)")
    if stated["knots"] not in ([], [float(len(knots))]):
        raise FileError(f"has {counted(len(knots), 'knot')}, not as many as it states")
    if stated["controls"] not in ([], [float(len(x))]) or len(y) != len(x):
        raise FileError(f"has {counted(len(x), 'control point')}, not as many as it states")
    if weights and max(weights) - min(weights) > RATIONAL * max(map(abs, weights)):
        raise FileError("is rational: its weights differ; only polynomial splines are read")
    if z and max(z) != min(z):
        raise FileError("does not lie in the plane of the drawing")
    controls = (np.array(x) + 1j * np.array(y)) * scale
    degree = stated["degree"][0]
    if degree not in (1.0, 2.0, 3.0):
        raise FileError(f"is of degree {degree:g}; splines of degree 1 to 3 are read")
    try:
        return CubicSpline.of(int(degree), np.array(knots), controls)
    except GeometryError as error:
        raise FileError(f"is not a spline: {error}") from None


def closed(strands: Sequence[Strand]) -> Curve:
    """The closed contour of strands end to end; the caller has limited the gaps.

    Where two ends differ, arcs and lines are moved to splines, and a strand to the next one. A
    contour without splines consists of lines and arcs.
    """
    starts = []
    for before, strand in zip((strands[-1], *strands[:-1]), strands, strict=True):
        given_way = isinstance(before, CubicSpline) and isinstance(strand, Arc)
        starts.append(before.end if given_way else strand.start)
    arcs = [strand for strand in strands if isinstance(strand, Arc)]
    if len(arcs) == len(strands):
        return Contour.through(np.array(starts), np.array([arc.sweep for arc in arcs]))
    ends = [*starts[1:], starts[0]]
    return SplineContour(
        tuple(
            strand.between(start, end)
            for strand, start, end in zip(strands, starts, ends, strict=True)
        )
    )
