"""The motion diagram: lift and three derivatives with their extremes, and over time."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.figure.layout import Strips, limits
from camgeo.figure.marks import Box, Line, Mark, Style, Text, over
from camgeo.figure.model import Axis, Panel
from camgeo.figure.style import CURVE, LIMIT, ZERO, diagram_angles, joint_marks, turn_axis
from camgeo.motion.joints import breaks, joints
from camgeo.motion.motion import Motion
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.arrays import FloatArray

MARKS: Final = ("", "′", "″", "‴")
RATES: Final = ("", "v", "a", "jerk")
ANGULAR: Final = ("", "d{}/dt", "d²{}/dt²", "d³{}/dt³")
"""Names of the derivatives over time: of a length, and of an angle by its symbol."""

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
DOWNWARDS: Final = replace(INFINITE, marker="v")
SPIKE: Final = Style(LIMIT, 1.0)
"""How an infinite value is drawn: a line from zero to a head at the edge of the curve's range."""

SPIKES_ROOM: Final = 0.25
"""Least part of a panel on the side of zero towards which a spike points."""


@dataclass(frozen=True, slots=True)
class Unit:
    """How a length or angle is written: its unit, symbol, and units per mm or rad."""

    name: str
    symbol: str
    scale: float


@dataclass(frozen=True, slots=True)
class Infinite:
    """A place at which a derivative is infinite because a lower one jumps.

    Attributes
    ----------
    cam_angle : [rad].
    up, down : whether it is infinite upwards, downwards, or both, where more than the next lower
        derivative jumps: that of a jump's impulse goes both ways.
    """

    cam_angle: float
    up: bool
    down: bool


def panels(
    strips: Strips, plan: MotionPlan, motion: Motion, unit: Unit, speed: float | None
) -> list[Panel]:
    """A panel for the position and each derivative of `motion`, which follows from `plan`.

    With a constant `speed` [rad/s] also over time.
    """
    places = tuple(joint.cam_angle for joint in joints(plan))
    phi = diagram_angles(tuple(joint.cam_angle for joint in breaks(plan)))
    jet = motion.jet(phi) * unit.scale
    degrees = np.concatenate(([0.0], np.degrees(phi)))
    near = _near_extremes(phi, jet)
    nearby = motion.jet(near.ravel())[: len(MARKS)].reshape(len(MARKS), *near.shape) * unit.scale
    found = []
    for order, mark in enumerate(MARKS):
        if order:
            strips.skip(GAP)
        values = jet[order]
        infinite = infinite_at(plan, motion, order)
        low, high = _range(values, infinite)
        shown = low, high + HEADROOM * (high - low)
        # From the value at the end of the turn: a jump at cam angle 0 is drawn like the others.
        curve = over(degrees, np.concatenate((values[-1:], values)))
        marks: list[Mark] = [ZERO, Line(curve, CURVE), *joint_marks(places)]
        marks += _spikes(infinite, low, high)
        closer = list(zip(near[order], nearby[order, order], strict=True))
        marks.append(_extremes(phi, values, closer, infinite))
        label = f"{unit.symbol}{mark} [{unit.name}{OVER_ANGLE[order]}]"
        # A curve that is zero wherever it is finite has no scale: its range is arbitrary.
        ticks = (0.0,) if infinite and not np.any(values) else None
        second = None
        if speed is not None and order:
            second = _second_scale(shown, unit, order, speed, strips.across)
        found.append(
            Panel(
                strips.frame(PANEL),
                turn_axis(numbered=order == 3),
                # aligned down the page, whatever the width of their numbers
                Axis(shown, label, ticks=ticks, label_place=NAME_PLACE),
                tuple(marks),
                right=None if second is None else replace(second, ticks=ticks),
            )
        )
    return found


def infinite_at(plan: MotionPlan, motion: Motion, order: int) -> list[Infinite]:
    """Where the derivative of `motion` is infinite because a lower one jumps."""
    found = []
    for joint in breaks(plan):
        if joint.order + 1 < order:
            angle = np.array([joint.cam_angle])
            before, after = motion.jet(angle, "left"), motion.jet(angle)
            rises = bool(after[joint.order + 1, 0] > before[joint.order + 1, 0])
            both = joint.order + 2 < order
            found.append(Infinite(joint.cam_angle, rises or both, not rises or both))
    return found


