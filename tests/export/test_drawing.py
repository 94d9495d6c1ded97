"""The sheet as DXF, PDF and SVG, read back with ezdxf and by the page's own operators."""

from __future__ import annotations

import io
import re
import zlib
from functools import cache
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import shapely
from ezdxf.bbox import extents
from ezdxf.document import Drawing
from ezdxf.entities.dimension import Dimension
from ezdxf.entities.mtext import MText
from ezdxf.filemanagement import read as parsed

from camgeo.design.design import Design
from camgeo.design.product import Product, disc_of
from camgeo.design.verify import Reading
from camgeo.errors import FileError
from camgeo.part.spec import text_of
from camgeo.pictures.sheet.marks import Diameter, Distance, line
from camgeo.pictures.sheet.placing import number_of
from camgeo.pictures.sheet.sheet import measured, sheets_of
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import MM_PER
from camgeo_export.drawing.writer import GRAIN, LAYERS, PDF, SVG, WRITER
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
    sheets,
    text_boxes,
)

SCENES = [("setzhub", "A4", "de"), ("groove", "A4", "en"), ("inch", "A3", "en")]

POINT = 25.4 / 72.0
"""Of a PDF [mm]."""


@cache
def written(name: str, size: str, language: str) -> bytes:
    return WRITER.write(products(name, size, language)[0], TOLERANCE).data


@cache
def read(name: str, size: str, language: str) -> Drawing:
    return parsed(io.StringIO(written(name, size, language).decode("utf-8")))


def dimensions(drawing: Drawing) -> list[Dimension]:
    return [each for each in drawing.modelspace() if isinstance(each, Dimension)]


def printed(dimension: Dimension) -> str:
    """What a program without dimensions of its own shows."""
    block = dimension.get_geometry_block()
    assert block is not None
    (text,) = [each for each in block if each.dxftype() in ("TEXT", "MTEXT")]
    found: str = text.text if isinstance(text, MText) else text.dxf.text
    return re.sub(r"\\A1;|\\~", "", found).replace("%%c", "Ø")


@pytest.mark.parametrize("kind", SCENES)
def test_the_sheet_is_measured_and_sound(kind: tuple[str, str, str]) -> None:
    product, data = products(*kind)[0], written(*kind)
    assert WRITER.measure(product, data) <= TOLERANCE
    facts = WRITER.write(product, TOLERANCE).facts
    assert facts["scale"] == ("1:2" if kind[0] == "groove" else "1:1")
    drawing = read(*kind)
    audit = drawing.audit()
    assert not audit.errors
    assert not audit.fixes
    assert {each.dxf.layer for each in drawing.modelspace()} <= set(LAYERS)
    name, size, language = kind
    keys = {**FULL, "sheet": size, "language": language}
    again = Design(load_scene(FIXTURES / "scenes" / f"{name}.toml").with_values(edited(keys)))
    assert WRITER.write(again.disc, TOLERANCE).data == data


@pytest.mark.parametrize("kind", SCENES)
def test_dimensions_state_what_they_measure(kind: tuple[str, str, str]) -> None:
    """At every scale and in both units, with no factor and no text of their own."""
    sheet = sheets(*kind)[0]
    found = dimensions(read(*kind))
    assert len(found) == len(measured(sheet))
    for dimension, mark in zip(found, measured(sheet), strict=True):
        assert dimension.dxf.text in ("", "<>")
        style = dimension.override()
        assert style.get("dimlfac") == 1.0
        length = dimension.get_measurement()
        assert length == pytest.approx(mark.measure / MM_PER[sheet.unit], rel=1e-12)
        assert dimension.dxf.actual_measurement == pytest.approx(length, rel=1e-12)
        assert isinstance(mark, Distance)
        text = number_of(mark, sheet.unit).replace("%%c", "Ø")
        assert printed(dimension) == (text.replace(".", ",") if sheet.comma else text)
        number = float(re.sub(r"[^0-9.].*$", "", text.lstrip("Ø(")))
        assert abs(number - length) <= 0.5 * 10.0**-mark.decimals


def test_bore_and_fits_are_printed() -> None:
    """The style of ezdxf's own set-up would print a bore of 16 as 1600."""
    texts = [printed(each) for each in dimensions(read("setzhub", "A4", "de"))]
    assert {"Ø16 H7", "5 JS9", "18,3", "12"} <= set(texts)
    texts = [printed(each) for each in dimensions(read("inch", "A3", "en"))]
    assert {"Ø0.75 H7", "0.1875 JS9", "0.844", "0.5"} <= set(texts)


