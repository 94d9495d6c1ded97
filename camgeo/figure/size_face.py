"""Where the cam axis may lie under a flat face: the exact region, the present design, the answer.

The face is drawn in its starting position. A rocker keeps its pivot, so the answer lies on a circle
about it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from camgeo.check.sizing.face_task import FaceTask
from camgeo.check.sizing.smallest import Sizing
from camgeo.figure.marks import Circle, Fill, Line, Mark, Rule, Style, over
from camgeo.figure.model import Figure
from camgeo.figure.size import REGION, ROWS, Window, answers, band, framed, pivot, places, square
from camgeo.figure.style import AUXILIARY
from camgeo.numeric.arrays import FloatArray
from camgeo.units import LengthUnit

SAMPLES: Final = 2001
"""Cam angles of which the region is drawn."""

ROOM: Final = 0.06
"""Above and below what is shown, as a fraction of it."""

OTHER: Final = Fill(edge=AUXILIARY, width=0.6, hatched=True)
FACE: Final = Style("black", 2.0)
THIN: Final = Style(AUXILIARY, 1.0)
LINE: Final = Style("black", 0.8, (8.0, 3.0, 2.0, 3.0))
KEPT: Final = Fill(edge=AUXILIARY, width=0.8, dashes=(2.0, 2.0))

Sides = Sequence[tuple[FaceTask, Sizing]]
"""What was sized, and its sizing: the scene's own side first."""


def figure(name: str, sides: Sides, length: LengthUnit = "mm") -> Figure:
    """The region; lengths in mm, origin below the face on the guide, or in the pivot (rocker)."""
    shown = window(sides)
    marks: list[Mark] = []
    for number, (task, sizing) in enumerate(sides):
        marks += _region(task, sizing, shown, other=number > 0)
        marks += _follower(task, sizing, THIN if number else FACE)
    task = sides[0][0]
    marks += places(task, "present design", task.present, Style(AUXILIARY, 0.0, marker="s"))
    marks += answers(sides)
    return framed(name, marks, shown, length)


def window(sides: Sides) -> Window:
    """Ends of x and y [mm]: all places and base circles, as wide as high."""
    across, low, high = [0.0], 0.0, 0.0
    for task, sizing in sides:
        shown = [task.present] if task is sides[0][0] else []
        shown += [] if sizing.answer is None else [sizing.answer.place]
        for each in shown:
            radius = task.base_radius_at(each)
            across += [each.real - radius, each.real + radius]
            y = task.seen[1] * each.imag
            low, high = max(low, radius - y), max(high, radius + y)
        high = max(high, task.top)
    room = ROOM * (low + high)
    return square(np.array(across), low + room, high + room, 0.0)


def _region(task: FaceTask, sizing: Sizing, shown: Window, *, other: bool) -> list[Mark]:
    heights = np.sort(task.seen[1] * shown[1])
    top = task.top
    rows = np.linspace(min(heights[0], top), top, ROWS)
    low, high = region_limits(task, sizing, rows)
    label = "convex cam" if sizing.radius == 0.0 else f"ρ ≥ {sizing.radius:g} mm"
    if task.held is not None:
        label += f", μ ≥ {np.degrees(sizing.angle):g}°"
    if other:
        label += ", face on the other side"
    return [band(task, rows, low, high, shown[0], OTHER if other else REGION, label)]


def region_limits(
    task: FaceTask, sizing: Sizing, rows: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Lower and upper end (k,), (k,) of Re P [mm] at Im P = `rows` (k,) [mm].

    Of a grid of cam angles, for a picture; the lower end is above the upper one outside the region.
    """
    low, high = np.full(len(rows), -np.inf), np.full(len(rows), np.inf)
    if sizing.hopeless is not None:
        return high, low
    phi = np.linspace(0.0, 2.0 * np.pi, SAMPLES, endpoint=False)
    for name in task.names:
        a, b, c = task.rows(name, phi, "right", task.asked(sizing.angle, sizing.radius or 0.0))
        rest = c[:, np.newaxis] + b[:, np.newaxis] * rows  # y is minus the row
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = rest / a[:, np.newaxis]
        none = np.any((a == 0.0)[:, np.newaxis] & (rest > 0.0), axis=0)
        low = np.maximum(low, np.max(ends, axis=0, initial=-np.inf, where=(a > 0.0)[:, np.newaxis]))
        high = np.minimum(
            high, np.min(ends, axis=0, initial=np.inf, where=(a < 0.0)[:, np.newaxis])
        )
        low = np.where(none, np.inf, low)
    return low, high


def _follower(task: FaceTask, sizing: Sizing, style: Style) -> list[Mark]:
    """The face, with its guide or its pivot."""
    answer, y = sizing.answer, task.seen[1] * task.top
    marks: list[Mark] = []
    if answer is not None and answer.face is not None:
        ends = [each.value for each in answer.face]
        marks.append(Line(over(ends, [y, y]), style, layer=3.0))
    if task.held is None:
        return [*marks, Rule("x", 0.0, LINE)]
    arm = Line(over([0.0, 0.0], [0.0, y]), style)
    return [Circle((0.0, 0.0), abs(task.present), KEPT), arm, *marks, pivot()]
