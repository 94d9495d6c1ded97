"""DXF and SVG at true size: what is written is what is read back, within the tolerance."""

from __future__ import annotations

import io
import math
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing
from ezdxf.filemanagement import read as parsed
from ezdxf.path import make_path

import camgeo
from camgeo.app.answers.verify import Reference, Wanted, verify_files
from camgeo.design.verify import ReadingOptions
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import Arc, SplineContour
from camgeo.geometry.outline.path import whole
from camgeo.numeric.arrays import FloatArray
from camgeo.part.boundaries import CurveBoundary, spline_deviation
from camgeo.part.part import WRITTEN_SHARE, Layer, Part
from camgeo.scene.formats.dxf import DxfSpec
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.dxf.reader import READER, read_drawing
from camgeo_export.dxf.writer import WRITER
from camgeo_export.svg import WRITER as SVG_WRITER
from camgeo_export.svg import read_drawing as svg_drawing_of
from camgeo_export.verify.svg import VERIFIER as SVG_VERIFIER
from tests.contour.cams import flank
from tests.effects.scenes import SCENES
from tests.export.stub_product import CircleBoundary, StubProduct
from tests.export.test_drawing import svg_runs
from tests.export.verified import TOLERANCE, checked, faults, read_back

FIXTURE_SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

PRODUCTS = {
    "disc": StubProduct(),
    "inch": StubProduct(unit="inch"),
    "groove": StubProduct(groove=True),
    "polyline": StubProduct(dxf=DxfSpec("polyline")),
    "single": StubProduct(dxf=DxfSpec("lines-and-arcs"), groove=True),
    "cut only": StubProduct(dxf=DxfSpec(auxiliary=False)),
    "large": StubProduct(scale=1e4),
}


def test_ezdxf_setting_is_put_back() -> None:
    before = ezdxf.options.write_fixed_meta_data_for_testing  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    WRITER.write(StubProduct(), 0.01)
    assert ezdxf.options.write_fixed_meta_data_for_testing == before  # type: ignore[attr-defined]  # ezdxf does not export it explicitly


def opened(data: bytes) -> Drawing:
    """By ezdxf, which finds nothing to mend."""
    document = parsed(io.StringIO(data.decode()))
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    return document


@pytest.mark.parametrize("product", PRODUCTS.values(), ids=PRODUCTS)
def test_ezdxf_finds_nothing_to_mend(product: StubProduct) -> None:
    document = opened(WRITER.write(product, 0.01).data)
    layers = {each.dxf.layer for each in document.modelspace()}
    assert (layers == {"CUT"}) == (not product.dxf.auxiliary)


def test_entities_layers_and_units() -> None:
    product = StubProduct()
    data = WRITER.write(product, 0.01).data
    drawing = read_drawing(data)
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
    inch = read_drawing(WRITER.write(replace(product, unit="inch"), 0.01).data)
    assert (inch.value("$INSUNITS"), inch.value("$MEASUREMENT")) == ("1", "0")
    assert dict(opened(data).header.custom_vars) == {
        "camgeo": product.version,
        "scene": product.scene_hash,
        "tolerance mm": "0.01",
    }


def test_edges_that_do_not_go_through_are_on_a_layer_with_their_depth() -> None:
    data = WRITER.write(StubProduct(groove=True), 0.01).data
    drawing = read_drawing(data)
    layers = [item.layer for item in drawing.items]
    assert layers[:4] == ["CUT", "CUT", "BLIND_3", "BLIND_3"]
    assert [record.text(2) for record in drawing.layers].count("BLIND_3") == 1
    # Whoever reads no particular layer gets the whole part, and nothing else.
    assert len(drawing.contours(None)) == 4
    rim, bore = drawing.contours("CUT")
    assert rim.area > math.pi * 59.0**2
    assert bore.area < math.pi * 11.0**2
    inch = read_drawing(WRITER.write(StubProduct(groove=True, unit="inch"), 0.01).data)
    assert "BLIND_0.11811" in {item.layer for item in inch.items}


