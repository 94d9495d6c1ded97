"""Every mark of a sheet is one entity of the drawing, where it was placed, as ezdxf reads it."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from ezdxf.document import Drawing
from ezdxf.filemanagement import read as parsed

from camgeo.design.product import Product
from camgeo.pictures.sheet.marks import (
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
    squeeze,
)
from camgeo.pictures.sheet.placing import ARROW, BEFORE, BEHIND, LETTERS, LIFTED
from camgeo.pictures.sheet.sheet import sheets_of
from camgeo.units import MM_PER
from camgeo_export.drawing.writer import LAYERS, RARE, WRITER
from tests.sheet.sheets import TOLERANCE, part, products

Placed = Callable[[complex], complex]

KINDS = ("inch", "groove", "bolts")


@cache
def product(name: str) -> Product:
    if name == "bolts":
        return part("bolts", 30, language="de", sheet="A4")
    return products(name, *{"inch": ("A3", "en"), "groove": ("A4", "en")}[name])[0]


@cache
def drawn(name: str) -> tuple[Sheet, Drawing]:
    (sheet,) = sheets_of(product(name), TOLERANCE)
    data = WRITER.write(product(name), TOLERANCE).data
    return sheet, parsed(io.StringIO(data.decode("utf-8")))


def placed(sheet: Sheet) -> list[tuple[Mark, complex, float]]:
    """Each mark with where its origin is on the paper [mm], and its scale."""
    views = [(mark, view.at, sheet.scale) for view in sheet.views for mark in view.marks]
    return [*views, *((mark, 0j, 1.0) for mark in sheet.marks)]


@pytest.mark.parametrize("name", KINDS)
def test_every_mark_is_an_entity_in_its_place(name: str) -> None:
    """At true size: a millimetre of paper is a unit over the scale."""
    sheet, drawing = drawn(name)
    paper = 1.0 / (sheet.scale * MM_PER[sheet.unit])
    marks, entities = placed(sheet), list(drawing.modelspace())
    assert len(marks) == len(entities)
    for (mark, at, scale), entity in zip(marks, entities, strict=True):

        def there(place: complex, at: complex = at, scale: float = scale) -> complex:
            return (at + scale * complex(place) - sheet.views[0].at) * paper

        check(mark, entity, there, scale * paper, paper)


def place(value: Any) -> complex:
    """Of a vector of ezdxf."""
    x, y, *_ = value
    return complex(x, y)


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
        assert place(dxf.center) == pytest.approx(there(mark.centre), abs=1e-9)
        assert dxf.radius == pytest.approx(mark.radius * size, rel=1e-12)
    elif isinstance(mark, Label):
        assert (kind, dxf.layer, dxf.text, dxf.style) == ("TEXT", mark.layer, mark.text, "CAMGEO")
        assert dxf.height == pytest.approx(mark.height * paper, rel=1e-12)
        assert dxf.get("rotation", 0.0) == pytest.approx(math.degrees(mark.angle), abs=1e-9)
        narrow = NARROWED * squeeze(mark.text, mark.height, mark.width)
        assert dxf.width == pytest.approx(narrow, rel=1e-12)
        assert dxf.get("halign", 0) == {"left": 0, "centre": 1, "right": 2}[mark.across]
        assert dxf.get("valign", 0) == 0
        where = dxf.insert if mark.across == "left" else dxf.align_point
        assert place(where) == pytest.approx(there(mark.at), abs=1e-9)
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
        assert told.get("dimdec") == mark.decimals
        assert told.get("dimpost") == f"{mark.prefix}<>{mark.suffix}"
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
    sheet, drawing = drawn(name)
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
        "dimtxt": LETTERS, "dimasz": ARROW, "dimexe": BEHIND, "dimexo": BEFORE, "dimgap": LIFTED,
        "dimscale": paper, "dimlfac": 1.0,
    }  # fmt: skip
    for key, value in expected.items():
        assert style.get(key) == pytest.approx(value, rel=1e-12)
        assert drawing.header[f"${key.upper()}"] == pytest.approx(value, rel=1e-12)
    words = {
        "dimtxsty": "CAMGEO", "dimdsep": ord("," if sheet.comma else "."), "dimzin": 8,
        "dimlunit": 2, "dimtad": 1, "dimtih": 0, "dimtoh": 0, "dimtix": 1, "dimtofl": 1,
        "dimlwd": 25, "dimlwe": 25,
    }  # fmt: skip
    assert {key: style.get(key) for key in words} == words
    low = -sheet.views[0].at * paper
    high = low + complex(sheet.width, sheet.height) * paper
    for least, most in (("$EXTMIN", "$EXTMAX"), ("$LIMMIN", "$LIMMAX")):
        box = [place(drawing.header[least]), place(drawing.header[most])]
        assert box == pytest.approx([low, high], abs=1e-9)
    (view,) = drawing.viewports.get_config("*Active")
    assert place(view.dxf.center) == pytest.approx(0.5 * (low + high), abs=1e-9)
    side = max((high - low).real, (high - low).imag)
    assert view.dxf.height == pytest.approx(1.05 * side, rel=1e-12)
    assert view.dxf.aspect_ratio == pytest.approx(4.0 / 3.0)
