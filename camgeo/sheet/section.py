"""The section through the cam axis, from the layers of the part alone.

The plane is upright in the front view, x = 0, and one looks along +x, as at a view from the left:
in first-angle projection it stands to the right of the front view, with the upper face of the disc
on its right. At a height y of the front view and in a layer, what is seen is the first material at
or behind the plane. Between the heights at which a boundary passes the plane, turns back or has a
corner, that changes steadily; so lines are where it differs between neighbouring layers, or jumps
between neighbouring heights.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from camgeo.numeric.arrays import ComplexArray
from camgeo.sheet.marks import Hatched, Layer, Mark, line
from camgeo.sheet.shape import COARSE, Shape, corners, crossings

NOTHING = math.inf
"""Distance of the first material where there is none."""

SAME = 1e-6
"""Fraction of the size of the part by which distances of the same face may differ."""

JUMP = 0.02
"""Fraction of the size by which the distance of the first material jumps at an edge."""

RECTANGLE = 4
"""Corners of a face without chamfers."""

Places = Sequence[float]


def section(shape: Shape) -> list[Mark]:
    """The cut part: across is the height over its lowest face, up is y of the front view [mm]."""
    size, layers = shape.size, shape.part.layers
    rings = [[c.points(COARSE * size) for c in shape.contours(layer)] for layer in layers]
    sharp = [np.concatenate([corners(c) for c in shape.contours(layer)]) for layer in layers]
    places = _places(rings, sharp, size)
    middles = [0.5 * (low + high) for low, high in pairwise(places)]
    seen = [[_first(own, y) for y in middles] for own in rings]
    low = layers[0].z0
    heights = [layers[0].z0 - low, *(layer.z1 - low for layer in layers)]
    marks: list[Mark] = []
    for k, own in enumerate(seen):
        for index, away in enumerate(own):
            if away == 0.0:
                marks.append(_face(heights[k], heights[k + 1], places[index], places[index + 1]))
    nothing = [NOTHING] * len(middles)
    for k, height in enumerate(heights):
        below = seen[k - 1] if k else nothing
        above = seen[k] if k < len(seen) else nothing
        for first, last, layer in _runs(below, above, SAME * size):
            marks.append(line(height + 1j * places[first], height + 1j * places[last], layer))
    for y in places:
        drawn = [_edge(own, tips, y, size) for own, tips in zip(rings, sharp, strict=True)]
        start = 0
        while start < len(drawn):
            end = start
            while end < len(drawn) and drawn[end] == drawn[start]:
                end += 1
            found = drawn[start]
            if found is not None:
                marks.append(line(heights[start] + 1j * y, heights[end] + 1j * y, found))
            start = end
    return marks


def hatching(face: Hatched, step: float) -> Iterator[tuple[complex, complex]]:
    """The lines of a cut face, at 45 degrees and `step` [mm] apart, through the same points in all
    faces of a view.
    """
    x0, x1 = float(face.corners.real.min()), float(face.corners.real.max())
    y0, y1 = float(face.corners.imag.min()), float(face.corners.imag.max())
    along = step * math.sqrt(2.0)
    for number in range(math.ceil((y0 - x1) / along), math.floor((y1 - x0) / along) + 1):
        rise = number * along
        start, end = max(x0, y0 - rise), min(x1, y1 - rise)
        if len(face.corners) != RECTANGLE:
            start, end = _inside(face.corners, rise, start, end)
        if start < end:
            yield complex(start, start + rise), complex(end, end + rise)


def _inside(corners: ComplexArray, rise: float, start: float, end: float) -> tuple[float, float]:
    """What of the line y = x + `rise`, x from `start` to `end`, lies in a convex polygon that runs
    counter-clockwise.
    """
    for one, other in zip(corners.tolist(), np.roll(corners, -1).tolist(), strict=True):
        normal = 1j * (other - one)  # inwards
        at_zero = ((complex(0.0, rise) - one) * normal.conjugate()).real
        pace = normal.real + normal.imag
        if pace > 0.0:
            start = max(start, -at_zero / pace)
        elif pace < 0.0:
            end = min(end, -at_zero / pace)
        elif at_zero < 0.0:
            return 0.0, 0.0
    return start, end


def _face(z0: float, z1: float, y0: float, y1: float) -> Hatched:
    return Hatched(np.array([z0 + 1j * y0, z1 + 1j * y0, z1 + 1j * y1, z0 + 1j * y1]))


def _places(
    rings: Sequence[Sequence[ComplexArray]], sharp: Sequence[ComplexArray], size: float
) -> list[float]:
    """Heights [mm], ascending, between which what is seen changes steadily in every layer."""
    found: list[float] = []
    for ring in (ring for own in rings for ring in own):
        found += crossings(1j * ring.conj(), 0.0).tolist()  # of its mirror image with x = 0
        before, after = np.roll(ring, 1), np.roll(ring, -1)
        turns = (ring.imag - before.imag) * (after.imag - ring.imag) <= 0.0
        found += ring[turns & (ring.real > 0.0)].imag.tolist()
    for tips in sharp:
        found += tips[tips.real > 0.0].imag.tolist()
    merged: list[float] = []
    for y in sorted(found):
        if not merged or y - merged[-1] > 10.0 * COARSE * size:
            merged.append(y)
    return merged


def _first(rings: Sequence[ComplexArray], y: float) -> float:
    """Distance from the plane to the first material at the height y [mm]; 0 in cut material."""
    ahead = [x for ring in rings for x in crossings(ring, y).tolist() if x > 0.0]
    if len(ahead) % 2:
        return 0.0
    return min(ahead, default=NOTHING)


def _runs(
    below: Sequence[float], above: Sequence[float], same: float
) -> Iterator[tuple[int, int, Layer]]:
    """Where a line separates two layers: first and last place, and what the line is."""
    kinds: list[Layer | None] = []
    for one, other in zip(below, above, strict=True):
        if one == other or abs(one - other) <= same:
            kinds.append(None)
        else:
            kinds.append("SECTION" if 0.0 in (one, other) else "EDGES")
    start = 0
    while start < len(kinds):
        end = start
        while end < len(kinds) and kinds[end] == kinds[start]:
            end += 1
        kind = kinds[start]
        if kind is not None:
            yield start, end, kind
        start = end


def _edge(
    rings: Sequence[ComplexArray], sharp: ComplexArray, y: float, size: float
) -> Layer | None:
    """What is drawn in a layer along the height y: a cut edge, one behind the plane, or nothing."""
    step = 20.0 * COARSE * size
    one, other = _first(rings, y - step), _first(rings, y + step)
    if one == other:
        return None
    if 0.0 in (one, other):
        return "SECTION"
    near = min(one, other)
    edges = sharp[np.abs(sharp.imag - y) <= step]
    cornered = bool(np.any(np.abs(edges.real - near) <= JUMP * size))
    return "EDGES" if cornered or abs(one - other) > JUMP * size else None