def test_single_lines_and_arcs_are_those_of_the_polylines() -> None:
    drawings = [
        read_drawing(WRITER.write(StubProduct(dxf=DxfSpec(entity)), 0.01).data)
        for entity in ("arcs", "lines-and-arcs")
    ]
    kinds = {item.kind for item in drawings[1].items if item.layer == "CUT"}
    assert kinds == {"ARC"}
    for one, other in zip(*(each.contours("CUT") for each in drawings), strict=True):
        assert isinstance(one, Contour)
        assert isinstance(other, Contour)
        assert len(one) == len(other)
        assert one.area == pytest.approx(other.area, rel=1e-12)


@pytest.mark.parametrize("sweep", [5e-324, 1e-300, 1e-160, -1e-17])
def test_an_arc_that_is_straight_except_for_rounding_is_a_line(sweep: float) -> None:
    """Its centre would lie where doubles have no squares, or no digits."""
    vertices = np.array([10.0, 10.0 + 8.0j, 3.0j])
    contour = Contour.through(vertices, np.array([sweep, 1.0, -sweep]))
    assert contour.sweeps.tolist() == [0.0, 1.0, 0.0]
    assert contour.area == Contour.through(vertices, np.array([0.0, 1.0, 0.0])).area
    assert Arc(0j, 1j, sweep, 0j).with_ends(0j, 2j) == Arc(0j, 2j, 0.0, 0j)


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
    check_view(opened(data), box, slack)


def check_view(document: Drawing, box: FloatArray, slack: float) -> None:
    """Assert that `document` shows the box (4,) of a drawing, with a margin."""

    def pair(low: str, high: str) -> FloatArray:
        return np.array([*document.header[low][:2], *document.header[high][:2]])

    np.testing.assert_allclose(pair("$EXTMIN", "$EXTMAX"), box, atol=slack)
    (view,) = document.viewports.get_config("*Active")
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
    scene = FIXTURE_SCENES / "setzhub.toml"
    text = f'{scene.read_text("utf-8")}\n[output.dxf]\nentity = "{entity}"\nauxiliary = false\n'
    document = opened(WRITER.write(camgeo.loads(text).disc, 0.01).data)
    courses = [make_path(each) for each in document.modelspace()]
    points = np.array([(p.x, p.y) for each in courses for p in each.flattening(1e-4)])
    box = np.concatenate((points.min(axis=0), points.max(axis=0)))
    # ezdxf flattens arcs by way of cubics, 0.008 mm off here.
    check_view(document, box, 0.01)


# A measurement that accepts a wrong file is worth nothing: break the file and see it found.


@pytest.mark.parametrize(
    ("old", "new"), [(b"\n 10\n32.0\n", b"\n 10\n32.5\n"), (b"\n 42\n0.", b"\n 42\n-0.")]
)
def test_a_moved_vertex_and_a_reversed_bulge_are_measured(old: bytes, new: bytes) -> None:
    head, mark, entities = WRITER.write(StubProduct(), 0.01).data.partition(b"ENTITIES")
    assert old in entities
    changed = head + mark + entities.replace(old, new, 1)
    assert WRITER.measure(StubProduct(), changed) > 0.1


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


# Splines ------------------------------------------------------------------------------------------


FINE = 1e-3


FLANK = whole(flank("plate_translating", -1))

FLANKED = StubProduct(
    given=Part((Layer(-8.0, 0.0, (CurveBoundary("outline", False, FLANK),
                                  CircleBoundary("bore", True, 10.0))),)),
    dxf=DxfSpec("spline", auxiliary=False),
)  # fmt: skip
"""A real flank with dwells and a round bore, drawn by splines."""

SPLINES = {
    "mm": FLANKED,
    "inch": replace(FLANKED, unit="inch"),
    "fast": replace(FLANKED, effort="fast"),
}

splines = pytest.mark.parametrize("product", SPLINES.values(), ids=SPLINES)


