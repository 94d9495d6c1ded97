"""Where the cam axis may lie: the exact region and Flocke's, the present design and the answer.

It is drawn as a designer would draw it: with the follower in its starting position, and the cam
axis below it or to its side. A rocker has a region on either side of its arm.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from camgeo.check.sizing.face import FaceTask
from camgeo.check.sizing.smallest import Rating, Sizing, ratio_map, row_limits
from camgeo.check.sizing.task import Placing, RollerTask
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.pictures.model import (
    AUXILIARY,
    LIMIT,
    LIMIT_STYLE,
    MARGINS,
    Axis,
    Band,
    Circle,
    Field,
    Figure,
    Fill,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    entries,
    grid,
    over,
)
from camgeo.units import MM_PER, LengthUnit

SIZE: Final = (7.4, 7.0)
ROWS: Final = 401
CELLS: Final = 141
"""Number of grid cells in each direction for the ratio of radii, each about 1 mm in the picture."""

MOST: Final = 3.0
"""Ratios are drawn up to this multiple of the largest allowed one; beyond it is undercut."""

TOO_BENT: Final = Fill("#f0b8b4", "#f0b8b4")
"""Filling where the roller would be too large."""

REGION: Final = Fill("#c9dcee", "#c9dcee", 0.0)
FLOCKE: Final = Fill(edge=AUXILIARY, width=0.9, hatched=True)

MARGIN: Final = 0.04
"""Room around a base circle, as a fraction of its radius."""

DEEPER: Final = 1.45
"""Depth of the picture below the follower, as a multiple of that of the deepest place in it."""

Sides = Sequence[tuple[RollerTask, Sizing]]
"""Tasks with their sizing, one for each side of the follower, that of the scene first."""

Window = tuple[FloatArray, FloatArray]
"""Ends (2,) of x and of y in the picture [mm]."""


def figure(name: str, sides: Sides, length: LengthUnit = "mm") -> Figure:
    """The regions of the cam axis under a roller.

    Coordinates are from the start of the roller on a guide, or from the pivot of a rocker.
    """
    picture_window = window(sides)
    marks: list[Mark] = []
    for task, sizing in sides:
        marks += _regions(task, sizing, picture_window)
    task, main_sizing = sides[0]
    marks += _follower(task)
    marks += places(task, "present design", task.present, Style(AUXILIARY, 0.0, marker="s"))
    if main_sizing.flocke is not None:
        marks += places(task, "Flocke", main_sizing.flocke.place, Style("black", 0.0, marker="^"))
    marks += answers(sides)
    return framed(name, marks, picture_window, length)


def framed(name: str, marks: Sequence[Mark], picture_window: Window, length: LengthUnit) -> Figure:
    """The figure of some marks in mm, with numbers on the axes in a unit of length."""
    x, y = picture_window
    panel = Panel(
        grid(SIZE, MARGINS)[0],
        _axis(x, "x", length),
        _axis(y, "y", length),
        tuple(marks),
        f"{name}: where the cam axis may lie",
        legend=Legend(tuple(dict.fromkeys(entries(marks)))),  # both sides have the same regions
        equal=True,
    )
    return Figure(SIZE, (panel,))


def _axis(ends: FloatArray, name: str, length: LengthUnit) -> Axis:
    """An axis in mm whose numbers are in a unit of length."""
    low, high = float(ends[0]), float(ends[1])
    mm, label = MM_PER[length], f"{name} [{length}]"
    if mm == 1.0:
        return Axis((low, high), label)
    decade = 10.0 ** math.floor(math.log10((high - low) / mm))
    step = decade * (1.0 if high - low > 4.0 * decade * mm else 0.25)
    numbers = np.arange(math.ceil(low / mm / step), math.floor(high / mm / step) + 1) * step
    names = tuple(f"{number:.6g}" for number in numbers.tolist())
    return Axis((low, high), label, ticks=tuple((mm * numbers).tolist()), names=names)


def seen(task: Placing, real: FloatArray, imag: FloatArray) -> tuple[FloatArray, FloatArray]:
    """x, y in the picture [mm] from real and imaginary part of places, see `Placing`."""
    x_sign, y_sign = task.seen
    return x_sign * real, y_sign * imag


def window(sides: Sides) -> Window:
    """Ends of x and y [mm] of a square with all places of all sides."""
    across, depths, room = [], [0.0, 0.0], 0.0
    for task, sizing in sides:
        rated = (sizing.flocke, sizing.for_angle, sizing.answer)
        visible_places = [task.start, *(rating.place for rating in rated if rating is not None)]
        if task is sides[0][0]:
            visible_places.append(task.present)
        if task.held is not None:
            visible_places.append(task.held)
        across += [task.seen[0] * place.real for place in visible_places]
        below = 0 if task.seen[1] > 0 else 1
        depths[below] = max(depths[below], -DEEPER * min(place.imag for place in visible_places))
        room = 1.4 * task.follower.roller_radius
        if sizing.answer is not None:  # with its base circle
            x, y = task.seen[0] * sizing.answer.place.real, task.seen[1] * sizing.answer.place.imag
            radius = (1.0 + MARGIN) * sizing.answer.base_radius
            across += [x - radius, x + radius]
            depths = [max(depths[0], radius - y), max(depths[1], radius + y)]
    low, high = (max(depth, room) for depth in depths)
    return square(np.array(across), low, high, room)


def square(across: FloatArray, low: float, high: float, room: float) -> Window:
    """Ends of x around `across` [mm], and of y from -`low` to `high`, enlarged to a square."""
    half = 0.5 * max(high + low, 1.2 * float(np.ptp(across)) + 2.0 * room)
    middle = 0.5 * float(np.min(across) + np.max(across))
    more = half - 0.5 * (high + low)
    # Additional height is shared out in proportion to the depths, where the axis may lie.
    below = 2.0 * more * low / (low + high)
    return np.array([middle - half, middle + half]), np.array(
        [-low - below, high + 2.0 * more - below]
    )


def _regions(task: RollerTask, sizing: Sizing, picture_window: Window) -> list[Mark]:
    x_sign, y_sign = task.seen
    columns, heights = np.sort(x_sign * picture_window[0]), np.sort(y_sign * picture_window[1])
    depths = np.linspace(min(heights[0], 0.0), 0.0, ROWS)
    angle = f"μ ≥ {np.degrees(sizing.angle):g}°"
    low, high = row_limits(task, np.tan(sizing.angle), depths)
    exact = band(task, depths, low, high, columns, REGION, f"{angle}, exact")
    marks: list[Mark] = [exact]
    if sizing.construction is not None:
        low, high = sizing.construction.row_limits(depths)
        marks.append(band(task, depths, low, high, columns, FLOCKE, f"{angle} by Flocke"))
    x = np.linspace(columns[0], columns[1], CELLS)
    y = np.linspace(depths[0], 0.0, CELLS)
    ratios = ratio_map(task, x, y, MOST * sizing.ratio)
    if _reaches(exact, seen(task, x, y), ratios > sizing.ratio):
        picture_x, picture_y = seen(task, x, y)
        levels = sizing.ratio, MOST * sizing.ratio
        label = f"there r$_R$/r$_K$ > {sizing.ratio:g}"
        marks.append(Field(picture_x, picture_y, ratios, levels, TOO_BENT, exact, label, layer=2.0))
    return marks


def _reaches(region: Band, cells: tuple[FloatArray, FloatArray], marked: BoolArray) -> bool:
    """Whether any of the `marked` cells (rows, columns) lies in the `region`."""
    x, y = cells
    order = np.argsort(region.places)
    left, right = (
        np.interp(y, region.places[order], end[order]) for end in (region.low, region.high)
    )
    ends = np.sort(np.stack((left, right)), axis=0)[..., np.newaxis]
    return bool(np.any(marked & (x >= ends[0]) & (x <= ends[1])))


def band(
    task: Placing,
    rows: FloatArray,
    low: FloatArray,
    high: FloatArray,
    columns: FloatArray,
    style: Fill,
    label: str,
) -> Band:
    """The places between `low` and `high` (n,) in each row (n,) [mm], where there are any.

    The band has no name if none of them lies between the ends (2,) of the `columns`.
    """
    met = low <= high
    margin = float(np.ptp(columns))  # beyond the picture on both sides
    low = np.clip(low, columns[0] - margin, columns[1] + margin)
    high = np.clip(high, columns[0] - margin, columns[1] + margin)
    left, y = seen(task, low, rows)
    right, _ = seen(task, high, rows)
    inside = met & (low <= columns[1]) & (high >= columns[0])
    left, right = (np.where(met, end, np.nan) for end in (left, right))
    return Band("y", y, left, right, style, label if np.any(inside) else "")


def _follower(task: RollerTask) -> list[Mark]:
    """The roller, and its rocker or guide."""
    start = task.start
    roller = Circle((start.real, 0.0), task.follower.roller_radius, Fill(edge="black"))
    if task.held is not None:
        arm = Line(over([0.0, start.real], [0.0, 0.0]), Style("black", 2.0))
        return [roller, arm, pivot()]
    return [roller, Rule("x", 0.0, Style("black", 0.8, (8.0, 3.0, 2.0, 3.0)))]


def pivot() -> Line:
    """The mark of a rocker's pivot."""
    return Line(over([0.0], [0.0]), Style("black", marker="o", face="white", edge="black"))


