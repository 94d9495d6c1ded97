"""The cam: disc with bore, pitch curve, base circle, and the roller at cam angle 0."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, PathPatch
from matplotlib.path import Path

from camgeo.errors import UndercutError
from camgeo.files.product import Product
from camgeo.numeric.arrays import ComplexArray
from camgeo.units import MM_PER
from camgeo_export.plots.style import AUXILIARY, LINE, cam_angles, frame

SAGITTA = 1e-4
"""Chords of the picture, relative to the base radius: far below a printed line."""

BODY = "#e4e8ec"
GROOVE = "#c2cad3"

PITCH_STYLE: Any = {"color": AUXILIARY, "linewidth": 1.0, "dashes": (10, 3, 2, 3)}
BASE_STYLE: Any = {"color": AUXILIARY, "linewidth": 0.8, "dashes": (5, 4)}

size = (7.0, 7.0)


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw the cam at cam angle 0, to scale, in the product's unit."""
    axes = figure.subplots(gridspec_kw=frame(figure, bottom=0.95))
    axes.set_aspect("equal")
    scale = 1.0 / MM_PER[product.unit]
    rings = _draw_part(axes, product, scale)
    pitch = product.curve("pitch", cam_angles()) * scale
    axes.plot(pitch[:, 0], pitch[:, 1], **PITCH_STYLE)
    base = product.base_radius * scale
    circle = base * np.exp(1j * cam_angles())
    axes.plot(circle.real, circle.imag, **BASE_STYLE)
    start = product.curve("pitch", np.zeros(1))[0] * scale
    roller = complex(start[0], start[1])
    end = _follower(axes, product, roller, scale)
    _rotation_arrow(axes, product.rotation, 0.45 * base)
    _centre_mark(axes, 0.1 * base)
    drawn = [*rings, circle, pitch[:, 0] + 1j * pitch[:, 1], np.array([end])]
    _frame(axes, drawn, roller, product.roller_radius * scale)
    axes.set_xlabel(f"x [{product.unit}]")
    axes.set_ylabel(f"y [{product.unit}]")
    axes.set_title(product.name)
    _legend(axes)


def _draw_part(axes: Axes, product: Product, scale: float) -> list[ComplexArray]:
    """Draw the part and return its rings; without an outline, the working curves as they run."""
    sagitta = SAGITTA * product.base_radius
    try:
        part = product.part
        body = [b.arcs(sagitta).contour.points(sagitta) * scale for b in part.through]
        groove = [b.arcs(sagitta).contour.points(sagitta) * scale for b in part.groove]
    except UndercutError:
        return _draw_working_curves(axes, product, scale)
    axes.add_patch(_area(body, BODY))
    if groove:
        axes.add_patch(_area(groove, GROOVE))
    for ring in (*body, *groove):
        axes.add_patch(PathPatch(_outline(ring), fill=False, edgecolor=LINE, linewidth=1.6))
    return [*body, *groove]


def _draw_working_curves(axes: Axes, product: Product, scale: float) -> list[ComplexArray]:
    """Both working curves with their cusps and loops: there is no disc, but the reason shows."""
    rings = []
    for what in ("inner", "outer"):
        points = product.curve(what, cam_angles()) * scale
        axes.plot(points[:, 0], points[:, 1], color=LINE, linewidth=1.0)
        rings.append(points[:, 0] + 1j * points[:, 1])
    axes.text(0.02, 0.98, "no outline: undercut", transform=axes.transAxes, va="top")
    return rings


def _legend(axes: Axes) -> None:
    handles = [
        Line2D([], [], color=LINE, linewidth=1.6, label="edges of the disc"),
        Line2D([], [], label="pitch curve", **PITCH_STYLE),
        Line2D([], [], label="base circle", **BASE_STYLE),
        Line2D(
            [], [], linestyle="none", marker="o", markersize=9, markerfacecolor="white",
            markeredgecolor="black", label="roller at φ = 0",
        ),
    ]  # fmt: skip
    axes.legend(
        handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=4, borderaxespad=0.0
    )


def _outline(ring: ComplexArray) -> Path:
    points = np.column_stack((ring.real, ring.imag))
    return Path(np.vstack((points, points[:1])), closed=True)


def _area(rings: list[ComplexArray], colour: str) -> PathPatch:
    """The area between `rings`, the first the outermost; the others are holes."""
    outer = max(rings, key=_area_of)
    paths = [_outline(ring if ring is outer else ring[::-1]) for ring in rings]
    return PathPatch(
        Path.make_compound_path(*paths), facecolor=colour, edgecolor="none", linewidth=0.0
    )


def _area_of(ring: ComplexArray) -> float:
    return 0.5 * float(np.sum((ring.conj() * np.roll(ring, -1)).imag))


def _follower(axes: Axes, product: Product, roller: complex, scale: float) -> complex:
    """The roller at cam angle 0 and the line to its pivot, or along its guide; where that ends."""
    radius = product.roller_radius * scale
    sketch = product.follower_sketch
    end = sketch.end * scale
    along = (end - roller) / abs(end - roller)
    if sketch.kind == "guide":
        end = roller + 3.5 * radius * along
        # a short bar on each side stands for the guide
        for side in (0.3j, -0.3j):
            _segment(axes, end + (side - 1.5) * radius * along, end + side * radius * along, 2.4)
    _segment(axes, roller, end, 1.2)
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


def _segment(axes: Axes, start: complex, end: complex, width: float) -> None:
    axes.plot(
        [start.real, end.real], [start.imag, end.imag], color="black", linewidth=width, zorder=3
    )


def _rotation_arrow(axes: Axes, rotation: int, radius: float) -> None:
    """An arc with a head around the axis, in the sense in which the disc turns."""
    angles = np.radians(np.linspace(200.0, 320.0, 61))[:: 1 if rotation > 0 else -1]
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
