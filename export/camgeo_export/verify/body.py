"""A mesh compared with the part: closed, its walls, heights, boundaries, chamfers and volume."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
import trimesh

from camgeo.errors import CamgeoError, GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.part.boundaries import numbers_of
from camgeo.part.mass import volume_within
from camgeo.part.part import Boundary, Part
from camgeo.product.product import Product
from camgeo.reading import COORDINATE
from camgeo.verifying.verification import Check, failed, near, reported
from camgeo.wording import counted
from camgeo_export.errors import FileError
from camgeo_export.matching import AnyContour
from camgeo_export.verify.bevels import Slope, contours_of, slopes_of, sloping
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

PLACES = ("lower edge", "half way up", "upper edge")
"""Where a chamfer is compared."""


def mesh_checks(product: Product, data: bytes, scale: float, tolerance: float) -> list[Check]:
    """All checks of the body in a 3MF package; `scale` [mm] is its unit."""
    mesh = mesh_in(data, scale)
    return [mesh] if isinstance(mesh, Check) else body_checks(product, *mesh, tolerance)


def mesh_in(data: bytes, scale: float) -> tuple[FloatArray, IntArray] | Check:
    """Vertices (n, 3) [mm] and triangles (m, 3) of a 3MF package; a failed check if it has none."""
    try:
        with np.errstate(all="ignore"):  # transforms may overflow, which is seen in the vertices
            mesh = trimesh.load_mesh(io.BytesIO(data), file_type="3mf", process=False)
        vertices, triangles = np.array(mesh.vertices), np.array(mesh.faces)
    except Exception as error:  # what trimesh raises for damaged files is not documented
        return failed("file", f"no mesh: {error}")
    return vertices * scale, triangles


def body_checks(
    product: Product, vertices: FloatArray, triangles: IntArray, tolerance: float
) -> list[Check]:
    """All checks of a body for printing against the part as it is printed; see `checks_of_body`."""
    extent, checks = product.drawn.base_radius, compensation_checks(product)
    try:
        part = product.drawn.printed.target
    except GeometryError as error:
        return [*checks, no_body(error)]
    return checks + checks_of_body(part, extent, vertices, triangles, tolerance)


def no_body(error: GeometryError) -> Check:
    """The failed check of a file whose scene has no such body."""
    return failed("body", f"there is none to compare it with: {error.message}")


def compensation_checks(product: Product) -> list[Check]:
    """What the bodies were compensated for, if they were."""
    text = product.drawn.printed.text
    return [reported("compensation", text, note="by [print]")] if text else []


def checks_of_body(
    part: Part, extent: float, vertices: FloatArray, triangles: IntArray, tolerance: float
) -> list[Check]:
    """All checks of a body.

    Parameters
    ----------
    part : that it should be.
    extent : size of the part [mm], for limits.
    vertices, triangles : (n, 3) [mm] and (m, 3), as in the file.
    tolerance : [mm].
    """
    try:
        part.require_heights()
    except GeometryError as error:
        return [no_body(error)]
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
    slopes = slopes_of(part)
    leaning = sloping(vertices, triangles, ~flat, slopes, tolerance)
    checks.append(upright(corners[~flat & (leaning < 0)], tolerance))
    # Where a chamfer meets its wall, and between, there is no flat face.
    bare: BoolArray = np.zeros(len(ranges), dtype=np.bool_)
    for slope in slopes:
        bare |= (ranges[:, 0] >= slope.z0 - tolerance) & (ranges[:, 0] <= slope.z1 + tolerance)
    bare[levels[flat, 0]] = False
    numbers = np.where(flat, (np.cumsum(~bare) - 1)[levels[:, 0]], -1)
    ranges = ranges[~bare]

    def contours(number: int) -> list[AnyContour]:
        return [polygon(vertices[loop]) for loop in border_loops(triangles[numbers == number])]

    found = volume(vertices, triangles)
    checks += level_checks(part, extent, ranges, contours, found, tolerance)
    for number, slope in enumerate(slopes):
        own = triangles[leaning == number]
        checks += slope_checks(slope, extent, contours_of(vertices, own), tolerance)
    return checks


def slope_checks(
    slope: Slope,
    extent: float,
    contours: Iterator[Sequence[AnyContour]],
    tolerance: float,
    extra: float = 0.0,
) -> Iterator[Check]:
    """The edges of chamfers and their sections half way up, against the part; see `level_checks`.

    `contours` are those of lower edges, sections and upper edges; raises FileError.
    """
    try:
        found = list(contours)
    except FileError as error:
        yield failed("deviation", str(error), slope.name)
        return
    for place, own in enumerate(found):
        shapes = shapes_of(slope.edges(place), extent, tolerance)
        where = f"{PLACES[place]} of the {slope.name}"
        yield from _level_checks(partial(list, own), shapes, tolerance, extra, where, {})


def level_checks(
    part: Part,
    extent: float,
    ranges: FloatArray,
    contours: Callable[[int], Sequence[AnyContour]],
    volume: float,
    tolerance: float,
    extra: float = 0.0,
) -> list[Check]:
    """Flat faces, their boundaries, and the volume, against the part.

    Parameters
    ----------
    part : that the body should be.
    extent : size of the part [mm], for limits.
    ranges : (k, 2) least and greatest height [mm] of the flat faces at each level, ascending.
    contours : gives those that bound the flat faces at a level; raises CamgeoError or KeyError.
    volume : [mm^3].
    tolerance : [mm].
    extra : further contributions to the deviation [mm].
    """
    wanted = part.levels
    if len(ranges) != len(wanted):
        note = f"flat faces at {counted(len(ranges), 'height')}, not at {len(wanted)}: "
        note += ", ".join(level.name for level in wanted)
        return [failed("height", note)]
    shapes = shapes_of(part.outlines, extent, tolerance)
    by_name = {shape.name: shape for shape in shapes}
    done: dict[tuple[str, bytes], None] = {}
    checks = []
    for number, level in enumerate(wanted):
        exact = level.z - wanted[0].z
        off = ranges[number] - exact
        height = exact + float(off[np.argmax(np.abs(off))])
        checks.append(near("height", height, exact, tolerance, "mm", level.name))
        own = [by_name[boundary.name] for boundary in level.boundaries]
        found = partial(contours, number)
        checks += _level_checks(found, own, tolerance, extra, level.name, done)
    return checks + _volume(part, by_name, volume, tolerance)


def _level_checks(
    contours: Callable[[], Sequence[AnyContour]],
    shapes: list[Shape],
    tolerance: float,
    extra: float,
    name: str,
    done: dict[tuple[str, bytes], None],
) -> list[Check]:
    """The boundaries of one face; results of another face with the same points are reused."""
    try:
        found = [each.counter_clockwise() for each in contours()]
    except (CamgeoError, KeyError) as error:
        note = f"the boundary of the face cannot be traced: {error}"
        return [failed("deviation", note, name)]
    pairs, count = matched(found, shapes)
    checks = (
        []
        if count.ok
        else [Check("contours", name, count.value, count.expected, ok=False, note=count.note)]
    )
    for shape, contour in pairs:
        if contour is not None:
            key = (shape.name, numbers_of(contour))
            if key in done:
                continue
            done[key] = None
        checks += contour_checks(shape, contour, tolerance, extra=extra, where=name)
    return checks


def _volume(part: Part, shapes: dict[str, Shape], volume: float, tolerance: float) -> list[Check]:
    """Exact areas times heights; off by at most the tolerance along all faces."""
    if any(shape.area is None for shape in shapes.values()):
        return []
    volumes, faces = [], []
    for band in part.bands:
        height = band.z1 - band.z0
        ends = [_area((each,), shapes) for each in (band.lower, band.upper)]
        between = 0.5 * (ends[0] + ends[1])
        if band.wall.corner_radius is not None and not band.is_upright:
            between = math.copysign(volume_within(band) / height, ends[0])
        elif not band.is_upright:
            # The parallel of a smooth curve encloses A(t) with A'' = 2 pi.
            between -= math.copysign(math.pi * band.width**2 / 6.0, ends[0])
        volumes.append(between * height)
        slant = math.hypot(height, band.width)
        faces.append(max(shapes[each.name].length for each in (band.lower, band.upper)) * slant)
    faces += [abs(_area(each.below, shapes) - _area(each.above, shapes)) for each in part.levels]
    exact, allowed = math.fsum(volumes), tolerance * math.fsum(faces)
    return [near("volume", volume, exact, allowed, "mm^3")]


def _area(boundaries: tuple[Boundary, ...], shapes: dict[str, Shape]) -> float:
    """Sum of the areas [mm^2], holes negative."""
    return math.fsum(
        (shapes[each.name].area or 0.0) * (-1.0 if each.hole else 1.0) for each in boundaries
    )
