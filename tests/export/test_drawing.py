"""The sheet as DXF, PDF and SVG, read back with ezdxf: every mark is an entity in its place."""

from __future__ import annotations

import io
import math
import re
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from itertools import pairwise
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import shapely
from ezdxf.bbox import extents
from ezdxf.document import Drawing
from ezdxf.entities.dimension import Dimension
from ezdxf.entities.mtext import MText
from ezdxf.filemanagement import read as parsed
from fontTools.pens.recordingPen import RecordingPen  # type: ignore[import-untyped]  # has no types
from fontTools.svgLib.path import parse_path  # type: ignore[import-untyped]  # has no types

from camgeo.design.design import Design
from camgeo.design.product import Product, find_disc
from camgeo.design.verify import ReadingOptions
from camgeo.errors import FileError
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.spec import text_name
from camgeo.pictures.sheet.marks import (
    ARROW,
    EXTENSION_GAP,
    EXTENSION_OVERSHOOT,
    LETTERS,
    LIFTED,
    NARROWED,
    Chain,
    Diameter,
    Distance,
    Filled,
    Hatched,
    Label,
    Mark,
    Round,
    Sheet,
    dimension_text,
    line,
)
from camgeo.pictures.sheet.sheet import build_sheets
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import MM_PER
from camgeo_export.drawing.writer import LAYERS, PDF, RARE, SVG, WRITER
from camgeo_export.verify.dxf import VERIFIER
from tests.sheet.sheets import (
    FIXTURES,
    FULL,
    HUBBED,
    TOLERANCE,
    edited,
    line_of,
    part,
    polygons,
    products,
    room,
    text_boxes,
)

Placed = Callable[[complex], complex]

KINDS = ("inch", "groove", "bolts")

GRAIN = 0.005
"""Of all coordinates on a page [mm]."""


SCENES = {"setzhub": ("A4", "de"), "groove": ("A4", "en"), "inch": ("A3", "en")}
"""Fixtures, their paper and language."""


@cache
def product(name: str) -> Product:
    if name == "bolts":
        return part("bolts", 30, language="de", sheet="A4")
    return products(name, *SCENES[name])[0]


def opened(data: bytes) -> Drawing:
    return parsed(io.StringIO(data.decode("utf-8")))


@cache
def drawn(name: str) -> tuple[Sheet, bytes, Drawing]:
    (sheet,) = build_sheets(product(name), TOLERANCE)
    data = WRITER.write(product(name), TOLERANCE).data
    return sheet, data, opened(data)


def placed(sheet: Sheet) -> list[tuple[Mark, complex, float]]:
    """Each mark with where its origin is on the paper [mm], and its scale."""
    views = [(mark, view.origin, sheet.scale) for view in sheet.views for mark in view.marks]
    return [*views, *((mark, 0j, 1.0) for mark in sheet.marks)]


@pytest.mark.parametrize("name", KINDS)
def test_every_mark_is_an_entity_in_its_place(name: str) -> None:
    """At true size: a millimetre of paper is a unit over the scale."""
    sheet, _, drawing = drawn(name)
    paper = 1.0 / (sheet.scale * MM_PER[sheet.unit])
    marks, entities = placed(sheet), list(drawing.modelspace())
    assert len(marks) == len(entities)
    for (mark, at, scale), entity in zip(marks, entities, strict=True):

        def there(place: complex, at: complex = at, scale: float = scale) -> complex:
            return (at + scale * complex(place) - sheet.views[0].origin) * paper

        check(mark, entity, there, scale * paper, paper)


def place(value: Any) -> complex:
    """Of a vector of ezdxf."""
    x, y, *_ = value
    return complex(x, y)


def require(found: Any, **stated: float) -> None:
    """Numbers of an entity or a style."""
    assert {name: getattr(found, name) for name in stated} == pytest.approx(
        stated, rel=1e-12, abs=1e-9
    )


