"""A mesh compared with the part: closed, its walls, heights, boundaries, chamfers and volume."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from camgeo.design.product import Product
from camgeo.design.verify import Check, failed, near, reported
from camgeo.errors import CamgeoError, FileError, GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.part.boundaries import contour_bytes
from camgeo.part.mass import chamfer_volume
from camgeo.part.part import Band, Boundary, Part
from camgeo.reading import COORDINATE
from camgeo.units import counted
from camgeo_export.reading import AnyContour
from camgeo_export.verify.plane import (
    Shape,
    boundary_shapes,
    contour_checks,
    deviation,
    matched,
)

PLACES = ("lower edge", "half way up", "upper edge")
"""Where a chamfer is compared."""


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
    """The failed check of a file for whose scene there is no body."""
    return failed("body", f"the scene has no body to compare the file with: {error.message}")


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
        message = f"there are no facets, or a coordinate is not finite or exceeds {COORDINATE:g} mm"
        return [failed("facets", message)]
    if np.min(triangles) < 0 or np.max(triangles) >= len(vertices):
        return [failed("facets", "a facet has a corner that is not among the vertices")]
    vertices, triangles = merged(vertices, triangles)
    checks = solid_checks(vertices, triangles)
    corners = vertices[triangles]
    levels, ranges = group_levels(corners[:, :, 2], tolerance)
    flat: BoolArray = (levels == levels[:, :1]).all(axis=1)
    slopes = part_slopes(part)
    leaning = slope_numbers(vertices, triangles, ~flat, slopes, tolerance)
    checks.append(upright_check(corners[~flat & (leaning < 0)], tolerance))
    # Where a chamfer meets its wall, and between, there is no flat face.
    bare: BoolArray = np.zeros(len(ranges), dtype=np.bool_)
    for slope in slopes:
        bare |= (ranges[:, 0] >= slope.z0 - tolerance) & (ranges[:, 0] <= slope.z1 + tolerance)
    bare[levels[flat, 0]] = False
    # Levels are numbered anew without the bare ones.
    numbers = np.where(flat, (np.cumsum(~bare) - 1)[levels[:, 0]], -1)
    ranges = ranges[~bare]

    def contours(number: int) -> list[AnyContour]:
        return [polygon(vertices[loop]) for loop in border_loops(triangles[numbers == number])]

    surfaces = Surfaces(ranges, contours, _chamfer_lookup(vertices, triangles, slopes, leaning))
    return checks + surfaces.checks(part, extent, volume(vertices, triangles), tolerance)


def _chamfer_lookup(
    vertices: FloatArray, triangles: IntArray, slopes: Sequence[Slope], numbers: IntArray
) -> Callable[[float, float], Iterator[list[Contour]]]:
    """The contours of a mesh's chamfers by their heights, see `Surfaces`; `numbers` (m,) are those
    of `slope_numbers`.
    """
    place = {(slope.z0, slope.z1): k for k, slope in enumerate(slopes)}
    return lambda low, high: chamfer_contours(vertices, triangles[numbers == place[low, high]])


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """The flat faces and the chamfers of a body, heights from that of the lowest face.

    Attributes
    ----------
    ranges : (k, 2) least and greatest height [mm] of the flat faces at each level, ascending.
    contours : gives those that bound the flat faces at a level; raises CamgeoError or KeyError.
    chamfer : gives those of the lower edges, the sections half way up and the upper edges of the
        chamfers between two heights [mm]; raises FileError.
    extra : further contributions to the deviation [mm].
    """

    ranges: FloatArray
    contours: Callable[[int], Sequence[AnyContour]]
    chamfer: Callable[[float, float], Iterator[Sequence[AnyContour]]]
    extra: float = 0.0

    def checks(self, part: Part, extent: float, volume: float, tolerance: float) -> list[Check]:
        """Flat faces, their boundaries, the volume and the chamfers, against the part.

        Parameters
        ----------
        part : that the body should be.
        extent : size of the part [mm], for limits.
        volume : [mm^3].
        tolerance : [mm].
        """
        checks = self._flat_checks(part, extent, volume, tolerance)
        for slope in part_slopes(part):
            checks += self._slope_checks(slope, extent, tolerance)
        return checks

    def _slope_checks(self, slope: Slope, extent: float, tolerance: float) -> Iterator[Check]:
        """The edges of chamfers and their sections half way up, against the part."""
        try:
            sections = list(self.chamfer(slope.z0, slope.z1))
        except FileError as error:
            yield failed("deviation", str(error), slope.name)
            return
        for place, contours in enumerate(sections):
            shapes = boundary_shapes(slope.edges(place), extent, tolerance)
            where = f"{PLACES[place]} of the {slope.name}"
            yield from _level_checks(
                partial(list, contours), shapes, tolerance, self.extra, where, {}
            )

    def _flat_checks(
        self, part: Part, extent: float, volume: float, tolerance: float
    ) -> list[Check]:
        wanted = part.levels
        if len(self.ranges) != len(wanted):
            count = counted(len(self.ranges), "height")
            names = ", ".join(level.name for level in wanted)
            return [failed("height", f"flat faces at {count}, not at {len(wanted)}: {names}")]
        by_name = {shape.name: shape for shape in boundary_shapes(part.outlines, extent, tolerance)}
        checked: dict[tuple[str, bytes], None] = {}
        checks = []
        for number, level in enumerate(wanted):
            exact = level.z - wanted[0].z
            deviations = self.ranges[number] - exact
            # The end of the range that deviates more.
            height = exact + float(deviations[np.argmax(np.abs(deviations))])
            checks.append(near("height", height, exact, tolerance, "mm", level.name))
            shapes = [by_name[boundary.name] for boundary in level.boundaries]
            contours = partial(self.contours, number)
            checks += _level_checks(contours, shapes, tolerance, self.extra, level.name, checked)
        return checks + _volume(part, by_name, volume, tolerance)

    def deviation(self, part: Part) -> float:
        """Largest proved deviation [mm] of flat faces and chamfers, in the plane and in height."""
        wanted, largest = part.levels, 0.0
        if len(self.ranges) != len(wanted):
            count = counted(len(self.ranges), "height")
            raise FileError(f"flat faces at {count}, expected {len(wanted)}")
        for number, level in enumerate(wanted):
            height_deviation = float(np.abs(self.ranges[number] - (level.z - wanted[0].z)).max())
            plane_deviation = deviation(self.contours(number), level.boundaries) + self.extra
            largest = max(largest, height_deviation, plane_deviation)
        for slope in part_slopes(part):
            for place, contours in enumerate(self.chamfer(slope.z0, slope.z1)):
                largest = max(largest, deviation(contours, slope.edges(place)) + self.extra)
        return largest


def _level_checks(
    contours: Callable[[], Sequence[AnyContour]],
    shapes: list[Shape],
    tolerance: float,
    extra: float,
    name: str,
    checked: dict[tuple[str, bytes], None],
) -> list[Check]:
    """The boundaries of one face; results of another face with the same points are reused."""
    try:
        loops = [contour.counter_clockwise() for contour in contours()]
    except (CamgeoError, KeyError) as error:
        return [failed("deviation", f"the boundary of the face cannot be traced: {error}", name)]
    pairs, count = matched(loops, shapes)
    checks = [] if count.ok else [replace(count, of=name)]
    for shape, contour in pairs:
        if contour is not None:
            key = (shape.name, contour_bytes(contour))
            if key in checked:
                continue
            checked[key] = None
        checks += contour_checks(shape, contour, tolerance, extra=extra, where=name)
    return checks


def _volume(part: Part, shapes: dict[str, Shape], volume: float, tolerance: float) -> list[Check]:
    """The check of the volume against exact areas times heights: it may deviate by the tolerance
    along all faces.
    """
    if any(shape.area is None for shape in shapes.values()):
        return []
    volumes, faces = [], []
    for band in part.bands:
        height = band.z1 - band.z0
        ends = [_area((boundary,), shapes) for boundary in (band.lower, band.upper)]
        mean_area = 0.5 * (ends[0] + ends[1])
        if band.wall.corner_radius is not None and not band.is_upright:
            mean_area = math.copysign(chamfer_volume(band) / height, ends[0])
        elif not band.is_upright:
            # Between its ends the parallel at t of a smooth curve encloses A(t) with A'' = 2 pi, so
            # the mean is below that of the ends by 2 pi width^2 / 12.
            mean_area -= math.copysign(math.pi * band.width**2 / 6.0, ends[0])
        volumes.append(mean_area * height)
        slant = math.hypot(height, band.width)
        faces.append(
            max(shapes[boundary.name].length for boundary in (band.lower, band.upper)) * slant
        )
    faces += [abs(_area(level.below, shapes) - _area(level.above, shapes)) for level in part.levels]
    exact, allowed = math.fsum(volumes), tolerance * math.fsum(faces)
    return [near("volume", volume, exact, allowed, "mm^3")]


def _area(boundaries: tuple[Boundary, ...], shapes: dict[str, Shape]) -> float:
    """Sum of the areas within boundaries [mm^2], those of holes negative."""
    return math.fsum(
        (shapes[boundary.name].area or 0.0) * (-1.0 if boundary.hole else 1.0)
        for boundary in boundaries
    )


# -- mesh -----------------------------------------------------------------------------------------
# Whether a mesh is one closed, outward body, or where it is not; the boundaries of its faces.


Vertex = TypeVar("Vertex")

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
    # Twice the area over the base.
    return np.asarray(doubled / np.where(longest > 0.0, longest, 1.0))


def volume(vertices: FloatArray, triangles: IntArray) -> float:
    """Enclosed volume [mm^3], positive where the facets are turned outwards."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    # Six times the signed volume of the tetrahedron of each facet and the origin is a (b x c).
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def solid_checks(vertices: FloatArray, triangles: IntArray) -> list[Check]:
    """Checks that the mesh is closed, each edge having two facets, and oriented: the two traverse
    their edge in opposite directions.
    """
    checks = [_facets(vertices, triangles)]
    start = triangles.reshape(-1).astype(np.int64)
    end = np.roll(triangles, -1, axis=1).reshape(-1).astype(np.int64)
    count = len(vertices)
    # One number for an edge in either direction.
    key = np.minimum(start, end) * count + np.maximum(start, end)
    edges, place, used = np.unique(key, return_inverse=True, return_counts=True)
    place = place.reshape(-1)
    single = np.flatnonzero(used != 2)
    note = ""
    if len(single):
        ends = [point_text(vertices[k]) for k in divmod(int(edges[single[0]]), count)]
        note = f"the edge from {ends[0]} mm to {ends[1]} mm has {used[single[0]]} of 2 facets"
    checks.append(
        Check("closed", "", float(len(single)), None, 0.0, "open edges", not len(single), note)
    )
    forth = np.where(start < end, 1, -1)
    # 0 where both facets of an edge traverse it in opposite directions.
    turned = np.bincount(place, weights=forth, minlength=len(edges))
    same = (used == 2) & (turned != 0.0)
    note = ""
    if np.any(same):
        # The facet that disagrees with most of its neighbours is the one that is turned.
        facet = int(np.argmax(same[place].reshape(-1, 3).sum(axis=1)))
        middle = point_text(vertices[triangles[facet]].mean(axis=0))
        note = f"facet {facet + 1}, near {middle} mm, is turned against its neighbours"
    wrong = int(np.count_nonzero(same))
    checks.append(
        Check("oriented", "", float(wrong), None, 0.0, "edges run twice", not wrong, note)
    )
    if not len(single) and not wrong and not volume(vertices, triangles) > 0.0:
        checks.append(failed("oriented", "the mesh is turned inside out"))
    return checks


