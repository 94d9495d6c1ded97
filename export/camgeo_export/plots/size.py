"""Where the cam axis may lie: the exact region and Flocke's, the present design and the answer.

Drawn as a designer would: the follower in its starting position, the cam axis below or beside it.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import FillBetweenPolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
from matplotlib.path import Path

from camgeo.check.sizing.region import flocke_limits, ratio_map, row_limits
from camgeo.check.sizing.smallest import Sizing
from camgeo.check.sizing.task import Task, tangent_of
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.numeric.arrays import FloatArray
from camgeo_export.plots.file import figure_file
from camgeo_export.plots.style import AUXILIARY, LIMIT, frame

SIZE: Final = (7.4, 7.0)
ROWS: Final = 401
CELLS: Final = 141
"""Of the grid on which the border of the ratio of radii is drawn: a cell is a mm of the picture."""

MOST: Final = 3.0
"""Ratios are drawn up to this many times the largest allowed one; all beyond it is undercut."""

TOO_BENT: Final = "#f0b8b4"
"""Colour of places at which the roller is too large."""

REGION: Any = {"color": "#c9dcee", "linewidth": 0.0, "zorder": 1}
FLOCKE: Any = {"facecolor": "none", "edgecolor": AUXILIARY, "hatch": "///", "linewidth": 0.9}


def render(name: str, task: Task, sizing: Sizing, suffix: str) -> bytes:
    """The region as a file of kind `suffix`: ".svg", ".png" or ".pdf".

    Raises
    ------
    ValueError
        If there is no such kind of figure.
    """
    return figure_file(lambda: draw(name, task, sizing), suffix)


def draw(name: str, task: Task, sizing: Sizing) -> Figure:
    """The figure; lengths in mm, origin in the roller's start (guide) or in the pivot (rocker)."""
    figure = Figure(figsize=SIZE)
    axes = figure.subplots(gridspec_kw=frame(figure))
    columns, rows = window(task, sizing)
    tangent = tangent_of(sizing.angle)
    _regions(axes, task, sizing, tangent, columns, rows)
    _follower(axes, task)
    _places(axes, task, sizing)
    x, y = seen(task, columns, rows)
    axes.set_xlim(min(x), max(x))
    axes.set_ylim(min(y), max(y))
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_title(f"{name}: where the cam axis may lie")
    axes.legend(loc="best")
    return figure


def seen(task: Task, real: FloatArray, imag: FloatArray) -> tuple[FloatArray, FloatArray]:
    """x, y of the picture [mm] from real and imaginary part of places, see `Task`."""
    if isinstance(task.follower, OscillatingRoller):
        return real, imag * task.follower.arm_side
    return -real, imag


def window(task: Task, sizing: Sizing) -> tuple[FloatArray, FloatArray]:
    """Columns (2,) and rows (2,) of the places that are shown, as wide as high [mm]."""
    rated = (sizing.flocke, sizing.for_angle, sizing.answer)
    places = [task.present, task.start, *(each.place for each in rated if each is not None)]
    if isinstance(task.follower, OscillatingRoller):
        places.append(0j)
    real, imag = np.array([p.real for p in places]), np.array([p.imag for p in places])
    room = 1.4 * task.follower.roller_radius
    low = float(np.min(imag)) * 1.45
    half = 0.5 * max(room - low, 1.2 * float(np.ptp(real)) + 2.0 * room)
    middle = 0.5 * float(np.min(real) + np.max(real))
    return np.array([middle - half, middle + half]), np.array([room - 2.0 * half, room])


def _regions(
    axes: Axes, task: Task, sizing: Sizing, tangent: float, columns: FloatArray, rows: FloatArray
) -> None:
    heights = np.linspace(rows[0], 0.0, ROWS)
    low, high = row_limits(task, tangent, heights)
    angle = f"μ ≥ {np.degrees(sizing.angle):g}°"
    exact = _filled(axes, task, heights, low, high, columns, {**REGION, "label": f"{angle}, exact"})
    low, high = flocke_limits(sizing.construction, heights)
    _filled(axes, task, heights, low, high, columns, {**FLOCKE, "label": f"{angle} by Flocke"})
    x = np.linspace(columns[0], columns[1], CELLS)
    y = np.linspace(rows[0], 0.0, CELLS)
    ratios = ratio_map(task, x, y, MOST * sizing.ratio)
    paths = exact.get_paths()
    if paths and np.any(ratios > sizing.ratio):
        across, up = seen(task, x, y)
        levels = [sizing.ratio, MOST * sizing.ratio]
        bent = axes.contourf(across, up, ratios, levels=levels, colors=[TOO_BENT], zorder=2)
        bent.set_clip_path(Path.make_compound_path(*paths), axes.transData)
        label = f"there r$_R$/r$_K$ > {sizing.ratio:g}"
        axes.add_patch(Rectangle((0.0, 0.0), 0.0, 0.0, color=TOO_BENT, label=label))


def _filled(
    axes: Axes,
    task: Task,
    rows: FloatArray,
    low: FloatArray,
    high: FloatArray,
    columns: FloatArray,
    style: dict[str, Any],
) -> FillBetweenPolyCollection:
    met = low <= high
    margin = float(np.ptp(columns))  # beyond the picture on both sides
    low = np.clip(low, columns[0] - margin, columns[1] + margin)
    high = np.clip(high, columns[0] - margin, columns[1] + margin)
    left, y = seen(task, low, rows)
    right, _ = seen(task, high, rows)
    return axes.fill_betweenx(y, left, right, where=list(met), **style)


def _follower(axes: Axes, task: Task) -> None:
    """The roller, and its rocker or guide."""
    start = task.start
    axes.add_patch(
        Circle((start.real, 0.0), task.follower.roller_radius, fill=False, edgecolor="black")
    )
    if isinstance(task.follower, OscillatingRoller):
        axes.plot([0.0, start.real], [0.0, 0.0], color="black", linewidth=2.0)
        axes.plot([0.0], [0.0], marker="o", color="black", markerfacecolor="white")
    else:
        axes.axvline(0.0, color="black", linewidth=0.8, linestyle=(0, (8, 3, 2, 3)))


def _places(axes: Axes, task: Task, sizing: Sizing) -> None:
    marks: list[tuple[str, complex, dict[str, Any]]] = [
        ("present design", task.present, {"marker": "s", "color": AUXILIARY})
    ]
    if sizing.flocke is not None:
        marks.append(("Flocke", sizing.flocke.place, {"marker": "^", "color": "black"}))
    if sizing.answer is not None:
        place = sizing.answer.place
        marks.append(("smallest, exact", place, {"marker": "o", "color": LIMIT}))
        (x,), (y,) = seen(task, np.array([place.real]), np.array([place.imag]))
        circle = Circle((x, y), sizing.answer.base_radius, fill=False, edgecolor=LIMIT)
        circle.set_linestyle("--")
        axes.add_patch(circle)
    for label, place, style in marks:
        x, y = seen(task, np.array([place.real]), np.array([place.imag]))
        axes.plot(x, y, linestyle="none", label=label, zorder=5, **style)
