"""What a part is called comes through every format, in the characters that each can hold."""

from __future__ import annotations

import io
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable
from dataclasses import astuple
from typing import Any

import ezdxf
import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo.design.design import Design
from camgeo.design.product import title_of
from camgeo.design.verify import Verifier
from camgeo.errors import SceneError
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.gcode.comments import ascii_of, stated
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.svg import WRITER as SVG
from camgeo_export.table import WRITER as CSV
from camgeo_export.threemf.writer import MODEL_PATH
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.dxf import VERIFIER as DXF_VERIFIER
from camgeo_export.verify.step import VERIFIER as STEP_VERIFIER
from camgeo_export.verify.svg import VERIFIER as SVG_VERIFIER
from camgeo_export.verify.threemf import VERIFIER as THREEMF_VERIFIER
from tests.export.stub_product import StubProduct, StubScene
from tests.export.verified import TOLERANCE, faults

TITLE = "Nockenhebel für Ø8"

SCENE = """
camgeo = 1
name = "lever"
cam = { rotation = "ccw" }
follower = { kind = "translating-roller", base_radius = 50, roller_radius = 10 }
motion = [{ dwell = 360 }]
part = { thickness = 12, bore = 25 }
"""


def titled(title: str = TITLE) -> Design:
    return camgeo.loads(f'{SCENE}drawing.title = "{title}"\n')


def called(title: str) -> StubProduct:
    scene: Any = StubScene(DrawingSpec(title=title))
    return StubProduct(scene=scene)


def of_dxf(data: bytes) -> str:
    document = ezdxf.read(io.StringIO(data.decode()))  # type: ignore[attr-defined] # not exported
    return dict(document.header.custom_vars)["title"]


def of_svg(data: bytes) -> str:
    return ET.fromstring(data).findtext("{http://www.w3.org/2000/svg}title") or ""


def of_3mf(data: bytes) -> str:
    """By lib3mf, and by the XML of the package."""
    lib3mf: Any = pytest.importorskip("lib3mf")
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromBuffer(data)
    objects = model.GetMeshObjects()
    assert objects.MoveNext()
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        assert TITLE in package.read(MODEL_PATH).decode("utf-8")
    name: str = objects.GetCurrentMeshObject().GetName()
    return name


def of_step(data: bytes) -> str:
    """ISO 10303-21, 6.4.3.3: characters beyond ASCII in the form of UTF-16."""
    text = data.decode("ascii")
    name = text.partition("PRODUCT('")[2].partition("'")[0]
    head, *coded = name.split("\\X2\\")
    for part in coded:
        digits, _, rest = part.partition("\\X0\\")
        head += bytes.fromhex(digits).decode("utf-16-be") + rest
    return head


@pytest.mark.parametrize(("writer", "verifier", "read"), [
    (DXF, DXF_VERIFIER, of_dxf), (SVG, SVG_VERIFIER, of_svg), (THREEMF, THREEMF_VERIFIER, of_3mf),
    (STEP, STEP_VERIFIER, of_step),
])  # fmt: skip
def test_the_title_comes_through(
    writer: Any, verifier: Verifier, read: Callable[[bytes], str]
) -> None:
    product = titled().disc
    assert (product.name, title_of(product)) == ("lever", TITLE)
    data = writer.write(product, TOLERANCE).data
    assert read(data) == TITLE
    assert faults(verifier, product, data) == []


@pytest.mark.parametrize("writer", [DXF, SVG, STEP, CSV])
def test_without_a_title_files_have_the_name(writer: Any) -> None:
    """To the last byte those of a drawing whose title is the name; but the hash is another."""
    plain, named = camgeo.loads(SCENE).disc, titled("lever").disc
    assert title_of(plain) == "lever"
    data = [writer.write(each, TOLERANCE).data.replace(each.scene_hash.encode(), b"")
            for each in (plain, named)]  # fmt: skip
    assert data[0] == data[1]


def test_a_program_spells_it_in_ascii() -> None:
    data = GCODE.write(called("Nockenhebel für Ø8 (links)"), TOLERANCE).data
    assert "(title Nockenhebel fuer dia. 8 [links])" in data.decode("ascii").splitlines()


def test_a_title_states_nothing_of_a_program() -> None:
    """Whatever it says: what the comments state comes first."""
    plain = GCODE.write(StubProduct(), TOLERANCE).data.decode()
    spoof = "scene abcdef, camgeo 9.9, tolerance 5 mm"
    told = GCODE.write(called(spoof), TOLERANCE).data.decode()
    notes = [
        [line.strip("()") for line in text.splitlines() if line.startswith("(")]
        for text in (plain, told)
    ]
    assert astuple(stated(notes[0])) == astuple(stated(notes[1]))


def test_the_table_is_utf8_and_its_own_headings_are_ascii() -> None:
    assert CSV.write(titled().disc, TOLERANCE).data.decode("utf-8").isascii()


@pytest.mark.parametrize(("text", "plain"), [
    ("Größe ±0,02 µm × 90°", "Groesse +-0,02 um x 90 deg"), ("came à galet", "came a galet"),
    ("Kurvenscheibe Å – ⌀8", "Kurvenscheibe Aa - dia. 8"), ("カム", "??"), ("u\u0308", "ue"),
])  # fmt: skip
def test_how_characters_are_spelled(text: str, plain: str) -> None:
    assert ascii_of(text) == plain


@given(st.text())
def test_everything_is_spelled_in_ascii(text: str) -> None:
    found = ascii_of(text)
    assert found.isascii()
    if text.isascii():
        assert found == text


def test_no_title_has_characters_that_xml_cannot_hold() -> None:
    for title in ("a\ufffe", "a\uffff", "a\tb"):
        with pytest.raises(SceneError, match=r"drawing\.title"):
            camgeo.Scene({**camgeo.loads(SCENE).scene.values, "drawing": {"title": title}})


def test_a_return_disc_is_told_apart() -> None:
    from tests.effects.scenes import SCENES

    text = (SCENES / "conjugate_lever.toml").read_text("utf-8")
    design = camgeo.loads(f'{text}\n[drawing]\ntitle = "{TITLE}"\n')
    assert [title_of(disc) for disc in design.discs] == [TITLE, f"{TITLE} (return)"]