@pytest.mark.parametrize("tolerance", [0.05, 1e-3, 1e-6])
@splines
def test_splines_are_read_back(product: StubProduct, tolerance: float) -> None:
    data = read_back(WRITER, product, tolerance, least=0.2).data
    assert WRITER.write(product, tolerance).data == data


@splines
def test_ezdxf_reads_the_same_curves(product: StubProduct) -> None:
    data = WRITER.write(product, FINE).data
    entities = opened(data).modelspace().query("SPLINE")
    ours = next(
        curve for curve in read_drawing(data).contours("CUT") if isinstance(curve, SplineContour)
    )
    assert len(entities) == len(ours.splines) == 5
    for entity, spline in zip(entities, ours.splines, strict=True):
        assert (entity.dxf.degree, entity.dxf.flags) == (3, 8)
        assert not entity.weights
        assert not entity.fit_points
        scale = 25.4 if product.unit == "inch" else 1.0
        points = np.array(entity.control_points) @ np.array([1.0, 1j, 0.0]) * scale
        np.testing.assert_allclose(points, spline.controls, rtol=0.0, atol=1e-12)
        np.testing.assert_array_equal(np.array(entity.knots), spline.knots)


def test_facts_state_what_is_drawn() -> None:
    written = WRITER.write(FLANKED, FINE)
    outline = FLANKED.part.boundaries[0].spline(WRITTEN_SHARE * FINE).contour
    assert written.facts == {
        "boundaries": 2,
        "splines": 5,
        "cubics": sum(len(spline) for spline in outline.splines),
        "arcs": 4,
        "lines": 0,
    }
    kinds = [(item.layer, item.kind) for item in read_drawing(written.data).items]
    # Two dwells and the two halves of the bore.
    assert sorted(kinds) == sorted([("CUT", "SPLINE")] * 5 + [("CUT", "ARC")] * 4)


def test_the_foreign_reader_takes_our_drawings() -> None:
    data = WRITER.write(FLANKED, FINE).data
    outline, bore = read_drawing(data).contours(None)
    assert isinstance(outline, SplineContour)
    assert isinstance(bore, Contour)
    assert spline_deviation(FLANK, outline) <= FINE
    assert math.sqrt(bore.area / math.pi) == pytest.approx(10.0, abs=FINE)
    found = READER.read(data, "a.dxf", layer=None, unit=None, gap=1e-9)
    same, _ = found.contours
    assert isinstance(same, SplineContour)
    assert found.notes == ()
    for ours, theirs in zip(outline.splines, same.splines, strict=True):
        assert np.array_equal(ours.knots, theirs.knots)
        assert np.array_equal(ours.controls, theirs.controls)


def around(data: bytes, kind: bytes) -> tuple[bytes, bytes, bytes]:
    """What is before the first such entity, the entity, and what is after it."""
    start = data.index(b"\n  0\n" + kind + b"\n", data.index(b"ENTITIES")) + 1
    end = data.index(b"\n  0\n", start) + 1
    return data[:start], data[start:end], data[end:]


def _changed(data: bytes, kind: bytes, code: bytes, which: int, by: float) -> bytes:
    """The file with the value of a group code of the first such entity changed."""
    before, entity, after = around(data, kind)
    lines = entity.split(b"\n")
    places = [k for k in range(0, len(lines) - 1, 2) if lines[k].strip() == code]
    lines[places[which] + 1] = repr(float(lines[places[which] + 1]) + by).encode()
    return before + b"\n".join(lines) + after


@pytest.mark.parametrize(("code", "which"), [(b"10", 3), (b"20", 4), (b"40", 5)])
def test_a_moved_control_point_or_knot_is_measured(code: bytes, which: int) -> None:
    data = WRITER.write(FLANKED, 1e-4).data
    moved = _changed(data, b"SPLINE", code, which, 0.01 if code != b"40" else 0.2)
    assert WRITER.measure(FLANKED, moved) > 1.5e-4


