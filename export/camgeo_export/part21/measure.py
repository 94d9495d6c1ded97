"""A STEP file of ours read back and compared with the exact curves."""

from __future__ import annotations

from camgeo.design.product import Product
from camgeo.errors import FileError, GeometryError
from camgeo.units import MM_PER, counted
from camgeo_export.part21.solid import Model, solid_of
from camgeo_export.part21.text import exchange_of
from camgeo_export.reading import deviation
from camgeo_export.verify.body import slopes_of
from camgeo_export.verify.step import (
    bounds_of,
    gap,
    levels,
    shell_checks,
    slope_contours,
)

UNCERTAINTY = 1e-7
"""That our files state [mm]."""


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of the solid from the part, in the plane and in height.

    Raises FileError unless it is one closed, outward shell along Z in the unit of the product.
    """
    part = product.drawn.part
    try:
        wanted = part.levels
    except GeometryError as error:
        raise FileError(f"no solid to compare this with: {error.message}") from None
    solid = solid_of(Model.of(exchange_of(data)))
    if solid.unit != MM_PER[product.unit]:
        raise FileError(f"the solid is in {solid.unit_name}, not in {product.unit}")
    for check in shell_checks(solid, UNCERTAINTY):
        if not check.ok:
            raise FileError(f"the solid fails the check '{check.name}': {check.note}")
    ranges, contours = levels(bounds_of(solid), UNCERTAINTY)
    if len(ranges) != len(wanted):
        found = counted(len(ranges), "height")
        raise FileError(f"flat faces at {found}, expected {len(wanted)}")
    largest = 0.0
    for heights, found_here, exact in zip(ranges.tolist(), contours, wanted, strict=True):
        z = exact.z - wanted[0].z
        off = max(abs(height - z) for height in heights)
        largest = max(largest, off, deviation(found_here, exact.boundaries) + gap(solid))
    for slope in slopes_of(part):
        contours_there = slope_contours(solid, slope.z0, slope.z1, UNCERTAINTY)
        for place, found_there in enumerate(contours_there):
            largest = max(largest, deviation(found_there, slope.edges(place)) + gap(solid))
    return largest
