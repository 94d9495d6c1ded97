"""STL and 3MF: one closed body, upright, within the tolerance; broken ones are refused."""

from __future__ import annotations

import cmath
import io
import math
from dataclasses import dataclass, replace

import lib3mf  # type: ignore[import-untyped]  # has no types
import numpy as np
import pytest
import trimesh

from camgeo.design.writing import Writer
from camgeo.errors import FileError, ToleranceError
from camgeo.part.part import Layer, Part
from camgeo_export.solid.prism import FIT_SHARE, body
from camgeo_export.stl import FACET
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.body import body_checks
from tests.export.stub_product import CircleBoundary, StubProduct
from tests.packages import repacked

VOLUMES = {False: 8.0 * math.pi * (32.0**2 - 10.0**2)}
VOLUMES[True] = math.pi * (8.0 * (60.0**2 - 10.0**2) - 3.0 * (48.0**2 - 32.0**2))


@dataclass(frozen=True, slots=True)
class PartProduct(StubProduct):
    """A product that is nothing but its part."""

    given: Part | None = None

    @property
    def part(self) -> Part:
        assert self.given is not None
        return self.given


both = pytest.mark.parametrize("writer", [STL, THREEMF], ids=["stl", "3mf"])


@both
@pytest.mark.parametrize("groove", [False, True], ids=["disc", "groove"])
@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
def test_read_back_is_within_the_tolerance(writer: Writer, groove: bool, tolerance: float) -> None:
    product = StubProduct(groove=groove, unit="inch")
    written = writer.write(product, tolerance)
    measured = writer.measure(product, written.data)
    assert measured is not None
    assert 0.5 * tolerance < measured <= tolerance
    assert written.facts["volume_mm3"] == pytest.approx(VOLUMES[groove], rel=tolerance / 10.0)
    assert written.data == writer.write(product, tolerance).data


@both
@pytest.mark.parametrize("groove", [False, True], ids=["disc", "groove"])
def test_trimesh_sees_a_closed_volume(writer: Writer, groove: bool) -> None:
    data = writer.write(StubProduct(groove=groove), 0.01).data
    mesh = trimesh.load_mesh(io.BytesIO(data), file_type=writer.format.suffix[1:])
    assert mesh.is_volume
    assert mesh.volume == pytest.approx(VOLUMES[groove], rel=1e-3)
    assert mesh.bounds[:, 2].tolist() == [0.0, 8.0]


def test_stl_normals_and_header() -> None:
    data = STL.write(StubProduct(), 0.01).data
    assert data.startswith(b"camgeo 0.0.test unit mm scene 0123456789abcdef eccentric")
    facets = np.frombuffer(data[84:], dtype=FACET)
    corners = facets["corners"].astype(float)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    np.testing.assert_allclose(facets["normal"], normals, atol=1e-6)


def test_stl_says_when_its_floats_are_too_coarse() -> None:
    with pytest.raises(ToleranceError, match="too coarse"):
        STL.write(StubProduct(), 1e-6)
    product = StubProduct()
    assert THREEMF.measure(product, THREEMF.write(product, 1e-5).data) <= 1e-5


def test_lib3mf_has_nothing_to_say() -> None:
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(THREEMF.write(StubProduct(groove=True), 0.01).data)
    assert reader.GetWarningCount() == 0
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    mesh = meshes.GetCurrentMeshObject()
    assert mesh.IsManifoldAndOriented()
    assert mesh.GetName() == "eccentric"
    assert not meshes.MoveNext()


def stl_of(corners: np.ndarray) -> bytes:
    facets = np.zeros(len(corners), dtype=FACET)
    facets["corners"] = corners
    head = b"camgeo x unit mm ".ljust(80) + np.uint32(len(facets)).tobytes()
    return head + facets.tobytes()


@pytest.fixture(scope="module")
def corners() -> np.ndarray:
    data = STL.write(StubProduct(), 0.01).data
    return np.array(np.frombuffer(data[84:], dtype=FACET)["corners"])


def test_a_missing_facet_is_refused(corners: np.ndarray) -> None:
    with pytest.raises(FileError, match=r"the check 'closed': the edge .* has 1 of 2 facets"):
        STL.measure(StubProduct(), stl_of(corners[1:]))


def test_a_flipped_facet_is_refused(corners: np.ndarray) -> None:
    corners = corners.copy()
    corners[5] = corners[5, ::-1]
    with pytest.raises(FileError, match=r"facet 6, near .* is turned against its neighbours"):
        STL.measure(StubProduct(), stl_of(corners))


def test_a_body_inside_out_is_refused(corners: np.ndarray) -> None:
    with pytest.raises(FileError, match="inside out"):
        STL.measure(StubProduct(), stl_of(corners[:, ::-1]))


def test_a_moved_vertex_is_measured(corners: np.ndarray) -> None:
    column = (corners[..., :2] == corners[0, 0, :2]).all(axis=-1)
    moved = corners.copy()
    moved[column, 0] += 0.2
    assert STL.measure(StubProduct(), stl_of(moved)) > 0.1


def test_a_wrong_height_is_measured(corners: np.ndarray) -> None:
    taller = corners * np.array([1.0, 1.0, 1.25])
    assert STL.measure(StubProduct(), stl_of(taller)) == pytest.approx(2.0)


