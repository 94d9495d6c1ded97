"""The effects in the scene over the cam angle, with their limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.figure.layout import Size, grid, limits
from camgeo.figure.marks import Line, Mark, Rule, Style, Text, over
from camgeo.figure.model import Axis, Figure, Frame, Legend, Panel, entries
from camgeo.figure.style import (
    BOTTOM,
    LIMIT_STYLE,
    LINE,
    MARGINS,
    TOP,
    ZERO,
    cam_angles,
    joint_marks,
    turn_axis,
)
from camgeo.motion.joints import breaks
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.product.product import Product
from camgeo.units import MM_PER, TURN, LengthUnit

if TYPE_CHECKING:  # unused in a picture without effects
    from camgeo.effects.effect import Column

WIDTH: Final = 7.0
"""Width of the figure [inch]."""

PANEL: Final = 1.7
"""Height of a panel [inch]."""

GAP: Final = 0.2
"""Gap between two panels [inch], with room for the power of ten of the lower one."""

NAME_PLACE: Final = 0.6
"""Distance [inch] of the titles from the vertical axes, to the left."""

PLAIN: Final = (-3, 5)
"""Powers of ten between which numbers are written in full; longer ones would overlap the title."""

ABREAST: Final = 3
"""Largest number of curve names in a row."""

HEADROOM: Final = 0.17
"""Space above the curves for each row of names, as a fraction of their range."""

CURVES: Final = (
    Style(LINE),
    Style("#c27c0e", dashes=(6.0, 1.5)),
    Style("#3f8f6b", dashes=(4.0, 1.5, 1.0, 1.5)),
    Style("#7a7a7a", dashes=(1.0, 1.0)),
)
"""Styles of the curves of a panel; a panel has no more curves than styles."""


def figure(product: Product, size: Size | None = None) -> Figure:
    """The columns of all effects, adjacent ones of equal unit in one panel.

    The curves jump where the effects do: both sides of the joints of the motion and of the breaks
    of the effects are drawn.
    """
    groups = panels(product.columns())
    count = max(1, len(groups))
    size = size or (WIDTH, TOP + count * PANEL + (count - 1) * GAP + BOTTOM)
    frames = grid(size, MARGINS, count, gaps=(GAP / PANEL, 0.0))
    title = f"{product.name}: effects"
    if not groups:
        words = "no effect in the scene has values over the cam angle"
        whole = Axis((0.0, 1.0))
        text = Text(words, (0.5, 0.5), 9.0, across="center")
        return Figure(size, (Panel(frames[0], whole, whole, (text,), title, bare=True),))
    places = np.array([joint.cam_angle for joint in breaks(product.cam.drive.plan)])
    first, *others = (
        _panel(product, frame, group, places, last=group is groups[-1])
        for frame, group in zip(frames, groups, strict=True)
    )
    return Figure(size, (replace(first, title=title), *others))


def panels(columns: Sequence[Column]) -> list[list[Column]]:
    """The columns in groups of adjacent ones with equal unit, at most one per curve style."""
    found: list[list[Column]] = []
    for column in columns:
        if found and found[-1][0].unit == column.unit and len(found[-1]) < len(CURVES):
            found[-1].append(column)
        else:
            found.append([column])
    return found


def _panel(
    product: Product, frame: Frame, group: Sequence[Column], places: FloatArray, *, last: bool
) -> Panel:
    shown, scale = shown_unit(group[0].unit, product.unit)
    marks: list[Mark] = [ZERO]
    drawn: list[FloatArray] = []
    for column, style in zip(group, CURVES, strict=False):
        phi, values = sampled(column, places)
        drawn.append(values * scale)
        marks.append(Line(over(np.degrees(phi), drawn[-1]), style, column.name))
    named = {each.limit: each.name for each in group if each.limit is not None}
    for limit, name in named.items():
        label = f"limit {limit * scale:.5g}" if len(group) == 1 else f"limit, {name}"
        marks.append(Rule("y", limit * scale, LIMIT_STYLE, label))
    found = entries(marks)
    low, high = limits([0.0, *drawn], [limit * scale for limit in named])
    rows = -(-len(found) // ABREAST)  # of names, in a strip above the curves
    return Panel(
        frame,
        turn_axis(numbered=last),
        Axis(
            (low, high + HEADROOM * rows * (high - low)),
            f"[{shown}]" if shown else "",
            powers=PLAIN,
            label_place=NAME_PLACE,  # aligned over all panels, whatever the width of the numbers
        ),
        (*marks, *joint_marks(product.cam.drive.joints)),
        legend=Legend(found, "upper right", None, min(len(found), ABREAST), 7.5, pad=0.3),
    )


def shown_unit(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The display unit for a column's `unit`, and the factor from `unit` to it."""
    scale = 1.0
    if unit == "mm" or unit.startswith("mm/"):
        unit, scale = length + unit.removeprefix("mm"), 1.0 / MM_PER[length]
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit, scale


def sampled(column: Column, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cam angles [rad] over one turn, ascending, and values (n,), (n,) of `column`.

    Each of `places` [rad] and of the column's own breaks occurs twice: with the left-hand value,
    then with the right-hand one. So does the start of the turn, with the value of its end.
    """
    ends = np.array([0.0, TURN])
    borders = np.concatenate((places, column.borders))
    borders = merged(np.concatenate((ends, borders[(borders > 0.0) & (borders < TURN)])))
    samples = cam_angles()
    inside = merged(np.concatenate((samples, borders)))[:-1]
    right = column.values(inside, "right")
    left = column.values(borders[1:], "left")
    phi = np.concatenate((ends[:1], borders[1:], inside))
    values = np.concatenate((left[-1:], left, right))
    # Left-hand values come first, and a stable sort keeps this order.
    order = np.argsort(phi, kind="stable")
    return phi[order], values[order]
