"""Verification of a sheet: its edges, and what its dimensions state."""

from __future__ import annotations

from typing import Final

from camgeo.errors import CamgeoError
from camgeo.product.product import Product
from camgeo.verifying.verification import Check, at_most, failed
from camgeo_export.drawing.measure import measure
from camgeo_export.dxf.reader import Drawing

FRAME: Final = "FRAME"
"""A layer that only sheets have."""


def is_sheet(drawing: Drawing) -> bool:
    """Whether a drawing of ours is a sheet, rather than contours to cut."""
    return any(item.layer == FRAME for item in drawing.items)


def sheet_checks(product: Product, data: bytes, tolerance: float) -> tuple[Check, ...]:
    """The edges of the front view and the dimensions against the part."""
    try:
        largest = measure(product, data)
    except CamgeoError as error:
        return (failed("contents", str(error)),)
    return (at_most("deviation", largest, tolerance, "mm", note="of edges and dimensions"),)
