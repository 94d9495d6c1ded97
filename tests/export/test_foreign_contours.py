"""Readers of foreign contours: what ezdxf draws and what a table of vertices holds."""

from __future__ import annotations

import io
import math
from collections.abc import Callable

import ezdxf
import numpy as np
import pytest
from ezdxf.layouts.layout import Modelspace

from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.studies.inspection import read_points
from camgeo.units import LengthUnit
from camgeo_export.contour_csv import READER as CSV
from camgeo_export.dxf.reader import READER as DXF
from camgeo_export.dxf.writer import WRITER
from camgeo_export.svg_reader import READER as SVG
from tests.export.stub_product import StubProduct

Drawing = Callable[[Modelspace], object]

GAP = 1e-3


def drawn(draw: Drawing, version: str = "R2010", units: int = 4) -> bytes:
    """A drawing as another program writes it."""
    document = ezdxf.new(version, units=units)  # type: ignore[attr-defined]  # ezdxf does not export it explicitly
    draw(document.modelspace())
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def read_dxf(
    data: bytes, layer: str | None = None, unit: LengthUnit | None = None, gap: float = GAP
) -> tuple[Contour, ...]:
    found = DXF.read(data, "a.dxf", layer=layer, unit=unit, gap=gap).contours
    plain = tuple(each for each in found if isinstance(each, Contour))
    assert len(plain) == len(found)
    return plain


def read_csv(text: str, unit: LengthUnit | None = None, layer: str | None = None) -> Contour:
    (contour,) = CSV.read(text.encode(), "a.csv", layer=layer, unit=unit, gap=GAP).contours
    assert isinstance(contour, Contour)
    return contour


def stadium(space: Modelspace) -> None:
    """Two lines and two half circles, in no order, each its own way."""
    space.add_line((10.0, -5.0), (-10.0, -5.0))
    space.add_arc((10.0, 0.0), 5.0, -90.0, 90.0)
    space.add_arc((-10.0, 0.0), 5.0, 90.0, 270.0)
    space.add_line((10.0, 5.0), (-10.0, 5.0))


STADIUM = 20.0 * 10.0 + math.pi * 25.0


@pytest.mark.parametrize("version", ["R12", "R2000", "R2010", "R2018"])
def test_lines_and_arcs_are_chained(version: str) -> None:
    (contour,) = read_dxf(drawn(stadium, version), unit="mm" if version == "R12" else None)
    assert contour.area == pytest.approx(STADIUM, rel=1e-12)
    assert contour.arc_count == 2
    assert contour.radii[contour.sweeps != 0.0] == pytest.approx([5.0, 5.0], rel=1e-12)


@pytest.mark.parametrize(("units", "scale"), [(1, 25.4), (4, 1.0), (5, 10.0), (6, 1000.0)])
def test_units(units: int, scale: float) -> None:
    (contour,) = read_dxf(drawn(stadium, units=units))
    assert contour.area == pytest.approx(STADIUM * scale**2, rel=1e-12)


def test_the_unit_must_be_known_and_agree() -> None:
    silent = drawn(stadium, units=0)
    with pytest.raises(FileError, match=r"a.dxf: does not state its unit .* give mm or inch"):
        read_dxf(silent)
    (contour,) = read_dxf(silent, unit="inch")
    assert contour.area == pytest.approx(STADIUM * 25.4**2, rel=1e-12)
    with pytest.raises(FileError, match="which is not inch"):
        read_dxf(drawn(stadium, units=4), unit="inch")
    with pytest.raises(FileError, match=r"INSUNITS is 13; supported: inch"):
        read_dxf(drawn(stadium, units=13))


BULGED = [(10.0, 0.0, 0.0), (10.0, 10.0, 1.0), (0.0, 10.0, 0.0), (0.0, 0.0, -0.5)]


def bulged_area() -> float:
    """A square of 10 with a half circle added above and a segment cut in below."""
    sweep = 4.0 * math.atan(0.5)
    radius = 5.0 / math.sin(0.5 * sweep)
    return 100.0 + 0.5 * math.pi * 25.0 - 0.5 * radius**2 * (sweep - math.sin(sweep))


@pytest.mark.parametrize("kind", ["lwpolyline", "polyline"])
@pytest.mark.parametrize("closed", [True, False])
def test_polylines_with_bulges(kind: str, closed: bool) -> None:
    points = BULGED if closed else [*BULGED, (10.0, 0.0, 0.0)]

    def draw(space: Modelspace) -> None:
        if kind == "lwpolyline":
            space.add_lwpolyline(points, format="xyb", close=closed)
        else:
            space.add_polyline2d(points, format="xyb", close=closed)

    (contour,) = read_dxf(drawn(draw))
    assert contour.area == pytest.approx(bulged_area(), rel=1e-12)
    assert len(contour) == 4