@pytest.mark.parametrize(
    ("kind", "code", "which"), [(b"SPLINE", b"10", 0), (b"ARC", b"40", 0), (b"ARC", b"51", 0)]
)
def test_ends_that_do_not_meet_are_refused(kind: bytes, code: bytes, which: int) -> None:
    data = WRITER.write(FLANKED, FINE).data
    with pytest.raises(FileError, match="has a loose end at"):
        WRITER.measure(FLANKED, _changed(data, kind, code, which, 1e-6))


@pytest.mark.parametrize("kind", [b"SPLINE", b"ARC"])
def test_a_missing_strand_is_refused(kind: bytes) -> None:
    before, _, after = around(WRITER.write(FLANKED, FINE).data, kind)
    with pytest.raises(FileError, match="has a loose end at"):
        WRITER.measure(FLANKED, before + after)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"\n 71\n3\n", b"\n 71\n2\n", "control points and .* knots"),
        (b"\n 71\n3\n", b"\n 71\n5\n", "its 13 knots do not ascend, or do not match"),
        (b"\n 72\n", b"\n 75\n", ""),
        (b"\nSPLINE\n", b"\nELLIPSE\n", "ELLIPSE on layer CUT is not part of the drawing"),
    ],
)
def test_a_broken_spline_is_refused(old: bytes, new: bytes, message: str) -> None:
    before, entity, after = around(WRITER.write(FLANKED, FINE).data, b"SPLINE")
    assert old in entity
    broken = before + entity.replace(old, new) + after
    if not message:  # a count that is not stated is no fault
        assert WRITER.measure(FLANKED, broken) <= FINE
        return
    with pytest.raises(FileError, match=message):
        WRITER.measure(FLANKED, broken)


# SVG at true size: what is written is the part, also by the arithmetic of the standard ------------


SVG = "{http://www.w3.org/2000/svg}"

SVG_PRODUCTS = {
    "disc": StubProduct(),
    "inch": StubProduct(unit="inch"),
    "groove": StubProduct(groove=True),
    "large": StubProduct(scale=1e4),
    "polyline": StubProduct(dxf=DxfSpec("polyline")),
}

products = pytest.mark.parametrize("product", SVG_PRODUCTS.values(), ids=SVG_PRODUCTS)


@products
def test_by_the_standard_the_paths_are_the_boundaries_at_true_size(product: StubProduct) -> None:
    root = ET.fromstring(SVG_WRITER.write(product, TOLERANCE).data)
    box = [float(each) for each in root.get("viewBox", "").split()]
    assert (root.get("width"), root.get("height")) == (f"{box[2]:.0f}mm", f"{box[3]:.0f}mm")
    groups = {each.get("id"): each for each in root.findall(f"{SVG}g")}
    assert list(groups) == (["CUT", "BLIND_3"] if product.groove else ["CUT"])
    for boundary in product.part.boundaries:
        assert isinstance(boundary, CircleBoundary)
        near = []
        for path in root.iter(f"{SVG}path"):
            ((ends, along),) = svg_runs(path.get("d", ""), complex.conjugate)  # y upward
            assert ends[-1] == ends[0]
            points = np.array([*ends, *along])
            assert np.all(abs(points.real) < -box[0])
            assert np.all(abs(points.imag) < -box[1])
            near.append(np.max(abs(abs(points - boundary.centre) - boundary.radius)))
        assert min(near) <= TOLERANCE


def test_lines_are_hairlines_without_fill() -> None:
    root = ET.fromstring(SVG_WRITER.write(StubProduct(groove=True), TOLERANCE).data)
    keys = ("fill", "stroke-width", "stroke")
    drawn = [tuple(map(each.get, keys)) for each in root.findall(f"{SVG}g")]
    assert drawn == [("none", "0.01", "#ff0000"), ("none", "0.01", "#0000ff")]


