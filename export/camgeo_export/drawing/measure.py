"""A sheet read back: its edges against the part, its dimensions against what they measure."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Final

from camgeo.product.product import Product
from camgeo.units import MM_PER
from camgeo_export.dxf.items import Item
from camgeo_export.dxf.reader import drawing_of
from camgeo_export.errors import FileError
from camgeo_export.matching import deviation

EDGES: Final = ("OUTLINE", "HIDDEN", "ENGRAVING")
"""Layers of the front view's edges, in the axes of the part."""

DIAMETER: Final = 3
"""Type of a dimension of a diameter, in the lowest bits of group 70."""

KIND: Final = 7
"""Those bits."""


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation of the edges [mm].

    Raises FileError if a boundary is missing, or a dimension has a text of its own or does not
    state what its definition points are apart.
    """
    drawing = drawing_of(data)
    if drawing.scale() != MM_PER[product.unit]:
        raise FileError(f"$INSUNITS does not say {product.unit}")
    drawn = tuple(item for item in drawing.items if item.layer in EDGES)
    contours = replace(drawing, items=drawn).contours(None)  # an edge may be hidden in part
    largest = deviation(contours, product.drawn.part.boundaries)
    for item in drawing.items:
        if item.kind == "DIMENSION":
            largest = max(largest, abs(_stated(item) - apart(item)) * drawing.scale())
    return largest


def _stated(item: Item) -> float:
    """What a dimension says that it measures, in units of the drawing."""
    if item.text(1) not in ("", "<>"):
        raise item.fault(f"has the text {item.text(1)!r} instead of what it measures")
    return item.number(42)


def apart(item: Item) -> float:
    """What the definition points of a dimension measure, in units of the drawing."""
    if int(item.number(70)) & KIND == DIAMETER:
        return abs(_point(item, 10) - _point(item, 15))
    along = cmath.rect(1.0, math.radians(item.number(50, 0.0)))
    return abs(((_point(item, 14) - _point(item, 13)) * along.conjugate()).real)


def _point(item: Item, code: int) -> complex:
    return complex(item.number(code), item.number(code + 10))
