"""The boundaries of a part as rings of strands that STEP can hold."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.cubics.lines_and_arcs import approximating_arcs
from camgeo.contour.spline import Arc, CubicSpline, SplineContour, strands_of
from camgeo.errors import ToleranceError
from camgeo.formats.step import FORMAT
from camgeo.part.bands import Bevel
from camgeo.part.boundary import written_contour
from camgeo.part.part import Boundary
from camgeo.product.drawn import TOPOLOGY_TOLERANCE
from camgeo.product.product import Product
from camgeo_export.step.frame import UNCERTAINTY
from camgeo_export.step.geometry import Strand
from camgeo_export.step.shell import Ring
from camgeo_export.step.slopes import contour_of, parallel

FLATTEST = 1e7
"""Radius [mm] beyond which an arc is drawn as a line if the tolerance allows: its ends would miss
the circle by the rounding of its centre."""

SAGITTA = 0.01
"""Share of the tolerance by which such an arc may leave its chord."""


def ring_of(boundary: Boundary, product: Product, tolerance: float) -> Ring:
    """A boundary within `tolerance` [mm], material on its left.

    Raises ToleranceError if an arc is so flat that the ends miss its circle by more than the
    uncertainty that the file states.
    """
    form, effort = product.options[FORMAT].walls, product.drawn.effort
    curve = written_contour(boundary, form, effort, tolerance).contour
    if isinstance(curve, Contour):
        contour = _without_flattest(curve, tolerance)
        strands = strands_of(contour).strands
    else:
        contour = approximating_arcs(curve, TOPOLOGY_TOLERANCE).contour
        strands = _open(curve)
    apart = max((_off_circle(each) for each in strands if isinstance(each, Arc)), default=0.0)
    if apart > UNCERTAINTY:
        message = f"arcs of the {boundary.name} are too flat for the numbers of the format"
        raise ToleranceError(message, UNCERTAINTY, apart)
    if boundary.hole:
        strands = tuple(strand.reversed() for strand in strands[::-1])
    return Ring(strands, contour)


def edge_of(bevel: Bevel, wall: Ring) -> Ring:
    """The edge of a chamfer, as far from the ring of its wall as the exact one from the wall."""
    strands = parallel(wall.strands, bevel.width, bevel.boundary.name)
    return Ring(strands, contour_of(strands))


def _without_flattest(contour: Contour, tolerance: float) -> Contour:
    """The contour with the flattest arcs as lines."""
    sagittas = 2.0 * contour.radii * np.sin(0.25 * contour.sweeps) ** 2
    flat = sagittas <= SAGITTA * tolerance
    kept = ~(flat & (contour.radii > FLATTEST))
    return Contour(
        contour.vertices, np.where(kept, contour.sweeps, 0.0), np.where(kept, contour.centres, 0.0)
    )


def _open(curve: SplineContour) -> tuple[Strand, ...]:
    """Its strands; one that is closed in itself in two parts, as an edge has two ends."""
    (strand, *others) = curve.strands
    if others or not isinstance(strand, CubicSpline):
        return curve.strands
    inner = strand.knots[(strand.knots > strand.knots[0]) & (strand.knots < strand.knots[-1])]
    return strand.divided(float(inner[len(inner) // 2]))


def _off_circle(arc: Arc) -> float:
    """How far [mm] its ends are from the circle that the file states."""
    if not arc.sweep:
        return 0.0
    return 0.5 * abs(abs(arc.start - arc.centre) - abs(arc.end - arc.centre)) + (
        4.0 * math.ulp(abs(arc.centre))
    )
