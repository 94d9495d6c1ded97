"""Views of a design, each computed only for its reader; value tables and sketches of mechanisms."""

from __future__ import annotations

import cmath
import csv
import io
import json
import math
import pickle
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import fields
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo.design import value_table
from camgeo.design.design import Design
from camgeo.design.drawn import DrawnDisc
from camgeo.design.milled import MilledDisc
from camgeo.design.pictured import PicturedCam
from camgeo.design.product import Product
from camgeo.design.value_table import Table, TabulatedCam, rounded
from camgeo.errors import FileError, SceneError, ToleranceError
from camgeo.kinematics.mechanism.sketch import MechanismSketch
from camgeo.record import Pickled
from camgeo.scene.formats.csv import CsvSpec
from camgeo.scene.scene import load_scene
from camgeo.units import MM_PER, TURN
from camgeo_export.table import ASC_WRITER as ASC
from camgeo_export.table import WRITER
from tests.effects.scenes import SCENES
from tests.export.stub_product import StubProduct
from tests.findings import known
from tests.part.parts import refused

SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml"

VIEWS = {
    "drawn": DrawnDisc,
    "milled": MilledDisc,
    "tabulated": TabulatedCam,
    "pictured": PicturedCam,
}

MOST = 15
"""Public members of a view."""

READERS = {"csv": {"tabulated"}, "dxf": {"drawn"}, "gcode": {"drawn", "milled"}}
"""Formats, and the views that are computed for them."""


def members(of: type) -> set[str]:
    return {name for name in vars(of) if not name.startswith("_")}


@pytest.mark.parametrize("view", VIEWS.values())
def test_a_view_is_small(view: type) -> None:
    answers = members(view) - {each.name for each in fields(view)} - members(Pickled)
    assert 0 < len(answers) <= MOST


@pytest.mark.parametrize("name", ["drawn", "milled", "tabulated"])
def test_the_stub_of_writers_gives_all_of_a_view(name: str) -> None:
    view = VIEWS[name]
    answers = members(view) - {each.name for each in fields(view)} - members(Pickled)
    assert answers <= {*members(StubProduct), *(each.name for each in fields(StubProduct))}


def test_a_product_is_small() -> None:
    assert len(members(Product) - {each.name for each in fields(Product)}) <= MOST


@pytest.mark.parametrize("name", READERS)
def test_a_writer_is_computed_its_own_view_and_no_other(name: str) -> None:
    code = (
        "import camgeo, json, sys; from camgeo.design.writing import find_writer;"
        f"find_writer({name!r}).write(camgeo.load(sys.argv[1]).disc, 0.01);"
        "print(json.dumps([n for n in sys.modules if n.startswith('camgeo.design.')]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(SCENE)], capture_output=True, text=True, check=True
    )
    modules = {view: VIEWS[view].__module__ for view in VIEWS}
    loaded = set(json.loads(done.stdout))
    assert {view for view in VIEWS if modules[view] in loaded} == READERS[name]


def test_views_travel_in_pickles_and_answer_the_same() -> None:
    design = camgeo.load(SCENE)
    drawn, milled, tabulated, pictured = pickle.loads(
        pickle.dumps(
            (design.disc.drawn, design.disc.milled, design.tabulated, design.disc.pictured)
        )
    )
    assert len(drawn.part.boundaries) == len(design.disc.drawn.part.boundaries)
    assert milled.toolpath(0.01).operations[0].cut.name == design.disc.milled.cuts[0].name
    step = Decimal(30)
    assert np.array_equal(tabulated.table(step).values, design.tabulated.table(step).values)
    phi = np.linspace(0.0, 6.0, 7)
    assert np.array_equal(pictured.curve("inner", phi), design.disc.pictured.curve("inner", phi))


@pytest.mark.parametrize(
    "step", [*map(Decimal, ("0", "-1", "NaN", "100")), 0, -1.0, 91, math.inf, "1", True]
)
def test_a_table_has_a_step_of_the_scene_s_range(step: Any) -> None:
    with refused("output.csv.step", "must be a number from 0.001 to 90 "):
        camgeo.load(SCENE).tabulated.table(step)


@pytest.mark.parametrize("step", [0.2, np.float64(0.2), Fraction(1, 5), 30, np.int64(30)])
def test_a_table_takes_any_number_as_its_step(step: Any) -> None:
    """0.2 is the decimal number 0.2, so the last row is exactly at 359.8 degrees."""
    tabulated = camgeo.load(SCENE).tabulated
    exact = Decimal("0.2") if step < 1 else Decimal(30)
    assert np.array_equal(tabulated.table(step).values, tabulated.table(exact).values)


# Value tables: columns, decimals, signs and units -------------------------------------------------


SETZHUB = SCENES / "setzhub.toml"


