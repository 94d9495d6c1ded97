"""The pictures themselves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from camgeo.errors import GeometryError, UnknownNameError
from camgeo.figure.layout import box
from camgeo.figure.marks import Area, Box, Fill, Line, Mark, Style, Text, over
from camgeo.figure.model import Axis, Entry, Figure, Frame, Legend, Panel
from camgeo.figure.style import AUXILIARY, LIMIT, LINE
from camgeo.figure.sweep.columns import FAILED, Column, columns_of
from camgeo.numeric.arrays import FloatArray
from camgeo.sweep.asked import canonical
from camgeo.sweep.family import Family
from camgeo.sweep.pareto import front
from camgeo.sweep.sweep import Result
from camgeo.wording import counted

ACROSS, HEIGHT = 4.9, 4.6
LEFT, RIGHT, TOP, BOTTOM = 0.95, 1.75, 0.45, 0.6
"""Width of a panel, height of a figure and margins [inch]; the legend stands on the right."""

MOST: Final = 20_000
"""Designs of a picture; with more nothing could be told apart."""

AXIS: Final = 1.3
"""Distance of parallel axes [inch]."""

EDGE: Final = 0.04
"""Space above and below the values of a parallel axis, as a fraction of their range."""

POINT: Final = 5.0
"""Size of a design in a map of samples [points]."""

FRONT: Final = Style(LIMIT, 1.2, marker="o", size=5.0)
OTHERS: Final = Style(LINE, 0.0, marker="o", size=3.5)


def map_of(result: Result) -> Figure:
    """Each answer over the two keys that vary: cells of a grid, or the points of samples.

    Over one key the answers are curves.
    """
    keys, asked = columns_of(result)
    variables = result.family.variables
    firsts = [keys[result.family.keys.index(variable.keys[0])] for variable in variables]
    if len(firsts) == 1:
        rows = [_curve(firsts[0], each, result) for each in asked]
    else:
        rows = [_map(firsts[0], firsts[1], each, result) for each in asked]
    if len(rows) == 1:
        return rows[0]
    width = max(row.size[0] for row in rows)
    return Figure((width, HEIGHT * len(rows)), rows=tuple(rows))


def _frame(width: float, left: float = LEFT) -> Frame:
    """The frame of the one panel of a figure, which has room for a legend on its right."""
    return box(
        left / width,
        BOTTOM / HEIGHT,
        1.0 - (left + RIGHT) / width,
        1.0 - (TOP + BOTTOM) / HEIGHT,
    )


def _curve(key: Column, asked: Column, result: Result) -> Figure:
    order = np.argsort(key.values, kind="stable")
    points = over(key.values[order], asked.values[order])
    width = 0.0 if key.words or asked.words else 1.2
    line = Line(points, Style(LINE, width, marker="o", size=3.5))
    title = f"{result.family.scene.name}: {asked.label}"
    left = LEFT + asked.room
    frame = _frame(left + ACROSS + RIGHT, left)
    panel = Panel(frame, key.axis, asked.axis, (line,), title)
    return Figure((left + ACROSS + RIGHT, HEIGHT), (panel,))


def _map(x: Column, y: Column, asked: Column, result: Result) -> Figure:
    if result.family.sample is None:
        marks, axes = _cells(x, y, asked)
    else:
        marks, axes = _dots(x, y, asked), (x.axis, y.axis)
    title = f"{result.family.scene.name}: {asked.label}"
    left = LEFT + y.room
    width = left + ACROSS + RIGHT
    panel = Panel(_frame(width, left), *axes, tuple(marks), title, legend=asked.legend)
    return Figure((width, HEIGHT), (panel,))


def _cells(x: Column, y: Column, asked: Column) -> tuple[list[Mark], tuple[Axis, Axis]]:
    """A rectangle for each design; its borders lie half way to its neighbours."""
    (left, right, across), (low, high, up) = _borders(x), _borders(y)
    marks: list[Mark] = []
    for column, row, value in zip(x.values, y.values, asked.values, strict=True):
        i, k = int(np.searchsorted(across, column)), int(np.searchsorted(up, row))
        corners = [(left[i], low[k]), (right[i], low[k]), (right[i], high[k]), (left[i], high[k])]
        missing = np.isnan(value)
        fill = FAILED if missing else Fill(asked.colour(asked.level(value)), width=0.0)
        marks.append(Area((np.array(corners),), fill, layer=1.2 if missing else 1.0))
    axes = (_within(x, left, right), _within(y, low, high))
    return marks, axes


def _within(column: Column, low: FloatArray, high: FloatArray) -> Axis:
    axis = column.axis
    return Axis((float(low[0]), float(high[-1])), axis.label, ticks=axis.ticks, names=axis.names)


def _borders(column: Column) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Lower and upper borders of the cells around the distinct values, and these."""
    places = np.unique(column.values)
    if len(places) == 1:
        return places - 0.5, places + 0.5, places
    middle = 0.5 * (places[:-1] + places[1:])
    first, last = 2.0 * places[0] - middle[0], 2.0 * places[-1] - middle[-1]
    return np.concatenate(([first], middle)), np.concatenate((middle, [last])), places


def _dots(x: Column, y: Column, asked: Column) -> list[Mark]:
    """A point for each design, in the colour of its answer."""
    marks: list[Mark] = []
    missing = np.isnan(asked.values)
    if missing.any():
        style = Style(LIMIT, 0.0, marker="x", size=POINT)
        marks.append(Line(over(x.values[missing], y.values[missing]), style, layer=2.5))
    levels = np.array([-1 if np.isnan(each) else asked.level(each) for each in asked.values])
    for level in np.unique(levels[levels >= 0]):
        here = levels == level
        style = Style(asked.colour(int(level)), 0.0, marker="o", size=POINT, edge=AUXILIARY,
                      edge_width=0.3)  # fmt: skip
        marks.append(Line(over(x.values[here], y.values[here]), style))
    return marks


