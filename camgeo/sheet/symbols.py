"""Symbols of technical drawings [mm of paper], made of lines so that every program shows them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from camgeo.sheet.lettering import width_of
from camgeo.sheet.marks import Label, Mark, Round, arc, arrow, line, path, rectangle

LETTER = 3.5
"""Height of letters in frames and at datums."""

CELL = 7.0
"""Height of a frame, and the least width of its cells: twice the letters (ISO 7083)."""

SINK = 0.5 * (CELL - LETTER)


def first_angle(middle: complex) -> list[Mark]:
    """The symbol of first-angle projection (ISO 5456-2), about 16 wide and 8 high."""
    left, right = middle - 6.5, middle - 0.5
    cone = (left - 1.5j, right - 3.0j, right + 3.0j, left + 1.5j)
    rings = middle + 4.5
    return [
        path(cone, "SYMBOL", closed=True),
        Round(rings, 1.5, "SYMBOL"),
        Round(rings, 3.0, "SYMBOL"),
        line(left - 0.8, right + 0.8, "CENTRE"),
        line(rings - 3.8, rings + 3.8, "CENTRE"),
        line(rings - 3.8j, rings + 3.8j, "CENTRE"),
    ]


def tolerance_frame(corner: complex, value: str, datums: Sequence[str]) -> list[Mark]:
    """A frame of ISO 1101 for the profile of a surface, by its lower left corner."""
    marks: list[Mark] = []
    widths = [CELL, width_of(value, LETTER) + 3.0, *(CELL for _ in datums)]
    start = corner
    for width in widths:
        marks.append(rectangle(start, width, CELL, "SYMBOL"))
        start += width
    middle = corner + complex(0.5 * CELL, 2.2)
    half = 2.2
    marks.append(line(middle - half, middle + half, "SYMBOL"))
    marks.append(arc(middle, middle + half, math.pi, "SYMBOL"))
    start = corner + CELL
    for text, width in zip((value, *datums), widths[1:], strict=True):
        marks.append(Label(text, start + complex(0.5 * width, SINK), LETTER, "centre", "SYMBOL"))
        start += width
    return marks


def frame_width(value: str, datums: Sequence[str]) -> float:
    """Width of such a frame [mm]."""
    return CELL * (1 + len(datums)) + width_of(value, LETTER) + 3.0


def datum(at: complex, outward: complex, name: str) -> list[Mark]:
    """A datum (ISO 5459): the triangle stands on a line at `at`, its letter is along `outward`."""
    foot = arrow(at + 3.0 * outward, outward, size=3.0)
    base = (at + 1.7j * outward, at - 1.7j * outward, at + 3.0 * outward)
    middle = at + (7.0 + 0.5 * CELL) * outward
    corner = middle - complex(0.5 * CELL, 0.5 * CELL)
    return [
        type(foot)(base),
        line(at + 3.0 * outward, at + 7.0 * outward, "SYMBOL"),
        rectangle(corner, CELL, CELL, "SYMBOL"),
        Label(name, middle - 0.5j * LETTER, LETTER, "centre", "SYMBOL"),
    ]


def texture(at: complex, text: str, letter: float = 2.5) -> list[Mark]:
    """Surface texture (ISO 21920-1) by material removal, its tip at `at`."""
    tall = 3.0 * letter
    left = at + 1.4 * letter * complex(-math.tan(math.pi / 6.0), 1.0)
    level = at + 1.4 * letter * complex(math.tan(math.pi / 6.0), 1.0)
    top = at + tall * complex(math.tan(math.pi / 6.0), 1.0)
    end = top + width_of(text, letter) + 1.5
    return [
        path((left, at, top, end), "SYMBOL"),
        line(left, level, "SYMBOL"),
        Label(text, top + complex(1.0, -1.5 * letter), letter, layer="SYMBOL"),
    ]


def texture_width(text: str, letter: float = 2.5) -> float:
    """From the tip of that symbol to its right end [mm]."""
    return 3.0 * letter * math.tan(math.pi / 6.0) + width_of(text, letter) + 1.5


def others(at: complex, letter: float = 2.5) -> list[Mark]:
    """The basic symbol in brackets, behind the texture of all surfaces: some state another one. Its
    tip is at `at`.
    """
    aside = 1.4 * letter * complex(math.tan(math.pi / 6.0), 1.0)
    end = at + 2.6 * letter * complex(math.tan(math.pi / 6.0), 1.0)
    low = at + 0.3j * letter
    return [
        path((at - aside.conjugate(), at, end), "SYMBOL"),
        Label("(", low - 1.2 * letter, 1.6 * letter, "right", "SYMBOL"),
        Label(")", low + 1.8 * letter, 1.6 * letter, "left", "SYMBOL"),
    ]


def edges(at: complex, text: str, letter: float = 2.5) -> list[Mark]:
    """The symbol of ISO 13715 for edges of undefined shape, its corner at `at`."""
    tip = at + complex(2.0, 2.0) * letter / 2.5
    return [
        path((at - 1.5, at, at - 1.5j), "SYMBOL"),
        path((at, tip, tip + width_of(text, letter) + 1.0), "SYMBOL"),
        Label(text, tip + complex(0.7, 0.8), letter, layer="SYMBOL"),
    ]
