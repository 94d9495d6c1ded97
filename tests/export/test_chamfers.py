"""Chamfers in the files of solids: written, read back, verified; what lacks one is refused."""

from __future__ import annotations

import io
import math
import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
import trimesh

import camgeo
from camgeo.design.verify import Reading
from camgeo.design.writing import Writer
from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.part.assembly import bore_boundary
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.mass import solid
from camgeo.part.part import Bevel, Boundary, Layer, Part
from camgeo.part.spec import DShaft, Keyway
from camgeo.units import LengthUnit
from camgeo_export.part21.solid import Cone, Model, solid_of
from camgeo_export.part21.text import exchange_of
from camgeo_export.solid.measure import measure
from camgeo_export.solid.prism import body
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.body import _sections, body_checks, polygon
from camgeo_export.verify.step import VERIFIER as STEP_VERIFIER
from camgeo_export.verify.step import bounds_of, is_inclined, volume_of
from tests.effects.scenes import design
from tests.export.test_solids import PartProduct
from tests.export.verified import faults
from tests.part.test_mass import circle

OUTLINE = circle("outline", 30.0, complex(0.0, -5.0))
BORE = circle("bore", 8.0, hole=True)
TOLERANCE = 0.01


def bevel(boundary: Boundary, width: float, z: float, *, upper: bool) -> Bevel:
    edge = boundary.inset(width, f"chamfer of the {boundary.name}")
    return Bevel(boundary, edge, width, width, z, upper)


PART = Part(
    (Layer(-8.0, 0.0, (OUTLINE, BORE)),),
    (
        bevel(OUTLINE, 0.5, 0.0, upper=True),
        bevel(OUTLINE, 0.5, -8.0, upper=False),
        bevel(BORE, 1.0, 0.0, upper=True),
    ),
)
PRODUCT = PartProduct(given=PART)


def _cone(one: float, other: float) -> float:
    """Volume of a frustum of 45 degrees."""
    return math.pi * abs(other**3 - one**3) / 3.0


WALLS = 7.0 * math.pi * (30.0**2 - 8.0**2)
VOLUME = 2.0 * _cone(29.5, 30.0) + WALLS - _cone(8.0, 9.0)


def mesh() -> tuple[FloatArray, IntArray]:
    made = body(PART, TOLERANCE, lambda values: values)
    return made.vertices.copy(), made.triangles


@pytest.mark.parametrize("writer", [STL, THREEMF], ids=["stl", "3mf"])
@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
def test_read_back_is_within_the_tolerance(writer: Writer, tolerance: float) -> None:
    written = writer.write(PRODUCT, tolerance)
    measured = writer.measure(PRODUCT, written.data)
    assert measured is not None
    assert 0.5 * tolerance < measured <= tolerance
    assert written.facts["volume_mm3"] == pytest.approx(VOLUME, rel=0.2 * tolerance)
    found = trimesh.load_mesh(io.BytesIO(written.data), file_type=writer.format.suffix[1:])
    assert found.is_volume
    assert found.bounds[:, 2].tolist() == [0.0, 8.0]


def test_mass_and_mesh_agree_with_cones() -> None:
    assert solid(PART).volume == pytest.approx(VOLUME, rel=1e-13)


def test_a_chamfer_takes_no_more_facets_than_a_wall() -> None:
    """Each wall has two facets for each of its chords, and so has each chamfer beside it."""
    sharp, edged = (len(body(part, TOLERANCE, lambda values: values).triangles)
                    for part in (PART.sharp, PART))  # fmt: skip
    assert edged <= 1.1 * 2.0 * sharp


def test_verification_has_nothing_to_say() -> None:
    vertices, triangles = mesh()
    checks = body_checks(PRODUCT, vertices, triangles, TOLERANCE)
    assert [check for check in checks if not check.ok] == []
    where = {check.of for check in checks if check.name == "deviation"}
    assert len([each for each in where if "half way up" in each]) == 3


def test_a_solid_with_sharp_edges_is_refused() -> None:
    made = body(PART.sharp, TOLERANCE, lambda values: values)
    with pytest.raises(FileError, match="there is no chamfer"):
        measure(PART, made.vertices, made.triangles)
    for check in body_checks(PRODUCT, made.vertices, made.triangles, TOLERANCE):
        if check.name == "deviation" and "chamfer" in check.of:
            assert not check.ok