def upright_facets(corners: FloatArray, tolerance: float = 0.0) -> BoolArray:
    """(m,) whether facets (m, 3, 3) have an edge that is vertical within `tolerance` [mm]."""
    plane = corners[:, :, 0] + 1j * corners[:, :, 1]
    steep = np.abs(plane - np.roll(plane, 1, axis=1)) <= tolerance
    # A short edge of a flat border is not a vertical one.
    steep &= np.abs(corners[:, :, 2] - np.roll(corners[:, :, 2], 1, axis=1)) > tolerance
    return np.asarray(steep.any(axis=1))


def upright_check(corners: FloatArray, tolerance: float = 0.0) -> Check:
    """The check that each facet that is neither flat nor of a chamfer has an edge that is vertical
    within `tolerance` [mm].
    """
    steep = upright_facets(corners, tolerance)
    if steep.all():
        return Check("walls", "", "upright", ok=True)
    first = corners[int(np.argmin(steep))].mean(axis=0)
    count = counted(int(np.count_nonzero(~steep)), "facet")
    return failed("walls", f"{count} neither flat nor upright, one near {point_text(first)} mm")


def group_levels(heights: FloatArray, tolerance: float) -> tuple[IntArray, FloatArray]:
    """The numbers of the levels of `heights` [mm], ascending, in the same shape; and (k, 2) the
    least and greatest height of each level. Heights are on one level if none is more than
    `tolerance` [mm] above the one below it.
    """
    unique, index = np.unique(heights, return_inverse=True)
    level = np.concatenate(([0], np.cumsum(np.diff(unique) > tolerance)))
    first = np.flatnonzero(np.diff(level, prepend=-1))
    last = np.append(first[1:] - 1, len(unique) - 1)
    return level[index.reshape(heights.shape)], np.column_stack((unique[first], unique[last]))


