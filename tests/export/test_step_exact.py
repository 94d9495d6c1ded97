"""STEP files read by a reader of the tests: every entity, every face, and the whole body."""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import FloatArray
from camgeo.part.assembly import bore_boundary
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.mass import solid
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
from camgeo_export.step.writer import WRITER
from tests.export.exchange import CLOSE, Exchange, Ref, Surface
from tests.export.stub_product import StubProduct
from tests.export.test_dxf_spline import PRODUCTS
from tests.export.test_solids import PartProduct
from tests.measuring import Outline
from tests.part.parts import made

TOLERANCE = 0.02

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
}  # fmt: skip


@cache
def product(name: str, unit: str = "mm") -> PartProduct:
    return PartProduct(given=PARTS[name], effort="fast", unit="inch" if unit == "inch" else "mm")


@pytest.mark.parametrize("name", PARTS)
def test_each_file_is_the_whole_part(name: str) -> None:
    part, unit = PARTS[name], "inch" if "flat" in name or "straight" in name else "mm"
    written = WRITER.write(product(name, unit), TOLERANCE)
    file = Exchange(written.data)
    assert file.unit == (25.4 if unit == "inch" else 1.0)
    check_body(file, part, dict(written.facts))
    bottom = part.layers[0].z0
    walls = {each.name: each for each in part.boundaries}
    edges = {each.edge.name: each for each in part.bevels}
    levels = {(each.name, each.z - bottom) for each in part.levels}
    drawn = {name: outline_of(each.arcs(1e-4, "fast").contour) for name, each in walls.items()}
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
            assert face.name == level[0]
            assert face.surface.kind == "PLANE"
            flat.add(level)
    assert flat == levels
    assert set(names) == {*walls, *edges}


def check_body(file: Exchange, part: Part, facts: dict[str, object]) -> None:
    """Closed, in one piece, of the volume, centre and inertia of the part, and as it is counted."""
    mesh, exact = file.mesh, solid(part)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.body_count == 1
    assert mesh.volume == pytest.approx(exact.volume, rel=CHORDS)
    assert facts["volume_mm3"] == pytest.approx(exact.volume, rel=CHORDS)
    size = float(np.max(np.abs(mesh.vertices)))
    centre = exact.centre - [0.0, 0.0, part.layers[0].z0]
    assert np.max(np.abs(mesh.center_mass - centre)) <= CHORDS * size
    room = 2.0 * CHORDS * exact.volume * size**2
    assert np.max(np.abs(mesh.moment_inertia - exact.inertia)) <= room
    kinds = Counter(each.surface.kind for each in file.faces)
    counted = {"faces": len(file.faces), "planes": kinds["PLANE"],
               "cylinders": kinds["CYLINDRICAL_SURFACE"], "cones": kinds["CONICAL_SURFACE"],
               "splines": kinds["SURFACE_OF_LINEAR_EXTRUSION"]}  # fmt: skip
    for name, count in counted.items():
        assert facts.get(name, 0) == count
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


def outline_of(contour: Contour) -> Outline:
    return Outline.through(contour.vertices, contour.sweeps)


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_walls_of_splines_are_the_whole_part(unit: str) -> None:
    given = replace(PRODUCTS[unit], step=StepSpec("spline"))
    written = WRITER.write(given, TOLERANCE)
    file = Exchange(written.data)
    check_body(file, given.part, dict(written.facts))
    assert "SURFACE_OF_LINEAR_EXTRUSION" in {each.surface.kind for each in file.faces}


def test_the_frame_says_what_and_by_whom() -> None:
    given = replace(StubProduct(name="Nocken 'A'"), unit="inch")
    file = Exchange(WRITER.write(given, TOLERANCE).data)
    description, name, schema = file.header
    assert (description.kind, description.values) == ("FILE_DESCRIPTION", [
        ["camgeo 0.0.test", f"scene {given.scene_hash}", "tolerance 0.02 mm"], "2;1",
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
