"""STEP: one closed shell for parts of any layers, by a reader of the tests; each fault is found."""

from __future__ import annotations

import math
import re
from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Final

import manifold3d
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline
from scipy.ndimage import label

from camgeo.cam.cam import Contact
from camgeo.design.product import Product
from camgeo.design.verify import Check, ReadingOptions
from camgeo.errors import FileError, GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import CubicSpline, SplineContour
from camgeo.numeric.arrays import FloatArray
from camgeo.part.assembly import bore_boundary
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.mass import Solid
from camgeo.part.part import Bevel, Layer, Part
from camgeo.part.spec import (
    Chamfer,
    Chamfers,
    Counterbore,
    DShaft,
    Holes,
    Hub,
    Keyway,
    Mark,
    PartSpec,
)
from camgeo.scene.formats.step import StepSpec
from camgeo_export.part21 import Solid as StepSolid
from camgeo_export.step import writer
from camgeo_export.step.writer import WRITER
from camgeo_export.verify.step import level_bounds, volume_by_levels
from tests.export.stub_product import CircleBoundary, StubProduct
from tests.export.test_dxf import SPLINES
from tests.export.test_solids import BODIES, BORE, POCKETS, RIM
from tests.export.verified import TOLERANCE, VERIFIERS, read_back, require_moments
from tests.long_form import examples
from tests.measuring import Outline
from tests.part.parts import made

# A STEP file as far as camgeo writes them, read and meshed without any of its code ----------------


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


# The files ----------------------------------------------------------------------------------------


def test_a_spline_that_is_closed_is_divided() -> None:
    """A shell has no edge that ends where it begins."""
    knots = np.array([0.0] * 4 + [1.0, 2.0, 3.0] + [4.0] * 4)
    controls = np.array([30, 30 + 20j, 40j, -50, -40j, 30 - 20j, 30], dtype=complex)
    contour = SplineContour((CubicSpline(knots, controls),))
    strands = writer._open(contour)
    assert len(strands) == 2
    assert SplineContour(strands).area == pytest.approx(contour.area, rel=1e-15)


def test_walls_of_splines_are_counted_and_bound_field_by_field() -> None:
    product = replace(SPLINES["mm"], step=StepSpec("spline"))
    written = read_back(WRITER, product)
    drawn = product.part.boundaries[0].spline(0.98 * TOLERANCE).contour
    assert written.facts["splines"] == len(drawn.splines)
    text = written.data.decode()
    for kind, fields in (
        ("B_SPLINE_CURVE_WITH_KNOTS", (".UNSPECIFIED.", ".F.")),
        ("SURFACE_OF_LINEAR_EXTRUSION", ()),
    ):
        found = re.search(rf"#(\d+)={kind}\((.*)\);", text)
        assert found is not None
        for own in FIELD.finditer(text, found.start(2), found.end(2)):
            if own.group() not in (*fields, "''"):
                changed = text[: own.start()] + _changed(own.group()) + text[own.end() :]
                with pytest.raises(FileError):
                    WRITER.measure(product, changed.encode())


def test_a_closed_cavity_is_refused() -> None:
    layers = [Layer(-10.0, -8.0, (RIM, BORE)), Layer(-2.0, 0.0, (RIM, BORE))]
    hollow = Layer(-8.0, -2.0, (RIM, BORE, POCKETS[0]), "cavity")
    product = StubProduct(given=Part((layers[0], hollow, layers[1])))
    with pytest.raises(GeometryError, match="one body without closed cavities"):
        WRITER.write(product, TOLERANCE)


SOLID, OPEN, RINGED = "solid", "open", "with an island"

ISLANDS = tuple(
    CircleBoundary(f"island {k}", False, 2.0, pocket.centre) for k, pocket in enumerate(POCKETS)
)

ACROSS = {SOLID: [1, 1], OPEN: [0, 0], RINGED: [1, 0]}
"""Whether the middle of a pocket is solid, and the ring around it."""


