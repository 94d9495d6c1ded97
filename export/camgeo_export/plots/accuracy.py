"""What accuracy costs, over the tolerance: pieces beside their limits, bytes, seconds, effects.

All on logarithmic axes, the tolerance falling to the right: what costs more stands farther right.
Forms differ by marker and dash, fast fits have hollow markers, so that a print in grey can be read.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from camgeo.accuracy.rows import EFFORTS, FORMS, ORDER, ContourRow, Form
from camgeo.accuracy.survey import Survey
from camgeo_export.plots.file import figure_file
from camgeo_export.plots.style import LIMIT, LINE

WIDTH, HEIGHT = 8.0, 3.2
"""Sizes [inch] of the figure and of each panel."""

LEFT, RIGHT, TOP, BOTTOM, GAP = 0.85, 2.0, 0.4, 0.55, 0.3
"""Margins [inch]; the legends stand in the right one, the gap between the panels."""

EFFECTS_GAP: Final = 0.75
"""Gap [inch] above the panel of the effects, whose axis of tolerances is its own."""

COLOURS: Final[dict[Form, str]] = {"polyline": "#c05a00", "arcs": LINE, "spline": "#6a8f3c"}

MARKERS: Final[dict[Form, str]] = {"polyline": "s", "arcs": "o", "spline": "^"}

SOLID_STYLES: Final[dict[str, tuple[str, str]]] = {"stl": ("x", "#808080"), "3mf": ("+", "#404040")}

EFFECT_MARKERS: Final = "osD^vP*X"
"""Of the effects, in their order; with more of them they begin anew."""

LEAST_RANGE: Final = 100.0
"""Factor from the lower to the upper end of an axis, at least."""

DOTTED: Final = (0, (1, 1.5))

Value = Callable[[ContourRow], float | None]


def render(survey: Survey, *, title: str, suffix: str, computing: bool = True) -> bytes:
    """The measurements as a file of kind `suffix`: ".svg", ".png" or ".pdf".

    Parameters
    ----------
    computing : whether seconds of computing are drawn, which differ from run to run.

    Raises
    ------
    ValueError
        If there is no such kind of figure.
    """
    return figure_file(lambda: _figure(survey, title, computing=computing), suffix)


def _figure(survey: Survey, title: str, *, computing: bool) -> Figure:
    panels = [_pieces, _bytes]
    seconds = computing or any(row.round_seconds is not None for row in survey.contours)
    count = len(panels) + seconds
    effects = computing and any(row.seconds is not None for row in survey.effects)
    below_others = (HEIGHT + EFFECTS_GAP) * effects
    height = TOP + BOTTOM + count * HEIGHT + (count - 1) * GAP + below_others
    figure = Figure(figsize=(WIDTH, height))
    FigureCanvasAgg(figure)
    below: Axes | None = None
    for number in range(count):
        axes = _axes(figure, BOTTOM + below_others + (count - 1 - number) * (HEIGHT + GAP), height)
        if number < len(panels):
            panels[number](axes, survey)
        else:
            _seconds(axes, survey, computing=computing)
        _scale(axes, survey, label=number == count - 1)
        _legend(axes)
        if below is None:
            axes.set_title(title)
        below = axes
    if effects:
        axes = _axes(figure, BOTTOM, height)
        _effects(axes, survey)
        _legend(axes)
    return figure


def _axes(figure: Figure, bottom: float, height: float) -> Axes:
    """A panel whose lower edge is `bottom` inches above that of the figure of `height`."""
    axes = figure.add_axes(
        (LEFT / WIDTH, bottom / height, 1.0 - (LEFT + RIGHT) / WIDTH, HEIGHT / height)
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    return axes


def _legend(axes: Axes) -> None:
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0.0, fontsize=7.5)


def _scale(axes: Axes, survey: Survey, *, label: bool) -> None:
    tolerances = [row.tolerance for row in survey.contours]
    if tolerances:
        axes.set_xlim(max(tolerances) * 1.8, min(tolerances) / 1.8)
    _widen(axes)
    knee = survey.knee
    if knee is not None:
        axes.axvline(knee.row.tolerance, color=LIMIT, linewidth=1.0, linestyle=(0, (5, 3)))
    if label:
        axes.set_xlabel("tolerance [mm]")
    else:
        axes.tick_params(labelbottom=False)


def _widen(axes: Axes) -> None:
    low, high = axes.get_ylim()
    if high < LEAST_RANGE * low:  # a few per cent must not look like a mountain
        wider = math.sqrt(LEAST_RANGE * low / high)
        axes.set_ylim(low / wider, high * wider)


def _pieces(axes: Axes, survey: Survey) -> None:
    """Pieces without those that dwells and turns are, and the limits with their slopes."""

    def free(row: ContourRow) -> float | None:
        return None if row.count is None else row.count.pieces - row.count.forced

    for form in FORMS:
        own = [row for row in survey.contours if row.form == form and row.count is not None]
        # The same limit stands in the rows of both efforts.
        least = {row.tolerance: row.count.least for row in own if row.count}
        tolerances = sorted(least, reverse=True)
        if tolerances and least[tolerances[0]] > 0.0:
            values = [least[tolerance] for tolerance in tolerances]
            slope = f"limit, slope −1/{ORDER[form]}"
            axes.plot(tolerances, values, color=COLOURS[form], linewidth=0.7, label=slope)
        for effort in EFFORTS:
            rows = [row for row in own if row.effort == effort]
            _points(axes, rows, free, f"{form}, {effort}", _style(form, effort))
    if survey.knee is not None:
        axes.plot([], [], color=LIMIT, linewidth=1.0, linestyle=(0, (5, 3)), label="advice")
    axes.set_ylabel("pieces, dwells and turns not counted")


def _bytes(axes: Axes, survey: Survey) -> None:
    """Sizes of the files: drawings, programs, solids; of contours those of fewest pieces."""
    fewest = [row for row in survey.contours if row.effort == EFFORTS[0]]
    for form in FORMS:
        rows = [row for row in fewest if row.form == form]
        _points(axes, rows, _drawing_size, f"DXF, {form}", _style(form, EFFORTS[0]))
    style = {**_style("arcs", EFFORTS[1]), "marker": "D", "linestyle": DOTTED}
    _points(axes, fewest, _program_size, "G-code", style)
    for name, (marker, colour) in SOLID_STYLES.items():
        found = [(row.tolerance, row.file.size) for row in survey.solids if row.format == name
                 and row.file is not None]  # fmt: skip
        if found:
            axes.plot(
                *zip(*found, strict=True), color=colour, marker=marker, markersize=5.0,
                linewidth=0.8, linestyle=(0, (4, 2)), label=name.upper(),
            )  # fmt: skip
    axes.set_ylabel("bytes")


def _seconds(axes: Axes, survey: Survey, *, computing: bool) -> None:
    """Milling once round, and computing: fit with its proof."""
    fewest = [row for row in survey.contours if row.effort == EFFORTS[0]]
    for form in FORMS:
        rows = [row for row in fewest if row.form == form]
        label = f"milled round, {form}"
        _points(axes, rows, lambda row: row.round_seconds, label, _style(form, EFFORTS[0]))
    if computing:
        for form in FORMS:
            for effort in EFFORTS:
                rows = [row for row in survey.contours if (row.form, row.effort) == (form, effort)]
                style = {**_style(form, effort), "linestyle": DOTTED, "markersize": 3.5}
                _points(axes, rows, _fit_seconds, f"fit, {form}, {effort}", style)
    axes.set_ylabel("seconds")


def _effects(axes: Axes, survey: Survey) -> None:
    """Computing of the numerical effects, over tolerances of their own."""
    names = tuple(dict.fromkeys(row.effect for row in survey.effects))
    for number, name in enumerate(names):
        found = [(row.tolerance, row.seconds) for row in survey.effects
                 if row.effect == name and row.seconds is not None]  # fmt: skip
        if found:
            axes.plot(
                *zip(*found, strict=True), color=LINE, linewidth=0.8, markersize=5.0, label=name,
                marker=EFFECT_MARKERS[number % len(EFFECT_MARKERS)], linestyle=DOTTED,
            )  # fmt: skip
    tolerances = [row.tolerance for row in survey.effects]
    axes.set_xlim(max(tolerances) * 1.8, min(tolerances) / 1.8)
    _widen(axes)
    axes.set_ylabel("seconds")
    axes.set_xlabel("tolerance of effects, of the largest magnitude")


def _points(
    axes: Axes, rows: Sequence[ContourRow], value: Value, label: str, style: dict[str, Any]
) -> None:
    found = [(row.tolerance, value(row)) for row in rows]
    sound = np.array([(x, y) for x, y in found if y is not None and y > 0.0], dtype=np.float64)
    if len(sound):
        axes.plot(sound[:, 0], sound[:, 1], label=label, **style)


def _style(form: Form, effort: str) -> dict[str, Any]:
    hollow = effort == EFFORTS[1]
    return {
        "color": COLOURS[form],
        "marker": MARKERS[form],
        "markersize": 5.0,
        "markerfacecolor": "white" if hollow else COLOURS[form],
        "markeredgecolor": COLOURS[form],
        "linewidth": 0.8,
        "linestyle": "none" if hollow else "solid",
    }


def _drawing_size(row: ContourRow) -> float | None:
    return None if row.drawing is None else row.drawing.size


def _program_size(row: ContourRow) -> float | None:
    return None if row.program is None else row.program.size


def _fit_seconds(row: ContourRow) -> float | None:
    return None if row.count is None else row.count.fit_seconds
