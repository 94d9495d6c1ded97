"""The spectrum of the ripple: how much of it lies in each octave of the cam's frequency.

Over the harmonics of the cam's speed, with a line for each tolerance; both axes are logarithmic.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import Final

from camgeo.pictures.model import (
    Axis,
    Figure,
    Frame,
    Legend,
    Line,
    Panel,
    Style,
    box,
    entries,
    heights,
    log_limits,
    over,
)
from camgeo.studies.accuracy.benefit import BenefitRow
from camgeo.studies.accuracy.contours import FORMS
from camgeo.units import LengthUnit, LiftUnit

WIDTH, HEIGHT = 8.0, 2.6
"""Sizes [inch] of the figure and of each panel."""

LEFT, RIGHT, TOP, BOTTOM, GAP = 0.85, 2.0, 0.4, 0.55, 0.3
"""Margins [inch]; the legends are in the right one. Last the gap between the panels."""

COLOURS: Final = ("#08306b", "#2171b5", "#6baed6", "#8c5aa8", "#c27c0e", "#7a7a7a")
"""Of the tolerances, the loosest first; repeated with other markers if there are more."""

MARKERS: Final = "os^vDP"

DECADES: Final = 1e7
"""Factor from the top of a panel to its lower end: what is further down moves nothing."""

ORDER: Final = "harmonic of the cam's speed"


def figure(rows: Sequence[BenefitRow], *, title: str, unit: LiftUnit = "mm") -> Figure:
    """One panel for each form of the contour of `rows`, which are of one speed of the cam.

    The output moves in `unit`.
    """
    forms = [form for form in FORMS if any(row.form == form and row.octaves for row in rows)]
    height = TOP + BOTTOM + len(forms) * HEIGHT + (len(forms) - 1) * GAP
    panels = []
    for number, form in enumerate(forms):
        bottom = BOTTOM + (len(forms) - 1 - number) * (HEIGHT + GAP)
        frame = box(LEFT / WIDTH, bottom / height, 1 - (LEFT + RIGHT) / WIDTH, HEIGHT / height)
        own = [row for row in rows if row.form == form]
        head, last = "" if number else title, number == len(forms) - 1
        panels.append(panel(own, frame, f"{form} [{unit}/s²]", title=head, numbered=last))
    return Figure((WIDTH, height), tuple(panels))


def panel(
    rows: Sequence[BenefitRow],
    frame: Frame,
    label: str,
    *,
    title: str = "",
    numbered: bool = True,
    length: LengthUnit = "mm",
) -> Panel:
    """The effective values of the octaves, each drawn at the first of its harmonics.

    `rows` are of one form of the contour at one speed, with tolerances in the unit `length`.
    """
    lines = []
    for row, colour, marker in zip(rows, cycle(COLOURS), cycle(MARKERS)):
        found = [(2.0**octave, value) for octave, value in enumerate(row.octaves) if value > 0.0]
        if found:
            style = Style(colour, 1.2, marker=marker, size=4.0)
            lines.append(
                Line(over(*zip(*found, strict=True)), style, f"{row.tolerance:.6g} {length}")
            )
    low, high = log_limits(heights(lines))
    count = max((len(row.octaves) for row in rows), default=1)
    ticks = tuple(2.0**octave for octave in range(count))
    return Panel(
        frame,
        Axis(
            (0.8, 1.25 * ticks[-1]),
            ORDER if numbered else "",
            log=True,
            ticks=ticks,
            names=tuple(f"{tick:g}" for tick in ticks),
            numbered=numbered,
        ),
        Axis((max(low, high / DECADES), high), label, log=True),
        tuple(lines),
        title=title,
        legend=Legend(entries(lines), "upper left", (1.02, 1.0), size=7.5, gap=0.0),
    )
