"""The cost of accuracy over the tolerance: pieces with limits, bytes, seconds, ripple, effects.

All axes are logarithmic, with the tolerance falling to the right, where costs are higher. Forms
differ by marker and dash, fast fits have hollow markers, so that a print in grey can be read.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from camgeo.accuracy.bill import Stage
from camgeo.accuracy.rows import EFFORTS, FORMS, ORDER, ContourRow
from camgeo.accuracy.survey import Survey
from camgeo.contour.contour import Form
from camgeo.figure.layout import box, heights, log_limits
from camgeo.figure.marks import Line, Rule, Style, over
from camgeo.figure.model import Axis, Figure, Legend, Panel, entries
from camgeo.figure.style import LIMIT, LINE

WIDTH, HEIGHT = 8.0, 3.2
"""Sizes [inch] of the figure and of each panel."""

LEFT, RIGHT, TOP, BOTTOM, GAP = 0.85, 2.0, 0.4, 0.55, 0.3
"""Margins [inch]; the legends are in the right one. Last the gap between the panels."""

EFFECTS_GAP: Final = 0.75
"""Gap [inch] above the panel of the effects, which has its own axis of tolerances."""

COLOURS: Final[dict[Form, str]] = {"polyline": "#c05a00", "arcs": LINE, "spline": "#6a8f3c"}

MARKERS: Final[dict[Form, str]] = {"polyline": "s", "arcs": "o", "spline": "^"}

SOLID_STYLES: Final[dict[str, tuple[str, str]]] = {
    "stl": ("x", "#808080"), "3mf": ("+", "#404040"), "step": ("^", "#404040"),
}  # fmt: skip

EFFECT_MARKERS: Final = "osD^vP*X"
"""Colours of the effects in order, repeated if there are more effects."""

STAGE_STYLES: Final[dict[Stage, tuple[str, str]]] = {
    "evaluate": ("#404040", "s"),
    "fit": ("#c05a00", "^"),
    "prove": ("#8c5aa8", "v"),
    "write": ("#6a8f3c", "D"),
    "read": ("#2f7fc1", "P"),
}
STAGE_NAMES: Final[dict[Stage, str]] = {
    "evaluate": "evaluate", "fit": "fit", "prove": "prove", "write": "write", "read": "read back",
}  # fmt: skip

LEAST_SECONDS: Final = 1e-4
"""Shortest time drawn; a stage that takes nothing has no place on a logarithmic axis."""

LEAST_RANGE: Final = 100.0
"""Least factor from the lower to the upper end of an axis."""

DOTTED: Final = (1.0, 1.5)

ADVICE: Final = Style(LIMIT, 1.0, (5.0, 3.0))

Value = Callable[[ContourRow], float | None]


def figure(survey: Survey, *, title: str, computing: bool = True) -> Figure:
    """The measurements, one panel per kind of cost.

    Parameters
    ----------
    computing : whether computing times are drawn, which differ from run to run.
    """
    drawn = [("pieces, dwells and turns not counted", _pieces(survey)), ("bytes", _bytes(survey))]
    if computing or any(row.round_seconds is not None for row in survey.contours):
        drawn.append(("seconds", _seconds(survey, computing=computing)))
    if computing and any(row.stages for row in survey.bill):
        drawn.append(("seconds of a build", _bill(survey)))
    if any(row.ripple for row in survey.contours):
        drawn.append(("ripple [% of the demanded peak]", _ripples(survey)))
    count = len(drawn)
    effects = computing and any(row.seconds is not None for row in survey.effects)
    below_others = (HEIGHT + EFFECTS_GAP) * effects
    height = TOP + BOTTOM + count * HEIGHT + (count - 1) * GAP + below_others
    knee = [] if survey.knee is None else [Rule("x", survey.knee.row.tolerance, ADVICE)]
    tolerances = [row.tolerance for row in survey.contours]
    panels = []
    for number, (label, lines) in enumerate(drawn):
        bottom = BOTTOM + below_others + (count - 1 - number) * (HEIGHT + GAP)
        x = _tolerances(tolerances, "tolerance [mm]", numbered=number == count - 1)
        panel = _panel(bottom, height, x, label, lines)
        panels.append(replace(panel, marks=(*lines, *knee), title="" if number else title))
    if effects:
        x = _tolerances(
            [row.tolerance for row in survey.effects],
            "tolerance of effects, of the largest magnitude",
        )
        panels.append(_panel(BOTTOM, height, x, "seconds", _effects(survey)))
    return Figure((WIDTH, height), tuple(panels))


def _panel(bottom: float, height: float, x: Axis, label: str, lines: list[Line]) -> Panel:
    """A panel whose lower edge is `bottom` inches above that of the figure of `height`."""
    low, high = log_limits(heights(lines))
    if high < LEAST_RANGE * low:  # a few per cent must not look like a large change
        wider = math.sqrt(LEAST_RANGE * low / high)
        low, high = low / wider, high * wider
    named = entries(lines)
    return Panel(
        box(LEFT / WIDTH, bottom / height, 1.0 - (LEFT + RIGHT) / WIDTH, HEIGHT / height),
        x,
        Axis((low, high), label, log=True),
        tuple(lines),
        legend=Legend(named, "upper left", (1.02, 1.0), size=7.5, gap=0.0) if named else None,
    )


def _tolerances(tolerances: list[float], label: str, *, numbered: bool = True) -> Axis:
    ends = (max(tolerances) * 1.8, min(tolerances) / 1.8) if tolerances else log_limits([])
    return Axis(ends, label if numbered else "", log=True, numbered=numbered)


def _pieces(survey: Survey) -> list[Line]:
    """Pieces without those of dwells and turns, and the limits with their slopes."""

    def free(row: ContourRow) -> float | None:
        return None if row.count is None else row.count.pieces - row.count.forced

    lines = []
    for form in FORMS:
        own = [row for row in survey.contours if row.form == form and row.count is not None]
        # The rows of both efforts hold the same limit.
        least = {row.tolerance: row.count.least for row in own if row.count}
        tolerances = sorted(least, reverse=True)
        if tolerances and least[tolerances[0]] > 0.0:
            values = [least[tolerance] for tolerance in tolerances]
            slope = f"limit, slope −1/{ORDER[form]}"
            lines.append(Line(over(tolerances, values), Style(COLOURS[form], 0.7), slope))
        for effort in EFFORTS:
            rows = [row for row in own if row.effort == effort]
            lines += _points(rows, free, f"{form}, {effort}", _style(form, effort))
    if survey.knee is not None:  # its line is in every panel, its name only in this one
        lines.append(Line(over([], []), ADVICE, "advice"))
    return lines


def _bytes(survey: Survey) -> list[Line]:
    """Sizes of the files: drawings, programs, solids; for contours those with the fewest pieces."""
    fewest = [row for row in survey.contours if row.effort == EFFORTS[0]]
    lines = []
    for form in FORMS:
        rows = [row for row in fewest if row.form == form]
        lines += _points(rows, _drawing_size, f"DXF, {form}", _style(form, EFFORTS[0]))
    style = replace(_style("arcs", EFFORTS[1]), marker="D", width=0.8, dashes=DOTTED)
    lines += _points(fewest, _program_size, "G-code", style)
    for name, (marker, colour) in SOLID_STYLES.items():
        found = [(row.tolerance, row.file.size) for row in survey.solids if row.format == name
                 and row.file is not None]  # fmt: skip
        if found:
            style = Style(colour, 0.8, (4.0, 2.0), marker, 5.0)
            lines.append(Line(over(*zip(*found, strict=True)), style, name.upper()))
    return lines


def _seconds(survey: Survey, *, computing: bool) -> list[Line]:
    """Time of milling one round, and of computing: fit with its proof."""
    fewest = [row for row in survey.contours if row.effort == EFFORTS[0]]
    lines = []
    for form in FORMS:
        rows = [row for row in fewest if row.form == form]
        label = f"milled round, {form}"
        lines += _points(rows, lambda row: row.round_seconds, label, _style(form, EFFORTS[0]))
    for form in FORMS if computing else ():
        for effort in EFFORTS:
            rows = [row for row in survey.contours if (row.form, row.effort) == (form, effort)]
            style = replace(_style(form, effort), width=0.8, dashes=DOTTED, size=3.5)
            lines += _points(rows, _fit_seconds, f"fit, {form}, {effort}", style)
    return lines


def _bill(survey: Survey) -> list[Line]:
    """Seconds of whole builds, in all and by stage."""
    built = [row for row in survey.bill if row.total]
    tolerances = [row.tolerance for row in built]
    totals = [row.total or 0.0 for row in built]
    lines = [Line(over(tolerances, totals), Style(LINE, 1.6, marker="o", size=5.0), "whole build")]
    for stage, (colour, marker) in STAGE_STYLES.items():
        spent = [max(row.stages[stage], LEAST_SECONDS) for row in built]
        style = Style(colour, 0.9, (4.0, 2.0), marker, 4.0)
        lines.append(Line(over(tolerances, spent), style, STAGE_NAMES[stage]))
    return lines


def _ripples(survey: Survey) -> list[Line]:
    """Largest error of the acceleration in a replay, in per cent of its demanded peak."""
    lines = []
    for form in FORMS:
        for effort in EFFORTS:
            rows = [row for row in survey.contours if (row.form, row.effort) == (form, effort)]
            label = f"ripple, {form}, {effort}"
            lines += _points(rows, _ripple_percent, label, _style(form, effort))
    return lines


def _effects(survey: Survey) -> list[Line]:
    """Computing times of the numerical effects, over their own tolerances."""
    lines = []
    for number, name in enumerate(dict.fromkeys(row.effect for row in survey.effects)):
        found = [(row.tolerance, row.seconds) for row in survey.effects
                 if row.effect == name and row.seconds is not None]  # fmt: skip
        if found:
            marker = EFFECT_MARKERS[number % len(EFFECT_MARKERS)]
            style = Style(LINE, 0.8, DOTTED, marker, 5.0)
            lines.append(Line(over(*zip(*found, strict=True)), style, name))
    return lines


def _points(rows: Sequence[ContourRow], value: Value, label: str, style: Style) -> list[Line]:
    found = [(row.tolerance, value(row)) for row in rows]
    positive = [(x, y) for x, y in found if y is not None and y > 0.0]
    return [Line(over(*zip(*positive, strict=True)), style, label)] if positive else []


def _style(form: Form, effort: str) -> Style:
    hollow, colour = effort == EFFORTS[1], COLOURS[form]
    return Style(
        colour,
        0.0 if hollow else 0.8,
        marker=MARKERS[form],
        size=5.0,
        face="white" if hollow else colour,
        edge=colour,
    )


def _drawing_size(row: ContourRow) -> float | None:
    return None if row.drawing is None else row.drawing.size


def _program_size(row: ContourRow) -> float | None:
    return None if row.program is None else row.program.size


def _fit_seconds(row: ContourRow) -> float | None:
    return None if row.count is None else row.count.fit_seconds


def _ripple_percent(row: ContourRow) -> float | None:
    return None if row.ripple is None else 100.0 * row.ripple
