"""The point files: the columns of opticurv's source in their order, with correct values."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.app.cli.import_ import import_project
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.writing import make_files
from camgeo.errors import FileError, SceneError
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import parse_scene
from camgeo_export.table import ASC_SECOND as SECOND
from camgeo_export.table import ASC_WRITER as WRITER
from camgeo_export.table import COLUMNS, POINTS, AscWriter
from tests.inches import in_inches
from tests.reference import THESIS_CAMS, pitch_curve_of, reference, thesis_params

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
