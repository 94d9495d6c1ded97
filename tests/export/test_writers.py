"""What holds for the files of all writers, and for opticurv's: they are read back, name the part,
and keep limits.
"""

from __future__ import annotations

import io
import json
import math
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import astuple, replace
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf.filemanagement
import lib3mf  # type: ignore[import-untyped]  # has no types
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo import reading
from camgeo.app.cli.import_ import import_project
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import Product, display_title
from camgeo.design.writing import Writer, make_files
from camgeo.errors import FileError, SceneError
from camgeo.milling import plan, walk
from camgeo.numeric.arrays import FloatArray
from camgeo.part.spec import text_name
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.scene.formats.dxf import ENTITIES, DxfSpec, Entity
from camgeo.scene.formats.step import StepSpec
from camgeo.scene.scene import parse_scene
from camgeo.units import LengthUnit
from camgeo_export import part21
from camgeo_export import svg as svg_writer
from camgeo_export.dxf import reader as dxf_reader
from camgeo_export.dxf import writer as dxf_writer
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.gcode import writer as gcode_writer
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.gcode.writer import to_ascii
from camgeo_export.part21 import Extrusion, Solid, read_exchange
from camgeo_export.solid import prism
from camgeo_export.step import writer as step_writer
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.svg import WRITER as SVG
from camgeo_export.table import ASC_SECOND as SECOND
from camgeo_export.table import ASC_WRITER as WRITER
from camgeo_export.table import COLUMNS, POINTS, AscWriter
from camgeo_export.table import WRITER as CSV
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify import stl, threemf
from camgeo_export.verify.gcode import parse_notes
from camgeo_export.verify.threemf import MODEL_PATH, unpack_parts
from tests.export.stub_product import PIECES, StubProduct, StubScene
from tests.export.test_solids import ENGRAVED
from tests.export.verified import TOLERANCE, measured, read_back
from tests.inches import in_inches
from tests.reference import THESIS_CAMS, pitch_curve_of, reference, thesis_params

UNITS: tuple[LengthUnit, ...] = ("mm", "inch")

DISC, GROOVE = StubProduct(), StubProduct(groove=True)

DRAWN = {
    "disc": DISC,
    "inch": StubProduct(unit="inch"),
    "groove": GROOVE,
    "polyline": StubProduct(dxf=DxfSpec("polyline")),
    "large": StubProduct(scale=1e4),
}


READ_BACK: dict[str, tuple[Writer, Product, tuple[float, ...]]] = {
    **{f"dxf, {name}": (DXF, each, (0.05, 1e-3)) for name, each in DRAWN.items()},
    "dxf, single": (DXF, replace(GROOVE, dxf=DxfSpec("lines-and-arcs")), (0.05, 1e-3)),
    "dxf, cut only": (DXF, StubProduct(dxf=DxfSpec(auxiliary=False)), (0.05, 1e-3, 1e-7)),
    **{f"svg, {name}": (SVG, each, (0.05, 1e-3)) for name, each in DRAWN.items()},
    "svg, finest": (SVG, DISC, (1e-7,)),
    **{f"gcode, {unit}": (GCODE, StubProduct(unit=unit), (0.05, 0.01, 1e-3, 1e-6))
       for unit in UNITS},
    **{f"{writer.format.name}, {name}": (writer, replace(each, unit="inch"), (0.05, 1e-3))
       for writer in (STL, THREEMF) for name, each in (("disc", DISC), ("groove", GROOVE))},
    "3mf, finest": (THREEMF, DISC, (1e-5,)),
    **{f"step, {name}, {unit}": (STEP, replace(each, unit=unit), (TOLERANCE,))
       for name, each in (("disc", DISC), ("groove", GROOVE)) for unit in UNITS},
    **{f"{writer.format.name}, engraved": (writer, StubProduct(given=ENGRAVED, unit="inch"),
       (TOLERANCE,)) for writer in (DXF, SVG, STL, THREEMF, STEP)},
}  # fmt: skip
"""Writers and products, and tolerances [mm]."""


@pytest.mark.parametrize(
    ("name", "tolerance"), [(name, each) for name, row in READ_BACK.items() for each in row[2]]
)
def test_what_is_written_is_read_back_and_the_same_each_time(name: str, tolerance: float) -> None:
    writer, product, _ = READ_BACK[name]
    written = read_back(writer, product, tolerance)
    assert writer.write(product, tolerance).data == written.data


