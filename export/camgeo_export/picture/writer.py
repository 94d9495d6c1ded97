"""SVG and PNG: a picture of the cam, for papers and web pages. For manufacturing use the DXF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.figure.plots import stacked
from camgeo.formats import plain
from camgeo.formats.format import Format
from camgeo.product.product import Product
from camgeo.writing.writer import Written
from camgeo_export.plots.render import drawn, saved

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