def check(mark: Mark, entity: Any, there: Placed, size: float, paper: float) -> None:
    """`there` gives the place in the drawing, `size` is that of a millimetre of the mark."""
    kind, dxf = entity.dxftype(), entity.dxf
    if isinstance(mark, Chain):
        assert dxf.layer == mark.layer
        expected = [there(each) for each in mark.vertices.tolist()]
        if kind == "LINE":
            assert (len(expected), mark.closed, mark.sweeps[0]) == (2, False, 0.0)
            assert [place(dxf.start), place(dxf.end)] == pytest.approx(expected, abs=1e-9)
            return
        assert kind == "LWPOLYLINE"
        rows = np.array(entity.get_points("xyb"))
        assert rows[:, 0] + 1j * rows[:, 1] == pytest.approx(np.array(expected), abs=1e-9)
        assert rows[:, 2] == pytest.approx(np.tan(0.25 * mark.sweeps), abs=1e-12)
        assert entity.closed == mark.closed
        assert dxf.flags == 128 + mark.closed
    elif isinstance(mark, Round):
        assert (kind, dxf.layer) == ("CIRCLE", mark.layer)
        require(dxf, radius=mark.radius * size)
        assert place(dxf.center) == pytest.approx(there(mark.centre), abs=1e-9)
    elif isinstance(mark, Label):
        assert (kind, dxf.layer, dxf.text, dxf.style) == ("TEXT", mark.layer, mark.text, "CAMGEO")
        require(
            dxf, height=mark.height * paper, rotation=0.0, valign=0,
            width=NARROWED * mark.squeeze,
            halign={"left": 0, "centre": 1, "right": 2}[mark.across],
        )  # fmt: skip
        where = dxf.insert if mark.across == "left" else dxf.align_point
        assert place(where) == pytest.approx(there(mark.place), abs=1e-9)
    elif isinstance(mark, Filled):
        assert (kind, dxf.layer) == ("SOLID", mark.layer)
        expected = [there(each) for each in mark.corners]
        corners = [place(dxf.get(f"vtx{k}")) for k in range(4)]
        if len(expected) == 4:
            corners[2], corners[3] = corners[3], corners[2]
        assert corners[: len(expected)] == pytest.approx(expected, abs=1e-9)
    elif isinstance(mark, Hatched):
        assert (kind, dxf.layer, dxf.color) == ("HATCH", "HATCH", 256)
        assert (dxf.pattern_name, dxf.solid_fill) == ("ANSI31", 0)
        (path,) = entity.paths
        found = [place(each) for each in path.vertices]
        expected = [there(each) for each in mark.corners.tolist()]
        assert found == pytest.approx(expected, abs=1e-9)
        (line,) = entity.pattern.lines
        assert line.angle == 45.0
        apart = abs(complex(*line.offset))
        assert apart == pytest.approx(2.5 * paper, rel=1e-9)
    else:
        assert (kind, dxf.layer, dxf.dimstyle) == ("DIMENSION", "DIMENSION", "CAMGEO")
        told = entity.override()
        assert (told.get("dimdec"), told.get("dimpost")) == (
            mark.decimals,
            f"{mark.prefix}<>{mark.suffix}",
        )
        check_dimension(mark, entity, there)


def check_dimension(mark: Distance | Diameter, entity: Any, there: Placed) -> None:
    dxf, told = entity.dxf, entity.override()
    if isinstance(mark, Distance):
        assert dxf.dimtype & 7 == 0
        ends = [place(dxf.defpoint2), place(dxf.defpoint3)]
        assert ends == pytest.approx([there(mark.first), there(mark.second)], abs=1e-9)
        assert dxf.angle == pytest.approx(math.degrees(mark.angle), abs=1e-9)
        across = 1j * np.exp(1j * mark.angle)
        off = ((place(dxf.defpoint) - there(mark.line)) * np.conj(across)).real
        assert off == pytest.approx(0.0, abs=1e-9)
        if mark.bare:
            arrows = [told.get("dimblk1"), told.get("dimblk2")]
            assert told.get("dimsah") == 1
            assert arrows[mark.bare - 1] == "NONE"
            assert arrows[2 - mark.bare] in ("", None)
        return
    assert isinstance(mark, Diameter)
    assert dxf.dimtype & 7 == 3
    ray = mark.radius * np.exp(1j * mark.angle)
    ends = [place(dxf.defpoint), place(dxf.defpoint4)]
    expected = [there(mark.centre - ray), there(mark.centre + ray)]
    assert sorted(ends, key=abs) == pytest.approx(sorted(expected, key=abs), abs=1e-9)
    own = {"dimtmove": 1, "dimtoh": 1, "dimtad": 1, "dimtofl": 0, "dimcen": 0.0}
    assert {name: told.get(name) for name in own} == own