@pytest.mark.parametrize("writer", [DXF, SVG, GCODE, STL, THREEMF, STEP, CSV])
def test_the_file_of_another_design_is_measured_as_wrong(writer: Writer) -> None:
    """What is 1% larger is off by that, 32 mm from a middle that is 5 mm off the cam axis."""
    written = writer.write(StubProduct(scale=1.01), TOLERANCE)
    assert 0.3 < measured(writer, DISC, written.data) < 0.7
    assert all(isinstance(value, int | float | str) for value in written.facts.values())


# Engraved parts -----------------------------------------------------------------------------------


@pytest.mark.parametrize("entity", ENTITIES)
def test_letters_are_on_layers_of_their_depth(entity: Entity) -> None:
    """A laser would cut through what is on layer CUT."""
    product = StubProduct(given=ENGRAVED, dxf=DxfSpec(entity))
    data = read_back(DXF, product).data
    space = ezdxf.filemanagement.read(io.StringIO(data.decode("utf-8"))).modelspace()
    assert {"CUT", "BLIND_0.3", "BLIND_0.5"} <= {each.dxf.layer for each in space}
    if entity in ("arcs", "polyline"):
        letters = [each for each in ENGRAVED.boundaries if text_name(each.name)]
        blind = [each for each in space if each.dxf.layer.startswith("BLIND")]
        assert len(blind) == len(letters)


def test_walls_of_letters_are_splines_where_step_files_have_splines() -> None:
    product = StubProduct(given=ENGRAVED, step=StepSpec("spline"))
    data = read_back(STEP, product).data
    curved = sum(
        len(each.spline(TOLERANCE).contour.splines)
        for each in ENGRAVED.boundaries
        if text_name(each.name)
    )
    found = Solid.from_bytes(data)
    assert sum(isinstance(each.surface, Extrusion) for each in found.faces) >= curved


# What a part is called, in the characters that each format can hold -------------------------------


TITLE = "Nockenhebel für Ø8"

LEVER = """
camgeo = 1
name = "lever"
cam = { rotation = "ccw" }
follower = { kind = "translating-roller", base_radius = 50, roller_radius = 10 }
motion = [{ dwell = 360 }]
part = { thickness = 12, bore = 25 }
"""


def titled(title: str) -> Product:
    return camgeo.loads(f'{LEVER}drawing.title = "{title}"\n').disc


def called(title: str) -> StubProduct:
    scene: Any = StubScene(DrawingSpec(title=title))
    return StubProduct(scene=scene)


def of_dxf(data: bytes) -> str:
    document = ezdxf.filemanagement.read(io.StringIO(data.decode()))
    return dict(document.header.custom_vars)["title"]


def of_svg(data: bytes) -> str:
    return ET.fromstring(data).findtext("{http://www.w3.org/2000/svg}title") or ""


def of_3mf(data: bytes) -> str:
    """Of the one body, by lib3mf, and in the XML of the package."""
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromBuffer(data)
    objects = model.GetMeshObjects()
    assert objects.MoveNext()
    assert TITLE in unpack_parts(data)[MODEL_PATH].decode("utf-8")
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


@pytest.mark.parametrize(
    ("writer", "read"), [(DXF, of_dxf), (SVG, of_svg), (THREEMF, of_3mf), (STEP, of_step)]
)
def test_the_title_comes_through(writer: Writer, read: Callable[[bytes], str]) -> None:
    product = titled(TITLE)
    assert (product.name, display_title(product)) == ("lever", TITLE)
    assert read(read_back(writer, product, least=0.0).data) == TITLE


@pytest.mark.parametrize("writer", [DXF, SVG, STEP, CSV])
def test_without_a_title_files_have_the_name(writer: Any) -> None:
    """To the last byte those of a drawing whose title is the name; but the hash is another."""
    plain, named = camgeo.loads(LEVER).disc, titled("lever")
    assert display_title(plain) == "lever"
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
    assert astuple(parse_notes(notes[0])) == astuple(parse_notes(notes[1]))


