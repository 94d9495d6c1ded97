"""STL and 3MF: one closed body, upright, within the tolerance; broken ones are refused."""

from __future__ import annotations

import io
import math
import zipfile

import lib3mf  # type: ignore[import-untyped]
import numpy as np
import pytest
import trimesh

from camgeo.errors import ToleranceError
from camgeo.files.product import Writer
from camgeo_export.errors import FileError
from camgeo_export.solid.prism import FIT_SHARE
from camgeo_export.stl.writer import FACET
from camgeo_export.stl.writer import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from tests.export.stub_product import StubProduct

VOLUMES = {False: 8.0 * math.pi * (32.0**2 - 10.0**2)}
VOLUMES[True] = math.pi * (8.0 * (60.0**2 - 10.0**2) - 3.0 * (48.0**2 - 32.0**2))

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
    mesh = trimesh.load_mesh(io.BytesIO(data), file_type=writer.suffix[1:])
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
    with pytest.raises(FileError, match="not closed"):
        STL.measure(StubProduct(), stl_of(corners[1:]))


def test_a_flipped_facet_is_refused(corners: np.ndarray) -> None:
    corners = corners.copy()
    corners[5] = corners[5, ::-1]
    with pytest.raises(FileError, match="not closed"):
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
    with pytest.raises(FileError, match="not upright"):
        STL.measure(StubProduct(), stl_of(leaning))


def test_an_stl_in_inches_is_measured(corners: np.ndarray) -> None:
    assert STL.measure(StubProduct(), stl_of(corners / 25.4)) > 10.0


def test_a_cut_stl_is_refused() -> None:
    with pytest.raises(FileError, match="whole binary STL"):
        STL.measure(StubProduct(), STL.write(StubProduct(), 0.01).data[:-10])


def test_a_groove_that_is_not_there_is_refused() -> None:
    data = STL.write(StubProduct(), 0.01).data
    with pytest.raises(FileError, match="2 heights, expected 3"):
        STL.measure(StubProduct(groove=True), data)


@both
def test_a_scene_without_thickness_is_told(writer: Writer) -> None:
    data = writer.write(StubProduct(), 0.01).data
    assert "part.thickness" in writer.needs
    with pytest.raises(FileError, match=r"part\.thickness"):
        writer.measure(StubProduct(thickness=None), data)


def repacked(data: bytes, old: bytes, new: bytes) -> bytes:
    stream = io.BytesIO()
    source = zipfile.ZipFile(io.BytesIO(data))
    with zipfile.ZipFile(stream, "w") as target:
        for name in source.namelist():
            target.writestr(name, source.read(name).replace(old, new))
    return stream.getvalue()


def test_a_3mf_in_another_unit_is_refused() -> None:
    data = THREEMF.write(StubProduct(), 0.01).data
    with pytest.raises(FileError, match="not in millimetres"):
        THREEMF.measure(StubProduct(), repacked(data, b"millimeter", b"inch"))


def test_a_cut_3mf_is_refused() -> None:
    data = THREEMF.write(StubProduct(), 0.01).data
    with pytest.raises(FileError, match="not a 3MF"):
        THREEMF.measure(StubProduct(), data[:-100])
    with pytest.raises(FileError, match="not a 3MF"):
        THREEMF.measure(StubProduct(), repacked(data, b"</mesh>", b""))


def test_a_3mf_keeps_doubles() -> None:
    product = StubProduct()
    data = THREEMF.write(product, 0.01).data
    boundary = product.part.through[0].polyline(FIT_SHARE * 0.01).contour.vertices
    mesh = trimesh.load_mesh(io.BytesIO(data), file_type="3mf", process=False)
    plane = np.asarray(mesh.vertices)[:, 0] + 1j * np.asarray(mesh.vertices)[:, 1]
    assert set(boundary.tolist()) <= set(plane.tolist())