def _range(values: FloatArray, infinite: list[Infinite]) -> tuple[float, float]:
    """Lower and upper end of the curve's range, with room for what is infinite."""
    low, high = limits([values, 0.0])
    room = SPIKES_ROOM * (high - low) / (1.0 - SPIKES_ROOM)
    if any(each.down for each in infinite):
        low = min(low, -room)
    if any(each.up for each in infinite):
        high = max(high, room)
    return low, high


def _spikes(infinite: list[Infinite], low: float, high: float) -> list[Mark]:
    """A line from zero to a head at `low` or `high` for each infinite value."""
    marks: list[Mark] = []
    for end, style, angles in (
        (high, INFINITE, [each.cam_angle for each in infinite if each.up]),
        (low, DOWNWARDS, [each.cam_angle for each in infinite if each.down]),
    ):
        at = np.degrees(angles)
        if not len(at):
            continue
        ends = np.tile([0.0, end, math.nan], len(at))
        marks.append(Line(over(np.repeat(at, 3), ends), SPIKE, layer=4.0, clipped=False))
        marks.append(Line(over(at, np.full(len(at), end)), style, layer=4.0, clipped=False))
    return marks


def number(value: float) -> str:
    """Four digits, or all digits before the point if there are more."""
    text = f"{value:.0f}" if 1e3 <= abs(value) < 1e7 else f"{value + 0.0:.4g}"
    return text.replace("-", "−")


def _near_extremes(phi: FloatArray, jet: FloatArray) -> FloatArray:
    """(rows, 2, CLOSER) cam angles between the neighbours of the largest and of the smallest value
    of each row of `jet` at `phi`.
    """
    places = np.stack((np.argmax(jet, axis=1), np.argmin(jet, axis=1)), axis=1)
    starts = phi[np.maximum(places - 1, 0)]
    ends = phi[np.minimum(places + 1, len(phi) - 1)]
    return np.linspace(starts, ends, CLOSER, axis=-1)


def _extremes(
    phi: FloatArray,
    values: FloatArray,
    closer: list[tuple[FloatArray, FloatArray]],
    infinite: list[Infinite],
) -> Text:
    """Largest and smallest value with the first place of each, to the digits written.

    They are searched for among the drawn `values` at `phi` and those `closer` to the largest and to
    the smallest of them; where a value is `infinite` no finite one is the largest.
    """
    size = float(np.max(np.abs(values)))
    lines = []
    for word, sign, (near, nearby) in zip(("max", "min"), (1.0, -1.0), closer, strict=True):
        beyond = [each.cam_angle for each in infinite if (each.up if sign > 0.0 else each.down)]
        if beyond:
            end = "∞" if sign > 0.0 else "−∞"
            lines.append(f"{word} {end} at {math.degrees(min(beyond)):.1f}°")
            continue
        found, angles = np.concatenate((values, nearby)), np.concatenate((phi, near))
        extreme = float(np.max(sign * found)) * sign
        first = float(np.min(angles[np.abs(found - extreme) <= SAME * size]))
        lines.append(f"{word} {number(extreme)} at {math.degrees(first):.1f}°")
    return Text(
        ",  ".join(lines), (0.99, 0.95), SMALL, "panel", across="right", up="top", box=Box(1.0)
    )


def _second_scale(
    shown: tuple[float, float], unit: Unit, order: int, speed: float, across: float
) -> Axis:
    """The derivative over time at a constant speed."""
    factor = speed**order
    name = RATES[order] if unit.symbol == "s" else ANGULAR[order].format(unit.symbol)
    low, high = (limit * factor for limit in shown)
    size = max(abs(low), abs(high))
    thousands = max(0, math.floor(math.log10(size) / 3.0)) if size > 0.0 else 0
    power = f"10{str(3 * thousands).translate(RAISED)} " if thousands else ""
    return Axis(
        (low / 1000.0**thousands, high / 1000.0**thousands),
        f"{name} [{power}{unit.name}{OVER_TIME[order]}]",
        label_size=8.5,
        label_place=SECOND_PLACE * across,
    )
