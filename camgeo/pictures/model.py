"""A figure as data: panels with axes and marks, text and a legend.

Everything that is shown is decided here: limits, ticks, texts, order. A renderer, matplotlib or a
browser, only chooses how to write a number at a tick, and where a legend covers least.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, is_dataclass
from functools import cache, lru_cache
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.record import Brief, Displayed
from camgeo.units import TURN

Frame = tuple[float, float, float, float]
"""Left, lower, right and upper edge, as fractions of a figure from its lower left corner."""


Corner = Literal["best", "upper left", "upper center", "upper right", "lower left", "lower center"]


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis of a panel.

    Attributes
    ----------
    limits : ends of the axis; the greater one first if the axis is reversed.
    log : whether its scale is logarithmic.
    ticks, names : positions of ticks and their labels; None for round numbers.
    numbered : whether the ticks have labels.
    powers : numbers at the ticks share a power of ten unless theirs is between these two.
    label_place : distance of the label from the panel [inch]; None for next to the numbers.
    """

    limits: tuple[float, float]
    label: str = ""
    log: bool = False
    ticks: tuple[float, ...] | None = None
    names: tuple[str, ...] | None = None
    numbered: bool = True
    powers: tuple[int, int] | None = None
    label_size: float = 9.0
    label_place: float | None = None


@dataclass(frozen=True, slots=True)
class Entry:
    """One name in a legend, with the style of what it names."""

    label: str
    style: Style | Fill


@dataclass(frozen=True, slots=True)
class Legend:
    """The names of what is drawn.

    Attributes
    ----------
    place : which part of the legend is at `anchor`; "best" is where it covers least.
    anchor : place as fractions of the panel or figure; None for the corner or edge that `place`
        names.
    gap, pad, spacing : distances from the anchor, inside the frame of the legend, and between
        names, in sizes of the text.
    """

    entries: tuple[Entry, ...]
    place: Corner = "best"
    anchor: tuple[float, float] | None = None
    columns: int = 1
    size: float = 8.0
    gap: float = 0.5
    pad: float = 0.4
    spacing: float = 0.5


@dataclass(frozen=True, slots=True)
class Panel(Brief):
    """A frame with axes, a grid, and what is drawn in it.

    Attributes
    ----------
    title_size, title_gap : size of the title, and its distance from the frame [points].
    right, above : further axes of the same frame, on the right and above.
    equal : whether a unit is equally long on both axes; then the frame shrinks to fit.
    bare : whether only marks are drawn, neither frame nor axes.
    """

    frame: Frame
    x: Axis
    y: Axis
    marks: tuple[Mark | Inset, ...]
    title: str = ""
    title_size: float = 11.0
    title_gap: float = 6.0
    legend: Legend | None = None
    right: Axis | None = None
    above: Axis | None = None
    equal: bool = False
    bare: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Inset:
    """A panel within a panel that shows part of it enlarged.

    Attributes
    ----------
    corner, side : lower left corner and side of the square that the panel fills.
    window : lower left corner and side of the square that it enlarges; lines join the two.
    """

    panel: Panel
    corner: Point
    side: float
    window: tuple[float, float, float]
    style: Style
    layer: float = 6.0


@dataclass(frozen=True, slots=True)
class Figure(Displayed):
    """A figure, or several figures one above the other.

    Attributes
    ----------
    size : width and height [inch].
    aligned : whether the labels of the vertical axes are aligned.
    rows : figures of equal width, from the top; then the figure holds nothing else.
    """

    size: tuple[float, float]
    panels: tuple[Panel, ...] = ()
    texts: tuple[Text, ...] = ()
    legend: Legend | None = None
    aligned: bool = False
    rows: tuple[Figure, ...] = ()

    def to_data(self) -> dict[str, Any]:
        """The figure as dicts, lists, texts and numbers for JSON; each part has its `kind`, and a
        gap in a line is None.
        """
        data: dict[str, Any] = figure_data(self)
        return data


def entries(marks: Iterable[Mark]) -> tuple[Entry, ...]:
    """A legend entry for each mark that has a label."""
    named = (mark for mark in marks if isinstance(mark, Line | Rule | Band | Area | Field))
    return tuple(Entry(mark.label, mark.style) for mark in named if mark.label)


PLAIN: Final = (str, float, int, bool, type(None))
"""Types that JSON data already are; most values of a figure are of the first two."""


@cache
def _names(kind: Any) -> tuple[str, ...]:
    """Names of the fields of a dataclass, kept for all figures."""
    return tuple(field.name for field in fields(kind))