@given(st.lists(st.tuples(*[st.sampled_from((SOLID, OPEN, RINGED))] * 2), min_size=1, max_size=4))
@settings(max_examples=examples(12, long=300), deadline=None)
def test_random_layers_are_one_solid_or_are_refused(slices: list[tuple[str, str]]) -> None:
    """Refused if the material falls apart, or holds a cavity; else closed and of its volume."""
    layers = []
    for number, kinds in enumerate(slices):
        boundaries = [RIM]
        for place, kind in enumerate(kinds):
            boundaries += [POCKETS[place]] if kind != SOLID else []
            boundaries += [ISLANDS[place]] if kind == RINGED else []
        layers.append(Layer(2.0 * number, 2.0 * number + 2.0, tuple(boundaries), f"{number}"))
    product = StubProduct(given=Part(tuple(layers)))
    # From the middle of one pocket to that of the other; what is outside goes round behind a wall.
    section = np.array([[*ACROSS[one], 1, *ACROSS[other][::-1]] for one, other in slices])
    walled = np.pad(section, ((0, 0), (0, 1)), constant_values=1)
    if any(label(each)[1] > 1 for each in (section, 1 - np.pad(walled, ((1, 1), (0, 1))))):
        with pytest.raises(GeometryError, match="one body without closed cavities"):
            WRITER.write(product, 0.1)
        return
    written = WRITER.write(product, 0.1)
    assert WRITER.measure(product, written.data) <= 0.1
    areas = {SOLID: 0.0, OPEN: 25.0, RINGED: 25.0 - 4.0}
    volume = 2.0 * math.pi * sum(1600.0 - sum(areas[kind] for kind in kinds) for kinds in slices)
    assert volume_by_levels(level_bounds(StepSolid.from_bytes(written.data)), ()) == pytest.approx(
        volume, rel=0.01
    )


def test_names_are_those_of_the_part_in_any_script() -> None:
    product = StubProduct(name="Nockenhebel für Ø8, 凸轮 '𝛼' \\ a")
    data = WRITER.write(product, TOLERANCE).data
    assert data.isascii()
    assert rb"\X2\00FC\X0\r \X2\00D8\X0\8, \X2\51F88F6E\X0\ ''\X4\0001D6FC\X0\'' \\ a" in data
    solid = StepSolid.from_bytes(data)
    assert (solid.name, solid.products) == (product.name, (product.name,))
    assert {face.name for face in solid.faces} == {"lower face", "upper face", "outline", "bore"}
    assert WRITER.measure(product, data) <= TOLERANCE


def test_what_is_almost_straight_is_a_line_or_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A radius of 1e10 mm has a centre that doubles cannot place to 1e-7 mm."""

    def product(sagitta: float) -> Product:
        corners = np.array([50.0 + 50.0j, -50.0 + 50.0j, -50.0 - 50.0j, 50.0 - 50.0j])
        sweeps = np.array([8.0 * sagitta / 100.0, 0.0, 0.0, 0.0])
        outline = ExactBoundary("outline", hole=False, exact=Contour.through(corners, sweeps))
        return StubProduct(given=Part((Layer(-5.0, 0.0, (outline,)),)))

    written = WRITER.write(product(1.25e-7), 1e-3)
    assert written.facts["cylinders"] == 0
    assert WRITER.measure(product(1.25e-7), written.data) <= 1e-3
    with pytest.raises(ToleranceError, match="too flat for the number format of the file"):
        WRITER.write(product(1.25e-7), 1e-6)
    curved = WRITER.write(product(1.25e-3), 1e-3)
    assert curved.facts["cylinders"] == 1
    assert WRITER.measure(product(1.25e-3), curved.data) <= 1e-9
    monkeypatch.setattr(writer, "SAGITTA", 0.0)
    with pytest.raises(ToleranceError, match="too flat"):
        WRITER.write(product(1.25e-7), 1e-3)


def test_the_file_of_a_cad_program_is_read_wherever_it_lies_along_z() -> None:
    """Another origin, other names, entities that belong to nothing, 3 mm higher."""
    text = WRITER.write(StubProduct(), TOLERANCE).data.decode()
    text = text.replace("'camgeo 0.0.test'", "'another program'").replace("eccentric", "Part1")
    text = text.replace("ENDSEC;\nEND", "#99999=DIRECTION('',(1.,0.,0.));\nENDSEC;\nEND")

    def higher(found: re.Match[str]) -> str:
        x, y, z = found.group(1).split(",")
        return f"CARTESIAN_POINT('',({x},{y},{float(z) + 3.0!r}))"

    text = re.sub(r"CARTESIAN_POINT\('',\(([^)]*)\)\)", higher, text)
    data = text.encode()
    assert not VERIFIERS["step"].origin(data).version
    checks = VERIFIERS["step"].checks(StubProduct(), data, ReadingOptions("file"), TOLERANCE)
    assert [check.name for check in checks if check.ok is False] == []


# Faults -------------------------------------------------------------------------------------------

PRODUCT = StubProduct()

LINES = WRITER.write(PRODUCT, TOLERANCE).data.decode().splitlines()

FIELD = re.compile(r"#\d+|-?\d+\.\d*(?:E-?\d+)?|'(?:[^']|'')*'|\.[A-Z]+\.|\b\d+\b")

HARMLESS = {
    ("VECTOR", "1."),  # it only shows a direction
    ("DIRECTION", "1."),  # which may have any length
}
"""Fields of a solid that say nothing about its shape: no measure need find their change."""

BEGIN, END = (
    next(k for k, line in enumerate(LINES) if word in line)
    for word in ("REPRESENTATION_CONTEXT", "MANIFOLD_SOLID_BREP")
)
"""The lines of the solid lie between these, or are the last of them."""

SHARES = 5


def _harmless(kind: str, field: str, text: str) -> bool:
    """Also the place of a plane's origin in it, and where a first axis points across the third."""
    if (kind, field) in HARMLESS or field.startswith("'"):
        return True
    planes = re.search(r"=CARTESIAN_POINT\('',\((0\.03,0\.|0\.,0\.03),8\.\)\);", text)
    firsts = re.search(r"=DIRECTION\('',\(1\.,(0\.03,0\.|0\.,0\.03)\)\);", text)
    return bool(planes or firsts)


