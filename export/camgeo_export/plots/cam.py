"""The cam: disc with bore, pitch curve, base circle, and the roller or face at cam angle 0.

The disc is the real one: what is cut off from an undercut flank is drawn beside it. Of a conjugate
pair the return disc and its roller are drawn over the main disc, dashed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.path import Path

from camgeo.errors import GeometryError, UndercutError
from camgeo.files.product import Product
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Part
from camgeo.units import MM_PER
from camgeo_export.plots import cut_off, disc, flanks
from camgeo_export.plots.style import AUXILIARY, LINE, RETURN_STYLE, cam_angles, frame

SAGITTA = 1e-4
"""Chords of the picture, relative to the base radius: far below a printed line."""

PITCH_STYLE: Any = {"color": AUXILIARY, "linewidth": 1.0, "dashes": (10, 3, 2, 3)}
BASE_STYLE: Any = {"color": AUXILIARY, "linewidth": 0.8, "dashes": (5, 4)}

FACE = 2.4
"""Width of the line that is a flat face [pt]."""

ARROW = np.radians(np.linspace(200.0, 320.0, 61))
"""Directions [rad] of the arrow about the axis."""

KNIFE = 0.1
"""Size by which a knife edge is drawn, which has none, relative to the base radius."""

BELOW = 0.452
"""Distance of the legend from the axes [inch], room for their label and numbers."""

size = (7.0, 7.0)


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw the cam at cam angle 0, to scale, in the product's unit."""
    axes = figure.subplots(gridspec_kw=frame(figure, bottom=0.95))
    axes.set_aspect("equal")
    scale = 1.0 / MM_PER[product.unit]
    part = _part(product)
    found = product.cut_off
    if part is None:
        lines = flanks.draw(axes, product, found, scale)
    else:
        lines = disc.draw(axes, part, scale, SAGITTA * product.base_radius)
    if product.returning is not None:
        lines = [*lines, *_return_disc(axes, product.returning, scale)]
    columns = product.curve("pitch", cam_angles()) * scale
    pitch = columns[:, 0] + 1j * columns[:, 1]
    if not product.is_flat:
        axes.plot(pitch.real, pitch.imag, **PITCH_STYLE)
    base = product.base_radius * scale
    circle = base * np.exp(1j * cam_angles())
    axes.plot(circle.real, circle.imag, **BASE_STYLE)
    if found:
        cut_off.draw(axes, found, scale)
    roller = complex(pitch[0])
    end = (_flat if product.is_flat else _follower)(axes, product, roller, scale)
    _rotation_arrow(axes, product.rotation, 0.45 * base)
    _centre_mark(axes, 0.1 * base)
    drawn = [*lines, circle, pitch, *(each.course * scale for each in found)]
    radius = _size(product) * scale
    ends = [point * scale for point in product.follower_sketch.face or ()]
    guide = np.array([roller, end, *ends])
    _frame(axes, [*drawn, guide], roller, radius)
    if found:
        size = max(float(np.ptp(line.real)) for line in lines) / scale
        mark = 0.1 * base * np.array([-1.0, 1.0, 0.0, 1j, -1j])
        drawn += [guide, mark, roller + radius * np.exp(1j * cam_angles())]
        drawn += [0.45 * base * np.exp(1j * ARROW), *(flanks.note(axes) if part is None else ())]

        def window(inset: Axes, middle: complex, width: float) -> None:
            if part is None:
                flanks.draw_near(inset, product, found, middle, width)
            else:
                disc.draw_near(inset, part, middle, width)

        cut_off.enlarge(axes, found, drawn, size, scale, window)
    axes.set_xlabel(f"x [{product.unit}]")
    axes.set_ylabel(f"y [{product.unit}]")
    axes.set_title(product.name)
    if part is None:
        edges, marks = (
            Line2D([], [], label="flanks", **flanks.FLANK),
            flanks.handles(product, found),
        )
    else:
        edges = Line2D([], [], color=LINE, linewidth=disc.EDGE, label="edges of the disc")
        marks = cut_off.handles("cut off") if found else []
    if product.returning is not None:
        edges.set_label("edges of the main disc")
        marks = [Line2D([], [], label="return disc and its roller", **RETURN_STYLE), *marks]
    _legend(axes, figure, edges, marks, product)


def _part(product: Product) -> Part | None:
    """None if there is no disc."""
    try:
        return product.part
    except UndercutError:
        return None


def _return_disc(axes: Axes, disc: Product, scale: float) -> list[ComplexArray]:
    """Flank of the return disc, its roller at cam angle 0 and what holds that; returns the lines.

    The flank is drawn as it runs, whole: its own picture shows what is cut off from it.
    """
    try:
        flank = disc.curve("inner", cam_angles())
    except GeometryError:  # the roller centre stands still in the cam, which the findings tell
        flank = np.empty((0, 2))
    columns = np.concatenate([flank, disc.curve("pitch", np.zeros(1))]) * scale
    points = columns[:, 0] + 1j * columns[:, 1]
    roller = complex(points[-1])
    rim = roller + disc.roller_radius * scale * np.exp(1j * cam_angles())
    sketch = disc.follower_sketch
    lines = [points[:-1], rim]
    if sketch.kind == "pivot":
        lines.append(np.array([roller, sketch.end * scale]))
    for line in lines:
        axes.plot(line.real, line.imag, zorder=2.8, **RETURN_STYLE)
    axes.plot(roller.real, roller.imag, "+", color=RETURN_STYLE["color"], markersize=6, zorder=2.8)
    return lines


