"""Widths of texts, by which a sheet is laid out.

They are those of DejaVu Sans, with which sheets are drawn as PDF and SVG; fonts that CAD programs
take in its place are narrower.
"""

from __future__ import annotations

from typing import Final

NARROWED: Final = 0.8
"""Width of the letters of a sheet, as a fraction of the font's."""

FIRST: Final = 32

WIDTHS: Final = (
    *(44, 55, 63, 115, 87, 130, 107, 38, 54, 54, 69, 115, 44, 49, 44, 46),
    *(87, 87, 87, 87, 87, 87, 87, 87, 87, 87, 46, 46, 115, 115, 115, 73),
    *(137, 94, 94, 96, 106, 87, 79, 106, 103, 40, 40, 90, 76, 118, 103, 108),
    *(83, 108, 95, 87, 84, 100, 94, 136, 94, 84, 94, 54, 46, 54, 115, 69),
    *(69, 84, 87, 75, 87, 84, 48, 87, 87, 38, 38, 79, 38, 134, 87, 84),
    *(87, 87, 56, 71, 54, 87, 81, 112, 81, 81, 72, 87, 46, 87, 115),
)
"""Of the characters from `FIRST`, in percent of the height of capitals."""

OTHER: Final = 115
"""Of any other character, in percent; few are wider."""


def width_of(text: str, height: float) -> float:
    """Width [mm] of a text whose capitals are `height` [mm] high."""
    places = (ord(letter) - FIRST for letter in text.replace("%%c", "O"))
    total = sum(WIDTHS[k] if 0 <= k < len(WIDTHS) else OTHER for k in places)
    return NARROWED * height * total / 100.0


def squeeze(text: str, height: float, width: float) -> float:
    """By what a text is narrowed further to be at most `width` [mm] wide; 1 if it need not be."""
    wide = width_of(text, height)
    return 1.0 if not width or wide <= width else width / wide


def wrapped(text: str, height: float, width: float) -> tuple[str, ...]:
    """The text in lines at most `width` [mm] wide, broken at spaces; longer words stay whole."""
    lines: list[str] = []
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and width_of(longer, height) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return tuple(lines)
