"""Solids as STL, 3MF and STEP: one closed body within the tolerance; broken ones are refused."""

from __future__ import annotations

import cmath
import io
import math
import re
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from typing import TypeVar
from unittest.mock import Mock

import manifold3d
import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given, reject, settings
from hypothesis import strategies as st

import camgeo
from camgeo.cam.cam import Contact
from camgeo.design.product import Product
from camgeo.design.verify import ReadingOptions
from camgeo.design.writing import Writer
from camgeo.errors import FileError, GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from camgeo.part.assembly import bevelled, bore_boundary
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.mass import Solid
from camgeo.part.part import Bevel, Boundary, Layer, Part
from camgeo.part.spec import Chamfers, Counterbore, DShaft, Engraving, Holes, Hub, Keyway, PartSpec
from camgeo.units import LengthUnit
from camgeo_export.part21 import Cone
from camgeo_export.part21 import Solid as StepSolid
from camgeo_export.solid import prism
from camgeo_export.solid.prism import FIT_SHARE, PIECE, body, polygon_gaps, triangulate
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.body import _sections, body_checks, measure, polygon, solid_checks, volume
from camgeo_export.verify.plane import paired
from camgeo_export.verify.step import level_bounds, volume_by_levels
from camgeo_export.verify.stl import FACET
from tests.effects.scenes import design
from tests.export.stub_product import CircleBoundary, StubProduct
from tests.export.verified import TOLERANCE, VERIFIERS, faults, measured, read_back
from tests.long_form import examples
from tests.packages import repacked
from tests.part.parts import FLANKS, chamfers, circle, made, made_or_refused, specs, tight_specs
from tests.strategies import attack


def test_stl_says_when_its_floats_are_too_coarse() -> None:
    with pytest.raises(ToleranceError, match="too coarse"):
        STL.write(StubProduct(), 1e-6)


def stl_of(corners: np.ndarray) -> bytes:
    facets = np.zeros(len(corners), dtype=FACET)
    facets["corners"] = corners
    head = b"camgeo x unit mm ".ljust(80) + np.uint32(len(facets)).tobytes()
    return head + facets.tobytes()


@pytest.fixture(scope="module")
def corners() -> np.ndarray:
    return np.array(np.frombuffer(STL_DATA[84:], dtype=FACET)["corners"])


Change = Callable[[np.ndarray], np.ndarray]
"""Of the corners of all facets (n, 3, 3)."""


@pytest.mark.parametrize(
    ("change", "least", "most"),
    [
        (lambda c: c + [0.2, 0, 0] * (c[..., :2] == c[0, 0, :2]).all(-1, keepdims=True), 0.1, 0.3),
        (lambda c: c * [1.0, 1.0, 1.25], 1.999, 2.001),
        (lambda c: c / 25.4, 10.0, 40.0),
    ],
    ids=["vertex", "height", "inch"],
)
def test_what_is_moved_is_measured(
    corners: np.ndarray, change: Change, least: float, most: float
) -> None:
    assert least < measured(STL, StubProduct(), stl_of(change(corners))) < most


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c[1:], r"the check 'closed': the edge .* has 1 of 2 facets"),
        (
            lambda c: np.vstack((c[:5], c[5:6, ::-1], c[6:])),
            "facet 6, near .* is turned ag",
        ),
        (lambda c: c[:, ::-1], "inside out"),
        (lambda c: c + 0.01 * c[..., 2:] * [1.0, 0.0, 0.0], "neither flat nor upright"),
    ],
    ids=["open", "flipped", "inside out", "leaning"],
)
def test_what_is_no_body_is_refused(corners: np.ndarray, change: Change, message: str) -> None:
    with pytest.raises(FileError, match=message):
        STL.measure(StubProduct(), stl_of(change(corners)))


def test_a_groove_that_is_not_there_is_refused() -> None:
    with pytest.raises(FileError, match="2 heights, expected 3"):
        STL.measure(StubProduct(groove=True), STL_DATA)


STL_DATA, PACKAGE = (each.write(StubProduct(), 0.01).data for each in (STL, THREEMF))


@pytest.mark.parametrize(
    ("writer", "data", "message"),
    [
        (STL, STL_DATA[:84] + STL_DATA[134:], "complete binary STL"),
        (THREEMF, PACKAGE[:-100], "not a 3MF"),
        (THREEMF, repacked(PACKAGE, lambda _, text: text.replace("</mesh>", "")), "not a 3MF"),
        (THREEMF, repacked(PACKAGE, lambda _, text: text.replace("millimeter", "inch")),
         "not in millimetres"),
    ],
    ids=["stl", "zip", "xml", "unit"],
)  # fmt: skip
def test_what_is_cut_or_in_another_unit_is_refused(
    writer: Writer, data: bytes, message: str
) -> None:
    with pytest.raises(FileError, match=message):
        writer.measure(StubProduct(), data)


