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
    LEFT,
    LIMIT_STYLE,
    LINE,
    MARGINS,
    RIGHT,
    TOP,
    ZERO,
    cam_angles,
    joint_marks,
    turn_axis,
)
from camgeo.motion.joints import breaks
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.product.product import Product
from camgeo.units import TURN, LengthUnit, unit_in

if TYPE_CHECKING:  # unused in a picture without effects
    from camgeo.effects.effect import Column

WIDTH: Final = 7.0
"""Width of the figure [inch]."""

PANEL: Final = 1.7
"""Height of a panel [inch]."""

ROWS: Final = 7
"""Most panels one above the other, as many as a screen shows; more stand in further columns."""

NARROW, BETWEEN = 4.2, 1.0
"""Width of a panel of several columns, and the gap between two, with room for numbers [inch]."""

GAP: Final = 0.2
"""Gap between two panels [inch], with room for the power of ten of the lower one."""

NAME_PLACE: Final = 0.6
"""Distance [inch] of the titles from the vertical axes, to the left."""

PLAIN: Final = (-3, 5)
"""Powers of ten between which numbers are written in full; longer ones would overlap the title."""

ABREAST: Final = (3, 2)
"""Largest number of curve names in a row, of one column of panels and of several."""

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
    """The columns of all effects, adjacent ones of equal unit in one panel, read downwards.

    The curves jump where the effects do: both sides of the joints of the motion and of the breaks
    of the effects are drawn.
    """
    groups = panels(product.columns())
    count = max(1, len(groups))
    columns = -(-count // ROWS)
    rows = -(-count // columns)
    if size is None:
        across = LEFT + RIGHT + columns * NARROW + (columns - 1) * BETWEEN
        width = WIDTH if columns == 1 else across
        size = width, TOP + rows * PANEL + (rows - 1) * GAP + BOTTOM
    panel = (size[0] - LEFT - RIGHT - (columns - 1) * BETWEEN) / columns
    found = grid(size, MARGINS, rows, columns, (GAP / PANEL, BETWEEN / panel))
    frames = [found[row * columns + column] for column in range(columns) for row in range(rows)]
    title = f"{product.name}: effects"
    if not groups:
        words = "no effect in the scene has values over the cam angle"
        whole = Axis((0.0, 1.0))
        text = Text(words, (0.5, 0.5), 9.0, across="center")
        return Figure(size, (Panel(frames[0], whole, whole, (text,), title, bare=True),))
    places = np.array([joint.cam_angle for joint in breaks(product.cam.drive.plan)])
    abreast = ABREAST[min(columns, 2) - 1]
    ends = {*range(rows - 1, count, rows), count - 1}
    made = tuple(
        _panel(product, frame, group, places, last=number in ends, abreast=abreast)
        for number, (frame, group) in enumerate(zip(frames, groups, strict=False))
    )
    if columns == 1:
        return Figure(size, (replace(made[0], title=title), *made[1:]))
    at = 0.5, 1.0 - 0.1 / size[1]
    return Figure(size, made, (Text(title, at, 11.0, "figure", across="center", up="top"),))


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
    product: Product,
    frame: Frame,
    group: Sequence[Column],
    places: FloatArray,
    *,
    last: bool,
    abreast: int,
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
    rows = -(-len(found) // abreast)  # of names, in a strip above the curves
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
        legend=Legend(found, "upper right", None, min(len(found), abreast), 7.5, pad=0.3),
    )


def shown_unit(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The display unit for a column's `unit`, and the factor from `unit` to it."""
    unit, divisor = unit_in(unit, length)
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit, 1.0 / divisor


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