def _legend(
    axes: Axes,
    figure: Figure | SubFigure,
    edges: Line2D,
    marks: list[Line2D],
    product: Product,
) -> None:
    base = Line2D([], [], label="base circle", **BASE_STYLE)
    if product.is_flat:
        face = Line2D([], [], color="black", linewidth=FACE, label="face at φ = 0")
        handles = [edges, base, face, *marks]
    else:
        round_ = product.roller_radius > 0.0
        roller = Line2D(
            [], [], linestyle="none", marker="o" if round_ else "+", markersize=9,
            markerfacecolor="white", markeredgecolor="black",
            label=f"{'roller' if round_ else 'knife edge'} at φ = 0",
        )  # fmt: skip
        handles = [edges, Line2D([], [], label="pitch curve", **PITCH_STYLE), base, roller, *marks]
    axes.apply_aspect()
    height = axes.get_position().height * figure.bbox.height / figure.dpi
    axes.legend(
        handles=handles, loc="upper center", bbox_to_anchor=(0.5, -BELOW / height), ncols=4,
        borderaxespad=0.0,
    )  # fmt: skip


def _size(product: Product) -> float:
    """Radius [mm] of the roller, or the size by which a knife edge is drawn."""
    return product.roller_radius or KNIFE * product.base_radius


def _follower(axes: Axes, product: Product, roller: complex, scale: float) -> complex:
    """The roller at cam angle 0 and the line to its pivot, or along its guide; where that ends."""
    radius = _size(product) * scale
    sketch = product.follower_sketch
    end = sketch.end * scale
    along = (end - roller) / abs(end - roller)
    if sketch.kind == "guide":
        end = roller + 3.5 * radius * along
        # a short bar on each side stands for the guide
        for side in (0.3j, -0.3j):
            _segment(axes, end + (side - 1.5) * radius * along, end + side * radius * along, 2.4)
    _segment(axes, roller, end, 1.2)
    if product.roller_radius > 0.0:
        axes.add_patch(
            Circle((roller.real, roller.imag), radius, facecolor="white", edgecolor="black",
                   linewidth=1.2, zorder=4)
        )  # fmt: skip
    axes.plot(roller.real, roller.imag, "+", color="black", markersize=6, zorder=5)
    if sketch.kind == "pivot":
        axes.plot(
            end.real, end.imag, "o", color="black", markerfacecolor="white", markersize=6, zorder=5
        )
    return end


def _flat(axes: Axes, product: Product, contact: complex, scale: float) -> complex:
    """The flat face at cam angle 0, with the stem along its guide or the lever to its pivot."""
    sketch = product.follower_sketch
    assert sketch.face is not None  # of a flat follower
    start, stop = (point * scale for point in sketch.face)
    end = sketch.end * scale
    # A follower that never moves needs no length of face: its stem stands on the contact.
    along = (stop - start) / abs(stop - start) if stop != start else 0j
    foot = start + along * ((end - start) * along.conjugate()).real
    _segment(axes, start, stop, FACE)
    _segment(axes, foot, end, 1.2)
    axes.plot(contact.real, contact.imag, "+", color="black", markersize=6, zorder=5)
    if sketch.kind == "pivot":
        axes.plot(
            end.real, end.imag, "o", color="black", markerfacecolor="white", markersize=6, zorder=5
        )
    return end


def _segment(axes: Axes, start: complex, end: complex, width: float) -> None:
    axes.plot(
        [start.real, end.real], [start.imag, end.imag], color="black", linewidth=width, zorder=3
    )


def _rotation_arrow(axes: Axes, rotation: int, radius: float) -> None:
    """An arc with a head around the axis, in the sense in which the disc turns."""
    angles = ARROW[:: 1 if rotation > 0 else -1]
    curve = Path(np.column_stack((radius * np.cos(angles), radius * np.sin(angles))))
    axes.add_patch(
        FancyArrowPatch(path=curve, arrowstyle="-|>", mutation_scale=12, color="black",
                        linewidth=1.0, zorder=4)
    )  # fmt: skip


def _centre_mark(axes: Axes, half: float) -> None:
    axes.plot([-half, half], [0.0, 0.0], color=AUXILIARY, linewidth=0.8)
    axes.plot([0.0, 0.0], [-half, half], color=AUXILIARY, linewidth=0.8)


def _frame(axes: Axes, rings: list[ComplexArray], roller: complex, radius: float) -> None:
    """Limits around all that is drawn."""
    points = np.concatenate([*rings, roller + radius * np.exp(1j * cam_angles())])
    reach = 0.06 * max(np.ptp(points.real), np.ptp(points.imag))
    axes.set_xlim(points.real.min() - reach, points.real.max() + reach)
    axes.set_ylim(points.imag.min() - reach, points.imag.max() + reach)