@pytest.mark.parametrize("name", KINDS)
def test_tables_and_styles_are_those_of_the_sheet(name: str) -> None:
    sheet, _, drawing = drawn(name)
    paper = 1.0 / (sheet.scale * MM_PER[sheet.unit])
    layers = {each.dxf.name: each.dxf for each in drawing.layers}
    for layer, (colour, kind, width) in LAYERS.items():
        if layer in RARE:
            assert layer not in layers
            continue
        own = layers[layer]
        assert (own.color, own.linetype.upper(), own.lineweight) == (colour, kind, width)
    assert drawing.header["$LTSCALE"] == pytest.approx(paper, rel=1e-12)
    assert drawing.units == (4 if sheet.unit == "mm" else 1)
    assert drawing.header["$MEASUREMENT"] == (1 if sheet.unit == "mm" else 0)
    text = drawing.styles.get("CAMGEO").dxf
    assert (text.font, text.width) == ("DejaVuSans.ttf", NARROWED)
    style = drawing.dimstyles.get("CAMGEO").dxf
    expected = {
        "dimtxt": LETTERS, "dimasz": ARROW, "dimexe": EXTENSION_OVERSHOOT,
        "dimexo": EXTENSION_GAP, "dimgap": LIFTED, "dimscale": paper, "dimlfac": 1.0,
    }  # fmt: skip
    require(style, **expected)
    for key, value in expected.items():
        assert drawing.header[f"${key.upper()}"] == pytest.approx(value, rel=1e-12)
    words = {
        "dimtxsty": "CAMGEO", "dimdsep": ord("," if sheet.comma else "."), "dimzin": 8,
        "dimlunit": 2, "dimtad": 1, "dimtih": 0, "dimtoh": 0, "dimtix": 1, "dimtofl": 1,
        "dimlwd": 25, "dimlwe": 25,
    }  # fmt: skip
    assert {key: style.get(key) for key in words} == words
    low = -sheet.views[0].origin * paper
    high = low + complex(sheet.width, sheet.height) * paper
    for least, most in (("$EXTMIN", "$EXTMAX"), ("$LIMMIN", "$LIMMAX")):
        box = [place(drawing.header[least]), place(drawing.header[most])]
        assert box == pytest.approx([low, high], abs=1e-9)
    (view,) = drawing.viewports.get_config("*Active")
    assert place(view.dxf.center) == pytest.approx(0.5 * (low + high), abs=1e-9)
    side = max((high - low).real, (high - low).imag)
    assert view.dxf.height == pytest.approx(1.05 * side, rel=1e-12)
    assert view.dxf.aspect_ratio == pytest.approx(4.0 / 3.0)


# What the sheet says ------------------------------------------------------------------------------


def streams(data: bytes) -> list[str]:
    """The operators of each page of a PDF."""
    found = re.findall(rb"stream\n(.*?)\nendstream", data, re.DOTALL)
    return [zlib.decompress(each).decode("ascii") for each in found]


def dimensions(drawing: Drawing) -> list[Dimension]:
    return [each for each in drawing.modelspace() if isinstance(each, Dimension)]


def printed(dimension: Dimension) -> str:
    """What a program without dimensions of its own shows."""
    block = dimension.get_geometry_block()
    assert block is not None
    (text,) = [each for each in block if each.dxftype() in ("TEXT", "MTEXT")]
    found: str = text.text if isinstance(text, MText) else text.dxf.text
    return re.sub(r"\\A1;|\\~", "", found).replace("%%c", "Ø")


@pytest.mark.parametrize("name", SCENES)
def test_the_sheet_is_measured_and_sound(name: str) -> None:
    _, data, drawing = drawn(name)
    assert WRITER.measure(product(name), data) <= TOLERANCE
    facts = WRITER.write(product(name), TOLERANCE).facts
    assert facts["scale"] == ("1:2" if name == "groove" else "1:1")
    audit = drawing.audit()
    assert not audit.errors
    assert not audit.fixes
    assert {each.dxf.layer for each in drawing.modelspace()} <= set(LAYERS)
    size, language = SCENES[name]
    keys = {**FULL, "sheet": size, "language": language}
    again = Design(load_scene(FIXTURES / "scenes" / f"{name}.toml").with_values(edited(keys)))
    assert WRITER.write(again.disc, TOLERANCE).data == data