def test_mirrored_entities() -> None:
    def draw(space: Modelspace) -> None:
        down = {"extrusion": (0.0, 0.0, -1.0)}
        space.add_lwpolyline(BULGED, format="xyb", close=True, dxfattribs=down)

    (contour,) = read_dxf(drawn(draw))
    assert contour.area == pytest.approx(bulged_area(), rel=1e-12)
    assert float(np.max(contour.vertices.real)) == 0.0


def test_the_largest_first_and_layers() -> None:
    def draw(space: Modelspace) -> None:
        space.add_circle((0.0, 0.0), 3.0)
        space.add_circle((1.0, 0.0), 9.0, dxfattribs={"layer": "FRAME"})
        space.add_circle((0.0, 0.0), 5.0, dxfattribs={"layer": "FRAME"})

    everything = read_dxf(drawn(draw))
    assert [round(math.sqrt(each.area / math.pi), 9) for each in everything] == [9.0, 5.0, 3.0]
    assert len(read_dxf(drawn(draw), layer="FRAME")) == 2
    with pytest.raises(FileError, match=r"has no layer 'CUTS'; there are 0, FRAME"):
        read_dxf(drawn(draw), layer="CUTS")


def test_our_own_drawings() -> None:
    """Only layer CUT of them: outline and bore."""
    product = StubProduct()
    found = read_dxf(WRITER.write(product, 1e-3).data)
    assert [math.sqrt(each.area / math.pi) for each in found] == pytest.approx(
        [32.0, 10.0], abs=2e-3
    )


def test_gaps_up_to_the_limit_are_closed() -> None:
    def draw(space: Modelspace) -> None:
        space.add_line((0.0, 0.0), (10.0, 0.0))
        space.add_line((10.0, 0.01), (0.0, 10.0))
        space.add_line((0.0, 10.0), (0.0, 0.0))

    (contour,) = read_dxf(drawn(draw), gap=0.02)
    assert contour.area == pytest.approx(50.0, abs=0.1)
    with pytest.raises(FileError, match=r"a.dxf, line \d+: LINE has a loose end at \(10, 0\) mm"):
        read_dxf(drawn(draw))


def test_the_reported_line_is_that_of_the_entity() -> None:
    data = drawn(lambda space: space.add_line((0.0, 0.0), (1.0, 0.0)))
    with pytest.raises(FileError) as reported:
        read_dxf(data)
    line = int(str(reported.value).split("line ")[1].split(":")[0])
    assert data.decode().splitlines()[line - 1].strip() == "LINE"


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "no EOF at its end"),
        (b"hello\nworld\n", "line 1: 'hello' is not a group code"),
        (b"0\nLINE\n0\nEOF\n", "line 1: not a DXF file: it begins with no section"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00", "is a binary DXF"),
    ],
)
def test_what_is_no_dxf(data: bytes, message: str) -> None:
    with pytest.raises(FileError, match=message):
        read_dxf(data)


def test_numbers_that_are_none() -> None:
    broken = drawn(stadium).replace(b"\n-10.0\n", b"\nnan\n", 1)
    with pytest.raises(FileError, match=r"line \d+: 'nan' is not a finite number"):
        read_dxf(broken)


# CSV --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("head", ["x,y,bulge\n", "# by hand\n\nX, Y, Bulge\n", "\ufeffx,y,bulge\n"])
def test_csv_with_bulges(head: str) -> None:
    contour = read_csv(head + "".join(f"{x},{y},{b}\n" for x, y, b in BULGED))
    assert contour.area == pytest.approx(bulged_area(), rel=1e-12)
    assert len(contour) == 4


def test_csv_of_points_run_clockwise_and_closed_twice_over() -> None:
    contour = read_csv("0,0\n0,1\n1,1\n1,0\n0,0\n", unit="inch")
    assert contour.area == pytest.approx(25.4**2, rel=1e-14)
    assert len(contour) == 4


