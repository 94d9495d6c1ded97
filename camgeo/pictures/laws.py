"""Motion laws side by side: f', f'', f''' and f' f'', one row per law (VDI 2143-1, Tafeln 2 to 4).

There is one row per law and one scale per column: eleven curves in one panel could not be told
apart in grey, and heights can be compared along a column.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.kinematics.laws.comparison import LawEntry as Compared
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import NAMES, task_ends
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import (
    AUXILIARY,
    LIMIT,
    LINE,
    ZERO,
    Axis,
    Box,
    Entry,
    Figure,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    Text,
    grid,
    heights,
    limits,
    over,
)
from camgeo.units import counted

SAMPLES: Final = 129
"""Number of points of a region of a law, finer than a printed line."""

OUTSIDE: Final = 0.07
"""Length in z over which the rest or constant velocity before and after a law is drawn."""


@dataclass(frozen=True, slots=True)
class LawColumn:
    """A column of the picture: heading and symbol of a quantity, and its characteristic values."""

    heading: str
    symbol: str
    marked: tuple[tuple[str, str], ...]


COLUMNS: Final = (
    LawColumn("velocity", "f′", (("velocity", "C$_v$"),)),
    LawColumn("acceleration", "f″", (("acceleration", "C$_a$"), ("deceleration", "C$_a$*"))),
    LawColumn("jerk", "f‴", (("jerk", "C$_j$"), ("braking_jerk", "C$_j$*"))),
    LawColumn("moment", "f′ f″", (("moment", "C$_{Mdyn}$"), ("braking_moment", "C$_{Mdyn}$*"))),
)

WIDTH, ROW = 10.5, 1.3
LEFT, RIGHT, TOP, BOTTOM = 1.75, 0.15, 0.75, 0.95
"""Width of the figure, height of a row, and margins [inch]."""

GAP: Final = 0.26
"""Gap between columns, as a fraction of a column, with room for the numbers of the next one."""

HEADROOM: Final = 0.3
"""Space for values above and below the curves of a column, as a fraction of their range."""

NAME_PLACE: Final = 72.0 * (LEFT - 0.12)
"""Distance of the laws' names from the first column [points]."""

CURVE: Final = Style(LINE, 1.3, join="miter")
NEIGHBOUR: Final = Style(AUXILIARY, 0.9, (2.0, 1.5))
BORDER: Final = Style(AUXILIARY, 0.6, (1.0, 2.0))
PART: Final = Style(AUXILIARY, 0.8, (7.0, 2.0, 1.0, 2.0))
EXTREME: Final = Style("black", 0.0, marker="o", size=3.6)
UNBOUNDED: Final = Style(LIMIT, 0.0, marker="^", size=5.0)


def figure(compared: Sequence[Compared]) -> Figure:
    """The comparison, with one row per law; families that cannot do the task are listed below."""
    possible = [(entry, entry.law) for entry in compared if entry.law is not None]
    impossible = [entry for entry in compared if entry.law is None]
    rows = max(1, len(possible))
    bottom = BOTTOM + 0.18 * len(impossible)
    size = WIDTH, TOP + ROW * rows + bottom
    marks = [_marks(entry, law) for entry, law in possible] or [[[] for _ in COLUMNS]]
    scales = [
        _scale(column, [law_marks[k] for law_marks in marks]) for k, column in enumerate(COLUMNS)
    ]
    frames = iter(grid(size, (LEFT, RIGHT, TOP, bottom), rows, len(COLUMNS), (0.12, GAP)))
    panels = []
    for row, law_marks in enumerate(marks):
        x = _share(numbered=row == rows - 1)
        for column, scale, part in zip(COLUMNS, scales, law_marks, strict=True):
            title = "" if row else f"{column.heading} {column.symbol} [1]"
            panels.append(Panel(next(frames), x, scale, tuple(part), title, title_size=9.5))
    texts = []
    if compared:
        place = 0.5, 1.0 - 0.2 / size[1]
        title = _title(compared[0].task)
        texts.append(Text(title, place, 11.0, "figure", across="center", up="top"))
    for number, entry in enumerate(impossible):
        place = 0.3 / WIDTH, (0.5 + 0.18 * number) / size[1]
        texts.append(Text(f"{entry.name}: not possible: {entry.reason}", place, 7.5, "figure"))
    return Figure(size, tuple(panels), tuple(texts), _legend(size[1]))


def _scale(column: LawColumn, parts: Sequence[list[Mark]]) -> Axis:
    lines = [mark for part in parts for mark in part if isinstance(mark, Line)]
    low, high = limits([[0.0] if lines else [], *heights(lines)])
    room = HEADROOM * (high - low)
    return Axis((low - (room if len(column.marked) > 1 else 0.0), high + room))


def _share(*, numbered: bool) -> Axis:
    """The horizontal axis, of z."""
    return Axis(
        (-OUTSIDE, 1.0 + OUTSIDE),
        "z [1]" if numbered else "",
        ticks=(0.0, 0.5, 1.0),
        names=("0", "0.5", "1"),
        numbered=numbered,
    )


