"""What of a contour a flat face touches: the vertices and arcs of its convex hull.

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
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, ascending, grouped
from camgeo.outline.roller_path import LinesAndArcs
from camgeo.units import TURN

WIDEST = math.pi / 4.0
"""Widest range of normals [rad] of the cells in which distances are compared."""

MOST_PAIRS = 2_000_000
"""Most pairs of a cell and a circle, or of two circles in a cell."""


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
    # The face stands on a vertex between the normals of the sides that meet there.
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
    count = len(nodes)
    first = np.searchsorted(nodes, lows % TURN)
    cells = np.remainder(np.searchsorted(nodes, (lows + spans) % TURN) - first, count)
    cells[(cells == 0) & (spans > math.pi)] = count
    if np.sum(cells) > MOST_PAIRS:
        raise GeometryError(_too_rough(np.sum(cells) / count))
    which, rank = grouped(cells)
    cell = np.remainder(first[which] + rank, count)
    order = np.argsort(cell, kind="stable")
    cell, which = cell[order], which[order]
    low, high = nodes, np.append(nodes[1:], nodes[0] + TURN)
    cell, which = _without_hidden(circles, low, high, cell, which)
    grid = ascending(np.concatenate((nodes, _crossings(circles, low, high, cell, which))))
    parent = np.remainder(np.searchsorted(nodes, grid, "right") - 1, count)
    begin = np.searchsorted(cell, parent, "left")
    many = np.searchsorted(cell, parent, "right") - begin
    fine, step = grouped(many)
    candidate = which[begin[fine] + step]
    middle = 0.5 * (grid + np.append(grid[1:], grid[0] + TURN))
    height = circles.distance(candidate, middle[fine])
    best = np.lexsort((candidate, height, fine))
    last = best[np.append(fine[1:] != fine[:-1], True)]  # `best` keeps the order of the cells
    held = candidate[last]
    changed = held != np.roll(held, 1)
    changed[0] |= not np.any(changed)
    return Hull(circles, grid[fine[last]][changed], held[changed])


def _without_hidden(
    circles: Circles, low: FloatArray, high: FloatArray, cell: IntArray, which: IntArray
) -> tuple[IntArray, IntArray]:
    """The pairs of a cell and a circle without those that lie behind another one throughout."""
    middle, half = 0.5 * (low + high)[cell], 0.5 * (high - low)[cell]
    turned = circles.centres[which] * np.exp(-1j * middle)
    size = np.abs(turned)
    here = turned.real + circles.radii[which]
    change = half * np.abs(turned.imag) + 0.5 * half * half * size
    least = np.full(len(low), -np.inf)
    np.maximum.at(least, cell, here - change)
    seen = here + change >= least[cell]
    return cell[seen], which[seen]


def _crossings(
    circles: Circles, low: FloatArray, high: FloatArray, cell: IntArray, which: IntArray
) -> FloatArray:
    """(k,) theta in [0, 2 pi) inside cells at which two of their circles are equally far."""
    found = [np.empty(0)]
    step, examined = 1, 0
    while np.any(pairs := cell[step:] == cell[:-step]):
        index = np.flatnonzero(pairs)
        examined += len(index)
        if examined > MOST_PAIRS:
            raise GeometryError(_too_rough(len(cell) / len(low)))
        one, other, inside = which[index], which[index + step], cell[index]
        way = circles.centres[other] - circles.centres[one]
        size, rise = np.abs(way), circles.radii[one] - circles.radii[other]
        with np.errstate(divide="ignore", invalid="ignore"):
            away = np.arccos(rise / size)
        for theta in (np.angle(way) + away, np.angle(way) - away):
            offset = (theta - low[inside]) % TURN
            crossed = (offset > 0.0) & (offset < (high - low)[inside])
            found.append((low[inside] + offset)[crossed] % TURN)
        step += 1
    return np.concatenate(found)


def _too_rough(layers: float) -> str:
    return (
        "the contour is too rough to be replayed: its vertices and arcs lie in"
        f" {layers:.0f} layers; smooth it first"
    )