def _kind(line: str) -> str:
    found = re.match(r"(?:#\d+=)?\(?([A-Z0-9_]+)", line)
    assert found is not None
    return found.group(1)


def _fields() -> list[tuple[int, int]]:
    """Lines and starts of fields: of each kind of entity of the solid those of the first and the
    last.
    """
    chosen: dict[str, list[int]] = {}
    for number in range(BEGIN + 1, END + 1):
        chosen.setdefault(_kind(LINES[number]), []).append(number)
    found = []
    for numbers in chosen.values():
        for number in sorted({numbers[0], numbers[-1]}):
            line = LINES[number]
            first = line.index("=") + 1
            found += [(number, field.start()) for field in FIELD.finditer(line, first)]
    return found


def _changed(field: str) -> str:
    if field.startswith("#"):
        return f"#{int(field[1:]) - 1 or 2}"
    if field.startswith("'"):
        return f"'{field[1:-1]}x'"
    if field.startswith("."):
        return {".T.": ".F.", ".F.": ".T.", ".MILLI.": ".CENTI."}.get(field, ".OTHER.")
    if "." not in field:
        return str(int(field) + 1)
    return repr(1.01 * float(field) + 0.03)


def _measured(text: str) -> list[Check]:
    """What fails of a file by its shape alone."""
    data = text.encode()
    if damage := VERIFIERS["step"].origin(data).damage:
        return [Check("file", ok=False, note=damage)]
    checks = VERIFIERS["step"].checks(PRODUCT, data, ReadingOptions("file"), TOLERANCE)
    return [check for check in checks if check.ok is False]


@pytest.mark.parametrize("part", range(examples(1, long=SHARES)))
def test_each_field_that_is_changed_is_measured(part: int) -> None:
    """A share of the fields, all of them in the long form."""
    missed = []
    for number, start in _fields()[part::SHARES]:
        line = LINES[number]
        found = FIELD.match(line, start)
        assert found is not None
        field = found.group()
        text = line[:start] + _changed(field) + line[found.end() :]
        lines = [*LINES[:number], text, *LINES[number + 1 :]]
        if not _measured("\n".join(lines)):
            missed.append((_kind(line), field, text))
    assert [each for each in missed if not _harmless(*each)] == []


def test_a_line_that_is_left_out_is_found() -> None:
    for number in range(END, BEGIN, -37):
        lines = [*LINES[:number], *LINES[number + 1 :]]
        assert _measured("\n".join(lines))


def test_a_shell_inside_out_is_found() -> None:
    """All faces and loops turned: closed and oriented, but around the outside."""
    text = "\n".join(LINES)
    for kind in ("ADVANCED_FACE", "FACE_OUTER_BOUND", "FACE_BOUND"):
        text = re.sub(
            rf"(={kind}\(.*)\.([TF])\.\);",
            lambda found: f"{found[1]}.{'F' if found[2] == 'T' else 'T'}.);",
            text,
        )
    found = {each.name: each.note for each in _measured(text)}
    assert found["outwards"] == "the shell is turned inside out"


