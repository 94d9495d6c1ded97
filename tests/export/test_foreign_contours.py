"""Contours of other programs: what ezdxf draws, a table of vertices holds, or an SVG shows."""

from __future__ import annotations

import io
import json
import math
import random
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ezdxf.filemanagement import new
from ezdxf.layouts.base import BaseLayout
from ezdxf.layouts.layout import Modelspace
from ezdxf.math import ConstructionArc, Matrix44, rational_bspline_from_arc

from camgeo.app.answers.inspect import read_points
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.foreign import Outlines, by_arcs
from camgeo.geometry.contour.spline import CubicSpline, SplineContour
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import LengthUnit
from camgeo_export.contour_csv import READER as CSV
from camgeo_export.dxf.reader import NEAR, PLACED, READER, read_drawing
from camgeo_export.reading import AnyContour
from camgeo_export.svg import READER as SVG
from tests.measuring import Outline

GAP = 1e-3

Draw = Callable[[Modelspace], object]

Way = Callable[[BaseLayout], object]


def add(entity: str, *given: Any, **options: Any) -> Way:
    """An entity, by the method of ezdxf that adds it."""
    return lambda space: getattr(space, f"add_{entity}")(*given, **options)


def together(*ways: Way) -> Way:
    """One after the other."""
    return lambda space: [way(space) for way in ways]


def block(name: str, *ways: Way, **options: Any) -> Way:
    """What is drawn as a block, which is not inserted."""
    return lambda space: together(*ways)(space.doc.blocks.new(name, **options))


def insert(name: str, place: tuple[float, float], **options: Any) -> Way:
    return add("blockref", name, place, options)


def drawn(draw: Draw, version: str = "R2010", units: int = 4) -> bytes:
    """A drawing as another program writes it."""
    document = new(version, units=units)
    draw(document.modelspace())
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def read_dxf(
    data: bytes, layer: str | None = None, unit: LengthUnit | None = None, gap: float = GAP
) -> tuple[Contour, ...]:
    found = READER.read(data, "a.dxf", layer=layer, unit=unit, gap=gap).contours
    plain = tuple(each for each in found if isinstance(each, Contour))
    assert len(plain) == len(found)
    return plain


HALF, RADIUS, BORE = 10.0, 5.0, 2.0
AREA = 4.0 * HALF * RADIUS + math.pi * RADIUS**2


RIGHT = add("arc", (HALF, 0.0), RADIUS, -90.0, 90.0)
LEFT = add("arc", (-HALF, 0.0), RADIUS, 90.0, 270.0)
TOP = add("line", (HALF, RADIUS), (-HALF, RADIUS))
BOTTOM = add("line", (HALF, -RADIUS), (-HALF, -RADIUS))
HOLE = add("circle", (0.0, 0.0), BORE)
STADIUM = together(BOTTOM, RIGHT, LEFT, TOP)
PLATE = together(STADIUM, HOLE)


def from_stadium(z: ComplexArray) -> FloatArray:
    """Signed distances [mm]."""
    return np.abs(z - np.clip(z.real, -HALF, HALF)) - RADIUS


@pytest.mark.parametrize(("units", "scale"), [(1, 25.4), (4, 1.0), (5, 10.0), (6, 1000.0)])
def test_units(units: int, scale: float) -> None:
    (contour,) = read_dxf(drawn(STADIUM, units=units))
    assert contour.area == pytest.approx(AREA * scale**2, rel=1e-12)


def test_the_unit_must_be_known_and_agree() -> None:
    silent = drawn(STADIUM, units=0)
    with pytest.raises(FileError, match=r"a.dxf: does not state its unit .* give mm or inch"):
        read_dxf(silent)
    (contour,) = read_dxf(silent, unit="inch")
    assert contour.area == pytest.approx(AREA * 25.4**2, rel=1e-12)
    with pytest.raises(FileError, match="which is not inch"):
        read_dxf(drawn(STADIUM, units=4), unit="inch")
    with pytest.raises(FileError, match=r"INSUNITS is 13; supported: inch"):
        read_dxf(drawn(STADIUM, units=13))


BULGED = [(10.0, 0.0, 0.0), (10.0, 10.0, 1.0), (0.0, 10.0, 0.0), (0.0, 0.0, -0.5)]


