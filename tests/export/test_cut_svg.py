"""SVG at true size: what is written is the part, also by the arithmetic of the standard."""

from __future__ import annotations

import math
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import camgeo
from camgeo.app.answers.verify import Against, Wanted, verify_files
from camgeo.design.verify import Reading
from camgeo.errors import FileError
from camgeo.scene.formats.dxf import DxfSpec
from camgeo.units import LengthUnit
from camgeo_export.svg import WRITER, drawing_of
from camgeo_export.verify.svg import VERIFIER
from tests.effects.scenes import SCENES
from tests.export.stub_product import CircleBoundary, StubProduct
from tests.export.test_drawing import svg_runs
from tests.export.verified import TOLERANCE, checked, faults

SVG = "{http://www.w3.org/2000/svg}"

PRODUCTS = {
    "disc": StubProduct(),
    "inch": StubProduct(unit="inch"),
    "groove": StubProduct(groove=True),
    "large": StubProduct(scale=1e4),
    "polyline": StubProduct(dxf=DxfSpec("polyline")),
}

products = pytest.mark.parametrize("product", PRODUCTS.values(), ids=PRODUCTS)


@products
def test_by_the_standard_the_paths_are_the_boundaries_at_true_size(product: StubProduct) -> None:
    root = ET.fromstring(WRITER.write(product, TOLERANCE).data)
    box = [float(each) for each in root.get("viewBox", "").split()]
    assert root.get("width") == f"{box[2]:.0f}mm"
    assert root.get("height") == f"{box[3]:.0f}mm"
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
    root = ET.fromstring(WRITER.write(StubProduct(groove=True), TOLERANCE).data)
    through, blind = root.findall(f"{SVG}g")
    for each in (through, blind):
        assert each.get("fill") == "none"
        assert each.get("stroke-width") == "0.01"
    assert (through.get("stroke"), blind.get("stroke")) == ("#ff0000", "#0000ff")


def test_the_edges_of_a_real_groove_pass_verification() -> None:
    product = camgeo.load(SCENES / "groove.toml").with_output({"fit": "fast"}).disc
    data = WRITER.write(product, TOLERANCE).data
    assert faults(VERIFIER, product, data) == []
    moved = data.replace(b'id="BLIND_10"', b'id="CUT"')
    assert [each.name for each in faults(VERIFIER, product, moved)] == ["written again"]
    larger = data.replace(b'width="222mm"', b'width="223mm"').replace(b'"222mm"', b'"223mm"')
    assert {each.name for each in faults(VERIFIER, product, larger)} > {"written again", "area"}
    foreign = re.sub(rb"<desc>.*</desc>", b"", larger.replace(b"223mm", b"222mm"))
    read = checked(VERIFIER, product, foreign, Reading("groove.cut.svg"))
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
    text = WRITER.write(PRODUCTS["disc"], TOLERANCE).data.decode()
    changed, count = re.subn(pattern, new, text, count=1)
    assert count
    checks = checked(VERIFIER, PRODUCTS["disc"], changed.encode(), Reading("a.cut.svg"))
    assert check in {name for (name, _), each in checks.items() if each.ok is False}


def test_files_are_known_by_the_whole_ending(tmp_path: Path) -> None:
    """The return disc of a pair too; a picture next to them is judged by its bytes alone."""
    design = camgeo.load(SCENES / "conjugate_lever.toml")
    written = design.write(tmp_path, ["cut-svg", "svg"], tolerance=TOLERANCE)
    against = Against(design.discs, TOLERANCE)
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
    (contour,) = drawing_of(drawn(body)).contours
    assert contour.area == 200.0
    assert set(contour.vertices.tolist()) == {0j, 10 + 0j, 10 - 20j, -20j}


@pytest.mark.parametrize(("side", "mm"), [
    ("100mm", 1.0), ("10cm", 1.0), ("1in", 0.254), ("72pt", 0.254), ("96px", 0.254), ("96", 0.254),
])  # fmt: skip
def test_units_of_the_size(side: str, mm: float) -> None:
    head = f'width="{side}" height="{side}" viewBox="0 0 100 100"'
    found = drawing_of(drawn('<circle cx="5" cy="7" r="3"/>', head))
    assert found.scale == pytest.approx(mm, rel=1e-15)
    (circle,) = found.contours
    assert circle.area == pytest.approx(math.pi * (3.0 * mm) ** 2, rel=1e-14)
    assert circle.centres[0] == pytest.approx((5.0 - 7.0j) * mm, rel=1e-14)


@pytest.mark.parametrize(("large", "positive", "area"), [
    (0, 1, 0.25 * math.pi - 0.5), (0, 0, 0.25 * math.pi - 0.5),
    (1, 0, 0.75 * math.pi + 0.5), (1, 1, 0.75 * math.pi + 0.5),
])  # fmt: skip
def test_flags_of_an_arc(large: int, positive: int, area: float) -> None:
    """A quarter of a circle or the rest of it, on its chord."""
    data = drawn(f'<path d="M1 0A1 1 30 {large} {positive} 0 1Z"/>')
    assert drawing_of(data).contours[0].area == pytest.approx(area, rel=1e-14)


@pytest.mark.parametrize(("body", "message"), [
    ('<path d="M0 0C1 1 2 2 3 0Z"/>', "C in a path is not read"),
    ('<path d="M0 0L9 9"/>', "not closed"),
    ('<path d="M0 0L9 9Z" transform="scale(2)"/>', "transformation"),
    ('<g style="transform:rotate(3deg)"><circle r="1"/></g>', "transformation"),
    ('<path d="M0 0A1 2 0 0 0 1 1Z"/>', "ellipse"),
    ('<path d="M0 0A1 1 0 0 2 1 1Z"/>', "flags"),
    ('<path d="M0 0L5"/>', "needs 2 numbers"),
    ('<path d="L5 5Z"/>', "not read"),
    ('<path d="M0 0L1e999 0 5 5Z"/>', "not a number"),
    ('<path d="M0 0 # 5 5Z"/>', "cannot be read at ' # 5"),
    ('<ellipse rx="1" ry="2"/>', "ellipse is not read"),
    ('<image href="file:///etc/passwd"/>', "image is not read"),
    ('<use href="#a"/>', "use is not read"),
    ("<text>CUT</text>", "text is not read"),
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
        drawing_of(data)


@pytest.mark.parametrize(("data", "message"), [
    (b'<!DOCTYPE svg [<!ENTITY a "aaa">]><svg/>', "document type"),
    (b"<html/>", "its root is html"),
    (b"<svg", "not XML"),
    (b'<?xml version="1.0" encoding="UTF-16"?><svg/>', "UTF-8"),
    (b"\xff\xfe<\0s\0v\0g\0", "UTF-8"),
])  # fmt: skip
def test_what_may_not_be_parsed_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(FileError, match=message):
        drawing_of(data)
    assert message in VERIFIER.origin(data).damage or message.startswith(("its", "not"))


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_the_drawing_is_in_mm_whatever_the_unit(unit: LengthUnit) -> None:
    data = WRITER.write(StubProduct(unit=unit), TOLERANCE).data
    assert drawing_of(data).scale == 1.0
    assert data == WRITER.write(StubProduct(), TOLERANCE).data
