"""The contents of a panel: lines, areas, text, and how each is drawn. Nothing here draws.

Coordinates are those of the panel's axes unless a mark states otherwise; widths and sizes of text
and markers are in points, colours as in HTML. NaN in a line or a band is a gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from camgeo.numeric.arrays import FloatArray, frozen

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Style:
    """How a line and the markers on its points are drawn.

    Attributes
    ----------
    color : of the line, and of the markers unless they have their own.
    width : of the line; 0 for markers alone.
    dashes : alternating lengths on and off, in line widths; empty for a solid line.
    marker : "o" round, "s" square, "D" on a corner, "^" "v" "<" triangle, "P" "X" cross, "*" star,
        "+" "x" thin cross; "" for none.
    size, face, edge, edge_width : of the markers.
    cap, join : ends and corners of a solid line.
    """

    color: str
    width: float = 1.4
    dashes: tuple[float, ...] = ()
    marker: str = ""
    size: float = 6.0
    face: str = ""
    edge: str = ""
    edge_width: float = 1.0
    cap: Literal["butt", "round", "projecting"] = "projecting"
    join: Literal["round", "miter"] = "round"


@dataclass(frozen=True, slots=True)
class Fill:
    """How an area is drawn; without `face` or `edge` if they are empty."""

    face: str = ""
    edge: str = ""
    width: float = 1.0
    dashes: tuple[float, ...] = ()
    hatched: bool = False
    opacity: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A line through `points` (n, 2), with markers on them if its style has any.

    Attributes
    ----------
    layer : marks of higher layers are drawn on top, within a layer later ones.
    clipped : whether it ends at the panel's edges.
    """

    points: FloatArray
    style: Style
    label: str = ""
    layer: float = 2.0
    clipped: bool = True


@dataclass(frozen=True, slots=True)
class Rule:
    """A straight line across the whole panel, where the `axis` has the value `at`."""

    axis: Literal["x", "y"]
    at: float
    style: Style
    label: str = ""
    layer: float = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """The area between two curves, `low` and `high` (n,) over `places` (n,) of the `axis`."""

    axis: Literal["x", "y"]
    places: FloatArray
    low: FloatArray
    high: FloatArray
    style: Fill
    label: str = ""
    layer: float = 1.0

    def __post_init__(self) -> None:
        _freeze(self, "places", "low", "high")


@dataclass(frozen=True, slots=True, eq=False)
class Area:
    """The area inside closed rings, each (n, 2): the first the outermost, the others its holes.

    `closed` is false if the edge is drawn open, from the first to the last point.
    """

    rings: tuple[FloatArray, ...]
    style: Fill
    label: str = ""
    layer: float = 1.0
    closed: bool = True


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle."""

    centre: Point
    radius: float
    style: Fill
    layer: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Arrow:
    """A line through `points` (n, 2) with a filled head of `head` points at its end."""

    points: FloatArray
    style: Style
    head: float
    layer: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Where the `values` (rows, columns) at `x` (columns,), `y` (rows,) lie between two levels.

    Attributes
    ----------
    within : only inside this.
    """

    x: FloatArray
    y: FloatArray
    values: FloatArray
    between: tuple[float, float]
    style: Fill
    within: Band
    label: str = ""
    layer: float = 1.0

    def __post_init__(self) -> None:
        _freeze(self, "x", "y", "values")


@dataclass(frozen=True, slots=True)
class Box:
    """The box behind a text, so that it can be read on top of lines; `pad` as in matplotlib."""

    pad: float
    opacity: float = 1.0
    ring: bool = False


@dataclass(frozen=True, slots=True)
class Text:
    r"""A text.

    Attributes
    ----------
    text : lines separated by "\n"; letters between "$_" and "$" are subscripts, as in TeX.
    at : place, as fractions of the panel or figure from the lower left if not of the axes.
    offset : from there to the text [points].
    across, up : which part of the text is placed there.
    spacing : of lines, in sizes of the text; None for the font's own.
    """

    text: str
    at: Point
    size: float
    of: Literal["data", "panel", "figure"] = "data"
    offset: Point | None = None
    across: Literal["left", "center", "right"] = "left"
    up: Literal["bottom", "baseline", "center", "top"] = "baseline"
    turned: bool = False
    bold: bool = False
    spacing: float | None = None
    box: Box | None = None
    layer: float = 3.0


Mark = Line | Rule | Band | Area | Circle | Arrow | Field | Text


def _freeze(mark: Band | Field, *names: str) -> None:
    for name in names:
        object.__setattr__(mark, name, frozen(getattr(mark, name), np.float64))


def over(x: ArrayLike, y: ArrayLike) -> FloatArray:
    """(n, 2) points of a curve `y` (n,) over `x` (n,)."""
    return frozen(np.column_stack((x, y)), np.float64)


def plane(points: ArrayLike) -> FloatArray:
    """(n, 2) points of the complex `points` (n,)."""
    z = np.asarray(points)
    return over(z.real, z.imag)