def bulged_area() -> float:
    """A square of 10 with a half circle added above and a segment cut in below."""
    sweep = 4.0 * math.atan(0.5)
    radius = 5.0 / math.sin(0.5 * sweep)
    return 100.0 + 0.5 * math.pi * 25.0 - 0.5 * radius**2 * (sweep - math.sin(sweep))


@pytest.mark.parametrize("kind", ["lwpolyline", "polyline2d"])
@pytest.mark.parametrize("closed", [True, False])
def test_polylines_with_bulges(kind: str, closed: bool) -> None:
    points = BULGED if closed else [*BULGED, (10.0, 0.0, 0.0)]
    (contour,) = read_dxf(drawn(add(kind, points, format="xyb", close=closed)))
    assert contour.area == pytest.approx(bulged_area(), rel=1e-12)
    assert len(contour) == 4


def test_the_largest_first_and_layers() -> None:
    frame = [
        add("circle", (x, 0.0), size, dxfattribs={"layer": "FRAME"})
        for x, size in ((1.0, 9.0), (0.0, 5.0))
    ]
    data = drawn(together(add("circle", (0.0, 0.0), 3.0), *frame))
    sizes = [round(math.sqrt(each.area / math.pi), 9) for each in read_dxf(data)]
    assert sizes == [9.0, 5.0, 3.0]
    assert len(read_dxf(data, layer="FRAME")) == 2
    with pytest.raises(FileError, match=r"has no layer 'CUTS'; there are 0, FRAME"):
        read_dxf(data, layer="CUTS")


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


# Splines ------------------------------------------------------------------------------------------


def read_curves(data: bytes, gap: float = 1e-9) -> tuple[AnyContour, ...]:
    return read_drawing(data, "a.dxf").contours(None, gap)


BOW = [(10.0, 0.0), (10.0, 10.0), (-10.0, 10.0), (-10.0, 0.0)]

BOW_AREA = 120.0
"""y = 30 t (1 - t) and dx = -120 t (1 - t) dt: 3600 times the integral of t^2 (1 - t)^2, 1/30."""


def under(draw: Draw) -> Draw:
    """What leads from (10, 0) to (-10, 0), over a line."""
    return lambda space: (draw(space), space.add_line((-10.0, 0.0), (10.0, 0.0)))


@pytest.mark.parametrize(
    ("draw", "least", "most"),
    [
        (lambda space: space.add_open_spline(BOW, degree=3), BOW_AREA, BOW_AREA),
        (lambda space: space.add_rational_spline(BOW, [2.0] * 4, degree=3), BOW_AREA, BOW_AREA),
        (lambda space: space.add_open_spline(BOW, degree=2), BOW_AREA + 1.0, 199.0),
        (lambda space: space.add_open_spline(BOW, degree=1), 200.0, 200.0),
    ],
    ids=["cubic", "equal weights", "square", "straight"],
)
def test_clamped_and_of_lower_degree(draw: Draw, least: float, most: float) -> None:
    (contour,) = read_curves(drawn(under(draw)))
    assert isinstance(contour, SplineContour)
    assert [type(strand) for strand in contour.splines] == [CubicSpline]
    assert least * (1.0 - 1e-14) <= contour.area <= most * (1.0 + 1e-14)


@pytest.mark.parametrize(
    ("draw", "area"),
    [
        (lambda space: space.add_lwpolyline([(10.0, 0.01), (0.0, 10.0), (-10.0, 0.0)]), 100.0),
        (lambda space: space.add_open_spline([*BOW[:3], (-10.0, 0.01)], degree=3), BOW_AREA),
    ],
    ids=["lines", "spline"],
)
def test_gaps_up_to_the_limit_are_closed(draw: Draw, area: float) -> None:
    data = drawn(under(draw))
    (contour,) = read_curves(data, gap=0.02)
    assert contour.area == pytest.approx(area, abs=0.2)
    with pytest.raises(FileError, match=r"a.dxf, line \d+: \w+ has a loose end at \(-?10, 0"):
        read_curves(data)


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
def test_splines_that_are_refused(draw: Draw, message: str) -> None:
    with pytest.raises(FileError, match=rf"a.dxf, line \d+: {message}"):
        read_curves(drawn(draw))


# Curves that camgeo has no exact form for, and what is wrong in a drawing -------------------------


def along(contour: Contour | SplineContour) -> ComplexArray:
    """Points on all pieces."""
    plain = by_arcs(contour, 1e-9) if isinstance(contour, SplineContour) else contour
    return Outline.through(plain.vertices, plain.sweeps).dense(9 * len(plain))


