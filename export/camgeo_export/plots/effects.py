"""The effects that the scene calls for, over the cam angle, with their limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from camgeo.files.product import Product
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.units import MM_PER, TURN, LengthUnit
from camgeo_export.plots.style import (
    BOTTOM,
    LEFT,
    LIMIT,
    LINE,
    TOP,
    cam_angles,
    frame,
    over_cam_angle,
)

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

CURVES: Final[tuple[dict[str, Any], ...]] = (
    {"color": LINE, "linestyle": "-"},
    {"color": "#c27c0e", "linestyle": (0, (6, 1.5))},
    {"color": "#3f8f6b", "linestyle": (0, (4, 1.5, 1, 1.5))},
    {"color": "#7a7a7a", "linestyle": (0, (1, 1))},
)
"""How the curves of a panel differ; one with more of them is parted."""


def size(product: Product) -> tuple[float, float]:
    """Width and height [inch] of the figure on its own: a panel for each group of curves."""
    count = max(1, len(panels(product.effect_columns)))
    return (WIDTH, TOP + count * PANEL + (count - 1) * GAP + BOTTOM)


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw the columns of all effects, neighbours of one unit in one panel.

    Where an effect jumps, the curve does: both sides of the joints of the motion and of the
    effect's own borders are drawn.
    """
    groups = panels(product.effect_columns)
    title = f"{product.name}: effects"
    if not groups:
        axes = figure.subplots(gridspec_kw=frame(figure))
        axes.set_axis_off()
        axes.set_title(title)
        axes.text(0.5, 0.5, "no effect of the scene has values over the cam angle", ha="center")
        return
    spacing = {**frame(figure), "hspace": GAP / PANEL}
    rows = figure.subplots(len(groups), 1, squeeze=False, gridspec_kw=spacing)[:, 0]
    breaks = np.array([joint.cam_angle for joint in product.plan_sketch.breaks])
    across = figure.bbox.width / figure.dpi * spacing["right"] - LEFT
    for index, (axes, group) in enumerate(zip(rows, groups, strict=True)):
        _draw_panel(axes, group, product.unit, breaks)
        over_cam_angle(axes, product.joints, label=index == len(groups) - 1)
        # aligned down the page, whatever the width of their numbers
        axes.yaxis.set_label_coords(-NAME_PLACE / across, 0.5)
    rows[0].set_title(title)


def panels(columns: Sequence[Column]) -> list[list[Column]]:
    """The columns in groups of neighbours with the same unit, no larger than a panel can tell."""
    found: list[list[Column]] = []
    for column in columns:
        if found and found[-1][0].unit == column.unit and len(found[-1]) < len(CURVES):
            found[-1].append(column)
        else:
            found.append([column])
    return found


def _draw_panel(axes: Axes, group: Sequence[Column], unit: LengthUnit, breaks: FloatArray) -> None:
    axes.axhline(0.0, color="black", linewidth=0.5)
    told, scale = shown_unit(group[0].unit, unit)
    for column, style in zip(group, CURVES, strict=False):
        phi, values = course(column, breaks)
        axes.plot(np.degrees(phi), values * scale, label=column.name, **style)
    for limit, name in {each.limit: each.name for each in group if each.limit is not None}.items():
        label = f"limit {limit * scale:.5g}" if len(group) == 1 else f"limit, {name}"
        axes.axhline(limit * scale, color=LIMIT, linestyle="--", linewidth=1.0, label=label)
    axes.set_ylabel(f"[{told}]" if told else "")
    axes.ticklabel_format(axis="y", scilimits=PLAIN)
    _name_curves(axes)


def _name_curves(axes: Axes) -> None:
    """The legend, in a strip of its own above the curves."""
    entries = len(axes.get_legend_handles_labels()[1])
    rows = -(-entries // ABREAST)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + HEADROOM * rows * (high - low))
    axes.legend(loc="upper right", ncols=min(entries, ABREAST), borderpad=0.3, fontsize=7.5)


def shown_unit(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The unit that is written for a column's `unit`, and how many of it are one of that."""
    scale = 1.0
    if unit == "mm" or unit.startswith("mm/"):
        unit, scale = length + unit.removeprefix("mm"), 1.0 / MM_PER[length]
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit, scale


def course(column: Column, breaks: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cam angles [rad] over one turn, ascending, and values (n,), (n,) of `column`.

    Each of `breaks` and of the column's own borders is there twice: with the left-hand value, then
    with the right-hand one. So is the start of the turn, with the value of its end.
    """
    ends = np.array([0.0, TURN])
    borders = np.concatenate((breaks, column.borders))
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
