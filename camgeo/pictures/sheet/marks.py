"""The contents of a sheet: lines, arcs, texts, dimensions. Nothing here draws.

Marks of the sheet itself are in millimetres of paper, from its lower left corner; those of a view
are in millimetres of the part. Heights of texts are always those on paper.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, frozen
from camgeo.units import MM_PER, LengthUnit

Layer = Literal[
    "OUTLINE", "HIDDEN", "SECTION", "EDGES", "CENTRE", "PITCH_CURVE", "BASE_CIRCLE",
    "HATCH", "DIMENSION", "SYMBOL", "TEXT", "FRAME", "GRID", "DIAGRAM", "ENGRAVING",
]  # fmt: skip
"""What a line means. OUTLINE and HIDDEN are the edges of the part seen from above, SECTION what is
cut, EDGES what is visible behind it and other wide lines, ENGRAVING the outlines of letters."""

Across = Literal["left", "centre", "right"]

DIAMETER: Final = "%%c"
"""The diameter sign, as every CAD program knows it."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Lines and arcs end to end.

    Attributes
    ----------
    vertices : (n,) complex [mm].
    sweeps : (n,) angle turned from each vertex to the next [rad]; 0 is a line. The last one counts
        only if the chain is closed.
    """

    vertices: ComplexArray
    sweeps: FloatArray
    layer: Layer
    closed: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, np.complex128))
        object.__setattr__(self, "sweeps", frozen(self.sweeps, np.float64))


@dataclass(frozen=True, slots=True)
class Round:
    """A circle [mm]."""

    centre: complex
    radius: float
    layer: Layer


@dataclass(frozen=True, slots=True)
class Label:
    """A line of text.

    Attributes
    ----------
    at : where its base line begins, has its middle or ends, see `across` [mm].
    height : of its capitals [mm of paper].
    angle : of its base line [rad].
    width : at most, in mm of paper, to which a longer text is narrowed; 0 for no limit.
    """

    text: str
    at: complex
    height: float = 2.5
    across: Across = "left"
    layer: Layer = "TEXT"
    angle: float = 0.0
    width: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Filled:
    """A filled polygon of three or four corners [mm]: arrowheads and datum triangles."""

    corners: tuple[complex, ...]
    layer: Layer = "SYMBOL"


@dataclass(frozen=True, slots=True, eq=False)
class Hatched:
    """A cut face, hatched inside its closed polygon [mm]."""

    corners: ComplexArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", frozen(self.corners, np.complex128))


@dataclass(frozen=True, slots=True)
class Distance:
    """A dimension: the distance of two points of the part along a direction.

    Attributes
    ----------
    first, second : the points that it measures [mm].
    line : any point on the dimension line [mm].
    angle : of the dimension line [rad].
    prefix, suffix : around the measured number, which is never stated itself.
    decimals : that are written at most; zeros at the end are not.
    aside : how far the text is from the middle, along the line [mm of paper].
    bare : which end has no arrow, for a datum stands in its place: 1 or 2, or 0 for neither.
    """

    first: complex
    second: complex
    line: complex
    angle: float = 0.0
    prefix: str = ""
    suffix: str = ""
    decimals: int = 3
    aside: float = 0.0
    bare: int = 0

    @property
    def measure(self) -> float:
        """What it measures [mm of the part]."""
        along = complex(np.exp(1j * self.angle))
        return abs(((self.second - self.first) * along.conjugate()).real)


@dataclass(frozen=True, slots=True)
class Diameter:
    """A dimension: the diameter of a circle. A leader on a ray from the centre ends at the circle;
    the text stands on a shelf at its other end, after a diameter sign.

    Attributes
    ----------
    centre, radius : of the circle [mm].
    angle : of the ray [rad].
    reach : length of the leader [mm of paper].
    count : how many such circles there are.
    suffix : after the measured number, which is never stated itself.
    decimals : that are written at most; zeros at the end are not.
    """

    centre: complex
    radius: float
    angle: float
    reach: float = 8.0
    count: int = 1
    suffix: str = ""
    decimals: int = 3

    @property
    def prefix(self) -> str:
        """Before the number: how many there are, and the diameter sign."""
        return f"{self.count}x {DIAMETER}" if self.count > 1 else DIAMETER

    @property
    def measure(self) -> float:
        """What it measures [mm of the part]."""
        return 2.0 * self.radius


LETTERS: Final = 3.5
"""Height of the texts of dimensions [mm of paper]."""


ARROW: Final = 3.0
"""Length of their arrows [mm of paper]."""


LIFTED: Final = 0.8
"""Of texts above the dimension line, and the gap beside arrows [mm of paper]."""


BEFORE, BEHIND = 0.8, 1.5
"""From the part to its extension line, and from the dimension line to its end [mm of paper]."""


BEFORE, BEHIND = 0.8, 1.5
"""From the part to its extension line, and from the dimension line to its end [mm of paper]."""


QUARTERS: Final[ComplexArray] = frozen([1.0, 1j, -1.0, -1j], np.complex128)
"""Unit vectors to the quarters of a circle."""


Mark = Chain | Round | Label | Filled | Hatched | Distance | Diameter


@dataclass(frozen=True, slots=True)
class View:
    """A view of the part.

    Attributes
    ----------
    at : place of the view's origin on the sheet [mm of paper].
    marks : [mm of the part].
    """

    at: complex
    marks: tuple[Mark, ...]


@dataclass(frozen=True, slots=True)
class Sheet:
    """A whole sheet.

    Attributes
    ----------
    width, height : trimmed [mm].
    scale : millimetres of paper for each millimetre of the part.
    ratio : the same as the title block states it, "1:2".
    unit : of the dimensions.
    comma : whether decimals follow a comma.
    views : the first one is the front view, whose origin is the cam axis.
    marks : on the sheet itself.
    """

    width: float
    height: float
    scale: float
    ratio: str
    unit: LengthUnit
    comma: bool
    views: tuple[View, ...]
    marks: tuple[Mark, ...] = ()

    @property
    def dimensions(self) -> tuple[Distance | Diameter, ...]:
        """Those of all views."""
        marks = (mark for view in self.views for mark in view.marks)
        return tuple(mark for mark in marks if isinstance(mark, Distance | Diameter))


def number_of(mark: Distance | Diameter, unit: LengthUnit) -> str:
    """The text of a dimension, with a decimal point."""
    text = f"{mark.measure / MM_PER[unit]:.{mark.decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return f"{mark.prefix}{text}{mark.suffix}"


def shelf_of(text: str) -> float:
    """Length of the line below the text of a diameter [mm of paper]: as if all letters were as wide
    as high, before they are narrowed.
    """
    return NARROWED * LETTERS * len(text.replace(DIAMETER, "O"))


def line(start: complex, end: complex, layer: Layer) -> Chain:
    """A straight line."""
    return path((start, end), layer)


def path(points: tuple[complex, ...], layer: Layer, *, closed: bool = False) -> Chain:
    """Straight lines from point to point."""
    return Chain(np.array(points), np.zeros(len(points)), layer, closed)


def rectangle(corner: complex, width: float, height: float, layer: Layer) -> Chain:
    """A rectangle by its lower left corner."""
    across, up = complex(width), 1j * height
    return path((corner, corner + across, corner + across + up, corner + up), layer, closed=True)


def arrow(tip: complex, direction: complex, layer: Layer = "SYMBOL", size: float = 3.0) -> Filled:
    """An arrowhead of `size` that points along the unit vector `direction`."""
    back, side = tip - size * direction, size / 6.0 * 1j * direction
    return Filled((tip, back + side, back - side), layer)


def moved(marks: Sequence[Mark], at: complex, scale: float) -> list[Mark]:
    """Marks of paper as marks of a view, their origin at the place `at` of the part [mm]."""
    found: list[Mark] = []
    for mark in marks:
        if isinstance(mark, Chain):
            found.append(replace(mark, vertices=at + mark.vertices / scale))
        elif isinstance(mark, Round):
            found.append(replace(mark, centre=at + mark.centre / scale, radius=mark.radius / scale))
        elif isinstance(mark, Label):
            found.append(replace(mark, at=at + mark.at / scale))
        elif isinstance(mark, Filled):
            found.append(replace(mark, corners=tuple(at + each / scale for each in mark.corners)))
    return found


# -- stretch --------------------------------------------------------------------------------------
# Stretches of a contour, cut from its lines and arcs.


# -- lettering ------------------------------------------------------------------------------------
# Widths of texts, by which a sheet is laid out.
#
# They are those of DejaVu Sans, with which sheets are drawn as PDF and SVG; fonts that CAD programs
# take in its place are narrower.


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


# -- symbols --------------------------------------------------------------------------------------
# Symbols of technical drawings [mm of paper], made of lines so that every program shows them.


LETTER = 3.5
"""Height of letters in frames and at datums."""

CELL = 7.0
"""Height of a frame, and the least width of its cells: twice the letters (ISO 7083)."""


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
