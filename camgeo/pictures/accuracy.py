"""The cost of accuracy over the tolerance: pieces with limits, bytes, seconds, ripple, effects.

At a speed of the cam the first panel has both costs and deviations of the form of the drawing: what
accuracy costs rises, what deviates falls. The knee is marked in all panels, with its reason in
words above them. The last panels, with axes of their own, are the spectrum of the deviation, and
the effects. There are also figures of the deviations alone: at several speeds, and by octaves of
the cam's frequency.

All axes are logarithmic, with the tolerance falling to the right, where costs are higher. Forms
differ by marker and dash, and fast fits have hollow markers, so that a print in grey can be read.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import cycle, product
from typing import Any, Final

from camgeo.geometry.contour.contour import Form
from camgeo.pictures.model import (
    LIMIT,
    LINE,
    Axis,
    Figure,
    Frame,
    Legend,
    Line,
    Panel,
    Rule,
    Style,
    Text,
    box,
    entries,
    heights,
    log_limits,
    over,
)
from camgeo.studies.accuracy.benefit import BenefitRow, advice, find_sufficient, sufficient_sentence
from camgeo.studies.accuracy.contours import EFFORTS, FORMS, ORDER, ContourRow, in_length
from camgeo.studies.accuracy.survey import Stage, Survey
from camgeo.units import MM_PER, RPM, LengthUnit, LiftUnit, in_unit

WIDTH, HEIGHT = 8.0, 3.2
"""Width of the figure and height of each panel [inch]."""

LEFT, RIGHT, TOP, BOTTOM, GAP = 0.85, 2.0, 0.4, 0.55, 0.3
"""Margins, of which the right one has the legends, and the gap between panels [inch]."""

AXIS_GAP: Final = 0.75
"""Gap [inch] above a panel that has a horizontal axis of its own."""

COLOURS: Final[dict[Form, str]] = {"polyline": "#c05a00", "arcs": LINE, "spline": "#6a8f3c"}

MARKERS: Final[dict[Form, str]] = {"polyline": "s", "arcs": "o", "spline": "^"}

SOLID_STYLES: Final[dict[str, tuple[str, str]]] = {
    "stl": ("x", "#808080"), "3mf": ("+", "#404040"), "step": ("^", "#404040"),
}  # fmt: skip

EFFECT_MARKERS: Final = "osD^vP*X"
"""Markers of the effects in order, repeated if there are more effects."""

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

DEVIATION_STYLES: Final = ((LINE, "o"), ("#8c5aa8", "v"), ("#2f7fc1", "P"))
"""Colour and marker of acceleration, contact force and lift-off speed."""

COST_STYLES: Final = (("#c05a00", "s"), ("#6a8f3c", "D"), ("#808080", "^"), ("#404040", "o"))
"""Colour and marker of pieces, bytes, milling and building."""

LEAST_SECONDS: Final = 1e-4
"""Shortest time drawn [s]: a time of 0 has no place on a logarithmic axis."""

LEAST_RANGE: Final = 100.0
"""Least ratio of the upper to the lower end of an axis."""

DOTTED: Final = (1.0, 1.5)

POINTS: Final = 72.0
"""Points in an inch."""

REASON_SIZE: Final = 8.0
"""Size of the text on the knee [points]."""

REASON_WIDTH: Final = 118
"""Letters in a line of that text, which is as wide as the figure."""

REASON_LINE: Final = 1.4 * REASON_SIZE
"""Height of a line of that text [points]."""

BOTH: Final = "off [% of exact]; cost [times the loosest's]"
"""Label of the vertical axis of the panel with both deviations and costs."""

ADVICE: Final = Style(LIMIT, 1.0, (5.0, 3.0))

Value = Callable[[ContourRow], float | None]


KneeMark = tuple[float, str, str]
"""A knee to be drawn: its tolerance [mm], its name, and its reason in words."""


def knee_mark(survey: Survey, benefits: Sequence[BenefitRow]) -> KneeMark | None:
    """The knee of the benefits of one form, if they have one, else that of the costs, or None."""
    if benefits:
        sufficient = find_sufficient(benefits)
        if sufficient is not None:
            name = f"enough at {sufficient.row.speed / RPM:g} rev/min"
            return sufficient.row.tolerance, name, sufficient_sentence(sufficient)
    knee = survey.knee
    return None if knee is None else (knee.row.tolerance, "advice", advice(knee))


def figure(
    survey: Survey,
    *,
    title: str,
    computing: bool = True,
    benefits: Sequence[BenefitRow] = (),
    form: Form = "arcs",
    unit: LiftUnit = "mm",
    length: LengthUnit = "mm",
) -> Figure:
    """The measurements in one panel for each kind of cost; the first has the benefits, if any.

    Parameters
    ----------
    computing : whether computing times are drawn, which differ from run to run.
    benefits : rows of all forms at one speed of the cam; those of `form` are drawn with its costs.
    unit : unit of the output's motion.
    length : unit of length in the figure.
    """
    knee, mm = knee_mark(survey, [row for row in benefits if row.form == form]), MM_PER[length]
    survey = survey.in_length(length)
    benefits = [in_length(row, mm, mm if unit == "mm" else 1.0) for row in benefits]
    form_rows = [row for row in benefits if row.form == form]
    both = _both(survey, form_rows, form, computing=computing)
    panel_lines = [(f"{form}: {BOTH}", both)] if both else []
    if len({row.form for row in benefits if row.ripple}) > 1:
        panel_lines.append(("acceleration off [% of its peak]", _deviation_lines(benefits)))
    panel_lines += [
        ("pieces, dwells and turns not counted", _pieces(survey)),
        ("bytes", _bytes(survey)),
    ]
    if computing or any(row.round_seconds is not None for row in survey.contours):
        panel_lines.append(("seconds", _seconds(survey, computing=computing)))
    if computing and any(row.stages for row in survey.bill):
        panel_lines.append(("seconds of a build", _bill(survey)))
    if any(row.ripple for row in survey.contours):
        ripples = _by_form(survey, lambda row: row.ripple and 100.0 * row.ripple, "ripple, {}, {}")
        panel_lines.append(("ripple [% of the demanded peak]", ripples))
    count = len(panel_lines)
    spectrum = [row for row in form_rows if row.octaves]
    effects = computing and any(row.seconds is not None for row in survey.effects)
    # Spectrum and effects have horizontal axes of their own, and so a larger gap above.
    below_others = (HEIGHT + AXIS_GAP) * (bool(spectrum) + effects)
    words = []
    if knee is not None:
        sentence = in_unit(": ".join(knee[1:]), length)
        words = textwrap.wrap(sentence, REASON_WIDTH, break_on_hyphens=False)
    reason_height = len(words) * REASON_LINE
    top = TOP + reason_height / POINTS
    height = top + BOTTOM + count * HEIGHT + (count - 1) * GAP + below_others
    rules = [] if knee is None else [Rule("x", knee[0] / mm, ADVICE)]
    tolerances = [row.tolerance for row in survey.contours]
    panels = []
    for number, (label, lines) in enumerate(panel_lines):
        bottom = BOTTOM + below_others + (count - 1 - number) * (HEIGHT + GAP)
        x = _tolerances(tolerances, f"tolerance [{length}]", numbered=number == count - 1)
        if knee is not None and not number:  # its line is in every panel, its name only here
            lines.append(Line(over([], []), ADVICE, knee[1]))
        panel = replace(_panel(bottom, height, x, label, lines), marks=(*lines, *rules))
        if not number:
            at_top = [_above(words)] if words else []
            marks, gap = (*panel.marks, *at_top), panel.title_gap + reason_height
            panel = replace(panel, marks=marks, title=title, title_gap=gap)
        panels.append(panel)
    if spectrum:
        frame = _frame(BOTTOM + (HEIGHT + AXIS_GAP) * effects, height)
        moves = length if unit == "mm" else unit
        label = f"{form}: off, by octaves [{moves}/s²]"
        panels.append(octaves(spectrum, frame, label, length=length))
    if effects:
        x = _tolerances(
            [row.tolerance for row in survey.effects],
            "tolerance of effects, of the largest magnitude",
        )
        panels.append(_panel(BOTTOM, height, x, "seconds", _effects(survey)))
    return Figure((WIDTH, height), tuple(panels))


def _frame(bottom: float, height: float, high: float = HEIGHT) -> Frame:
    """The frame of a panel, `bottom` above the lower edge of a figure of `height`, both [inch]."""
    return box(LEFT / WIDTH, bottom / height, 1.0 - (LEFT + RIGHT) / WIDTH, high / height)


def _panel(bottom: float, height: float, x: Axis, label: str, lines: list[Line]) -> Panel:
    """A panel with logarithmic axes in the frame that `_frame` gives."""
    low, high = log_limits(heights(lines))
    if high < LEAST_RANGE * low:  # a few per cent must not look like a large change
        wider = math.sqrt(LEAST_RANGE * low / high)
        low, high = low / wider, high * wider
    y = Axis((low, high), label, log=True)
    legend = _right_legend(lines) if entries(lines) else None
    return Panel(_frame(bottom, height), x, y, tuple(lines), legend=legend)


def _right_legend(lines: Sequence[Line]) -> Legend:
    """The legend of lines, on the right of their panel."""
    return Legend(entries(lines), "upper left", (1.02, 1.0), size=7.5, gap=0.0)


def _tolerances(tolerances: list[float], label: str, *, numbered: bool = True) -> Axis:
    """The horizontal axis of tolerances, falling to the right."""
    ends = (max(tolerances) * 1.8, min(tolerances) / 1.8) if tolerances else log_limits([])
    return Axis(ends, label if numbered else "", log=True, numbered=numbered)


def _above(words: list[str]) -> Text:
    """Lines above a panel, as wide as the figure."""
    start = (0.2 - LEFT) * POINTS
    return Text("\n".join(words), (0.0, 1.0), REASON_SIZE, "panel", (start, 5.0), up="bottom")


def _both(
    survey: Survey, benefits: Sequence[BenefitRow], form: Form, *, computing: bool
) -> list[Line]:
    """Deviations on contours of the `form` in per cent, and their costs as multiples of the
    loosest.

    Values that are 0 or unknown are left out. Empty without benefits.
    """
    known = [row for row in benefits if row.acceleration is not None]
    lines = []
    for name, (colour, marker), deviations in (
        ("acceleration off", DEVIATION_STYLES[0], [row.ripple for row in known]),
        ("contact force off", DEVIATION_STYLES[1], [row.force_share for row in known]),
        ("lift-off speed lost", DEVIATION_STYLES[2], [row.lift_off_share for row in known]),
    ):
        points = [
            (row.tolerance, y and 100.0 * y) for row, y in zip(known, deviations, strict=True)
        ]
        lines += _log_line(points, Style(colour, 1.4, marker=marker, size=5.0), name)
    if not lines:
        return []
    fits = [row for row in survey.contours if (row.form, row.effort) == (form, EFFORTS[0])]
    spent: tuple[list[tuple[float, float | None]], ...] = (
        [(row.tolerance, row.count.pieces if row.count else None) for row in fits],
        [(row.tolerance, _drawing_size(row)) for row in fits],
        [(row.tolerance, row.round_seconds) for row in fits],
        [(row.tolerance, row.total) for row in survey.bill if computing],
    )
    # Costs have different units: relative to the loosest tolerance they share an axis.
    names = ("pieces", "bytes, DXF", "milled round", "seconds of a build")
    for name, (colour, marker), amounts in zip(names, COST_STYLES, spent, strict=True):
        costs = sorted(((x, y) for x, y in amounts if y), reverse=True)
        style = Style(colour, 1.0, (4.0, 2.0), marker, 5.0, "white", colour)
        lines += _log_line([(x, y / costs[0][1]) for x, y in costs], style, name)
    return lines


def _deviation_lines(benefits: Sequence[BenefitRow]) -> list[Line]:
    """The deviation of the acceleration by form, in per cent of its exact peak."""
    lines = []
    for form in FORMS:
        points = [(row.tolerance, row.ripple and 100.0 * row.ripple) for row in benefits
                 if row.form == form]  # fmt: skip
        lines += _log_line(points, _style(form, EFFORTS[0]), f"acceleration off, {form}")
    return lines


def _by_form(
    survey: Survey,
    value: Value,
    label: str,
    efforts: Sequence[str] = EFFORTS,
    forms: Sequence[Form] = FORMS,
    **style_changes: Any,
) -> list[Line]:
    """A line of a value of contours for each form and effort."""
    lines = []
    for form, effort in product(forms, efforts):
        points = [(row.tolerance, value(row)) for row in survey.contours
                 if (row.form, row.effort) == (form, effort)]  # fmt: skip
        lines += _log_line(
            points, replace(_style(form, effort), **style_changes), label.format(form, effort)
        )
    return lines


def _pieces(survey: Survey) -> list[Line]:
    """Numbers of pieces without those of dwells and turns, and their limits with slopes."""

    def free(row: ContourRow) -> float | None:
        return None if row.count is None else row.count.pieces - row.count.forced

    lines = []
    for form in FORMS:
        # The rows of both efforts hold the same limit.
        least = {row.tolerance: row.count.least for row in survey.contours
                 if row.form == form and row.count}  # fmt: skip
        tolerances = sorted(least, reverse=True)
        if tolerances and least[tolerances[0]] > 0.0:
            values = [least[tolerance] for tolerance in tolerances]
            slope = f"limit, slope −1/{ORDER[form]}"
            lines.append(Line(over(tolerances, values), Style(COLOURS[form], 0.7), slope))
        lines += _by_form(survey, free, "{}, {}", forms=(form,))
    return lines


def _bytes(survey: Survey) -> list[Line]:
    """Sizes of the files: drawings, programs, solids; for contours those with the fewest pieces."""
    lines = _by_form(survey, _drawing_size, "DXF, {}", EFFORTS[:1])
    style = replace(_style("arcs", EFFORTS[1]), marker="D", width=0.8, dashes=DOTTED)
    programs = [(row.tolerance, row.program.size) for row in survey.contours
                if row.effort == EFFORTS[0] and row.program]  # fmt: skip
    lines += _log_line(programs, style, "G-code")
    for name, (marker, colour) in SOLID_STYLES.items():
        points = [(row.tolerance, row.file.size if row.file else None) for row in survey.solids
                 if row.format == name]  # fmt: skip
        lines += _log_line(points, Style(colour, 0.8, (4.0, 2.0), marker, 5.0), name.upper())
    return lines


def _seconds(survey: Survey, *, computing: bool) -> list[Line]:
    """Time of milling once around, and computing time of the fit with its proof."""
    lines = _by_form(survey, lambda row: row.round_seconds, "milled round, {}", EFFORTS[:1])
    if computing:
        lines += _by_form(
            survey,
            lambda row: row.count.fit_seconds if row.count else None,
            "fit, {}, {}",
            width=0.8,
            dashes=DOTTED,
            size=3.5,
        )
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


def _effects(survey: Survey) -> list[Line]:
    """Computing times of the numerical effects, over their own tolerances."""
    lines = []
    for number, name in enumerate(dict.fromkeys(row.effect for row in survey.effects)):
        points = [(row.tolerance, row.seconds) for row in survey.effects if row.effect == name]
        marker = EFFECT_MARKERS[number % len(EFFECT_MARKERS)]
        lines += _log_line(points, Style(LINE, 0.8, DOTTED, marker, 5.0), name)
    return lines


def _log_line(points: Iterable[tuple[float, float | None]], style: Style, label: str) -> list[Line]:
    """A line through the points that logarithmic axes can show; none if there are none."""
    visible = [(x, y) for x, y in points if y is not None and 0.0 < y < math.inf]
    return [Line(over(*zip(*visible, strict=True)), style, label)] if visible else []


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


# What is off, alone -------------------------------------------------------------------------------


LOW: Final = 2.6
"""Height of a panel in the figures of deviations [inch]."""

DASHES: Final[tuple[tuple[float, ...], ...]] = ((), (4.0, 2.0), (1.0, 1.5))
"""Dashes of the speeds in ascending order, repeated if there are more."""

LIFT_OFF_LABEL: Final = "lifts off at [rev/min]"

TOLERANCE_COLOURS: Final = ("#08306b", "#2171b5", "#6baed6", "#8c5aa8", "#c27c0e", "#7a7a7a")
"""Colours of the tolerances, the loosest first; repeated with other markers if there are more."""

TOLERANCE_MARKERS: Final = "os^vDP"

DECADES: Final = 1e7
"""Largest ratio of the upper to the lower end of a spectrum: what is below moves nothing."""

HARMONIC: Final = "harmonic of the cam's speed"


def benefit_figure(rows: Sequence[BenefitRow], *, title: str, unit: LiftUnit = "mm") -> Figure:
    """One panel each for acceleration and force at all speeds, and for the lift-off speed.

    `unit` is that of the output's motion. Panels without values are left out, as those of forces in
    a scene without forces.
    """
    speeds = sorted({row.speed for row in rows})
    panel_lines: list[tuple[str, list[Line]]] = [
        (
            f"acceleration is off [{unit}/s²]",
            _speed_lines(rows, speeds, lambda row: row.acceleration),
        ),
        ("contact force is off [N]", _speed_lines(rows, speeds, lambda row: row.force)),
        (
            LIFT_OFF_LABEL,
            _speed_lines(
                rows, speeds[:1], lambda row: row.lift_off_speed and row.lift_off_speed / RPM
            ),
        ),
    ]
    panel_lines = [(label, lines) for label, lines in panel_lines if lines]
    exact = {row.exact_lift_off_speed for row in rows} - {None, math.inf}
    height, frames = _low_frames(len(panel_lines))
    panels = []
    for number, ((label, lines), frame) in enumerate(zip(panel_lines, frames, strict=True)):
        last = number == len(panel_lines) - 1
        rules = [
            Rule("y", speed / RPM, ADVICE) for speed in exact if speed and label == LIFT_OFF_LABEL
        ]
        tolerances = [row.tolerance for row in rows]
        low, high = log_limits(heights(lines))
        panels.append(
            Panel(
                frame,
                _tolerances(tolerances, "tolerance [mm]", numbered=last),
                Axis((low, max(high, *(1.2 * rule.at for rule in rules), 0.0)), label, log=True),
                (*lines, *rules),
                title="" if number else title,
                legend=_right_legend(lines),
            )
        )
    return Figure((WIDTH, height), tuple(panels))


def _speed_lines(
    rows: Sequence[BenefitRow], speeds: Sequence[float], value: Callable[[BenefitRow], float | None]
) -> list[Line]:
    """A line of a value over the tolerance, for each form and speed."""
    lines = []
    for form in FORMS:
        for number, speed in enumerate(speeds):
            points = [(row.tolerance, value(row)) for row in rows
                     if (row.form, row.speed) == (form, speed)]  # fmt: skip
            colour, dashes = COLOURS[form], DASHES[number % len(DASHES)]
            style = Style(colour, 0.8, dashes, MARKERS[form], 4.0, colour, colour)
            suffix = f", {speed / RPM:g} rev/min" if len(speeds) > 1 else ""
            lines += _log_line(points, style, f"{form}{suffix}")
    return lines


def spectrum_figure(rows: Sequence[BenefitRow], *, title: str, unit: LiftUnit = "mm") -> Figure:
    """One panel of the spectrum for each form of the contour; all `rows` are of one speed.

    `unit` is that of the output's motion.
    """
    forms = [form for form in FORMS if any(row.form == form and row.octaves for row in rows)]
    height, frames = _low_frames(len(forms))
    panels = []
    for number, (form, frame) in enumerate(zip(forms, frames, strict=True)):
        form_rows = [row for row in rows if row.form == form]
        head, last = "" if number else title, number == len(forms) - 1
        panels.append(octaves(form_rows, frame, f"{form} [{unit}/s²]", title=head, numbered=last))
    return Figure((WIDTH, height), tuple(panels))


def octaves(
    rows: Sequence[BenefitRow],
    frame: Frame,
    label: str,
    *,
    title: str = "",
    numbered: bool = True,
    length: LengthUnit = "mm",
) -> Panel:
    """The effective value of each octave, drawn at the first of its harmonics.

    `rows` are of one form of the contour at one speed, with tolerances in the unit `length`.
    """
    lines = []
    for row, colour, marker in zip(rows, cycle(TOLERANCE_COLOURS), cycle(TOLERANCE_MARKERS)):
        points = [(2.0**octave, value) for octave, value in enumerate(row.octaves)]
        style = Style(colour, 1.2, marker=marker, size=4.0)
        lines += _log_line(points, style, f"{row.tolerance:.6g} {length}")
    low, high = log_limits(heights(lines))
    count = max((len(row.octaves) for row in rows), default=1)
    ticks = tuple(2.0**octave for octave in range(count))
    return Panel(
        frame,
        Axis(
            (0.8, 1.25 * ticks[-1]),
            HARMONIC if numbered else "",
            log=True,
            ticks=ticks,
            names=tuple(f"{tick:g}" for tick in ticks),
            numbered=numbered,
        ),
        Axis((max(low, high / DECADES), high), label, log=True),
        tuple(lines),
        title=title,
        legend=_right_legend(lines),
    )


def _low_frames(count: int) -> tuple[float, list[Frame]]:
    """The height [inch] of a figure of so many panels below each other, and their frames."""
    height = TOP + BOTTOM + count * LOW + (count - 1) * GAP
    bottoms = (BOTTOM + (count - 1 - number) * (LOW + GAP) for number in range(count))
    return height, [_frame(bottom, height, LOW) for bottom in bottoms]