def listed(array: FloatArray) -> list[Any]:
    """The numbers of an array as nested lists, with None for NaN."""
    gaps = np.isnan(array)
    if not gaps.any():
        numbers: list[Any] = array.tolist()
        return numbers
    data = array.astype(object)
    data[gaps] = None
    rows: list[Any] = data.tolist()
    return rows


@lru_cache(maxsize=512)
def _styled(style: Style | Fill) -> dict[str, Any]:
    """The data of a style; kept, as a figure has few styles for many marks."""
    kind: Any = type(style)
    data: dict[str, Any] = {"kind": kind.__name__.lower()}
    for name in _names(kind):
        data[name] = figure_data(getattr(style, name))
    return data


def figure_data(value: Any, array: Callable[[FloatArray], Any] = listed) -> Any:
    """A value as dicts, lists, texts and numbers, see `Figure.to_data`; a complex is a pair.

    Parameters
    ----------
    array : function that gives the data of an array.
    """
    kind: Any = type(value)
    if kind in PLAIN:
        return value
    if isinstance(value, tuple):
        # Most items are plain data already, and need no call.
        return [item if type(item) in PLAIN else figure_data(item, array) for item in value]
    if kind is np.ndarray:
        return array(value)
    if kind is Style or kind is Fill:
        data = dict(_styled(value))
        data["dashes"] = list(value.dashes)
        return data
    if is_dataclass(value):
        parts: dict[str, Any] = {"kind": kind.__name__.lower()}
        for name in _names(kind):
            part = getattr(value, name)
            parts[name] = part if type(part) in PLAIN else figure_data(part, array)
        return parts
    if isinstance(value, complex):
        return [value.real, value.imag]
    return value.item() if isinstance(value, np.generic) else value


# -- marks ----------------------------------------------------------------------------------------
# The contents of a panel: lines, areas, text, and how each is drawn. Nothing here draws.
#
# Coordinates are those of the panel's axes unless a mark states otherwise; widths and sizes of text
# and markers are in points, colours as in HTML. NaN in a line or a band is a gap.


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
    """How an area is drawn: without filling if `face` is empty, without edge if `edge` is."""

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
    layer : marks of higher layers are drawn on top; within a layer, later ones are.
    clipped : whether the line ends at the panel's edges.
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
    """The area inside closed rings, each (n, 2): the first is the outer one, the others are holes.

    `closed` is false if the edge is drawn open, from the first to the last point only.
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
    between : the two levels.
    within : band outside which nothing is drawn.
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
    at : place in the coordinates that `of` names: those of the axes, or fractions of the panel or
        figure from its lower left corner.
    offset : from that place to the text [points].
    across, up : which part of the text is placed there, horizontally and vertically.
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


# -- layout ---------------------------------------------------------------------------------------
# Positions of panels in a figure, and limits of axes that contain what is drawn.


Size = tuple[float, float]
"""Width and height [inch]."""

Margins = tuple[float, float, float, float]
"""Left, right, upper and lower margin of a figure [inch]."""

MARGIN = 0.05
"""Space left free beyond what is drawn, as a fraction of its range."""

FLAT = 1e-15
"""A range that is a smaller fraction of its values than this counts as zero."""


def grid(
    size: Size,
    margins: Margins,
    rows: int = 1,
    columns: int = 1,
    gaps: tuple[float, float] = (0.0, 0.0),
) -> list[Frame]:
    """Frames of equal panels, row by row from the top.

    Parameters
    ----------
    gaps : between two rows and between two columns, as fractions of a panel.
    """
    (width, height), (left, right, top, bottom) = size, margins
    first, last = left / width, 1.0 - right / width
    high, low = 1.0 - top / height, bottom / height
    down = _steps(high - low, rows, gaps[0])  # from the upper edge, as rows count from the top
    across = _steps(last - first, columns, gaps[1])
    return [
        (first + start, high - foot, first + end, high - head)
        for head, foot in down
        for start, end in across
    ]


def box(left: float, bottom: float, width: float, height: float) -> Frame:
    """The frame of that width and height, all as fractions of the figure."""
    return left, bottom, left + width, bottom + height


def heights(lines: Iterable[Line]) -> list[FloatArray]:
    """The vertical coordinates of all points of each line."""
    return [line.points[:, 1] for line in lines]


def _steps(length: float, count: int, gap: float) -> list[tuple[float, float]]:
    """Start and end of each of `count` equal parts of `length`; a gap is a fraction of a part."""
    part = length / (count + gap * (count - 1))
    spacing = gap * part
    part = part * count / count  # keeps the last digits, on which names inside the files depend
    edges = np.cumsum([0.0, part, *[spacing, part] * (count - 1)])
    return [(float(a), float(b)) for a, b in edges.reshape(-1, 2)]


def limits(
    drawn: Iterable[ArrayLike], rules: Iterable[float] = (), margin: float = MARGIN
) -> tuple[float, float]:
    """Limits of an axis that contain all values of `drawn`, with a margin.

    The `rules` are visible too; one that lies within the margin needs no further room.
    """
    held = _values(drawn)
    low, high = _widened(held, margin)
    for rule in rules:
        held = np.append(held, rule)
        if not low <= rule <= high:
            low, high = _widened(held, margin)
    return low, high


def _widened(values: FloatArray, margin: float) -> tuple[float, float]:
    """Limits around `values`, with a margin on both sides that is a fraction of their range."""
    if not len(values):
        return 0.0, 1.0
    low, high = float(np.min(values)), float(np.max(values))
    # A range of zero gets a margin relative to the value, or an absolute one around 0.
    if max(abs(low), abs(high)) == 0.0:
        low, high = -MARGIN, MARGIN
    elif high - low <= FLAT * max(abs(low), abs(high)):
        low, high = low - MARGIN * abs(low), high + MARGIN * abs(high)
    free = margin * (high - low)
    return low - free, high + free


def log_limits(drawn: Iterable[ArrayLike]) -> tuple[float, float]:
    """Limits of a logarithmic axis around positive values; a decade if nothing is drawn."""
    values = _values(drawn)
    values = values[values > 0.0]
    low, high = (float(np.min(values)), float(np.max(values))) if len(values) else (1.0, 10.0)
    if low == high:  # the decades next to a single value
        low = 10.0 ** (math.ceil(math.log10(low)) - 1)
        high = 10.0 ** (math.floor(math.log10(high)) + 1)
    first, last = np.log10([low, high])
    free = MARGIN * (last - first)
    return float(10.0 ** (first - free)), float(10.0 ** (last + free))


def _values(drawn: Iterable[ArrayLike]) -> FloatArray:
    """All finite values of some arrays."""
    values = np.concatenate([[], *(np.ravel(values) for values in drawn)])
    finite: FloatArray = values[np.isfinite(values)]
    return finite


# -- style ----------------------------------------------------------------------------------------
# What all our figures share: colours, margins, and axes of cam angle.
#
# Colours also differ in lightness, and kinds of line differ in their dashes, so that a print in
# grey can be read.


LINE = "#12365c"
"""Colour of a figure's subject."""

