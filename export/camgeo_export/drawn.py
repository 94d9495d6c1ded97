"""The boundaries of a part as drawings and STEP files have them: both of the same pieces."""

from __future__ import annotations

import math

from camgeo.part.part import Boundary
from camgeo.product.product import Product
from camgeo_export.matching import AnyContour

FIT_SHARE = 0.98
"""Share of the tolerance that a fit may use; the rest is for rounding to the nearest double and for
the slack of the bound by which the file is measured."""


def curve_of(boundary: Boundary, entity: str, product: Product, tolerance: float) -> AnyContour:
    """A boundary within `FIT_SHARE` of `tolerance` [mm], counter-clockwise.

    As "arcs", as "polyline" or as "spline"; arcs turn by half a turn at most.
    """
    share, effort = FIT_SHARE * tolerance, product.drawn.effort
    if entity == "spline":
        return boundary.spline(share, effort).contour.split(math.pi)
    if entity == "polyline":
        return boundary.polyline(share, effort).contour
    return boundary.arcs(share, effort).contour.split(math.pi)
