"""Areas that a cutter passes over, as polygons: for pictures, rests and collisions.

Arcs become chords within a `fineness` [mm], and so do the round ends of what is swept, so that an
area is off by up to twice that at its edge. GEOS thins its own input as well: below 1e-5 mm a finer
one gains nothing. Verdicts on the flanks of a part are exact ones, by its parallels.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final

import numpy as np
import shapely

from camgeo.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray, taken
from camgeo.toolpath.course import Course, alike, below

Area = Any
"""A polygon or several, of shapely, which has no types."""

FINEST: Final = 1e-5

NOTHING: Final = shapely.Polygon()

SHARE: Final = 0.005
"""Of a distance, to which the farthest point of an area is sought."""

LONGEST: Final = 200
"""Points of a line that is widened at once. A line of several turns is met by itself at every turn:
in parts its area takes a quarter of the time."""


def polygon(contours: Iterable[Contour], fineness: float) -> Area:
    """What lies within an odd number of `contours`."""
    found: Area = NOTHING
    for contour in contours:
        ring = contour.points(fineness)
        if len(ring) > 2:
            ring_area = shapely.Polygon(np.column_stack((ring.real, ring.imag)))
            found = shapely.symmetric_difference(found, shapely.make_valid(ring_area))
    return found


def swept(course: Course, radius: float, fineness: float) -> Area:
    """What a circle of `radius` [mm] passes over on `course`."""
    if not len(course) or radius <= 0.0:
        return NOTHING
    chains = (part for chain in _chains(_once(course), fineness) for part in _in_parts(chain))
    shapes = [_shape(part) for part in chains]
    found = shapely.buffer(shapes, radius, quad_segs=_quarter(radius, fineness))
    while len(found) > 1:  # neighbours first: half the time of all at once
        rest = found[len(found) // 2 * 2 :]
        found = np.append(shapely.union(found[:-1:2], found[1::2]), rest)
    return found[0]


Known = dict[tuple[float, float, bytes], tuple[Area, Area]]
"""What has been swept: areas and the same a little grown, by radius, fineness and pieces."""


def swept_below(
    course: Course, heights: Iterable[float], radius: float, fineness: float, known: Known
) -> list[Area]:
    """What a circle of `radius` [mm] passes over with its tip not above each of `heights` [mm],
    which ascend.

    What is new at a height is added to the area at the one before. Where nothing reaches beyond
    that by more than twice the fineness, as chords of the same path do, both are the same object,
    so that what follows is computed once for all slabs between passes. What equal pieces sweep is
    looked up in `known`, and added to it.
    """
    same = alike(course)
    highest, lowest = course.highest, course.lowest
    level = course.from_z == course.to_z
    done = np.zeros(len(course), dtype=np.bool_)
    area: Area = NOTHING
    wide: Area = NOTHING
    found = []
    for z in heights:
        fresh = (lowest <= z) & ~done[same]
        for which in (fresh & level, fresh & ~level):
            if not np.any(which):
                continue
            pieces = below(taken(course, which), z)
            more, more_wide = _swept_once(pieces, radius, fineness, known)
            if area.is_empty:
                area, wide = more, more_wide
            elif not shapely.covers(wide, more):
                area = shapely.union(area, more)
                wide = _wide(area, fineness)
        done[same[fresh & (highest <= z)]] = True
        found.append(area)
    return found


def _swept_once(course: Course, radius: float, fineness: float, known: Known) -> tuple[Area, Area]:
    """What is swept, looked up in `known` or added to it, and the same a little grown."""
    columns = (course.starts, course.ends, course.sweeps, course.centres)
    key = (radius, fineness, b"".join(each.tobytes() for each in columns))
    if key not in known:
        area = swept(course, radius, fineness)
        known[key] = area, _wide(area, fineness)
    return known[key]


def _wide(area: Area, fineness: float) -> Area:
    """`area` with what chords may leave at its edge, prepared for questions."""
    found = grown(area, 2.0 * fineness)
    shapely.prepare(found)
    return found


def disc(place: complex, radius: float, fineness: float) -> Area:
    """A circle."""
    point = shapely.Point(place.real, place.imag)
    return shapely.buffer(point, radius, quad_segs=_quarter(radius, fineness))


def grown(area: Area, distance: float) -> Area:
    """`area` with all that is nearer than `distance` [mm], or without its rim if that is negative.

    Round corners are chords within a hundredth of it.
    """
    return shapely.buffer(area, distance, quad_segs=6)


def parts(area: Area) -> list[Area]:
    """The polygons of an area, without lines and points."""
    return [
        each
        for each in shapely.get_parts(shapely.make_valid(area)).tolist()
        if each.geom_type == "Polygon" and each.area > 0.0
    ] if not area.is_empty else []  # fmt: skip


def place_in(area: Area) -> complex:
    """A point within the largest part of `area`."""
    point = shapely.point_on_surface(max(parts(area), key=lambda each: each.area))
    return complex(point.x, point.y)


def farthest(area: Area, edge: Area) -> tuple[float, complex]:
    """How far from `edge` a point of `area` lies at most [mm], and that point: of all points, not
    of its corners alone, to a hundredth.
    """
    corners = shapely.get_coordinates(area)
    away = shapely.distance(shapely.points(corners), edge)
    most = int(np.argmax(away))
    low, high, place = max(float(away[most]), FINEST), np.inf, complex(*corners[most])
    step = SHARE
    while high > (1.0 + SHARE) * low:
        middle = (1.0 + step) * low if np.isinf(high) else 0.5 * (low + high)
        beyond = shapely.difference(area, grown(edge, middle))
        if parts(beyond):
            low, place, step = middle, place_in(beyond), 1.0
        else:
            high = middle
    return float(shapely.distance(shapely.Point(place.real, place.imag), edge)), place


def rings(area: Area) -> tuple[ComplexArray, ...]:
    """All rings of `area`, outer and inner, as complex [mm]."""
    found = []
    for each in parts(area):
        for ring in (each.exterior, *each.interiors):
            points = shapely.get_coordinates(ring)
            found.append(points[:, 0] + 1j * points[:, 1])
    return tuple(found)


def _quarter(radius: float, fineness: float) -> int:
    """Chords of a quarter of a circle within `fineness`."""
    angle = 2.0 * np.arccos(max(0.0, 1.0 - max(fineness, FINEST) / radius))
    return max(4, int(np.ceil(0.5 * np.pi / angle)))


def _once(course: Course) -> Course:
    """The course without pieces that it repeats: further rounds of a path sweep nothing more, and
    what overlaps itself takes GEOS far longer.
    """
    first = alike(course) == np.arange(len(course))
    return course if np.all(first) else taken(course, first)


def _chains(course: Course, fineness: float) -> list[ComplexArray]:
    """Points along the course, one array for each part without a gap."""
    piece, ends = course.chords(max(fineness, FINEST))
    gaps = np.flatnonzero(course.starts[1:] != course.ends[:-1]) + 1
    starts = course.starts[np.concatenate(([0], gaps))]
    parts = np.split(ends, np.searchsorted(piece, gaps))
    return [np.concatenate(([start], part)) for start, part in zip(starts, parts, strict=True)]


def _in_parts(chain: ComplexArray) -> Iterator[ComplexArray]:
    """Parts of a chain, each from the end of the one before."""
    for first in range(0, max(len(chain) - 1, 1), LONGEST):
        yield chain[first : first + LONGEST + 1]


def _shape(chain: ComplexArray) -> Any:
    """A line through points, or the point that all of them are."""
    keep = np.concatenate(([True], np.diff(chain) != 0.0))
    points = np.column_stack((chain[keep].real, chain[keep].imag))
    return shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])


def overlap(areas: Sequence[Area], others: Sequence[Area]) -> np.ndarray[Any, Any]:
    """(n, m) areas [mm^2] that each of `areas` (n,) shares with each of `others` (m,)."""
    if not areas or not others:
        return np.zeros((len(areas), len(others)))
    first = np.array(areas, dtype=object)[:, None]
    second = np.array(others, dtype=object)[None, :]
    found: np.ndarray[Any, Any] = shapely.area(shapely.intersection(first, second))
    return found
