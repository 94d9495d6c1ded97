"""The parts of a contour that a flat face touches: the vertices and arcs of its convex hull.

The face with the normal at theta lies at the distance

    h(theta) = max over the contour of Re(exp(-i theta) P),

its support function. Of a line only the ends can be touched alone, of an arc that turns in only its
ends, of one that turns out, a circle of radius R about C, all places between the normals at its
ends, at the distance Re(exp(-i theta) C) + R; a point is a circle of radius 0. So h is the upper
envelope of sines, exactly: the vertices that count are those of their convex hull, each between the
normals of the hull's sides, and within a range of theta where the same arcs are present two
distances are equal at the roots of a sine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, ascending
from camgeo.outline.layers import (
    MOST_PAIRS,
    NONE,
    Cells,
    Pairs,
    changes,
    covered,
    outermost,
    seen,
    together,
    too_rough,
)
from camgeo.outline.roller_path import LinesAndArcs
from camgeo.units import TURN

WIDEST = math.pi / 4.0
"""Widest range of normals [rad] of the cells in which distances are compared."""

LAYERS = "vertices and arcs lie"


@dataclass(frozen=True, slots=True, eq=False)
class Circles:
    """n circles and points that a face touches.

    Attributes
    ----------
    centres : (n,) complex [mm].
    radii : (n,) [mm], 0 for points.
    elements : (n,) number of the contour's piece, -1 - k of its vertex k.
    """

    centres: ComplexArray
    radii: FloatArray
    elements: IntArray

    def distance(self, which: IntArray, theta: FloatArray) -> FloatArray:
        """(k,) h [mm] of those at `which` (k,) at theta (k,) [rad]."""
        turned = self.centres[which] * np.exp(-1j * theta)
        return np.asarray(turned.real + self.radii[which])


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """The convex hull of a contour by its normals.

    Attributes
    ----------
    circles : what may be touched.
    normals : (k,) theta [rad], ascending from one in [0, 2 pi) over less than a turn, at which what
        is touched changes.
    touched : (k,) the circle from each of them to the next.
    """

    circles: Circles
    normals: FloatArray
    touched: IntArray

    @property
    def widths(self) -> FloatArray:
        """(k,) range of normals [rad] over which each is touched."""
        ends = np.append(self.normals[1:], self.normals[0] + TURN)
        return np.asarray(ends - self.normals)

    def ends(self) -> FloatArray:
        """(k,) h [mm] at `normals`."""
        return self.circles.distance(self.touched, self.normals)


def hull_of(contour: LinesAndArcs) -> Hull:
    """The convex hull of `contour`.

    Raises
    ------
    GeometryError
        If the contour does not run counter-clockwise round an area, or is too rough.
    """
    if not contour.area > 0.0:
        raise GeometryError("the contour must enclose an area and run counter-clockwise")
    corner = _convex_hull(contour.vertices)
    points = contour.vertices[corner]
    sides = np.roll(points, -1) - points
    # The face rests on a vertex between the normals of the sides that meet there.
    leaving = np.angle(-1j * sides) % TURN
    arcs = np.flatnonzero(contour.sweeps > 0.0)
    first = contour.vertices[arcs] - contour.centres[arcs]
    starts = np.angle(first) % TURN
    circles = Circles(
        np.concatenate((points, contour.centres[arcs])),
        np.concatenate((np.zeros(len(points)), np.abs(first))),
        np.concatenate((-1 - corner, arcs)),
    )
    lows = np.concatenate((np.roll(leaving, 1), starts))
    spans = np.concatenate(((leaving - np.roll(leaving, 1)) % TURN, contour.sweeps[arcs]))
    return _envelope(circles, lows, np.minimum(spans, TURN))


def _convex_hull(points: ComplexArray) -> IntArray:
    """Indices of the vertices of the convex hull, counter-clockwise, without those on its sides."""
    order = np.lexsort((points.imag, points.real))
    chains = []
    for run in (order.tolist(), order[::-1].tolist()):
        chain: list[int] = []
        for each in run:
            while len(chain) > 1:
                a, b, c = points[chain[-2]], points[chain[-1]], points[each]
                if ((b - a).conjugate() * (c - b)).imag > 0.0:
                    break
                chain.pop()
            chain.append(each)
        chains.append(chain[:-1])
    return np.array(chains[0] + chains[1] or [0], dtype=np.intp)  # a circle has one vertex


def _envelope(circles: Circles, lows: FloatArray, spans: FloatArray) -> Hull:
    """The upper envelope of the distances of `circles` (n,), each over its range of normals."""
    whole = np.arange(0.0, TURN, WIDEST)
    nodes = ascending(np.concatenate((whole, lows % TURN, (lows + spans) % TURN)))
    cells = Cells.between(nodes)
    first = np.searchsorted(nodes, lows % TURN)
    number = np.remainder(np.searchsorted(nodes, (lows + spans) % TURN) - first, len(cells))
    number[(number == 0) & (spans > math.pi)] = len(cells)
    pairs = covered(cells, first, number, LAYERS)
    pairs = _without_hidden(circles, cells, *pairs)
    grid, _, held = outermost(cells, pairs, _crossings(circles, cells, *pairs), circles.distance)
    return Hull(circles, *changes(grid[held != NONE], held[held != NONE]))


def _without_hidden(circles: Circles, cells: Cells, cell: IntArray, which: IntArray) -> Pairs:
    """The pairs of a cell and a circle without those that lie behind another one throughout."""
    low, high = cells.low[cell], cells.high[cell]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    turned = circles.centres[which] * np.exp(-1j * middle)
    size = np.abs(turned)
    here = turned.real + circles.radii[which]
    change = half * np.abs(turned.imag) + 0.5 * half * half * size
    kept = seen(cell, here - change, here + change)
    return cell[kept], which[kept]


def _crossings(circles: Circles, cells: Cells, cell: IntArray, which: IntArray) -> FloatArray:
    """(k,) theta in [0, 2 pi) inside cells at which two of their circles are equally far."""
    found = [np.empty(0)]
    examined = 0
    for index, with_index in together(cell):
        examined += len(index)
        if examined > MOST_PAIRS:
            raise too_rough(LAYERS, len(cell) / len(cells))
        one, other = which[index], which[with_index]
        low, high = cells.low[cell[index]], cells.high[cell[index]]
        way = circles.centres[other] - circles.centres[one]
        size, rise = np.abs(way), circles.radii[one] - circles.radii[other]
        with np.errstate(divide="ignore", invalid="ignore"):
            away = np.arccos(rise / size)
        for theta in (np.angle(way) + away, np.angle(way) - away):
            offset = (theta - low) % TURN
            crossed = (offset > 0.0) & (offset < high - low)
            found.append((low + offset)[crossed] % TURN)
    return np.concatenate(found)