@pytest.mark.parametrize("kind", SCENES)
def test_all_is_on_the_paper(kind: tuple[str, str, str]) -> None:
    """By the boxes of ezdxf, at the plotted scale; the part keeps its own size and place."""
    sheet, drawing = sheets(*kind)[0], read(*kind)
    unit = sheet.scale * MM_PER[sheet.unit]
    box = extents(drawing.modelspace())
    assert box.size.x * unit == pytest.approx(sheet.width)
    assert box.size.y * unit == pytest.approx(sheet.height)
    frame = extents(drawing.modelspace().query('*[layer=="FRAME"]'))
    for entity in drawing.modelspace():
        if entity.dxf.layer != "GRID":
            own = extents([entity])
            for end in (own.extmin, own.extmax):
                assert frame.inside(end), entity
    outlines = drawing.modelspace().query('LWPOLYLINE[layer=="OUTLINE"]')
    assert len(outlines) == len(products(*kind)[0].drawn.part.boundaries)


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
    drawing = parsed(io.StringIO(data.decode("utf-8")))
    letters = [each for each in engraved.drawn.part.boundaries if text_of(each.name)]
    assert len(drawing.modelspace().query('LWPOLYLINE[layer=="ENGRAVING"]')) == len(letters) > 7
    assert drawing.layers.get("ENGRAVING").dxf.lineweight < LAYERS["HIDDEN"][2]
    notes = " ".join(each.dxf.text for each in drawing.modelspace().query("TEXT"))
    assert words in notes
    before = parsed(io.StringIO(WRITER.write(plain, TOLERANCE).data.decode("utf-8")))
    assert "ENGRAVING" not in before.layers
    assert len(dimensions(drawing)) == len(dimensions(before))


def test_a_changed_dimension_or_edge_is_found() -> None:
    kind = SCENES[0]
    product, data = products(*kind)[0], written(*kind)
    text = data.decode()
    place = text.index("AcDbAlignedDimension")
    start = text.rindex("AcDbDimension", 0, place)
    measure = re.compile(r"\n 42\n([0-9.]+)\n").search(text, start)
    assert measure is not None
    changed = f"{text[: measure.start(1)]}{float(measure[1]) + 0.5}{text[measure.end(1) :]}"
    assert WRITER.measure(product, changed.encode()) == pytest.approx(0.5)
    own = f"{text[: measure.start()]}\n  1\n16.5{text[measure.start() :]}"
    with pytest.raises(FileError, match=r"has the text '16\.5' instead of what it measures"):
        WRITER.measure(product, own.encode())
    vertex = re.compile(r"\nOUTLINE\n100\nAcDb.*?\n 10\n([-0-9.]+)\n", re.DOTALL).search(text)
    assert vertex is not None
    moved = f"{text[: vertex.start(1)]}{float(vertex[1]) + 1.0}{text[vertex.end(1) :]}"
    assert WRITER.measure(product, moved.encode()) > 0.05


def streams(data: bytes) -> list[str]:
    """The operators of each page of a PDF."""
    found = re.findall(rb"stream\n(.*?)\nendstream", data, re.DOTALL)
    return [zlib.decompress(each).decode("ascii") for each in found]


def test_a_page_has_the_true_size() -> None:
    """The frame of an A4 sheet is 180 mm by 277 mm, and a stretch of 100 mm is 100 mm long."""
    product = products("setzhub", "A4", "de")[0]
    data = PDF.write(product, TOLERANCE).data
    assert PDF.write(product, TOLERANCE).data == data
    assert b"Date" not in data
    assert len(data) < 120_000
    media = re.search(rb"/MediaBox \[ ?([0-9. ]+)\]", data)
    assert media is not None
    size = [float(each) * POINT for each in media[1].split()][2:]
    assert size == pytest.approx([210.0, 297.0], abs=0.02)
    (stream,) = streams(data)
    grain = float(stream.split()[0]) * POINT
    assert grain == pytest.approx(GRAIN, rel=1e-6)
    widths = re.split(r"([0-9]+) w\n", stream)
    widest = max(range(1, len(widths), 2), key=lambda k: float(widths[k]))
    assert float(widths[widest]) * grain == pytest.approx(0.7)
    ends = re.findall(r"([0-9-]+) ([0-9-]+) [ml]\b", widths[widest + 1].partition("S\n")[0])
    points = np.array(ends, dtype=np.float64) * grain
    frame = points.max(axis=0) - points.min(axis=0)
    # with the centring marks, 5 mm long on each side
    assert frame == pytest.approx([190.0, 287.0], abs=GRAIN)