def border_loops(triangles: IntArray) -> list[list[int]]:
    """Closed chains of the edges that belong to only one of `triangles` (m, 3)."""
    start = triangles.reshape(-1).tolist()
    end = np.roll(triangles, -1, axis=1).reshape(-1).tolist()
    edges = set(zip(start, end, strict=True))
    # Inner edges occur in both directions.
    border = [edge for edge in zip(start, end, strict=True) if edge[::-1] not in edges]
    successors = dict(border)
    if len(successors) != len(border):
        raise FileError("boundaries of the mesh touch each other")
    return list(_rings(successors))


def _rings(successors: dict[Vertex, Vertex]) -> Iterator[list[Vertex]]:
    """The closed chains that `successors` form; KeyError if one is not closed."""
    while successors:
        first, following = successors.popitem()
        ring = [first]
        while following != first:
            ring.append(following)
            following = successors.pop(following)
        yield ring


def _facets(vertices: FloatArray, triangles: IntArray) -> Check:
    """The check that no facet has two corners at the same place, or all three on a line."""
    same = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    bad = np.flatnonzero(same | (heights(vertices[triangles]) <= ROUNDING * np.abs(vertices).max()))
    note = ""
    if len(bad):
        place = point_text(vertices[triangles[bad[0], 0]])
        note = f"{len(bad)} of them have no area, facet {bad[0] + 1} at {place} mm among them"
    return Check("facets", "", float(len(triangles)), ok=not len(bad), note=note)