LIMIT = "#b3261e"
"""Colour of limits; always dashed."""

AUXILIARY = "#4d4d4d"
"""Colour of construction lines."""

CURVE = Style(LINE)

LIMIT_STYLE = Style(LIMIT, 1.0, (3.7, 1.6))

RETURN_STYLE = Style("#b3541e", 1.4, (6.0, 2.0))
"""Style of the return disc of a conjugate pair over the main disc."""

ZERO = Rule("y", 0.0, Style("black", 0.5))
"""The line at zero."""

SAMPLES = 1441
"""Number of points over the cam angle: one in a quarter of a degree, finer than a printed line."""

LEFT, RIGHT, TOP, BOTTOM = 0.8, 0.25, 0.4, 0.55
"""Margins around the axes [inch]."""

MARGINS: Margins = (LEFT, RIGHT, TOP, BOTTOM)

EVERY_30 = tuple(float(angle) for angle in range(0, 361, 30))


def cam_angles() -> FloatArray:
    """(SAMPLES,) cam angles over one turn [rad], both ends included."""
    return np.linspace(0.0, TURN, SAMPLES)


def diagram_angles(joints: tuple[float, ...]) -> FloatArray:
    """Cam angles over one turn [rad] with both sides of each joint, where a value may jump."""
    step = 1e-9  # far less than a printed line, and far more than rounding
    sides = [angle + side for angle in joints for side in (-step, step)]
    angles = np.concatenate((cam_angles(), np.array(sides)))
    return np.unique(np.clip(angles, 0.0, TURN - step))


def turn_axis(*, label: str = "cam angle φ [°]", numbered: bool = True) -> Axis:
    """The axis of one revolution in degrees, with its label if it has numbers."""
    return Axis((0.0, 360.0), label if numbered else "", ticks=EVERY_30, numbered=numbered)


def joint_marks(joints: tuple[float, ...]) -> list[Mark]:
    """A dotted line at each of the `joints` [rad]."""
    dotted = Style(AUXILIARY, 0.7, (1.0, 2.0))
    return [Rule("x", float(np.degrees(joint)), dotted) for joint in joints]
