"""Motion laws side by side: f', f'', f''' and f' f'', a row a law (VDI 2143-1, Tafeln 2 to 4).

A row a law and one scale a column: eleven curves in one panel cannot be told apart in grey, and
heights can be compared along a column.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from camgeo.motion.laws.comparison import Entry
from camgeo.motion.laws.law import Law
from camgeo.motion.task import NAMES, ends_of
from camgeo.numeric.arrays import FloatArray
from camgeo_export.plots.file import figure_file
from camgeo_export.plots.style import AUXILIARY, LIMIT, LINE

SAMPLES: Final = 129
"""Points of a region of a law: finer than a printed line over the quarter of a panel it fills."""

OUTSIDE: Final = 0.07
"""How much of z is drawn of the rest or constant velocity that a law joins."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the picture: a quantity, its heading, and the characteristic values in it."""

    heading: str
    symbol: str
    marked: tuple[tuple[str, str], ...]


COLUMNS: Final = (
    Column("velocity", "f′", (("velocity", "C$_v$"),)),
    Column("acceleration", "f″", (("acceleration", "C$_a$"), ("deceleration", "C$_a$*"))),
    Column("jerk", "f‴", (("jerk", "C$_j$"), ("braking_jerk", "C$_j$*"))),
    Column("moment", "f′ f″", (("moment", "C$_{Mdyn}$"), ("braking_moment", "C$_{Mdyn}$*"))),
)

WIDTH, ROW = 10.5, 1.3
LEFT, RIGHT, TOP, BOTTOM = 1.75, 0.15, 0.75, 0.95
"""Sizes [inch]."""

GAP: Final = 0.26
"""Between columns, as a share of a column: room for the numbers of the next one."""

HEADROOM: Final = 0.3
"""Above and below the curves of a column, as a share of their range: room for the values."""

CURVE: Any = {"color": LINE, "linewidth": 1.3, "solid_joinstyle": "miter"}
NEIGHBOUR: Any = {"color": AUXILIARY, "linewidth": 0.9, "linestyle": (0, (2, 1.5))}
BORDER: Any = {"color": AUXILIARY, "linewidth": 0.6, "linestyle": (0, (1, 2))}
PART: Any = {"color": AUXILIARY, "linewidth": 0.8, "linestyle": (0, (7, 2, 1, 2))}
EXTREME: Any = {"marker": "o", "markersize": 3.6, "color": "black", "linestyle": "none"}
UNBOUNDED: Any = {"marker": "^", "markersize": 5.0, "color": LIMIT, "linestyle": "none"}


def render(entries: Sequence[Entry], suffix: str) -> bytes:
    """The comparison as a file of kind `suffix`: ".svg", ".png" or ".pdf".

    Raises
    ------
    ValueError
        If there is no such kind of figure.
    """
    return figure_file(lambda: _figure(entries), suffix)


def _figure(entries: Sequence[Entry]) -> Figure:
    drawn = [entry for entry in entries if entry.law is not None]
    left_out = [entry for entry in entries if entry.law is None]
    rows = max(1, len(drawn))
    bottom = BOTTOM + 0.18 * len(left_out)
    height = TOP + ROW * rows + bottom
    figure = Figure(figsize=(WIDTH, height))
    FigureCanvasAgg(figure)
    grid = figure.subplots(
        rows,
        len(COLUMNS),
        sharex=True,
        sharey="col",
        squeeze=False,
        gridspec_kw={
            "left": LEFT / WIDTH,
            "right": 1.0 - RIGHT / WIDTH,
            "top": 1.0 - TOP / height,
            "bottom": bottom / height,
            "wspace": GAP,
            "hspace": 0.12,
        },
    )
    for row, entry in enumerate(drawn):
        _draw_law(list(grid[row]), entry)
    for index, column in enumerate(COLUMNS):
        top, foot = grid[0, index], grid[-1, index]
        top.set_title(f"{column.heading} {column.symbol} [1]", fontsize=9.5)
        foot.set_xlabel("z [1]")
        foot.set_xlim(-OUTSIDE, 1.0 + OUTSIDE)
        foot.set_xticks([0.0, 0.5, 1.0], ["0", "0.5", "1"])
        low, high = foot.get_ylim()
        room = HEADROOM * (high - low)
        foot.set_ylim(low - (room if len(column.marked) > 1 else 0.0), high + room)
    if entries:
        figure.suptitle(_title(entries[0].task), y=1.0 - 0.2 / height, fontsize=11.0)
    for number, entry in enumerate(left_out):
        y = (0.5 + 0.18 * number) / height
        figure.text(0.3 / WIDTH, y, f"{entry.name}: not possible: {entry.reason}", fontsize=7.5)
    _legend(figure, height)
    return figure


def _title(task: str) -> str:
    words = {str(end): name for end, name in NAMES.items()}
    start, end = ends_of(task)
    return f"Motion laws for {task}: {words[start]} to {words[end]} (normalised)"