def test_another_height_or_no_groove() -> None:
    data = WRITER.write(StubProduct(thickness=8.5), TOLERANCE).data
    assert WRITER.measure(StubProduct(), data) == pytest.approx(0.5)
    data = WRITER.write(StubProduct(), TOLERANCE).data.replace(b"'outline'", b"'rim'")
    with pytest.raises(FileError, match="flat faces at 2 heights, expected 3"):
        WRITER.measure(StubProduct(groove=True), data)


# By the reader of the tests: every entity, every face, and the whole body -------------------------


CHORDS = 1e-3
"""Share of a volume by which meshes of points on its edges may be off."""


def edged(boundary: ExactBoundary, width: float, *ends: float) -> list[Bevel]:
    """Chamfers at the height 0, and below."""
    edge = boundary.inset(width, f"chamfer of the {boundary.name}")
    return [Bevel(boundary, edge, width, width, z, upper=z == 0.0) for z in ends]


def of(outline: ExactBoundary, hole: ExactBoundary) -> Part:
    """A plate of 8 mm: the outline with two chamfers, the hole with an upper one."""
    bevels = (*edged(outline, 0.5, 0.0, -8.0), *edged(hole, 1.0, 0.0))
    return Part((Layer(-8.0, 0.0, (outline, hole)),), bevels)


ROUND = ExactBoundary("outline", False, Contour.circle(30.0, -5j))

SQUARE = ExactBoundary("outline", False, Contour.polygon(40.0 * np.exp(1j * (0.3 + np.pi / 2
                       * np.arange(4)))))  # fmt: skip

WINDOW = ExactBoundary("window", True, Contour.polygon(
    np.array([-6 - 4j, 9 - 5j, 8 + 6j, -5 + 3j])))  # fmt: skip

BENDS = Contour.through(np.array([-30 - 20j, 30 - 20j, 30 + 20j, -30 + 20j]),
                        np.array([0.0, math.pi, 0.0, math.pi]))  # fmt: skip
"""A slot of 60 mm by 40 mm with round ends."""

FULL = PartSpec(
    thickness=10.0, bore=16.0, keyway=Keyway(5.0, 2.3, 0.4), rim=140.0, groove_depth=4.0,
    hub=Hub(28.0, 6.0, "both"), mark=Mark(66.5, 2.0, 0.6, 5.0, 0.9),
    bolt_circle=Holes(3, 46.0, 4.0, 0.2, Counterbore(7.0, 3.0)),
    chamfers=Chamfers(outline=Chamfer(0.5), rim=Chamfer(0.7), bore=Chamfer(0.4, "upper"),
                      hub=Chamfer(0.3), bolt_circle=Chamfer(0.25)),
)  # fmt: skip

PARTS: dict[str, Part] = {
    "circle and keyway": of(ROUND, bore_boundary(16.0, Keyway(5.0, 2.3, 0.7))),
    "circle and flat": of(ROUND, bore_boundary(16.0, None, DShaft(13.0, -1.0))),
    "straight edges": of(SQUARE, WINDOW),
    "lines and arcs that are tangent": of(
        ExactBoundary("outline", False, BENDS), ExactBoundary("bore", True, Contour.circle(8.0))
    ),
    "all features": made(Contact.GROOVE, FULL),
    "a ring": made(Contact.OUTER, replace(FULL, hub=None, mark=None, bolt_circle=None,
                                          chamfers=Chamfers(outline=Chamfer(0.5, "lower")))),
    **BODIES,
}  # fmt: skip


@cache
def product(name: str, unit: str = "mm") -> StubProduct:
    return StubProduct(given=PARTS[name], effort="fast", unit="inch" if unit == "inch" else "mm")


