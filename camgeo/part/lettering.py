"""Engraved texts: their letters in place, as boundaries, clear of each other."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import least_distance
from camgeo.contour.pieces import Pieces
from camgeo.contour.simple import winding_number
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.engraving import CIRCLE, ENGRAVING, LETTER, OUTWARD, Engraving
from camgeo.part.glyphs import glyph, kerning
from camgeo.part.letter_boundary import LetterBoundary
from camgeo.units import TURN

COARSEST: Final = 0.004
"""Of the fits of an outline, as a share of the height of capital letters: strokes are an eighth of
it wide."""

APART: Final = 0.01
"""By which outlines must at least lie apart, as a share of the height of capital letters."""


FAR: Final = 1.5
"""Of the distances at which letters can touch, beyond which they need not be compared; it covers
how far arcs bulge beyond their ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Letter:
    """A letter in place.

    Attributes
    ----------
    character : which it is.
    place : its middle [mm], at half the height of capital letters.
    boundaries : its outlines, holes and what stands within them, by which it is cut.
    contours : these as lines and arcs.
    deviation : of these [mm].
    """

    character: str
    place: complex
    boundaries: tuple[LetterBoundary, ...]
    contours: tuple[Contour, ...]
    deviation: float

    @property
    def where(self) -> str:
        """Which letter, and where it is."""
        return f'"{self.character}" at X {self.place.real:.4g}, Y {self.place.imag:.4g} mm'


def lettered(texts: Sequence[Engraving]) -> tuple[tuple[Letter, ...], ...]:
    """The letters of each text.

    Raises
    ------
    GeometryError
        With the key of the text, if the font lacks a character, letters or their outlines touch, or
        a text goes round the cam axis more than once.
    """
    found = tuple(_letters(text, number) for number, text in enumerate(texts, start=1))
    letters = [(number, each) for number, text in enumerate(found, start=1) for each in text]
    for first, second in _near([each for _, each in letters]):
        (_, one), (number, other) = letters[first], letters[second]
        apart = least_distance(Pieces.around(one.contours), Pieces.around(other.contours))
        if apart <= APART * texts[number - 1].height:
            message = f"the {other.where} touches the {one.where}"
            raise GeometryError(message, key=f"part.{ENGRAVING}[{number}]")
    return found


def _near(letters: Sequence[Letter]) -> list[tuple[int, int]]:
    """The pairs of letters that may touch, by their numbers, in order."""
    places = np.array([each.place for each in letters])
    reaches = np.array(
        [
            max(float(np.max(np.abs(contour.vertices - each.place))) for contour in each.contours)
            for each in letters
        ]
    )
    near = np.abs(places[:, None] - places) <= FAR * (reaches[:, None] + reaches)
    pairs: list[tuple[int, int]] = [(one, other) for one, other in np.argwhere(np.triu(near, 1))]
    return pairs


def _letters(text: Engraving, number: int) -> tuple[Letter, ...]:
    key = f"part.{ENGRAVING}[{number}]"
    found = []
    for count, (character, place, along) in enumerate(_places(text, key), start=1):
        middle = 0.5 * glyph(character).advance + 0.5j
        outlines = [
            place + text.height * along * (each - middle) for each in glyph(character).outlines
        ]
        if outlines:
            name = f"{ENGRAVING} {number}{LETTER}{count}"
            found.append(_letter(character, place, outlines, name, text, key))
    return tuple(found)


def _places(text: Engraving, key: str) -> Iterator[tuple[str, complex, complex]]:
    """Each character with its place [mm] and the direction in which it is read there.

    Along a circle letters have the distances of straight text where they are nearest to the cam
    axis, at their feet or at their tops.
    """
    advances = [glyph(each).advance for each in text.text]
    moved = [0.0, *(kerning(*pair) for pair in pairwise(text.text))]
    starts = np.cumsum(moved) + np.concatenate(([0.0], np.cumsum(advances)[:-1]))
    first, last = _ink(text.text, starts)
    sizes = text.height * (starts + 0.5 * np.array(advances) - 0.5 * (first + last))
    ray = cmath.exp(1j * text.angle)
    outward = text.tops == OUTWARD
    if text.along != CIRCLE:
        way = ray * (-1j if outward else 1j)
        if text.turn is not None:
            way = cmath.exp(1j * text.turn)
        for character, size in zip(text.text, sizes.tolist(), strict=True):
            yield character, text.radius * ray + size * way, way
        return
    radius = text.radius - 0.5 * text.height
    if text.height * (last - first) >= TURN * radius:
        message = (
            f"{text.height * (last - first):.4g} mm of text do not fit around"
            f" {TURN * radius:.4g} mm, the circle on which the letters are nearest to the cam axis"
        )
        raise GeometryError(message, key=f"{key}.radius", value=f"{text.radius:g}")
    for character, size in zip(text.text, sizes.tolist(), strict=True):
        turned = ray * cmath.exp((-1j if outward else 1j) * size / radius)
        yield character, text.radius * turned, turned * (-1j if outward else 1j)


def _ink(text: str, starts: ComplexArray) -> tuple[float, float]:
    """Where what is drawn of a straight text begins and ends, in heights of capital letters."""
    ends = [
        (start + float(np.min(each.real)), start + float(np.max(each.real)))
        for character, start in zip(text, starts.tolist(), strict=True)
        for each in glyph(character).outlines
    ]
    return min((low for low, _ in ends), default=0.0), max((high for _, high in ends), default=0.0)


def _letter(
    character: str,
    place: complex,
    outlines: list[ComplexArray],
    name: str,
    text: Engraving,
    key: str,
) -> Letter:
    """A letter of its outlines, by turns holes and what stands within them."""
    coarsest = COARSEST * text.height
    made = [
        LetterBoundary(f"{name} outline {number}", True, each, coarsest)
        for number, each in enumerate(outlines, start=1)
    ]
    fits = [each.beside(coarsest) for each in made]
    contours = [fit.contour for fit in fits]
    for one, other in combinations(contours, 2):
        apart = least_distance(Pieces.around([one]), Pieces.around([other]))
        if apart <= APART * text.height:
            message = f'outlines of "{character}" touch each other, which cannot be engraved'
            raise GeometryError(message, key=f"{key}.text", value=text.text)
    boundaries = []
    for boundary, contour in zip(made, contours, strict=True):
        start = complex(contour.vertices[0])
        around = sum(
            winding_number(other, start) != 0 for other in contours if other is not contour
        )
        boundaries.append(boundary if around % 2 == 0 else replace(boundary, hole=False))
    deviation = max(fit.deviation for fit in fits)
    return Letter(character, place, tuple(boundaries), tuple(contours), deviation)
