"""DXF: what is written is what is read back, within the tolerance, in the right unit."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from ezdxf.path import make_path

import camgeo
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import Arc
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.formats.dxf import DxfSpec
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.dxf.reader import drawing_of
from camgeo_export.dxf.writer import WRITER
from tests.export.stub_product import StubProduct

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

PRODUCTS = {
    "disc": StubProduct(),
    "inch": StubProduct(unit="inch"),
    "groove": StubProduct(groove=True),
    "polyline": StubProduct(dxf=DxfSpec("polyline")),
    "single": StubProduct(dxf=DxfSpec("lines-and-arcs"), groove=True),
    "cut only": StubProduct(dxf=DxfSpec(auxiliary=False)),
    "large": StubProduct(scale=1e4),
}


@pytest.fixture(params=list(PRODUCTS.values()), ids=list(PRODUCTS))
def product(request: pytest.FixtureRequest) -> StubProduct:
    found: StubProduct = request.param
    return found


@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
def test_read_back_is_within_the_tolerance(product: StubProduct, tolerance: float) -> None:
    written = WRITER.write(product, tolerance)
    assert 0.5 * tolerance < WRITER.measure(product, written.data) <= tolerance


def test_numbers_keep_the_finest_tolerance() -> None:
    product = StubProduct()
    assert WRITER.measure(product, WRITER.write(product, 1e-7).data) <= 1e-7


def test_the_same_bytes_each_time(product: StubProduct) -> None:
    assert WRITER.write(product, 0.01).data == WRITER.write(product, 0.01).data


def test_ezdxf_setting_is_put_back() -> None:
    before = ezdxf.options.write_fixed_meta_data_for_testing  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    WRITER.write(StubProduct(), 0.01)
    assert ezdxf.options.write_fixed_meta_data_for_testing == before  # type: ignore[attr-defined]  # ezdxf does not export it explicitly


def test_ezdxf_finds_nothing_to_mend(product: StubProduct) -> None:
    text = WRITER.write(product, 0.01).data.decode()
    document = ezdxf.read(io.StringIO(text))  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes


def test_entities_layers_and_units() -> None:
    product = StubProduct()
    data = WRITER.write(product, 0.01).data
    drawing = drawing_of(data)
    kinds = [(item.layer, item.kind) for item in drawing.items]
    assert kinds == [
        ("CUT", "LWPOLYLINE"),
        ("CUT", "LWPOLYLINE"),
        ("PITCH_CURVE", "LWPOLYLINE"),
        ("BASE_CIRCLE", "CIRCLE"),
        ("CENTRE", "LINE"),
        ("CENTRE", "LINE"),
    ]
    assert drawing.value("$ACADVER") == "AC1024"
    assert (drawing.value("$INSUNITS"), drawing.value("$MEASUREMENT")) == ("4", "1")
    inch = drawing_of(WRITER.write(replace(product, unit="inch"), 0.01).data)
    assert (inch.value("$INSUNITS"), inch.value("$MEASUREMENT")) == ("1", "0")
    document = ezdxf.read(io.StringIO(data.decode()))  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    assert dict(document.header.custom_vars) == {
        "camgeo": product.version,
        "scene": product.scene_hash,
        "tolerance mm": "0.01",
    }


def test_edges_that_do_not_go_through_are_on_a_layer_with_their_depth() -> None:
    data = WRITER.write(StubProduct(groove=True), 0.01).data
    drawing = drawing_of(data)
    layers = [item.layer for item in drawing.items]
    assert layers[:4] == ["CUT", "CUT", "BLIND_3", "BLIND_3"]
    assert [record.text(2) for record in drawing.layers].count("BLIND_3") == 1
    # Whoever reads no particular layer gets the whole part, and nothing else.
    assert len(drawing.contours(None)) == 4
    rim, bore = drawing.contours("CUT")
    assert rim.area > math.pi * 59.0**2
    assert bore.area < math.pi * 11.0**2
    inch = drawing_of(WRITER.write(StubProduct(groove=True, unit="inch"), 0.01).data)
    assert "BLIND_0.11811" in {item.layer for item in inch.items}


def test_single_lines_and_arcs_are_those_of_the_polylines() -> None:
    drawings = [
        drawing_of(WRITER.write(StubProduct(dxf=DxfSpec(entity)), 0.01).data)
        for entity in ("arcs", "lines-and-arcs")
    ]
    kinds = {item.kind for item in drawings[1].items if item.layer == "CUT"}
    assert kinds == {"ARC"}
    for one, other in zip(*(each.contours("CUT") for each in drawings), strict=True):
        assert isinstance(one, Contour)
        assert isinstance(other, Contour)
        assert len(one) == len(other)
        assert one.area == pytest.approx(other.area, rel=1e-12)


def test_without_auxiliary_geometry_only_the_cut_is_drawn() -> None:
    drawing = drawing_of(WRITER.write(PRODUCTS["cut only"], 0.01).data)
    assert {item.layer for item in drawing.items} == {"CUT"}


def test_areas_are_those_of_the_part() -> None:
    outline, bore = drawing_of(WRITER.write(StubProduct(), 1e-5).data).contours("CUT")
    assert outline.area == pytest.approx(math.pi * 32.0**2, rel=1e-6)
    assert bore.area == pytest.approx(math.pi * 10.0**2, rel=1e-6)


def test_no_arc_exceeds_half_a_turn() -> None:
    for contour in drawing_of(WRITER.write(StubProduct(), 0.01).data).contours("CUT"):
        assert isinstance(contour, Contour)
        assert abs(contour.sweeps).max() <= math.pi


def test_chain_gives_back_a_contour() -> None:
    contour = Contour.circle(3.0, 1.0 + 2.0j).split(1.0)
    again = Contour.through(contour.vertices, contour.sweeps)
    np.testing.assert_allclose(again.centres, contour.centres, atol=1e-14)


@pytest.mark.parametrize("sweep", [5e-324, 1e-300, 1e-160, -1e-17])
def test_an_arc_that_is_straight_except_for_rounding_is_a_line(sweep: float) -> None:
    """Its centre would lie where doubles have no squares, or no digits."""
    vertices = np.array([10.0, 10.0 + 8.0j, 3.0j])
    contour = Contour.through(vertices, np.array([sweep, 1.0, -sweep]))
    assert contour.sweeps.tolist() == [0.0, 1.0, 0.0]
    polygon = Contour.through(vertices, np.array([0.0, 1.0, 0.0]))
    assert contour.area == polygon.area
    assert Arc(0j, 1j, sweep, 0j).between(0j, 2j) == Arc(0j, 2j, 0.0, 0j)


def test_a_flat_arc_and_one_that_is_nearly_a_circle_stay_arcs() -> None:
    nearly = 2.0 * math.pi - 1e-9
    contour = Contour.through(np.array([10.0, 10.0 + 1e-9j, 20.0j]), np.array([nearly, 1e-12, 0.0]))
    assert contour.sweeps.tolist() == [nearly, 1e-12, 0.0]


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e5])
@pytest.mark.parametrize("unit", ["mm", "inch"])
@pytest.mark.parametrize("auxiliary", [True, False])
def test_the_drawing_is_seen_when_it_is_opened(
    scale: float, unit: LengthUnit, auxiliary: bool
) -> None:
    """Extents, limits and open view, as ezdxf reads them, compared with circles of the part."""
    product = StubProduct(scale=scale, unit=unit, dxf=DxfSpec(auxiliary=auxiliary))
    mm = MM_PER[unit]
    lowest, side = (-45.0, 40.0) if auxiliary else (-37.0, 32.0)
    box = np.array([-side, lowest, side, max(27.0, 35.0 * auxiliary)]) * scale / mm
    slack = 1e-3 * scale
    data = WRITER.write(product, 1e-4 * scale).data
    document = ezdxf.read(io.StringIO(data.decode()))  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    check_view(document, box, slack)


def check_view(document: Any, box: FloatArray, slack: float) -> None:
    """Assert that `document` shows the box (4,) of a drawing, with a margin."""

    def pair(low: str, high: str) -> FloatArray:
        return np.array([*document.header[low][:2], *document.header[high][:2]])

    np.testing.assert_allclose(pair("$EXTMIN", "$EXTMAX"), box, atol=slack)
    (view,) = document.viewports.get("*Active")
    middle, height = view.dxf.center, view.dxf.height
    half = np.array([0.5 * height * view.dxf.aspect_ratio, 0.5 * height])
    seen = np.array([middle.x - half[0], middle.y - half[1], *(np.array(middle)[:2] + half)])
    size = max(box[2] - box[0], box[3] - box[1])
    for shown in (pair("$LIMMIN", "$LIMMAX"), seen):
        beyond = np.concatenate((box[:2] - shown[:2], shown[2:] - box[2:]))
        assert np.all(beyond >= 0.04 * size)
        assert np.min(beyond) <= 0.06 * size
    assert height <= 1.2 * size


@pytest.mark.parametrize("entity", ["arcs", "spline"])
def test_the_view_of_a_real_disc(entity: str) -> None:
    """Curves that reach their extremes inside a piece, compared with points on all of them."""
    scene = SCENES / "setzhub.toml"
    text = f'{scene.read_text("utf-8")}\n[output.dxf]\nentity = "{entity}"\nauxiliary = false\n'
    data = WRITER.write(camgeo.loads(text).disc, 0.01).data
    document = ezdxf.read(io.StringIO(data.decode()))  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    courses = [make_path(each) for each in document.modelspace()]
    points = np.array([(p.x, p.y) for each in courses for p in each.flattening(1e-4)])
    box = np.concatenate((points.min(axis=0), points.max(axis=0)))
    # ezdxf flattens arcs by way of cubics, 0.008 mm off here.
    check_view(document, box, 0.01)


# A measurement that accepts a wrong file is worth nothing: break the file and see it found.


def test_a_moved_vertex_is_measured() -> None:
    product = StubProduct()
    data = WRITER.write(product, 0.01).data
    vertex = b"\n 10\n32.0\n"
    assert data.count(vertex) == 1
    moved = data.replace(vertex, b"\n 10\n32.5\n")
    assert WRITER.measure(product, moved) > 0.1


def test_a_reversed_bulge_is_measured() -> None:
    product = StubProduct()
    data = WRITER.write(product, 0.01).data
    head, entities = data.split(b"ENTITIES")
    turned = entities.replace(b"\n 42\n0.", b"\n 42\n-0.", 1)
    assert WRITER.measure(product, head + b"ENTITIES" + turned) > 0.1


def test_a_foreign_scale_is_measured() -> None:
    data = WRITER.write(StubProduct(scale=1.001), 0.01).data
    assert WRITER.measure(StubProduct(), data) > 0.03


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"$INSUNITS\n 70\n4", b"$INSUNITS\n 70\n1", "INSUNITS"),
        (b"$INSUNITS\n 70\n4", b"$INSUNITS\n 70\n6", "INSUNITS"),
        (b"$MEASUREMENT\n 70\n1", b"$MEASUREMENT\n 70\n0", "MEASUREMENT"),
        (b"\n 70\n1\n 10\n", b"\n 70\n0\n 10\n", "LWPOLYLINE has a loose end"),
        (b"\n 10\n32.0\n", b"\n 10\nnan\n", "not a finite number"),
        (b"\n 10\n32.0\n", b"\n 11\n32.0\n", "vertices"),
        (b"\n  8\nCUT", b"\n  8\nSCRAP", "SCRAP"),
        (b"CIRCLE\n", b"TEXT\n", "TEXT"),
        (b"EOF", b"EO", "no EOF"),
        (b"  0\nSECTION", b"  a\nSECTION", "not a DXF"),
    ],
)
def test_a_broken_drawing_is_refused(old: bytes, new: bytes, message: str) -> None:
    product = StubProduct()
    data = WRITER.write(product, 0.01).data
    assert old in data
    with pytest.raises(FileError, match=message):
        WRITER.measure(product, data.replace(old, new))


def test_a_missing_boundary_is_refused() -> None:
    with pytest.raises(FileError, match="has no layer 'BLIND_3'"):
        WRITER.measure(StubProduct(groove=True), WRITER.write(StubProduct(), 0.01).data)