@pytest.mark.parametrize("writer", [STL, THREEMF, STEP], ids=["stl", "3mf", "step"])
def test_a_scene_without_thickness_has_no_body(writer: Writer) -> None:
    assert "part.thickness" in writer.format.needs
    product = StubProduct(thickness=None)
    with pytest.raises(GeometryError, match=r"part\.thickness"):
        writer.write(product, 0.01)
    data = writer.write(StubProduct(), 0.01).data
    with pytest.raises(FileError, match=r"part\.thickness"):
        writer.measure(product, data)
    checks = VERIFIERS[writer.format.name].checks(product, data, ReadingOptions("file"), 0.01)
    assert [check.name for check in checks if check.ok is False] == ["body"]


def test_a_3mf_keeps_doubles() -> None:
    product = StubProduct()
    data = THREEMF.write(product, 0.01).data
    boundary = product.part.boundaries[0].polyline(FIT_SHARE * 0.01).contour.vertices
    mesh = trimesh.load_mesh(io.BytesIO(data), file_type="3mf", process=False)
    plane = np.asarray(mesh.vertices)[:, 0] + 1j * np.asarray(mesh.vertices)[:, 1]
    assert set(boundary.tolist()) <= set(plane.tolist())


RIM, BORE = CircleBoundary("rim", False, 40.0), CircleBoundary("bore", True, 8.0)
HUB, COUNTERBORE = CircleBoundary("hub", False, 15.0), CircleBoundary("counterbore", True, 12.0)
POCKETS = tuple(
    CircleBoundary(f"pocket {k}", True, 5.0, 28.0 * cmath.exp(2j * math.pi * k / 3.0))
    for k in range(3)
)
ISLAND = CircleBoundary("island", False, 2.0, 28.0 + 0j)

PARTS: dict[str, tuple[Layer, ...]] = {
    "hub": (Layer(-10.0, 0.0, (RIM, BORE)), Layer(0.0, 6.0, (HUB, BORE), "hub")),
    "hubs on both sides": (
        Layer(-16.0, -10.0, (HUB, BORE), "lower hub"),
        Layer(-10.0, 0.0, (RIM, BORE)),
        Layer(0.0, 6.0, (HUB.inset(0.0, "upper hub"), BORE), "hub"),
    ),
    "counterbore above": (
        Layer(-10.0, -4.0, (RIM, BORE)),
        Layer(-4.0, 0.0, (RIM, COUNTERBORE), "counterbore"),
    ),
    "counterbore below": (
        Layer(-10.0, -6.0, (RIM, COUNTERBORE), "counterbore"),
        Layer(-6.0, 0.0, (RIM, BORE)),
    ),
    "pockets round an island": (
        Layer(-10.0, -4.0, (RIM, BORE)),
        Layer(-4.0, 0.0, (RIM, BORE, *POCKETS, ISLAND), "pocket"),
    ),
    "floors that look up and down at one height": (
        Layer(-10.0, -4.0, (RIM, COUNTERBORE), "counterbore"),
        Layer(-4.0, 0.0, (RIM, BORE, *POCKETS, ISLAND), "pocket"),
    ),
}

TEXTS = (Engraving("Ø8", 5.0, 0.3, 22.0), Engraving("0", 4.0, 0.5, 20.0, 3.0))

ENGRAVED = made(Contact.INNER, PartSpec(thickness=8.0, bore=20.0, engraving=TEXTS))

BODIES: dict[str, Part] = {
    "disc": StubProduct().part,
    "groove": StubProduct(groove=True).part,
    **{name: Part(layers) for name, layers in PARTS.items()},
    "engraved": ENGRAVED,
}
"""Of one solid each."""


# Chamfers -----------------------------------------------------------------------------------------


ROUND = circle("outline", 30.0, complex(0.0, -5.0))
ROUND_BORE = circle("bore", 8.0, hole=True)


def bevel(boundary: Boundary, width: float, z: float, *, upper: bool) -> Bevel:
    edge = boundary.inset(width, f"chamfer of the {boundary.name}")
    return Bevel(boundary, edge, width, width, z, upper)


PART = Part(
    (Layer(-8.0, 0.0, (ROUND, ROUND_BORE)),),
    (
        bevel(ROUND, 0.5, 0.0, upper=True),
        bevel(ROUND, 0.5, -8.0, upper=False),
        bevel(ROUND_BORE, 1.0, 0.0, upper=True),
    ),
)
PRODUCT = StubProduct(given=PART)


def _cone(one: float, other: float) -> float:
    """Volume of a frustum of 45 degrees."""
    return math.pi * abs(other**3 - one**3) / 3.0


WALLS = 7.0 * math.pi * (30.0**2 - 8.0**2)
VOLUME = 2.0 * _cone(29.5, 30.0) + WALLS - _cone(8.0, 9.0)


def mesh(part: Part = PART, tolerance: float = TOLERANCE) -> tuple[FloatArray, IntArray]:
    """Vertices and triangles of a body."""
    made = body(part, tolerance, lambda values: values)
    return made.vertices.copy(), made.triangles