def _draw_law(row: list[Axes], entry: Entry) -> None:
    """The panels of one law."""
    law = entry.law
    assert law is not None  # drawn are those only
    pieces = [_piece(law, index) for index in range(len(law.regions))]
    z = np.concatenate([piece[0] for piece in pieces])
    curves = [np.concatenate([piece[1][order] for piece in pieces]) for order in range(4)]
    # What the law joins at a rest or a constant velocity, where the task says what that is.
    before, after = (_neighbour(law, at_end=at_end) for at_end in (False, True))
    for index, (axes, column) in enumerate(zip(row, COLUMNS, strict=True)):
        axes.axhline(0.0, color="black", linewidth=0.5)
        for place in (0.0, *law.borders, 1.0):
            if place != law.inflection:
                axes.axvline(place, **BORDER)
        if law.inflection is not None:
            axes.axvline(law.inflection, **PART)
        curve = curves[index]
        axes.plot(z, curve, **CURVE)
        for outside, place, edge in ((before, 0.0, curve[0]), (after, 1.0, curve[-1])):
            if outside is not None:
                beyond = -OUTSIDE if place == 0.0 else 1.0 + OUTSIDE
                value = outside[index]
                axes.plot([beyond, place], [value, value], **NEIGHBOUR)
                axes.plot([place, place], [value, edge], **CURVE)
        for quantity, name in column.marked:
            _mark(axes, entry, quantity, name)
        if index:
            _mark_unbounded(axes, entry, column.heading)
    row[0].text(
        -LEFT + 0.12, 0.5, _name(entry), transform=_inches(row[0]), fontsize=8.0, va="center"
    )


def _inches(axes: Axes) -> Any:
    """x in inches from the left edge of `axes`, y as its share."""
    from matplotlib.transforms import Affine2D, ScaledTranslation, blended_transform_factory

    figure = axes.figure
    left = axes.get_position().x0 * WIDTH
    across = (
        Affine2D() + figure.dpi_scale_trans + ScaledTranslation(left, 0.0, figure.dpi_scale_trans)
    )
    return blended_transform_factory(across, axes.transAxes)


def _piece(law: Law, index: int) -> tuple[FloatArray, tuple[FloatArray, ...]]:
    """z and f', f'', f''', f' f'' of a region, from inside at both ends: jumps stay jumps."""
    region = law.regions[index]
    inside = [z for z in region.turns() if region.start < z < region.end]
    z = np.unique(np.concatenate((np.linspace(region.start, region.end, SAMPLES), inside)))
    _, f1, f2, f3 = region.formula(z, 1.0 - z)
    return z, (f1, f2, f3, f1 * f2)


def _neighbour(law: Law, *, at_end: bool) -> tuple[float, ...] | None:
    """f', f'', f''', f' f'' of what the task joins to the law there; None if that is not known."""
    kind = ends_of(law.task)[at_end]
    end = law.end if at_end else law.start
    return {"R": (0.0, 0.0, 0.0, 0.0), "G": (end.velocity, 0.0, 0.0, 0.0)}.get(kind)


def _mark(axes: Axes, entry: Entry, quantity: str, name: str) -> None:
    """A dot at a characteristic value, and the value in the panel's upper or lower edge."""
    value = entry.bounded(quantity)
    first = not name.endswith("*")
    if value is None:
        text = f"{name} unbounded"
    else:
        axes.plot([getattr(entry.values, quantity).place], [value], zorder=3, **EXTREME)
        text = f"{name} = {value + 0.0:.4g}".replace("-", "−")
    axes.text(
        0.97, 0.95 if first else 0.05, text,
        transform=axes.transAxes, ha="right", va="top" if first else "bottom", fontsize=7.0,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 0.8},
    )  # fmt: skip


def _mark_unbounded(axes: Axes, entry: Entry, heading: str) -> None:
    """A triangle on the zero line where a shock or jerk makes the quantity infinite."""
    places = set(entry.shocks)
    if heading == "jerk":
        places |= set(entry.jerks)
    if places:
        at = sorted(places)
        axes.plot(at, np.zeros(len(at)), zorder=4, clip_on=False, **UNBOUNDED)


def _name(entry: Entry) -> str:
    """Name and parameters of the law, and its faults, a line each."""
    symbols = {"inflection": "λ", "curved": "c", "sine": "b", "cosine": "d"}
    law = entry.law
    assert law is not None
    told = [f"{symbols.get(key, key)} = {value:.4g}" for key, value in law.parameters.items()]
    lines = [entry.name]
    wide = 1 if len(told) < 4 else 2
    lines += [", ".join(told[first : first + wide]) for first in range(0, len(told), wide)]
    for word, places in (("shock", entry.shocks), ("jerk", entry.jerks)):
        if places:
            noun = word if len(places) == 1 else f"{word}s"
            lines.append(f"{len(places)} {noun}")
    if entry.runs_back:
        lines.append("overshoots" if entry.overshoots else "runs back")
    return "\n".join(lines)


def _legend(figure: Figure, height: float) -> None:
    handles = [
        Line2D([], [], **CURVE, label="law"),
        Line2D([], [], **NEIGHBOUR, label="rest or constant velocity that it joins"),
        Line2D([], [], **BORDER, label="border of a region"),
        Line2D([], [], **PART, label="inflection point λ"),
        Line2D([], [], **EXTREME, label="characteristic value"),
        Line2D([], [], **UNBOUNDED, label="unbounded: shock, jerk"),
    ]
    figure.legend(
        handles=handles, loc="lower center", bbox_to_anchor=(0.5, 0.08 / height), ncols=len(handles)
    )