@pytest.mark.parametrize("name", PARTS)
def test_each_file_is_the_whole_part(name: str) -> None:
    part, unit = PARTS[name], "inch" if "flat" in name or "straight" in name else "mm"
    written = read_back(WRITER, product(name, unit), least=0.0)
    file = Exchange(written.data)
    assert file.unit == (25.4 if unit == "inch" else 1.0)
    check_body(file, part, dict(written.facts))
    bottom = part.layers[0].z0
    walls = {each.name: each for each in part.boundaries}
    edges = {each.edge.name: each for each in part.bevels}
    levels = {(each.name, each.z - bottom) for each in part.levels}
    fits = {name: each.arcs(1e-4, "fast").contour for name, each in walls.items()}
    drawn = {name: Outline.through(each.vertices, each.sweeps) for name, each in fits.items()}
    flat, names = set(), Counter[str]()
    for face in file.faces:
        points = np.concatenate(face.loops)
        places = points[:, 0] + 1j * points[:, 1]
        if face.name in walls:
            own = [each for each in part.bands
                   if each.is_upright and each.wall.name == face.name]  # fmt: skip
            assert (np.min(points[:, 2]), np.max(points[:, 2])) in [
                pytest.approx((each.z0 - bottom, each.z1 - bottom), abs=1e-9) for each in own
            ]
            assert face.surface.kind in ("PLANE", "CYLINDRICAL_SURFACE")
            assert np.max(drawn[face.name].distances(places)) <= TOLERANCE + 1e-4
            names[face.name] += 1
        elif face.name in edges:
            bevel = edges[face.name]
            ends = [each.z - bottom for each in part.bevels if each.edge.name == face.name]
            check_chamfer(face.surface, points, drawn[bevel.boundary.name], bevel, ends)
            names[face.name] += 1
        else:
            height = float(points[0, 2])
            assert np.max(np.abs(points[:, 2] - height)) <= CLOSE
            (level,) = (each for each in levels if abs(each[1] - height) <= 1e-9)
            assert (face.name, face.surface.kind) == (level[0], "PLANE")
            flat.add(level)
    assert flat == levels
    assert set(names) == {*walls, *edges}


def check_body(file: Exchange, part: Part, facts: dict[str, object]) -> None:
    """Closed, in one piece, of the volume, centre and inertia of the part, and as it is counted."""
    mesh, volume = file.mesh, Solid.from_part(part).volume
    assert mesh.is_volume
    require_moments(mesh, part, CHORDS * volume)
    assert facts["volume_mm3"] == pytest.approx(volume, rel=CHORDS)
    kinds = Counter(each.surface.kind for each in file.faces)
    counted = {"faces": len(file.faces), "planes": kinds["PLANE"],
               "cylinders": kinds["CYLINDRICAL_SURFACE"], "cones": kinds["CONICAL_SURFACE"],
               "splines": kinds["SURFACE_OF_LINEAR_EXTRUSION"]}  # fmt: skip
    assert {name: facts.get(name, 0) for name in counted} == counted
    assert list(facts)[-1] == "volume_mm3"


def check_chamfer(
    surface: Surface, points: FloatArray, wall: Outline, bevel: Bevel, heights: list[float]
) -> None:
    """Of 45 degrees: its points are as far within the wall as above its foot, or at a corner that
    is mitred, where both faces go on until they meet, farther.
    """
    leaning = abs(surface.axis[2]) if surface.kind == "PLANE" else math.cos(surface.angle)
    assert surface.kind in ("PLANE", "CONICAL_SURFACE")
    assert leaning == pytest.approx(math.sqrt(0.5), rel=1e-9)
    (z,) = (each for each in heights if np.min(np.abs(points[:, 2] - each)) <= 1e-9)
    foot = z - bevel.height if z > np.mean(points[:, 2]) else z + bevel.height
    up = np.abs(points[:, 2] - foot)
    assert np.max(up) == pytest.approx(bevel.height, abs=1e-9)
    within = wall.distances(points[:, 0] + 1j * points[:, 1])
    assert np.min(within - up) >= -TOLERANCE - 1e-4
    assert np.max(within[up < 1e-9]) <= TOLERANCE + 1e-4


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_walls_of_splines_are_the_whole_part(unit: str) -> None:
    given = replace(SPLINES[unit], step=StepSpec("spline"))
    written = read_back(WRITER, given)
    file = Exchange(written.data)
    check_body(file, given.part, dict(written.facts))
    assert "SURFACE_OF_LINEAR_EXTRUSION" in {each.surface.kind for each in file.faces}


