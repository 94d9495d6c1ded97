"""Curves and surfaces of solids along Z: level lines, circles and splines, walls and chamfers.

Places are complex in the plane XY, heights apart; all lengths in mm.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgeo.contour.spline import Arc, CubicSpline
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import phase
from camgeo_export.errors import FileError
from camgeo_export.part21.model import Entity, Model
from camgeo_export.part21.parabola import Parabola, Point

Strand = Arc | CubicSpline

ALIGNED = 1e-9
"""Length across its way by which a direction of length 1 along Z or across it may be off."""

RATIONAL = 1e-12
"""Weights that differ by a larger fraction make a spline rational."""

KNOTS = 100_000
"""Most knots of a spline with all multiplicities."""


@dataclass(frozen=True, slots=True)
class Axes:
    """Origin and third axis of a placement; where the first points does not matter here."""

    origin: Point
    axis: Point


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line."""

    origin: Point
    way: Point


@dataclass(frozen=True, slots=True)
class Circle:
    """A level circle; `turns` is 1 where it runs counter-clockwise seen from above, else -1."""

    centre: Point
    radius: float
    turns: float


@dataclass(frozen=True, slots=True)
class Spline:
    """A level spline."""

    curve: CubicSpline
    z: float


Curve = Line | Circle | Spline | Parabola


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane, level, upright or inclined."""

    origin: Point
    normal: Point


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder along Z; its normal points away from the axis."""

    centre: complex
    radius: float


@dataclass(frozen=True, slots=True)
class Cone:
    """A cone about an axis along Z; its normal points away from the axis.

    Attributes
    ----------
    centre : of the axis.
    radius : at the height `z` [mm].
    rise : by which the radius grows with the height, at each mm.
    """

    centre: complex
    radius: float
    z: float
    rise: float

    def radius_at(self, z: float) -> float:
        """Radius at a height [mm]."""
        return self.radius + self.rise * (z - self.z)


@dataclass(frozen=True, slots=True)
class Extrusion:
    """A spline drawn out along Z, upwards for `up` 1 and downwards for -1; the normal is to the
    right of the curve if upwards.
    """

    curve: CubicSpline
    up: float


Surface = Plane | Cylinder | Cone | Extrusion


