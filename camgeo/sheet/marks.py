"""The contents of a sheet: lines, arcs, texts, dimensions. Nothing here draws.

Marks of the sheet itself are in millimetres of paper, from its lower left corner; those of a view
are in millimetres of the part. Heights of texts are always those on paper.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, frozen
from camgeo.units import LengthUnit

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
    unit : of the dimensions.
    comma : whether decimals follow a comma.
    views : the first one is the front view, whose origin is the cam axis.
    marks : on the sheet itself.
    """

    width: float
    height: float
    scale: float
    unit: LengthUnit
    comma: bool
    views: tuple[View, ...]
    marks: tuple[Mark, ...] = field(default=())


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


def arc(centre: complex, start: complex, sweep: float, layer: Layer) -> Chain:
    """An arc from `start` that turns by `sweep` [rad], in quarters at most: half circles are turned
    over by some programs.
    """
    count = math.ceil(abs(sweep) / (0.5 * math.pi) - 1e-9)
    turns = np.exp(1j * sweep * np.arange(count + 1) / count)
    sweeps = np.full(count + 1, sweep / count)
    return Chain(centre + (start - centre) * turns, sweeps, layer)


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