ALONG = np.linspace(0.0, 1.0, 100)


def read_drawn(draw: Draw) -> Outlines:
    return READER.read(drawn(draw), "a.dxf", layer=None, unit=None, gap=1e-3)


@pytest.mark.parametrize("ratio", [0.99, 0.5, 0.02])
def test_an_ellipse_is_followed_within_what_is_told(ratio: float) -> None:
    """Distances to first order: x^2/a^2 + y^2/b^2 - 1 over the size of its gradient."""
    a, turn, centre = 60.0, np.exp(0.3j), 7.0 - 5.0j
    ends = [(each.real, each.imag) for each in (centre, a * turn)]
    found = read_drawn(add("ellipse", *ends, ratio))
    (contour,) = found.contours
    assert isinstance(contour, SplineContour)
    z = (along(contour) - centre) / turn / a
    value = z.real**2 + (z.imag / ratio) ** 2 - 1.0
    slope = 2.0 * np.hypot(z.real, z.imag / ratio**2)
    off = a * np.max(np.abs(value) / slope)
    assert 1e-3 * NEAR < off <= NEAR + 2e-9
    assert contour.area == pytest.approx(math.pi * a * a * ratio, rel=1e-8)
    assert found.notes == ("a.dxf: 1 ELLIPSE followed by cubics within 1e-07 mm",)


@pytest.mark.parametrize("degree", [2, 3, 5])
@pytest.mark.parametrize("seed", range(3))
def test_rational_splines_are_followed_within_what_is_told(degree: int, seed: int) -> None:
    """Points of them by ezdxf are as near to what is read, seen at their nearest."""
    make = random.Random(f"{degree} {seed}")
    count = 3 * degree
    ring = [
        (make.uniform(20, 40) * math.cos(t), make.uniform(20, 40) * math.sin(t))
        for t in np.arange(count) * 2.0 * math.pi / count
    ]
    weights = [make.uniform(0.5, 3.0) for _ in range(count + 1)]
    draw = add("rational_spline", [*ring, ring[0]], weights, degree=degree)
    found = read_drawn(draw)
    (contour,) = found.contours
    assert found.followed == NEAR
    document = new()
    draw(document.modelspace())
    curve = document.modelspace()[0].construction_tool()
    exact = np.array([complex(each.x, each.y) for each in curve.points(ALONG * curve.max_t)])
    assert isinstance(contour, SplineContour)
    plain = by_arcs(contour, 1e-9)
    outline = Outline.through(plain.vertices, plain.sweeps)
    assert np.max(outline.distances(exact)) <= NEAR + 1e-8


def test_what_lies_on_what_is_told_for_lines_of_any_drawing() -> None:
    """Random polygons with random lines: what touches a corner, ends loosely or divides is left."""
    for seed in range(20):
        make = random.Random(seed)
        count = make.randint(3, 12)
        corners = [
            (make.uniform(30, 60) * math.cos(t), make.uniform(30, 60) * math.sin(t))
            for t in np.sort([make.uniform(0, 2 * math.pi) for _ in range(count)]).tolist()
        ]
        sides = list(pairwise([*corners, corners[0]]))
        extra = []
        for _ in range(make.randint(0, 5)):
            corner = make.choice(corners)
            away = (make.uniform(70, 99), make.uniform(70, 99))
            extra.append((corner, away))
        doubles = [side[::-1] for side in sides if make.random() < 0.3]
        every = sides + extra + doubles
        make.shuffle(every)
        found = read_drawn(together(*(add("line", *ends) for ends in every)))
        (contour,) = found.contours
        area = 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in sides)
        assert contour.area == pytest.approx(abs(area), rel=1e-12)
        told = sum(int(note.split(": ")[1].split()[0]) for note in found.notes)
        assert told == len(extra) + len(doubles)


