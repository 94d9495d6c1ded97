"""The motion diagram: lift and three derivatives with their extremes, and over time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.cam.drive import Drive
from camgeo.figure.layout import Strips, limits
from camgeo.figure.marks import Box, Line, Mark, Style, Text, over
from camgeo.figure.model import Axis, Panel
from camgeo.figure.style import CURVE, LIMIT, ZERO, diagram_angles, joint_marks, turn_axis
from camgeo.motion.joints import breaks, joints
from camgeo.numeric.arrays import FloatArray

MARKS: Final = ("", "′", "″", "‴")
RATES: Final = {"s": ("", "v", "a", "jerk"), "ψ": ("", "dψ/dt", "d²ψ/dt²", "d³ψ/dt³")}
RAISED: Final = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
OVER_ANGLE: Final = ("", "/rad", "/rad²", "/rad³")
OVER_TIME: Final = ("", "/s", "/s²", "/s³")

PANEL, GAP = 1.3, 0.09
"""Heights [inch] of each panel and of the gap between two."""

HEIGHT: Final = 4 * PANEL + 3 * GAP

NAME_PLACE: Final = 0.6
"""Distance [inch] of the names of the vertical axes to the left of them."""

SECOND_PLACE: Final = 0.09
"""Distance of the names of the second scales, as a fraction of the width."""

SMALL: Final = 7.5
"""Size of the text of plan and diagram [points]."""

HEADROOM: Final = 0.28
"""Space above the curve of a panel for the extremes, as a fraction of its range."""

CLOSER: Final = 101
"""Points between two neighbours of an extreme: half a degree in steps of 0.005 degrees."""

SAME: Final = 1e-10
"""Values that differ by less than this fraction of the largest are the same extreme."""

INFINITE: Final = Style(LIMIT, 0.0, marker="^", size=5.5)

ValuesAt = Callable[[FloatArray], FloatArray]
"""Values at cam angles [rad], in the unit of the panel."""


@dataclass(frozen=True, slots=True)
class Unit:
    """How a length or angle is written: its unit, symbol, and units per mm or rad."""

    name: str
    symbol: str
    scale: float


def panels(strips: Strips, drive: Drive, unit: Unit, speed: float | None) -> list[Panel]:
    """A panel for the lift and each derivative; with a constant `speed` [rad/s] also over time."""
    places = tuple(joint.cam_angle for joint in joints(drive.plan))
    phi = diagram_angles(tuple(joint.cam_angle for joint in breaks(drive.plan)))
    found = []
    for order, mark in enumerate(MARKS):
        if order:
            strips.skip(GAP)

        def values_at(angles: FloatArray, order: int = order) -> FloatArray:
            values: FloatArray = drive.motion.jet(angles)[order] * unit.scale
            return values

        values = values_at(phi)
        low, high = limits([values, 0.0])
        shown = low, high + HEADROOM * (high - low)
        # From the value at the end of the turn: a jump at cam angle 0 is drawn like the others.
        curve = over([0.0, *np.degrees(phi)], [values[-1], *values])
        infinite = [math.degrees(angle) for angle in infinite_at(drive, order)]
        marks: list[Mark] = [ZERO, Line(curve, CURVE), *joint_marks(places)]
        marks.append(_extremes(values_at, phi))
        if infinite:
            zeros = np.zeros(len(infinite))
            marks.append(Line(over(infinite, zeros), INFINITE, layer=4.0, clipped=False))
        label = f"{unit.symbol}{mark} [{unit.name}{OVER_ANGLE[order]}]"
        found.append(
            Panel(
                strips.frame(PANEL),
                turn_axis(numbered=order == 3),
                # aligned down the page, whatever the width of their numbers
                Axis(shown, label, label_place=NAME_PLACE),
                tuple(marks),
                right=None
                if speed is None or not order
                else _second_scale(shown, unit, order, speed, strips.across),
            )
        )
    return found


def infinite_at(drive: Drive, order: int) -> list[float]:
    """Cam angles [rad] at which the derivative is infinite because a lower one jumps."""
    return [joint.cam_angle for joint in breaks(drive.plan) if joint.order + 1 < order]


def number(value: float) -> str:
    """Four digits, or all digits before the point if there are more."""
    text = f"{value:.0f}" if 1e3 <= abs(value) < 1e7 else f"{value + 0.0:.4g}"
    return text.replace("-", "−")


def _extremes(values_at: ValuesAt, phi: FloatArray) -> Text:
    """Largest and smallest value with the first place of each, to the digits written.

    They are searched for between the neighbours of the largest of the drawn points.
    """
    values = values_at(phi)
    size = float(np.max(np.abs(values)))
    lines = []
    for word, sign in (("max", 1.0), ("min", -1.0)):
        index = int(np.argmax(sign * values))
        around = slice(max(index - 1, 0), index + 2)
        closer = np.unique(
            np.concatenate((phi, np.linspace(phi[around][0], phi[around][-1], CLOSER)))
        )
        found = values_at(closer)
        extreme = float(np.max(sign * found)) * sign
        first = np.argmax(np.abs(found - extreme) <= SAME * size)
        lines.append(f"{word} {number(extreme)} at {math.degrees(closer[first]):.1f}°")
    return Text(
        ",  ".join(lines), (0.99, 0.95), SMALL, "panel", across="right", up="top", box=Box(1.0)
    )


def _second_scale(
    shown: tuple[float, float], unit: Unit, order: int, speed: float, across: float
) -> Axis:
    """The derivative over time at a constant speed."""
    factor = speed**order
    low, high = (limit * factor for limit in shown)
    size = max(abs(low), abs(high))
    thousands = max(0, math.floor(math.log10(size) / 3.0)) if size > 0.0 else 0
    power = f"10{str(3 * thousands).translate(RAISED)} " if thousands else ""
    return Axis(
        (low / 1000.0**thousands, high / 1000.0**thousands),
        f"{RATES[unit.symbol][order]} [{power}{unit.name}{OVER_TIME[order]}]",
        label_size=8.5,
        label_place=SECOND_PLACE * across,
    )
