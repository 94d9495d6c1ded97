"""Views of a design, each computed only for its reader, and value tables as a shop wants them."""

from __future__ import annotations

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
from camgeo.record import Pickled
from camgeo.scene.formats.csv import CsvSpec
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
    found = [float(row[1].replace(",", ".")) for row in body]
    assert np.max(abs(found - exact)) <= 0.5e-4 + 1e-12
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
    with pytest.raises(ToleranceError, match="csv file, read back, is off"):
        stated(decimals=2).write(tmp_path, ["csv"])
    assert list(tmp_path.iterdir()) == []
    report = stated(decimals=3).write(tmp_path, ["csv"])
    (file,) = report.files
    assert 0.0 < known(file.deviation) <= 0.5e-3 + 1e-9


@pytest.mark.parametrize(("names", "said"), [
    (["phi", "iner radius"], "did you mean inner radius"), (["S"], "is no column"),
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
    assert rounded(table, 3).csv() == "a\n0.000\n0.000\n1.234\n"
    assert rounded(table, 0).csv() == "a\n0\n0\n1\n"
    assert rounded(table, None) is table