def test_blocks_without_end_are_refused() -> None:
    itself = block("A", add("circle", (0, 0), 1.0), insert("a", (5, 0)))
    found = read_drawn(together(itself, insert("A", (0, 0))))
    assert len(found.contours) == 1
    assert "inserts a block into itself" in found.notes[0]
    many = [block(f"B{k}", *(insert(f"B{k + 1}", (x, 0)) for x in range(10))) for k in range(6)]
    with pytest.raises(FileError, match=rf"in blocks; at most {PLACED:,} are allowed"):
        read_drawn(together(*many, block("B6"), insert("B0", (0, 0))))


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda space: None, "no contour found; supported: LINE, ARC"),
        (lambda space: space.add_text("A"), "no contour found; not read: 1 TEXT"),
        (
            lambda space: space.add_circle((0, 0), 5.0, dxfattribs={"layer": "DEFPOINTS"}),
            "no contour found; 1 entity not read that the drawing does not show",
        ),
        (lambda space: space.add_line((0, 0), (1, 0)), r"LINE has a loose end at \(0, 0\) mm"),
        (lambda space: space.add_mesh() and None, "no contour found"),
    ],
)
def test_a_drawing_without_a_contour_is_refused_with_the_reason(draw: Draw, message: str) -> None:
    with pytest.raises(FileError, match=message):
        read_drawn(draw)


def test_a_line_end_is_any() -> None:
    data = drawn(lambda space: space.add_circle((1, 2), 3.0))
    for end in (b"\r\n", b"\r"):
        found = READER.read(
            b"\xef\xbb\xbf" + data.replace(b"\n", end), "a.dxf", layer=None, unit=None, gap=0.0
        )
        assert found.contours[0].area == pytest.approx(9.0 * math.pi, rel=1e-12)


def test_the_centre_of_the_bore_is_found_among_others() -> None:
    """That of a bore with a keyway, as one of arcs and lines; not that of a bolt hole."""
    middle = 100.0 + 50.0j

    half = math.asin(0.3)
    points = [(middle + 10.0 * np.exp(1j * t)) for t in (half, -half)]
    bulge = math.tan(0.25 * (2.0 * math.pi - 2.0 * half))
    corners = [(points[0].real, points[0].imag, bulge), (points[1].real, points[1].imag, 0.0),
               (112.0, points[1].imag, 0.0), (112.0, points[0].imag, 0.0)]  # fmt: skip
    circles = [add("circle", (x, 50), size) for x, size in ((90, 40.0), (70, 3.0), (130, 3.0))]
    keyed = add("lwpolyline", corners, format="xyb", close=True)
    found = read_drawn(together(*circles, keyed))
    outline = found.contours[0]
    assert not isinstance(outline, SplineContour)
    assert found.misplaced_bore(outline) == "its bore is centred on (100, 50) mm: --origin 100 50"
    moved = found.with_origin(middle)
    assert moved.contours[1].area == pytest.approx(found.contours[1].area, rel=1e-12)
    outline = moved.contours[0]
    assert not isinstance(outline, SplineContour)
    assert moved.misplaced_bore(outline) == ""


# Many entities ------------------------------------------------------------------------------------


HEADER = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"

MOST = 20.0
"""Bytes of memory for a byte of the file."""

CHILD = """
import json, sys
from pathlib import Path
import scipy.sparse.csgraph, scipy.spatial
from camgeo_export.dxf.reader import READER
def peak():
    rows = Path("/proc/self/status").read_text().splitlines()
    return 1024.0 * float(next(row for row in rows if row.startswith("VmHWM")).split()[1])
data = Path(sys.argv[1]).read_bytes()
before = peak() - len(data)
read = READER.read(data, "a.dxf", layer=None, unit=None, gap=1e-3)
print(json.dumps([(peak() - before) / len(data), len(read.contours[0]), len(read.notes)]))
"""


def line(x: float, y: float, u: float, v: float) -> str:
    ends = f"10\n{x:.9f}\n20\n{y:.9f}\n30\n0.0\n11\n{u:.9f}\n21\n{v:.9f}\n31\n0.0\n"
    return f"0\nLINE\n8\nCONTOUR\n62\n7\n{ends}"


def many_lines(count: int) -> str:
    """A circle of `count` lines, and as many that are loose."""
    turn = 2.0 * math.pi / count
    places = [(100.0 * math.cos(turn * k), 100.0 * math.sin(turn * k)) for k in range(count)]
    round_lines = [line(*places[k - 1], *places[k]) for k in range(count)]
    loose = [line(k, 200.0 + k % 7, k + 0.5, 200.0) for k in range(count)]
    return "".join((HEADER, *round_lines, *loose, "0\nENDSEC\n0\nEOF\n"))


