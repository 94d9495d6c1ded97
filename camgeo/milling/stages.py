"""What a simulation of a milling program hands on: the material in slabs, and what is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import shapely

from camgeo.geometry.contour.contour import Contour
from camgeo.milling.course import Course, alike, below
from camgeo.milling.moves import Move, Point, Stop
from camgeo.numeric.arrays import ComplexArray, FloatArray, taken


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """An upright body between two heights [mm]; a point is in it if within an odd number of its
    contours.
    """

    name: str
    z0: float
    z1: float
    contours: tuple[Contour, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Slab:
    """The material between two heights [mm]."""

    z0: float
    z1: float
    material: Area

    @property
    def middle(self) -> float:
        """Height of its middle [mm]."""
        return 0.5 * (self.z0 + self.z1)

    def without(self, area: Area) -> Slab:
        """What is left when `area` is taken away."""
        if self.material.is_empty or area.is_empty:
            return self
        return replace(self, material=shapely.difference(self.material, area))


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """The material after an operation, slab by slab from the lowest."""

    operation: str
    slabs: tuple[Slab, ...]

    @property
    def volume(self) -> float:
        """Of the material [mm^3]."""
        return sum((slab.z1 - slab.z0) * float(slab.material.area) for slab in self.slabs)


@dataclass(frozen=True, slots=True)
class Flaw:
    """Something that a machinist would not accept.

    Attributes
    ----------
    name : "rapid", "plunge", "gouge", "obstacle", "depth", "shank", "loose" or "rest".
    operation : in which it arises.
    text : what is wrong, in words.
    value, limit : what was found and what is allowed, in `unit`.
    place : of its largest extent, in the part's coordinates; as the work lies where it is shown.
    watched : whether it is no fault, but something for the machinist to watch.
    """

    name: str
    operation: str
    text: str
    value: float
    limit: float
    place: Point
    unit: str = "mm"
    watched: bool = False

    @property
    def sentence(self) -> str:
        """In words, with its operation and its place."""
        x, y, z = self.place
        return f"{self.operation}: {self.text} at X {x:.4g}, Y {y:.4g}, Z {z:.4g} mm"

    @property
    def excess(self) -> float:
        """By how much the limit is missed."""
        return abs(self.value - self.limit)


def areas(slabs: Iterable[Slab]) -> list[Area]:
    """The material of each."""
    return [slab.material for slab in slabs]


def each_once(found: Callable[[Area], Area], several: Iterable[Area]) -> list[Area]:
    """What is `found` of each of `several`, once for those that are the same object."""
    several = list(several)
    known = {id(area): area for area in several}
    made = {key: found(area) for key, area in known.items()}
    return [made[id(area)] for area in several]


# -- setup ----------------------------------------------------------------------------------------
# What a simulation of a milling program is given: what each tool does, and what it starts from.


SLICES: Final = 4
"""Slabs of a point or of rounded corners at their lowest."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What one tool does: an operation.

    Attributes
    ----------
    name : of the operation.
    moves : in order, halts among them.
    radius : of the cutter [mm].
    point : height [mm] of its point or its rounded corners, below the full radius.
    rounded : whether that is a rounded corner, and not a cone.
    plunges : whether it may go straight down into material.
    shank : radius above the cutting edges, and their length [mm]; None if not known.
    obstacles : that no move may touch below their tops.
    start : where it stands before; None if the first move is a traverse.
    """

    name: str
    moves: tuple[Move | Stop, ...]
    radius: float
    point: float = 0.0
    rounded: bool = False
    plunges: bool = True
    shank: tuple[float, float] | None = None
    obstacles: tuple[Body, ...] = ()
    start: Point | None = None

    def radius_at(self, height: FloatArray) -> FloatArray:
        """(n,) radius [mm] at heights (n,) above the tip, that of the tip below it."""
        if self.point <= 0.0:
            return np.full(len(height), self.radius)
        up = np.clip(height, 0.0, self.point)
        if self.rounded:
            return self.radius - self.point + np.sqrt(up * (2.0 * self.point - up))
        return self.radius * up / self.point

    def slices(self, tip: float, top: float) -> list[float]:
        """Z [mm] from a tip up to a `top` between which the radius changes by equal steps or so."""
        share = np.arange(1, SLICES + 1) / SLICES
        if self.rounded:
            share = 1.0 - np.cos(0.5 * np.pi * share)
        high = self.point if self.rounded else min(self.point, max(top - tip, 0.0))
        return (tip + high * share).tolist() if high > 0.0 else []


@dataclass(frozen=True, slots=True, eq=False)
class Chamfer:
    """An edge of the part that a cone takes off.

    Attributes
    ----------
    run : of the cone; its moves do not matter.
    course : exact, of its tip, all at one height.
    top : Z above which it is to take nothing off [mm].
    turned : height of the part's other face [mm], if it was taken off from there: run, course and
        top are those of that side.
    """

    run: Run
    course: Course
    top: float
    turned: float | None = None

    def height(self, z: float) -> float:
        """A height of the side from which it was taken off, seen from this one; and back [mm]."""
        return z if self.turned is None else self.turned - z

    @property
    def heights(self) -> list[float]:
        """Between which the section of the part changes by equal steps or so [mm]."""
        own = self.run.slices(float(np.min(self.course.lowest)), self.top)
        return [self.height(z) for z in own]


@dataclass(frozen=True, slots=True, eq=False)
class Before:
    """What another side has left, seen from this one.

    Attributes
    ----------
    slabs : of the material, from the lowest.
    corners : heights [mm] between which rounded corners of its cutters were lowest.
    """

    slabs: tuple[Slab, ...]
    corners: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Setup:
    """What a program starts from, and what must come of it.

    Attributes
    ----------
    blank : contours, of which a point of it is within an odd number.
    top, bottom : of the blank, Z [mm].
    part : what must be left.
    held : outlines within which the blank is held all the time, beside the clamps and screws of
        each run; None if that is not to be judged.
    rim : contours of the strip along the outline of the blank by which it is held where nothing
        else holds it, as with tabs; None if it is not.
    fixture : whether a fixture below all of the blank is to hold what nothing else holds.
    chamfers : edges that the part lacks.
    lowest : Z below which no tip may go but for its point [mm]; None for no limit.
    joined : Z up to which waste may hold on to the part [mm]: tabs, a skin; None for none.
    hanging : Z from which on it may do so; None for none.
    before : what an earlier side has left of the blank; None for all of it.
    final : whether the part must be all there is in the end, and no other side follows.
    unfinished : walls that the stated operations of all sides leave unfinished, or roughed.
    known : whether the outline of the blank is stated, and not one that reaches beyond all cuts.
    density : of the material [t/mm^3]; None if it is not stated.
    """

    blank: tuple[Contour, ...]
    top: float
    bottom: float
    part: tuple[Body, ...] = ()
    held: tuple[tuple[Contour, ...], ...] | None = None
    rim: tuple[Contour, ...] | None = None
    fixture: bool = False
    chamfers: tuple[Chamfer, ...] = ()
    lowest: float | None = None
    joined: float | None = None
    hanging: float | None = None
    before: Before | None = None
    final: bool = True
    unfinished: tuple[Contour, ...] = ()
    known: bool = True
    density: float | None = None


# -- sweep ----------------------------------------------------------------------------------------
# Areas that a cutter passes over, as polygons: for pictures, rests and collisions.
#
# Arcs become chords within a `fineness` [mm], and so do the round ends of what is swept, so that an
# area is off by up to twice that at its edge. GEOS thins its own input as well: below 1e-5 mm a
# finer one gains nothing. Verdicts on the flanks of a part are exact ones, by its parallels.


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
