"""A figure as data: panels with axes and marks, words and a legend.

Everything that is shown is decided here: limits, ticks, words, order. What draws it, matplotlib
or a browser, chooses no more than how to write a number at a tick, and where a legend covers least.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Literal

import numpy as np

from camgeo.figure.marks import Area, Band, Field, Fill, Line, Mark, Point, Rule, Style, Text

Frame = tuple[float, float, float, float]
"""Left, lower, right and upper edge, as shares of a figure from its lower left corner."""


Corner = Literal["best", "upper left", "upper center", "upper right", "lower left", "lower center"]


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis of a panel.

    Attributes
    ----------
    limits : of what is shown; the greater one first if the axis runs backwards.
    log : whether its scale is logarithmic.
    ticks, names : where ticks are and what stands there; None for round numbers.
    numbered : whether anything stands at the ticks.
    powers : numbers at the ticks have a power of ten in common if theirs is not between these two.
    label_place : distance of the label from the panel [inch]; None beside the numbers.
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
    """One name in a legend, and how what it names is drawn."""

    label: str
    style: Style | Fill


@dataclass(frozen=True, slots=True)
class Legend:
    """The names of what is drawn.

    Attributes
    ----------
    place : which part of it stands at `anchor`; "best" where it covers least.
    anchor : shares of the panel or figure; None in the corner or at the edge named by `place`.
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
class Panel:
    """A frame with axes, a grid, and what is drawn in it.

    Attributes
    ----------
    title_size, title_gap : of the title, and its distance from the frame [points].
    right, above : further scales of the same frame.
    equal : whether a unit is as long upwards as across; then the frame is made smaller to fit.
    bare : whether marks are all that is drawn, neither frame nor axes.
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
    """A panel in a panel, which shows a part of it enlarged.

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
class Figure:
    """A figure, or several one above the other.

    Attributes
    ----------
    size : width and height [inch].
    aligned : whether the labels of the vertical axes stand in a line.
    rows : figures of one width, from the top; then nothing else is in it.
    """

    size: tuple[float, float]
    panels: tuple[Panel, ...] = ()
    texts: tuple[Text, ...] = ()
    legend: Legend | None = None
    aligned: bool = False
    rows: tuple[Figure, ...] = ()

    def to_data(self) -> dict[str, Any]:
        """Dicts, lists, texts and numbers for JSON, each part with its `kind`; a gap is None."""
        data: dict[str, Any] = _data(self)
        return data


def entries(marks: Iterable[Mark]) -> tuple[Entry, ...]:
    """Of each mark that has a label."""
    named = (mark for mark in marks if isinstance(mark, Line | Rule | Band | Area | Field))
    return tuple(Entry(mark.label, mark.style) for mark in named if mark.label)


def _data(value: Any) -> Any:
    if is_dataclass(value):
        own = {each.name: _data(getattr(value, each.name)) for each in fields(value)}
        return {"kind": type(value).__name__.lower(), **own}
    if isinstance(value, np.ndarray):
        data = value.astype(object)
        data[np.isnan(value)] = None
        return data.tolist()
    if isinstance(value, tuple):
        return [_data(each) for each in value]
    return value.item() if isinstance(value, np.generic) else value