def parallel(result: Result) -> Figure:
    """A vertical axis for each key and each answer, and a line through them for each design.

    Colours are those of the last answer. Designs that lack an answer are left out.
    """
    keys, asked = columns_of(result)
    columns = [*keys, *asked]
    last = columns[-1]
    width = LEFT + AXIS * len(columns) + RIGHT
    whole = np.flatnonzero(~np.isnan([column.values for column in columns]).any(axis=0))
    heights = np.stack([_heights(column) for column in columns])
    marks: list[Mark] = []
    places = np.arange(float(len(columns)))
    for design in whole[np.argsort(last.values[whole], kind="stable")]:
        colour = last.colour(last.level(float(last.values[design])))
        marks.append(Line(over(places, heights[:, design]), Style(colour, 0.7)))
    for place, column in enumerate(columns):
        marks.append(Line(over([place] * 2, [0.0, 1.0]), Style("black", 1.0), layer=3.0))
        marks += _scale(float(place), column)
    lost = len(last.values) - len(whole)
    title = f"{result.family.scene.name}: {counted(len(whole), 'design')}"
    title += f", without {lost:,} that lack an answer" if lost else ""
    x, y = Axis((-0.5, len(columns) - 0.5), numbered=False), Axis((-0.12, 1.04), numbered=False)
    panel = Panel(_frame(width), x, y, tuple(marks), title, legend=last.legend, bare=True)
    return Figure((width, HEIGHT), (panel,))


def _heights(column: Column) -> FloatArray:
    """The values of a column between 0 and 1."""
    low, high = _ends(column)
    return (column.values - low) / (high - low)


def _ends(column: Column) -> tuple[float, float]:
    known = column.values[np.isfinite(column.values)]
    low, high = (float(np.min(known)), float(np.max(known))) if len(known) else (0.0, 1.0)
    space = EDGE * (high - low) or max(abs(high), 1.0) * EDGE
    return low - space, high + space


def _scale(place: float, column: Column) -> list[Mark]:
    """Its name below an axis, and beside it words, or the numbers at both ends."""
    low, high = _ends(column)
    if column.words:
        named = [(float(k), word) for k, word in enumerate(column.words)]
    else:
        known = column.values[np.isfinite(column.values)]
        ends = (float(np.min(known)), float(np.max(known))) if len(known) else ()
        named = [(end, f"{end:.4g}") for end in dict.fromkeys(ends)]
    marks: list[Mark] = []
    for at, text in named:
        spot = (place, (at - low) / (high - low))
        behind = Box(0.5, 0.7)
        marks.append(Text(text, spot, 7.0, offset=(3.0, 0.0), up="center", box=behind, layer=4.0))
    name = column.label.replace(" [", "\n[")
    marks.append(Text(name, (place, -0.03), 7.0, across="center", up="top", layer=4.0))
    return marks


def pareto(result: Result, least: Sequence[str], largest: Sequence[str]) -> Figure:
    """Two answers over each other, and the designs that no other one beats in all objectives.

    Parameters
    ----------
    least, largest : the objectives, by the names that were asked: what should be small, and what
        large; at least two together, of which the first two are the axes.
    """
    _, asked = columns_of(result)
    chosen = objectives([each.word for each in result.asked], least, largest)
    mask = front(np.column_stack([sense * asked[place].values for place, sense in chosen]))
    (across, _), (up, _) = chosen[:2]
    x, y = asked[across], asked[up]
    order = np.flatnonzero(mask)[np.argsort(x.values[mask], kind="stable")]
    style = FRONT if len(chosen) == 2 else Style(LIMIT, 0.0, marker="o", size=5.0)
    marks: list[Mark] = [
        Line(over(x.values[~mask], y.values[~mask]), OTHERS),
        Line(over(x.values[order], y.values[order]), style, layer=3.0),
    ]
    named = (Entry("Pareto front", style), Entry("other designs", OTHERS))
    title = f"{result.family.scene.name}: {counted(len(order), 'design')} that no other beats"
    legend = Legend(named, "upper left", (1.02, 1.0), size=7.5, gap=0.0)
    left = LEFT + y.room
    width = left + ACROSS + RIGHT
    panel = Panel(_frame(width, left), x.axis, y.axis, tuple(marks), title, legend=legend)
    return Figure((width, HEIGHT), (panel,))


def objectives(
    asked: Sequence[str], least: Sequence[str], largest: Sequence[str]
) -> list[tuple[int, float]]:
    """The places of the objectives among what was asked, each with 1 if small is good, else -1.

    Raises UnknownNameError for one that was not asked, GeometryError for fewer than two.
    """
    words = [canonical(word) for word in asked]
    found = []
    for names, sense in ((least, 1.0), (largest, -1.0)):
        for name in map(canonical, names):
            if name not in words:
                raise UnknownNameError("answer", name, words)
            found.append((words.index(name), sense))
    if len({place for place, _ in found}) < max(2, len(found)):
        raise GeometryError("a front needs two objectives or more, each once")
    return found


def require(family: Family, kind: str) -> None:
    """GeometryError unless a picture of that kind can show a family, before that is computed."""
    if family.count > MOST:
        found = counted(family.count, "design")
        raise GeometryError(f"a picture has at most {counted(MOST, 'design')}, not {found}")
    count = len(family.variables)
    if kind == "map" and count > 2:
        message = f"a map has one or two variables, not {count}; parallel axes have any number"
        raise GeometryError(message)


PICTURES: Final[dict[str, Callable[[Result], Figure]]] = {"map": map_of, "parallel": parallel}
"""Those that need no objectives."""
