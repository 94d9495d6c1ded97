"""A measured flank over the cam angle: its deviations, and the error of the lift."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import (
    AUXILIARY,
    LIMIT_STYLE,
    LINE,
    MARGINS,
    ZERO,
    Axis,
    Figure,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    entries,
    grid,
    joint_marks,
    limits,
    over,
    turn_axis,
)
from camgeo.studies.inspection import Deviations, LiftErrors

SIZE: Final = (7.0, 5.6)
ONE: Final = (7.0, 3.4)
"""Without lift errors."""

LEFT: Final = 0.95
"""Margin [inch] with room for small numbers."""

MEASURED: Final = Style(LINE, 0.9, marker="o", size=2.0)
ERROR: Final = Style(AUXILIARY, 1.2)

GAP: Final = 10.0
"""Range of cam angle [degrees] without points over which no line is drawn."""

Scale = tuple[str, float]
"""A unit, and how many of it make a mm or a rad."""


def figure(
    deviations: Deviations,
    lift: LiftErrors | None,
    *,
    title: str,
    unit: Scale,
    lift_unit: Scale,
    tolerance: float | None,
    joints: tuple[float, ...],
) -> Figure:
    """Deviations, positive for more material, with the zone that is allowed, and lift errors.

    Parameters
    ----------
    tolerance : width of the zone [mm].
    joints : cam angles [rad] to mark.
    """
    name, scale = unit
    order = np.argsort(deviations.places.phi, kind="stable")
    values = deviations.values[order] * scale
    rules = [] if tolerance is None else [0.5 * tolerance * scale, -0.5 * tolerance * scale]
    phi = np.degrees(deviations.places.phi[order])
    wide = np.flatnonzero(np.diff(phi) > GAP) + 1
    drawn = over(np.insert(phi, wide, np.nan), np.insert(values, wide, np.nan))
    marks: list[Mark] = [
        ZERO,
        Line(drawn, MEASURED, "measured"),
        *(Rule("y", at, LIMIT_STYLE, "allowed" * (at > 0.0)) for at in rules),
    ]
    rows = 1 if lift is None else 2
    size = ONE if lift is None else SIZE
    frames = grid(size, (LEFT, *MARGINS[1:]), rows, gaps=(0.12, 0.0))
    first = Panel(
        frames[0],
        turn_axis(numbered=lift is None),
        _axis(values, rules, f"deviation [{name}]"),
        (*marks, *joint_marks(joints)),
        title=title,
        title_size=9.0,
        legend=Legend(entries(marks)),
    )
    if lift is None:
        return Figure(size, (first,))
    name, scale = lift_unit
    errors = lift.errors * scale
    second = Panel(
        frames[1],
        turn_axis(),
        _axis(errors, [], f"lift error [{'°' if name == 'deg' else name}]"),
        (ZERO, Line(over(np.degrees(lift.phi), errors), ERROR), *joint_marks(joints)),
    )
    return Figure(size, (first, second), aligned=True)


def _axis(values: FloatArray, rules: list[float], label: str) -> Axis:
    return Axis(limits([[0.0], values], rules), label, powers=(-2, 3))
