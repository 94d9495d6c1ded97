"""A drawing as PDF and SVG, at true scale: coordinates are whole multiples of `GRAIN`."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo_export.drawing.document import APART
from camgeo_export.drawing.strokes import GRAIN, Outline, Stroke, Strokes, rounded

POINT: Final = 25.4 / 72.0
"""Unit of a PDF [mm]."""

TURN: Final = 0.25 * math.pi
"""Most that a cubic of a PDF turns, which then leaves its arc by less than 1e-5 of the radius."""

Pieces = list[tuple[complex, complex, float, complex]]
"""Start and end in whole grains, angle turned [rad], centre of an arc."""


def svg(pages: Sequence[Strokes]) -> bytes:
    """The pages side by side in one picture: letters are defined once and used where they stand."""
    wide = sum(each.width for each in pages) + APART * (len(pages) - 1)
    high = max(each.height for each in pages)
    box = f'width="{wide:g}mm" height="{high:g}mm" viewBox="0 0 {_grains(wide)} {_grains(high)}"'
    found = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" {box}>',
        '<rect width="100%" height="100%" fill="#fff"/>',
    ]
    left = 0.0
    for number, each in enumerate(pages):
        found.append(f'<g transform="translate({_grains(left)} 0)">' if number else "<g>")
        found += _svg_page(each, number)
        found.append("</g>")
        left += each.width + APART
    return "\n".join([*found, "</svg>", ""]).encode()


def _grains(length: float) -> int:
    return round(length / GRAIN)


def _svg_page(page: Strokes, number: int) -> Iterator[str]:
    top = _grains(page.height)
    yield '<g fill="none" stroke="#000" stroke-linejoin="round">'
    for width, strokes in sorted(page.lines.items()):
        path = "".join(_svg_stroke(each, top) for each in strokes)
        yield f'<path stroke-width="{_grains(0.01 * width)}" d="{path}"/>'
    yield "</g>"
    yield "<defs>"
    for shape, name in page.shapes.items():
        yield f'<path id="s{number}-{name}" d="{_svg_outline(shape)}"/>'
    yield "</defs>"
    for name, at in page.places:
        yield f'<use href="#s{number}-{name}" x="{at.real:.0f}" y="{top - at.imag:.0f}"/>'


def _svg_stroke(stroke: Stroke, top: int) -> str:
    pieces = _pieces(stroke)
    if not pieces:
        return ""
    found = [f"M{pieces[0][0].real:.0f} {top - pieces[0][0].imag:.0f}"]
    for start, end, sweep, centre in pieces:
        way = f"{_number(end.real - start.real)}{_signed(start.imag - end.imag)}"
        if sweep:
            radius = f"{abs(start - centre):.0f}"
            flags = f"{int(abs(sweep) > math.pi)} {int(sweep < 0.0)}"
            found.append(f"a{radius} {radius} 0 {flags} {way}")
        else:
            found.append(f"l{way}")
    return "".join([*found, "z"] if stroke.closed else found)


def _svg_outline(outline: Outline) -> str:
    found, at = [], 0j
    for word, points in outline:
        found.append(word.lower())
        ways = [point - at for point in points]
        numbers = "".join(f"{_signed(w.real)}{_signed(-w.imag)}" for w in ways)
        found.append(numbers.strip())
        at = points[-1] if points else at
    return "".join(found)


def _number(value: float) -> str:
    return f"{value + 0.0:.0f}"


def _signed(value: float) -> str:
    """A number after another one: a minus separates them."""
    text = _number(value)
    return text if text.startswith("-") else f" {text}"


def _pieces(stroke: Stroke) -> Pieces:
    """The pieces of a stroke that are longer than a grain."""
    points = [rounded(each) for each in stroke.vertices.tolist()]
    sweeps = stroke.sweeps.tolist()
    if stroke.closed:
        points.append(points[0])
    exact = [*stroke.vertices.tolist(), complex(stroke.vertices[0])]
    found: Pieces = []
    for (start, end), sweep, one, other in zip(pairwise(points), sweeps, exact, exact[1:],
                                               strict=False):  # fmt: skip
        if start != end:
            centre = 0j
            if sweep:
                centre = 0.5 * (one + other) + 0.5j * (other - one) / math.tan(0.5 * sweep)
            found.append((start, end, sweep, centre))
    return found


def pdf(pages: Sequence[Strokes]) -> bytes:
    """A document with a page for each."""
    objects: list[bytes] = [b"<< /Type /Catalog /Pages 2 0 R >>"]
    kids = " ".join(f"{4 + 2 * number} 0 R" for number in range(len(pages)))
    objects.append(f"<< /Type /Pages /Kids [ {kids} ] /Count {len(pages)} >>".encode())
    objects.append(b"<< /Creator (camgeo) >>")
    for number, each in enumerate(pages):
        size = f"{each.width / POINT:.4f} {each.height / POINT:.4f}"
        objects.append(
            f"<< /Type /Page /Parent 2 0 R /MediaBox [ 0 0 {size} ] /Resources << >>"
            f" /Contents {5 + 2 * number} 0 R >>".encode()
        )
        stream = zlib.compress("\n".join(_pdf_page(each)).encode(), 9)
        head = f"<< /Length {len(stream)} /Filter /FlateDecode >>\nstream\n".encode()
        objects.append(head + stream + b"\nendstream")
    found = bytearray(b"%PDF-1.4\n%\xc2\xb5\xc2\xb6\n")
    places = []
    for number, body in enumerate(objects):
        places.append(len(found))
        found += f"{number + 1} 0 obj\n".encode() + body + b"\nendobj\n"
    start = len(found)
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    found += f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n{table}".encode()
    found += f"trailer\n<< /Size {len(objects) + 1} /Root 1 0 R /Info 3 0 R >>\n".encode()
    return bytes(found + f"startxref\n{start}\n%%EOF\n".encode())


def _pdf_page(page: Strokes) -> Iterator[str]:
    grain = GRAIN / POINT
    yield f"{grain:.9f} 0 0 {grain:.9f} 0 0 cm 1 j"
    for width, strokes in sorted(page.lines.items()):
        yield f"{_grains(0.01 * width)} w"
        for each in strokes:
            yield from _pdf_stroke(each)
        yield "S"
    shapes = {name: " ".join(_pdf_outline(shape)) for shape, name in page.shapes.items()}
    for name, at in page.places:
        yield f"q 1 0 0 1 {_xy(at)} cm {shapes[name]} f Q"


def _xy(point: complex) -> str:
    return f"{_number(point.real)} {_number(point.imag)}"


def _pdf_stroke(stroke: Stroke) -> Iterator[str]:
    pieces = _pieces(stroke)
    if not pieces:
        return
    yield f"{_xy(pieces[0][0])} m"
    for start, end, sweep, centre in pieces:
        if not sweep:
            yield f"{_xy(end)} l"
            continue
        count = math.ceil(abs(sweep) / TURN)
        turn = sweep / count
        reach = 4.0 / 3.0 * math.tan(0.25 * turn)
        turned = np.exp(1j * turn * np.arange(count + 1))
        points = [start, *(centre + (start - centre) * each for each in turned[1:-1]), end]
        for one, other in pairwise(points):
            first = one + reach * 1j * (one - centre)
            second = other - reach * 1j * (other - centre)
            yield f"{_xy(first)} {_xy(second)} {_xy(other)} c"
    if stroke.closed:
        yield "h"


def _pdf_outline(outline: Outline) -> Iterator[str]:
    at = 0j
    for word, points in outline:
        if word == "Q":  # a quadratic as a cubic
            points = (at + 2 / 3 * (points[0] - at), points[1] + 2 / 3 * (points[0] - points[1]),
                      points[1])  # fmt: skip
        numbers = " ".join(map(_xy, points))
        letter = {"M": "m", "L": "l", "Q": "c", "C": "c", "Z": "h"}[word]
        yield f"{numbers} {letter}".strip()
        at = points[-1] if points else at
