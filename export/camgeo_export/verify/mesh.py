"""Whether a mesh is one closed, outward body, or where it is not; the boundaries of its faces."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.verifying.verification import Check, failed
from camgeo.wording import counted
from camgeo_export.errors import FileError

ROUNDING = 2.0**-52 * 4.0
"""Height below which a facet has no area, as a fraction of the mesh's reach."""


def merged(vertices: FloatArray, triangles: IntArray) -> tuple[FloatArray, IntArray]:
    """The mesh with coincident vertices merged: an STL repeats them."""
    unique, index = np.unique(vertices, axis=0, return_inverse=True)
    return unique, index.reshape(-1)[triangles]


def polygon(points: FloatArray) -> Contour:
    """The closed contour through `points` (n, 3) [mm] at one height."""
    return Contour.polygon(points[:, 0] + 1j * points[:, 1])


def heights(corners: FloatArray) -> FloatArray:
    """(m,) [mm] height of each triangle (m, 3, 3) over its longest side; 0 for a point."""
    sides = corners - np.roll(corners, 1, axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    found: FloatArray = doubled / np.where(longest > 0.0, longest, 1.0)
    return found


def volume(vertices: FloatArray, triangles: IntArray) -> float:
    """Enclosed volume [mm^3], positive where the facets are turned outwards."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def solid_checks(vertices: FloatArray, triangles: IntArray) -> list[Check]:
    """Closed: each edge has two facets. Oriented: they traverse it in opposite directions."""
    checks = [_facets(vertices, triangles)]
    start = triangles.reshape(-1).astype(np.int64)
    end = np.roll(triangles, -1, axis=1).reshape(-1).astype(np.int64)
    count = len(vertices)
    key = np.minimum(start, end) * count + np.maximum(start, end)
    edges, place, used = np.unique(key, return_inverse=True, return_counts=True)
    place = place.reshape(-1)
    single = np.flatnonzero(used != 2)
    note = ""
    if len(single):
        edge = _edge_text(vertices, int(edges[single[0]]), count)
        note = f"the edge {edge} has {used[single[0]]} of 2 facets"
    checks.append(
        Check("closed", "", float(len(single)), None, 0.0, "open edges", not len(single), note)
    )
    forth = np.where(start < end, 1, -1)
    turned = np.bincount(place, weights=forth, minlength=len(edges))
    same = (used == 2) & (turned != 0.0)
    note = ""
    if np.any(same):
        note = _flipped_text(vertices, triangles, place, same)
    wrong = int(np.count_nonzero(same))
    checks.append(
        Check("oriented", "", float(wrong), None, 0.0, "edges run twice", not wrong, note)
    )
    if not len(single) and not wrong and not volume(vertices, triangles) > 0.0:
        checks.append(failed("oriented", "the mesh is turned inside out"))
    return checks


def upright_facets(corners: FloatArray, within: float = 0.0) -> BoolArray:
    """(m,) whether facets (m, 3, 3) have a vertical edge, `within` a length [mm]."""
    plane = corners[:, :, 0] + 1j * corners[:, :, 1]
    steep = np.abs(plane - np.roll(plane, 1, axis=1)) <= within
    # A short edge of a flat border is not one.
    steep &= np.abs(corners[:, :, 2] - np.roll(corners[:, :, 2], 1, axis=1)) > within
    found: BoolArray = steep.any(axis=1)
    return found


def upright(corners: FloatArray, within: float = 0.0) -> Check:
    """Each facet that is neither flat nor of a chamfer must have an edge that is vertical, `within`
    a length [mm].
    """
    found = upright_facets(corners, within)
    if found.all():
        return Check("walls", "", "upright", ok=True)
    first = corners[int(np.argmin(found))].mean(axis=0)
    count = counted(int(np.count_nonzero(~found)), "facet")
    return failed("walls", f"{count} neither flat nor upright, one near {point_text(first)} mm")


def levels_of(heights: FloatArray, within: float) -> tuple[IntArray, FloatArray]:
    """The numbers of the levels of `heights` [mm], ascending, in the same shape; and (k, 2) the
    least and greatest height of each level, in which each follows the one below `within` a length.
    """
    found, index = np.unique(heights, return_inverse=True)
    level = np.concatenate(([0], np.cumsum(np.diff(found) > within)))
    first = np.flatnonzero(np.diff(level, prepend=-1))
    last = np.append(first[1:] - 1, len(found) - 1)
    return level[index.reshape(heights.shape)], np.column_stack((found[first], found[last]))


def border_loops(triangles: IntArray) -> list[list[int]]:
    """Closed chains of the edges that belong to only one of `triangles` (m, 3)."""
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


def _facets(vertices: FloatArray, triangles: IntArray) -> Check:
    """No facet has two corners at the same place, or all three on a line."""
    same = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    bad = np.flatnonzero(same | (heights(vertices[triangles]) <= ROUNDING * np.abs(vertices).max()))
    note = ""
    if len(bad):
        place = point_text(vertices[triangles[bad[0], 0]])
        note = f"{len(bad)} of them have no area, facet {bad[0] + 1} at {place} mm among them"
    return Check("facets", "", float(len(triangles)), ok=not len(bad), note=note)


def _flipped_text(
    vertices: FloatArray,
    triangles: IntArray,
    place: IntArray,
    same: np.ndarray[tuple[int], np.dtype[np.bool_]],
) -> str:
    """Which facet is oriented against most of its neighbours."""
    against = same[place].reshape(-1, 3).sum(axis=1)
    facet = int(np.argmax(against))
    middle = vertices[triangles[facet]].mean(axis=0)
    return f"facet {facet + 1}, near {point_text(middle)} mm, is turned against its neighbours"


def _edge_text(vertices: FloatArray, key: int, count: int) -> str:
    one, other = divmod(key, count)
    return f"from {point_text(vertices[one])} mm to {point_text(vertices[other])} mm"


def point_text(point: FloatArray) -> str:
    """A `point` (3,) in a message."""
    return f"({', '.join(f'{value:.6g}' for value in point)})"