def test_a_chamfer_of_another_width_is_measured() -> None:
    wide = bevel(BORE, 1.25, 0.0, upper=True)
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
    places = vertices[:, 0] + 1j * vertices[:, 1]
    top = (vertices[:, 2] == 8.0) & (np.abs(places) < 10.0)
    count = int(np.count_nonzero(top))
    order = np.flatnonzero(top)
    after = np.arange(len(vertices))
    after[order] = np.roll(order, count // 8)
    measured = measure(PART, vertices[after], triangles)
    # Half way up, chords of an eighth of a turn lie inside the circle of 8.5 mm.
    assert measured > 8.5 * (1.0 - math.cos(math.pi / 8.0)) - 0.1


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
    written = STEP.write(product, TOLERANCE)
    assert STEP.measure(product, written.data) <= TOLERANCE
    assert faults(STEP_VERIFIER, product, written.data) == []
    assert written.facts["volume_mm3"] == pytest.approx(VOLUME, rel=1e-12)
    read = solid_of(Model.of(exchange_of(written.data)))
    leaning = [face for face in read.faces if is_inclined(face)]
    assert {face.name for face in leaning} == {each.edge.name for each in PART.bevels}
    assert all(isinstance(face.surface, Cone) for face in leaning)
    assert (written.facts["faces"], written.facts["cones"]) == (12, 6)
    assert len(read.faces) == 12
    assert volume_of(bounds_of(read), read.faces) == pytest.approx(VOLUME, rel=1e-12)


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
    product = PartProduct(given=part)
    written = STEP.write(product, TOLERANCE)
    assert STEP.measure(product, written.data) <= TOLERANCE
    assert faults(STEP_VERIFIER, product, written.data) == []
    counts = [written.facts[kind] for kind in ("faces", "cylinders", "cones", "planes")]
    assert counts == [26, 4, 8, 14]
    assert written.facts["volume_mm3"] == pytest.approx(solid(part).volume, rel=1e-12)
    made = body(part, TOLERANCE, lambda values: values)
    assert measure(part, made.vertices, made.triangles) <= TOLERANCE


KEYED = bore_boundary(16.0, Keyway(5.0, 2.3, 0.4))
FLATTED = bore_boundary(16.0, None, DShaft(14.0, -2.0))


def with_bore(bore: ExactBoundary) -> Part:
    """A disc whose bore has chamfers on both sides, of different widths."""
    return Part(
        (Layer(-8.0, 0.0, (OUTLINE, bore)),),
        (
            bevel(OUTLINE, 0.5, 0.0, upper=True),
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
    product = PartProduct(given=part)
    written = STL.write(product, tolerance)
    measured = STL.measure(product, written.data)
    assert measured is not None
    assert 0.5 * tolerance < measured <= tolerance
    made = body(part, tolerance, lambda values: values)
    checks = body_checks(product, made.vertices.copy(), made.triangles, tolerance)
    assert [check for check in checks if not check.ok] == []
    for band in (each for each in part.bands if each.wall is bore and not each.is_upright):
        for share in (0.1, 0.3, 0.7, 0.9):
            z = band.z0 + share * (band.z1 - band.z0)
            ring = min(
                (polygon(each) for each in _sections(made.vertices, made.triangles, z + 8.0)),
                key=lambda contour: abs(contour.area),
            )
            assert band.section(z).deviation(ring.counter_clockwise()) <= tolerance


def test_straight_chords_along_bent_corners_are_measured() -> None:
    """Without steps a corner would be off by what its parabola leaves of its chord half way up."""
    part = with_bore(KEYED)
    made = body(part, 1e-3, lambda values: values)
    steps = sorted({round(z, 9) for z in made.vertices[:, 2].tolist() if 7.0 < z < 8.0})
    assert len(steps) > 2
    moved = made.vertices.copy()
    inner = (moved[:, 2] > 7.0) & (moved[:, 2] < 8.0) & (np.hypot(moved[:, 0], moved[:, 1]) < 20.0)
    moved[inner, :2] *= 1.001
    assert measure(part, moved, made.triangles) > 5e-3


@BORES
@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_step_files_have_parabolas_at_corners(bore: ExactBoundary, unit: LengthUnit) -> None:
    part = with_bore(bore)
    product = replace(PRODUCT, given=part, unit=unit)
    written = STEP.write(product, TOLERANCE)
    assert STEP.measure(product, written.data) <= 1e-9
    assert faults(STEP_VERIFIER, product, written.data) == []
    volume = solid(part).volume
    assert written.facts["volume_mm3"] == pytest.approx(volume, rel=1e-13)
    read = solid_of(Model.of(exchange_of(written.data)))
    assert volume_of(bounds_of(read), read.faces) == pytest.approx(volume, rel=1e-12)
    edges = {use.edge.number: use.edge for face in read.faces for loop in face.loops
             for use in loop}  # fmt: skip
    bends = [each.bend for each in edges.values() if each.bend is not None]
    assert len(bends) == 4  # two corners with an arc on each side
    for bend in bends:
        # The corner stays between cone and plane: at each height on the section's.
        z = 0.5 * (bend.start.z + bend.end.z)
        width = min(z, 8.0 - z)
        vertices = bore.inset(width, "section").exact.vertices
        assert min(abs(vertices - bend.place_at(z))) <= 1e-12 * 25.4


@pytest.mark.parametrize(
    ("pattern", "new"),
    [
        (rb"(B_SPLINE_CURVE_WITH_KNOTS\('',2,\(#\d+,)#\d+,", rb"\g<1>#1,"),
        (rb"(B_SPLINE_CURVE_WITH_KNOTS\('',2,\((#\d+),)#\d+,", rb"\g<1>\g<2>,"),
        (rb"(CONICAL_SURFACE\('',#\d+,)8\.", rb"\g<1>8.01"),
    ],
)
def test_faults_of_parabolas_are_found(pattern: bytes, new: bytes) -> None:
    product = PartProduct(given=with_bore(KEYED))
    data = STEP.write(product, TOLERANCE).data
    changed, count = re.subn(pattern, new, data)
    assert count
    assert faults(STEP_VERIFIER, product, changed)
    with pytest.raises(FileError):
        STEP.measure(product, changed)


def test_step_files_cannot_have_chamfers_along_splines() -> None:
    base = design("plate_translating", "").scene
    keys = {"part.thickness": 8, "part.chamfers": {"outline": {"width": 0.5}},
            "output.step": {"walls": "spline"}}  # fmt: skip
    with pytest.raises(GeometryError, match="parallel of a spline") as caught:
        STEP.write(camgeo.Design(base.with_values(keys)).disc, TOLERANCE)
    assert caught.value.key == "output.step.walls"


@pytest.mark.parametrize(
    ("kind", "pattern", "new", "fault"),
    [
        ("radius", rb"(CONICAL_SURFACE\('',#\d+,)29\.5", rb"\g<1>29.6", "uncertainty"),
        ("angle", rb"(CONICAL_SURFACE\('',#\d+,[^,]*),0\.785\d*", rb"\g<1>,0.7", "uncertainty"),
        ("sense", rb"(ADVANCED_FACE\('chamfer of the bore',[^)]*\),#\d+,)\.F\.", rb"\g<1>.T.",
         "walls"),
    ],
)  # fmt: skip
def test_faults_of_cones_are_found(kind: str, pattern: bytes, new: bytes, fault: str) -> None:
    data = STEP.write(PRODUCT, TOLERANCE).data
    changed, count = re.subn(pattern, new, data)
    assert count, kind
    assert fault in {check.name for check in faults(STEP_VERIFIER, PRODUCT, changed)}
    with pytest.raises(FileError):
        STEP.measure(PRODUCT, changed)


def test_a_step_file_of_other_chamfers_is_refused() -> None:
    data = STEP.write(PRODUCT, TOLERANCE).data
    sharp = PartProduct(given=PART.sharp)
    wide = PartProduct(
        given=Part(PART.layers, (*PART.bevels[:2], bevel(BORE, 1.5, 0.0, upper=True)))
    )
    for product in (sharp, wide):
        foreign = Reading("x.step")
        checks = STEP_VERIFIER.checks(product, data, foreign, TOLERANCE)
        assert {check.name for check in checks if check.ok is False} >= {"deviation"}
    upright = STEP.write(sharp, TOLERANCE).data
    with pytest.raises(FileError):
        STEP.measure(PRODUCT, upright)
