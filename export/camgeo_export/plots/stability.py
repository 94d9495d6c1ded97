"""Error against conditioning, a point for each quantity of each case of the stability suite.

Both in ulp on logarithmic axes. On the diagonal an error is what half an ulp of the inputs does;
left of 1 ulp the least that a double can be wrong by takes its place.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from camgeo.stability.measure import Reading
from camgeo_export.plots.file import figure_file
from camgeo_export.plots.style import AUXILIARY, LIMIT

WIDTH, HEIGHT = 9.6, 9.0
LEFT, RIGHT, TOP, BOTTOM = 0.75, 2.75, 0.5, 0.6
"""Sizes [inch]; the legend stands in the right margin."""

LEAST: Final = 0.1
"""Errors and conditionings below this [ulp], zero among them, are drawn at it."""

ROOM: Final = 3.0
"""Factor by which the axes go beyond the points."""

COLOURS: Final = ("#12365c", "#c05a00", "#2e7d32", "#8e24aa", "#6d4c41", "#0097a7", "#9e9d24")

MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X", "<")
"""Every quantity has a colour and a marker of its own; they differ in shape for prints in grey."""


def render(readings: Sequence[Reading], limit: float, suffix: str) -> bytes:
    """The readings as a file of kind `suffix`: ".svg", ".png" or ".pdf".

    Parameters
    ----------
    readings : with finite errors.
    limit : the largest ratio that is let pass, drawn as a line.

    Raises
    ------
    ValueError
        If there is no such kind of figure.
    """
    return figure_file(lambda: _figure(readings, limit), suffix)


def _figure(readings: Sequence[Reading], limit: float) -> Figure:
    figure = Figure(figsize=(WIDTH, HEIGHT))
    FigureCanvasAgg(figure)
    axes = figure.add_axes(
        (
            LEFT / WIDTH,
            BOTTOM / HEIGHT,
            1.0 - (LEFT + RIGHT) / WIDTH,
            1.0 - (BOTTOM + TOP) / HEIGHT,
        )
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    quantities = tuple(dict.fromkeys(reading.quantity for reading in readings))
    styles = {quantity: _style(number) for number, quantity in enumerate(quantities)}
    for quantity in quantities:
        own = [reading for reading in readings if reading.quantity == quantity]
        axes.plot(
            [max(reading.conditioning, LEAST) for reading in own],
            [max(reading.error, LEAST) for reading in own],
            zorder=3,
            **styles[quantity],
        )
    conditionings = [reading.conditioning for reading in readings]
    highest = ROOM * max([1.0, limit, *conditionings, *(reading.error for reading in readings)])
    axes.set_xlim(LEAST / ROOM, ROOM * max([1.0, *conditionings]))
    axes.set_ylim(LEAST / ROOM, highest)
    _lines(axes, limit)
    axes.set_xlabel("conditioning: change by half an ulp of each input [ulp]")
    axes.set_ylabel("error against mpmath [ulp]")
    axes.set_title("Rounding errors of the stability suite")
    handles = [Line2D([], [], label=name, **style) for name, style in styles.items()]
    handles += list(axes.lines[-2:])
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(1.0 - (RIGHT - 0.12) / WIDTH, 1.0 - TOP / HEIGHT),
        borderaxespad=0.0,
        fontsize=7.0,
        labelspacing=0.35,
    )
    return figure


def _style(number: int) -> dict[str, Any]:
    return {
        "color": COLOURS[number % len(COLOURS)],
        "marker": MARKERS[number % len(MARKERS)],
        "markersize": 4.0,
        "markeredgecolor": "white",
        "markeredgewidth": 0.3,
        "linestyle": "none",
    }


def _lines(axes: Axes, limit: float) -> None:
    """Ratio 1, and the limit."""
    low, high = axes.get_xlim()
    x = np.geomspace(low, high, 201)
    x = np.sort(np.append(x, 1.0))
    floor = np.maximum(1.0, x)
    axes.plot(x, floor, color=AUXILIARY, linewidth=1.0, label="ratio 1")
    axes.plot(
        x, limit * floor, color=LIMIT, linewidth=1.0, linestyle=(0, (5, 3)),
        label=f"limit, ratio {limit:g}",
    )  # fmt: skip
