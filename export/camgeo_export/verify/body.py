"""A mesh compared with the part: closed, upright, its heights, its boundaries, its volume."""

from __future__ import annotations

import io
import math

import numpy as np
import trimesh

from camgeo.contour.contour import Contour
from camgeo.errors import CamgeoError, GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.part.part import Boundary, Part
from camgeo.product.product import Product
from camgeo.reading import COORDINATE
from camgeo.verifying.verification import Check, failed, near
from camgeo.wording import counted
from camgeo_export.verify.mesh import (
    border_loops,
    levels_of,
    merged,
    polygon,
    solid_checks,
    upright,
    volume,
)
from camgeo_export.verify.plane import contour_checks, matched
from camgeo_export.verify.shapes import Shape, shapes_of


def mesh_checks(product: Product, data: bytes, scale: float, tolerance: float) -> list[Check]:
    """All checks of the body in a 3MF package; `scale` [mm] is its unit."""
    try:
        with np.errstate(all="ignore"):  # transforms may overflow, which is seen in the vertices
            mesh = trimesh.load_mesh(io.BytesIO(data), file_type="3mf", process=False)
        vertices, triangles = np.array(mesh.vertices), np.array(mesh.faces)
    except Exception as error:  # what trimesh raises for damaged files is not documented
        return [failed("file", f"no mesh: {error}")]
    return body_checks(product, vertices * scale, triangles, tolerance)


def body_checks(
    product: Product, vertices: FloatArray, triangles: IntArray, tolerance: float
) -> list[Check]:
    """All checks of a body.

    Parameters
    ----------
    vertices, triangles : (n, 3) [mm] and (m, 3), as in the file.
    tolerance : [mm].
    """
    part = product.drawn.part
    try:
        wanted = part.levels
    except GeometryError as error:
        return [failed("body", f"there is none to compare it with: {error.message}")]
    if not len(triangles) or not np.abs(vertices).max(initial=0.0) <= COORDINATE:  # or NaN
        message = f"there are none, or a coordinate is not finite, or beyond {COORDINATE:g} mm"
        return [failed("facets", message)]
    if np.min(triangles) < 0 or np.max(triangles) >= len(vertices):
        return [failed("facets", "one of them has a corner that is not among the vertices")]
    vertices, triangles = merged(vertices, triangles)
    checks = solid_checks(vertices, triangles)
    corners = vertices[triangles]
    levels, ranges = levels_of(corners[:, :, 2], tolerance)
    flat: BoolArray = (levels == levels[:, :1]).all(axis=1)
    checks.append(upright(corners[~flat], tolerance))
    if len(ranges) != len(wanted):
        note = f"flat faces at {counted(len(ranges), 'height')}, not at {len(wanted)}: "
        note += ", ".join(level.name for level in wanted)
        checks.append(failed("height", note))
    else:
        shapes = shapes_of(part.boundaries, product.drawn.base_radius, tolerance)
        by_name = {shape.name: shape for shape in shapes}
        done: dict[tuple[str, bytes], None] = {}
        for number, level in enumerate(wanted):
            exact = level.z - wanted[0].z
            off = ranges[number] - exact
            height = exact + float(off[np.argmax(np.abs(off))])
            checks.append(near("height", height, exact, tolerance, "mm", level.name))
            faces = triangles[flat & (levels[:, 0] == number)]
            own = [by_name[boundary.name] for boundary in level.boundaries]
            checks += _level_checks(vertices, faces, own, tolerance, level.name, done)
        checks += _volume(part, by_name, vertices, triangles, tolerance)
    return checks


def _level_checks(
    vertices: FloatArray,
    triangles: IntArray,
    shapes: list[Shape],
    tolerance: float,
    name: str,
    done: dict[tuple[str, bytes], None],
) -> list[Check]:
    """The boundaries of one face; results of another face with the same points are reused."""
    try:
        loops = border_loops(triangles)
    except (CamgeoError, KeyError) as error:
        note = f"the boundary of the face cannot be traced: {error}"
        return [failed("deviation", note, name)]
    pairs, count = matched([polygon(vertices[loop]).counter_clockwise() for loop in loops], shapes)
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


def _first(contour: Contour) -> int:
    """The vertex at which to begin, independent of where the loop was entered."""
    order = np.lexsort((contour.vertices.imag, contour.vertices.real))
    return int(order[0])


def _volume(
    part: Part,
    shapes: dict[str, Shape],
    vertices: FloatArray,
    triangles: IntArray,
    tolerance: float,
) -> list[Check]:
    """Exact areas times heights; off by at most the tolerance along all faces."""
    if any(shape.area is None for shape in shapes.values()):
        return []
    volumes, faces = [], []
    for wall in part.walls:
        height = wall.z1 - wall.z0
        volumes.append(_area((wall.boundary,), shapes) * height)
        faces.append(shapes[wall.boundary.name].length * height)
    faces += [abs(_area(each.below, shapes) - _area(each.above, shapes)) for each in part.levels]
    exact, allowed = math.fsum(volumes), tolerance * math.fsum(faces)
    return [near("volume", volume(vertices, triangles), exact, allowed, "mm^3")]


def _area(boundaries: tuple[Boundary, ...], shapes: dict[str, Shape]) -> float:
    """Sum of the areas [mm^2], holes negative."""
    return math.fsum(
        (shapes[each.name].area or 0.0) * (-1.0 if each.hole else 1.0) for each in boundaries
    )
