"""An SVG drawing read back and compared with the exact curves."""

from __future__ import annotations

from camgeo.product.product import Product
from camgeo_export.errors import FileError
from camgeo_export.layers import layered
from camgeo_export.matching import deviation
from camgeo_export.svg.reader import SvgDrawing, drawing_of


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of all that is drawn.

    Raises FileError if the drawing is incomplete, foreign or not at true size.
    """
    drawing = drawing_of(data)
    layers = layered(product)
    check_contents(drawing, tuple(layers))
    return max(
        deviation(drawing.layers.get(name, ()), boundaries) for name, boundaries in layers.items()
    )


def check_contents(drawing: SvgDrawing, layers: tuple[str, ...]) -> None:
    """Raise FileError unless the drawing has these layers alone, one unit to the millimetre."""
    if drawing.scale != 1.0:
        raise FileError(f"a unit of the drawing is {drawing.scale:g} mm, not 1 mm")
    foreign = [name for name in drawing.layers if name not in layers]
    if foreign:
        raise FileError(f"a contour in the group {foreign[0][:40]!r} is not part of the drawing")