def test_the_edges_of_a_real_groove_pass_verification() -> None:
    product = camgeo.load(SCENES / "groove.toml").with_output({"fit": "fast"}).disc
    data = SVG_WRITER.write(product, TOLERANCE).data
    assert faults(SVG_VERIFIER, product, data) == []
    moved = data.replace(b'id="BLIND_10"', b'id="CUT"')
    assert [each.name for each in faults(SVG_VERIFIER, product, moved)] == ["written again"]
    larger = data.replace(b'width="222mm"', b'width="223mm"').replace(b'"222mm"', b'"223mm"')
    assert {each.name for each in faults(SVG_VERIFIER, product, larger)} > {"written again", "area"}
    foreign = re.sub(rb"<desc>.*</desc>", b"", larger.replace(b"223mm", b"222mm"))
    read = checked(SVG_VERIFIER, product, foreign, ReadingOptions("groove.cut.svg"))
    assert all(each.ok is not False for each in read.values())


@pytest.mark.parametrize(
    ("pattern", "new", "check"),
    [
        (r"(?s)<g .*</g>", "", "file"),
        (r"A(\d+)", r"A1\1", "file"),
        (r" 0 0 0 ", " 0 0 1 ", "deviation"),
        (r"<path [^>]*>", "", "contours"),
        (r"M(-?\d+)", r"M1\1", "deviation"),
    ],
)
def test_what_is_damaged_is_measured(pattern: str, new: str, check: str) -> None:
    text = SVG_WRITER.write(SVG_PRODUCTS["disc"], TOLERANCE).data.decode()
    changed, count = re.subn(pattern, new, text, count=1)
    assert count
    checks = checked(
        SVG_VERIFIER, SVG_PRODUCTS["disc"], changed.encode(), ReadingOptions("a.cut.svg")
    )
    assert check in {name for (name, _), each in checks.items() if each.ok is False}


def test_files_are_known_by_the_whole_ending(tmp_path: Path) -> None:
    """The return disc of a pair too; a picture next to them is judged by its bytes alone."""
    design = camgeo.load(SCENES / "conjugate_lever.toml")
    written = design.write(tmp_path, ["cut-svg", "svg"], tolerance=TOLERANCE)
    against = Reference(design.discs, TOLERANCE)
    verdicts = verify_files(written.paths[:-1], lambda *_: against, Wanted())
    assert [each.file for each in verdicts] == [
        "conjugate_lever.cut.svg",
        "conjugate_lever.svg",
        "conjugate_lever-return.cut.svg",
        "conjugate_lever-return.svg",
    ]
    assert all(each.passed for each in verdicts)
    assert [each.format for each in verdicts] == ["cut-svg", "svg", "cut-svg", "svg"]
    assert [each.measured for each in verdicts] == [True, False, True, False]
    assert verdicts[2].scene[0] == "conjugate_lever-return"


def drawn(body: str, head: str = 'width="100mm" height="100mm" viewBox="0 0 100 100"') -> bytes:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'.encode()


@pytest.mark.parametrize("body", [
    '<path d="M0 0H10V20h-10z"/>', '<path d="m0,0 10,0 0,20 -10,0 0-20"/>',
    '<polygon points="0,0 10,0 10,20 0,20"/>', '<g><path d="M0 0L10 0L10 20L0 20L0 0"/></g>',
    '<path d="M 0 0 L 1e1 0 10 20 .0 20 Z"/>',
])  # fmt: skip
def test_rectangles(body: str) -> None:
    (contour,) = svg_drawing_of(drawn(body)).contours
    assert contour.area == 200.0
    assert set(contour.vertices.tolist()) == {0j, 10 + 0j, 10 - 20j, -20j}


@pytest.mark.parametrize(("side", "mm"), [
    ("100mm", 1.0), ("10cm", 1.0), ("1in", 0.254), ("72pt", 0.254), ("96px", 0.254), ("96", 0.254),
])  # fmt: skip
def test_units_of_the_size(side: str, mm: float) -> None:
    head = f'width="{side}" height="{side}" viewBox="0 0 100 100"'
    found = svg_drawing_of(drawn('<circle cx="5" cy="7" r="3"/>', head))
    assert found.scale == pytest.approx(mm, rel=1e-15)
    (circle,) = found.contours
    assert (circle.area, circle.centres[0]) == pytest.approx(
        (math.pi * (3.0 * mm) ** 2, (5.0 - 7.0j) * mm), rel=1e-14
    )