def test_progress_and_the_line_of_an_error() -> None:
    text = many_lines(5_000)
    steps: list[str] = []
    read = READER.read(
        text.encode(), "a.dxf", layer=None, unit=None, gap=0.0, progress=steps.append
    )
    (circle,) = read.contours
    assert len(circle) == 5_000
    assert "5,000 pieces left out" in read.notes[0]
    assert steps[0] == "a.dxf, 0 % read"
    assert any(step == "a.dxf, 0 entities taken" for step in steps)
    place = text.rindex("\n21\n200.0")
    broken = text[:place] + "\n21\n200,0" + text[place + len("\n21\n200.0") :]
    number = text[: place + 4].count("\n") + 1
    with pytest.raises(FileError, match=rf"a.dxf, line {number}: '200,0.*' is not a finite number"):
        READER.read(broken.encode(), "a.dxf", layer=None, unit=None, gap=0.0)


@pytest.mark.long  # of 100 MB and a million entities
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="states no peak of memory")
def test_memory_is_in_proportion_to_the_file(tmp_path: Path) -> None:
    file = tmp_path / "large.dxf"
    file.write_text(many_lines(500_000))
    assert file.stat().st_size > 80_000_000
    done = subprocess.run(
        [sys.executable, "-c", CHILD, str(file)], capture_output=True, text=True, check=True
    )
    share, pieces, notes = json.loads(done.stdout)
    assert share <= MOST
    assert (pieces, notes) == (500_000, 1)


# Tables and SVG -----------------------------------------------------------------------------------


def read_csv(text: str, unit: LengthUnit | None = None, layer: str | None = None) -> Contour:
    (contour,) = CSV.read(text.encode(), "a.csv", layer=layer, unit=unit, gap=GAP).contours
    assert isinstance(contour, Contour)
    return contour


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
@pytest.mark.parametrize(
    "titles",
    [[], ["x", "y"], ["x [inch]", "y [inch]"], ["y", "x", "z"], ["z [mm]", "y (in)", "x (in)"]],
)
def test_csv_and_measured_points_are_one_table(separator: str, titles: list[str]) -> None:
    """The same points by both readers, however they are written; z is of no interest."""
    corners = [
        (3.0 * math.cos(k) + 0.125, 2.0 * math.sin(k) - 0.25) for k in np.arange(16) * math.pi / 8.0
    ]
    names = [each[0] for each in titles] or ["x", "y"]
    rows = [{"x": x, "y": y, "z": -1.5} for x, y in corners]
    lines = [separator.join(titles)] if titles else []
    mark = SEPARATORS[separator]
    lines += [separator.join(repr(row[name]).replace(".", mark) for name in names) for row in rows]
    text = "\r\n".join(lines)
    scale = 25.4 if "in" in "".join(titles) else 1.0
    expected = np.array([complex(x, y) for x, y in corners]) * scale
    assert np.array_equal(read_points(text, "a.csv").points, expected)
    assert np.array_equal(read_csv(text).vertices, expected)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a.csv, line 1: there are no rows"),
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
        ("0,0\n1,0\n", "2 points enclose nothing"),
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

    expected = [(200.0 + 25.0 * math.pi), 4.0 * math.pi, math.pi]
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


# Drawings as shops make them ----------------------------------------------------------------------
# Drawings as shops make them, with ezdxf, read back against the shape that each is known to show.
#
# The shape is a stadium with a round bore: the points 5 mm from a segment, and 2 mm from a point.
# These distances are the independent answer.


def lines(*ends: tuple[float, float, float, float]) -> Way:
    return together(PLATE, *(add("line", each[:2], each[2:]) for each in ends))


COMB = together(
    PLATE, *(add("line", (k, 20.0), end) for k in range(40) for end in ((k + 1.0, 20.0), (k, 21.0)))
)

BRIDGE = together(
    STADIUM,
    *(add("arc", (0, 0), BORE, start, start + 180) for start in (0, 180)),
    add("line", (BORE, 0.0), (HALF, RADIUS)),
)
"""A line from the bore, of two arcs, to a corner of the outline."""


def hidden(name: str, **state: bool) -> Way:
    """A frame on a layer that is not shown."""

    def draw(space: BaseLayout) -> None:
        PLATE(space)
        layer = (
            space.doc.layers.get(name) if name in space.doc.layers else space.doc.layers.add(name)
        )
        if state.get("off"):
            layer.off()
        if state.get("frozen"):
            layer.freeze()
        space.add_circle((0.0, 0.0), 4.0, dxfattribs={"layer": name.swapcase()})
        space.add_line((-HALF, RADIUS), (HALF, -RADIUS), dxfattribs={"layer": name})

    return draw


