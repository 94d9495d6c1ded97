"""The drawing: one sheet as DXF, PDF and SVG."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

from ezdxf.document import Drawing

from camgeo.formats.drawing import FORMAT
from camgeo.formats.format import Format
from camgeo.product.product import Product
from camgeo.sheet.marks import Sheet
from camgeo.sheet.readable import findings_of
from camgeo.sheet.scales import SMALLEST, spelled
from camgeo.sheet.sheet import measured, sheets_of
from camgeo.writing.writer import Written
from camgeo_export.drawing.document import document_of
from camgeo_export.drawing.measure import measure
from camgeo_export.drawing.page import pdf, svg
from camgeo_export.drawing.strokes import Strokes, know_the_font, strokes_of
from camgeo_export.dxf.file import bytes_of, describe, fixed_metadata


def _made(product: Product, tolerance: float) -> tuple[tuple[Sheet, ...], Drawing]:
    """The sheets and their document, once for all files of a disc."""
    known = product.pictured.known
    name = f"{FORMAT.name} within {tolerance!r} mm"
    if name not in known:
        sheets = sheets_of(product, tolerance)
        know_the_font()
        with fixed_metadata():
            document = document_of(sheets)
            describe(document, product, tolerance)
        known[name] = sheets, document
    made: tuple[tuple[Sheet, ...], Drawing] = known[name]
    return made


def _pages(product: Product, tolerance: float) -> tuple[Strokes, ...]:
    """What is drawn on each sheet, once for PDF and SVG."""
    known = product.pictured.known
    name = f"pages of the {FORMAT.name} within {tolerance!r} mm"
    if name not in known:
        sheets, document = _made(product, tolerance)
        documents = [document] if len(sheets) == 1 else [document_of([each]) for each in sheets]
        known[name] = tuple(map(strokes_of, documents, sheets))
    made: tuple[Strokes, ...] = known[name]
    return made


def with_pair(product: Product) -> tuple[Product, ...]:
    """What has a sheet each: the disc, and with a main disc the pair that is one piece."""
    return (product,) if product.pair is None else (product, product.pair)


@dataclass(frozen=True, slots=True)
class PageWriter:
    """Writes the sheets as pictures.

    Attributes
    ----------
    format : with the suffix of the file.
    written : makes a file of pages.
    """

    format: Format[None]
    written: Callable[[Sequence[Strokes]], bytes]

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """See `with_pair`."""
        return with_pair(product)

    def write(self, product: Product, tolerance: float) -> Written:
        """The whole sheets, at their scale."""
        return Written(self.written(_pages(product, tolerance)))

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
        """See `with_pair`."""
        return with_pair(product)

    def write(self, product: Product, tolerance: float) -> Written:
        """The sheet; the edges of the part lie within `tolerance` [mm]."""
        sheets, document = _made(product, tolerance)
        with fixed_metadata():
            data = bytes_of(document)
        facts: dict[str, int | float | str] = {
            "scale": spelled(Fraction(sheets[0].scale).limit_denominator(SMALLEST)),
            "dimensions": sum(len(measured(sheet)) for sheet in sheets),
        }
        findings = tuple(each for sheet in sheets for each in findings_of(sheet))
        return Written(data, facts, findings)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the sheet back, without ezdxf: edges and dimensions against the part [mm]."""
        return measure(product, data)


PDF: Final = PageWriter(replace(FORMAT, suffix="-drawing.pdf"), pdf)
SVG: Final = PageWriter(replace(FORMAT, suffix="-drawing.svg"), svg)
WRITER: Final = DrawingWriter(FORMAT, (PDF, SVG))