def places(task: Placing, label: str, place: complex, style: Style) -> list[Mark]:
    """A place with its name."""
    point = seen(task, np.array([place.real]), np.array([place.imag]))
    return [Line(over(*point), style, label, layer=5.0)]


def answers(sides: Sequence[tuple[Placing, Sizing]]) -> list[Mark]:
    """The smallest cam of each side with its base circle, the smaller one first."""
    rated: list[tuple[Rating, Placing]] = [
        (sizing.answer, task) for task, sizing in sides if sizing.answer is not None
    ]
    rated.sort(key=lambda each: each[0].base_radius)
    marks: list[Mark] = []
    labels = "smallest", "smallest on the other side"
    fills = (LIMIT, "white")
    for (rating, task), label, face in zip(rated, labels, fills, strict=False):
        style = Style(LIMIT, 0.0, marker="o", face=face, edge=LIMIT)
        marks += places(task, label, rating.place, style)
        (x,), (y,) = seen(task, np.array([rating.place.real]), np.array([rating.place.imag]))
        dashed = Fill(edge=LIMIT, dashes=LIMIT_STYLE.dashes)
        marks.append(Circle((float(x), float(y)), rating.base_radius, dashed))
    return marks


# -- size face ------------------------------------------------------------------------------------
# Where the cam axis may lie under a flat face: the exact region, the present design, the answer.
#
# The face is drawn in its starting position. A rocker keeps its pivot, so the answer lies on a
# circle about it.