def point_text(point: FloatArray) -> str:
    """A `point` (3,) in a message."""
    return f"({', '.join(f'{value:.6g}' for value in point)})"


# -- bevels ---------------------------------------------------------------------------------------
# The chamfers of a mesh: facets between two heights that are neither flat nor upright.
#
# Their edges are compared with those of the part, and so is their section half way up, where facets
# whose lower and upper edge do not match would sag most.


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


def part_slopes(part: Part) -> tuple[Slope, ...]:
    """The chamfers of a part, from the lowest upwards."""
    if not part.bevels:
        return ()
    base = part.layers[0].z0
    bands_by_heights: dict[tuple[float, float], list[Band]] = {}
    for band in part.bands:
        if not band.is_upright:
            bands_by_heights.setdefault((band.z0 - base, band.z1 - base), []).append(band)
    return tuple(
        Slope(*heights, tuple(bands_by_heights[heights])) for heights in sorted(bands_by_heights)
    )


def slope_numbers(
    vertices: FloatArray,
    triangles: IntArray,
    among: BoolArray,
    slopes: Sequence[Slope],
    tolerance: float,
) -> IntArray:
    """(m,) the numbers of the slopes to which facets belong, -1 for none.

    Leaning facets `among` (m,) these that are connected belong to a slope if they reach from its
    lower to its upper edge within `tolerance` [mm]; along bent corners they do in several steps.
    """
    numbers = np.full(len(triangles), -1)
    if not slopes:
        return numbers
    from scipy.sparse import coo_array  # only for parts with chamfers
    from scipy.sparse.csgraph import connected_components

    leaning = np.flatnonzero(among & ~upright_facets(vertices[triangles], tolerance))
    corners = triangles[leaning]
    # Facets are connected where they share a corner.
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
        there = (np.abs(low - slope.z0) <= tolerance) & (np.abs(high - slope.z1) <= tolerance)
        numbers[leaning[there[labels]]] = number
    return numbers