@pytest.mark.parametrize("name", SCENES)
def test_dimensions_state_what_they_measure(name: str) -> None:
    """At every scale and in both units, with no factor and no text of their own."""
    sheet, _, drawing = drawn(name)
    found = dimensions(drawing)
    assert len(found) == len(sheet.dimensions)
    for dimension, mark in zip(found, sheet.dimensions, strict=True):
        assert dimension.dxf.text in ("", "<>")
        assert dimension.override().get("dimlfac") == 1.0
        length = dimension.get_measurement()
        assert (length, dimension.dxf.actual_measurement) == pytest.approx(
            (mark.measure / MM_PER[sheet.unit], length), rel=1e-12
        )
        assert isinstance(mark, Distance)
        text = dimension_text(mark, sheet.unit).replace("%%c", "Ø")
        assert printed(dimension) == (text.replace(".", ",") if sheet.comma else text)
        number = float(re.sub(r"[^0-9.].*$", "", text.lstrip("Ø(")))
        assert abs(number - length) <= 0.5 * 10.0**-mark.decimals


def test_bore_and_fits_are_printed() -> None:
    """The style of ezdxf's own set-up would print a bore of 16 as 1600."""
    for name, texts in (
        ("setzhub", {"Ø16 H7", "5 JS9", "18,3", "12"}),
        ("inch", {"Ø0.75 H7", "0.1875 JS9", "0.844", "0.5"}),
        ("bolts", {"6x Ø5"}),
    ):
        assert texts <= {printed(each) for each in dimensions(drawn(name)[2])}


@pytest.mark.parametrize("name", SCENES)
def test_all_is_on_the_paper(name: str) -> None:
    """By the boxes of ezdxf, at the plotted scale; the part keeps its own size and place."""
    sheet, _, drawing = drawn(name)
    unit = sheet.scale * MM_PER[sheet.unit]
    box = extents(drawing.modelspace())
    assert (box.size.x * unit, box.size.y * unit) == pytest.approx((sheet.width, sheet.height))
    frame = extents(drawing.modelspace().query('*[layer=="FRAME"]'))
    for entity in drawing.modelspace():
        if entity.dxf.layer != "GRID":
            own = extents([entity])
            for end in (own.extmin, own.extmax):
                assert frame.inside(end), entity
    outlines = drawing.modelspace().query('LWPOLYLINE[layer=="OUTLINE"]')
    assert len(outlines) == len(product(name).drawn.part.boundaries)


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "capital letters 4 high, 0.3 deep, its middle at radius 20 and 270°"),
        ("de", "Großbuchstaben 4 hoch, 0,3 tief, Mitte auf Radius 20 bei 270°"),
    ],
)
def test_letters_are_drawn_thin_and_noted(language: str, words: str) -> None:
    """They have no dimensions; other sheets do not even have the layer."""
    text = "[[part.engraving]]\nheight = 4\ndepth = 0.3\nradius = 20\nangle = 270\n"
    keys = edited({"language": language})
    plain, engraved = (
        Design(parse_scene(f"{HUBBED}{more}").with_values(keys)).disc for more in ("", text)
    )
    data = WRITER.write(engraved, TOLERANCE).data
    assert WRITER.measure(engraved, data) <= TOLERANCE
    drawing = opened(data)
    letters = [each for each in engraved.drawn.part.boundaries if text_name(each.name)]
    assert len(drawing.modelspace().query('LWPOLYLINE[layer=="ENGRAVING"]')) == len(letters) > 7
    assert drawing.layers.get("ENGRAVING").dxf.lineweight < LAYERS["HIDDEN"][2]
    notes = " ".join(each.dxf.text for each in drawing.modelspace().query("TEXT"))
    assert words in notes
    before = opened(WRITER.write(plain, TOLERANCE).data)
    assert "ENGRAVING" not in before.layers
    assert len(dimensions(drawing)) == len(dimensions(before))


def test_a_changed_dimension_or_edge_is_found() -> None:
    disc, (_, data, _) = product("setzhub"), drawn("setzhub")
    text = data.decode()
    place = text.index("AcDbAlignedDimension")
    start = text.rindex("AcDbDimension", 0, place)
    measure = re.compile(r"\n 42\n([0-9.]+)\n").search(text, start)
    assert measure is not None
    changed = f"{text[: measure.start(1)]}{float(measure[1]) + 0.5}{text[measure.end(1) :]}"
    assert WRITER.measure(disc, changed.encode()) == pytest.approx(0.5)
    own = f"{text[: measure.start()]}\n  1\n16.5{text[measure.start() :]}"
    with pytest.raises(FileError, match=r"has the text '16\.5' instead of what it measures"):
        WRITER.measure(disc, own.encode())
    vertex = re.compile(r"\nOUTLINE\n100\nAcDb.*?\n 10\n([-0-9.]+)\n", re.DOTALL).search(text)
    assert vertex is not None
    moved = f"{text[: vertex.start(1)]}{float(vertex[1]) + 1.0}{text[vertex.end(1) :]}"
    assert WRITER.measure(disc, moved.encode()) > 0.05


