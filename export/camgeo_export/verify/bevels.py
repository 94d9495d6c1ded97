"""The chamfers of a mesh: facets between two heights that are neither flat nor upright.

Their edges are compared with those of the part, and so is their section half way up, where facets
whose lower and upper edge do not match would sag most.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import FloatArray, IntArray
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


def sloping(corners: FloatArray, slopes: Sequence[Slope], within: float) -> IntArray:
    """(m,) the numbers of the slopes between whose heights facets (m, 3, 3) reach, -1 for none."""
    numbers = np.full(len(corners), -1)
    if not slopes:
        return numbers
    leaning = ~upright_facets(corners, within)
    low, high = corners[:, :, 2].min(axis=1), corners[:, :, 2].max(axis=1)
    for number, slope in enumerate(slopes):
        there = (np.abs(low - slope.z0) <= within) & (np.abs(high - slope.z1) <= within)
        numbers[there & leaning] = number
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
    """The middles (n, 3) of the edges across a height, loop by loop: each facet joins two."""
    after: dict[tuple[int, int], tuple[int, int]] = {}
    for facet in triangles.tolist():
        above = [vertices[corner, 2] > z for corner in facet]
        up = down = None
        for k in range(3):
            one, other = facet[k], facet[(k + 1) % 3]
            if not above[k] and above[(k + 1) % 3]:
                up = (one, other)
            elif above[k] and not above[(k + 1) % 3]:
                down = (other, one)
        if up is None or down is None:
            raise FileError("a facet of a chamfer is flat")
        after[up] = down
    while after:
        first, following = after.popitem()
        loop = [first]
        while following != first:
            if following not in after:
                raise FileError("the facets of a chamfer do not go round")
            loop.append(following)
            following = after.pop(following)
        ends = np.array(loop)
        yield 0.5 * (vertices[ends[:, 0]] + vertices[ends[:, 1]])
