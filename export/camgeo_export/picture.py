"""SVG and PNG: a picture of the cam, for papers and web pages. For manufacturing use the DXF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.design.product import Product
from camgeo.design.writing import Written
from camgeo.pictures.plots import stacked
from camgeo.scene.formats import format as plain
from camgeo.scene.formats.format import Format
from camgeo_export.plots import drawn, saved

PAGE: Final = "picture"


@dataclass(frozen=True, slots=True)
class PictureWriter:
    """Writes a picture of the cam.

    Attributes
    ----------
    format : of the picture.
    """

    format: Format[None]

    def write(self, product: Product, tolerance: float) -> Written:
        """The picture; no tolerance applies to it."""
        known = product.pictured.known
        if PAGE not in known:
            known[PAGE] = drawn(stacked(product, ["cam"]))
        return Written(saved(known[PAGE], self.format.suffix))

    def measure(self, product: Product, data: bytes) -> None:
        """None: a picture is not meant to be measured."""


SVG = PictureWriter(plain.SVG)
PNG = PictureWriter(plain.PNG)