def stated(**options: Any) -> Design:
    return camgeo.load(SETZHUB).with_output({f"csv.{key}": each for key, each in options.items()})


def read(design: Design, delimiter: str = ",") -> tuple[list[str], list[list[str]]]:
    rows = csv.reader(
        io.StringIO(WRITER.write(design.disc, 1e-3).data.decode()), delimiter=delimiter
    )
    head, *body = rows
    return head, body


def test_by_default_the_table_is_the_whole_one_to_the_last_byte() -> None:
    design = camgeo.load(SETZHUB)
    table = design.tabulated.table()
    assert design.tabulated.written() is table
    assert WRITER.write(design.disc, 1e-3).data == table.csv().encode()
    same = stated(decimal_comma=False, angle="deg", unit="mm")
    assert WRITER.write(same.disc, 1e-3).data == table.csv().encode()


def test_columns_in_the_order_asked_for_with_polar_coordinates() -> None:
    names = ["inner angle", "inner radius", "s", "phi", "pitch radius", "mu"]
    head, body = read(stated(columns=names, step=0.5))
    assert head == [
        "inner angle [deg]", "inner radius [mm]", "s [mm]", "phi [deg]", "pitch radius [mm]",
        "mu [deg]",
    ]  # fmt: skip
    assert len(body) == 720
    whole = camgeo.load(SETZHUB).tabulated.table(0.5).columns
    found = np.array(body, dtype=np.float64).T
    point = found[1] * np.exp(1j * np.radians(found[0]))
    exact = whole["inner x [mm]"] + 1j * whole["inner y [mm]"]
    assert np.max(abs(point - exact)) <= 1e-13 * np.max(abs(exact))
    assert np.all((found[0] >= 0.0) & (found[0] < 360.0))
    for row, name in ((2, "s [mm]"), (3, "phi [deg]"), (5, "mu [deg]")):
        assert np.array_equal(found[row], whole[name])


def test_a_flat_face_has_the_polar_coordinates_of_its_contact() -> None:
    names = ["contact radius", "contact angle"]
    design = camgeo.load(SCENES / "tappet.toml").with_output({"csv.columns": names})
    head, body = read(design)
    assert head == ["contact radius [mm]", "contact angle [deg]"]
    whole = camgeo.load(SCENES / "tappet.toml").tabulated.table().columns
    radius = np.hypot(whole["contact x [mm]"], whole["contact y [mm]"])
    assert np.array_equal(np.array(body, dtype=np.float64)[:, 0], radius)


@pytest.mark.parametrize(("separator", "delimiter"), [(None, ";"), (";", ";"), ("tab", "\t")])
def test_decimal_commas(separator: str | None, delimiter: str) -> None:
    options = {} if separator is None else {"separator": separator}
    design = stated(columns=["phi", "s", "r_K"], decimals=4, decimal_comma=True, **options)
    head, body = read(design, delimiter)
    assert head == ["phi [deg]", "s [mm]", "r_K [mm]"]
    assert "." not in "".join(map("".join, body))
    assert all(len(cell.partition(",")[2]) == 4 for row in body for cell in row)
    exact = camgeo.load(SETZHUB).tabulated.table().columns["s [mm]"]
    assert np.max(abs([float(row[1].replace(",", ".")) for row in body] - exact)) <= 0.5e-4 + 1e-12
    data = WRITER.write(design.disc, 1e-3).data
    assert 0.0 < WRITER.measure(design.disc, data) <= 0.5e-4 + 1e-12
    with pytest.raises(FileError, match="ratios or radii differ"):
        WRITER.measure(design.disc, data.replace(b"90,0000", b"90,0001", 1))


def test_units_of_lengths_and_angles() -> None:
    whole = camgeo.load(SETZHUB).tabulated.table()
    found = stated(unit="inch", angle="rad").tabulated.written()
    assert [name.replace("rad", "deg") for name in found.names if "/" not in name] == [
        name.replace("[mm]", "[inch]") for name in whole.names if "/" not in name
    ]
    columns, exact = found.columns, whole.columns
    np.testing.assert_allclose(columns["s [inch]"] * 25.4, exact["s [mm]"], rtol=1e-14)
    np.testing.assert_allclose(columns["kappa [1/inch]"] / 25.4, exact["kappa [1/mm]"], rtol=1e-14)
    np.testing.assert_allclose(columns["mu [rad]"], np.radians(exact["mu [deg]"]), rtol=1e-15)
    speed = np.radians(exact["omega_psi [deg/s]"])
    np.testing.assert_allclose(columns["omega_psi [rad/s]"], speed, rtol=1e-15)


