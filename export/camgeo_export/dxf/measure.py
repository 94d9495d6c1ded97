"""A drawing read back and compared with the exact curves."""

from __future__ import annotations

from camgeo.design.product import Product
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.scene.formats.dxf import FORMAT, SINGLE
from camgeo.units import MM_PER
from camgeo_export.dxf.reader import Drawing, drawing_of
from camgeo_export.reading import deviation, layered

KINDS: dict[str, tuple[str, ...]] = {
    "PITCH_CURVE": ("LWPOLYLINE",),
    "BASE_CIRCLE": ("CIRCLE",),
    "CENTRE": ("LINE",),
}
"""What each auxiliary layer holds; anything else does not belong in the drawing."""

PART_KINDS: dict[str, tuple[str, ...]] = {
    "arcs": ("LWPOLYLINE",),
    SINGLE: ("ARC", "LINE"),
    "polyline": ("LWPOLYLINE",),
    "spline": ("SPLINE", "ARC", "LINE"),
}
"""What the layers of the part hold, by the option `entity`."""

MEASUREMENT = {"mm": "1", "inch": "0"}


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of all that is drawn.

    Raises FileError if the drawing is incomplete, foreign or in the wrong unit.
    """
    drawing = drawing_of(data)
    _check(drawing, product)
    largest = max(
        deviation(drawing.contours(name), boundaries)
        for name, boundaries in layered(product).items()
    )
    if not product.options[FORMAT].auxiliary:
        return largest
    scale = drawing.scale()
    circles = [item for item in drawing.items if item.layer == "BASE_CIRCLE"]
    pitch = drawing.contours("PITCH_CURVE") if product.drawn.has_pitch_curve else ()
    if len(pitch) > 1 or len(circles) != 1:
        raise FileError("the drawing must have one base circle, and one pitch curve at most")
    x, y, radius = (circles[0].number(code) * scale for code in (10, 20, 40))
    largest = max(largest, abs(complex(x, y)) + abs(radius - product.drawn.base_radius))
    for contour in pitch:
        assert isinstance(contour, Contour)  # a polyline, by `_check`
        largest = max(largest, product.drawn.pitch_deviation(contour))
    return largest


def _check(drawing: Drawing, product: Product) -> None:
    options = product.options[FORMAT]
    kinds = dict(KINDS) if options.auxiliary else {}
    kinds |= dict.fromkeys(layered(product), PART_KINDS[options.entity])
    if not product.drawn.has_pitch_curve:
        kinds.pop("PITCH_CURVE", None)
    for item in drawing.items:
        if item.kind not in kinds.get(item.layer, ()):
            raise FileError(f"{item.kind} on layer {item.layer} is not part of the drawing")
    if drawing.scale() != MM_PER[product.unit]:
        raise FileError(f"$INSUNITS does not say {product.unit}")
    if drawing.value("$MEASUREMENT") != MEASUREMENT[product.unit]:
        raise FileError(f"$MEASUREMENT does not say {product.unit}")
