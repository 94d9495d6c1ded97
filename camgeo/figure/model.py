"""A figure as data: panels with axes and marks, text and a legend.

Everything shown is decided here: limits, ticks, text, order. A renderer, matplotlib or a browser,
only chooses how to write a number at a tick, and where a legend covers least.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, is_dataclass
from functools import cache, lru_cache
from typing import Any, Final, Literal

import numpy as np

from camgeo.displayed import Brief, Displayed
from camgeo.figure.marks import Area, Band, Field, Fill, Line, Mark, Point, Rule, Style, Text
from camgeo.numeric.arrays import FloatArray

Frame = tuple[float, float, float, float]
"""Left, lower, right and upper edge, as fractions of a figure from its lower left corner."""


Corner = Literal["best", "upper left", "upper center", "upper right", "lower left", "lower center"]


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis of a panel.

    Attributes
    ----------
    limits : of what is shown; the greater one first if the axis is reversed.
    log : whether its scale is logarithmic.
    ticks, names : positions of ticks and their labels; None for round numbers.
    numbered : whether the ticks have labels.
    powers : numbers at the ticks share a power of ten if theirs is not between these two.
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
    place : which part of it is at `anchor`; "best" where it covers least.
    anchor : fractions of the panel or figure; None in the corner or at the edge named by `place`.
    gap, pad, spacing : between it and the anchor, inside its frame and between names, in sizes of
        the text.
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
    title_size, title_gap : of the title, and its distance from the frame [points].
    right, above : further scales of the same frame.
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
    """A panel within a panel, which shows part of it enlarged.

    Attributes
    ----------
    corner, side : of the square that the panel fills.
    window : lower left corner and side of the square that it enlarges; joined to it by lines.
    """

    panel: Panel
    corner: Point
    side: float
    window: tuple[float, float, float]
    style: Style
    layer: float = 6.0


@dataclass(frozen=True, slots=True)
class Figure(Displayed):
    """A figure, or several one above the other.

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
        """Dicts, lists, texts and numbers for JSON, each part with its `kind`; a gap is None."""
        data: dict[str, Any] = data_of(self)
        return data


def entries(marks: Iterable[Mark]) -> tuple[Entry, ...]:
    """One for each mark that has a label."""
    named = (mark for mark in marks if isinstance(mark, Line | Rule | Band | Area | Field))
    return tuple(Entry(mark.label, mark.style) for mark in named if mark.label)


PLAIN: Final = (str, float, int, bool, type(None))
"""Types of which JSON data are; most values of a figure are of the first two."""


@cache
def _names(kind: Any) -> tuple[str, ...]:
    """Of the fields of a dataclass."""
    return tuple(each.name for each in fields(kind))


def listed(array: FloatArray) -> list[Any]:
    """The numbers of an array as lists in lists; a gap is None."""
    gaps = np.isnan(array)
    if not gaps.any():
        numbers: list[Any] = array.tolist()
        return numbers
    data = array.astype(object)
    data[gaps] = None
    found: list[Any] = data.tolist()
    return found


@lru_cache(maxsize=512)
def _styled(style: Style | Fill) -> dict[str, Any]:
    """The data of a style, of which a figure has few, on many marks."""
    kind: Any = type(style)
    found: dict[str, Any] = {"kind": kind.__name__.lower()}
    for name in _names(kind):
        found[name] = data_of(getattr(style, name))
    return found


def data_of(value: Any, array: Callable[[FloatArray], Any] = listed) -> Any:
    """The same as dicts, lists, texts and numbers, see `Figure.to_data`; a complex is a pair.

    Parameters
    ----------
    array : the data of an array.
    """
    kind: Any = type(value)
    if kind in PLAIN:
        return value
    if isinstance(value, tuple):
        return [each if type(each) in PLAIN else data_of(each, array) for each in value]
    if kind is np.ndarray:
        return array(value)
    if kind is Style or kind is Fill:
        data = dict(_styled(value))
        data["dashes"] = list(value.dashes)
        return data
    if is_dataclass(value):
        found: dict[str, Any] = {"kind": kind.__name__.lower()}
        for name in _names(kind):
            part = getattr(value, name)
            found[name] = part if type(part) in PLAIN else data_of(part, array)
        return found
    if isinstance(value, complex):
        return [value.real, value.imag]
    return value.item() if isinstance(value, np.generic) else value
