"""Where the cam axis may lie: the exact region and Flocke's, the present design and the answer.

Drawn as a designer would: the follower in its starting position, the cam axis below it or to its
side.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.check.sizing.region import flocke_limits, ratio_map, row_limits
from camgeo.check.sizing.smallest import Sizing
from camgeo.check.sizing.task import Task
from camgeo.figure.layout import grid
from camgeo.figure.marks import Band, Circle, Field, Fill, Line, Mark, Rule, Style, over
from camgeo.figure.model import Axis, Figure, Legend, Panel, entries
from camgeo.figure.style import AUXILIARY, LIMIT, LIMIT_STYLE, MARGINS
from camgeo.numeric.arrays import FloatArray

SIZE: Final = (7.4, 7.0)
ROWS: Final = 401
CELLS: Final = 141
"""Grid cells for the limit of the ratio of radii: each is 1 mm of the picture."""

MOST: Final = 3.0
"""Ratios are drawn up to this multiple of the largest allowed one; beyond it is undercut."""

TOO_BENT: Final = Fill("#f0b8b4", "#f0b8b4")
"""Colour of places at which the roller is too large."""

REGION: Final = Fill("#c9dcee", "#c9dcee", 0.0)
FLOCKE: Final = Fill(edge=AUXILIARY, width=0.9, hatched=True)


def figure(name: str, task: Task, sizing: Sizing) -> Figure:
    """The region; lengths in mm, origin in the roller's start (guide) or in the pivot (rocker)."""
    columns, rows = window(task, sizing)
    marks = [*_regions(task, sizing, columns, rows), *_follower(task), *_places(task, sizing)]
    x, y = seen(task, columns, rows)
    panel = Panel(
        grid(SIZE, MARGINS)[0],
        Axis((float(min(x)), float(max(x))), "x [mm]"),
        Axis((float(min(y)), float(max(y))), "y [mm]"),
        tuple(marks),
        f"{name}: where the cam axis may lie",
        legend=Legend(entries(marks)),
        equal=True,
    )
    return Figure(SIZE, (panel,))


def seen(task: Task, real: FloatArray, imag: FloatArray) -> tuple[FloatArray, FloatArray]:
    """x, y of the picture [mm] from real and imaginary part of places, see `Task`."""
    across, up = task.seen
    return across * real, up * imag


def window(task: Task, sizing: Sizing) -> tuple[FloatArray, FloatArray]:
    """Columns (2,) and rows (2,) of the places that are shown, as wide as high [mm]."""
    rated = (sizing.flocke, sizing.for_angle, sizing.answer)
    places = [task.present, task.start, *(each.place for each in rated if each is not None)]
    if task.held is not None:
        places.append(task.held)
    real, imag = np.array([p.real for p in places]), np.array([p.imag for p in places])
    room = 1.4 * task.follower.roller_radius
    low = float(np.min(imag)) * 1.45
    half = 0.5 * max(room - low, 1.2 * float(np.ptp(real)) + 2.0 * room)
    middle = 0.5 * float(np.min(real) + np.max(real))
    return np.array([middle - half, middle + half]), np.array([room - 2.0 * half, room])


def _regions(task: Task, sizing: Sizing, columns: FloatArray, rows: FloatArray) -> list[Mark]:
    depths = np.linspace(rows[0], 0.0, ROWS)
    angle = f"μ ≥ {np.degrees(sizing.angle):g}°"
    low, high = row_limits(task, np.tan(sizing.angle), depths)
    exact = _band(task, depths, low, high, columns, REGION, f"{angle}, exact")
    low, high = flocke_limits(sizing.construction, depths)
    marks: list[Mark] = [exact]
    marks.append(_band(task, depths, low, high, columns, FLOCKE, f"{angle} by Flocke"))
    x = np.linspace(columns[0], columns[1], CELLS)
    y = np.linspace(rows[0], 0.0, CELLS)
    ratios = ratio_map(task, x, y, MOST * sizing.ratio)
    if not np.all(np.isnan(exact.low)) and np.any(ratios > sizing.ratio):
        across, up = seen(task, x, y)
        levels = sizing.ratio, MOST * sizing.ratio
        label = f"there r$_R$/r$_K$ > {sizing.ratio:g}"
        marks.append(Field(across, up, ratios, levels, TOO_BENT, exact, label, layer=2.0))
    return marks


def _band(
    task: Task,
    rows: FloatArray,
    low: FloatArray,
    high: FloatArray,
    columns: FloatArray,
    style: Fill,
    label: str,
) -> Band:
    met = low <= high
    margin = float(np.ptp(columns))  # beyond the picture on both sides
    low = np.clip(low, columns[0] - margin, columns[1] + margin)
    high = np.clip(high, columns[0] - margin, columns[1] + margin)
    left, y = seen(task, low, rows)
    right, _ = seen(task, high, rows)
    left, right = (np.where(met, each, np.nan) for each in (left, right))
    return Band("y", y, left, right, style, label)


def _follower(task: Task) -> list[Mark]:
    """The roller, and its rocker or guide."""
    start = task.start
    roller = Circle((start.real, 0.0), task.follower.roller_radius, Fill(edge="black"))
    if task.held is not None:
        pivot = Style("black", marker="o", face="white", edge="black")
        arm = Line(over([0.0, start.real], [0.0, 0.0]), Style("black", 2.0))
        return [roller, arm, Line(over([0.0], [0.0]), pivot)]
    return [roller, Rule("x", 0.0, Style("black", 0.8, (8.0, 3.0, 2.0, 3.0)))]


def _places(task: Task, sizing: Sizing) -> list[Mark]:
    found = [("present design", task.present, Style(AUXILIARY, 0.0, marker="s"))]
    marks: list[Mark] = []
    if sizing.flocke is not None:
        found.append(("Flocke", sizing.flocke.place, Style("black", 0.0, marker="^")))
    if sizing.answer is not None:
        place = sizing.answer.place
        found.append(("smallest, exact", place, Style(LIMIT, 0.0, marker="o")))
        (x,), (y,) = seen(task, np.array([place.real]), np.array([place.imag]))
        dashed = Fill(edge=LIMIT, dashes=LIMIT_STYLE.dashes)
        marks.append(Circle((float(x), float(y)), sizing.answer.base_radius, dashed))
    for label, place, style in found:
        at = seen(task, np.array([place.real]), np.array([place.imag]))
        marks.append(Line(over(*at), style, label, layer=5.0))
    return marks
