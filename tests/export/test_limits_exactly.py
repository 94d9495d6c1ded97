"""Limits of what is written and read: as much as one allows passes, and one more does not."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from camgeo.errors import FileError
from camgeo_export import svg as svg_writer
from camgeo_export import svg_reader
from camgeo_export.dxf import reader as dxf_reader
from camgeo_export.dxf import writer as dxf_writer
from camgeo_export.solid import prism
from camgeo_export.step import writer as step_writer
from camgeo_export.stl import WRITER as STL
from tests.export.stub_product import PIECES, StubProduct

PRODUCT = StubProduct()

TOLERANCE = 0.05

FACETS = int(STL.write(PRODUCT, TOLERANCE).facts["triangles"])


def squares(count: int) -> bytes:
    """An SVG of so many contours of four lines."""
    body = "".join(f'<path d="M{9 * k} 0h5v5h-5z"/>' for k in range(count))
    head = 'xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm" viewBox="0 0 9 9"'
    return f"<svg {head}>{body}</svg>".encode()


def drawing() -> None:
    dxf_writer.WRITER.write(PRODUCT, TOLERANCE)


def read_drawing() -> None:
    data = dxf_writer.WRITER.write(PRODUCT, TOLERANCE).data
    dxf_reader.drawing_of(data).contours("CUT")


CASES: dict[str, tuple[object, str, int, Callable[[], object], str]] = {
    # Outline, bore and pitch curve, of four lines of text for each piece.
    "dxf": (dxf_writer, "DRAWING_LINES", 4 * 3 * PIECES, drawing, "36 pieces of at least 4 lines"),
    "contours of a dxf": (dxf_reader, "CONTOURS", 2, read_drawing, "2 closed contours"),
    "svg": (svg_writer, "SVG_PIECES", 2 * PIECES,
            lambda: svg_writer.WRITER.write(PRODUCT, TOLERANCE), "would have 24 pieces"),
    "contours of an svg": (svg_reader, "CONTOURS", 5, lambda: svg_reader.drawing_of(squares(5)),
                           "5 closed contours"),
    "pieces of an svg": (svg_reader, "SVG_PIECES", 20, lambda: svg_reader.drawing_of(squares(5)),
                         "20 lines and arcs"),
    "step": (step_writer, "INSTANCES", 20 * 2 * PIECES,
             lambda: step_writer.WRITER.write(PRODUCT, TOLERANCE), "walls of 24 pieces"),
    "stl": (prism, "FACETS", FACETS, lambda: STL.write(PRODUCT, TOLERANCE), f"{FACETS:,} facets"),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_as_much_as_a_limit_allows_and_no_more(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module, limit, most, make, message = CASES[name]
    monkeypatch.setattr(module, limit, most)
    make()
    monkeypatch.setattr(module, limit, most - 1)
    with pytest.raises(FileError, match=message):
        make()
