"""SVG and PNG: a picture of the cam, for papers and web pages. For making it, take the DXF."""

from __future__ import annotations

from camgeo.figure.plots import stacked
from camgeo.files.product import Product, Written
from camgeo_export.plots.render import render


class PictureWriter:
    """Writes a picture of the cam in the format of `suffix`."""

    needs: tuple[str, ...] = ()

    def __init__(self, suffix: str) -> None:
        self.suffix = suffix

    def write(self, product: Product, tolerance: float) -> Written:
        """The picture; no tolerance holds for it."""
        return Written(render(stacked(product, ["cam"]), self.suffix))

    def measure(self, product: Product, data: bytes) -> None:
        """Nothing: a picture is not made to measure from."""


SVG = PictureWriter(".svg")
PNG = PictureWriter(".png")