@dataclass(frozen=True, slots=True)
class Geometry:
    """Reads geometry in units of `scale` mm and of `angle` rad."""

    model: Model
    scale: float
    angle: float = 1.0

    def point(self, ref: int) -> Point:
        """A point [mm]."""
        x, y, z = self._triple(self.model.entity(ref, "CARTESIAN_POINT"))
        return Point(complex(x, y) * self.scale, z * self.scale)

    def direction(self, ref: int) -> Point:
        """A direction of length 1."""
        found = self.model.entity(ref, "DIRECTION")
        x, y, z = self._triple(found)
        size = math.hypot(x, y, z)
        if not size > 0.0:
            raise found.fault("is of length 0")
        return Point(complex(x / size, y / size), z / size)

    def axes(self, ref: int) -> Axes:
        """A placement; without an axis it stands along Z, and without a first one it has some."""
        found = self.model.entity(ref, "AXIS2_PLACEMENT_3D")
        axis, first = (
            self.direction(found.ref(place)) if found.values[place : place + 1] != (None,) else None
            for place in (2, 3)
        )
        axis = axis or Point(0j, 1.0)
        if first is not None:
            along = (first.place * axis.place.conjugate()).real + first.z * axis.z
            if not abs(along) < 1.0 - ALIGNED:
                raise found.fault("has its first axis along its third")
        return Axes(self.point(found.ref(1)), axis)

    def curve(self, ref: int) -> Curve:
        """The curve of an edge; that of a curve on surfaces is its own in space."""
        found = self.model.entity(
            ref, "LINE", "CIRCLE", "B_SPLINE_CURVE_WITH_KNOTS", "SURFACE_CURVE", "SEAM_CURVE"
        )
        if found.kind in ("SURFACE_CURVE", "SEAM_CURVE"):
            found = self.model.entity(found.ref(1), "LINE", "CIRCLE", "B_SPLINE_CURVE_WITH_KNOTS")
        if found.kind == "LINE":
            vector = self.model.entity(found.ref(2), "VECTOR")
            return Line(self.point(found.ref(1)), self.direction(vector.ref(1)))
        if found.kind == "CIRCLE":
            axes = self.axes(found.ref(1))
            if abs(axes.axis.place) > ALIGNED:
                raise found.fault("is not level: only upright solids can be read")
            radius = self._radius(found)
            return Circle(axes.origin, radius, math.copysign(1.0, axes.axis.z))
        return self._spline(found.number)

    def surface(self, ref: int) -> Surface:
        """The surface of a face."""
        found = self.model.entity(
            ref, "PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "SURFACE_OF_LINEAR_EXTRUSION"
        )
        if found.kind == "SURFACE_OF_LINEAR_EXTRUSION":
            vector = self.model.entity(found.ref(2), "VECTOR")
            way = self.direction(vector.ref(1))
            if abs(way.place) > ALIGNED:
                raise found.fault("is not drawn out along Z")
            curve = self.curve(found.ref(1))
            if not isinstance(curve, Spline):
                raise found.fault("is not of a spline")
            return Extrusion(curve.curve, math.copysign(1.0, way.z))
        axes = self.axes(found.ref(1))
        if found.kind == "PLANE":
            return Plane(axes.origin, axes.axis)
        if abs(axes.axis.place) > ALIGNED:
            raise found.fault("does not stand along Z: only upright solids can be read")
        if found.kind == "CYLINDRICAL_SURFACE":
            return Cylinder(axes.origin.place, self._radius(found))
        angle = found.number_at(3) * self.angle
        if not 0.0 < angle < 0.5 * math.pi:
            raise found.fault("is no cone between a cylinder and a plane")
        radius = found.number_at(2) * self.scale
        rise = math.copysign(math.tan(angle), axes.axis.z)
        return Cone(axes.origin.place, radius, axes.origin.z, rise)

    def _triple(self, found: Entity) -> list[float]:
        numbers = found.numbers(1)
        if len(numbers) != 3:
            raise found.fault("does not have three coordinates")
        return numbers

    def _radius(self, found: Entity) -> float:
        radius = found.number_at(2) * self.scale
        if not radius > 0.0:
            raise found.fault("has no radius above 0")
        return radius

    def _spline(self, ref: int) -> Spline | Parabola | Line:
        """A spline with its knots; of several types, as those with weights are, or of one."""
        knots = self.model.entity(ref, "B_SPLINE_CURVE_WITH_KNOTS")
        if self.model.is_a(ref, "B_SPLINE_CURVE"):
            shape, first = self.model.entity(ref, "B_SPLINE_CURVE"), 0
        else:
            shape, first = knots, 1
        place = 0 if shape is not knots else 6
        if self.model.is_a(ref, "RATIONAL_B_SPLINE_CURVE"):
            weights = self.model.entity(ref, "RATIONAL_B_SPLINE_CURVE").numbers(0)
            if not weights or max(weights) - min(weights) > RATIONAL * max(map(abs, weights)):
                raise knots.fault("is rational: its weights differ")
        points = [self.point(each) for each in shape.refs(first + 1)]
        heights = [point.z for point in points] or [0.0]
        if max(heights) - min(heights) > ALIGNED:
            form = [shape.number_at(first), *knots.numbers(place), len(points)]
            if form == [2, 3, 3, 3]:
                return Parabola(*points)
            if form == [1, 2, 2, 2]:
                return _through(*points)
            raise knots.fault("is not level: only upright solids can be read")
        counts = [int(each) for each in knots.numbers(place)]
        values = knots.numbers(place + 1)
        whole = min(counts, default=0) >= 1 and sum(counts) <= KNOTS
        if len(counts) != len(values) or not whole:
            raise knots.fault("does not have as many knots as multiplicities above 0")
        degree = int(shape.number_at(first))
        try:
            curve = CubicSpline.of(
                degree,
                np.repeat(values, counts).astype(np.float64),
                np.array([point.place for point in points], dtype=np.complex128),
            )
        except (GeometryError, IndexError) as error:
            raise knots.fault(f"is not a spline that can be read: {error}") from None
        return Spline(curve, heights[0])


def _through(one: Point, other: Point) -> Line:
    """The line through two points of different heights."""
    along, up = other.place - one.place, other.z - one.z
    size = math.hypot(abs(along), up)
    return Line(one, Point(along / size, up / size))