def on_cut(space: BaseLayout) -> None:
    """The layer of what is cut, in lower case as some programs write it, and a frame."""
    PLATE(space)
    for each in space:
        each.dxf.layer = "cut"
    space.add_lwpolyline([(-90, -90), (90, -90), (90, 90), (-90, 90)], close=True)


def rational(degree: int) -> Way:
    """The ends as rational splines, of a higher degree if asked for."""

    def draw(space: BaseLayout) -> None:
        together(BOTTOM, TOP, HOLE)(space)
        for x, start in ((HALF, -90.0), (-HALF, 90.0)):
            arc = ConstructionArc((x, 0.0), RADIUS, start, start + 180.0)
            curve = rational_bspline_from_arc((x, 0.0), RADIUS, arc.start_angle, arc.end_angle)
            curve = curve.degree_elevation(degree - 2) if degree > 2 else curve
            space.add_spline().apply_construction_tool(curve)

    return draw


ROUND_ELLIPSES = together(
    BOTTOM,
    TOP,
    add("ellipse", (0, 0), (0.0, BORE), 1.0),
    add("ellipse", (HALF, 0), (RADIUS, 0.0), 1.0, -0.5 * math.pi, 0.5 * math.pi),
    add("ellipse", (-HALF, 0), (0.0, -RADIUS), 1.0, math.pi, 2.0 * math.pi),
)

STRAIGHT_SPLINES = together(
    RIGHT,
    LEFT,
    HOLE,
    add("open_spline", [(HALF, RADIUS), (1.0, RADIUS), (-HALF, RADIUS)], degree=1),
    add("spline", [(-HALF, -RADIUS), (3.0, -RADIUS), (HALF, -RADIUS)]),
)
"""The lines as a spline of degree 1, and as one through points."""


def heavy(flags: int, kinds: tuple[int, ...]) -> Way:
    """A POLYLINE with bulges that is marked as fitted, some of its vertices being of the frame."""

    def draw(space: BaseLayout) -> None:
        HOLE(space)
        corners = CORNERS.copy()
        for kind in kinds:
            corners.insert(2, (99.0, float(kind), 0.0))
        drawn = space.add_polyline2d(corners, format="xyb", close=True)
        drawn.dxf.flags |= flags
        for vertex in drawn.vertices:
            if vertex.dxf.location.x == 99.0:
                vertex.dxf.flags = int(vertex.dxf.location.y)

    return draw


def turned_plate(space: BaseLayout) -> None:
    """Turned, scaled and away from its place."""
    there = Matrix44.translate(-15.0, -9.0, 0.0) @ Matrix44.z_rotate(math.radians(30.0))
    PLATE(space)
    for entity in space:
        entity.transform(there @ Matrix44.scale(2.0) @ Matrix44.translate(3.0, 4.0, 0.0))


NESTED = together(
    block("inner", PLATE),
    block("outer", insert("INNER", (7.0, 8.0), xscale=-1.0)),
    insert("Outer", (7.0, -8.0), xscale=-1.0),
)

GRID = {"row_count": 2, "row_spacing": 2.0 * RADIUS, "column_count": 1}

ROWS = together(block("side", BOTTOM), insert("side", (0.0, 0.0), **GRID), RIGHT, LEFT, HOLE)
"""The line of the top and that of the bottom as an array of one."""

LAYER_OF_INSERT = together(
    block("part", PLATE),
    lambda space: space.doc.layers.add("HID").freeze(),
    insert("part", (0, 0), layer="cut"),
    insert("part", (5, 0), layer="hid"),
    insert("part", (90, 0), layer="OTHER"),
)
"""Entities on layer 0 of a block lie on that of the insertion."""

THIRD = 1.0 / 3.0

SQUASHED = together(
    block(
        "squashed",
        add("line", (HALF, RADIUS * THIRD), (-HALF, RADIUS * THIRD)),
        add("line", (HALF, -RADIUS * THIRD), (-HALF, -RADIUS * THIRD)),
        add("ellipse", (0, 0), (BORE, 0.0), THIRD),
        add("ellipse", (HALF, 0), (RADIUS, 0.0), THIRD, -0.5 * math.pi, 0.5 * math.pi),
        add("ellipse", (-HALF, 0), (RADIUS, 0.0), THIRD, 0.5 * math.pi, 1.5 * math.pi),
    ),
    insert("squashed", (0, 0), yscale=3.0),
)
"""Circles in a block that is stretched threefold along y, squashed as ellipses there."""

