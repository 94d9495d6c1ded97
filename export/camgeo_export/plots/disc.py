"""The disc as a body: filled, with its edges; as a whole, or what a window shows of it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Boundary, Part
from camgeo_export.plots import cut_off
from camgeo_export.plots.style import LINE, RETURN_STYLE

BODY = "#e4e8ec"
GROOVE = "#c2cad3"

EDGE = 1.6
"""Width of the edges [points]."""

FINE = 1e-3
"""Chords of a window, relative to its side."""


def draw(axes: Axes, part: Part, scale: complex, sagitta: float) -> list[ComplexArray]:
    """Draw the part and return its rings; `scale` units in 1 mm, chords `sagitta` [mm] off.

    A complex scale turns the part.
    """
    drawn: list[ComplexArray] = []
    for boundaries, colour in _areas(part):
        rings = [ring * scale for ring in _rings(boundaries, sagitta)]
        axes.add_patch(_area(rings, colour))
        drawn += rings
    for ring in drawn:
        axes.add_patch(PathPatch(_outline(ring), fill=False, edgecolor=LINE, linewidth=EDGE))
    return drawn


def draw_behind(axes: Axes, part: Part, scale: complex, sagitta: float) -> None:
    """Draw the outline of a second disc, that of a conjugate pair, over the first one."""
    for ring in _rings(part.boundaries[:1], sagitta):
        line = np.append(ring, ring[:1]) * scale
        axes.plot(line.real, line.imag, zorder=3, **RETURN_STYLE)


def draw_near(axes: Axes, part: Part, middle: complex, width: float) -> None:
    """Draw what lies in and about the square of side `width` [mm] round `middle`, in mm."""
    sagitta = FINE * width
    for boundaries, colour in _areas(part):
        rings = _rings(boundaries, sagitta)
        inside = [cut_off.clipped(ring, middle, 2.0 * width) for ring in rings]
        inside = [ring for ring in inside if len(ring)]
        if inside:
            axes.add_patch(_area(inside, colour))
        for ring in rings:
            edge = cut_off.near(np.append(ring, ring[:1]), middle, width)
            axes.plot(edge.real, edge.imag, color=LINE, linewidth=EDGE)


def _areas(part: Part) -> list[tuple[tuple[Boundary, ...], str]]:
    """What is filled with a colour: the lowest layer, and what each of the others begins."""
    found = [(part.layers[0].boundaries, BODY)]
    for lower, upper in pairwise(part.layers):
        begins = tuple(each for each in upper.boundaries if each not in lower.boundaries)
        found.append((begins, GROOVE))
    return found


def _rings(boundaries: tuple[Boundary, ...], sagitta: float) -> list[ComplexArray]:
    """Points [mm] of each boundary."""
    return [boundary.arcs(sagitta).contour.points(sagitta) for boundary in boundaries]


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