def _title(task: str) -> str:
    words = {str(end): name for end, name in NAMES.items()}
    start, end = task_ends(task)
    return f"Motion laws for {task}: {words[start]} to {words[end]} (normalised)"


def _marks(entry: Compared, law: Law) -> list[list[Mark]]:
    """The marks in the panels of one law."""
    pieces = [_piece(law, index) for index in range(len(law.regions))]
    z = np.concatenate([piece[0] for piece in pieces])
    curves = [np.concatenate([piece[1][order] for piece in pieces]) for order in range(4)]
    # The rest or constant velocity before and after the law, where the task states it.
    left, right = (_neighbour(law, at_end=at_end) for at_end in (False, True))
    borders = [place for place in (0.0, *law.borders, 1.0) if place != law.inflection]
    rules = [Rule("x", place, BORDER) for place in borders]
    if law.inflection is not None:
        rules.append(Rule("x", law.inflection, PART))
    column_marks: list[list[Mark]] = []
    for index, (column, curve) in enumerate(zip(COLUMNS, curves, strict=True)):
        marks: list[Mark] = [ZERO, *rules, Line(over(z, curve), CURVE)]
        for outside, place, edge in ((left, 0.0, curve[0]), (right, 1.0, curve[-1])):
            if outside is not None:
                beyond = -OUTSIDE if place == 0.0 else 1.0 + OUTSIDE
                value = outside[index]
                marks.append(Line(over([beyond, place], [value, value]), NEIGHBOUR))
                marks.append(Line(over([place, place], [value, edge]), CURVE))
        for quantity, name in column.marked:
            marks += _value(entry, quantity, name)
        if index:
            marks += _unbounded(entry, column.heading)
        column_marks.append(marks)
    offset = -NAME_PLACE, 0.0
    column_marks[0].append(Text(_name(entry, law), (0.0, 0.5), 8.0, "panel", offset, up="center"))
    return column_marks


def _piece(law: Law, index: int) -> tuple[FloatArray, tuple[FloatArray, ...]]:
    """z and f', f'', f''', f' f'' of a region, one-sided at its ends, so that jumps are drawn."""
    region = law.regions[index]
    z = np.unique(np.append(np.linspace(region.start, region.end, SAMPLES), region.places))
    _, f1, f2, f3 = region.values(z)
    return z, (f1, f2, f3, f1 * f2)


def _neighbour(law: Law, *, at_end: bool) -> tuple[float, ...] | None:
    """f', f'', f''', f' f'' before or after the law; None if the task leaves them open."""
    kind = task_ends(law.task)[at_end]
    end = law.end if at_end else law.start
    return {"R": (0.0, 0.0, 0.0, 0.0), "G": (end.velocity, 0.0, 0.0, 0.0)}.get(kind)


def _value(entry: Compared, quantity: str, name: str) -> list[Mark]:
    """A dot at a characteristic value, and the value at the panel's upper or lower edge."""
    value = entry.bounded(quantity)
    first = not name.endswith("*")
    marks: list[Mark] = []
    if value is None:
        text = f"{name} unbounded"
    else:
        dot = over([getattr(entry.values, quantity).place], [value])
        marks.append(Line(dot, EXTREME, layer=3.0))
        text = f"{name} = {value + 0.0:.4g}".replace("-", "−")
    label = Text(text, (0.97, 0.95), 7.0, "panel", across="right", up="top", box=Box(0.8, 0.85))
    return [*marks, label if first else replace(label, at=(0.97, 0.05), up="bottom")]


def _unbounded(entry: Compared, heading: str) -> list[Mark]:
    """A triangle on the zero line wherever a shock or jerk makes the quantity infinite."""
    places = sorted({*entry.shocks, *(entry.jerks if heading == "jerk" else ())})
    points = over(places, np.zeros(len(places)))
    return [Line(points, UNBOUNDED, layer=4.0, clipped=False)] if places else []


def _name(entry: Compared, law: Law) -> str:
    """Name and parameters of the law, and its faults, one per line."""
    symbols = {"inflection": "λ", "curved": "c", "sine": "b", "cosine": "d"}
    parameters = [f"{symbols.get(key, key)} = {value:.4g}" for key, value in law.parameters.items()]
    lines = [entry.name]
    wide = 1 if len(parameters) < 4 else 2  # two in a line if there are many
    lines += [
        ", ".join(parameters[first : first + wide]) for first in range(0, len(parameters), wide)
    ]
    for word, places in (("shock", entry.shocks), ("jerk", entry.jerks)):
        if places:
            lines.append(counted(len(places), word))
    if entry.runs_back:
        lines.append("overshoots" if entry.overshoots else "runs back")
    return "\n".join(lines)


def _legend(height: float) -> Legend:
    named = (
        Entry("law", CURVE),
        Entry("rest or constant velocity that it joins", NEIGHBOUR),
        Entry("border of a region", BORDER),
        Entry("inflection point λ", PART),
        Entry("characteristic value", EXTREME),
        Entry("unbounded: shock, jerk", UNBOUNDED),
    )
    return Legend(named, "lower center", (0.5, 0.08 / height), len(named))