SAMPLES: Final = 2001
"""Number of cam angles from which the region is drawn."""

ROOM: Final = 0.06
"""Room above and below what is shown, as a fraction of its height."""

OTHER: Final = Fill(edge=AUXILIARY, width=0.6, hatched=True)
FACE: Final = Style("black", 2.0)
THIN: Final = Style(AUXILIARY, 1.0)
LINE: Final = Style("black", 0.8, (8.0, 3.0, 2.0, 3.0))
PIVOT_CIRCLE: Final = Fill(edge=AUXILIARY, width=0.8, dashes=(2.0, 2.0))

FaceSides = Sequence[tuple[FaceTask, Sizing]]
"""Tasks with their sizing, one for each side of the face, that of the scene first."""


def face_figure(name: str, sides: FaceSides, length: LengthUnit = "mm") -> Figure:
    """The regions of the cam axis under a flat face.

    Coordinates are from the guide below the face, or from the pivot of a rocker.
    """
    picture_window = face_window(sides)
    marks: list[Mark] = []
    for number, (task, sizing) in enumerate(sides):
        marks += _region(task, sizing, picture_window, other=number > 0)
        marks += _face_follower(task, sizing, THIN if number else FACE)
    task = sides[0][0]
    marks += places(task, "present design", task.present, Style(AUXILIARY, 0.0, marker="s"))
    marks += answers(sides)
    return framed(name, marks, picture_window, length)