def test_the_table_is_utf8_and_its_own_headings_are_ascii() -> None:
    assert CSV.write(titled(TITLE), TOLERANCE).data.decode("utf-8").isascii()


@pytest.mark.parametrize(("text", "plain"), [
    ("Größe ±0,02 µm × 90°", "Groesse +-0,02 um x 90 deg"), ("came à galet", "came a galet"),
    ("Kurvenscheibe Å – ⌀8", "Kurvenscheibe Aa - dia. 8"), ("カム", "??"), ("u\u0308", "ue"),
])  # fmt: skip
def test_how_characters_are_spelled(text: str, plain: str) -> None:
    assert to_ascii(text) == plain


@given(st.text())
def test_everything_is_spelled_in_ascii(text: str) -> None:
    found = to_ascii(text)
    assert found.isascii()
    if text.isascii():
        assert found == text


@pytest.mark.parametrize("title", ["a\ufffe", "a\uffff", "a\tb"])
def test_no_title_has_characters_that_xml_cannot_hold(title: str) -> None:
    with pytest.raises(SceneError, match=r"drawing\.title"):
        camgeo.Scene({**camgeo.loads(LEVER).scene.values, "drawing": {"title": title}})


def test_a_return_disc_is_told_apart() -> None:
    from tests.effects.scenes import SCENES

    text = (SCENES / "conjugate_lever.toml").read_text("utf-8")
    design = camgeo.loads(f'{text}\n[drawing]\ntitle = "{TITLE}"\n')
    assert [display_title(disc) for disc in design.discs] == [TITLE, f"{TITLE} (return)"]


# What would not be read back is not written -------------------------------------------------------


SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml"