def test_the_files_of_opticurv_stay_what_they_are() -> None:
    before = ASC.write(camgeo.load(SETZHUB).disc, 1e-3).data
    after = stated(columns=["phi"], decimals=2, unit="inch", angle="rad", decimal_comma=True)
    assert ASC.write(after.disc, 1e-3).data == before


def test_too_few_decimals_are_refused(tmp_path: Path) -> None:
    """A length may be off by half of the last decimal."""
    with pytest.raises(ToleranceError, match="csv file, read back, deviates"):
        stated(decimals=2).write(tmp_path, ["csv"])
    assert list(tmp_path.iterdir()) == []
    report = stated(decimals=3).write(tmp_path, ["csv"])
    (file,) = report.files
    assert 0.0 < known(file.deviation) <= 0.5e-3 + 1e-9


@pytest.mark.parametrize(("names", "said"), [
    (["phi", "iner radius"], "did you mean inner radius"), (["S"], "is not a column"),
])  # fmt: skip
def test_a_column_that_there_is_not(names: Sequence[str], said: str) -> None:
    with refused(f"output.csv.columns[{len(names)}]", said):
        stated(columns=list(names)).tabulated.written()


@pytest.mark.parametrize(("options", "key"), [
    ({"decimals": 16}, "decimals"), ({"decimals": -1}, "decimals"), ({"unit": "cm"}, "unit"),
    ({"angle": "gon"}, "angle"), ({"separator": "|"}, "separator"), ({"columns": []}, "columns"),
    ({"decimal_comma": True, "separator": ","}, "separator"), ({"columns": ["s", "s"]}, "columns"),
])  # fmt: skip
def test_options_that_are_not_allowed(options: dict[str, Any], key: str) -> None:
    with pytest.raises(SceneError) as caught:
        stated(**options)
    assert all(each.key.startswith(f"output.csv.{key}") for each in caught.value.faults)


@pytest.mark.parametrize("given", [
    {"decimals": 16}, {"decimals": 1.5}, {"decimal_comma": 1}, {"separator": "|"}, {"unit": "m"},
    {"angle": "gon"}, {"separator": ",", "decimal_comma": True},
])  # fmt: skip
def test_the_declaration_has_its_own_door(given: dict[str, Any]) -> None:
    with refused(f"output.csv.{next(iter(given))}"):
        CsvSpec(**given)


def test_a_table_has_a_largest_size(monkeypatch: pytest.MonkeyPatch) -> None:
    design = camgeo.load(SETZHUB)
    monkeypatch.setattr(value_table, "NUMBERS", 40 * len(design.tabulated.table(90).names))
    assert len(design.tabulated.table(9).values) == 40
    with refused("output.csv.step", "45 rows of 25 columns are more than 1,000"):
        design.tabulated.table(8)


def test_rounding_writes_no_minus_zero() -> None:
    table = Table(("a",), np.array([[-0.0004], [-0.0], [1.2345]]))
    assert (rounded(table, 3).csv(), rounded(table, 0).csv()) == (
        "a\n0.000\n0.000\n1.234\n",
        "a\n0\n0\n1\n",
    )
    assert rounded(table, None) is table


# The sketch of a mechanism: bodies stay rigid, roller and face lie where the cam holds them -------


SCENE_FILES = sorted((Path(__file__).resolve().parents[2] / "fixtures" / "scenes").glob("*.toml"))

ANGLES = np.random.default_rng(7).uniform(0.0, TURN, 7)

ROUNDING = 1e-12
"""Rounding of a point, as a share of the mechanism's size: some sines and sums."""


@pytest.fixture(params=SCENE_FILES, ids=lambda path: path.stem)
def design(request: pytest.FixtureRequest) -> Design:
    return Design(load_scene(request.param))


def lengths(sketch: MechanismSketch[complex]) -> list[float]:
    """Lengths of the links, from point to point."""
    return [abs(b - a) for link in sketch.links for a, b in pairwise(link)]


def test_links_keep_their_lengths_and_what_is_fixed_its_place(design: Design) -> None:
    """A guide stays, and holds its slider all the way."""
    start = design.disc.pictured.mechanism_sketch(0.0)
    size = max(abs(point) for point in start.points)
    for phi in ANGLES:
        sketch = design.disc.pictured.mechanism_sketch(float(phi))
        assert lengths(sketch) == pytest.approx(lengths(start), abs=ROUNDING * size)
        assert sketch.shafts == start.shafts
        for guide, first in zip(sketch.guides, start.guides, strict=True):
            way = (guide.middle - first.middle) * first.direction.conjugate()
            assert guide.direction == first.direction
            assert abs(way.imag) <= ROUNDING * size
            assert (guide.travel, len(guide.travel)) == (first.travel, 2 * guide.block)
            ways = [((at - guide.middle) / guide.direction).real for at in guide.travel] or [0.0]
            assert min(ways) <= ROUNDING * size
            assert max(ways) >= -ROUNDING * size