STRETCHED_ARCS = together(
    block("bore", add("arc", (0, 0), BORE, 10, 190), add("arc", (0, 0), BORE, 190, 10)),
    block("flat", insert("bore", (0, 0), yscale=0.25)),
    insert("flat", (0, 0), yscale=4.0),
    STADIUM,
)
"""The same bore of two arcs, twice stretched: back to a circle."""


def shuffled(space: BaseLayout) -> None:
    """The outline in 64 pieces in any order and any direction, with the gaps of four decimals."""
    pieces = []
    corners = [complex(-HALF + 20.0 * k / 32, -RADIUS) for k in range(33)]
    pieces += list(pairwise(corners))
    pieces += [(-a, -b) for a, b in pieces]
    draw = random.Random(5)
    draw.shuffle(pieces)
    for a, b in pieces:
        first, last = (a, b) if draw.random() < 0.5 else (b, a)
        ends = [(round(z.real, 4) + 1e-4 * draw.random(), z.imag) for z in (first, last)]
        space.add_line(*ends)
    together(RIGHT, LEFT, HOLE)(space)


CORNERS = [(-HALF, -RADIUS, 0.0), (HALF, -RADIUS, 1.0), (HALF, RADIUS, 0.0), (-HALF, RADIUS, 1.0)]


DOWN = {"extrusion": (0.0, 0.0, -1.0)}
"""Of what is drawn from below."""

MIRRORED = together(
    add("lwpolyline", CORNERS, format="xyb", close=True, dxfattribs=DOWN),
    add("circle", (0.0, 0.0), BORE, dxfattribs=DOWN),
)


def annotated(space: BaseLayout) -> None:
    space.add_text("DRAWN BY")
    space.add_mtext("not to scale")
    space.add_point((0.0, 0.0))
    space.add_linear_dim((0, 9), (-HALF, RADIUS), (HALF, RADIUS)).render()
    space.add_hatch().paths.add_polyline_path([(-9, -4), (9, -4), (9, 4)], is_closed=True)
    space.add_solid([(0, 0), (1, 0), (0, 1)])


@dataclass(frozen=True)
class Case:
    """A way to draw the plate.

    Attributes
    ----------
    draw : it.
    note : what is told of the rest; "" for nothing.
    within : of the shape [mm].
    layer : asked for.
    version : of the format.
    """

    draw: Way
    note: str = ""
    within: float = 1e-12
    layer: str | None = None
    version: str = "R2010"


OUT = r"left out: [A-Z]+ in line \d+"
LOOSE, BRANCH = f"{OUT} has a loose end at", f"{OUT} meets more than one other piece at"
TWICE = f"{OUT} is drawn a second time at"

BASE = {"base_point": (3.0, 4.0)}