@pytest.mark.parametrize(("large", "positive", "area"), [
    (0, 1, 0.25 * math.pi - 0.5), (0, 0, 0.25 * math.pi - 0.5),
    (1, 0, 0.75 * math.pi + 0.5), (1, 1, 0.75 * math.pi + 0.5),
])  # fmt: skip
def test_flags_of_an_arc(large: int, positive: int, area: float) -> None:
    """A quarter of a circle or the rest of it, on its chord."""
    data = drawn(f'<path d="M1 0A1 1 30 {large} {positive} 0 1Z"/>')
    assert svg_drawing_of(data).contours[0].area == pytest.approx(area, rel=1e-14)


@pytest.mark.parametrize(("body", "message"), [
    ('<path d="M0 0C1 1 2 2 3 0Z"/>', "C is not allowed"),
    ('<path d="M0 0L9 9"/>', "not closed"),
    ('<path d="M0 0L9 9Z" transform="scale(2)"/>', "transformation"),
    ('<g style="transform:rotate(3deg)"><circle r="1"/></g>', "transformation"),
    ('<path d="M0 0A1 2 0 0 0 1 1Z"/>', "elliptical"),
    ('<path d="M0 0A1 1 0 0 2 1 1Z"/>', "flags"),
    ('<path d="M0 0L5"/>', "needs 2 numbers"),
    ('<path d="L5 5Z"/>', "not allowed"),
    ('<path d="M0 0L1e999 0 5 5Z"/>', "not a number"),
    ('<path d="M0 0 # 5 5Z"/>', "cannot be read at ' # 5"),
    ('<ellipse rx="1" ry="2"/>', "element ellipse cannot be read"),
    ('<image href="file:///etc/passwd"/>', "image cannot be read"),
    ('<use href="#a"/>', "use cannot be read"),
    ("<text>CUT</text>", "text cannot be read"),
    ('<circle r="0"/>', "radius above 0"),
    ("", "no contour found"),
    ('viewBox="0 0 10 10"', "states no width"),
    ('width="10mm" height="20mm" viewBox="0 0 10 10"', "scale x and y differently"),
    ('width="10mm" height="10mm" viewBox="0 0 10 0"', "viewBox"),
    ('width="100%" height="100%" viewBox="0 0 10 10"', "states no width"),
])  # fmt: skip
def test_what_has_no_exact_form_or_no_size_is_refused(body: str, message: str) -> None:
    data = drawn(body) if body[:1] in ("<", "") else drawn('<circle r="1"/>', body)
    with pytest.raises(FileError, match=re.escape(message)):
        svg_drawing_of(data)


@pytest.mark.parametrize(("data", "message"), [
    (b'<!DOCTYPE svg [<!ENTITY a "aaa">]><svg/>', "document type"),
    (b"<html/>", "its root is html"),
    (b"<svg", "not XML"),
    (b'<?xml version="1.0" encoding="UTF-16"?><svg/>', "UTF-8"),
    (b"\xff\xfe<\0s\0v\0g\0", "UTF-8"),
])  # fmt: skip
def test_what_may_not_be_parsed_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(FileError, match=message):
        svg_drawing_of(data)
    assert message in SVG_VERIFIER.origin(data).damage or message.startswith(("its", "not"))


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_the_drawing_is_in_mm_whatever_the_unit(unit: LengthUnit) -> None:
    data = SVG_WRITER.write(StubProduct(unit=unit), TOLERANCE).data
    assert svg_drawing_of(data).scale == 1.0
    assert data == SVG_WRITER.write(StubProduct(), TOLERANCE).data