def test_curves_of_a_page_are_those_of_the_sheet() -> None:
    """The rim and all other edges lie within a grain of their own arcs, ends and middles alike."""
    (sheet, _, _), disc = drawn("groove"), product("groove")
    (stream,) = streams(PDF.write(disc, TOLERANCE).data)
    wide = re.split(r"[0-9]+ w\n", stream)[-2]  # the frame is wider
    rim = next(each for each in disc.drawn.part.boundaries if each.name == "rim")
    radius = float(np.abs(rim.arcs(TOLERANCE, "fast").contour.vertices[0])) * sheet.scale
    found = np.array(re.findall(" ".join(["(-?[0-9]+)"] * 6) + " c", wide), dtype=np.float64)
    control = (found[:, ::2] + 1j * found[:, 1::2]) * GRAIN - sheet.views[0].origin
    on_rim = np.abs(np.abs(control[:, 2]) - radius) <= GRAIN
    assert np.count_nonzero(on_rim) == 8
    start = np.roll(control[on_rim, 2], 1)[1:]
    first, second, end = control[on_rim].T
    middle = 0.125 * start + 0.375 * (first + second)[1:] + 0.125 * end[1:]
    assert np.abs(middle) == pytest.approx(radius, abs=2.0 * GRAIN)


def test_a_picture_has_the_size_of_the_sheet() -> None:
    data = SVG.write(product("setzhub"), TOLERANCE).data
    assert len(data) < 160_000
    assert SVG.write(product("setzhub"), TOLERANCE).data == data
    root = ET.fromstring(data)
    assert (root.get("width"), root.get("height")) == ("210mm", "297mm")
    box = [float(each) * GRAIN for each in str(root.get("viewBox")).split()]
    assert box == pytest.approx([0.0, 0.0, 210.0, 297.0])
    names = {each.get("id") for each in root.iter() if each.get("id")}
    used = [str(each.get("href"))[1:] for each in root.iter() if each.get("href")]
    assert set(used) == names
    assert len(used) > 5 * len(names)


def test_a_further_sheet_is_a_page_and_is_beside_the_first() -> None:
    """In PDF, SVG and DXF; the part keeps its place."""
    disc = part("hub", 0, sheet="A4", step=5)
    assert len(streams(PDF.write(disc, TOLERANCE).data)) == 2
    root = ET.fromstring(SVG.write(disc, TOLERANCE).data)
    assert root.get("width") == "440mm"  # with 20 mm between them
    data = WRITER.write(disc, TOLERANCE).data
    drawing = opened(data)
    assert extents(drawing.modelspace()).size.x == pytest.approx(440.0)
    assert WRITER.measure(disc, data) <= TOLERANCE
    texts = [each.dxf.text for each in drawing.modelspace().query("TEXT")]
    assert {"1/2", "2/2", "355"} <= set(texts)


def test_lines_have_the_widths_of_one_group() -> None:
    """Group 0.5 of ISO 128: wide and narrow lines 2 : 1; the frame is that of ISO 5457, and letters
    are finer than all else.
    """
    widths = {layer: width for layer, (_, _, width) in LAYERS.items()}
    assert (widths.pop("FRAME"), widths.pop("ENGRAVING"), set(widths.values())) == (
        70,
        18,
        {25, 50},
    )
    wide = {layer for layer, width in widths.items() if width == 50}
    assert wide == {"OUTLINE", "SECTION", "EDGES", "DIAGRAM"}


CROWDED = (
    ("bolts", 30, "A4"),
    pytest.param("hub and bolts", 255, "A3", marks=pytest.mark.long),  # the same with more of both
    pytest.param("hub and bolts", 30, "A3", marks=pytest.mark.long),
)


