"""A STEP file as far as camgeo writes them, read and meshed without any of its code.

Every claim of the file is checked on the way: each curve begins and ends at its vertices and runs
the way that is said, each edge lies on the surfaces of its two faces, and the normal of each face
points to the left of its loops. What is left is a mesh whose corners are points of the edges.
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

import manifold3d
import numpy as np
import trimesh
from scipy.interpolate import BSpline

from camgeo.numeric.arrays import FloatArray

STEP: Final = 0.05
"""Of points along an arc [rad]."""

SAMPLES: Final = 25
"""Points along a spline."""

CLOSE: Final = 2e-7
"""Within which all meets [mm]: twice the uncertainty that files state."""

TOKEN: Final = re.compile(
    r"#(?P<ref>\d+)|'(?P<text>(?:[^']|'')*)'|\.(?P<word>[A-Z_0-9]+)\.|(?P<kind>[A-Z_0-9]+)(?=\()"
    r"|(?P<number>[-+]?\d+\.?\d*(?:E[-+]?\d+)?)|(?P<mark>[(),$*])"
)


class Ref(int):
    """A reference to an entity."""


@dataclass(frozen=True)
class Typed:
    """An entity, or a value that names its type."""

    kind: str
    values: list[Any]


def values_of(text: str) -> list[Any]:
    """What stands between brackets, as nested lists."""
    stack: list[list[Any]] = [[]]
    kinds: list[str] = []
    kind = ""
    for found in TOKEN.finditer(text):
        group, word = found.lastgroup, found.group()
        if group == "kind":
            kind = word
        elif word == "(":
            kinds.append(kind)
            stack.append([])
            kind = ""
        elif word == ")":
            inner, own = stack.pop(), kinds.pop()
            stack[-1].append(Typed(own, inner) if own else inner)
        elif group == "ref":
            stack[-1].append(Ref(found["ref"]))
        elif group == "text":
            stack[-1].append(found["text"].replace("''", "'"))
        elif group == "word":
            stack[-1].append({"T": True, "F": False}.get(found["word"], found["word"]))
        elif group == "number":
            stack[-1].append(float(word) if "." in word else int(word))
        elif word in "$*":
            stack[-1].append(None)
    assert len(stack) == 1
    return stack[0]


@dataclass(frozen=True)
class Surface:
    """Of a face, in mm; `size` is the radius, `angle` that of a cone."""

    kind: str
    origin: FloatArray
    axis: FloatArray
    size: float = 0.0
    angle: float = 0.0
    directrix: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))

    def flat(self, points: FloatArray) -> FloatArray:
        """(n, 2) the points in a plane into which the surface unrolls, seen from its normal."""
        one = np.cross(self.axis, [0.36, 0.48, 0.8])
        one /= np.linalg.norm(one)
        other = np.cross(self.axis, one)
        arm = points - self.origin
        if self.kind == "PLANE":
            return np.column_stack((arm @ one, arm @ other))
        high = arm @ self.axis
        if self.kind == "SURFACE_OF_LINEAR_EXTRUSION":
            off = np.linalg.norm((self.directrix - points[:, None])[..., :2], axis=2)
            return np.column_stack((np.argmin(off, axis=1).astype(float), high))
        # About the middle of the face, so that it is not cut.
        turned = np.exp(1j * np.arctan2(arm @ other, arm @ one))
        middle = np.mean(turned)
        return np.column_stack((np.angle(turned / middle), high))

    def off(self, points: FloatArray) -> float:
        """Largest distance of points from the surface [mm]."""
        arm = points - self.origin
        high = arm @ self.axis
        if self.kind == "PLANE":
            return float(np.max(np.abs(high)))
        if self.kind == "SURFACE_OF_LINEAR_EXTRUSION":
            away = np.linalg.norm((self.directrix - points[:, None])[..., :2], axis=2)
            return float(np.max(np.min(away, axis=1)))
        radius = np.linalg.norm(arm - np.outer(high, self.axis), axis=1)
        expected = self.size + high * math.tan(self.angle)
        return float(np.max(np.abs(radius - expected))) * math.cos(self.angle)

    def normals(self, points: FloatArray) -> FloatArray:
        """(n, 3) at points, about."""
        if self.kind == "PLANE":
            return np.broadcast_to(self.axis, points.shape)
        if self.kind == "SURFACE_OF_LINEAR_EXTRUSION":
            off = np.linalg.norm((self.directrix - points[:, None])[..., :2], axis=2)
            ways = np.gradient(self.directrix, axis=0)[np.argmin(off, axis=1)]
            found = np.cross(ways, self.axis)
        else:
            arm = points - self.origin
            out = arm - np.outer(arm @ self.axis, self.axis)
            out /= np.linalg.norm(out, axis=1)[:, None]
            found = math.cos(self.angle) * out - math.sin(self.angle) * self.axis
        return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


@dataclass
class Face:
    """A face as it is read: triangles of places [mm]."""

    name: str
    surface: Surface
    loops: list[FloatArray]
    triangles: FloatArray


class Exchange:
    """A STEP file."""

    def __init__(self, data: bytes) -> None:
        text = data.decode("ascii")
        head, _, body = text.partition("ENDSEC;\nDATA;\n")
        body, _, tail = body.partition("ENDSEC;\n")
        assert head.startswith("ISO-10303-21;\nHEADER;\n")
        assert tail == "END-ISO-10303-21;\n"
        self.header = [values_of(line)[0] for line in head.splitlines()[2:]]
        self.entities: dict[int, list[Typed]] = {}
        for number, line in enumerate(body.splitlines(), start=1):
            found = re.fullmatch(r"#(\d+)=(.*);", line)
            assert found is not None
            assert int(found[1]) == number
            (value,) = values_of(found[2])
            self.entities[number] = [value] if isinstance(value, Typed) else value

    def all_of(self, kind: str) -> list[Typed]:
        return [each for own in self.entities.values() for each in own if each.kind == kind]

    def one_of(self, kind: str) -> Typed:
        (found,) = self.all_of(kind)
        return found

    def at(self, ref: Any, *kinds: str) -> Typed:
        """The entity that is referred to, of one of these kinds."""
        assert isinstance(ref, Ref)
        (found,) = (each for each in self.entities[ref] if each.kind in kinds)
        return found

    # Units and frame ------------------------------------------------------------------------------

    @cached_property
    def representation(self) -> Typed:
        return self.one_of("ADVANCED_BREP_SHAPE_REPRESENTATION")

    @cached_property
    def unit(self) -> float:
        """Millimetres of the unit of length."""
        context = self.representation.values[2]
        units = self.at(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT").values[0]
        length, angle, solid = units
        self.at(length, "LENGTH_UNIT")
        self.at(angle, "PLANE_ANGLE_UNIT")
        assert self.at(angle, "SI_UNIT").values == [None, "RADIAN"]
        self.at(solid, "SOLID_ANGLE_UNIT")
        assert self.at(solid, "SI_UNIT").values == [None, "STERADIAN"]
        return self.millimetres(length)

    def millimetres(self, length: Ref) -> float:
        kinds = {each.kind for each in self.entities[length]}
        if "SI_UNIT" in kinds:
            assert self.at(length, "SI_UNIT").values == ["MILLI", "METRE"]
            assert self.at(length, "NAMED_UNIT").values == [None]
            return 1.0
        name, measure = self.at(length, "CONVERSION_BASED_UNIT").values
        exponents = self.at(length, "NAMED_UNIT").values[0]
        assert self.at(exponents, "DIMENSIONAL_EXPONENTS").values == [1.0, *[0.0] * 6]
        factor, other = self.at(measure, "LENGTH_MEASURE_WITH_UNIT").values
        assert name == "INCH"
        assert factor.kind == "LENGTH_MEASURE"
        (size,) = factor.values
        return float(size) * self.millimetres(other)

    # Geometry -------------------------------------------------------------------------------------

    def point(self, ref: Ref) -> FloatArray:
        name, numbers = self.at(ref, "CARTESIAN_POINT").values
        assert name == ""
        return np.array(numbers) * self.unit

    def direction(self, ref: Ref) -> FloatArray:
        found = np.array(self.at(ref, "DIRECTION").values[1])
        assert abs(np.linalg.norm(found) - 1.0) < 1e-12
        return found

    def axes(self, ref: Ref) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Origin [mm], third and first direction."""
        _, origin, axis, first = self.at(ref, "AXIS2_PLACEMENT_3D").values
        third, one = self.direction(axis), self.direction(first)
        assert abs(third @ one) < 1e-12
        return self.point(origin), third, one

    def vertex(self, ref: Ref) -> FloatArray:
        return self.point(self.at(ref, "VERTEX_POINT").values[1])

    def edge(self, ref: Ref) -> FloatArray:
        """(n, 3) points of an edge from its start to its end [mm]."""
        _, start, end, curve, same = self.at(ref, "EDGE_CURVE").values
        ends = self.vertex(start), self.vertex(end)
        kinds = ("LINE", "CIRCLE", "B_SPLINE_CURVE_WITH_KNOTS")
        found = self.at(curve, *kinds)
        points = {"LINE": self.line, "CIRCLE": self.circle}.get(found.kind, self.spline)(
            found, ends if same else ends[::-1]
        )
        points = points if same else points[::-1]
        for there, here in zip(ends, (points[0], points[-1]), strict=True):
            assert np.linalg.norm(there - here) <= CLOSE
        points[0], points[-1] = ends
        return points

    def line(self, found: Typed, ends: tuple[FloatArray, FloatArray]) -> FloatArray:
        _, through, vector = found.values
        way = self.direction(self.at(vector, "VECTOR").values[1])
        assert self.at(vector, "VECTOR").values[2] == 1.0
        along = ends[1] - ends[0]
        assert along @ way > 0.0
        assert np.linalg.norm(np.cross(along, way)) <= CLOSE
        assert np.linalg.norm(np.cross(self.point(through) - ends[0], way)) <= CLOSE
        return np.array(ends)

    def circle(self, found: Typed, ends: tuple[FloatArray, FloatArray]) -> FloatArray:
        _, placed, radius = found.values
        origin, axis, first = self.axes(placed)
        second = np.cross(axis, first)
        angles = [math.atan2((each - origin) @ second, (each - origin) @ first) for each in ends]
        # A curve begins at its first axis: one that runs past it would cross its seam.
        assert abs(angles[0]) < 1e-6
        sweep = angles[1] % (2.0 * math.pi)
        turned = np.linspace(0.0, sweep, 2 + math.ceil(sweep / STEP))[:, None]
        return np.asarray(
            origin + self.unit * radius * (np.cos(turned) * first + np.sin(turned) * second)
        )

    def spline(self, found: Typed, ends: tuple[FloatArray, FloatArray]) -> FloatArray:
        _, degree, controls, form, closed, crossing, counts, knots, kind = found.values
        assert (closed, crossing, kind) == (False, False, "UNSPECIFIED")
        assert form == ("PARABOLIC_ARC" if degree == 2 else "UNSPECIFIED")
        places = np.array([self.point(each) for each in controls])
        assert len(places) + degree + 1 == sum(counts)
        curve = BSpline(np.repeat(knots, counts), places, degree)
        share = np.linspace(0.0, 1.0, SAMPLES * (len(knots) - 1) + 1)
        found_points: FloatArray = curve(knots[0] + (knots[-1] - knots[0]) * share)
        assert np.linalg.norm(found_points[0] - ends[0]) <= CLOSE
        return found_points

    def surface(self, ref: Ref) -> Surface:
        kinds = ("PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "SURFACE_OF_LINEAR_EXTRUSION")
        found = self.at(ref, *kinds)
        if found.kind == "SURFACE_OF_LINEAR_EXTRUSION":
            _, curve, vector = found.values
            own = self.at(curve, "B_SPLINE_CURVE_WITH_KNOTS")
            controls = own.values[2]
            ends = self.point(controls[0]), self.point(controls[-1])
            way = self.direction(self.at(vector, "VECTOR").values[1])
            return Surface(found.kind, ends[0], way, directrix=self.spline(own, ends))
        origin, axis, _ = self.axes(found.values[1])
        size, angle, *_ = [*found.values[2:], 0.0, 0.0]
        return Surface(found.kind, origin, axis, self.unit * size, angle)

    # Faces ----------------------------------------------------------------------------------------

    @cached_property
    def faces(self) -> list[Face]:
        _, (placed, solid), _ = self.representation.values
        origin, axis, first = self.axes(placed)
        assert np.array_equal([origin, axis, first], [[0, 0, 0], [0, 0, 1], [1, 0, 0]])
        (shell,) = [self.at(solid, "MANIFOLD_SOLID_BREP").values[1]]
        edges: dict[Ref, FloatArray] = {}
        uses: dict[Ref, list[bool]] = defaultdict(list)
        found = []
        for ref in self.at(shell, "CLOSED_SHELL").values[1]:
            name, bounds, surface, same = self.at(ref, "ADVANCED_FACE").values
            loops = []
            for number, bound in enumerate(bounds):
                kind = "FACE_BOUND" if number else "FACE_OUTER_BOUND"
                _, loop, forward = self.at(bound, kind).values
                assert forward is True
                course: list[FloatArray] = []
                for use in self.at(loop, "EDGE_LOOP").values[1]:
                    _, start, end, edge, ahead = self.at(use, "ORIENTED_EDGE").values
                    assert start is end is None
                    if edge not in edges:
                        edges[edge] = self.edge(edge)
                    uses[edge].append(ahead)
                    course.append(edges[edge] if ahead else edges[edge][::-1])
                for before, after in zip(course, [*course[1:], course[0]], strict=True):
                    assert np.array_equal(before[-1], after[0])
                loops.append(np.concatenate([each[:-1] for each in course]))
            own = self.surface(surface)
            found.append(self.face(name, own, loops, same=same))
        assert all(sorted(each) == [False, True] for each in uses.values())
        curves = {ref for ref, own in self.entities.items() if own[0].kind == "EDGE_CURVE"}
        assert curves == set(edges)
        return found

    def face(self, name: str, surface: Surface, loops: list[FloatArray], *, same: bool) -> Face:
        """With its loops counter-clockwise seen from where its normal points."""
        corners = np.concatenate(loops)
        assert surface.off(corners) <= 4.0 * CLOSE if surface.directrix.size == 0 else 0.02
        plane = surface.flat(corners)
        plane = plane if same else plane * [-1.0, 1.0]
        flats = np.split(plane, np.cumsum([len(each) for each in loops])[:-1])
        areas = [_area(each) for each in flats]
        assert areas[0] > 0.0
        assert all(each < 0.0 for each in areas[1:])
        triangles = corners[manifold3d.triangulate([np.ascontiguousarray(each) for each in flats])]
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        sizes = np.linalg.norm(normals, axis=1)
        wanted = surface.normals(np.mean(triangles, axis=1)) * (1.0 if same else -1.0)
        assert np.sum(normals * wanted) > 0.99 * np.sum(sizes)
        return Face(name, surface, loops, triangles)

    @property
    def mesh(self) -> trimesh.Trimesh:
        """All triangles."""
        corners = np.concatenate([each.triangles for each in self.faces]).reshape(-1, 3)
        places, index = np.unique(corners, axis=0, return_inverse=True)
        return trimesh.Trimesh(places, index.reshape(-1, 3), process=False)


def _area(points: FloatArray) -> float:
    x, y = points.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