def chamfer_contours(vertices: FloatArray, triangles: IntArray) -> Iterator[list[Contour]]:
    """The lower edges, the sections half way up and the upper edges of a slope's facets (m, 3).

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
        raise FileError("a chamfer does not extend from a lower to an upper edge all the way round")
    yield [polygon(vertices[loop]) for loop in lower]
    yield [polygon(points) for points in _sections(vertices, triangles, middle)]
    yield [polygon(vertices[loop]) for loop in upper]


def _sections(vertices: FloatArray, triangles: IntArray, z: float) -> Iterator[FloatArray]:
    """The points (n, 3) at which edges cross the height `z`, loop by loop: each facet that crosses
    it joins two of them.
    """
    above = vertices[:, 2] > z
    successors: dict[tuple[int, int], tuple[int, int]] = {}
    for facet in triangles[above[triangles].any(axis=1) & ~above[triangles].all(axis=1)].tolist():
        # Edges are named from their lower to their upper end, so the falling edge of a facet is the
        # rising one of its neighbour.
        for k in range(3):
            one, other = facet[k], facet[(k + 1) % 3]
            if not above[one] and above[other]:
                rising = (one, other)
            elif above[one] and not above[other]:
                falling = (other, one)
        successors[rising] = falling
    try:
        rings = list(_rings(successors))
    except KeyError:
        raise FileError("the facets of a chamfer do not form a closed ring") from None
    for ring in rings:
        low, high = vertices[np.array(ring).T]
        share = (z - low[:, 2:]) / (high[:, 2:] - low[:, 2:])
        points = low + share * (high - low)
        yield points[np.any(points != np.roll(points, 1, axis=0), axis=1)]


# -- measure --------------------------------------------------------------------------------------
# A mesh read back, split into the boundaries of the part and compared with them.


SAME = 1e-6
"""Share of its size by which the heights of the edges of a chamfer may be rounded in a file."""


def measure(part: Part, vertices: FloatArray, triangles: IntArray) -> float:
    """Largest proved deviation [mm] of a body from the `part` that it should be, in the plane and
    in height.

    `vertices` (n, 3) [mm] and `triangles` (m, 3) as in the file. Raises FileError unless
    they form one closed, outward oriented body of flat faces, upright walls and chamfers.
    """
    try:
        part.require_heights()
    except GeometryError as error:
        raise FileError(f"the scene has no body to compare this with: {error.message}") from None
    if not np.isfinite(vertices).all():
        raise FileError("the mesh has coordinates that are not finite")
    vertices, triangles = merged(vertices, triangles)
    corners = vertices[triangles]
    flat = (corners[:, :, 2] == corners[:, :1, 2]).all(axis=1)
    slopes = part_slopes(part)
    numbers = slope_numbers(
        vertices, triangles, ~flat, slopes, SAME * (1.0 + np.abs(vertices).max())
    )
    walls = upright_check(corners[~flat & (numbers < 0)])
    for check in (*solid_checks(vertices, triangles), walls):
        if not check.ok:
            raise FileError(f"the mesh fails the check '{check.name}': {check.note}")
    heights = np.unique(corners[flat][:, 0, 2])

    def contours(number: int) -> list[AnyContour]:
        level = triangles[flat & (corners[:, 0, 2] == heights[number])]
        return [polygon(vertices[loop]) for loop in border_loops(level)]

    chamfers = _chamfer_lookup(vertices, triangles, slopes, numbers)
    return Surfaces(heights[:, None], contours, chamfers).deviation(part)