@pytest.mark.parametrize(
    ("name", "module", "limit", "message"),
    [
        ("stl", prism, "FACETS", "stl: the body would have at least "),
        ("3mf", prism, "FACETS", "3mf: the body would have at least "),
        ("step", step_writer, "INSTANCES", "step: the solid would have walls of "),
        ("dxf", dxf_writer, "DRAWING_LINES", "dxf: the drawing would have "),
        ("gcode", plan, "PROGRAM_LINES", "gcode: the program would have more than 200,000 lines"),
        ("gcode", walk, "PROGRAM_LINES", "gcode: the program would have more than 200,000 lines"),
        ("gcode", gcode_writer, "PROGRAM_LINES", "gcode: the program would have more than 200,000"),
    ],
)
def test_a_file_that_would_not_be_read_is_refused_before_anything_is_written(
    name: str,
    module: object,
    limit: str,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(module, limit, 1 if module is gcode_writer else 20)
    assert main(["build", str(SCENE), "-o", str(tmp_path / "out"), "--only", name]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "a larger tolerance" in said
    assert not (tmp_path / "out").exists()


def test_walls_within_the_limit_may_have_faces_beyond_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prism, "FACETS", 100)
    mesh = prism._Mesh()
    mesh.points = [np.zeros((3, 3))]
    mesh.faces = [np.zeros((101, 3), dtype=np.intp)]
    with pytest.raises(FileError, match="would have 101 facets; at most 100"):
        mesh.close()


def test_the_largest_body_is_within_all_other_limits() -> None:
    """A closed surface has half as many vertices as facets, and two more for each of its parts."""
    vertices, digits = reading.FACETS // 2 + 100, 24
    elements = reading.FACETS + vertices + 100
    assert elements <= threemf.ELEMENTS
    assert 3 * elements <= threemf.ATTRIBUTES
    vertex = len('<vertex x="" y="" z="" />') + 3 * digits
    facet = len('<triangle v1="" v2="" v3="" />') + 3 * len(str(vertices))
    model = vertices * vertex + reading.FACETS * facet
    assert model <= threemf.UNPACKED
    assert stl.STL.size >= 84 + 50 * reading.FACETS


def test_the_largest_solid_is_within_all_other_limits() -> None:
    """Of a cam with thousands of pieces, an entity takes 52 bytes, and 5 commas and brackets."""
    data = STEP.write(StubProduct(), 0.01).data
    entities = data.count(b"\n#")
    assert part21.STEP.size >= 1.2 * len(data) / entities * reading.INSTANCES
    marks = data.count(b",") + data.count(b"(")
    assert 1.05 * marks / entities * reading.INSTANCES <= part21.PARAMETERS


COARSE = 0.05

FACETS = int(STL.write(DISC, COARSE).facts["triangles"])


def squares(count: int) -> bytes:
    """An SVG of so many contours of four lines."""
    body = "".join(f'<path d="M{9 * k} 0h5v5h-5z"/>' for k in range(count))
    head = 'xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm" viewBox="0 0 9 9"'
    return f"<svg {head}>{body}</svg>".encode()


STEPPED = STEP.write(DISC, COARSE).data


def read_step() -> None:
    read_exchange(STEPPED)


def read_drawing() -> None:
    dxf_reader.read_drawing(DXF.write(DISC, COARSE).data).contours("CUT")


LIMITS: dict[str, tuple[object, str, int, Callable[[], object], str]] = {
    # Outline, bore and pitch curve, of four lines of text for each piece.
    "dxf": (dxf_writer, "DRAWING_LINES", 4 * 3 * PIECES,
            lambda: DXF.write(DISC, COARSE), "36 pieces of at least 4 lines"),
    "contours of a dxf": (dxf_reader, "CONTOURS", 2, read_drawing, "2 closed contours"),
    "svg": (svg_writer, "SVG_PIECES", 2 * PIECES,
            lambda: SVG.write(DISC, COARSE), "would have 24 pieces"),
    "contours of an svg": (svg_writer, "CONTOURS", 5, lambda: svg_writer.read_drawing(squares(5)),
                           "5 closed contours"),
    "pieces of an svg": (svg_writer, "SVG_PIECES", 20, lambda: svg_writer.read_drawing(squares(5)),
                         "20 lines and arcs"),
    "entities of a step": (part21, "INSTANCES", STEPPED.count(b"\n#"), read_step,
                           "more entities"),
    "marks of a step": (part21, "PARAMETERS", STEPPED.count(b",") + STEPPED.count(b"("),
                        read_step, "commas and brackets"),
    "header of a step": (part21, "RECORDS", 3, read_step, "more than 2 records"),
    "lists of a step": (part21, "NESTED", 2, read_step, "nested more than 1 deep"),
    "step": (step_writer, "INSTANCES", 20 * 2 * PIECES,
             lambda: STEP.write(DISC, COARSE), "walls of 24 pieces"),
    "stl": (prism, "FACETS", FACETS, lambda: STL.write(DISC, COARSE), f"{FACETS:,} facets"),
}  # fmt: skip


@pytest.mark.parametrize("name", LIMITS)
def test_as_much_as_a_limit_allows_and_no_more(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module, limit, most, make, message = LIMITS[name]
    monkeypatch.setattr(module, limit, most)
    make()
    monkeypatch.setattr(module, limit, most - 1)
    with pytest.raises(FileError, match=message):
        make()


# The point files: the columns of opticurv's source in their order, with correct values ------------


FIXTURES = Path(__file__).parents[2] / "fixtures"


def imported(name: str) -> str:
    """The scene of a project."""
    data = (FIXTURES / "reference" / "ocv" / f"{name}.ocv").read_bytes()
    return import_project(data, name)


@cache
def design(name: str) -> Product:
    """The cam of a project."""
    return Design(parse_scene(imported(name))).disc


def numbers(data: bytes) -> FloatArray:
    """(n, k) what a file holds, read without the writer."""
    return np.array([[float(cell) for cell in row.split(",")] for row in data.decode().split()])


@pytest.mark.parametrize("name", THESIS_CAMS)
@pytest.mark.parametrize("writer", [WRITER, SECOND], ids=["1", "2"])
def test_a_file_reads_back_to_the_bit(name: str, writer: AscWriter) -> None:
    product = design(name)
    written = writer.write(product, 0.001)
    assert writer.measure(product, written.data) == 0.0
    assert written.facts == {"rows": 720, "columns": len(writer.columns)}
    assert numbers(written.data).shape == (720, len(writer.columns))
    assert written.data == writer.write(product, 0.001).data
    assert written.data.endswith(b"\n")
    for odd in (b"\r", b" ", b"nan", b"-0,", b"-0\n"):
        assert odd not in written.data


def test_the_columns_stand_as_in_the_source() -> None:
    """Source lines 1417 to 1432 and 1436 to 1441."""
    assert (
        *("phi", "s", "psi", "psi_rad", "psi'", "psi''", "x_Bik", "y_Bik", "x_i_vers", "y_i_vers"),
        *("x_B_vers", "y_B_vers", "x_a_vers", "y_a_vers", "mue", "r_K"),
    ) == COLUMNS
    assert COLUMNS[8:14] == POINTS
    assert (WRITER.format.suffix, SECOND.format.suffix) == ("1.asc", "2.asc")
    assert WRITER.companions == (SECOND,)
    first, second = (numbers(each.write(design("setzhub"), 1.0).data) for each in (WRITER, SECOND))
    assert np.array_equal(first[:, 8:14], second)


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_the_values_are_those_of_the_mechanism(name: str) -> None:
    """Against the geometry itself: closed triangle, roller on the rocker, offset by the roller."""
    product = design(name)
    params = reference("thesis_examples.toml")[THESIS_CAMS[name]]["params"]
    values = dict(zip(COLUMNS, numbers(WRITER.write(product, 1.0).data).T, strict=True))
    assert np.array_equal(values["phi"], 0.5 * np.arange(720))
    cam = values["x_B_vers"] + 1j * values["y_B_vers"]
    axis = complex(params["x_A0"], params["y_A0"])
    # 16 roundings of lengths below 512 mm.
    close = 16.0 * 2.0**-53 * 512.0
    assert abs(values["x_Bik"] + 1j * values["y_Bik"] - cam - axis).max() < close
    # The disc turned clockwise by phi brings the roller centre onto the rocker; the pivot is 0.
    fixed = axis + cam * np.exp(-1j * np.radians(values["phi"]))
    assert abs(abs(fixed) - params["l_3"]).max() < close
    swing = np.degrees(np.unwrap(np.angle(fixed / fixed[0])))
    assert abs(swing - values["psi"]).max() < 1e-11
    assert np.array_equal(values["psi_rad"], np.radians(values["psi"]))
    for flank, side in (("i", 1.0), ("a", -1.0)):
        point = values[f"x_{flank}_vers"] + 1j * values[f"y_{flank}_vers"]
        assert abs(abs(point - cam) - params["r_R"]).max() < close
        # In the cam's frame the pitch curve runs counter-clockwise: the inner flank is to its left.
        along = np.roll(cam, -1) - np.roll(cam, 1)
        assert np.all(side * ((point - cam) * along.conj()).imag > 0.0)


@pytest.mark.parametrize("name", THESIS_CAMS)
def test_the_values_are_those_of_the_formulas(name: str) -> None:
    product = design(name)
    curve = pitch_curve_of(thesis_params(THESIS_CAMS[name], -1))
    values = dict(zip(COLUMNS, numbers(WRITER.write(product, 1.0).data).T, strict=True))
    phi = np.radians(values["phi"])
    jet = curve.motion.jet(phi)
    assert np.array_equal(values["psi'"], jet[1] + 0.0)
    assert np.array_equal(values["psi''"], jet[2] + 0.0)
    assert np.array_equal(values["mue"], np.degrees(curve.transmission_angle(phi)))
    assert np.array_equal(1.0 / values["r_K"], 1.0 / (1.0 / curve.curvature(phi)))


def test_another_unit_changes_nothing_but_roundings() -> None:
    inch = in_inches(parse_scene(imported("vorschub")))
    product = Design(parse_scene(inch)).disc
    for writer in (WRITER, SECOND):
        data = writer.write(product, 1.0).data
        assert writer.measure(product, data) == 0.0
        there, here = numbers(writer.write(design("vorschub"), 1.0).data), numbers(data)
        assert abs(there - here).max() < 1e-10


def moved(place: int, by: float) -> bytes:
    """The file with a value of one row changed."""
    data = WRITER.write(design("setzhub"), 1.0).data
    rows = [line.split(",") for line in data.decode().splitlines()]
    rows[300][place] = repr(float(rows[300][place]) + by)
    return "\n".join(map(",".join, rows)).encode()


@pytest.mark.parametrize(("place", "off"), [(1, 0.25), (6, 0.5), (7, 0.125), (8, 0.25), (13, 0.5)])
def test_a_changed_length_is_measured(place: int, off: float) -> None:
    assert WRITER.measure(design("setzhub"), moved(place, off)) == pytest.approx(off)


@pytest.mark.parametrize("place", [0, 2, 3, 4, 5, 14, 15])
def test_a_changed_angle_ratio_or_radius_is_refused(place: int) -> None:
    with pytest.raises(FileError, match="angles, ratios or radii differ"):
        WRITER.measure(design("setzhub"), moved(place, 1e-9))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"0,0,0,0,0,0,", b"0,0,0,0,0,", "does not have this scene's columns and rows"),
        (b"0,0,0,0,0,0,", b"zero,0,0,0,0,0,", "not a number"),
        (b"0,0,0,0,0,0,", b"0,nan,0,0,0,0,", "not a finite number"),
        (b"0,0,0,0,0,0,", b"0,0,0,nan,0,0,", "differ from this scene's"),
        (b"\n0.5,0", b"\n", "differ|does not have"),
    ],
)
def test_a_damaged_file_is_refused(old: bytes, new: bytes, message: str) -> None:
    product = design("setzhub")
    data = WRITER.write(product, 1.0).data
    assert old in data
    with pytest.raises(FileError, match=message):
        WRITER.measure(product, data.replace(old, new, 1))


