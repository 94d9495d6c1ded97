"""A mesh held against the part: closed, upright, its heights, its boundaries, its volume."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import CamgeoError
from camgeo.files.product import Product
from camgeo.files.verification import Check, failed, near
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.part.part import Boundary, Part
from camgeo_export.solid.measure import border_loops
from camgeo_export.verify.mesh import merged, solid_checks, volume
from camgeo_export.verify.plane import contour_checks, matched
from camgeo_export.verify.shapes import Shape, shapes_of

Level = tuple[str, float, tuple[Boundary, ...]]


def body_checks(
    product: Product, vertices: FloatArray, triangles: IntArray, tolerance: float
) -> list[Check]:
    """All that is looked at of a body.

    Parameters
    ----------
    vertices, triangles : (n, 3) [mm] and (m, 3), as they stand in the file.
    tolerance : [mm].
    """
    part = product.part
    if part.thickness is None:
        note = "the scene has no part.thickness that the body could be held against"
        return [failed("body", note)]
    if not len(triangles) or not np.isfinite(vertices).all():
        return [failed("facets", "there are none, or one of their coordinates is not finite")]
    if np.min(triangles) < 0 or np.max(triangles) >= len(vertices):
        return [failed("facets", "one of them has a corner that is not among the vertices")]
    vertices, triangles = merged(vertices, triangles)
    checks = solid_checks(vertices, triangles)
    corners = vertices[triangles]
    flat: BoolArray = (corners[:, :, 2] == corners[:, :1, 2]).all(axis=1)
    checks.append(_walls(corners[~flat]))
    heights = sorted(set(corners[flat][:, 0, 2].tolist()))
    wanted = _levels(part, part.thickness)
    names = [name for name, _, _ in wanted]
    if len(heights) != len(wanted):
        note = f"flat faces at {len(heights)} heights, not at {len(wanted)}: {', '.join(names)}"
        checks.append(failed("height", note))
    else:
        shapes = shapes_of(part.boundaries, product.base_radius, tolerance)
        by_name = {shape.name: shape for shape in shapes}
        done: dict[tuple[str, bytes], None] = {}
        for height, (name, exact, boundaries) in zip(heights, wanted, strict=True):
            checks.append(near("height", height, exact, tolerance, "mm", name))
            level = triangles[flat & (corners[:, 0, 2] == height)]
            own = [by_name[boundary.name] for boundary in boundaries]
            checks += _level_checks(vertices, level, own, tolerance, name, done)
        checks += _volume(part, part.thickness, by_name, vertices, triangles, tolerance)
    return checks


def _levels(part: Part, thickness: float) -> list[Level]:
    """The flat faces: name, height [mm], boundaries."""
    levels: list[Level] = [("lower face", 0.0, part.through)]
    if part.groove:
        levels.append(("floor of the groove", thickness - part.groove_depth, part.groove))
    return [*levels, ("upper face", thickness, part.boundaries)]


def _walls(corners: FloatArray) -> Check:
    """Each facet that is not flat must have a vertical edge."""
    plane = corners[:, :, 0] + 1j * corners[:, :, 1]
    upright = (plane == np.roll(plane, 1, axis=1)).any(axis=1)
    if upright.all():
        return Check("walls", "", "upright", ok=True)
    first = corners[int(np.argmin(upright))].mean(axis=0)
    place = ", ".join(f"{value:.6g}" for value in first)
    count = int(np.count_nonzero(~upright))
    return failed("walls", f"{count} facets are neither flat nor upright, one round ({place}) mm")


def _level_checks(
    vertices: FloatArray,
    triangles: IntArray,
    shapes: list[Shape],
    tolerance: float,
    name: str,
    done: dict[tuple[str, bytes], None],
) -> list[Check]:
    """The boundaries of one face; those that another face had with the same points are known."""
    try:
        loops = border_loops(triangles)
    except (CamgeoError, KeyError) as error:
        note = f"the border of the face cannot be followed: {error}"
        return [failed("deviation", note, name)]
    pairs, count = matched([_contour(vertices[loop]) for loop in loops], shapes)
    checks = (
        []
        if count.ok
        else [Check("contours", name, count.value, count.expected, ok=False, note=count.note)]
    )
    for shape, contour in pairs:
        if contour is not None:
            assert isinstance(contour, Contour)  # polygons
            key = (shape.name, np.roll(contour.vertices, -_first(contour)).tobytes())
            if key in done:
                continue
            done[key] = None
        checks += contour_checks(shape, contour, tolerance, where=name)
    return checks


def _contour(points: FloatArray) -> Contour:
    vertices = points[:, 0] + 1j * points[:, 1]
    contour = Contour(vertices, np.zeros(len(vertices)), np.zeros_like(vertices))
    return contour.counter_clockwise()


def _first(contour: Contour) -> int:
    """The vertex at which to begin, the same wherever the loop was entered."""
    order = np.lexsort((contour.vertices.imag, contour.vertices.real))
    return int(order[0])


def _volume(
    part: Part,
    thickness: float,
    shapes: dict[str, Shape],
    vertices: FloatArray,
    triangles: IntArray,
    tolerance: float,
) -> list[Check]:
    """Exact areas times heights; off by the tolerance along all walls and on both faces at most."""
    if any(shapes[each.name].area is None for each in part.boundaries):
        return []
    body = _area(part.through, shapes)
    exact = body * thickness + _area(part.groove, shapes) * part.groove_depth
    walls = math.fsum(shapes[each.name].length for each in part.through) * thickness
    walls += math.fsum(shapes[each.name].length for each in part.groove) * part.groove_depth
    allowed = tolerance * (walls + 2.0 * body)
    return [near("volume", volume(vertices, triangles), exact, allowed, "mm^3")]


def _area(boundaries: tuple[Boundary, ...], shapes: dict[str, Shape]) -> float:
    """Sum of the areas [mm^2], holes negative; of a groove minus what it takes away."""
    return math.fsum(
        (shapes[each.name].area or 0.0) * (-1.0 if each.hole else 1.0) for each in boundaries
    )
