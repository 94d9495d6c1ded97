"""Error against conditioning, one point per quantity of each case of the stability suite.

Both in ulp on logarithmic axes. On the diagonal an error equals the effect of half an ulp of the
inputs; left of 1 ulp the least possible error of a double replaces it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from camgeo.pictures.model import (
    AUXILIARY,
    LIMIT,
    Axis,
    Figure,
    Legend,
    Line,
    Panel,
    Style,
    box,
    entries,
    over,
)
from tests.stability.measure import Reading

WIDTH, HEIGHT = 9.6, 9.0
LEFT, RIGHT, TOP, BOTTOM = 0.75, 2.75, 0.5, 0.6
"""Sizes [inch]; the legend stands in the right margin."""

LEAST: Final = 0.1
"""Errors and conditionings below this [ulp], zero included, are drawn at it."""

ROOM: Final = 3.0
"""Factor by which the axes extend beyond the points."""

COLOURS: Final = ("#12365c", "#c05a00", "#2e7d32", "#8e24aa", "#6d4c41", "#0097a7", "#9e9d24")

MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X", "<")
"""Every quantity has its own colour and marker; shapes differ for prints in grey."""


def figure(readings: Sequence[Reading], limit: float) -> Figure:
    """The readings as points.

    Parameters
    ----------
    readings : with finite errors.
    limit : the largest ratio that passes, drawn as a line.
    """
    points = []
    for number, quantity in enumerate(dict.fromkeys(reading.quantity for reading in readings)):
        own = [reading for reading in readings if reading.quantity == quantity]
        x = [max(reading.conditioning, LEAST) for reading in own]
        y = [max(reading.error, LEAST) for reading in own]
        points.append(Line(over(x, y), _style(number), quantity, layer=3.0))
    conditionings = [reading.conditioning for reading in readings]
    highest = ROOM * max([1.0, limit, *conditionings, *(reading.error for reading in readings)])
    low, high = LEAST / ROOM, ROOM * max([1.0, *conditionings])
    marks = (*points, *_lines(low, high, limit))
    panel = Panel(
        box(
            LEFT / WIDTH,
            BOTTOM / HEIGHT,
            1.0 - (LEFT + RIGHT) / WIDTH,
            1.0 - (BOTTOM + TOP) / HEIGHT,
        ),
        Axis((low, high), "conditioning: change by half an ulp of each input [ulp]", log=True),
        Axis((low, highest), "error against mpmath [ulp]", log=True),
        marks,
        "Rounding errors of the stability suite",
    )
    anchor = (1.0 - (RIGHT - 0.12) / WIDTH, 1.0 - TOP / HEIGHT)
    legend = Legend(entries(marks), "upper left", anchor, size=7.0, gap=0.0, spacing=0.35)
    return Figure((WIDTH, HEIGHT), (panel,), legend=legend)


def _style(number: int) -> Style:
    return Style(
        COLOURS[number % len(COLOURS)],
        0.0,
        marker=MARKERS[number % len(MARKERS)],
        size=4.0,
        edge="white",
        edge_width=0.3,
    )


def _lines(low: float, high: float, limit: float) -> list[Line]:
    """Ratio 1, and the limit."""
    x = np.sort(np.append(np.geomspace(low, high, 201), 1.0))
    floor = np.maximum(1.0, x)
    return [
        Line(over(x, floor), Style(AUXILIARY, 1.0), "ratio 1"),
        Line(over(x, limit * floor), Style(LIMIT, 1.0, (5.0, 3.0)), f"limit, ratio {limit:g}"),
    ]
