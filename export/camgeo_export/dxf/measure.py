"""A drawing read back and held against the exact curves."""

from __future__ import annotations

from camgeo.files.product import Product
from camgeo.formats.dxf import FORMAT
from camgeo.units import MM_PER
from camgeo_export.dxf.reader import DxfFile, read
from camgeo_export.errors import FileError
from camgeo_export.matching import deviation

KINDS: dict[str, tuple[str, ...]] = {
    "CUT": ("LWPOLYLINE",),
    "PITCH_CURVE": ("LWPOLYLINE",),
    "BASE_CIRCLE": ("CIRCLE",),
    "CENTRE": ("LINE",),
}
"""What each layer holds; anything else does not belong into the drawing."""

SPLINE_KINDS = ("SPLINE", "ARC", "LINE")
"""What layer CUT holds where splines are drawn."""

MEASUREMENT = {"mm": "1", "inch": "0"}


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of all that is drawn.

    Raises FileError if the drawing is incomplete, foreign or in the wrong unit.
    """
    drawing = read(data)
    _check(drawing, product)
    cut = deviation(drawing.curves("CUT"), product.drawn.part.boundaries)
    if not product.options[FORMAT].auxiliary:
        return cut
    pitch = drawing.contours("PITCH_CURVE")
    circles = drawing.circles("BASE_CIRCLE")
    if len(pitch) != (1 if product.drawn.has_pitch_curve else 0) or len(circles) != 1:
        raise FileError("the drawing lacks its pitch curve or its base circle")
    centre, radius = circles[0]
    return max(
        cut,
        abs(centre) + abs(radius - product.drawn.base_radius),
        *(product.drawn.pitch_deviation(each.counter_clockwise()) for each in pitch),
    )


def _check(drawing: DxfFile, product: Product) -> None:
    options = product.options[FORMAT]
    kinds = dict(KINDS) if options.auxiliary else {"CUT": KINDS["CUT"]}
    if options.entity == "spline":
        kinds["CUT"] = SPLINE_KINDS
    for entity in drawing.entities:
        if entity.kind not in kinds.get(entity.layer, ()):
            raise FileError(f"{entity.kind} on layer {entity.layer} is not part of the drawing")
    if drawing.mm_per_unit != MM_PER[product.unit]:
        raise FileError(f"$INSUNITS does not say {product.unit}")
    if drawing.header.get("$MEASUREMENT") != MEASUREMENT[product.unit]:
        raise FileError(f"$MEASUREMENT does not say {product.unit}")
