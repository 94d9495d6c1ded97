"""What accuracy buys over the tolerance: ripple of acceleration and contact force, and lift-off.

All axes are logarithmic, with the tolerance falling to the right, as in `camgeo.pictures.accuracy`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

from camgeo.pictures.accuracy import COLOURS, MARKERS
from camgeo.pictures.model import (
    LIMIT,
    Axis,
    Figure,
    Legend,
    Line,
    Panel,
    Rule,
    Style,
    box,
    entries,
    heights,
    log_limits,
    over,
)
from camgeo.studies.accuracy.benefit import BenefitRow
from camgeo.studies.accuracy.contours import FORMS
from camgeo.units import RPM, LiftUnit

WIDTH, HEIGHT = 8.0, 2.6
"""Sizes [inch] of the figure and of each panel."""

LEFT, RIGHT, TOP, BOTTOM, GAP = 0.85, 2.0, 0.4, 0.55, 0.3
"""Margins [inch]; the legends are in the right one. Last the gap between the panels."""

DASHES: Final[tuple[tuple[float, ...], ...]] = ((), (4.0, 2.0), (1.0, 1.5))
"""Of the speeds in ascending order, repeated if there are more."""

LIFTS_OFF: Final = "lifts off at [rev/min]"

EXACT: Final = Style(LIMIT, 1.0, (5.0, 3.0))

Value = Callable[[BenefitRow], float | None]


def figure(rows: Sequence[BenefitRow], *, title: str, unit: LiftUnit = "mm") -> Figure:
    """One panel each for acceleration and force at all speeds, and for the speed of lift-off.

    The output moves in `unit`. Panels without values, as of forces in a scene that has none, are
    left out.
    """
    speeds = sorted({row.speed for row in rows})
    drawn: list[tuple[str, list[Line]]] = [
        (
            f"acceleration is off [{unit}/s²]",
            _each(rows, speeds, lambda row: row.acceleration),
        ),
        ("contact force is off [N]", _each(rows, speeds, lambda row: row.force)),
        (LIFTS_OFF, _each(rows, speeds[:1], _lift_off)),
    ]
    drawn = [(label, lines) for label, lines in drawn if lines]
    exact = {row.exact_lift_off for row in rows} - {None, math.inf}
    height = TOP + BOTTOM + len(drawn) * HEIGHT + (len(drawn) - 1) * GAP
    panels = []
    for number, (label, lines) in enumerate(drawn):
        last = number == len(drawn) - 1
        bottom = BOTTOM + (len(drawn) - 1 - number) * (HEIGHT + GAP)
        rules = [Rule("y", each / RPM, EXACT) for each in exact if each and label == LIFTS_OFF]
        tolerances = [row.tolerance for row in rows]
        low, high = log_limits(heights(lines))
        named = entries(lines)
        panels.append(
            Panel(
                box(LEFT / WIDTH, bottom / height, 1.0 - (LEFT + RIGHT) / WIDTH, HEIGHT / height),
                Axis(
                    (max(tolerances) * 1.8, min(tolerances) / 1.8),
                    "tolerance [mm]" if last else "",
                    log=True,
                    numbered=last,
                ),
                Axis((low, max(high, *(1.2 * each.at for each in rules), 0.0)), label, log=True),
                (*lines, *rules),
                title="" if number else title,
                legend=Legend(named, "upper left", (1.02, 1.0), size=7.5, gap=0.0),
            )
        )
    return Figure((WIDTH, height), tuple(panels))


def _each(rows: Sequence[BenefitRow], speeds: Sequence[float], value: Value) -> list[Line]:
    lines = []
    for form in FORMS:
        for number, speed in enumerate(speeds):
            found = [
                (row.tolerance, shown)
                for row in rows
                if (row.form, row.speed) == (form, speed)
                and (shown := value(row)) is not None
                and 0.0 < shown < math.inf
            ]
            if not found:
                continue
            colour = COLOURS[form]
            style = Style(
                colour, 0.8, DASHES[number % len(DASHES)], MARKERS[form], 4.0, colour, colour
            )
            at = f", {speed / RPM:g} rev/min" if len(speeds) > 1 else ""
            lines.append(Line(over(*zip(*found, strict=True)), style, f"{form}{at}"))
    return lines


def _lift_off(row: BenefitRow) -> float | None:
    return None if row.lift_off is None else row.lift_off / RPM
