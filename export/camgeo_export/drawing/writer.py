"""The drawing: one sheet as DXF, PDF and SVG."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

from ezdxf.document import Drawing

from camgeo.formats.drawing import FORMAT
from camgeo.formats.format import Format
from camgeo.product.product import Product
from camgeo.sheet.marks import Sheet
from camgeo.sheet.scales import SMALLEST, spelled
from camgeo.sheet.sheet import measured, sheet_of
from camgeo.writing.writer import Written
from camgeo_export.drawing.document import document_of
from camgeo_export.drawing.measure import measure
from camgeo_export.drawing.page import know_the_font, page
from camgeo_export.dxf.file import bytes_of, describe, fixed_metadata


def _made(product: Product, tolerance: float) -> tuple[Sheet, Drawing]:
    """The sheet and its document, once for all files of a disc."""
    known = product.pictured.known
    name = f"{FORMAT.name} within {tolerance!r} mm"
    if name not in known:
        sheet = sheet_of(product, tolerance)
        know_the_font()
        with fixed_metadata():
            document = document_of(sheet)
            describe(document, product, tolerance)
        known[name] = sheet, document
    made: tuple[Sheet, Drawing] = known[name]
    return made


def sheets_of(product: Product) -> tuple[Product, ...]:
    """What has a sheet each: the disc, and with a main disc the pair that is one piece."""
    return (product,) if product.pair is None else (product, product.pair)


@dataclass(frozen=True, slots=True)
class PageWriter:
    """Writes the sheet as a picture.

    Attributes
    ----------
    format : with the suffix of the file.
    kind : "pdf" or "svg".
    """

    format: Format[None]
    kind: str

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """See `sheets_of`."""
        return sheets_of(product)

    def write(self, product: Product, tolerance: float) -> Written:
        """The picture of the whole sheet, at its scale."""
        sheet, document = _made(product, tolerance)
        return Written(page(document, sheet, self.kind))

    def measure(self, product: Product, data: bytes) -> None:
        """None: the drawing itself is measured."""


@dataclass(frozen=True, slots=True)
class DrawingWriter:
    """Writes the sheet as DXF.

    Attributes
    ----------
    format : with the suffix of the file.
    companions : writers of PDF and SVG.
    """

    format: Format[None]
    companions: tuple[PageWriter, ...]

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """See `sheets_of`."""
        return sheets_of(product)

    def write(self, product: Product, tolerance: float) -> Written:
        """The sheet; the edges of the part lie within `tolerance` [mm]."""
        sheet, document = _made(product, tolerance)
        with fixed_metadata():
            data = bytes_of(document)
        facts: dict[str, int | float | str] = {
            "scale": spelled(Fraction(sheet.scale).limit_denominator(SMALLEST)),
            "dimensions": len(measured(sheet)),
        }
        return Written(data, facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the sheet back, without ezdxf: edges and dimensions against the part [mm]."""
        return measure(product, data)


PDF: Final = PageWriter(replace(FORMAT, suffix="-drawing.pdf"), "pdf")
SVG: Final = PageWriter(replace(FORMAT, suffix="-drawing.svg"), "svg")
WRITER: Final = DrawingWriter(FORMAT, (PDF, SVG))
