"""What a scene states of engraved text."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.mechanism.values import Angle, Length
from camgeo.numeric.checked import check_fields, instance, number, one_of, shown
from camgeo.part.glyphs import require_glyphs

ENGRAVING: Final = "engraving"
"""Key of the list of texts in [part], and how the names of their boundaries begin."""

LETTER: Final = " letter "
"""In the name of a boundary, between that of its text and the number of the character."""

CIRCLE: Final = "circle"
STRAIGHT: Final = "straight"
COURSES: Final = (CIRCLE, STRAIGHT)
"""What the line of a text follows."""

OUTWARD: Final = "outward"
INWARD: Final = "inward"
SENSES: Final = (OUTWARD, INWARD)
"""Where the tops of letters point, seen from the cam axis."""

MOST_LETTERS: Final = 100
"""Characters of a text."""

MOST_TEXTS: Final = 20
"""Texts of a part."""

SHAPED: Final = ("R", "AL", "AN")
"""Directions of characters that are written from right to left, in shapes that depend on their
neighbours."""


def text_to_engrave(key: str, value: Any) -> str:
    """A line of text in composed characters, each of which has one shape.

    Raises
    ------
    GeometryError
        If it is empty or too long, or a character does not stand for itself.
    """
    text = unicodedata.normalize("NFC", instance(key, value, str, "a text"))
    if not text.strip() or len(text) > MOST_LETTERS:
        message = f"must be a text of 1 to {MOST_LETTERS} characters, not of spaces alone"
        raise GeometryError(message, key, shown(value))
    for each in text:
        known = f"U+{ord(each):04X}"
        if unicodedata.category(each)[0] in "MC":
            message = f"{known} in it is no character of its own, so it cannot be engraved"
            raise GeometryError(message, key, shown(value))
        if unicodedata.bidirectional(each) in SHAPED:
            message = f'"{each}" ({known}) is written from right to left, which is not engraved'
            raise GeometryError(message, key, shown(value))
    return text


@dataclass(frozen=True, slots=True)
class Engraving:
    """A line of text sunk in the upper face of the disc.

    Attributes
    ----------
    text : in composed characters (NFC).
    height : of capital letters [mm].
    depth : below the upper face [mm].
    radius : distance of its middle, at half the height of capital letters, from the cam axis [mm].
    angle : direction of its middle from the x axis at cam angle 0 [rad], counter-clockwise, -2 pi
        to 2 pi.
    along : one of `COURSES`: letters stand on a circle about the cam axis, or on a straight line.
    tops : one of `SENSES`: where the tops of the letters point, at the middle of the text.
    turn : of a straight text, the direction in which it is read, from the x axis at cam angle 0
        [rad], in place of `tops`; None for across the ray through its middle.

    Raises
    ------
    GeometryError
        With the key in `part.engraving`, if a value is invalid, the letters of a text along a
        circle reach the cam axis, or a text along a circle has a turn.
    """

    text: Annotated[str, text_to_engrave]
    height: Length
    depth: Length
    radius: Length
    angle: Angle = 0.0
    along: Annotated[str, partial(one_of, choices=COURSES)] = CIRCLE
    tops: Annotated[str, partial(one_of, choices=SENSES)] = OUTWARD
    turn: Angle | None = None

    def __post_init__(self) -> None:
        check_fields(self, f"part.{ENGRAVING}.")
        if self.along == STRAIGHT:
            return
        if self.turn is not None:
            message = 'belongs to a "straight" text; along a circle tops point outward or inward'
            raise GeometryError(message, f"part.{ENGRAVING}.turn")
        number(f"part.{ENGRAVING}.radius", self.radius, above=0.5 * self.height, unit="mm")


def text_of(boundary: str) -> str:
    """Name of the text to which the boundary of that name belongs; empty if it is of none."""
    text, letter, _ = boundary.partition(LETTER)
    return text if letter and text.startswith(ENGRAVING) else ""


def engravings_of(tables: Iterable[Mapping[str, Any]], name: str) -> tuple[Engraving, ...]:
    """The texts of converted tables, in mm and rad; that of one without a text is `name`.

    Raises
    ------
    GeometryError
        With the key of the text, counted from 1, if one is invalid or its font has no such
        character.
    """
    found = []
    for number_of_text, table in enumerate(tables, start=1):
        try:
            made = Engraving(**{"text": name, **table})
            require_glyphs(made.text)
        except GeometryError as error:
            begin = f"part.{ENGRAVING}"
            key = error.key.replace(begin, f"{begin}[{number_of_text}]", 1)
            raise GeometryError(error.message, key, error.value) from None
        found.append(made)
    return tuple(found)