@pytest.mark.parametrize(("name", "angle", "paper"), CROWDED)
def test_texts_are_where_they_were_placed_and_clear_of_all_dimensions(
    name: str, angle: int, paper: str
) -> None:
    """By the lines and texts that ezdxf draws: nothing goes through what a dimension says."""
    disc = part(name, angle, language="de", sheet=paper)
    (sheet,) = build_sheets(disc, TOLERANCE)
    drawing = opened(WRITER.write(disc, TOLERANCE).data)
    marks = [(view, mark) for view in sheet.views for mark in view.marks
             if isinstance(mark, Distance | Diameter)]  # fmt: skip
    rooms = [room(mark, sheet, view.origin, sheet.scale) for view, mark in marks]
    origin = sheet.views[0].origin
    for own, dimension in zip(rooms, dimensions(drawing), strict=True):
        block = dimension.get_geometry_block()
        assert block is not None
        (text,) = block.query("MTEXT")
        middle = origin + sheet.scale * complex(text.dxf.insert.x, text.dxf.insert.y)
        assert middle == pytest.approx(own.middle, abs=1e-6)
    texts = text_boxes(sheet)
    for dimension in dimensions(drawing):
        block = dimension.get_geometry_block()
        assert block is not None
        for each in block.query("LINE"):
            start, end = (complex(p.x, p.y) for p in (each.dxf.start, each.dxf.end))
            way = line_of(line(start, end, each.dxf.layer), origin, sheet.scale)
            crossing = shapely.intersects(polygons(texts), way)
            assert [own.text for own, across in zip(texts, crossing, strict=True) if across] == []


def test_files_of_a_pair_are_verified() -> None:
    """Each sheet belongs to its disc by its name, and to no other by its content."""
    discs = products("conjugate_lever")
    reading = ReadingOptions("a-drawing.dxf")
    for disc, other in (discs, discs[::-1]):
        assert find_disc(discs, f"{disc.name}-drawing") is disc
        data = WRITER.write(disc, TOLERANCE).data
        assert VERIFIER.origin(data).version
        checks = VERIFIER.checks(disc, data, reading, TOLERANCE)
        assert {each.name for each in checks} == {"unit", "deviation"}
        assert all(each.ok is not False for each in checks)
        wrong = VERIFIER.checks(other, data, reading, TOLERANCE)
        assert any(each.ok is False for each in wrong)


# Pages --------------------------------------------------------------------------------------------
# Pages of a sheet: SVG and PDF draw the same, and that is what the sheet has, grain by grain.


PAGED = ("inch", "bolts")


TOLD = {"m": "moveTo", "l": "lineTo", "c": "curveTo", "h": "closePath"}

SHARES = np.array([0.25, 0.5, 0.75])

Runs = list[tuple[list[complex], list[complex]]]
"""Of each run of lines and curves its ends, and places a quarter, a half and three quarters of the
way along each curve [grains]; y upwards."""


def runs(drawn: Iterable[tuple[str, Any]], at: Callable[[complex], complex]) -> Runs:
    """The runs of what a pen was told."""
    found: Runs = []
    here = 0j
    for told, points in drawn:
        if told == "closePath":
            ends = found[-1][0]
            ends += ends[:1] if ends[-1] != ends[0] else ()
        elif points:
            *own, last = points if told != "arcTo" else points[-1:]
            places = [here, *(complex(*each) for each in own), complex(*last)]
            if told == "moveTo":
                found.append(([], []))
            elif told != "lineTo":
                along = arc_of(here, places[-1], points) if told == "arcTo" else bezier(places)
                found[-1][1].extend(map(at, along))
            here = places[-1]
            found[-1][0].append(at(here))
    return found


def svg_runs(text: str, at: Callable[[complex], complex]) -> Runs:
    """The runs of a path, as fontTools reads it."""
    pen = RecordingPen()
    pen.arcTo = lambda *told: pen.value.append(("arcTo", told))
    parse_path(text, pen)
    return runs(pen.value, at)


def arc_of(start: complex, end: complex, numbers: Sequence[Any]) -> Iterator[complex]:
    """Places along an arc (SVG 2, appendix B.2.4)."""
    radius, _, _, large, positive, _ = numbers
    half = 0.5 * (start - end)
    root = math.sqrt(max(0.0, radius**2 / abs(half) ** 2 - 1.0))
    sign = -1.0 if large == positive else 1.0
    centre = 0.5 * (start + end) + sign * root * complex(half.imag, -half.real)
    turn = float(np.angle((end - centre) / (start - centre))) % (2.0 * math.pi)
    turn = turn if positive else turn - 2.0 * math.pi
    yield from (centre + (start - centre) * np.exp(1j * turn * SHARES)).tolist()


def bezier(points: list[complex]) -> list[complex]:
    """Places along a curve, by de Casteljau's algorithm."""
    rows = [np.full(3, each) for each in points]
    while len(rows) > 1:
        rows = [(1.0 - SHARES) * a + SHARES * b for a, b in pairwise(rows)]
    found: list[complex] = rows[0].tolist()
    return found