@pytest.mark.parametrize("writer", [STL, THREEMF], ids=["stl", "3mf"])
@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
def test_read_back_is_within_the_tolerance(writer: Writer, tolerance: float) -> None:
    written = read_back(writer, PRODUCT, tolerance)
    assert written.facts["volume_mm3"] == pytest.approx(VOLUME, rel=0.2 * tolerance)
    found = trimesh.load_mesh(io.BytesIO(written.data), file_type=writer.format.suffix[1:])
    assert found.is_volume
    assert found.bounds[:, 2].tolist() == [0.0, 8.0]


def test_a_chamfer_takes_no_more_facets_than_a_wall() -> None:
    """Each wall has two facets for each of its chords, and so has each chamfer beside it."""
    sharp, edged = (len(mesh(part)[1]) for part in (PART.sharp, PART))
    assert edged <= 1.1 * 2.0 * sharp


def test_verification_has_nothing_to_say() -> None:
    checks = body_checks(PRODUCT, *mesh(), TOLERANCE)
    assert [check for check in checks if not check.ok] == []
    where = {check.of for check in checks if check.name == "deviation"}
    assert len([each for each in where if "half way up" in each]) == 3


def test_a_solid_with_sharp_edges_is_refused() -> None:
    sharp = mesh(PART.sharp)
    with pytest.raises(FileError, match="there is no chamfer"):
        measure(PART, *sharp)
    for check in body_checks(PRODUCT, *sharp, TOLERANCE):
        if check.name == "deviation" and "chamfer" in check.of:
            assert not check.ok


def test_a_chamfer_of_another_width_is_measured() -> None:
    wide = bevel(ROUND_BORE, 1.25, 0.0, upper=True)
    other = Part(PART.layers, (*PART.bevels[:2], wide))
    vertices, triangles = mesh()
    with pytest.raises(FileError, match="neither flat nor upright"):
        measure(other, vertices, triangles)
    steep = vertices.copy()
    radius = np.hypot(steep[:, 0], steep[:, 1])
    steep[(steep[:, 2] == 8.0) & (radius < 10.0), :2] *= 9.25 / 9.0
    assert measure(PART, steep, triangles) == pytest.approx(0.25, abs=0.02)
    broken = [check for check in body_checks(PRODUCT, steep, triangles, TOLERANCE) if not check.ok]
    assert {check.name for check in broken} >= {"deviation", "area"}


