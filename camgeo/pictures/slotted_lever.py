"""Diagram of a slotted lever: phi, omega_2 and eps_2 over one revolution of the crank, with
extremes.

There is one panel per quantity, one below the other: in a single panel, as in the SAM exercise,
each would need a scale of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from camgeo.kinematics.mechanism.slotted_lever import DrivenLever, LeverExtreme, Quantity
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import (
    AUXILIARY,
    CURVE,
    SAMPLES,
    ZERO,
    Axis,
    Box,
    Figure,
    Line,
    Mark,
    Panel,
    Rule,
    Style,
    Text,
    grid,
    heights,
    limits,
    over,
    turn_axis,
)
from camgeo.units import RPM, TURN

WIDTH, HEIGHT = 7.4, 8.0
LEFT, RIGHT, TOP, BOTTOM = 0.85, 0.3, 0.85, 0.55
"""Size of the figure, and its margins [inch]."""

DEGREE_STEPS: Final = (1.0, 1.5, 3.0, 4.5, 6.0, 9.0, 10.0)
"""Steps between ticks of an angle, times a power of ten: 15, 30, 45, 60, 90 degrees."""

MOST_TICKS: Final = 7
"""Largest number of parts into which the ticks of an angle divide the axis."""

POWERS: Final = (-3, 4)
"""Powers of ten beyond which the numbers at the ticks share the power, so that they fit."""

HEADROOM: Final = 0.18
"""Space for the values above and below a curve, as a fraction of its range."""

PANELS: Final[tuple[tuple[Quantity, str, str], ...]] = (
    ("phi", "lever angle φ", "°"),
    ("omega2", "angular velocity ω$_2$", "rad/s"),
    ("eps2", "angular acceleration ε$_2$", "rad/s²"),
)
"""Quantities with name and unit, in the order of `DrivenLever.output`."""

EXTREME: Final = Style("black", 0.0, marker="o", size=4.2)
OPEN: Final = Style("black", 0.0, marker="o", size=4.2, face="white", edge="black")
STROKE: Final = Style(AUXILIARY, 0.8, (5.0, 2.0))


def figure(driven: DrivenLever) -> Figure:
    """One panel per quantity, with the extremes as dots and their values next to them."""
    size = WIDTH, HEIGHT
    theta = crank_angles(driven)
    strokes = [
        Rule("x", float(np.degrees(stroke.start)), STROKE, layer=1.5)
        for stroke in driven.strokes or ()
    ]
    panels = []
    for frame, curve, (quantity, name, unit) in zip(
        grid(size, (LEFT, RIGHT, TOP, BOTTOM), len(PANELS), gaps=(0.1, 0.0)),
        driven.output(theta),
        PANELS,
        strict=True,
    ):
        first, last = quantity == PANELS[0][0], quantity == PANELS[-1][0]
        scale = float(np.degrees(1.0)) if first else 1.0
        marks: list[Mark] = [ZERO, Line(over(np.degrees(theta), scale * curve), CURVE), *strokes]
        for extreme in driven.extremes:
            if extreme.quantity == quantity:
                marks += _marked(extreme, scale, unit)
        if first and not driven.extremes:  # R = a: phi has only limits at 0 and 360 degrees
            marks.append(Line(over([0.0, 360.0], [-90.0, 90.0]), OPEN, clipped=False))
        lines = [mark for mark in marks if isinstance(mark, Line)]
        y_limits = limits([0.0, *heights(lines)], margin=HEADROOM)
        ticks = round_ticks(y_limits, DEGREE_STEPS, MOST_TICKS) if first else None
        panels.append(
            Panel(
                frame,
                turn_axis(label="crank angle θ [°]", numbered=last),
                Axis(y_limits, f"{name} [{unit}]", ticks=ticks, powers=POWERS),
                tuple(marks),
                above=Axis((0.0, driven.turn_time), "time t [s]") if first else None,
            )
        )
    title_place = 0.5, 1.0 - 0.18 / HEIGHT
    title = Text(_title(driven), title_place, 11.0, "figure", across="center", up="top")
    return Figure(size, tuple(panels), (title,), aligned=True)


def crank_angles(driven: DrivenLever) -> FloatArray:
    """Crank angles of the curves within one revolution [rad], ascending.

    They are dense where the pin passes near the lever's axis: there everything changes within about
    the angle at which the acceleration is largest, which may be far less than the step elsewhere.
    For R = a the ends are left out, where phi is undefined.
    """
    uniform = np.linspace(0.0, TURN, SAMPLES)
    if not driven.extremes:
        return uniform[1:-1]
    peak = driven.lever.largest_acceleration.place
    near = peak * np.geomspace(1e-2, 1e3, 401)
    near = near[near < np.pi]
    places = [extreme.crank for extreme in driven.extremes]
    return np.unique(np.concatenate((uniform, near, TURN - near, places)))


def _marked(extreme: LeverExtreme, scale: float, unit: str) -> list[Mark]:
    """A dot at the extreme, its value and its crank angle outside the curve."""
    place, value = float(np.degrees(extreme.crank)), scale * extreme.value
    places = [place, 360.0] if place == 0.0 else [place]  # the same extreme again, one turn later
    number = f"{value + 0.0:.5g}".replace("-", "−")
    space = "" if unit == "°" else " "
    left = place <= 180.0
    inside = 60.0 < place < 300.0
    return [
        Line(over(places, [value] * len(places)), EXTREME, layer=3.0, clipped=False),
        Text(
            f"{number}{space}{unit} at {place:.4g}°",
            (place, value),
            8.0,
            offset=(0.0 if inside else 7.0 if left else -7.0, 6.0 if extreme.largest else -6.0),
            across="center" if inside else "left" if left else "right",
            up="bottom" if extreme.largest else "top",
            box=Box(0.8, 0.85),
            layer=4.0,
        ),
    ]


def _title(driven: DrivenLever) -> str:
    lever = driven.lever
    kind = "swinging" if lever.swings else "R = a" if lever.crank == lever.distance else "turning"
    lengths = f"a = {lever.distance:.6g} mm, R = {lever.crank:.6g} mm"
    speed = f"{driven.speed / RPM:.6g} rev/min"
    ratio = f", time ratio {lever.time_ratio:.4g}" if lever.swings else ""
    return f"Slotted lever, {kind}: {lengths}, {speed}{ratio}"


def round_ticks(
    limits: tuple[float, float], steps: Sequence[float], parts: int
) -> tuple[float, ...]:
    """Multiples within `limits` of the smallest step that divides them into at most `parts`.

    Parameters
    ----------
    steps : from 1 to 10 in ascending order; a step is one of them times a power of ten.
    """
    low, high = limits
    least = (high - low) / parts
    power = 10.0 ** math.floor(math.log10(least))
    step = next(factor * power for factor in steps if factor * power >= least)
    first, last = math.ceil(low / step), math.floor(high / step)
    return tuple(number * step for number in range(first, last + 1))
