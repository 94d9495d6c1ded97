"""The sheet itself: trimmed size, frame and grid (ISO 5457), and the title block (ISO 7200)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.formats.drawing import DrawingSpec, SheetName
from camgeo.sheet.lettering import width_of
from camgeo.sheet.marks import Label, Mark, line, rectangle
from camgeo.sheet.symbols import first_angle
from camgeo.sheet.words import WORDS
from camgeo.units import LengthUnit


@dataclass(frozen=True, slots=True)
class Size:
    """A sheet: width and height [mm], and the fields of its grid along each."""

    width: float
    height: float
    columns: int
    rows: int


SIZES: Final[dict[SheetName, Size]] = {"A3": Size(420, 297, 8, 6), "A4": Size(210, 297, 4, 6)}

LEFT, MARGIN = 20.0, 10.0
"""Of the frame, on the left for filing and on the other sides [mm]."""

BAND = 5.0
"""Width of the grid outside the frame [mm]."""

FIELD = 50.0
"""Length of a field of the grid, from the middle of the sheet [mm]."""

BLOCK_WIDTH, BLOCK_HEIGHT = 180.0, 38.0
"""Of the title block [mm]."""

Row = tuple[float, float, tuple[tuple[str, str, float, float], ...]]
"""Bottom and height of a row of the title block, and its cells: label, text, width, letters."""


def frame(size: Size) -> list[Mark]:
    """Trimmed edge, frame, centring marks and grid; an A4 sheet has letters on two sides only."""
    low, high = complex(LEFT, MARGIN), complex(size.width - MARGIN, size.height - MARGIN)
    inner, outer = high - low, high - low + complex(2 * BAND, 2 * BAND)
    marks: list[Mark] = [
        rectangle(0j, size.width, size.height, "GRID"),
        rectangle(low, inner.real, inner.imag, "FRAME"),
        rectangle(low - complex(BAND, BAND), outer.real, outer.imag, "GRID"),
    ]
    x, y = 0.5 * size.width, 0.5 * size.height
    ends = ((complex(x, low.imag), -1j), (complex(x, high.imag), 1j),
            (complex(low.real, y), -1.0), (complex(high.real, y), 1.0))  # fmt: skip
    marks += [line(at + BAND * way, at, "FRAME") for at, way in ends]
    both = size.columns > 4
    for number in range(size.columns):
        start = x + (number - 0.5 * size.columns) * FIELD
        ends_at = _clipped(start, FIELD, low.real, high.real)
        for side in (low.imag - BAND, high.imag) if both else (high.imag,):
            if number:
                marks.append(line(complex(start, side), complex(start, side + BAND), "GRID"))
            at = complex(0.5 * sum(ends_at), side + 1.25)
            marks.append(Label(str(number + 1), at, 2.5, "centre", "GRID"))
    for number in range(size.rows):
        start = y - (number - 0.5 * size.rows + 1.0) * FIELD
        ends_at = _clipped(start, FIELD, low.imag, high.imag)
        for side in (low.real - BAND, high.real) if both else (high.real,):
            if number:
                level = start + FIELD
                marks.append(line(complex(side, level), complex(side + BAND, level), "GRID"))
            at = complex(side + 0.5 * BAND, 0.5 * sum(ends_at) - 1.25)
            marks.append(Label("ABCDEF"[number], at, 2.5, "centre", "GRID"))
    return marks


def _clipped(start: float, length: float, low: float, high: float) -> tuple[float, float]:
    return max(start, low), min(start + length, high)


def title_block(
    corner: complex,
    spec: DrawingSpec,
    scale: str,
    unit: LengthUnit,
    sheet: tuple[int, int],
) -> list[Mark]:
    """The title block by its lower left corner; `sheet` is its number and how many there are."""
    words = WORDS[spec.language]
    numbered = f"{sheet[0]}/{sheet[1]}"
    rows: tuple[Row, ...] = (
        (28.0, 10.0, (
            (words.material, spec.material, 52.0, 2.5),
            (words.hardness, spec.hardness, 40.0, 2.5),
            (words.tolerances, spec.general_tolerances, 52.0, 2.5),
            (words.scale, scale, 18.0, 3.5),
            ("", "", 18.0, 2.5),
        )),
        (18.0, 10.0, (
            (words.owner, spec.owner, 52.0, 2.5),
            (words.document_type, spec.document_type, 52.0, 2.5),
            (words.edges, "", 30.0, 2.5),
            (words.surface, "", 28.0, 2.5),
            (words.dimensions, unit, 18.0, 2.5),
        )),
        (9.0, 9.0, (
            (words.creator, spec.creator, 52.0, 2.5),
            (words.approver, spec.approver, 52.0, 2.5),
            (words.date, spec.date, 30.0, 2.5),
            (words.revision, spec.revision, 14.0, 2.5),
            (words.language, spec.language, 14.0, 2.5),
            (words.size, spec.sheet, 18.0, 2.5),
        )),
        (0.0, 9.0, (
            (words.title, spec.title, 104.0, 3.5),
            (words.number, spec.number, 58.0, 3.5),
            (words.sheet, numbered, 18.0, 2.5),
        )),
    )  # fmt: skip
    marks: list[Mark] = [rectangle(corner, BLOCK_WIDTH, BLOCK_HEIGHT, "FRAME")]
    for bottom, height, cells in rows:
        left = 0.0
        for label, text, width, letter in cells:
            at = corner + complex(left, bottom)
            marks.append(rectangle(at, width, height, "GRID"))
            if label:
                head = at + complex(1.0, height - 2.6)
                marks.append(Label(label, head, 1.8, width=width - 2.0))
            if text:
                marks.append(Label(text, at + complex(1.5, 1.3), letter, width=width - 3.0))
            left += width
    marks += first_angle(corner + complex(171.0, 33.0))
    return marks


def block_place(name: str) -> complex:
    """Where the symbol in the cell of "edges" or "surface" has its tip, from the block's corner."""
    return {"edges": complex(108.0, 19.0), "surface": complex(138.0, 18.8)}[name]


def column(texts: tuple[str, ...], top: complex, letter: float, step: float) -> list[Mark]:
    """Lines of text, the first one below `top`."""
    return [
        Label(text, top - 1j * (letter + step * number), letter)
        for number, text in enumerate(texts)
    ]


def widest(texts: tuple[str, ...], letter: float) -> float:
    """Width of the widest of some texts [mm]."""
    return max((width_of(text, letter) for text in texts), default=0.0)
