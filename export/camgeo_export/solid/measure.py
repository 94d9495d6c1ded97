"""A mesh that was read back, taken apart into the boundaries of the part and held against them."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.files.product import Product
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo_export.errors import FileError
from camgeo_export.matching import deviation


def measure(product: Product, vertices: FloatArray, triangles: IntArray) -> float:
    """Largest proved deviation [mm] of a body from the part, in the plane and in its heights.

    `vertices` (n, 3) [mm] and `triangles` (m, 3) as they stand in the file. Raises FileError unless
    they form one closed, outward oriented body with upright walls between flat faces.
    """
    try:
        wanted = product.part.levels
    except GeometryError as error:
        raise FileError(f"no body to hold this against: {error.message}") from None
    if not np.isfinite(vertices).all():
        raise FileError("the mesh has coordinates that are not finite")
    # An STL repeats its vertices; equal ones are one.
    vertices, merged = np.unique(vertices, axis=0, return_inverse=True)
    triangles = merged.reshape(-1)[triangles]
    _check_closed(vertices, triangles)
    corners = vertices[triangles]
    flat = (corners[:, :, 2] == corners[:, :1, 2]).all(axis=1)
    _check_upright(corners[~flat])
    heights = sorted(set(corners[flat][:, 0, 2].tolist()))
    if len(heights) != len(wanted):
        raise FileError(f"flat faces at {len(heights)} heights, expected {len(wanted)}")
    largest = 0.0
    for height, exact in zip(heights, wanted, strict=True):
        level = triangles[flat & (corners[:, 0, 2] == height)]
        contours = [_contour(vertices[loop]) for loop in border_loops(level)]
        off = abs(height - (exact.z - wanted[0].z))
        largest = max(largest, off, deviation(contours, exact.boundaries))
    return largest


def _check_closed(vertices: FloatArray, triangles: IntArray) -> None:
    """Each edge must be run once in each direction, and the volume be positive."""
    start = triangles.reshape(-1)
    end = np.roll(triangles, -1, axis=1).reshape(-1)
    count = len(vertices)
    forth = np.sort(start * count + end)
    back = np.sort(end * count + start)
    if (start == end).any() or (np.diff(forth) == 0).any() or not np.array_equal(forth, back):
        raise FileError("the mesh is not closed, or its facets are not all turned outwards")
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    if not np.einsum("ij,ij->", a, np.cross(b, c)) > 0.0:
        raise FileError("the mesh is turned inside out")


def _check_upright(corners: FloatArray) -> None:
    """Each triangle that is not flat must have a vertical edge."""
    plane = corners[:, :, 0] + 1j * corners[:, :, 1]
    if not (plane == np.roll(plane, 1, axis=1)).any(axis=1).all():
        raise FileError("the mesh has a wall that is not upright")


def border_loops(triangles: IntArray) -> list[list[int]]:
    """Closed chains of the edges that belong to one of `triangles` (m, 3) only."""
    start = triangles.reshape(-1).tolist()
    end = np.roll(triangles, -1, axis=1).reshape(-1).tolist()
    edges = set(zip(start, end, strict=True))
    border = [edge for edge in zip(start, end, strict=True) if edge[::-1] not in edges]
    after = dict(border)
    if len(after) != len(border):
        raise FileError("boundaries of the mesh touch each other")
    loops = []
    while after:
        first, following = after.popitem()
        loop = [first]
        while following != first:
            loop.append(following)
            following = after.pop(following)
        loops.append(loop)
    return loops


def _contour(points: FloatArray) -> Contour:
    vertices = points[:, 0] + 1j * points[:, 1]
    return Contour(vertices, np.zeros(len(vertices)), np.zeros_like(vertices))
