"""The effects that the scene calls for, over the cam angle, with their limits."""

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
from camgeo.files.product import Product
from camgeo.motion.joints import breaks
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.units import MM_PER, TURN, LengthUnit

if TYPE_CHECKING:  # a picture without effects needs nothing of them
    from camgeo.effects.effect import Column

WIDTH: Final = 7.0
"""Of the figure [inch]."""

PANEL: Final = 1.7
"""Height of a panel [inch]."""

GAP: Final = 0.2
"""Height between two panels [inch]; a power of ten of the lower one has room there."""

NAME_PLACE: Final = 0.6
"""Distance of the names of the vertical axes to the left of them [inch]."""

PLAIN: Final = (-3, 5)
"""Powers of ten between which numbers are written out; wider ones run into the name of the axis."""

ABREAST: Final = 3
"""Names of curves that stand beside each other at most."""

HEADROOM: Final = 0.17
"""Above the curves for each row of their names, as a share of their range."""

CURVES: Final = (
    Style(LINE),
    Style("#c27c0e", dashes=(6.0, 1.5)),
    Style("#3f8f6b", dashes=(4.0, 1.5, 1.0, 1.5)),
    Style("#7a7a7a", dashes=(1.0, 1.0)),
)
"""How the curves of a panel differ; one with more of them is parted."""


def figure(product: Product, size: Size | None = None) -> Figure:
    """The columns of all effects, neighbours of one unit in one panel.

    Where an effect jumps, the curve does: both sides of the joints of the motion and of the
    effect's own borders are drawn.
    """
    groups = panels(product.columns())
    count = max(1, len(groups))
    size = size or (WIDTH, TOP + count * PANEL + (count - 1) * GAP + BOTTOM)
    frames = grid(size, MARGINS, count, gaps=(GAP / PANEL, 0.0))
    title = f"{product.name}: effects"
    if not groups:
        words = "no effect of the scene has values over the cam angle"
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
    """The columns in groups of neighbours with the same unit, no larger than a panel can tell."""
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
    told, scale = shown_unit(group[0].unit, product.unit)
    marks: list[Mark] = [ZERO]
    drawn: list[FloatArray] = []
    for column, style in zip(group, CURVES, strict=False):
        phi, values = course(column, places)
        drawn.append(values * scale)
        marks.append(Line(over(np.degrees(phi), drawn[-1]), style, column.name))
    named = {each.limit: each.name for each in group if each.limit is not None}
    for limit, name in named.items():
        label = f"limit {limit * scale:.5g}" if len(group) == 1 else f"limit, {name}"
        marks.append(Rule("y", limit * scale, LIMIT_STYLE, label))
    found = entries(marks)
    low, high = limits([0.0, *drawn], [limit * scale for limit in named])
    rows = -(-len(found) // ABREAST)  # of names, in a strip of their own above the curves
    return Panel(
        frame,
        turn_axis(numbered=last),
        Axis(
            (low, high + HEADROOM * rows * (high - low)),
            f"[{told}]" if told else "",
            powers=PLAIN,
            label_place=NAME_PLACE,  # aligned down the page, whatever the width of their numbers
        ),
        (*marks, *joint_marks(product.cam.drive.joints)),
        legend=Legend(found, "upper right", None, min(len(found), ABREAST), 7.5, pad=0.3),
    )


def shown_unit(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The unit that is written for a column's `unit`, and how many of it are one of that."""
    scale = 1.0
    if unit == "mm" or unit.startswith("mm/"):
        unit, scale = length + unit.removeprefix("mm"), 1.0 / MM_PER[length]
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit, scale


def course(column: Column, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cam angles [rad] over one turn, ascending, and values (n,), (n,) of `column`.

    Each of `places` [rad] and of the column's own borders is there twice: with the left-hand value,
    then with the right-hand one. So is the start of the turn, with the value of its end.
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
    # Left-hand values stand first, and a stable sort leaves them there.
    order = np.argsort(phi, kind="stable")
    return phi[order], values[order]