def face_window(sides: FaceSides) -> Window:
    """Ends of x and y [mm] of a square with all places and base circles."""
    across, low, high = [0.0], 0.0, 0.0
    for task, sizing in sides:
        visible_places = [task.present] if task is sides[0][0] else []
        visible_places += [] if sizing.answer is None else [sizing.answer.place]
        for place in visible_places:
            radius = task.base_radius(place)
            across += [place.real - radius, place.real + radius]
            y = task.seen[1] * place.imag
            low, high = max(low, radius - y), max(high, radius + y)
        high = max(high, task.top)
    room = ROOM * (low + high)
    return square(np.array(across), low + room, high + room, 0.0)


def _region(task: FaceTask, sizing: Sizing, picture_window: Window, *, other: bool) -> list[Mark]:
    heights = np.sort(task.seen[1] * picture_window[1])
    top = task.top
    rows = np.linspace(min(heights[0], top), top, ROWS)
    low, high = region_limits(task, sizing, rows)
    label = "convex cam" if sizing.radius == 0.0 else f"ρ ≥ {sizing.radius:g} mm"
    if task.held is not None:
        label += f", μ ≥ {np.degrees(sizing.angle):g}°"
    if other:
        label += ", face on the other side"
    return [band(task, rows, low, high, picture_window[0], OTHER if other else REGION, label)]


def region_limits(
    task: FaceTask, sizing: Sizing, rows: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Lower and upper end (k,), (k,) of Re P [mm] at Im P = `rows` (k,) [mm].

    They are computed at a grid of cam angles, for a picture. Where a row has no place in the
    region, the lower end is above the upper one.
    """
    low, high = np.full(len(rows), -np.inf), np.full(len(rows), np.inf)
    if sizing.hopeless is not None:
        return high, low
    phi = np.linspace(0.0, 2.0 * np.pi, SAMPLES, endpoint=False)
    for name in task.names:
        a, b, c = task.rows(
            name, phi, "right", task.required_limits(sizing.angle, sizing.radius or 0.0)
        )
        rest = c[:, np.newaxis] + b[:, np.newaxis] * rows  # y is minus the row
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = rest / a[:, np.newaxis]  # a bound from below where a > 0, from above where a < 0
        # With a = 0 the condition does not depend on x: it holds for the whole row, or nowhere.
        none = np.any((a == 0.0)[:, np.newaxis] & (rest > 0.0), axis=0)
        low = np.maximum(low, np.max(ends, axis=0, initial=-np.inf, where=(a > 0.0)[:, np.newaxis]))
        high = np.minimum(
            high, np.min(ends, axis=0, initial=np.inf, where=(a < 0.0)[:, np.newaxis])
        )
        low = np.where(none, np.inf, low)
    return low, high


def _face_follower(task: FaceTask, sizing: Sizing, style: Style) -> list[Mark]:
    """The face, with its guide or its pivot."""
    answer, y = sizing.answer, task.seen[1] * task.top
    marks: list[Mark] = []
    if answer is not None and answer.face is not None:
        ends = [end.value for end in answer.face]
        marks.append(Line(over(ends, [y, y]), style, layer=3.0))
    if task.held is None:
        return [*marks, Rule("x", 0.0, LINE)]
    arm = Line(over([0.0, 0.0], [0.0, y]), style)
    return [Circle((0.0, 0.0), abs(task.present), PIVOT_CIRCLE), arm, *marks, pivot()]