CASES = {
    "nothing else": Case(PLATE),
    **{each: Case(PLATE, version=each) for each in ("R12", "R2000", "R2018")},
    "loose line at a corner": Case(lines((HALF, RADIUS, 30, 5)), rf"1 piece {LOOSE} \(30, 5\) mm$"),
    "loose line away": Case(lines((40, 40, 50, 50)), f"1 piece {LOOSE}"),
    "centre lines": Case(lines((-30, 0, 30, 0), (0, -30, 0, 30)), f"2 pieces {LOOSE}"),
    "lines that cross the outline": Case(lines((-9, -9, 9, 9), (0, 9, 1, -9)), f"2 pieces {LOOSE}"),
    "cross in the bore": Case(lines((-1, 0, 1, 0), (0, -1, 0, 1)), f"2 pieces {LOOSE}"),
    "chord": Case(lines((HALF, RADIUS, HALF, -RADIUS)), f"1 piece {BRANCH}"),
    "two chords": Case(
        lines((HALF, RADIUS, HALF, -RADIUS), (-HALF, RADIUS, -HALF, -RADIUS)),
        f"2 pieces {BRANCH}",
    ),
    "star of lines": Case(
        lines(*((0, 0, x, y) for x in (-HALF, HALF) for y in (-RADIUS, RADIUS))),
        f"4 pieces {BRANCH}",
    ),
    "bridge to the bore": Case(BRIDGE, f"1 piece {BRANCH}"),
    "leader": Case(
        together(PLATE, lambda s: s.add_lwpolyline([(0, 9), (3, 20), (9, 20)])), "1 piece"
    ),
    "tick along the outline": Case(lines((HALF, RADIUS, 12, RADIUS)), f"1 piece {LOOSE}"),
    "tree of lines": Case(COMB, f"80 pieces {LOOSE}"),
    "line of no length": Case(lines((HALF, RADIUS, HALF, RADIUS))),
    "line twice": Case(together(PLATE, TOP), f"1 piece {TWICE}"),
    "line three times": Case(together(PLATE, TOP, TOP), f"2 pieces {TWICE}"),
    "line twice, reversed": Case(lines((-HALF, RADIUS, HALF, RADIUS)), f"1 piece {TWICE}"),
    "arc twice, mirrored": Case(
        together(PLATE, lambda s: s.add_arc((HALF, 0), RADIUS, -90, 90, dxfattribs=DOWN)),
        f"1 piece {TWICE}",
    ),
    "all twice": Case(together(PLATE, PLATE), f"5 pieces {TWICE}"),
    "bore as circle and polyline": Case(
        together(
            PLATE, lambda s: s.add_lwpolyline([(0, 2, 1), (0, -2, 1)], format="xyb", close=True)
        ),
        "1 piece left out: LWPOLYLINE in line .* second time",
    ),
    "line over part of a line": Case(lines((HALF, RADIUS, 0, RADIUS)), f"1 piece {LOOSE}"),
    "layer off": Case(hidden("Constr", off=True), "2 entities not read .* on layer Constr$"),
    "layer frozen": Case(hidden("CONSTR", frozen=True), "2 entities not read .* on layer CONSTR$"),
    "Defpoints": Case(hidden("Defpoints"), "2 entities not read .* on layer Defpoints$"),
    "invisible": Case(
        together(PLATE, lambda s: s.add_circle((0, 0), 4.0, dxfattribs={"invisible": 1})),
        "1 entity not read .* on layer 0$",
    ),
    "paper space": Case(together(PLATE, lambda s: s.doc.paperspace().add_circle((0.0, 0.0), 30.0))),
    "layer cut": Case(on_cut),
    "layer by any case": Case(on_cut, layer="Cut"),
    "rational arcs": Case(rational(2), "2 SPLINE followed by cubics within 1e-07 mm", NEAR),
    "rational arcs of degree 4": Case(rational(4), "2 SPLINE followed by cubics", NEAR),
    "round ellipses": Case(ROUND_ELLIPSES),
    "straight splines": Case(STRAIGHT_SPLINES, "1 SPLINE followed by cubics"),
    "fitted polyline": Case(heavy(2, ())),
    "splined polyline": Case(heavy(4, (16, 17))),
    "block": Case(together(block("Plate", PLATE, **BASE), insert("PLATE", (3, 4)))),
    "block, turned, scaled": Case(
        together(
            block("Plate", turned_plate, **BASE),
            insert("PLATE", (15.0, 9.0), rotation=-30.0, xscale=0.5, yscale=0.5),
        )
    ),
    "blocks in blocks, mirrored": Case(NESTED),
    "block in rows": Case(ROWS),
    "layer of the insertion": Case(LAYER_OF_INSERT, "on layer HID$", layer="CUT"),
    "stretched ellipses": Case(SQUASHED),
    "stretched arcs": Case(STRETCHED_ARCS),
    "shuffled pieces with gaps": Case(shuffled, within=1.1e-4),
    "mirrored": Case(MIRRORED),
    "annotated": Case(together(PLATE, annotated), "not read: .*HATCH"),
    "unknown block": Case(
        together(PLATE, lambda s: s.add_blockref("GONE", (0, 0))),
        r"line \d+: INSERT inserts a block that is not there: 'GONE'; left out",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_plate_is_read_however_it_is_drawn(name: str) -> None:
    case = CASES[name]
    data = drawn(case.draw, case.version)
    unit: LengthUnit | None = "mm" if case.version == "R12" else None
    found = READER.read(data, "a.dxf", layer=case.layer, unit=unit, gap=GAP)
    big, small = found.contours
    assert np.max(np.abs(from_stadium(along(big)))) <= case.within + 1e-8 * (case.within == NEAR)
    assert np.max(np.abs(np.abs(along(small)) - BORE)) <= 1e-12
    assert big.area == pytest.approx(AREA, abs=40.0 * case.within + 1e-10)
    assert small.area == pytest.approx(math.pi * BORE**2, rel=1e-12)
    assert (found.followed == NEAR) == ("followed by" in case.note)
    told = "\n".join(found.notes)
    if case.note:
        assert re.search(case.note, told), told
    else:
        assert told == ""