def test_a_twisted_chamfer_sags_half_way_up() -> None:
    """Its edges are where they belong, but facets join places that do not lie over each other."""
    vertices, triangles = mesh()
    top = np.flatnonzero((vertices[:, 2] == 8.0) & (np.hypot(*vertices.T[:2]) < 10.0))
    vertices[top] = vertices[np.roll(top, len(top) // 8)]
    # Half way up, chords of an eighth of a turn lie inside the circle of 8.5 mm.
    assert measure(PART, vertices, triangles) > 8.5 * (1.0 - math.cos(math.pi / 8.0)) - 0.1


def test_chamfers_that_the_tolerance_may_hide_are_refused() -> None:
    with pytest.raises(GeometryError, match=r"at least 4 tolerances wide, 0\.8 mm") as caught:
        STL.write(PRODUCT, 0.2)
    assert caught.value.key == "part.chamfers"


@dataclass(frozen=True, slots=True)
class Stadium(ExactBoundary):
    """A slot with round ends, 20 mm from centre to centre: its parallels are such slots."""

    def inset(self, distance: float, name: str) -> Stadium:
        radius = float(self.exact.radii[1]) + (distance if self.hole else -distance)
        return stadium(name, radius, hole=self.hole)


def stadium(name: str, radius: float, *, hole: bool) -> Stadium:
    ends = np.array([-10.0, 10.0, 10.0, -10.0], dtype=np.complex128)
    sides = radius * np.array([-1j, -1j, 1j, 1j])
    centres = np.array([0.0, 10.0, 0.0, -10.0], dtype=np.complex128)
    return Stadium(name, hole, Contour(ends + sides, np.array([0.0, math.pi] * 2), centres))


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_step_files_have_cones(unit: LengthUnit) -> None:
    product = replace(PRODUCT, unit=unit)
    written = read_back(STEP, product, least=0.0)
    assert written.facts["volume_mm3"] == pytest.approx(VOLUME, rel=1e-12)
    assert Solid.from_part(PART).volume == pytest.approx(VOLUME, rel=1e-13)
    read = StepSolid.from_bytes(written.data)
    leaning = [face for face in read.faces if face.is_inclined]
    assert {face.name for face in leaning} == {each.edge.name for each in PART.bevels}
    assert all(isinstance(face.surface, Cone) for face in leaning)
    assert (written.facts["faces"], written.facts["cones"]) == (12, 6)
    assert len(read.faces) == 12
    assert volume_by_levels(level_bounds(read), read.faces) == pytest.approx(VOLUME, rel=1e-12)


def test_step_files_have_inclined_planes_on_lines() -> None:
    around, slot = stadium("outline", 25.0, hole=False), stadium("bore", 8.0, hole=True)
    part = Part(
        (Layer(-8.0, 0.0, (around, slot)),),
        tuple(
            bevel(each, width, z, upper=z == 0.0)
            for each, width in ((around, 0.5), (slot, 1.0))
            for z in (0.0, -8.0)
        ),
    )
    product = StubProduct(given=part)
    written = read_back(STEP, product, least=0.0)
    counts = [written.facts[kind] for kind in ("faces", "cylinders", "cones", "planes")]
    assert counts == [26, 4, 8, 14]
    assert written.facts["volume_mm3"] == pytest.approx(Solid.from_part(part).volume, rel=1e-12)
    assert measure(part, *mesh(part)) <= TOLERANCE


KEYED = bore_boundary(16.0, Keyway(5.0, 2.3, 0.4))
FLATTED = bore_boundary(16.0, None, DShaft(14.0, -2.0))


def with_bore(bore: ExactBoundary) -> Part:
    """A disc whose bore has chamfers on both sides, of different widths."""
    return Part(
        (Layer(-8.0, 0.0, (ROUND, bore)),),
        (
            bevel(ROUND, 0.5, 0.0, upper=True),
            bevel(bore, 1.0, 0.0, upper=True),
            replace(bevel(bore, 0.5, -8.0, upper=False), edge=bore.inset(0.5, "lower chamfer")),
        ),
    )


BORES = pytest.mark.parametrize("bore", [KEYED, FLATTED], ids=["keyway", "flat"])


@BORES
@pytest.mark.parametrize("tolerance", [0.05, 4e-3])
def test_meshes_follow_bent_corners(bore: ExactBoundary, tolerance: float) -> None:
    """At any height they are within the tolerance of the section there."""
    part = with_bore(bore)
    product = StubProduct(given=part)
    read_back(STL, product, tolerance)
    vertices, triangles = mesh(part, tolerance)
    for band in (each for each in part.bands if each.wall is bore and not each.is_upright):
        for share in (0.1, 0.3, 0.7, 0.9):
            z = band.z0 + share * (band.z1 - band.z0)
            ring = min(
                (polygon(each) for each in _sections(vertices, triangles, z + 8.0)),
                key=lambda contour: abs(contour.area),
            )
            assert band.section(z).deviation(ring.counter_clockwise()) <= tolerance


def test_straight_chords_along_bent_corners_are_measured() -> None:
    """Without steps a corner would be off by what its parabola leaves of its chord half way up."""
    part = with_bore(KEYED)
    moved, triangles = mesh(part, 1e-3)
    steps = {round(z, 9) for z in moved[:, 2].tolist() if 7.0 < z < 8.0}
    assert len(steps) > 2
    inner = (moved[:, 2] > 7.0) & (moved[:, 2] < 8.0) & (np.hypot(moved[:, 0], moved[:, 1]) < 20.0)
    moved[inner, :2] *= 1.001
    assert measure(part, moved, triangles) > 5e-3


@BORES
@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_step_files_have_parabolas_at_corners(bore: ExactBoundary, unit: LengthUnit) -> None:
    part = with_bore(bore)
    product = replace(PRODUCT, given=part, unit=unit)
    written = read_back(STEP, product, least=0.0)
    assert measured(STEP, product, written.data) <= 1e-9
    volume = Solid.from_part(part).volume
    assert written.facts["volume_mm3"] == pytest.approx(volume, rel=1e-13)
    read = StepSolid.from_bytes(written.data)
    assert volume_by_levels(level_bounds(read), read.faces) == pytest.approx(volume, rel=1e-12)
    edges = {use.edge.number: use.edge for face in read.faces for loop in face.loops
             for use in loop}  # fmt: skip
    bends = [each.bend for each in edges.values() if each.bend is not None]
    assert len(bends) == 4  # two corners with an arc on each side
    for bend in bends:
        # The corner stays between cone and plane: at each height on the section's.
        z = 0.5 * (bend.start.z + bend.end.z)
        width = min(z, 8.0 - z)
        vertices = bore.inset(width, "section").exact.vertices
        assert min(abs(vertices - bend.section_point(z))) <= 1e-12 * 25.4


def require_faults(product: StubProduct, pattern: bytes, new: bytes) -> set[str]:
    """The checks that fail on a STEP file with a change, for which it is not measured either."""
    changed, count = re.subn(pattern, new, STEP.write(product, TOLERANCE).data)
    assert count
    with pytest.raises(FileError):
        STEP.measure(product, changed)
    return {check.name for check in faults(VERIFIERS["step"], product, changed)}


@pytest.mark.parametrize(
    ("pattern", "new"),
    [
        (rb"(B_SPLINE_CURVE_WITH_KNOTS\('',2,\(#\d+,)#\d+,", rb"\g<1>#1,"),
        (rb"(B_SPLINE_CURVE_WITH_KNOTS\('',2,\((#\d+),)#\d+,", rb"\g<1>\g<2>,"),
        (rb"(CONICAL_SURFACE\('',#\d+,)8\.", rb"\g<1>8.01"),
    ],
)
def test_faults_of_parabolas_are_found(pattern: bytes, new: bytes) -> None:
    assert require_faults(StubProduct(given=with_bore(KEYED)), pattern, new)


def test_step_files_cannot_have_chamfers_along_splines() -> None:
    base = design("plate_translating", "").scene
    keys = {"part.thickness": 8, "part.chamfers": {"outline": {"width": 0.5}},
            "output.step": {"walls": "spline"}}  # fmt: skip
    with pytest.raises(GeometryError, match="parallel of a spline") as caught:
        STEP.write(camgeo.Design(base.with_values(keys)).disc, TOLERANCE)
    assert caught.value.key == "output.step.walls"


@pytest.mark.parametrize(
    ("pattern", "new", "fault"),
    [
        (rb"(CONICAL_SURFACE\('',#\d+,)29\.5", rb"\g<1>29.6", "uncertainty"),
        (rb"(CONICAL_SURFACE\('',#\d+,[^,]*),0\.785\d*", rb"\g<1>,0.7", "uncertainty"),
        (rb"(ADVANCED_FACE\('chamfer of the bore',[^)]*\),#\d+,)\.F\.", rb"\g<1>.T.",
         "walls"),
    ],
)  # fmt: skip
def test_faults_of_cones_are_found(pattern: bytes, new: bytes, fault: str) -> None:
    assert fault in require_faults(PRODUCT, pattern, new)


def test_a_step_file_of_other_chamfers_is_refused() -> None:
    data = STEP.write(PRODUCT, TOLERANCE).data
    foreign = ReadingOptions("x.step")
    sharp = StubProduct(given=PART.sharp)
    wide = StubProduct(
        given=Part(PART.layers, (*PART.bevels[:2], bevel(ROUND_BORE, 1.5, 0.0, upper=True)))
    )
    for product in (sharp, wide):
        checks = VERIFIERS["step"].checks(product, data, foreign, TOLERANCE)
        assert {check.name for check in checks if check.ok is False} >= {"deviation"}
    with pytest.raises(FileError):
        STEP.measure(PRODUCT, STEP.write(sharp, TOLERANCE).data)


# A conjugate pair in one piece --------------------------------------------------------------------


PAIR = Path(__file__).parents[2] / "fixtures" / "pairs" / "conjugate_pair.toml"


@cache
def in_one_piece(upper: str = "main") -> tuple[camgeo.Design, Product]:
    scene = camgeo.load(PAIR).scene.with_values({"part.pair.upper": upper})
    design = camgeo.Design(scene)
    assert design.disc.pair is not None
    return design, design.disc.pair


@pytest.mark.parametrize("upper", ["main", "return"])
@pytest.mark.parametrize("writer", [STL, THREEMF, STEP], ids=["stl", "3mf", "step"])
def test_it_is_one_solid_of_the_exact_volume(writer: Writer, upper: str) -> None:
    _, pair = in_one_piece(upper)
    exact = Solid.from_part(pair.drawn.part)
    written = read_back(writer, pair, least=0.0)
    # all faces are within the tolerance, and none is larger than 4 discs of 60 mm are
    slack = TOLERANCE * 4.0 * math.pi * 60.0 * (60.0 + 10.0)
    assert float(written.facts["volume_mm3"]) == pytest.approx(exact.volume, abs=slack)


def test_the_step_file_has_the_faces_that_are_counted() -> None:
    """A face for each piece of a wall; of flat ones, one at each of eight heights and the floors of
    two marks; the faces between discs and spacer name their disc."""
    written = STEP.write(in_one_piece()[1], TOLERANCE)
    lines = written.data.decode().splitlines()
    names = [line.split("'")[1] for line in lines if "ADVANCED_FACE(" in line]
    assert len(names) == written.facts["faces"]
    for name in ("upper face of the return disc", "lower face of the disc", "spacer", "lower hub"):
        assert name in names
    assert names.count("mark") == 8  # two slots with two sides and two ends


@pytest.mark.parametrize("upper", ["main", "return"])
def test_both_rollers_touch_their_discs_at_every_cam_angle(upper: str) -> None:
    """Sections of the mesh at the middle of each disc, turned with the shaft: the rollers of the
    rigid lever touch both at once. A return disc that is 0.5 degrees off would miss by 0.1 mm."""
    design, pair = in_one_piece(upper)
    written = STL.write(pair, TOLERANCE)
    mesh = trimesh.load_mesh(io.BytesIO(written.data), file_type="stl")
    assert mesh.is_watertight
    assert mesh.body_count == 1
    low = {"main": (36.0, 17.0), "return": (17.0, 36.0)}[upper]
    phi = np.linspace(0.0, 2.0 * math.pi, 41)[:-1] + 0.01
    lift = design.drive.motion.jet(phi)[0]
    for cam, z in zip(design.cams, low, strict=True):
        section = mesh.section(plane_origin=[0.0, 0.0, z], plane_normal=[0.0, 0.0, 1.0])
        assert section is not None
        rings = [shapely.Polygon(ring[:, :2]) for ring in section.discrete]
        outline = max(rings, key=lambda ring: ring.area)
        centres = [cam.follower.traced_point(each) for each in lift.tolist()]
        turned = np.array(centres) * np.exp(-1j * cam.rotation * phi)
        off = [
            shapely.distance(outline.exterior, shapely.points(each.real, each.imag))
            - cam.follower.roller_radius
            for each in (turned, turned * np.exp(1j * math.radians(0.5)))
        ]
        assert np.max(np.abs(off[0])) <= TOLERANCE
        assert np.max(np.abs(off[1])) > 0.1


# Random parts -------------------------------------------------------------------------------------


COARSE = 0.05

Found = TypeVar("Found")


def drawn_part(contact: Contact, spec: PartSpec) -> Part:
    part = made_or_refused(contact, spec)
    if part is None:
        reject()
    return part


def _or_refused(make: Callable[[], Found]) -> Found | None:
    """What is made; None if the part is refused as it is."""
    try:
        return make()
    except GeometryError as error:
        if error.key == "part":
            return None
        raise


@given(st.sampled_from(list(FLANKS)), specs() | tight_specs())
@settings(attack, max_examples=examples(8, long=60))
def test_random_parts_are_solids(contact: Contact, spec: PartSpec) -> None:
    part = drawn_part(contact, spec)
    facets = _or_refused(partial(mesh, part, COARSE))
    if facets is None:
        return
    for check in solid_checks(*facets):
        assert check.ok, check
    exact, off = _volume(part)
    assert volume(*facets) == pytest.approx(exact, abs=off)


@given(st.sampled_from(list(FLANKS)), specs(), chamfers())
@settings(attack, max_examples=examples(6, long=60))
def test_random_chamfers_are_refused_or_in_the_solid(
    contact: Contact, spec: PartSpec, edges: Chamfers
) -> None:
    """Only those that the part has room for; the rest of the edges is sharp."""
    sharp = drawn_part(contact, replace(spec, keyway=None, d_shaft=None))
    kept, refused = Chamfers(), []
    for field in fields(edges):
        tried = replace(kept, **{field.name: getattr(edges, field.name)})
        try:
            part = bevelled(sharp, tried, 0.01)
        except GeometryError as error:
            refused.append(error.key or "")
        else:
            kept = tried
    assert all(key.startswith("part.chamfers.") for key in refused), refused
    part = bevelled(sharp, kept, 0.01)
    facets = _or_refused(partial(mesh, part, COARSE))
    if facets is None:
        reject()
    for check in solid_checks(*facets):
        assert check.ok, check
    _, off = _volume(sharp)
    assert volume(*facets) == pytest.approx(Solid.from_part(part).volume, abs=off)
    product = StubProduct(given=part, effort="fast")
    assert measure(part, *facets) <= COARSE
    written = read_back(STEP, product, COARSE, least=0.0)
    assert written.facts["volume_mm3"] == pytest.approx(Solid.from_part(part).volume, abs=off)


@given(st.sampled_from(list(FLANKS)), specs() | tight_specs(), st.sampled_from([1e-3, 0.05]))
@settings(attack, max_examples=examples(6, long=60))
def test_what_is_written_of_random_parts_is_read_back(
    contact: Contact, spec: PartSpec, tolerance: float
) -> None:
    product = StubProduct(given=drawn_part(contact, spec), effort="fast")
    for writer in (STL, THREEMF, STEP):
        written = _or_refused(partial(writer.write, product, tolerance))
        if written is not None:
            assert measured(writer, product, written.data) <= tolerance


THIN_HUB = PartSpec(thickness=10.0, bore=20.0, hub=Hub(20.002, 5.0))

BOLTS = Holes(2, 40.0, 5.0, counterbore=Counterbore(5.003, 3.0))


@pytest.mark.parametrize("writer", [STL, THREEMF, STEP], ids=["stl", "3mf", "step"])
@pytest.mark.parametrize(
    ("spec", "names", "apart"),
    [
        (THIN_HUB, ("hub", "bore"), 0.001),
        (PartSpec(thickness=10.0, bolt_circle=BOLTS), ("bolt hole 1", "counterbore 1"), 0.0015),
    ],
    ids=["hub", "counterbore"],
)
def test_walls_that_a_tolerance_does_not_keep_apart_are_refused(
    writer: Writer, spec: PartSpec, names: tuple[str, str], apart: float
) -> None:
    """Such bodies failed when they were read back, or one wall was taken for the other."""
    product = StubProduct(given=made(Contact.INNER, spec))
    with pytest.raises(GeometryError, match=r"a solid within 0\.01 mm cannot separate") as refused:
        writer.write(product, 0.01)
    assert refused.value.key == "part"
    assert all(name in str(refused.value) for name in names)
    tighter = 0.1 * apart
    assert measured(THREEMF, product, THREEMF.write(product, tighter).data) <= tighter


def _volume(part: Part) -> tuple[float, float]:
    """Of all layers [mm^3], and by how much chords within the tolerance may change it."""
    whole, off = 0.0, 0.0
    for layer in part.layers:
        height = layer.z1 - layer.z0
        for boundary in layer.boundaries:
            fit = boundary.arcs(1e-4, "fast")
            contour: Contour = fit.contour
            whole += (-1.0 if boundary.hole else 1.0) * height * abs(contour.area)
            off += height * (COARSE + fit.deviation) * (contour.length + math.pi * COARSE)
    return whole, off


# Parts of bodies: triangles of faces, how near polygons come, and which contour is which ----------


SIZE = 10.0
"""Largest radius of the rings that are drawn [mm]."""

OFF = 16.0 * 2.0**-53 * (2.0 * SIZE) ** 2
"""Of an area [mm^2] where each corner is off by some units of its last place."""


def star(centre: complex, radii: list[float]) -> ComplexArray:
    """A counter-clockwise ring with its vertices evenly around a centre."""
    turn = np.exp(2j * math.pi * np.arange(len(radii)) / len(radii))
    return np.asarray(centre + np.array(radii) * turn, dtype=np.complex128)


def radii(low: float, high: float, least: int, most: int) -> st.SearchStrategy[list[float]]:
    return st.lists(st.floats(low, high), min_size=least, max_size=most)


@st.composite
def faces(draw: st.DrawFn) -> list[ComplexArray]:
    """An outline, perhaps a bore with an island in it, and some holes between both."""
    # The chords of a ring of 8 stay outside of 0.9 of its least radius.
    rings = [star(0.0, draw(radii(7.8, SIZE, 8, 80)))]
    if draw(st.booleans()):
        rings.append(star(0.0, draw(radii(2.0, 3.5, 8, 60)))[::-1])
        if draw(st.booleans()):
            rings.append(star(0.1, draw(radii(0.8, 1.5, 3, 40))))
    # Of 8 places at a radius of 5 mm neighbours are 3.8 mm apart.
    for k in sorted(draw(st.sets(st.integers(0, 7), max_size=8))):
        place = 5.0 * np.exp(0.25j * math.pi * k)
        rings.append(star(place, draw(radii(0.3, 1.4, 3, 24)))[::-1])
    return rings


def sides_of(rings: list[ComplexArray]) -> set[tuple[int, int]]:
    """The sides of the rings, by the positions of their ends in the row of all points."""
    starts = np.cumsum([0, *map(len, rings)])
    return {
        (int(start) + k, int(start) + (k + 1) % len(ring))
        for start, ring in zip(starts[:-1], rings, strict=True)
        for k in range(len(ring))
    }


def area(ring: ComplexArray) -> Fraction:
    """The exact area of a polygon."""
    x, y = ([Fraction(value) for value in part] for part in (ring.real, ring.imag))
    twice = sum(x[k - 1] * y[k] - x[k] * y[k - 1] for k in range(len(x)))
    return Fraction(twice) / 2


def require_face(rings: list[ComplexArray], found: IntArray) -> None:
    """The triangles cover the face once, with the sides of its rings."""
    points = np.concatenate(rings)
    outers = sum(area(ring) > 0 for ring in rings)
    assert len(found) == len(points) - 2 * outers + 2 * (len(rings) - outers)
    edges = {(int(row[k]), int(row[(k + 1) % 3])) for row in found for k in range(3)}
    assert len(edges) == 3 * len(found)
    assert {edge for edge in edges if edge[::-1] not in edges} == sides_of(rings)
    assert set(np.unique(found)) == set(range(len(points)))
    # None is turned over and the areas sum up: no two of them overlap.
    areas = [area(points[row]) for row in found]
    assert min(areas) > -OFF
    assert sum(areas) == sum(map(area, rings))


@given(faces(), st.integers(3, 40))
def test_triangles_cover_the_face_once(rings: list[ComplexArray], most: int) -> None:
    require_face(rings, triangulate(rings, most))


@given(faces())
def test_a_small_face_is_left_to_the_ears(rings: list[ComplexArray]) -> None:
    seen = prism._tilted(rings)
    ears = manifold3d.triangulate([np.column_stack((each.real, each.imag)) for each in seen])
    np.testing.assert_array_equal(triangulate(rings), ears)


def toothed(count: int, radius: float, teeth: int) -> ComplexArray:
    turn = np.arange(count) / count
    return np.asarray((radius + np.cos(2.0 * math.pi * teeth * turn)) * np.exp(2j * math.pi * turn))


@pytest.mark.parametrize(
    "rings",
    [
        [toothed(2400, 40.0, 0), toothed(1200, 8.0, 0)[::-1]],
        [toothed(3600, 40.0, 12)],
        [toothed(2400, 40.0, 20), toothed(600, 8.0, 12)[::-1]]
        + [(toothed(100, 3.0, 5) + 22.0 * np.exp(0.5j * k))[::-1] for k in range(12)],
    ],
    ids=["disc", "cogs", "holes"],
)
def test_ears_are_cut_from_few_points(
    rings: list[ComplexArray], monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that the time grows as the number of points, not as its square."""
    counted = Mock(wraps=manifold3d.triangulate)
    monkeypatch.setattr(manifold3d, "triangulate", counted)
    found = triangulate(rings)
    assert max(sum(map(len, each.args[0])) for each in counted.call_args_list) <= PIECE
    require_face(rings, found)


def test_a_spiral_is_divided_across_its_arm() -> None:
    turn = np.linspace(0.1, 30.0, 300)
    wound = turn * np.exp(1j * turn)
    rings = [np.concatenate((wound + 0.4 * np.exp(1j * turn), wound[::-1]))]
    require_face(rings, triangulate(rings, 20))


def test_a_face_without_a_proved_diagonal_stays_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    rings = [toothed(60, 40.0, 3), toothed(30, 8.0, 0)[::-1]]
    monkeypatch.setattr(prism, "_clear", lambda *_: False)
    np.testing.assert_array_equal(triangulate(rings, 20), triangulate(rings))


# How near polygons come: the verdict of shapely ---------------------------------------------------


def ring_of(radius: float, count: int) -> ComplexArray:
    return np.asarray(radius * np.exp(2j * math.pi * np.arange(count) / count))


def line(ring: ComplexArray) -> shapely.LinearRing:
    return shapely.LinearRing(np.column_stack((ring.real, ring.imag)))


@given(st.floats(4.5, 5.5), st.integers(3, 40), st.integers(3, 40), st.floats(1e-3, 2.0))
def test_nearest_is_the_distance_if_within_the_tolerance(
    radius: float, one: int, other: int, tolerance: float
) -> None:
    rings = {"one": ring_of(5.0, one), "other": 0.3 + ring_of(radius, other)}
    found = polygon_gaps(rings, tolerance)("one", "other")
    distance = shapely.distance(line(rings["one"]), line(rings["other"]))
    if distance > tolerance:
        assert found is None
    else:
        assert found is not None
        assert found[0] == distance
        # The place is on the one of both, within the rounding of 5 mm.
        assert line(rings["one"]).distance(shapely.Point(found[1].real, found[1].imag)) < 1e-14


# Which contour of a file is which boundary: by size, and by place where sizes are equal -----------


HOLES = [Contour.circle(3.0, 30.0 * cmath.exp(2j * math.pi * k / 6.0)) for k in range(6)]

NESTED = [Contour.circle(radius) for radius in (60.0, 49.0, 48.0, 12.0)]


def chords_of(contour: Contour) -> Contour:
    points = contour.points(0.03)
    return Contour(points, np.zeros(len(points)), np.zeros_like(points))


@pytest.mark.parametrize("seed", range(5))
def test_each_contour_is_found_in_any_order(seed: int) -> None:
    wanted = [*NESTED, *HOLES]
    order = np.random.default_rng(seed).permutation(len(wanted)).tolist()
    contours = [wanted[k] if k % 2 else wanted[k].reversed() for k in order]
    found = paired(contours, [chords_of(each) for each in wanted])
    assert [order.index(k) for k in range(len(wanted))] == [
        next(i for i, each in enumerate(contours) if each is match) for match in found
    ]


def test_a_hole_that_was_moved_stays_that_hole() -> None:
    """The others keep theirs, so that one deviation is reported and not two."""
    moved = [Contour.circle(3.0, 31.0 + 0j), *HOLES[1:]]
    assert paired(moved, [chords_of(each) for each in HOLES]) == moved


def test_small_contours_are_told_apart_by_their_places() -> None:
    """Their areas are no better known than a tolerance for the whole drawing allows, so their order
    is another one in the file.
    """
    sizes = [0.30 + 0.004 * k for k in range(12)]
    wanted = [Contour.circle(size, 20.0 * cmath.exp(0.3j * k)) for k, size in enumerate(sizes)]
    off = [0.009 if k % 2 else -0.009 for k in range(12)]
    contours = [
        Contour.circle(size + more, 20.0 * cmath.exp(0.3j * k))
        for k, (size, more) in enumerate(zip(sizes, off, strict=True))
    ]
    big = Contour.circle(50.0)
    assert paired([big, *contours[::-1]], [*wanted, big]) == [*contours, big]