def pdf_runs(text: str, at: complex = 0j) -> Runs:
    """The runs of operators m, l, c and h."""
    drawn = []
    for places, word in re.findall(r"((?:-?\d+\s+)*)([mlch])\b", text):
        drawn.append((TOLD[word], np.array(places.split(), dtype=float).reshape(-1, 2).tolist()))
    return runs(drawn, lambda place: at + place)


@cache
def pages(name: str) -> tuple[bytes, bytes]:
    return tuple(each.write(product(name), TOLERANCE).data for each in (SVG, PDF))  # type: ignore[return-value]  # of two


def svg_page(name: str) -> tuple[dict[int, Runs], list[Runs]]:
    """Lines by their widths, and filled outlines in their places."""
    root = ET.fromstring(pages(name)[0])
    high = float(str(root.get("viewBox")).split()[3])

    def upwards(point: complex) -> complex:
        return complex(point.real, high - point.imag)

    lines, shapes, filled = {}, {}, []
    for each in root.iter():
        tag = each.tag.rpartition("}")[2]
        if tag == "path" and each.get("stroke-width"):
            lines[int(each.get("stroke-width", ""))] = svg_runs(each.get("d", ""), upwards)
        elif tag == "path":
            shapes[each.get("id")] = each.get("d", "")
        elif tag == "use":
            at = complex(float(each.get("x", "")), float(each.get("y", "")))
            shape = shapes[each.get("href", "")[1:]]
            filled.append(svg_runs(shape, lambda point, at=at: upwards(point + at)))  # type: ignore[misc]  # bound now
    return lines, filled


def pdf_page(name: str) -> tuple[dict[int, Runs], list[Runs]]:
    (text,) = streams(pages(name)[1])
    across, _, _, up, *_ = map(float, text.split()[:6])
    assert (across, up) == pytest.approx([GRAIN * 72.0 / 25.4] * 2, rel=1e-6)
    lines = {int(width): pdf_runs(own) for width, own in re.findall(r"(\d+) w\n(.*?)\nS", text,
                                                                    re.DOTALL)}  # fmt: skip
    letters = re.findall(r"q 1 0 0 1 (-?\d+) (-?\d+) cm (.*?) f Q", text)
    return lines, [pdf_runs(own, complex(int(x), int(y))) for x, y, own in letters]


@pytest.mark.parametrize("name", PAGED)
def test_both_formats_draw_the_same(name: str) -> None:
    """Ends of lines to the grain; curves of a PDF are cubics, and have more of them."""
    (one, filled), (other, also) = svg_page(name), pdf_page(name)
    assert one.keys() == other.keys()
    for width, runs in one.items():
        assert len(runs) == len(other[width])
        for (ends, along), (cubics, inner) in zip(runs, other[width], strict=True):
            if not along:
                assert ends == cubics
                continue
            everything = np.array([*cubics, *inner])
            for places, off in ((ends, 1.0), (along, 200.0)):
                away = np.abs(everything[:, None] - np.array(places))
                assert np.max(np.min(away, axis=0)) <= off
            circle = circle_of(ends, along)
            if circle is not None:
                middle, radius = circle
                assert np.max(np.abs(np.abs(everything - middle) - radius)) <= 1.5
    assert len(filled) == len(also) > 30
    for letter, same in zip(filled, also, strict=True):
        assert [ends[0] for ends, _ in letter] == [ends[0] for ends, _ in same]
        for (ends, along), (more, inner) in zip(letter, same, strict=True):
            away = np.array([*ends, *along]) - np.array([*more, *inner])
            assert np.max(np.abs(away)) <= 1.5


def circle_of(ends: list[complex], along: list[complex]) -> tuple[complex, float] | None:
    """Middle and radius of a run that is a whole circle of quarters."""
    if len(ends) != 5 or len(along) != 12:
        return None
    middle = complex(np.mean(ends[:4]))
    radii = np.abs(np.array([*ends, *along]) - middle)
    return (middle, float(np.mean(radii))) if np.ptp(radii) <= 3.0 else None


