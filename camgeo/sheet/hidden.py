"""Edges of which a part is hidden: the outline of the lower disc of a pair in one piece.

What is seen of an edge changes where it passes under an edge above it. Places along it are compared
one by one, as polygons, so a stretch shorter than their distance may be drawn as its neighbours
are; the edge itself stays what it is, as its stretches are cut from its lines and arcs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray
from camgeo.sheet.marks import Chain, Layer
from camgeo.sheet.shape import COARSE, Edge, Shape, enclosing
from camgeo.sheet.stretch import cut_out

PLACES: Final = 720
"""Along an edge."""

NEAR: Final = 1e-4
"""Of the size of the part: an edge nearer than that to one above it is seen."""

FINE: Final = 1e-7
"""Of the length of an edge, to which the ends of its stretches are found."""

Covered = Callable[[complex], bool]


def chains_of(shape: Shape, edge: Edge) -> list[Chain]:
    """The edge as it is drawn: whole, or in stretches that are seen and hidden in turn."""
    contour, layer = edge.contour, _layer(edge)
    whole = Chain(contour.vertices, contour.sweeps, layer, closed=True)
    covers = _above(shape, edge) if layer == "OUTLINE" and not edge.boundary.hole else []
    if not covers:
        return [whole]
    size, length = shape.size, float(np.sum(contour.lengths))

    def covered(place: float) -> bool:
        here = cut_out(contour, place * length, 0.0, "OUTLINE").vertices[0]
        return any(_inside(rings, complex(here), NEAR * size) for rings in covers)

    ends = _changes(covered)
    if not ends:
        return [whole]
    found = []
    for first, last in pairwise([*ends, ends[0] + 1.0]):
        layer = "HIDDEN" if covered(0.5 * (first + last) % 1.0) else "OUTLINE"
        found.append(cut_out(contour, first * length, (last - first) * length, layer))
    return found


def _layer(edge: Edge) -> Layer:
    if edge.is_letter:
        return "ENGRAVING"
    return "HIDDEN" if edge.hidden else "OUTLINE"


def _above(shape: Shape, edge: Edge) -> list[list[ComplexArray]]:
    """The boundaries of each layer above an edge that reaches it, as polygons."""
    layers, coarse = shape.part.layers, COARSE * shape.size
    top = max(k for k, layer in enumerate(layers) if edge.boundary in layer.boundaries)
    above = [shape.contours(layer) for layer in layers[top + 1 :]]
    polygons = [[each.points(coarse) for each in contours] for contours in above]
    nearest = float(np.min(np.abs(edge.contour.points(coarse))))
    return [rings for rings in polygons if float(np.max(np.abs(rings[0]))) > nearest]


def _inside(rings: Sequence[ComplexArray], point: complex, near: float) -> bool:
    """Whether a point lies in the material of a layer, and not on its edge."""
    if not enclosing(rings, point) % 2:
        return False
    return all(_distance(ring, point) > near for ring in rings)


def _distance(ring: ComplexArray, point: complex) -> float:
    way = np.roll(ring, -1) - ring
    share = np.clip(((point - ring) * way.conj()).real / np.abs(way) ** 2, 0.0, 1.0)
    return float(np.min(np.abs(ring + share * way - point)))


def _changes(covered: Callable[[float], bool]) -> list[float]:
    """The places, as shares of the length, at which an edge goes under another or comes out."""
    places = (np.arange(PLACES + 1) / PLACES).tolist()
    seen = [covered(each) for each in places[:-1]]
    found = []
    for (low, high), before, after in zip(
        pairwise(places), seen, [*seen[1:], seen[0]], strict=True
    ):
        if before == after:
            continue
        while high - low > FINE:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if covered(middle) == before else (low, middle)
        found.append(0.5 * (low + high))
    return found