def strands_of(
    curve: Curve, start: Point, end: Point, *, same: bool
) -> tuple[tuple[Strand, ...], float]:
    """The pieces of a level edge from `start` to `end`, arcs of half a turn at most, and how far
    [mm] its ends are from the curve.

    `same` says whether it has the direction of the curve. Raises FileError if it ends on the way
    along a spline.
    """
    if isinstance(curve, Line):
        along = end.place - start.place
        off = max(_off_line(curve, each) for each in (start, end))
        backwards = (along * curve.way.place.conjugate()).real < 0.0
        if backwards == same:  # it runs the other way
            off = math.inf
        return (Arc(start.place, end.place, 0.0, 0j),), off
    if isinstance(curve, Parabola):
        return (Arc(start.place, end.place, 0.0, 0j),), math.inf
    if isinstance(curve, Spline):
        found = curve.curve if same else curve.curve.reversed()
        off = max(
            abs(found.start - start.place),
            abs(found.end - end.place),
            abs(curve.z - start.z),
            abs(curve.z - end.z),
        )
        return (found.between(start.place, end.place),), off
    return _arcs_of(curve, start, end, same=same)


def _arcs_of(
    circle: Circle, start: Point, end: Point, *, same: bool
) -> tuple[tuple[Strand, ...], float]:
    centre = circle.centre.place
    turns = circle.turns if same else -circle.turns
    arms = (start.place - centre, end.place - centre)
    off = max(
        *(abs(abs(arm) - circle.radius) for arm in arms),
        *(abs(each.z - circle.centre.z) for each in (start, end)),
    )
    if not min(map(abs, arms)) > 0.0:
        raise FileError("an edge ends in the centre of its circle")
    turned = phase(arms[1] / arms[0]) * turns % (2.0 * math.pi)
    sweep = turned if start != end and turned > 0.0 else 2.0 * math.pi
    count = 1 if sweep <= math.pi * (1.0 + ALIGNED) else 2
    inner = [
        centre + circle.radius * arms[0] / abs(arms[0]) * cmath.exp(1j * turns * sweep * k / count)
        for k in range(1, count)
    ]
    places = pairwise([start.place, *inner, end.place])
    return tuple(Arc(a, b, turns * sweep / count, centre) for a, b in places), off


def _off_line(line: Line, point: Point) -> float:
    """Distance [mm] of a point from a line."""
    place, z = point.place - line.origin.place, point.z - line.origin.z
    way = line.way
    along = (place * way.place.conjugate()).real + z * way.z
    return math.hypot(abs(place - along * way.place), z - along * way.z)


def off_rising(line: Curve, start: Point, end: Point, *, same: bool) -> float:
    """How far [mm] the ends of an edge between two heights are from its line; infinite if it has
    none, or if the line runs the other way.
    """
    if isinstance(line, Parabola):
        return line.off_ends(*((start, end) if same else (end, start)))
    if not isinstance(line, Line) or ((end.z - start.z) * line.way.z > 0.0) != same:
        return math.inf
    return max(_off_line(line, each) for each in (start, end))


def off_surface(surface: Surface, place: complex, z: float) -> float:
    """Distance [mm] of a point from a surface; of an extrusion see `same_curve`."""
    if isinstance(surface, Plane):
        apart, normal = place - surface.origin.place, surface.normal
        return abs((apart * normal.place.conjugate()).real + (z - surface.origin.z) * normal.z)
    if isinstance(surface, Cylinder):
        return abs(abs(place - surface.centre) - surface.radius)
    if isinstance(surface, Cone):
        across = abs(abs(place - surface.centre) - surface.radius_at(z))
        return across / math.hypot(1.0, surface.rise)
    return 0.0


def apart(one: CubicSpline, other: CubicSpline) -> float:
    """Bound of the distance [mm] between two splines with the same knots; infinite otherwise."""
    if len(one.knots) != len(other.knots) or len(one.controls) != len(other.controls):
        return math.inf
    scale = (one.knots[-1] - one.knots[0]) / (other.knots[-1] - other.knots[0])
    shifted = one.knots[0] + (other.knots - other.knots[0]) * scale
    if np.max(np.abs(shifted - one.knots)) > RATIONAL * (one.knots[-1] - one.knots[0]):
        return math.inf
    return float(np.max(np.abs(one.controls - other.controls)))