@pytest.mark.parametrize("name", PAGED)
def test_all_chains_of_the_sheet_are_on_the_page(name: str) -> None:
    """Each with its width: as many runs as chains at least, and each vertex, to half a grain."""
    (sheet,) = build_sheets(product(name), TOLERANCE)
    lines, _ = svg_page(name)
    where = {width: Counter(each for ends, _ in runs for each in ends)
             for width, runs in lines.items()}  # fmt: skip
    there = {width: np.array(list(each)) for width, each in where.items()}
    counts: Counter[int] = Counter()
    for mark, at, scale in placed(sheet):
        if isinstance(mark, Chain) and mark.layer != "HIDDEN":
            vertices: ComplexArray = mark.vertices
        elif isinstance(mark, Round):
            vertices = mark.centre + mark.radius * np.exp(0.5j * np.pi * np.arange(4))
        else:
            continue
        width = round(0.01 * LAYERS[mark.layer][2] / GRAIN)
        points = (at + scale * vertices) / GRAIN
        whole = np.rint(points.real) + 1j * np.rint(points.imag)
        if np.ptp(whole.real) or np.ptp(whole.imag):
            counts[width] += 1
            near = np.min(np.abs(there[width][:, None] - points), axis=0)
            assert np.max(near) <= math.sqrt(0.5) + 1e-6
    for width, count in counts.items():
        assert len(lines[width]) >= count
    assert max(lines) == round(0.7 / GRAIN)
    for runs in lines.values():  # a single line does not lead back
        assert all(len(ends) == 2 for ends, along in runs if len(set(ends)) == 2 and not along)


@pytest.mark.parametrize("name", PAGED)
def test_letters_and_arrows_are_where_the_sheet_has_them(name: str) -> None:
    """A text begins, has its middle or ends at its place; what is filled has its own corners."""
    (sheet,) = build_sheets(product(name), TOLERANCE)
    _, filled = svg_page(name)
    corners = [np.array(ends) for runs in filled for ends, _ in runs]
    firsts = np.array([ends[0] for runs in filled for ends, _ in runs])
    for mark, at, scale in placed(sheet):
        if isinstance(mark, Filled):
            wanted = np.array([(at + scale * each) / GRAIN for each in mark.corners])
            assert any(
                len(each) == len(wanted) + 1 and np.max(np.abs(each[:-1] - wanted)) <= 1.0
                for each in corners
            )
        elif isinstance(mark, Label) and mark.text.strip():
            place, size = (at + scale * mark.place) / GRAIN, mark.height / GRAIN
            along = firsts - place
            low, high = {"left": (-0.5, 2.0), "centre": (-2.0, 2.0), "right": (-2.0, 0.5)}[
                mark.across
            ]
            near = (along.real >= low * size) & (along.real <= high * size)
            assert np.any(near & (along.imag > -0.5 * size) & (along.imag < 1.5 * size)), mark
    frame = np.array([sheet.width, sheet.height]) / GRAIN
    assert np.all((firsts.real > 0.0) & (firsts.real < frame[0]))
    assert np.all((firsts.imag > 0.0) & (firsts.imag < frame[1]))


@pytest.mark.parametrize("name", PAGED)
def test_a_pdf_has_its_objects_where_its_table_says(name: str) -> None:
    data = pages(name)[1]
    (sheet,) = build_sheets(product(name), TOLERANCE)
    assert PDF.write(product(name), TOLERANCE).data == data
    assert len(data) < 120_000
    assert b"Date" not in data
    assert data.startswith(b"%PDF-1.4\n%")
    objects = (
        b"/Type /Catalog /Pages 2 0 R",
        b"/Type /Pages /Kids [ 4 0 R ] /Count 1",
        b"/Type /Page /Parent 2 0 R",
        b"/Contents 5 0 R",
        b"<< /Size 6 /Root 1 0 R /Info 3 0 R >>",
    )
    assert [each for each in objects if each not in data] == []
    start = int(data[data.rindex(b"startxref\n") + 10 :].split()[0])
    table = data[start:].decode("ascii")
    assert table.startswith("xref\n0 6\n0000000000 65535 f \n")
    places = [int(each) for each in re.findall(r"(\d{10}) 00000 n \n", table)]
    begun = [data[place : place + 10] for place in places]
    assert begun == [f"{number} 0 obj\n<<".encode() for number in range(1, 6)]
    assert table.endswith("%%EOF\n")
    size = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", data)
    assert size is not None
    paper = [float(each) * 25.4 / 72.0 for each in size.groups()]
    assert paper == pytest.approx([sheet.width, sheet.height], abs=1e-3)
    length = re.search(rb"/Length (\d+) /Filter /FlateDecode >>\nstream\n", data)
    assert length is not None
    assert data[length.end() + int(length[1]) :].startswith(b"\nendstream")
