"""DXF with splines: what is written is what is read back, by our readers and by ezdxf."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import ezdxf
import numpy as np
import pytest
from ezdxf.layouts.layout import Modelspace

from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.cubic_proof import spline_deviation
from camgeo.geometry.contour.spline import CubicSpline, SplineContour
from camgeo.geometry.outline.path import whole
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import WRITTEN_SHARE, Layer, Part
from camgeo.scene.formats.dxf import DxfSpec
from camgeo_export.dxf.items import Curve
from camgeo_export.dxf.reader import READER, drawing_of
from camgeo_export.dxf.writer import WRITER
from tests.contour.cams import flank
from tests.export.stub_product import CircleBoundary, StubProduct
from tests.export.test_foreign_contours import drawn, stadium

Drawing = Callable[[Modelspace], object]

TOLERANCE = 1e-3


@dataclass(frozen=True)
class FlankProduct(StubProduct):
    """A real flank with dwells and a round bore, drawn by splines."""

    dxf: DxfSpec = field(default_factory=lambda: DxfSpec("spline", auxiliary=False))

    @property
    def part(self) -> Part:
        path = whole(flank("plate_translating", -1))
        outline = CurveBoundary("outline", hole=False, path=path)
        return Part((Layer(-8.0, 0.0, (outline, CircleBoundary("bore", True, 10.0))),))


PRODUCTS = {
    "mm": FlankProduct(),
    "inch": FlankProduct(unit="inch"),
    "fast": FlankProduct(effort="fast"),
}


@pytest.fixture(params=list(PRODUCTS.values()), ids=list(PRODUCTS))
def product(request: pytest.FixtureRequest) -> FlankProduct:
    found: FlankProduct = request.param
    return found


def read_curves(data: bytes, gap: float = 1e-9) -> tuple[Curve, ...]:
    return drawing_of(data, "a.dxf").contours(None, gap)


@pytest.mark.parametrize("tolerance", [0.05, 1e-3, 1e-6])
def test_read_back_is_within_the_tolerance(product: FlankProduct, tolerance: float) -> None:
    data = WRITER.write(product, tolerance).data
    assert 0.2 * tolerance < WRITER.measure(product, data) <= tolerance


def test_the_same_bytes_each_time(product: FlankProduct) -> None:
    assert WRITER.write(product, TOLERANCE).data == WRITER.write(product, TOLERANCE).data


def test_ezdxf_reads_the_same_curves(product: FlankProduct) -> None:
    data = WRITER.write(product, TOLERANCE).data
    document = ezdxf.read(io.StringIO(data.decode()))  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    entities = document.modelspace().query("SPLINE")
    ours = next(
        curve for curve in drawing_of(data).contours("CUT") if isinstance(curve, SplineContour)
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
    product = FlankProduct()
    written = WRITER.write(product, TOLERANCE)
    outline = product.part.boundaries[0].spline(WRITTEN_SHARE * TOLERANCE).contour
    assert written.facts == {
        "boundaries": 2,
        "splines": 5,
        "cubics": sum(len(spline) for spline in outline.splines),
        "arcs": 4,
        "lines": 0,
    }
    kinds = [(item.layer, item.kind) for item in drawing_of(written.data).items]
    # Two dwells and the two halves of the bore.
    assert sorted(kinds) == sorted([("CUT", "SPLINE")] * 5 + [("CUT", "ARC")] * 4)


def test_a_drawing_is_shorter_than_by_arcs() -> None:
    splines = FlankProduct()
    arcs = replace(splines, dxf=DxfSpec("arcs", auxiliary=False))
    sizes = [len(WRITER.write(each, 1e-5).data) for each in (splines, arcs)]
    assert sizes[0] < sizes[1]


def test_the_foreign_reader_takes_our_drawings(product: FlankProduct) -> None:
    data = WRITER.write(product, TOLERANCE).data
    outline, bore = read_curves(data)
    assert isinstance(outline, SplineContour)
    assert isinstance(bore, Contour)
    assert spline_deviation(whole(flank("plate_translating", -1)), outline) <= TOLERANCE
    assert math.sqrt(bore.area / math.pi) == pytest.approx(10.0, abs=TOLERANCE)
    found = READER.read(data, "a.dxf", layer=None, unit=None, gap=1e-9)
    same, _ = found.contours
    assert isinstance(same, SplineContour)
    assert found.notes == ()
    for ours, theirs in zip(outline.splines, same.splines, strict=True):
        assert np.array_equal(ours.knots, theirs.knots)
        assert np.array_equal(ours.controls, theirs.controls)


# A measurement that accepts a wrong file is worth nothing: break the file and see it found.


def _entity(data: bytes, kind: bytes, number: int = 0) -> tuple[int, int]:
    """First and last byte of the entity of that number."""
    head = b"\n  0\n" + kind + b"\n"
    place = data.index(b"ENTITIES")
    for _ in range(number + 1):
        place = data.index(head, place) + 1
    return place, data.index(b"\n  0\n", place)


def _changed(data: bytes, kind: bytes, code: bytes, which: int, by: float) -> bytes:
    """The file with the value of a group code of the first such entity changed."""
    first, last = _entity(data, kind)
    lines = data[first:last].split(b"\n")
    places = [k for k in range(0, len(lines) - 1, 2) if lines[k].strip() == code]
    value = float(lines[places[which] + 1])
    lines[places[which] + 1] = repr(value + by).encode()
    return data[:first] + b"\n".join(lines) + data[last:]


@pytest.mark.parametrize(("code", "which"), [(b"10", 3), (b"20", 4), (b"40", 5)])
def test_a_moved_control_point_or_knot_is_measured(code: bytes, which: int) -> None:
    product = FlankProduct()
    data = WRITER.write(product, 1e-4).data
    moved = _changed(data, b"SPLINE", code, which, 0.01 if code != b"40" else 0.2)
    assert WRITER.measure(product, moved) > 1.5e-4


@pytest.mark.parametrize(
    ("kind", "code", "which"), [(b"SPLINE", b"10", 0), (b"ARC", b"40", 0), (b"ARC", b"51", 0)]
)
def test_ends_that_do_not_meet_are_refused(kind: bytes, code: bytes, which: int) -> None:
    product = FlankProduct()
    data = WRITER.write(product, TOLERANCE).data
    with pytest.raises(FileError, match="has a loose end at"):
        WRITER.measure(product, _changed(data, kind, code, which, 1e-6))


@pytest.mark.parametrize("kind", [b"SPLINE", b"ARC"])
def test_a_missing_strand_is_refused(kind: bytes) -> None:
    product = FlankProduct()
    data = WRITER.write(product, TOLERANCE).data
    first, last = _entity(data, kind)
    with pytest.raises(FileError, match="has a loose end at"):
        WRITER.measure(product, data[: first - 1] + data[last:])


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
    product = FlankProduct()
    data = WRITER.write(product, TOLERANCE).data
    first, last = _entity(data, b"SPLINE")
    first -= 5
    broken = data[:first] + data[first:last].replace(old, new) + data[last:]
    assert broken != data
    if not message:  # a count that is not stated is no fault
        assert WRITER.measure(product, broken) <= TOLERANCE
        return
    with pytest.raises(FileError, match=message):
        WRITER.measure(product, broken)


# Splines of other programs.


def half_round(space: Modelspace, degree: int = 3) -> None:
    """A line, and a spline over it from (10, 0) to (-10, 0)."""
    space.add_line((-10.0, 0.0), (10.0, 0.0))
    space.add_open_spline(BOW, degree=degree)


BOW = [(10.0, 0.0), (10.0, 10.0), (-10.0, 10.0), (-10.0, 0.0)]

BOW_AREA = 120.0
"""y = 30 t (1 - t) and dx = -120 t (1 - t) dt: 3600 times the integral of t^2 (1 - t)^2, 1/30."""


def test_clamped_and_of_lower_degree() -> None:
    (cubic,) = read_curves(drawn(half_round))
    assert cubic.area == pytest.approx(BOW_AREA, rel=1e-14)
    assert isinstance(cubic, SplineContour)
    assert [type(strand) for strand in cubic.splines] == [CubicSpline]
    (square,) = read_curves(drawn(lambda space: half_round(space, degree=2)))
    (corners,) = read_curves(drawn(lambda space: half_round(space, degree=1)))
    assert corners.area == pytest.approx(200.0, rel=1e-14)
    assert BOW_AREA < square.area < 200.0


def test_closed_splines_that_are_not_clamped() -> None:
    ring = [(40.0 * math.cos(k), 40.0 * math.sin(k)) for k in np.arange(15) * math.pi / 6.0]
    knots = np.arange(19.0)
    (contour,) = read_curves(
        drawn(lambda space: space.add_open_spline(ring, degree=3, knots=knots.tolist()))
    )
    assert isinstance(contour, SplineContour)
    assert len(contour) == 12
    # Uniform cubics through 12 points of a circle of 40 mm: of the radius (2 + cos 30 deg)/3 * 40
    # at knots, and rounder than 1e-3 of it.
    radius = 40.0 * (2.0 + math.cos(math.pi / 6.0)) / 3.0
    assert contour.area == pytest.approx(math.pi * radius**2, rel=2e-3)
    assert contour.length == pytest.approx(2.0 * math.pi * radius, rel=1e-3)


def test_gaps_are_closed_at_the_arcs_and_lines() -> None:
    def draw(space: Modelspace) -> None:
        space.add_line((-10.0, 0.01), (10.0, 0.0))
        space.add_open_spline(BOW, degree=3)

    (contour,) = read_curves(drawn(draw), gap=0.02)
    assert contour.area == pytest.approx(BOW_AREA, rel=1e-14)
    with pytest.raises(FileError, match="has a loose end at"):
        read_curves(drawn(draw))


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (
            lambda space: space.add_open_spline(BOW * 3, degree=11),
            "SPLINE is of degree 11, not of 1 to 10",
        ),
        (
            lambda space: space.add_rational_spline(BOW, [1, 0, 2, 1], degree=3),
            "SPLINE is of degree 3, .* or has weights that are not above 0",
        ),
        (
            lambda space: space.add_open_spline([(0, 0, 0), (1, 1, 0), (2, 1, 3), (3, 0, 0)]),
            "SPLINE does not lie in the plane",
        ),
        (
            lambda space: space.add_circle((0, 0), 5.0, dxfattribs={"extrusion": (0, 0.6, 0.8)}),
            "CIRCLE does not lie in the plane",
        ),
    ],
)
def test_what_is_refused(draw: Drawing, message: str) -> None:
    with pytest.raises(FileError, match=rf"a.dxf, line \d+: {message}"):
        read_curves(drawn(draw))


def test_equal_weights_are_no_weights() -> None:
    def draw(space: Modelspace) -> None:
        space.add_line((-10.0, 0.0), (10.0, 0.0))
        space.add_rational_spline(BOW, [2.0, 2.0, 2.0, 2.0], degree=3)

    (contour,) = read_curves(drawn(draw))
    assert contour.area == pytest.approx(BOW_AREA, rel=1e-14)


def test_lines_and_arcs_read_as_before() -> None:
    (contour,) = read_curves(drawn(stadium))
    assert isinstance(contour, Contour)
    (same,) = READER.read(drawn(stadium), "a.dxf", layer=None, unit=None, gap=1e-9).contours
    assert isinstance(same, Contour)
    assert np.array_equal(contour.vertices, same.vertices)