def test_the_frame_says_what_and_by_whom() -> None:
    given = replace(StubProduct(name="Nocken 'A'"), unit="inch")
    file = Exchange(WRITER.write(given, TOLERANCE).data)
    description, name, schema = file.header
    assert (description.kind, description.values) == ("FILE_DESCRIPTION", [
        ["camgeo 0.0.test", f"scene {given.scene_hash}", "tolerance 0.01 mm"], "2;1",
    ])  # fmt: skip
    assert (name.kind, name.values) == ("FILE_NAME", [
        "Nocken 'A'.step", "1970-01-01T00:00:00", [""], [""], "camgeo 0.0.test", "camgeo", "",
    ])  # fmt: skip
    protocol = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }"
    assert (schema.kind, schema.values) == ("FILE_SCHEMA", [[protocol]])
    shape, representation = file.one_of("SHAPE_DEFINITION_REPRESENTATION").values
    assert file.at(representation, "ADVANCED_BREP_SHAPE_REPRESENTATION") is file.representation
    assert file.representation.values[0] == "Nocken 'A'"
    assert file.at(file.representation.values[1][1], "MANIFOLD_SOLID_BREP").values[0] == given.name
    definition = file.at(shape, "PRODUCT_DEFINITION_SHAPE").values[2]
    _, _, version, stage = file.at(definition, "PRODUCT_DEFINITION").values
    own = file.at(version, "PRODUCT_DEFINITION_FORMATION").values[2]
    number, called, _, (discipline,) = file.at(own, "PRODUCT").values
    assert (number, called) == (given.name, given.name)
    context = file.at(discipline, "PRODUCT_CONTEXT").values[1]
    assert file.at(stage, "PRODUCT_DEFINITION_CONTEXT").values == ["part definition", context,
                                                                   "design"]  # fmt: skip
    assert file.one_of("APPLICATION_PROTOCOL_DEFINITION").values == [
        "international standard", "ap242_managed_model_based_3d_engineering", 2014, context,
    ]  # fmt: skip
    assert file.one_of("PRODUCT_RELATED_PRODUCT_CATEGORY").values == ["part", "", [own]]
    whole = file.representation.values[2]
    assert file.at(whole, "GEOMETRIC_REPRESENTATION_CONTEXT").values == [3]
    assert file.at(whole, "REPRESENTATION_CONTEXT").values == ["", "3D"]
    ((uncertain,),) = file.at(whole, "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT").values
    size, unit, *said = file.at(uncertain, "UNCERTAINTY_MEASURE_WITH_UNIT").values
    assert said == ["distance_accuracy_value", "ends and edges meet within it"]
    assert size.kind == "LENGTH_MEASURE"
    assert size.values[0] * file.millimetres(unit) == pytest.approx(1e-7, rel=1e-12)


def test_nothing_is_left_that_nothing_refers_to() -> None:
    """But for the roots of the file; and directions along the axes are there once."""
    file = Exchange(WRITER.write(product("circle and keyway"), TOLERANCE).data)
    used: set[int] = set()

    def visit(value: object) -> None:
        if isinstance(value, Ref):
            used.add(value)
        elif isinstance(value, list):
            for each in value:
                visit(each)

    for own in file.entities.values():
        for each in own:
            visit(each.values)
    roots = {own[0].kind for number, own in file.entities.items() if number not in used}
    assert roots == {
        "APPLICATION_PROTOCOL_DEFINITION", "PRODUCT_RELATED_PRODUCT_CATEGORY",
        "SHAPE_DEFINITION_REPRESENTATION",
    }  # fmt: skip
    along = Counter(str(each.values[1]) for each in file.all_of("DIRECTION"))
    assert along["[0.0, 0.0, 1.0]"] == 1


@pytest.mark.parametrize(
    ("pattern", "new"),
    [
        (rb"(=EDGE_CURVE\(.*),\.T\.", rb"\1,.F."),
        (rb"(=ORIENTED_EDGE\(.*),\.T\.", rb"\1,.F."),
        (rb"(=ADVANCED_FACE\(.*),\.T\.", rb"\1,.F."),
        (rb"(=CYLINDRICAL_SURFACE\(.*,)", rb"\g<1>1"),
        (rb"(=CONICAL_SURFACE\(.*,)", rb"\g<1>1"),
        (rb"(=CARTESIAN_POINT\('',\([^)]*)", rb"\g<1>1"),
    ],
)
def test_a_fault_is_seen(pattern: bytes, new: bytes) -> None:
    """Without it, none of this is a proof: senses, normals, radii, places."""
    whole = WRITER.write(product("circle and flat"), TOLERANCE).data
    data, count = re.subn(pattern, new, whole, count=1)
    assert count
    with pytest.raises((AssertionError, ValueError)):
        _ = Exchange(data).faces