def test_dimensions_are_the_scenes_own_wherever_the_cam_is(design: Design) -> None:
    """Each is measured between its ends, and is what the scene has at its key."""
    unit = MM_PER[design.scene.unit]
    for phi in (0.0, *map(float, ANGLES[:2])):
        sketch = design.disc.pictured.mechanism_sketch(phi)
        assert sketch.dimensions
        size = max(abs(point) for point in sketch.points)
        for each in sketch.dimensions:
            tables, key = each.key.rpartition(".")[::2]
            table: Any = design.scene.values
            for name in tables.split("."):
                table = table[name]
            # What a return roller does not state is as of the main one.
            stated = table.get(key, design.scene.values["follower"].get(key))
            stated = stated if isinstance(stated, list | tuple) else [stated]
            expected = [float(value) * unit for value in stated]
            assert list(each.value) == pytest.approx(expected, abs=10.0 * ROUNDING * size), each.key


def test_rollers_lie_on_the_pitch_curves_of_the_turned_discs(design: Design) -> None:
    discs = design.discs
    for phi in ANGLES:
        rollers = design.disc.pictured.mechanism_sketch(float(phi)).rollers
        for disc, (centre, radius) in zip(discs, rollers, strict=False):
            ((x, y),) = disc.pictured.curve("pitch", np.array([phi]))
            turned = complex(x, y) * cmath.exp(1j * design.cam.rotation * phi)
            assert abs(centre - turned) <= ROUNDING * abs(turned)
            assert radius == disc.cam.follower.roller_radius


def test_faces_touch_the_turned_disc(design: Design) -> None:
    pictured = design.disc.pictured
    outline = pictured.curve("pitch", np.linspace(0.0, TURN, 3601)) @ np.array([1.0, 1j])
    for phi in ANGLES:
        ((x, y),) = pictured.curve("pitch", np.array([phi]))
        turn = cmath.exp(1j * design.cam.rotation * phi)
        for number, (start, end) in enumerate(pictured.mechanism_sketch(float(phi)).faces):
            along = (end - start) / abs(end - start)
            outward = 1j * along if ((start * along.conjugate()).imag > 0.0) else -1j * along
            beyond = ((outline * turn - start) * outward.conjugate()).real
            assert np.max(beyond) <= ROUNDING * abs(start)
            contact = complex(x, y) * turn
            if number == 0:
                assert abs(((contact - start) * outward.conjugate()).real) <= 1e-9
                assert 0.0 < ((contact - start) * along.conjugate()).real < abs(end - start)
            else:  # the far side of a yoke, touched at a point between two of the outline's
                assert np.max(beyond) >= -1e-3


def test_the_far_angle_is_where_the_demanded_motion_is_farthest(design: Design) -> None:
    phi = np.linspace(0.0, TURN, 3601)
    strokes = np.abs(design.drive.plan.jet(phi)[0])
    far = design.drive.far_angle
    assert 0.0 <= far < TURN
    farthest = float(np.abs(design.drive.plan.jet(np.array([far]))[0, 0]))
    assert farthest >= float(strokes.max()) * (1.0 - ROUNDING)


def test_a_rod_reaches_through_its_guide_all_the_time() -> None:
    design = Design(
        load_scene(next(path for path in SCENE_FILES if path.stem == "plate_translating"))
    )
    for phi in (0.0, design.drive.far_angle, *ANGLES):
        sketch = design.disc.pictured.mechanism_sketch(float(phi))
        ((foot, end),) = sketch.links
        (guide,) = sketch.guides
        along = [((p - guide.middle) / guide.direction).real for p in (foot, end)]
        assert along[0] < 0.0 < along[1]
        assert math.isclose(((end - foot) / guide.direction).imag, 0.0, abs_tol=1e-9)


FOLDER = Path(__file__).parents[2] / "fixtures" / "scenes"


@pytest.mark.parametrize("name", ["tappet", "flat_rocker"])
def test_the_contact_lies_on_the_face_that_is_drawn(name: str) -> None:
    design = camgeo.load(FOLDER / f"{name}.toml")
    sketch = design.disc.pictured.follower_sketch
    start, end = known(sketch.face)
    contact = complex(*design.disc.pictured.curve("pitch", np.zeros(1))[0])
    share = (contact - start) / (end - start)
    assert abs(share.imag) <= 1e-14
    assert 0.0 < share.real < 1.0
    # As long as the scene says, that of a rocker on to the foot of its pivot.
    assert abs(end - start) == pytest.approx({"tappet": 20.0, "flat_rocker": 100.0}[name])
    foot = start if sketch.kind == "pivot" else contact
    assert abs(((sketch.end - foot) / (end - start)).real) <= 1e-14