SEPARATORS = {";": ",", "\t": ",", " ": ",", "  ": ".", ", ": "."}
"""With the decimal mark that goes with each."""


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize("head", ["", "x y", "x [inch] y [inch]", "y x z", "z [mm] y (in) x (in)"])
def test_csv_and_measured_points_are_one_table(separator: str, head: str) -> None:
    """The same points by both readers, however they are written; z is of no interest."""
    corners = [
        (3.0 * math.cos(k) + 0.125, 2.0 * math.sin(k) - 0.25) for k in np.arange(16) * math.pi / 8.0
    ]
    names = [each[0] for each in head.replace(" [", "[").replace(" (", "(").split()] or ["x", "y"]
    names = ["x", "y"] if not head else names
    titles = [each.replace("[", " [").replace("(", " (") for each in
              head.replace(" [", "[").replace(" (", "(").split()]  # fmt: skip
    rows = [{"x": x, "y": y, "z": -1.5} for x, y in corners]
    lines = [separator.join(titles)] if head else []
    mark = SEPARATORS[separator]
    lines += [separator.join(repr(row[name]).replace(".", mark) for name in names) for row in rows]
    text = "\r\n".join(lines)
    scale = 25.4 if "in" in head else 1.0
    expected = np.array([complex(x, y) for x, y in corners]) * scale
    assert np.array_equal(read_points(text, "a.csv").points, expected)
    assert np.array_equal(read_csv(text).vertices, expected)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a.csv, line 1: no rows"),
        ("x,y\n", "a.csv, line 2: 0 rows of numbers"),
        (
            "1,2,3,4\n",
            r"a.csv, line 1: .* 4 columns; without a heading 2 are allowed, x and y; bulge",
        ),
        ("0,0,0\n1,0,0\n1,1,0\n", r"a.csv, line 1: .* 3 columns; without a heading 2 are allowed"),
        ("0,0\n1,0\n1\n", r"a.csv, line 3: '1': 1 column; allowed: 2 in this file"),
        ("0,0\n1,zero\n", r"a.csv, line 2: 'zero': not a number"),
        ("# c\n0,0\n1,inf\n", r"a.csv, line 3: 'inf': not a number"),
        ("0,0\n1,2e9\n", r"a.csv, line 2: '2000000000.0': too large"),
        ("0,0\n1,0\n", "2 points enclosing nothing"),
        ("0,0\n0,0\n1,0\n1,1\n", "a.csv, line 2: the same point as in the previous row"),
        ("0,0\n1,0\n2,0\n", "enclose no area"),
    ],
)
def test_csv_faults(text: str, message: str) -> None:
    with pytest.raises(FileError, match=message):
        read_csv(text)


def test_csv_has_no_layers_and_is_text() -> None:
    with pytest.raises(FileError, match="has no layers; leave out the layer 'CUT'"):
        read_csv("0,0\n1,0\n1,1\n", layer="CUT")
    with pytest.raises(FileError, match="not UTF-8 text"):
        CSV.read(b"\xff\xfe0", "a.csv", layer=None, unit=None, gap=GAP)


def svg(body: str, size: str = 'width="80mm" height="40mm" viewBox="-40 -20 80 40"') -> bytes:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{body}</svg>'.encode()


GROUPS = (
    '<g id="NOTES"><circle r="19"/></g><g id="BLIND_2"><circle cx="3" r="1"/></g>'
    '<g id="CUT"><circle r="2"/>'
    '<path d="M-10,-5 H10 A5,5 0 0 1 10,5 H-10 A5,5 0 0 1 -10,-5 Z"/></g>'
)


def test_groups_of_an_svg_are_layers() -> None:
    def areas(data: bytes, layer: str | None = None) -> list[float]:
        found = SVG.read(data, "a.svg", layer=layer, unit=None, gap=GAP)
        return [each.area for each in found.contours]

    expected = [STADIUM, 4.0 * math.pi, math.pi]
    assert areas(svg(GROUPS)) == pytest.approx(expected, rel=1e-12)
    assert areas(svg(GROUPS), "NOTES") == pytest.approx([361.0 * math.pi], rel=1e-12)
    assert len(areas(svg(GROUPS.replace("CUT", "cut")))) == 4
    inches = svg(GROUPS, 'width="80in" height="40in" viewBox="-40 -20 80 40"')
    assert areas(inches) == pytest.approx([25.4**2 * each for each in expected], rel=1e-12)
    with pytest.raises(
        FileError, match="no contour in a group 'cut'; groups: 'BLIND_2', 'CUT', 'NOTES'"
    ):
        areas(svg(GROUPS), "cut")
    with pytest.raises(FileError, match="states its size; leave out the unit inch"):
        SVG.read(svg(GROUPS), "a.svg", layer=None, unit="inch", gap=GAP)