def test_curves_of_a_page_are_those_of_the_sheet() -> None:
    """The rim and all other edges lie within a grain of their own arcs, ends and middles alike."""
    product = products("groove", "A4", "en")[0]
    (stream,) = streams(PDF.write(product, TOLERANCE).data)
    sheet = sheets("groove", "A4", "en")[0]
    wide = re.split(r"[0-9]+ w\n", stream)[-2]  # the frame is wider
    rim = next(each for each in product.drawn.part.boundaries if each.name == "rim")
    radius = float(np.abs(rim.arcs(TOLERANCE, "fast").contour.vertices[0])) * sheet.scale
    found = np.array(re.findall(" ".join(["(-?[0-9]+)"] * 6) + " c", wide), dtype=np.float64)
    control = (found[:, ::2] + 1j * found[:, 1::2]) * GRAIN - sheet.views[0].at
    on_rim = np.abs(np.abs(control[:, 2]) - radius) <= GRAIN
    assert np.count_nonzero(on_rim) == 8
    start = np.roll(control[on_rim, 2], 1)[1:]
    first, second, end = control[on_rim].T
    middle = 0.125 * start + 0.375 * (first + second)[1:] + 0.125 * end[1:]
    assert np.abs(middle) == pytest.approx(radius, abs=2.0 * GRAIN)


def test_a_picture_has_the_size_of_the_sheet() -> None:
    product = products("setzhub", "A4", "de")[0]
    data = SVG.write(product, TOLERANCE).data
    assert len(data) < 160_000
    assert SVG.write(product, TOLERANCE).data == data
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
    product = part("hub", 0, sheet="A4", step=5)
    pages = streams(PDF.write(product, TOLERANCE).data)
    assert len(pages) == 2
    root = ET.fromstring(SVG.write(product, TOLERANCE).data)
    assert root.get("width") == "440mm"  # with 20 mm between them
    data = WRITER.write(product, TOLERANCE).data
    drawing = parsed(io.StringIO(data.decode("utf-8")))
    box = extents(drawing.modelspace())
    assert box.size.x == pytest.approx(440.0)
    assert WRITER.measure(product, data) <= TOLERANCE
    texts = [each.dxf.text for each in drawing.modelspace().query("TEXT")]
    assert {"1/2", "2/2", "355"} <= set(texts)


def test_lines_have_the_widths_of_one_group() -> None:
    """Group 0.5 of ISO 128: wide and narrow lines 2 : 1; the frame is that of ISO 5457, and letters
    are finer than all else.
    """
    widths = {layer: width for layer, (_, _, width) in LAYERS.items()}
    assert widths.pop("FRAME") == 70
    assert widths.pop("ENGRAVING") == 18
    assert set(widths.values()) == {25, 50}
    wide = {layer for layer, width in widths.items() if width == 50}
    assert wide == {"OUTLINE", "SECTION", "EDGES", "DIAGRAM"}


@cache
def featured(name: str, angle: int, sheet: str = "A4") -> Product:
    """A disc with some features, in German."""
    return part(name, angle, language="de", sheet=sheet)


def test_the_number_of_holes_stands_before_their_diameter() -> None:
    product = featured("bolts", 30)
    drawing = parsed(io.StringIO(WRITER.write(product, TOLERANCE).data.decode("utf-8")))
    (found,) = (each for each in dimensions(drawing) if "6x" in printed(each))
    assert printed(found) == "6x Ø5"
    assert found.dxf.text == "<>"
    assert found.override().get("dimpost") == "6x %%c<>"


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
    product = featured(name, angle, paper)
    (sheet,) = sheets_of(product, TOLERANCE)
    drawing = parsed(io.StringIO(WRITER.write(product, TOLERANCE).data.decode("utf-8")))
    marks = [(view, mark) for view in sheet.views for mark in view.marks
             if isinstance(mark, Distance | Diameter)]  # fmt: skip
    rooms = [room(mark, sheet, view.at, sheet.scale) for view, mark in marks]
    origin = sheet.views[0].at
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
            ends = (complex(p.x, p.y) for p in (each.dxf.start, each.dxf.end))
            way = line_of(line(*ends, each.dxf.layer), origin, sheet.scale)
            crossing = shapely.intersects(polygons(texts), way)
            assert [own.text for own, across in zip(texts, crossing, strict=True) if across] == []


def test_files_of_a_pair_are_verified() -> None:
    """Each sheet belongs to its disc by its name, and to no other by its content."""
    discs = products("conjugate_lever")
    reading = Reading("a-drawing.dxf")
    for disc, other in (discs, discs[::-1]):
        assert disc_of(discs, f"{disc.name}-drawing") is disc
        data = WRITER.write(disc, TOLERANCE).data
        assert VERIFIER.origin(data).version
        checks = VERIFIER.checks(disc, data, reading, TOLERANCE)
        assert {each.name for each in checks} == {"unit", "deviation"}
        assert all(each.ok is not False for each in checks)
        wrong = VERIFIER.checks(other, data, reading, TOLERANCE)
        assert any(each.ok is False for each in wrong)
