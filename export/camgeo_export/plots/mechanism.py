"""The mechanism as a diagram: disc, follower and linkage at cam angle 0 and at the far position."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Circle, PathPatch
from matplotlib.path import Path

from camgeo.errors import CamgeoError
from camgeo.files.product import Product
from camgeo.mechanism.sketch import Guide, MechanismSketch
from camgeo.part.boundaries import largest_radius
from camgeo.part.part import Part
from camgeo_export.plots import disc

SAGITTA = 1e-4
"""Chords of the picture, relative to the base radius: far below a printed line."""

COARSE = 1e-2
"""Tolerance of the outline by which the picture's room is found, relative to the base radius."""

LINK: Any = {"color": "black", "linewidth": 1.8, "solid_capstyle": "round", "zorder": 5}
FACE: Any = {"color": "black", "linewidth": 3.0, "solid_capstyle": "butt", "zorder": 5}
THIN: Any = {"color": "black", "linewidth": 1.0, "zorder": 4}

JOINT = 0.012
"""Radius of a joint, as a share of the root of the picture's area."""

HATCHES = 5
"""Strokes that mark a fixed body."""

ROOM = 0.07
"""Room around what is drawn, as a share of its size."""

WIDTH = 10.0
"""Of the picture [inch]."""

HEIGHTS = (2.5, 9.0)
"""Least and greatest height of the two panes [inch]."""

HEAD = 0.75
"""Room for the titles [inch]."""

EDGE = 0.15
"""Room beside the panes and between them [inch]."""


def size(product: Product) -> tuple[float, float]:
    """Width and height [inch]: the panes as high as what is in them, drawn to scale."""
    low, high = _window(product, _sketches(product))
    pane = 0.5 * (WIDTH - 3.0 * EDGE)
    height = pane * (high - low).imag / (high - low).real
    return WIDTH, min(max(height, HEIGHTS[0]), HEIGHTS[1]) + HEAD + EDGE


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw the mechanism twice, both to one scale."""
    width, height = figure.bbox.width / figure.dpi, figure.bbox.height / figure.dpi
    axes = figure.subplots(
        1, 2,
        gridspec_kw={
            "left": EDGE / width, "right": 1.0 - EDGE / width, "wspace": 0.02,
            "bottom": EDGE / height, "top": 1.0 - HEAD / height,
        },
    )  # fmt: skip
    sketches = _sketches(product)
    low, high = _window(product, sketches)
    joint = JOINT * math.sqrt((high - low).real * (high - low).imag)
    parts = _parts(product)
    for pane, (phi, sketch) in zip(axes, sketches, strict=True):
        turn = cmath.exp(1j * product.rotation * phi)
        for part in parts[:1]:
            disc.draw(pane, part, turn, SAGITTA * product.base_radius)
        for part in parts[1:]:
            disc.draw_behind(pane, part, turn, SAGITTA * product.base_radius)
        _bodies(pane, sketch, joint)
        _axis(pane, joint)
        pane.set_aspect("equal")
        pane.axis("off")
        pane.set_xlim(low.real, high.real)
        pane.set_ylim(low.imag, high.imag)
        pane.set_title(f"cam angle {math.degrees(phi):.4g}°")
    figure.suptitle(product.name, y=1.0 - 0.1 / height, fontsize=11.0)


def _sketches(product: Product) -> list[tuple[float, MechanismSketch]]:
    """Cam angle [rad] of each pane, and the mechanism there."""
    return [(phi, product.mechanism_sketch(phi)) for phi in (0.0, product.far_angle)]


def _window(
    product: Product, sketches: list[tuple[float, MechanismSketch]]
) -> tuple[complex, complex]:
    """Lower left and upper right corner [mm] of what both panes show."""
    reach = product.base_radius
    for part in _parts(product):
        ring = part.boundaries[0].arcs(COARSE * reach).contour
        reach = max(reach, largest_radius(ring))
    points = [point for _, sketch in sketches for point in sketch.points]
    corners = np.array([*points, *(reach * side for side in (1, 1j, -1, -1j))])
    low = complex(corners.real.min(), corners.imag.min())
    high = complex(corners.real.max(), corners.imag.max())
    room = ROOM * max((high - low).real, (high - low).imag) * (1.0 + 1.0j)
    return low - room, high + room


def _parts(product: Product) -> tuple[Part, ...]:
    """The disc and, of a pair, the return disc; none if one cannot be made or its bore not fit."""
    try:
        both = (product, product.returning)
        return tuple(each.part for each in both if each is not None)
    except CamgeoError:
        return ()


def _bodies(axes: Axes, sketch: MechanismSketch, joint: float) -> None:
    for link in sketch.links:
        axes.plot([point.real for point in link], [point.imag for point in link], **LINK)
    for start, end in sketch.faces:
        axes.plot([start.real, end.real], [start.imag, end.imag], **FACE)
    for centre, radius in sketch.rollers:
        _circle(axes, centre, radius, zorder=4)
        _circle(axes, centre, min(joint, 0.4 * radius), zorder=6)
    for guide in sketch.guides:
        _guide(axes, guide, joint)
    for point in sketch.joints:
        _circle(axes, point, joint, zorder=6)
    for point in sketch.shafts:
        _shaft(axes, point, joint)


def _circle(axes: Axes, centre: complex, radius: float, zorder: int) -> None:
    axes.add_patch(
        Circle((centre.real, centre.imag), radius, facecolor="white", edgecolor="black",
               linewidth=1.2, zorder=zorder)
    )  # fmt: skip


def _guide(axes: Axes, guide: Guide, joint: float) -> None:
    """Two bars, hatched on the outside, beside a rod or a block."""
    along, across = guide.direction * joint, 1j * guide.direction * joint
    if guide.block:
        block = np.array([1.6 * along + across, across - 1.6 * along])
        block = np.concatenate((block, -block, block[:1])) + guide.middle
        axes.add_patch(
            PathPatch(Path(np.column_stack((block.real, block.imag))), facecolor="white",
                      edgecolor="black", linewidth=1.2, zorder=5)
        )  # fmt: skip
    else:
        across *= 0.5
    for side in (1.15, -1.15):
        foot = guide.middle + side * across
        _stroke(axes, foot - 4.0 * along, foot + 4.0 * along)
        for k in range(HATCHES):
            start = foot + (k - 2) * 1.6 * along
            outward = math.copysign(1.0, side) * 1j * guide.direction * joint
            _stroke(axes, start, start + outward - 0.8 * along)


def _shaft(axes: Axes, point: complex, joint: float) -> None:
    """A joint on a small hatched stand."""
    left, right = point + joint * (-1.6 - 2.6j), point + joint * (1.6 - 2.6j)
    for end in (left, right):
        _stroke(axes, point, end)
    _stroke(axes, left - 0.7 * joint, right + 0.7 * joint)
    for k in range(HATCHES):
        start = left + (right - left) * (k / (HATCHES - 1))
        _stroke(axes, start, start - joint * (0.8 + 0.9j))
    _circle(axes, point, joint, zorder=6)


def _axis(axes: Axes, joint: float) -> None:
    _circle(axes, 0j, joint, zorder=6)
    for way in (2.2, 2.2j):
        _stroke(axes, -way * joint, way * joint)


def _stroke(axes: Axes, start: complex, end: complex) -> None:
    axes.plot([start.real, end.real], [start.imag, end.imag], **THIN)
