"""The chamfers of a mesh: facets between two heights that are neither flat nor upright.

Their edges are compared with those of the part, and so is their section half way up, where facets
whose lower and upper edge do not match would sag most.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.part.bands import Band
from camgeo.part.boundary import Boundary
from camgeo.part.part import Part
from camgeo_export.errors import FileError
from camgeo_export.verify.mesh import border_loops, polygon, upright_facets


@dataclass(frozen=True, slots=True)
class Slope:
    """The chamfers of a part between the same two heights [mm] over its lower face."""

    z0: float
    z1: float
    bands: tuple[Band, ...]

    @property
    def name(self) -> str:
        """What it is called in messages."""
        return f"chamfer from Z {self.z0:g} to {self.z1:g} mm"

    def edges(self, height: int) -> tuple[Boundary, ...]:
        """The exact edges: 0 the lower ones, 2 the upper ones, 1 the sections half way up."""
        if height == 1:
            return tuple(band.section(0.5 * (band.z0 + band.z1)) for band in self.bands)
        return tuple(band.upper if height else band.lower for band in self.bands)


def slopes_of(part: Part) -> tuple[Slope, ...]:
    """The chamfers of a part, from the lowest upwards."""
    if not part.bevels:
        return ()
    base = part.layers[0].z0
    found: dict[tuple[float, float], list[Band]] = {}
    for band in part.bands:
        if not band.is_upright:
            found.setdefault((band.z0 - base, band.z1 - base), []).append(band)
    return tuple(Slope(*heights, tuple(found[heights])) for heights in sorted(found))


def sloping(
    vertices: FloatArray,
    triangles: IntArray,
    among: BoolArray,
    slopes: Sequence[Slope],
    within: float,
) -> IntArray:
    """(m,) the numbers of the slopes to which facets belong, -1 for none.

    Facets that lean, `among` some of all (m,), and hang together reach from the lower to the upper
    edge of one slope, `within` a length [mm]; along bent corners they do in several steps.
    """
    numbers = np.full(len(triangles), -1)
    if not slopes:
        return numbers
    from scipy.sparse import coo_array  # only for parts with chamfers
    from scipy.sparse.csgraph import connected_components

    own = np.flatnonzero(among & ~upright_facets(vertices[triangles], within))
    corners = triangles[own]
    pairs = np.concatenate((corners[:, :2], corners[:, 1:]))
    size = len(vertices)
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    count, labels = connected_components(links, directed=False)
    labels = labels[corners[:, 0]]
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    heights = vertices[corners][:, :, 2]
    np.minimum.at(low, labels, heights.min(axis=1))
    np.maximum.at(high, labels, heights.max(axis=1))
    for number, slope in enumerate(slopes):
        there = (np.abs(low - slope.z0) <= within) & (np.abs(high - slope.z1) <= within)
        numbers[own[there[labels]]] = number
    return numbers


def contours_of(vertices: FloatArray, triangles: IntArray) -> Iterator[list[Contour]]:
    """Of the facets (m, 3) of a slope the lower edges, the sections half way up, the upper edges.

    Raises
    ------
    FileError
        If there are none, or if they do not reach all round from a lower to an upper edge.
    """
    if not len(triangles):
        raise FileError("there is no chamfer")
    loops = border_loops(triangles)
    middle = 0.5 * (np.min(vertices[triangles][:, :, 2]) + np.max(vertices[triangles][:, :, 2]))
    lower = [loop for loop in loops if np.all(vertices[loop][:, 2] < middle)]
    upper = [loop for loop in loops if np.all(vertices[loop][:, 2] > middle)]
    if len(lower) + len(upper) < len(loops) or len(lower) != len(upper):
        raise FileError("a chamfer does not reach all round from its lower to its upper edge")
    yield [polygon(vertices[loop]) for loop in lower]
    yield [polygon(points) for points in _sections(vertices, triangles, middle)]
    yield [polygon(vertices[loop]) for loop in upper]


def _sections(vertices: FloatArray, triangles: IntArray, z: float) -> Iterator[FloatArray]:
    """Where edges cross a height (n, 3), loop by loop: each facet that does joins two."""
    above = vertices[:, 2] > z
    after: dict[tuple[int, int], tuple[int, int]] = {}
    for facet in triangles[above[triangles].any(axis=1) & ~above[triangles].all(axis=1)].tolist():
        for k in range(3):
            one, other = facet[k], facet[(k + 1) % 3]
            if not above[one] and above[other]:
                up = (one, other)
            elif above[one] and not above[other]:
                down = (other, one)
        after[up] = down
    while after:
        first, following = after.popitem()
        loop = [first]
        while following != first:
            if following not in after:
                raise FileError("the facets of a chamfer do not go round")
            loop.append(following)
            following = after.pop(following)
        low, high = vertices[np.array(loop).T]
        share = (z - low[:, 2:]) / (high[:, 2:] - low[:, 2:])
        points = low + share * (high - low)
        yield points[np.any(points != np.roll(points, 1, axis=0), axis=1)]