def test_a_leaning_wall_is_refused(corners: np.ndarray) -> None:
    leaning = corners.copy()
    leaning[..., 0] += 0.01 * leaning[..., 2]
    with pytest.raises(FileError, match="neither flat nor upright"):
        STL.measure(StubProduct(), stl_of(leaning))


def test_an_stl_in_inches_is_measured(corners: np.ndarray) -> None:
    assert STL.measure(StubProduct(), stl_of(corners / 25.4)) > 10.0


def test_a_cut_stl_is_refused() -> None:
    with pytest.raises(FileError, match="complete binary STL"):
        STL.measure(StubProduct(), STL.write(StubProduct(), 0.01).data[:-10])


def test_a_groove_that_is_not_there_is_refused() -> None:
    data = STL.write(StubProduct(), 0.01).data
    with pytest.raises(FileError, match="2 heights, expected 3"):
        STL.measure(StubProduct(groove=True), data)


@both
def test_a_scene_without_thickness_is_reported(writer: Writer) -> None:
    data = writer.write(StubProduct(), 0.01).data
    assert "part.thickness" in writer.format.needs
    with pytest.raises(FileError, match=r"part\.thickness"):
        writer.measure(StubProduct(thickness=None), data)


def test_a_3mf_in_another_unit_is_refused() -> None:
    data = THREEMF.write(StubProduct(), 0.01).data
    with pytest.raises(FileError, match="not in millimetres"):
        THREEMF.measure(
            StubProduct(), repacked(data, lambda _, text: text.replace("millimeter", "inch"))
        )


def test_a_cut_3mf_is_refused() -> None:
    data = THREEMF.write(StubProduct(), 0.01).data
    with pytest.raises(FileError, match="not a 3MF"):
        THREEMF.measure(StubProduct(), data[:-100])
    with pytest.raises(FileError, match="not a 3MF"):
        THREEMF.measure(StubProduct(), repacked(data, lambda _, text: text.replace("</mesh>", "")))


def test_a_3mf_keeps_doubles() -> None:
    product = StubProduct()
    data = THREEMF.write(product, 0.01).data
    boundary = product.part.boundaries[0].polyline(FIT_SHARE * 0.01).contour.vertices
    mesh = trimesh.load_mesh(io.BytesIO(data), file_type="3mf", process=False)
    plane = np.asarray(mesh.vertices)[:, 0] + 1j * np.asarray(mesh.vertices)[:, 1]
    assert set(boundary.tolist()) <= set(plane.tolist())


def _shifted(name: str, radius: float, centre: complex, *, hole: bool) -> CircleBoundary:
    return CircleBoundary(name, hole, radius, centre)


RIM, BORE = _shifted("rim", 40.0, 0j, hole=False), _shifted("bore", 8.0, 0j, hole=True)
HUB = _shifted("hub", 15.0, 0j, hole=False)
COUNTERBORE = _shifted("counterbore", 12.0, 0j, hole=True)
POCKETS = tuple(
    _shifted(f"pocket {k}", 5.0, 28.0 * cmath.exp(2j * math.pi * k / 3.0), hole=True)
    for k in range(3)
)
ISLAND = _shifted("island", 2.0, 28.0 + 0j, hole=False)

PARTS: dict[str, tuple[Layer, ...]] = {
    "hub": (Layer(-10.0, 0.0, (RIM, BORE)), Layer(0.0, 6.0, (HUB, BORE), "hub")),
    "hubs on both sides": (
        Layer(-16.0, -10.0, (HUB, BORE), "lower hub"),
        Layer(-10.0, 0.0, (RIM, BORE)),
        Layer(0.0, 6.0, (replace(HUB, name="upper hub"), BORE), "hub"),
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


@pytest.mark.parametrize("name", PARTS)
def test_layers_of_any_kind_make_one_body(name: str) -> None:
    """Closed, upright, at the right heights and of the right volume, without a word about kinds."""
    part = Part(PARTS[name])
    tolerance = 1e-3
    solid = body(part, tolerance, lambda values: values)
    mesh = trimesh.Trimesh(solid.vertices, solid.triangles, process=False)
    assert mesh.is_volume
    volume = sum(
        math.pi * each.radius**2 * (-1.0 if each.hole else 1.0) * (layer.z1 - layer.z0)
        for layer in part.layers
        for each in layer.boundaries
        if isinstance(each, CircleBoundary)
    )
    walls = sum(
        math.tau * wall.boundary.radius * (wall.z1 - wall.z0)
        for wall in part.walls
        if isinstance(wall.boundary, CircleBoundary)
    )
    assert abs(solid.volume - volume) <= tolerance * walls
    heights = np.unique(solid.vertices[:, 2]).tolist()
    assert heights == [level.z - part.levels[0].z for level in part.levels]
    product = PartProduct(given=part)
    data = THREEMF.write(product, tolerance).data
    assert 0.5 * tolerance < THREEMF.measure(product, data) <= tolerance
    checks = body_checks(product, solid.vertices, solid.triangles, tolerance)
    assert all(check.ok for check in checks)
