"""The outlines of letters, from the font that matplotlib brings.

They are those of matplotlib's text paths, without what looks for fonts on the machine: the same
text has the same outlines everywhere. TrueType outlines consist of lines and quadratic
Bezier curves (Apple, "TrueType Reference Manual", chapter "Digitizing Letterform Designs").
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, frozen

FONT: Final = "DejaVu Sans"
FILE: Final = "fonts/ttf/DejaVuSans.ttf"
"""The font, and its file within the data of matplotlib."""

CAPITAL: Final = 1493.0
"""Height of the font's capital letters in its units, measured on "H"."""

MOVE, LINE, QUADRATIC, CLOSEST = 1, 2, 3, 79
"""Codes of the path commands of matplotlib."""

FIXED: Final = 65536.0
"""Units of FreeType's fixed-point numbers, 16.16."""


@dataclass(frozen=True, slots=True, eq=False)
class Glyph:
    """The outlines of a letter, in heights of capital letters, its foot on the x axis.

    Attributes
    ----------
    outlines : each (n, 3) complex, the Bezier points of quadratic curves, end to end and closed; of
        a line the middle one lies halfway. Empty for a space.
    advance : from its origin to that of the next letter.
    """

    outlines: tuple[ComplexArray, ...]
    advance: float


@cache
def glyph(character: str) -> Glyph:
    """The outlines of a character.

    Raises
    ------
    GeometryError
        With key "part.engraving.text", if the font has no such character.
    """
    from matplotlib.ft2font import LoadFlags

    font = _font()
    index = _index(font, character)
    loaded = font.load_glyph(index, flags=LoadFlags.NO_HINTING)
    points, codes = font.get_path()
    outlines = _outlines(points[:, 0] + 1j * points[:, 1], codes.tolist())
    advance = loaded.linearHoriAdvance / FIXED
    return Glyph(
        tuple(frozen(outline / CAPITAL, np.complex128) for outline in outlines), advance / CAPITAL
    )


@cache
def kerning(left: str, right: str) -> float:
    """By how much the font moves the right one of two letters away from the left one, in heights of
    capital letters.
    """
    from matplotlib.ft2font import Kerning

    font = _font()
    one, other = _index(font, left), _index(font, right)
    moved: int = font.get_kerning(one, other, Kerning.UNSCALED)
    return moved / CAPITAL


def require_glyphs(text: str) -> None:
    """GeometryError with key "part.engraving.text", if the font lacks a character of the text."""
    font = _font()
    for character in text:
        _index(font, character)


def _index(font: Any, character: str) -> Any:
    index = font.get_char_index(ord(character))
    if not index:
        raise GeometryError(
            f'{FONT} has no "{character}" (U+{ord(character):04X}) to engrave',
            "part.engraving.text",
            character,
        )
    return index


def _font() -> Any:
    """A new object of the font, whose size is its number of units, so that outlines are in units
    and not rounded.

    The object holds the letter loaded last, so each caller needs one of its own.
    """
    import matplotlib as mpl
    from matplotlib.ft2font import FT2Font

    font = FT2Font(str(Path(mpl.get_data_path()) / FILE))
    font.set_size(font.units_per_EM, 72)
    return font


def _outlines(points: ComplexArray, codes: list[int]) -> list[ComplexArray]:
    """The closed outlines of a path, (n, 3) each; an outline that encloses no area is left out."""
    outlines: list[ComplexArray] = []
    pieces: list[tuple[complex, complex, complex]] = []
    point, number = 0j, 0
    while number < len(codes):
        code, here = codes[number], complex(points[number])
        if code == MOVE:
            point, pieces = here, []
        elif code == LINE:
            pieces.append((point, 0.5 * (point + here), here))
            point = here
        elif code == QUADRATIC:
            # A quadratic curve takes two points, the middle one and its end.
            number += 1
            end = complex(points[number])
            pieces.append((point, here, end))
            point = end
        elif code == CLOSEST and pieces:
            start = pieces[0][0]
            if point != start:
                pieces.append((point, 0.5 * (point + start), start))
            moving = [piece for piece in pieces if piece[0] != piece[2]]
            if len(moving) > 1:
                outlines.append(np.array(moving))
        number += 1
    # The pieces of each outline must be end to end.
    assert all(one[2] == two[0] for outline in outlines for one, two in pairwise(outline.tolist()))
    return outlines