def test_no_file_is_refused() -> None:
    with pytest.raises(FileError, match="does not have this scene's columns and rows"):
        SECOND.measure(design("setzhub"), b"")


@pytest.mark.parametrize("scene", ["plate_translating", "shuttle"])
def test_what_is_no_cam_linkage_is_refused(scene: str) -> None:
    product = camgeo.load(FIXTURES / "scenes" / f"{scene}.toml").disc
    assert product.cam.drive.linkage is None
    with pytest.raises(SceneError, match=r"asc: needs \[linkage\]"):
        make_files((product,), ("asc",), 0.001)


def test_the_step_is_that_of_the_project() -> None:
    product = Design(parse_scene(imported("setzhub").replace("step = 0.5", "step = 0.7"))).disc
    phi = numbers(WRITER.write(product, 1.0).data)[:, 0]
    assert len(phi) == math.ceil(360.0 / 0.7)
    # Each is rounded once; counted up, the last would be 1e-12 off.
    assert phi[-1] == 359.8


def test_a_build_writes_both_files(tmp_path: Path) -> None:
    scene, out = tmp_path / "setzhub.toml", tmp_path / "out"
    project = FIXTURES / "reference" / "ocv" / "setzhub.ocv"
    assert main(["import", str(project), "-o", str(scene)]) == 0
    # 1, for the least transmission angle breaks the default limit.
    assert main(["build", str(scene), "-o", str(out), "--only", "asc"]) == 1
    for writer, name in ((WRITER, "setzhub1.asc"), (SECOND, "setzhub2.asc")):
        assert (out / name).read_bytes() == writer.write(design("setzhub"), 1.0).data
    certificate = json.loads((out / "certificate.json").read_bytes())
    files = [(each["file"], each["format"], each["deviation_mm"]) for each in certificate["files"]]
    assert files == [("setzhub1.asc", "asc", 0.0), ("setzhub2.asc", "asc", 0.0)]


def test_a_scene_may_ask_for_it_if_it_has_a_linkage() -> None:
    text = (FIXTURES / "scenes" / "vorschub.toml").read_text(encoding="utf-8")
    asked = text.replace('formats = ["dxf", ', 'formats = ["asc", "dxf", ')
    assert parse_scene(asked).output.formats[0] == "asc"
    head, _, tail = asked.partition("[linkage]")
    without = parse_scene(head + tail[tail.index("[[motion]]") :])
    (fault, *_) = without.lacking([WRITER.format])
    assert (fault.key, fault.value) == ("output.formats[1]", '"asc"')
    assert fault.message == "needs [linkage]"


def test_only_points_of_a_rocker_behind_a_slider_crank_are_asked_for() -> None:
    text = (FIXTURES / "scenes" / "four_bar.toml").read_text(encoding="utf-8")
    assert "formats = [" in text
    found = parse_scene(text.replace("formats = [", 'formats = ["asc", '))
    (fault, *_) = found.lacking([WRITER.format])
    assert fault.message == 'needs [linkage] kind = "slider-crank" and a rocker'
